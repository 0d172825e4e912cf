// SPDX-License-Identifier: BSD-3-Clause
// Singular points of nonlinear systems: named where they are, and none where there is none (singular_system.h).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "family_run.h"
#include "nonlinear_run.h"
#include "singular_system.h"

namespace {

using namespace sfdae_test;

NonlinearEquations recorded(const SingularSystem& system) {
  return equations_of(system.n(), system.n(), [&system](const auto& t, const auto* x, const auto* xdot, auto* F) {
    system.residual(t, x, xdot, F);
  });
}

struct Outcome {
  int status = 0;
  bool has_change = false;
  double t = 0.0, named = 0.0, step = 0.0;
  long steps = 0;
  std::vector<double> x;
  std::string text;
};

Outcome run(const SingularSystem& system, int method, double tolerance) {
  sfdae_options options = options_with(tolerance, method);
  options.max_steps = 4000;
  NonlinearRun run(recorded(system), options);
  Outcome outcome;
  outcome.status = run.created < 0 ? run.created : run.integrate(system.start(), system.end(), system.exact(system.start()));
  outcome.t = run.t;
  outcome.x = run.x;
  outcome.steps = run.statistics().steps;
  outcome.text = status_text(run, outcome.status);
  sfdae_change change;
  sfdae_change_init(&change, sizeof change);
  outcome.has_change = sfdae_get_change(run.solver(), &change) == 0;
  outcome.named = change.t;
  return outcome;
}

TEST(SingularPoints, Campaign) {
  const int count = std::getenv("COUNT") ? std::atoi(std::getenv("COUNT")) : 100;
  const unsigned first = std::getenv("FIRST") ? unsigned(std::atoi(std::getenv("FIRST"))) : 0;
  int missed = 0, all = 0, off = 0, far = 0;
  for (unsigned seed = first; seed < first + unsigned(count); ++seed) {
    const SingularSystem system(seed, true);
    for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
      for (double tolerance : {1e-3, 1e-5, 1e-8}) {
        const Outcome o = run(system, method, tolerance);
        ++all;
        const double s_error = (o.named - system.time()) / system.unit();
        const double left = (o.named - o.t - system.time_left(o.t, o.x)) / system.unit();
        const bool bad = !(o.status == SFDAE_CHARACTERISTICS_CHANGED && o.has_change);
        if (bad) ++missed;
        else if (std::abs(s_error) > 100 * tolerance + 1e-5) ++off;
        else if (std::abs(o.named - o.t) / system.unit() > 1e-5) ++far;
        if (bad || std::abs(s_error) > 100 * tolerance + 1e-5 || std::getenv("ALL"))
          std::printf("seed %u n %d mu %d kind %d m %d tol %.0e s* %.4f stopped s %.6f s_error %.2e left %.2e steps %ld %s\n", seed,
                      system.n(), system.mu(), int(system.kind()), method, tolerance, (system.time() - system.start()) / system.unit(),
                      (o.t - system.start()) / system.unit(), s_error, left, o.steps, o.text.substr(0, 150).c_str());
      }
  }
  std::printf("all %d missed %d off %d far %d\n", all, missed, off, far);
}

TEST(SingularPoints, NoAlarm) {
  const int count = std::getenv("COUNT") ? std::atoi(std::getenv("COUNT")) : 100;
  const unsigned first = std::getenv("FIRST") ? unsigned(std::atoi(std::getenv("FIRST"))) : 0;
  int alarms = 0, all = 0, failed = 0;
  for (unsigned seed = first; seed < first + unsigned(count); ++seed) {
    const SingularSystem system(seed, false);
    for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
      for (double tolerance : {1e-3, 1e-5, 1e-8}) {
        const Outcome o = run(system, method, tolerance);
        ++all;
        if (o.has_change) ++alarms;
        else if (o.status < 0) ++failed;
        if (o.status < 0)
          std::printf("NONE seed %u n %d mu %d kind %d m %d tol %.0e stopped s %.6f s %.4f steps %ld %s\n", seed, system.n(), system.mu(),
                      int(system.kind()), method, tolerance, (o.t - system.start()) / system.unit(), (system.time() - system.start()) / system.unit(), o.steps,
                      o.text.substr(0, 150).c_str());
      }
  }
  std::printf("all %d alarms %d failed %d\n", all, alarms, failed);
}

}  // namespace
