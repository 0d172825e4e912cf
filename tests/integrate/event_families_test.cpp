// SPDX-License-Identifier: BSD-3-Clause
// Events of families with known solutions: every component against a level, by all methods, forward and backward.
// What the exact solution crosses is found, and nothing else.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "family_problem.h"
#include "family_run.h"

namespace {

using namespace sfdae_test;
using Vector = std::vector<double>;
using FamilyPointer = std::shared_ptr<const LinearFamily>;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

int levels_crossed(double, const double* x, const double*, double* g, void* user) {
  const Vector& levels = *static_cast<const Vector*>(user);
  for (std::size_t i = 0; i < levels.size(); ++i) g[i] = x[i] - levels[i];
  return 0;
}

struct Event {
  double t;
  int component, sign;
  double value;  // of g as returned
};

struct Journey {
  Journey(const FamilyPointer& family, int method, double tol, bool constant = false) : problem(family) {
    if (constant) problem.declare_constants();
    sfdae_options options = options_with_tolerance(tol);
    options.method = method;
    EXPECT_EQ(sfdae_create_linear(&solver, &problem.problem, &options), SFDAE_OK);
    x.resize(index(problem.n()));
  }
  Journey(const Journey&) = delete;
  Journey& operator=(const Journey&) = delete;
  ~Journey() { sfdae_destroy(&solver); }

  void start(double t0, double t1) {
    problem.family().exact(t0, x.data(), nullptr);
    EXPECT_GE(sfdae_start(solver, t0, t1, x.data(), nullptr), 0);
  }
  std::vector<Event> events_to(double t1, Vector& levels) {
    EXPECT_EQ(sfdae_set_events(solver, problem.n(), levels_crossed, nullptr, &levels), SFDAE_OK);
    std::vector<Event> events;
    std::vector<int> which(x.size());
    int status;
    while ((status = sfdae_advance(solver, t1, &t, x.data(), nullptr)) == SFDAE_EVENT && events.size() < 1000) {
      sfdae_get_events(solver, which.data());
      for (std::size_t i = 0; i < x.size(); ++i)
        if (which[i] != 0) events.push_back({t, static_cast<int>(i), which[i], x[i] - levels[i]});
    }
    EXPECT_EQ(status, SFDAE_OK) << sfdae_message(solver);
    return events;
  }

  FamilyProblem problem;
  sfdae_solver* solver = nullptr;
  double t = 0.0;
  Vector x;
};

// Levels are the values of the exact solution at `middle`.
void compare(const FamilyPointer& family, int method, double tol, bool backward, bool constant = false) {
  const double t0 = backward ? 3.0 : 0.0, t1 = backward ? 0.0 : 3.0, middle = 1.234567;
  const int n = family->n();
  Vector levels(index(n)), exact(index(n)), slope(index(n)), before(index(n));
  family->exact(middle, levels.data(), nullptr);
  Journey run(family, method, tol, constant);
  run.start(t0, t1);
  const std::vector<Event> events = run.events_to(t1, levels);
  const double error = 300 * tol;
  for (const Event& event : events) {
    family->exact(event.t, exact.data(), slope.data());
    const double size = 1.0 + std::fabs(levels[index(event.component)]);
    // Rounding errors of x grow with the number of differentiations.
    const double rounding = 64 * std::numeric_limits<double>::epsilon() * std::pow(10.0, family->values().mu);
    EXPECT_LE(std::fabs(event.value), rounding * (size + std::fabs(slope[index(event.component)])))
        << family->name() << method;
    EXPECT_LE(std::fabs(exact[index(event.component)] - levels[index(event.component)]), error * size)
        << family->name() << " method " << method << " tol " << tol << " t " << event.t;
  }
  // Every crossing that is not too flat.
  constexpr int grid = 3000;
  family->exact(t0, before.data(), nullptr);
  int crossings = 0;
  for (int k = 1; k <= grid; ++k) {
    const double t = t0 + (t1 - t0) * k / grid;
    family->exact(t, exact.data(), slope.data());
    for (int i = 0; i < n; ++i) {
      const double old = before[index(i)] - levels[index(i)], now = exact[index(i)] - levels[index(i)];
      const double size = 1.0 + std::fabs(levels[index(i)]);
      const double distance = 3.0 / grid + error * size / std::fabs(slope[index(i)]);
      if (old * now >= 0.0 || std::fabs(slope[index(i)]) < 0.05 * size) continue;
      ++crossings;
      bool found = false;
      for (const Event& event : events)
        found = found || (event.component == i && std::fabs(event.t - t) <= distance && event.sign * now > 0.0);
      EXPECT_TRUE(found) << family->name() << " method " << method << " tol " << tol << " x" << i << " t " << t;
    }
    before = exact;
  }
  EXPECT_GE(crossings, n / 2) << family->name();
}

const int methods[] = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU, SFDAE_METHOD_AUTOMATIC};

