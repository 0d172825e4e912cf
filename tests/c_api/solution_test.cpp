// SPDX-License-Identifier: BSD-3-Clause
//
// The solution over a whole run: recorded, evaluated, saved and loaded.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace {

using sfdae::Solution;

// x2' = x1,  0 = x1^2 + x2^2 - 1:  x = (cos t, sin t); mu = 0.
sfdae::NonlinearProblem circle() {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [](const auto&, auto x, auto xdot, auto F) {
    F[0] = xdot[1] - x[0];
    F[1] = x[0] * x[0] + x[1] * x[1] - 1.0;
  };
  return problem;
}

sfdae::MultibodyProblem swinging_pendulum() {
  sfdae::MultibodyProblem problem(2, 1);
  problem.equations = [](const auto&, auto q, auto, auto to) {
    to.M(0, 0) = to.M(1, 1) = 1.0;
    to.f[1] = -9.81;
    to.g[0] = q[0] * q[0] + q[1] * q[1] - 1.0;
  };
  return problem;
}

sfdae::Options options_of(int method, double tol = 1e-7) {
  sfdae::Options options;
  options.method = method;
  options.rtol = options.atol = tol;
  return options;
}

// All points of a run, with outputs between steps, recorded or not.
template <class Problem>
std::vector<double> run(const Problem& problem, const sfdae::Options& options, const std::vector<double>& x,
                        Solution* solution) {
  sfdae::Solver solver(problem, options);
  if (solution != nullptr) solver.record(*solution);
  sfdae::Point point{0.0, x, {}};
  solver.start(point, 1.2);
  std::vector<double> all;
  for (double t : {0.3, 0.31, 1.2}) {
    solver.advance(t, point);
    all.insert(all.end(), point.x.begin(), point.x.end());
    all.insert(all.end(), point.xdot.begin(), point.xdot.end());
  }
  all.push_back(static_cast<double>(solver.statistics().steps));
  return all;
}

TEST(Solution, LeavesTheIntegrationAsItIs) {
  for (int output : {SFDAE_OUTPUT_CONSISTENT, SFDAE_OUTPUT_INTERPOLATED})
    for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU, SFDAE_METHOD_AUTOMATIC}) {
      sfdae::Options options = options_of(method);
      options.output = output;
      Solution solution, mechanical;
      EXPECT_EQ(run(circle(), options, {1.0, 0.0}, nullptr), run(circle(), options, {1.0, 0.0}, &solution));
      const std::vector<double> hanging = {1.0, 0.0, 0.0, 0.0, 0.0};
      EXPECT_EQ(run(swinging_pendulum(), options, hanging, nullptr),
                run(swinging_pendulum(), options, hanging, &mechanical));
    }
}

TEST(Solution, IsThatOfTheProblemBetweenSteps) {
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (double tol : {1e-4, 1e-7, 1e-10}) {
      Solution solution;
      sfdae::Solver solver(circle(), options_of(method, tol));
      solver.record(solution);
      sfdae::Point point{0.0, {1.0, 0.0}, {}};
      solver.start(point, 1.2);
      solver.advance(1.2, point);
      EXPECT_EQ(solution.num_unknowns(), 2);
      EXPECT_EQ(solution.start(), 0.0);
      EXPECT_EQ(solution.end(), solver.statistics().t_internal);
      double error = 0.0, slope_error = 0.0;
      for (double t = 0.0; t <= 1.2; t += 0.001) {
        const sfdae::Point at = solution(t);
        error = std::max({error, std::fabs(at.x[0] - std::cos(t)), std::fabs(at.x[1] - std::sin(t))});
        slope_error = std::max(slope_error, std::fabs(at.xdot[1] - std::cos(t)));
      }
      // That of the integration, about, and half a tolerance of interpolation with what polynomials leave out.
      EXPECT_LE(error, 30.0 * tol) << method << ", " << tol;
      EXPECT_LE(slope_error, 3e3 * tol + 1e-9) << method << ", " << tol;
    }
}

TEST(Solution, GoesBackward) {
  Solution solution;
  sfdae::Solver solver(circle(), options_of(SFDAE_METHOD_BDF));
  solver.record(solution);
  sfdae::Point point{0.0, {1.0, 0.0}, {}};
  solver.start(point, -1.0);
  solver.advance(-1.0, point);
  EXPECT_NEAR(solution(-0.777).x[1], std::sin(-0.777), 1e-5);
  EXPECT_THROW(solution(0.1), sfdae::Error);
  // Another direction begins anew.
  solver.start(point, 1.0);
  solver.advance(0.0, point);
  EXPECT_EQ(solution.start(), -1.0);
  EXPECT_NEAR(solution(-0.5).x[1], std::sin(-0.5), 1e-5);
}

// Of one unknown that is algebraic, from 0 to 1.
Solution solution_of(const sfdae::NonlinearProblem& problem, std::size_t n = 1) {
  Solution solution;
  sfdae::Solver solver(problem, options_of(SFDAE_METHOD_BDF, 1e-5));
  solver.record(solution);
  sfdae::Point point{0.0, std::vector<double>(n, 0.0), {}};
  solver.start(point, 1.0);
  solver.advance(1.0, point);
  return solution;
}

