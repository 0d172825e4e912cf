// SPDX-License-Identifier: BSD-3-Clause
// Gradients where steps are made again from checkpoints: the same in every bit as with all steps kept, whatever
// happened on the way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "family_run.h"
#include "sensitivity_problems.h"
#include "sfdae/sfdae.hpp"
#include "solver_options.h"
#include "transformed_system.h"

namespace {

using sfdae::Expression;
using sfdae::Matrix;
using sfdae::Point;
using sfdae_test::driven_by_a_table;
using sfdae_test::pendulum_with_friction;
using sfdae_test::scaled_count;
using sfdae_test::solver_options;
using sfdae_test::TransformedSystem;
using sfdae_test::van_der_pol;

using Times = std::vector<double>;
constexpr long kept[] = {2, 40, 100, 100000};

struct Wanted {
  std::vector<std::string> parameters;
  Matrix directions;
};

void ask(sfdae::Solver& solver, const Wanted& wanted, long max_kept_steps) {
  sfdae::Sensitivities sensitivities;
  sensitivities.parameters = wanted.parameters;
  sensitivities.directions = wanted.directions;
  sensitivities.adjoint = true;
  sensitivities.max_kept_steps = max_kept_steps;
  solver.set_sensitivities(sensitivities);
}

struct Outcome {
  std::vector<double> gradients, x;
  sfdae::Statistics statistics;
  sfdae::SensitivityStatistics work;
};

void append(std::vector<double>& to, const Matrix& matrix) {
  for (int j = 0; j < matrix.columns(); ++j)
    for (int i = 0; i < matrix.rows(); ++i) to.push_back(matrix(i, j));
}

Matrix weights_for(int n, int columns, int seed) {
  Matrix weights(n, columns);
  for (int j = 0; j < columns; ++j)
    for (int i = 0; i < n; ++i) weights(i, j) = std::sin(1.0 + 2.3 * i + 1.7 * j + seed);
  return weights;
}

// Two functionals of all times.
void add_gradient(sfdae::Solver& solver, const Times& times, Outcome& outcome) {
  append(outcome.gradients, solver.gradient(times, weights_for(solver.num_unknowns(), 2 * int(times.size()), 1)));
}

// What a run with so many steps kept comes to. Each is one with a solver of its own.
using Run = std::function<Outcome(long max_kept_steps)>;

// Pieces change nothing, in x neither.
void expect_same(const Run& run) {
  const Outcome all = run(0);
  EXPECT_EQ(all.work.checkpoints, 0);
  EXPECT_EQ(all.work.repeated_steps, 0);
  for (double value : all.gradients) EXPECT_TRUE(std::isfinite(value));
  for (long max_kept_steps : kept) {
    SCOPED_TRACE("max_kept_steps = " + std::to_string(max_kept_steps));
    const Outcome some = run(max_kept_steps);
    EXPECT_EQ(some.gradients, all.gradients);
    EXPECT_EQ(some.x, all.x);
    EXPECT_EQ(some.statistics.steps, all.statistics.steps);
    EXPECT_EQ(some.statistics.error_failures, all.statistics.error_failures);
    EXPECT_EQ(some.statistics.other_failures, all.statistics.other_failures);
    EXPECT_EQ(some.statistics.reductions, all.statistics.reductions);
    EXPECT_EQ(some.statistics.factorizations, all.statistics.factorizations);
    EXPECT_EQ(some.statistics.evaluations_F, all.statistics.evaluations_F);
    EXPECT_EQ(some.statistics.linearizations, all.statistics.linearizations);
    // Pieces take at least as much memory as a checkpoint.
    if (all.work.kept_steps > std::max(2 * max_kept_steps, 100L)) {
      EXPECT_GT(some.work.repeated_steps, 0);
    }
    if (max_kept_steps > all.work.kept_steps * 2 + 2) {
      EXPECT_EQ(some.work.repeated_steps, 0);
    }
  }
}

void finish(sfdae::Solver& solver, const Point& point, Outcome& outcome) {
  outcome.x.insert(outcome.x.end(), point.x.begin(), point.x.end());
  outcome.statistics = solver.statistics();
  outcome.work = solver.sensitivity_statistics();
}

class Pieces : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, Pieces,
                         testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU, SFDAE_METHOD_AUTOMATIC));

