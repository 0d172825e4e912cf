// Solves a family through the C API.
// SPDX-License-Identifier: BSD-3-Clause
#include "family_run.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace sfdae_test {

namespace {

struct Observer {
  const LinearFamily* family;
  const sfdae_options* options;
  double worst = 0.0;
};

double weighted_error(const LinearFamily& family, const sfdae_options& options, double t, const double* x) {
  if (!family.has_exact()) return 0.0;
  std::vector<double> exact(static_cast<std::size_t>(family.n()));
  family.exact(t, exact.data(), nullptr);
  double worst = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const double error = std::fabs(x[i] - exact[i]) / (options.rtol * std::fabs(exact[i]) + options.atol);
    if (!(error <= worst)) worst = error;
  }
  return worst;
}

int observe(const sfdae_progress* progress, void* user) {
  auto* observer = static_cast<Observer*>(user);
  const double error = weighted_error(*observer->family, *observer->options, progress->t, progress->x);
  if (!(error <= observer->worst)) observer->worst = error;
  return 0;
}

double slope_error(const LinearFamily& family, double t, const std::vector<double>& xdot, bool relative) {
  if (!family.has_exact()) return 0.0;
  std::vector<double> x(xdot.size()), exact(xdot.size());
  family.exact(t, x.data(), exact.data());
  double worst = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i)
    worst = std::max(worst, std::fabs(xdot[i] - exact[i]) / (relative ? 1.0 + std::fabs(exact[i]) : 1.0));
  return worst;
}

}  // namespace

sfdae_options options_with_tolerance(double tol) {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.rtol = options.atol = tol;
  return options;
}

FamilyRun run_family(FamilyProblem& problem, double t0, double t1, sfdae_options options, int outputs,
                     std::vector<double> x0) {
  const LinearFamily& family = problem.family();
  const std::size_t n = static_cast<std::size_t>(family.n());
  FamilyRun run;
  Observer observer{&family, &options};
  options.monitor = observe;
  options.monitor_user = &observer;
  run.x = std::move(x0);
  run.xdot.assign(n, 0.0);
  if (run.x.empty()) {
    run.x.assign(n, 0.0);
    if (family.has_exact()) family.exact(t0, run.x.data(), nullptr);
  }
  sfdae_statistics_init(&run.statistics, sizeof run.statistics);
  sfdae_characteristics_init(&run.characteristics, sizeof run.characteristics);
  sfdae_change_init(&run.change, sizeof run.change);

  sfdae_solver* solver = nullptr;
  run.status = sfdae_create_linear(&solver, &problem.problem, &options);
  if (run.status != SFDAE_OK) return run;
  run.t = t0;
  run.status = sfdae_start(solver, t0, t1, run.x.data(), run.xdot.data());
  if (run.status >= 0) run.initial_slope_error = slope_error(family, t0, run.xdot, false);
  for (int i = 1; i <= outputs && run.status >= 0; ++i) {
    const double tout = i == outputs ? t1 : t0 + (t1 - t0) * i / outputs;
    run.status = sfdae_advance(solver, tout, &run.t, run.x.data(), run.xdot.data());
    if (run.status < 0) break;
    run.output_error = std::max(run.output_error, weighted_error(family, options, run.t, run.x.data()));
    run.slope_error = std::max(run.slope_error, slope_error(family, run.t, run.xdot, true));
  }
  run.message = sfdae_message(solver);
  run.step_error = observer.worst;
  sfdae_get_statistics(solver, &run.statistics);
  sfdae_get_characteristics(solver, &run.characteristics);
  if (run.status == SFDAE_CHARACTERISTICS_CHANGED) sfdae_get_change(solver, &run.change);
  sfdae_destroy(&solver);
  return run;
}

int scaled_count(int count, int least) {
  const char* scale = std::getenv("SFDAE_TEST_SCALE");
  if (scale == nullptr) return count;
  return std::max(least, static_cast<int>(count * std::min(1.0, std::max(0.0, std::atof(scale)))));
}

}  // namespace sfdae_test