// Without differential equations steps are as long as the interval; a kink at 1/3, where halving helps.
TEST(Solution, FollowsAlgebraicEquations) {
  sfdae::NonlinearProblem problem(1, 1);
  problem.equations = [](const auto& t, auto x, auto, auto F) { F[0] = x[0] - sin(40.0 * t) - abs(t - 1.0 / 3.0); };
  const Solution solution = solution_of(problem);
  for (double t = 0.0; t <= 1.0; t += 1e-3) {
    if (std::fabs(t - 1.0 / 3.0) < 2e-3) continue;
    EXPECT_NEAR(solution(t).x[0], std::sin(40.0 * t) + std::fabs(t - 1.0 / 3.0), 2e-5) << t;
  }
}

// A ball on the floor, h'' = -1, with v -> -v: values at the impact are those after it.
TEST(Solution, JumpsWhereTheRunWasStartedAnew) {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [](const auto&, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - x[1];
    F[1] = xdot[1] + 1.0;
  };
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    Solution solution;
    sfdae::Solver solver(problem, options_of(method));
    solver.set_events(1, [](double, auto x, auto, auto g) { g[0] = x[0]; }, {-1});
    solver.record(solution);
    sfdae::Point point{0.0, {0.5, 0.0}, {}};
    solver.start(point, 2.5);
    ASSERT_EQ(solver.advance(2.5, point), SFDAE_EVENT);
    EXPECT_NEAR(point.t, 1.0, 1e-6);
    const double impact = point.t;
    EXPECT_GE(solution.end(), impact);
    point.x[1] = -point.x[1];
    solver.start(point, 2.5);
    solver.advance(2.5, point);
    EXPECT_NEAR(solution(impact).x[1], 1.0, 1e-5);
    EXPECT_NEAR(solution(std::nextafter(impact, 0.0)).x[1], -1.0, 1e-5);
    EXPECT_NEAR(solution(0.4).x[0], 0.5 - 0.08, 1e-5);
    EXPECT_NEAR(solution(1.5).x[0], 0.5 - 0.125, 1e-5);
    EXPECT_EQ(solution.start(), 0.0);
  }
}

Solution recorded() {
  Solution solution;
  run(circle(), options_of(SFDAE_METHOD_BDF, 1e-3), {1.0, 0.0}, &solution);
  return solution;
}

TEST(Solution, IsTheSameAfterLoading) {
  const Solution solution = recorded();
  const std::vector<double> saved = solution.save();
  const Solution loaded = Solution::load(saved);
  EXPECT_EQ(loaded.start(), solution.start());
  EXPECT_EQ(loaded.end(), solution.end());
  EXPECT_EQ(loaded.save(), saved);
  for (double t = 0.0; t <= 1.2; t += 0.01) {
    EXPECT_EQ(loaded(t).x, solution(t).x);
    EXPECT_EQ(loaded(t).xdot, solution(t).xdot);
  }
}

// A step function at 1/3, of an unknown: no polynomial of what is halved ten times at most holds it.
TEST(Solution, KnowsWhereItIsNotAccurate) {
  const auto accuracy_of = [](bool jumps) {
    sfdae::NonlinearProblem problem(2, 2);
    problem.equations = [=](const auto& t, auto x, auto xdot, auto F) {
      F[0] = x[0] - sin(t) - (jumps ? choose(x[1] - 1.0 / 3.0, 1.0, 0.0) : 0.0 * t);
      F[1] = xdot[1] - 1.0;
    };
    const Solution solution = solution_of(problem, 2);
    const Solution loaded = Solution::load(solution.save());
    EXPECT_EQ(loaded.accuracy().in_tolerances, solution.accuracy().in_tolerances);
    EXPECT_EQ(loaded.accuracy().t, solution.accuracy().t);
    return solution.accuracy();
  };
  EXPECT_LE(accuracy_of(false).in_tolerances, 0.3);
  const Solution::Accuracy jumping = accuracy_of(true);
  EXPECT_GT(jumping.in_tolerances, 100.0);
  EXPECT_LE(jumping.t, 1.0 / 3.0);
  EXPECT_GE(jumping.t, 1.0 / 3.0 - 1.0 / 1024.0 - 1e-12);
}