TEST_P(Pieces, GiveTheSameGradientsForAnyIndex) {
  for (double tolerance : {1e-3, 1e-8}) {
    for (unsigned seed = 1, last = static_cast<unsigned>(scaled_count(20, 3)); seed <= last; ++seed) {
      const TransformedSystem system(seed);
      SCOPED_TRACE("seed " + std::to_string(seed) + ", mu = " + std::to_string(system.mu()) + ", tolerance " +
                   std::to_string(tolerance));
      expect_same([&](long max_kept_steps) {
        sfdae::Solver solver(system.problem(), solver_options(tolerance, GetParam()));
        ask(solver, {{"p", "q"}, {}}, max_kept_steps);
        Outcome outcome;
        Point point;
        Matrix unused;
        system.exact(0.0, point.x, unused);
        solver.start(point, 2.0);
        for (double t : {0.7, 1.3}) solver.advance(t, point);
        add_gradient(solver, {0.7, 1.3}, outcome);
        // The integration goes on as if nobody had asked, and gradients may be asked for again.
        solver.advance(2.0, point);
        add_gradient(solver, {0.0, 1.3, 2.0}, outcome);
        add_gradient(solver, {0.01, 0.5, 0.7, 1.3, 1.42, 1.9}, outcome);
        finish(solver, point, outcome);
        return outcome;
      });
    }
  }
}

TEST_P(Pieces, RepeatStepsThatFail) {
  long failures = 0;
  expect_same([&](long max_kept_steps) {
    sfdae::Solver solver(van_der_pol(), solver_options(1e-5, GetParam()));
    ask(solver, {{"p"}, {}}, max_kept_steps);
    Outcome outcome;
    Point point{0.0, {2.0, 0.0, 0.0}, {}};
    solver.start(point, 60.0);
    solver.advance(60.0, point);
    add_gradient(solver, {0.0, 60.0}, outcome);
    finish(solver, point, outcome);
    failures = outcome.statistics.error_failures + outcome.statistics.other_failures;
    return outcome;
  });
  EXPECT_GT(failures, 0);
}

// Events, many outputs, points within steps, single steps, options that change on the way, a monitor that stops.
TEST_P(Pieces, DoNotDependOnWhatElseIsAsked) {
  expect_same([&](long max_kept_steps) {
    sfdae::Options options = solver_options(1e-6, GetParam());
    long calls = 0;
    options.monitor = [&calls](const sfdae_progress&) { return ++calls % 7 == 0; };
    sfdae::Solver solver(van_der_pol(), options);
    ask(solver, {{"p", ""}, weights_for(3, 2, 2)}, max_kept_steps);
    long events = 0, evaluations = 0;
    solver.set_events(1, [&](double, auto x, auto, auto g) {
      ++evaluations;
      g[0] = x[0] - 0.3;
    });
    Outcome outcome;
    Point point{0.0, {2.0, 0.0, 0.0}, {}};
    solver.start(point, 40.0);
    const Point inside{0.0, std::vector<double>(3), std::vector<double>(3)};
    for (int k = 1; k <= 60; ++k) {
      const double tout = 40.0 * k / 60.0;
      for (int status = SFDAE_EVENT; status != SFDAE_OK;) {
        status = k % 5 == 0 ? solver.step(tout, point) : solver.advance(tout, point);
        if (status == SFDAE_EVENT) ++events;
        const sfdae::Statistics at = solver.statistics();
        Point within = inside;
        within.t = at.t_internal - 0.4 * at.last_step;
        solver.interpolate(within);
      }
      if (k == 20) {
        options.rtol = options.atol = 1e-4;
        solver.set_options(options);
      }
      if (k == 30) {
        options.max_step = 0.05;
        options.max_order = 3;
        solver.set_options(options);
      }
    }
    const long before = evaluations, monitored = calls;
    add_gradient(solver, {0.0, 20.0, 40.0}, outcome);
    EXPECT_EQ(evaluations, before);
    EXPECT_EQ(calls, monitored);
    EXPECT_GE(events, 2);
    finish(solver, point, outcome);
    return outcome;
  });
}

// At each kink integrations start anew.
TEST_P(Pieces, KeepToTheirSideOfKinks) {
  const sfdae::NonlinearProblem problem = driven_by_a_table();
  expect_same([&](long max_kept_steps) {
    sfdae::Solver solver(problem, solver_options(1e-7, GetParam()));
    ask(solver, {{"p", "q"}, {}}, max_kept_steps);
    Outcome outcome;
    Point point{0.0, {0.5, 0.2, 0.0}, {}};
    solver.start(point, 2.0);
    solver.advance(2.0, point);
    add_gradient(solver, {0.0, 2.0}, outcome);
    finish(solver, point, outcome);
    return outcome;
  });
}

