// Checks that meet points at which the user's functions fail refuse a step, or the call ends with a status that says
// so: an answer with status SFDAE_OK is right.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "integrate/difference_check.h"
#include "nonlinear_run.h"
#include "random.h"

namespace {

using namespace sfdae_test;

double power_of_ten(Random& random, double low, double high) { return std::pow(10.0, random.real(low, high)); }

// d^k/dt^k of sin.
double sine(double t, int k) { return std::sin(t + 1.5707963267948966 * k); }

// y1' = -y1, 0 = (t - singular) (y2 - sin t), y = Q x with a rotation Q: the characteristic values change at one point,
// which the solution passes. Functions fail nearer to it than `width`.
struct PassedPoint {
  double c, s, singular, width = 0.0;

  explicit PassedPoint(Random& random) {
    const double angle = random.real(0.0, 6.0);
    c = std::cos(angle), s = std::sin(angle);
    singular = random.real(0.5, 3.0);
  }
  bool fails(double t) const { return std::fabs(t - singular) < width; }
  std::vector<double> solution(double t) const {
    const double y1 = std::exp(-t), y2 = std::sin(t);
    return {c * y1 - s * y2, s * y1 + c * y2};
  }
  double factor(double t, int order) const { return order == 0 ? t - singular : order == 1 ? 1.0 : 0.0; }
  double product(double t, int order) const {
    return (t - singular) * sine(t, order) + (order > 0 ? order * sine(t, order - 1) : 0.0);
  }

  static int E(double t, int order, double* E, void* user) {
    const auto& self = *static_cast<const PassedPoint*>(user);
    if (order == 0) E[0] = self.c, E[2] = self.s;
    return self.fails(t) ? 1 : 0;
  }
  static int A(double t, int order, double* A, void* user) {
    const auto& self = *static_cast<const PassedPoint*>(user);
    if (order == 0) A[0] = -self.c, A[2] = -self.s;
    A[1] = -self.s * self.factor(t, order), A[3] = self.c * self.factor(t, order);
    return self.fails(t) ? 1 : 0;
  }
  static int f(double t, int order, double* f, void* user) {
    const auto& self = *static_cast<const PassedPoint*>(user);
    f[1] = -self.product(t, order);
    return self.fails(t) ? 1 : 0;
  }
  // The same equations, F = E x' - A x - f.
  static int total_derivative(double t, int order, const double* x, double* F, double* F_x, double* F_xdot,
                              void* user) {
    const auto& self = *static_cast<const PassedPoint*>(user);
    if (self.fails(t)) return 1;
    const auto y = [&](int i, int k) {
      const double* at = x + 2 * k;
      return i == 0 ? self.c * at[0] + self.s * at[1] : -self.s * at[0] + self.c * at[1];
    };
    F[0] = y(0, order + 1) + y(0, order);
    F[1] = self.factor(t, 0) * y(1, order) + (order > 0 ? order * y(1, order - 1) : 0.0) - self.product(t, order);
    if (F_x != nullptr) {
      F_x[0] = order == 0 ? self.c : 0.0, F_x[2] = order == 0 ? self.s : 0.0;
      F_x[1] = -self.s * self.factor(t, order), F_x[3] = self.c * self.factor(t, order);
    }
    if (F_xdot != nullptr && order == 0) F_xdot[0] = self.c, F_xdot[2] = self.s;
    return 0;
  }
};

sfdae_solver* linear_solver(PassedPoint& point, const sfdae_options& options) {
  sfdae_linear_problem problem;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 2;
  problem.E = PassedPoint::E;
  problem.A = PassedPoint::A;
  problem.f = PassedPoint::f;
  problem.user = &point;
  sfdae_solver* solver = nullptr;
  EXPECT_EQ(sfdae_create_linear(&solver, &problem, &options), SFDAE_OK);
  return solver;
}

sfdae_solver* nonlinear_solver(PassedPoint& point, const sfdae_options& options) {
  sfdae_nonlinear_problem problem;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 2;
  problem.total_derivative = PassedPoint::total_derivative;
  problem.user = &point;
  sfdae_solver* solver = nullptr;
  EXPECT_EQ(sfdae_create_nonlinear(&solver, &problem, &options), SFDAE_OK);
  return solver;
}

using Create = sfdae_solver* (*)(PassedPoint&, const sfdae_options&);

// The status of a run over the singular point.
int status_beyond(Create create, PassedPoint& point, const sfdae_options& options) {
  sfdae_solver* solver = create(point, options);
  std::vector<double> x = point.solution(0.0), xdot(2);
  double t = 0.0;
  int status = sfdae_start(solver, 0.0, 4.0, x.data(), xdot.data());
  EXPECT_GE(status, SFDAE_OK) << sfdae_message(solver);
  status = sfdae_advance(solver, 4.0, &t, x.data(), xdot.data());
  sfdae_destroy(&solver);
  return status;
}

void expect_named(Create create, bool fails_nearby) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    Random random(seed);
    PassedPoint point(random);
    const int method = random.integer(0, 1) == 0 ? SFDAE_METHOD_BDF : SFDAE_METHOD_RADAU;
    const sfdae_options options = options_with(power_of_ten(random, -8.0, -4.0), method);
    ASSERT_EQ(status_beyond(create, point, options), SFDAE_CHARACTERISTICS_CHANGED) << "seed " << seed;
    if (!fails_nearby) continue;
    point.width = power_of_ten(random, -9.0, -3.0);
    EXPECT_LT(status_beyond(create, point, options), SFDAE_OK) << "seed " << seed << ", width " << point.width;
  }
}