TEST(Solution, EndsWhereItIsCut) {
  for (double end : {0.8, -0.8}) {
    Solution solution;
    sfdae::Solver solver(circle(), options_of(SFDAE_METHOD_BDF));
    solver.record(solution);
    sfdae::Point point{0.0, {1.0, 0.0}, {}};
    solver.start(point, end);
    solver.advance(end, point);
    const double inside = 0.43 * end, before = solution(inside).x[1];
    EXPECT_THROW(solution.cut(-0.1 * end), sfdae::Error);
    EXPECT_THROW(solution.cut(2.0 * end), sfdae::Error);
    EXPECT_THROW(solution.cut(std::numeric_limits<double>::quiet_NaN()), sfdae::Error);
    EXPECT_EQ(solution(inside).x[1], before);
    solution.cut(inside);
    EXPECT_EQ(solution.end(), inside);
    EXPECT_EQ(solution(inside).x[1], before);
    EXPECT_THROW(solution(0.44 * end), sfdae::Error);
    EXPECT_EQ(Solution::load(solution.save()).end(), inside);
    solution.cut(0.0);
    EXPECT_THROW(solution.end(), sfdae::Error);
    EXPECT_THROW(solution.cut(0.0), sfdae::Error);
    EXPECT_THROW(solution.accuracy(), sfdae::Error);
    // The next steps begin anew.
    solver.advance(1.5 * end, point);
    EXPECT_NEAR(solution(1.45 * end).x[1], std::sin(1.45 * end), 1e-5);
  }
}

TEST(Solution, RefusesWhatIsDamaged) {
  const std::vector<double> saved = recorded().save();
  sfdae_solution* solution = nullptr;
  ASSERT_EQ(sfdae_create_solution(&solution), SFDAE_OK);
  ASSERT_EQ(sfdae_load_solution(solution, saved.data(), saved.size()), SFDAE_OK);
  for (std::size_t length = 0; length < saved.size(); ++length)
    EXPECT_EQ(sfdae_load_solution(solution, saved.data(), length), SFDAE_ILLEGAL_ARGUMENT) << length;
  const double damages[] = {
      0.0, -1.0, 1e300, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 12345.0};
  for (std::size_t place = 0; place < saved.size(); ++place)
    for (double damage : damages) {
      if (saved[place] == damage) continue;
      std::vector<double> damaged = saved;
      damaged[place] = damage;
      EXPECT_EQ(sfdae_load_solution(solution, damaged.data(), damaged.size()), SFDAE_ILLEGAL_ARGUMENT) << place;
    }
  // It is as before.
  std::size_t length = 0;
  ASSERT_EQ(sfdae_get_solution_length(solution, &length), SFDAE_OK);
  std::vector<double> kept(length);
  ASSERT_EQ(sfdae_save_solution(solution, kept.data(), length), SFDAE_OK);
  EXPECT_EQ(kept, saved);
  EXPECT_EQ(sfdae_save_solution(solution, kept.data(), length - 1), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(sfdae_destroy_solution(&solution), SFDAE_OK);
  EXPECT_THROW(Solution::load({}), sfdae::Error);
}

TEST(Solution, KnowsNothingAtFirst) {
  Solution solution;
  EXPECT_THROW(solution.start(), sfdae::Error);
  double x = 0.0;
  EXPECT_EQ(sfdae_evaluate_solution(solution.get(), 0.0, &x, nullptr), SFDAE_NOT_STARTED);
  EXPECT_EQ(sfdae_get_solution_range(solution.get(), nullptr, nullptr, nullptr), SFDAE_NOT_STARTED);
  const Solution loaded = Solution::load(solution.save());
  EXPECT_THROW(loaded.end(), sfdae::Error);
  Solution moved = std::move(solution);
  EXPECT_NE(moved.get(), nullptr);
}

TEST(Solution, RefusesNothingAndTimesOutside) {
  EXPECT_EQ(sfdae_create_solution(nullptr), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(sfdae_destroy_solution(nullptr), SFDAE_OK);
  EXPECT_EQ(sfdae_record_solution(nullptr, nullptr), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(sfdae_evaluate_solution(nullptr, 0.0, nullptr, nullptr), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(sfdae_get_solution_length(nullptr, nullptr), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(sfdae_save_solution(nullptr, nullptr, 0), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(sfdae_load_solution(nullptr, nullptr, 0), SFDAE_ILLEGAL_ARGUMENT);
  const Solution solution = recorded();
  double x[2] = {};
  for (double t : {-1e-9, 100.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_EQ(sfdae_evaluate_solution(solution.get(), t, x, nullptr), SFDAE_ILLEGAL_ARGUMENT) << t;
  EXPECT_EQ(sfdae_evaluate_solution(solution.get(), 0.0, nullptr, nullptr), SFDAE_ILLEGAL_ARGUMENT);
}

// One that is destroyed is not recorded any more, and a solver that is does no harm.
TEST(Solution, AndSolverLiveApart) {
  auto solution = std::make_unique<Solution>();
  sfdae::Point point{0.0, {1.0, 0.0}, {}};
  {
    sfdae::Solver solver(circle(), options_of(SFDAE_METHOD_BDF));
    solver.start(point, 1.2);
    solver.record(*solution);  // after the start
    solver.advance(0.3, point);
    Solution other;
    solver.record(other);
    solver.advance(0.6, point);
    EXPECT_GE(other.start(), 0.3);
    solver.stop_recording();
    solver.record(*solution);
    solution = std::make_unique<Solution>();
    EXPECT_EQ(solver.advance(0.9, point), SFDAE_OK);
    solver.record(*solution);
    solver.advance(1.2, point);
  }
  EXPECT_NEAR((*solution)(1.15).x[1], std::sin(1.15), 1e-5);
}

}  // namespace