TEST_P(Pieces, AreThoseOfMechanicalSystemsBackwardInTime) {
  const sfdae::MultibodyProblem system = pendulum_with_friction();
  expect_same([&](long max_kept_steps) {
    sfdae::Solver solver(system, solver_options(1e-6, GetParam()));
    ask(solver, {{"m", "friction", "length"}, {}}, max_kept_steps);
    Outcome outcome;
    Point point{1.0, {0.7, 0.0, 0.0, 0.0, 0.0}, {}};
    solver.start(point, -2.0);
    solver.advance(-2.0, point);
    add_gradient(solver, {1.0, -2.0}, outcome);
    finish(solver, point, outcome);
    return outcome;
  });
}

// A function of the user's: x e^-x, or another one; it may refuse to be evaluated, or stop.
struct Decay {
  double factor = 1.0;
  long calls = 0, refused_call = 0, stopped_call = 0;
  static int call(int order, const double* x, double* derivatives, void* user) {
    Decay& self = *static_cast<Decay*>(user);
    if (++self.calls == self.refused_call) return 1;
    if (self.stopped_call > 0 && self.calls >= self.stopped_call) return -1;
    const double sign = order % 2 == 0 ? 1.0 : -1.0;
    derivatives[0] = self.factor * sign * (x[0] - order) * std::exp(-x[0]);
    return 0;
  }
};

int decay(sfdae_record* record, sfdae_expression, const sfdae_expression* x, const sfdae_expression* xdot,
          sfdae_expression* F, void* user) {
  const sfdae_expression k = sfdae_parameter(record, "k", 1.3), f = sfdae_external("decay", Decay::call, 1, x, user);
  F[0] = sfdae_add(xdot[0], sfdae_multiply(k, f));
  F[1] = sfdae_subtract(sfdae_add(x[1], sfdae_multiply(x[0], x[0])), sfdae_multiply(k, f));
  return 0;
}

class DecaySolver {
 public:
  DecaySolver(int method, Decay& function, long max_kept_steps) {
    sfdae_nonlinear_problem problem;
    sfdae_nonlinear_problem_init(&problem, sizeof problem);
    problem.num_equations = problem.num_unknowns = 2;
    problem.equations = decay;
    problem.user = &function;
    sfdae_options options;
    sfdae_options_init(&options, sizeof options);
    options.rtol = options.atol = 1e-6;
    options.method = method;
    EXPECT_EQ(sfdae_create_nonlinear(&solver_, &problem, &options), SFDAE_OK);
    const char* const name = "k";
    sfdae_sensitivity_options how;
    sfdae_sensitivity_options_init(&how, sizeof how);
    how.adjoint = 1;
    how.max_kept_steps = max_kept_steps;
    EXPECT_EQ(sfdae_set_sensitivities(solver_, 1, &name, nullptr, &how), SFDAE_OK);
    EXPECT_EQ(sfdae_start(solver_, 0.0, 6.0, x, nullptr), SFDAE_OK) << sfdae_message(solver_);
  }
  DecaySolver(const DecaySolver&) = delete;
  DecaySolver& operator=(const DecaySolver&) = delete;
  ~DecaySolver() { sfdae_destroy(&solver_); }
  int advance(double tout) { return sfdae_advance(solver_, tout, &t, x, nullptr); }
  int gradient(double at, double& result) {
    const double weights[] = {1.0, -0.5};
    return sfdae_get_gradient(solver_, 1, &at, 1, weights, &result);
  }
  operator sfdae_solver*() { return solver_; }
  double t = 0.0, x[2] = {2.0, 0.0};

 private:
  sfdae_solver* solver_ = nullptr;
};

TEST_P(Pieces, DoNotRepeatFailuresOfFunctions) {
  for (long refused : {60, 100, 150, 151, 152, 203}) {
    SCOPED_TRACE("call " + std::to_string(refused));
    Decay function;
    double expected = 0.0, end = 0.0;
    for (long max_kept_steps : {0L, 2L, 4L, 10L}) {
      function.calls = 0;
      function.refused_call = refused;
      DecaySolver solver(GetParam(), function, max_kept_steps);
      ASSERT_EQ(solver.advance(6.0), SFDAE_OK) << sfdae_message(solver);
      EXPECT_GT(function.calls, refused);
      function.refused_call = 0;
      double gradient = 0.0;
      ASSERT_EQ(solver.gradient(6.0, gradient), SFDAE_OK) << sfdae_message(solver);
      if (max_kept_steps == 0) expected = gradient, end = solver.x[0];
      EXPECT_EQ(gradient, expected);
      EXPECT_EQ(solver.x[0], end);
    }
  }
}