TEST(UnevaluatedPoints, DoNotHideChangesOfLinearProblems) { expect_named(linear_solver, true); }
// Steps end exactly at the singular point in some of these runs.
TEST(UnevaluatedPoints, AtTheEndsOfStepsAreChangesOfNonlinearProblems) { expect_named(nonlinear_solver, false); }

// x1' = -x1 / 10, 0 = x2 - sin(omega t): steps are as long as x1 allows, over many periods of x2. f fails within
// `width` of `center`.
struct FastComponent {
  double omega = 1.0, center = 0.0, width = 0.0;

  static int E(double, int order, double* E, void*) {
    if (order == 0) E[0] = 1.0;
    return 0;
  }
  static int A(double, int order, double* A, void*) {
    if (order == 0) A[0] = -0.1, A[3] = 1.0;
    return 0;
  }
  static int f(double t, int order, double* f, void* user) {
    const auto& self = *static_cast<const FastComponent*>(user);
    f[1] = -std::pow(self.omega, order) * sine(self.omega * t, order);
    return std::fabs(t - self.center) < self.width ? 1 : 0;
  }
  sfdae_solver* solver(const sfdae_options& options) {
    sfdae_linear_problem problem;
    sfdae_linear_problem_init(&problem, sizeof problem);
    problem.num_equations = problem.num_unknowns = 2;
    problem.E = E;
    problem.A = A;
    problem.f = f;
    problem.constant_E = problem.constant_A = 1;
    problem.user = this;
    sfdae_solver* solver = nullptr;
    EXPECT_EQ(sfdae_create_linear(&solver, &problem, &options), SFDAE_OK);
    return solver;
  }
};

// Zeros of x2 - level; g fails near some times.
struct Crossings {
  double level = 0.0;
  std::vector<double> centers = {};
  double width = 0.0;
  static int g(double t, const double* x, const double*, double* g, void* user) {
    const auto& self = *static_cast<const Crossings*>(user);
    g[0] = x[1] - self.level;
    return std::any_of(self.centers.begin(), self.centers.end(),
                       [&](double center) { return std::fabs(t - center) < self.width; })
               ? 1
               : 0;
  }
};

struct Step {
  double t, h;
};

void note_steps(sfdae_options& options, std::vector<Step>& steps) {
  options.monitor = [](const sfdae_progress* progress, void* user) {
    static_cast<std::vector<Step>*>(user)->push_back({progress->t, progress->step});
    return 0;
  };
  options.monitor_user = &steps;
}

const Step& any_of(const std::vector<Step>& steps, Random& random) {
  return steps[static_cast<std::size_t>(random.integer(0, static_cast<int>(steps.size()) - 1))];
}