TEST(EventFamilies, EventsAreTheCrossingsOfTheExactSolution) {
  for (int method : methods)
    for (double tol : {1e-4, 1e-7, 1e-10})
      for (bool backward : {false, true}) {
        for (int mu = 0; mu <= 3; ++mu) compare(kron(8, mu, 2.0), method, tol, backward);
        compare(kron(3, 2, 2.0), method, tol, backward);  // no dynamics
        compare(rotated_ode(RowOperation::scaling, 5.0), method, tol, backward);
      }
}

TEST(EventFamilies, ConstantMatricesAndMechanics) {
  for (int method : methods)
    for (double tol : {1e-4, 1e-7}) {
      compare(kron(8, 1, 0.0), method, tol, false, true);
      compare(chain(4, 2), method, tol, false);
    }
}

/// BDF steps do not depend on events nor on outputs: changes of sign at 3000 outputs are the events. With free
/// components.
TEST(EventFamilies, EventsAreTheCrossingsThatOutputsShow) {
  for (const FamilyPointer& family :
       {FamilyPointer(kron(8, 1, 2.0, 2)), FamilyPointer(kron(6, 0, 2.0)), FamilyPointer(chain(4, 2))}) {
    Vector levels(index(family->n()));
    Journey first(family, SFDAE_METHOD_BDF, 1e-6), plain(family, SFDAE_METHOD_BDF, 1e-6),
        run(family, SFDAE_METHOD_BDF, 1e-6);
    first.start(0.0, 3.0);
    EXPECT_EQ(sfdae_advance(first.solver, 1.234567, &first.t, levels.data(), nullptr), SFDAE_OK);
    plain.start(0.0, 3.0);
    run.start(0.0, 3.0);
    const std::vector<Event> events = run.events_to(3.0, levels);
    Vector old = plain.x;
    int crossings = 0;
    for (int k = 1; k <= 3000; ++k) {
      EXPECT_EQ(sfdae_advance(plain.solver, k * 1e-3, &plain.t, plain.x.data(), nullptr), SFDAE_OK);
      for (std::size_t i = 0; i < old.size(); ++i) {
        if ((old[i] - levels[i]) * (plain.x[i] - levels[i]) >= 0.0) continue;
        ++crossings;
        bool found = false;
        for (const Event& event : events)
          found = found || (index(event.component) == i && std::fabs(event.t - (k - 0.5) * 1e-3) <= 0.51e-3);
        EXPECT_TRUE(found) << family->name() << " x" << i << " t " << plain.t;
      }
      old = plain.x;
    }
    EXPECT_GE(static_cast<int>(events.size()), crossings);
    EXPECT_GE(crossings, family->n() / 2);
    sfdae_statistics a{}, b{};
    sfdae_statistics_init(&a, sizeof a);
    sfdae_statistics_init(&b, sizeof b);
    sfdae_get_statistics(plain.solver, &a);
    sfdae_get_statistics(run.solver, &b);
    EXPECT_EQ(a.steps, b.steps);
    EXPECT_EQ(a.next_step, b.next_step);
    // A step costs no reduction more, an event about ten.
    EXPECT_LE(b.reductions,
              b.steps + b.error_failures + b.other_failures + 3 + 16 * static_cast<long>(events.size()));
  }
}

}  // namespace