// A call of a function ends the integration's; the next one tries the step again.
TEST_P(Pieces, GoOnAfterCallsThatWereStopped) {
  Decay function;
  double expected = 0.0;
  for (long max_kept_steps : {0L, 2L, 4L, 10L}) {
    function.calls = 0;
    DecaySolver solver(GetParam(), function, max_kept_steps);
    int stops = 0;
    for (int k = 1; k <= 20; ++k) {
      function.stopped_call = function.calls + 5 + k % 7;
      for (int status = SFDAE_CALLBACK_STOPPED; status != SFDAE_OK;) {
        status = solver.advance(0.3 * k);
        ASSERT_TRUE(status == SFDAE_OK || status == SFDAE_CALLBACK_STOPPED) << sfdae_message(solver);
        if (status != SFDAE_OK) ++stops, function.stopped_call = 0;
      }
    }
    function.stopped_call = 0;
    double gradient = 0.0;
    ASSERT_EQ(solver.gradient(6.0, gradient), SFDAE_OK) << sfdae_message(solver);
    EXPECT_GT(stops, 3);
    if (max_kept_steps == 0) expected = gradient;
    EXPECT_EQ(gradient, expected);
  }
}

// Functions that return something else are noticed, and nothing is lost.
TEST_P(Pieces, AreRefusedWhereFunctionsHaveChanged) {
  Decay function;
  DecaySolver solver(GetParam(), function, 2);
  ASSERT_EQ(solver.advance(6.0), SFDAE_OK);
  double first = 0.0, again = -7.0;
  ASSERT_EQ(solver.gradient(6.0, first), SFDAE_OK);
  function.factor = 1.0 + 1e-9;
  EXPECT_EQ(solver.gradient(6.0, again), SFDAE_CALLBACK_FAILED);
  EXPECT_NE(std::string(sfdae_message(solver)).find("cannot be made again"), std::string::npos);
  function.factor = 1.0;
  function.stopped_call = function.calls + 40;
  EXPECT_EQ(solver.gradient(6.0, again), SFDAE_CALLBACK_STOPPED) << sfdae_message(solver);
  function.stopped_call = 0;
  sfdae_request_stop(solver);
  EXPECT_EQ(solver.gradient(6.0, again), SFDAE_STOPPED);
  EXPECT_EQ(again, -7.0);
  ASSERT_EQ(solver.gradient(6.0, again), SFDAE_OK) << sfdae_message(solver);
  EXPECT_EQ(first, again);
}

// Two pieces of a third of the steps, and checkpoints.
TEST_P(Pieces, BoundWhatIsKept) {
  constexpr int n = 60;
  sfdae::NonlinearProblem problem(n, n);
  problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
    const Expression width = sfdae::parameter(t, "width", 0.1);
    for (int i = 0; i < n; ++i) {
      const Expression left = i > 0 ? x[i - 1] : sin(3.0 * t), right = i + 1 < n ? x[i + 1] : 0.0 * t;
      F[i] = (1.0 + 0.1 * x[i]) * xdot[i] - (left - 2.0 * x[i] + right) / (width * width);
    }
  };
  double bytes[2];
  for (long max_kept_steps : {0L, 60L}) {
    sfdae::Solver solver(problem, solver_options(1e-7, GetParam()));
    ask(solver, {{"width"}, {}}, max_kept_steps);
    Point point{0.0, std::vector<double>(n, 0.3), {}};
    solver.start(point, 40.0);
    solver.advance(40.0, point);
    const sfdae::SensitivityStatistics work = solver.sensitivity_statistics();
    bytes[max_kept_steps > 0] = work.kept_bytes;
    if (max_kept_steps == 0) continue;
    // Pieces that begin where the method changes may be so short that their steps are kept.
    EXPECT_LE(work.kept_steps, 40);
    EXPECT_GE(double(work.checkpoints), double(solver.statistics().steps) / 30.0 - 3.0);
  }
  EXPECT_LE(bytes[1], 0.7 * bytes[0]);
}

}  // namespace