// The number of events until the run ends with the status; steps: those that it takes.
int count_events(FastComponent& problem, sfdae_options options, Crossings& crossings, std::vector<Step>& steps,
                 int& status) {
  note_steps(options, steps);
  sfdae_solver* solver = problem.solver(options);
  std::vector<double> x = {1.0, 0.0}, xdot(2);
  double t = 0.0;
  EXPECT_EQ(sfdae_set_events(solver, 1, Crossings::g, nullptr, &crossings), SFDAE_OK);
  EXPECT_EQ(sfdae_start(solver, 0.0, 10.0, x.data(), xdot.data()), SFDAE_OK);
  int events = 0;
  while ((status = sfdae_advance(solver, 10.0, &t, x.data(), xdot.data())) == SFDAE_EVENT) ++events;
  sfdae_destroy(&solver);
  return events;
}

// g fails exactly where the search of a step measures how accurate values by the polynomial are.
TEST(UnevaluatedPoints, DoNotHideEvents) {
  int ended = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    Random random(seed);
    FastComponent problem{random.real(1.0, 8.0)};
    Crossings crossings{random.real(-0.95, 0.95)};
    const int method = random.integer(0, 1) == 0 ? SFDAE_METHOD_BDF : SFDAE_METHOD_RADAU;
    const sfdae_options options = options_with(power_of_ten(random, -7.0, -3.0), method);
    int status = 0;
    std::vector<Step> steps;
    const int all = count_events(problem, options, crossings, steps, status);
    ASSERT_EQ(status, SFDAE_OK) << seed;
    for (int k = 0; k < 10; ++k) {
      const Step step = any_of(steps, random);
      crossings.centers = {step.t - 0.4 * step.h, step.t - 0.73 * step.h, step.t - 0.17 * step.h};
      crossings.width = 1e-3 * std::fabs(step.h);
      std::vector<Step> others;
      const int events = count_events(problem, options, crossings, others, status);
      crossings.centers.clear();
      if (status < 0) ++ended;
      else EXPECT_EQ(events, all) << "seed " << seed << ", step to " << step.t;
    }
  }
  EXPECT_GT(ended, 0);
}

struct Recorded {
  int status;
  double accuracy, error;  // as the solution says; of x2
};

Recorded record(FastComponent& problem, double tol, std::vector<Step>& steps) {
  sfdae_options options = options_with(tol);
  note_steps(options, steps);
  sfdae_solver* solver = problem.solver(options);
  sfdae_solution* solution = nullptr;
  EXPECT_EQ(sfdae_create_solution(&solution), SFDAE_OK);
  EXPECT_EQ(sfdae_record_solution(solver, solution), SFDAE_OK);
  std::vector<double> x = {1.0, 0.0}, xdot(2);
  double t = 0.0, end = 0.0;
  EXPECT_EQ(sfdae_start(solver, 0.0, 10.0, x.data(), xdot.data()), SFDAE_OK);
  Recorded recorded{sfdae_advance(solver, 10.0, &t, x.data(), xdot.data()), 0.0, 0.0};
  EXPECT_EQ(sfdae_get_solution_range(solution, nullptr, nullptr, &end), SFDAE_OK);
  EXPECT_EQ(sfdae_get_solution_accuracy(solution, &recorded.accuracy, nullptr), SFDAE_OK);
  for (double at = 0.0; at <= end; at += 0.002) {
    EXPECT_EQ(sfdae_evaluate_solution(solution, at, x.data(), nullptr), SFDAE_OK);
    recorded.error = std::max(recorded.error, std::fabs(x[1] - std::sin(problem.omega * at)));
  }
  sfdae_destroy_solution(&solution);
  sfdae_destroy(&solver);
  return recorded;
}

// What is recorded of a step of BDF within which f fails is right, or its accuracy says that it may not be.
TEST(UnevaluatedPoints, AreTakenForInaccurateOnesInSolutions) {
  int inaccurate = 0, runs = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    Random random(seed);
    FastComponent problem{random.real(1.0, 8.0)};
    const double tol = power_of_ten(random, -7.0, -3.0), limit = 100.0 * tol;
    // Steps that are a period of x2 long hide it from the polynomials.
    std::vector<Step> steps, others;
    if (record(problem, tol, steps).error > limit) continue;
    const Step step = any_of(steps, random);
    problem.center = step.t - 0.5 * step.h, problem.width = (0.5 - 1e-9) * step.h;
    const Recorded recorded = record(problem, tol, others);
    if (recorded.status == SFDAE_OK) ++runs;
    if (recorded.accuracy > 1.0) ++inaccurate;
    else EXPECT_LE(recorded.error, limit) << "seed " << seed << ", step to " << step.t;
  }
  EXPECT_GT(inaccurate, 0);
  EXPECT_GT(runs, 50);
}

// x1' = -lambda (x1 - sin omega t) + omega cos omega t, 0 = x2 - sin omega t: x1 = x2. f fails between two times, but
// for one in between.
struct FollowedSine {
  double lambda, omega, from = 1e9, to = -1e9, but = 0.0;

  static int E(double, int order, double* E, void*) {
    if (order == 0) E[0] = 1.0;
    return 0;
  }
  static int A(double, int order, double* A, void* user) {
    if (order == 0) A[0] = -static_cast<const FollowedSine*>(user)->lambda, A[3] = 1.0;
    return 0;
  }
  static int f(double t, int order, double* f, void* user) {
    const auto& self = *static_cast<const FollowedSine*>(user);
    const auto derivative = [&](int k) { return std::pow(self.omega, k) * sine(self.omega * t, k); };
    f[0] = derivative(order + 1) + self.lambda * derivative(order);
    f[1] = -derivative(order);
    return t > self.from && t < self.to && t != self.but ? 1 : 0;
  }
};

// Where the stages of a step to an output fail, all that is left is a polynomial that is not accurate enough.
TEST(UnevaluatedPoints, DoNotSpoilOutputsWithinSteps) {
  int failed = 0, right = 0;
  for (unsigned seed = 0; seed < 600; ++seed) {
    Random random(seed);
    FollowedSine problem{power_of_ten(random, 0.0, 2.0), random.real(0.5, 4.0)};
    sfdae_linear_problem description;
    sfdae_linear_problem_init(&description, sizeof description);
    description.num_equations = description.num_unknowns = 2;
    description.E = FollowedSine::E;
    description.A = FollowedSine::A;
    description.f = FollowedSine::f;
    description.user = &problem;
    const double tol = power_of_ten(random, -9.0, -5.0);
    sfdae_options options = options_with(tol, SFDAE_METHOD_RADAU);
    options.min_stages = options.max_stages = 2 * random.integer(1, 3) + 1;
    sfdae_solver* solver = nullptr;
    ASSERT_EQ(sfdae_create_linear(&solver, &description, &options), SFDAE_OK);
    std::vector<double> x(2), xdot(2);
    double t = 0.0;
    ASSERT_EQ(sfdae_start(solver, 0.0, 100.0, x.data(), xdot.data()), SFDAE_OK);
    for (int steps = random.integer(1, 12); steps > 0; --steps)
      ASSERT_EQ(sfdae_step(solver, 100.0, &t, x.data(), xdot.data()), SFDAE_STEP_TAKEN);
    sfdae_statistics statistics;
    sfdae_statistics_init(&statistics, sizeof statistics);
    sfdae_get_statistics(solver, &statistics);
    problem.to = statistics.t_internal;
    problem.from = problem.to - statistics.last_step;
    problem.but = problem.to - random.real(0.05, 0.95) * statistics.last_step;
    const int status = sfdae_interpolate(solver, problem.but, x.data(), xdot.data());
    if (status == SFDAE_CALLBACK_FAILED) {
      ++failed;
    } else {
      ASSERT_EQ(status, SFDAE_OK);
      EXPECT_NEAR(x[0], std::sin(problem.omega * problem.but), 20.0 * tol) << "seed " << seed;
      ++right;
    }
    sfdae_destroy(&solver);
  }
  EXPECT_GT(failed, 10);
  EXPECT_GT(right, 10);
}

}  // namespace
