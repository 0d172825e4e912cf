// SPDX-License-Identifier: BSD-3-Clause
// Jets that are found fulfil the equations and their total derivatives; where none exists, the failure names what
// remains.
#include "starts/jet_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "matrix_checks.h"
#include "nonlinear_examples.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

using sfdae_test::NonlinearExample;
using sfdae_test::rounding;
using sfdae_test::size;

struct Example {
  std::string name;
  sfdae_test::RecordPointer record;
  double t;
  std::vector<double> x;  // consistent
  int mu, d;
};

std::vector<double> values_of(const std::vector<sfdae_test::Jet>& jets) {
  std::vector<double> x;
  for (const auto& jet : jets) x.push_back(jet[0]);
  return x;
}

std::vector<Example> examples() {
  const double c = std::cos(0.6), s = std::sin(0.6), v = 0.7, g = sfdae_test::Pendulum::gravity;
  std::vector<Example> all;
  all.push_back({"pendulum", sfdae_test::record_of_pendulum(), 0.0, {s, -c, v * c, v * s, v * v + g * c}, 2, 2});
  for (const char* name : {"torus", "robot_arm"}) {
    const auto& p = sfdae_test::formula_problem(name);
    all.push_back({name, sfdae_test::record_of_formulas(name), 0.3, values_of(p.exact(0.3, 0)), p.data.values.mu,
                   p.data.values.d});
  }
  all.push_back({"redundant", sfdae_test::record_with_redundant_equation(), 1.0, {0.5, 0.5}, 0, 1});
  all.push_back({"free", sfdae_test::record_with_free_component(), 0.0, {2.0, 4.0, 0.3}, 0, 1});
  all.push_back({"rising", sfdae_test::record_with_rising_rank(), 0.5, {std::sin(0.5), std::sin(0.5), 0.3}, 0, 1});
  return all;
}

Jet jet_of(double t, const std::vector<double>& x) {
  Jet jet;
  jet.t = t;
  jet.n = static_cast<int>(x.size());
  jet.x = x;
  return jet;
}

// max |F_k|, k = 0..level, relative to |F_x| |x_j|, |F_x'| |j x_j| summed up, at least 1.
double relative_residual(NonlinearProblem& problem, const Jet& jet, int level) {
  const std::size_t m = size(problem.m()), n = size(problem.n());
  std::vector<double> F(m * size(level + 1));
  EXPECT_EQ(problem.residuals(jet.t, jet.x.data(), level, F.data()).status, SFDAE_OK);
  TaylorData data;
  const NonlinearProblem::Scaling plain{1.0, RowScaling::common, nullptr, nullptr};
  EXPECT_EQ(problem.linearize(jet.t, jet.x.data(), {level, level, level}, plain, data).status, SFDAE_OK);
  double worst = 0.0;
  for (int k = 0; k <= level; ++k)
    for (std::size_t i = 0; i < m; ++i) {
      double terms = 1.0;
      for (int l = 0; l <= k; ++l)
        for (std::size_t j = 0; j < n; ++j)
          terms +=
              (std::fabs(data.E(l)(static_cast<int>(i), static_cast<int>(j))) * (k - l + 1) *
                   std::fabs(jet.column(k - l + 1)[j]) +
               std::fabs(data.A(l)(static_cast<int>(i), static_cast<int>(j))) * std::fabs(jet.column(k - l)[j])) /
              data.row_scale[i];
      const double residual = std::fabs(F[i + m * size(k)]);
      worst = std::max(worst, std::isnan(residual) ? INFINITY : residual / terms);
    }
  return worst;
}

std::vector<double> disturbed(std::vector<double> x, double amount, std::uint64_t seed) {
  const std::vector<double> random = sfdae_test::random_vector(static_cast<int>(x.size()), seed);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += amount * random[i] * std::max(std::fabs(x[i]), 0.1);
  return x;
}

void solve_levels(JetSolver& solver, Jet& jet, int highest) {
  for (int level = 0; level <= highest; ++level) solver.solve(jet, level);
}

// What a failing call reports, "" and SFDAE_OK if it does not fail.
struct Report {
  int status = SFDAE_OK;
  std::string message;
};
template <class Call>
Report report_of(Call call) {
  try {
    call();
  } catch (const Failure& failure) {
    return {failure.status(), failure.what()};
  }
  return {};
}

}  // namespace

TEST(Jet, ShiftKeepsThePolynomial) {
  Jet jet = jet_of(0.5, sfdae_test::random_vector(2 * 6, 3));
  jet.n = 2;
  jet.order = 5;
  const auto value = [](const Jet& at, int i, double t) {
    double sum = 0.0;
    for (int k = at.order; k >= 0; --k) sum = sum * (t - at.t) + at.column(k)[i];
    return sum;
  };
  Jet moved = jet;
  moved.shift(-0.8);
  EXPECT_EQ(moved.t, 0.5 - 0.8);
  for (int i = 0; i < 2; ++i)
    for (double t : {-1.0, -0.3, 0.5, 0.9}) EXPECT_NEAR(value(moved, i, t), value(jet, i, t), rounding(32)) << t;
}

TEST(JetSolver, FulfilsTheEquationsAndTheirTotalDerivatives) {
  for (const Example& e : examples())
    for (double amount : {0.0, 1e-6, 0.05, 0.5})
      for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        SCOPED_TRACE(e.name + ", off by " + std::to_string(amount) + ", seed " + std::to_string(seed));
        NonlinearExample example(e.record);
        const std::vector<double> guess = disturbed(e.x, amount, seed);
        const Units units;
        Jet jet = jet_of(e.t, guess);
        JetSolver solver(*example.problem, units);
        const Report report = report_of([&] { solve_levels(solver, jet, e.mu); });
        ASSERT_EQ(report.status, SFDAE_OK) << report.message;
        EXPECT_LE(relative_residual(*example.problem, jet, e.mu), rounding(10 * jet.n));
        const std::vector<double> x(jet.x.data(), jet.x.data() + jet.n);
        EXPECT_LE(sfdae_test::distance(x, e.x), amount == 0.0 ? 1e-9 : INFINITY);
      }
}

// The jets of exact solutions that are unique: d = 0 leaves no choice, from any guess nearby.
TEST(JetSolver, FindsTheOnlySolutionThereIs) {
  const auto& p = sfdae_test::formula_problem("robot_arm");
  const auto exact = p.exact(0.3, 1);
  NonlinearExample example(sfdae_test::record_of_formulas("robot_arm"));
  Jet jet = jet_of(0.3, disturbed(values_of(exact), 0.02, 4));
  const Units units;
  JetSolver solver(*example.problem, units);
  solve_levels(solver, jet, 4);
  // The smallest pivot of the array is about 1e-4.
  for (std::size_t i = 0; i < exact.size(); ++i) EXPECT_NEAR(jet.column(0)[i], exact[i][0], 1e4 * rounding(8)) << i;
}

TEST(JetSolver, DoesNotTouchFixedComponents) {
  const Example e = examples().front();
  for (double amount : {0.01, 0.2, 0.5}) {
    NonlinearExample example(e.record);
    std::vector<double> guess = disturbed(e.x, amount, 9);
    guess[0] = 0.5;
    guess[2] = -0.4;
    Jet jet = jet_of(e.t, guess);
    const Units units;
    JetSolver solver(*example.problem, units);
    solver.set_fixed({1, 0, 1, 0, 0});
    const Report report = report_of([&] { solve_levels(solver, jet, 2); });
    ASSERT_EQ(report.status, SFDAE_OK) << report.message;
    EXPECT_EQ(jet.x[0], 0.5);
    EXPECT_EQ(jet.x[2], -0.4);
    EXPECT_LE(relative_residual(*example.problem, jet, 2), rounding(50));
    EXPECT_NEAR(std::fabs(jet.x[1]), std::sqrt(0.75), rounding(5));
  }
}

// x = 2 lies outside of the circle: equation 4, its position, remains.
TEST(JetSolver, NamesWhatRemainsWhereFixedComponentsAreImpossible) {
  const Example e = examples().front();
  NonlinearExample example(e.record);
  std::vector<double> guess = e.x;
  guess[0] = 2.0;
  Jet jet = jet_of(e.t, guess);
  const Units units;
  JetSolver solver(*example.problem, units);
  solver.set_fixed({1, 0, 0, 0, 0});
  const Report report = report_of([&] { solve_levels(solver, jet, 2); });
  EXPECT_EQ(report.status, SFDAE_NO_CONSISTENT_VALUES);
  EXPECT_NE(report.message.find(" equation 4 by "), std::string::npos) << report.message;
  EXPECT_EQ(jet.x[0], 2.0);
}

// 0 = x^2 + 1 has no solution at all, 0 = x1, 0 = x1 - t contradict each other at t = 1 by 1, or in the first
// derivative.
TEST(JetSolver, NamesTheDerivativeThatCannotBeFulfilled) {
  sfdae_test::Recording square(1), contradiction(2);
  const auto no_square = square.finish({square.x[0] * square.x[0] + 1.0});
  const auto no_rate =
      contradiction.finish({contradiction.x[0] * contradiction.x[0],
                            contradiction.x[0] * (1.0 + contradiction.x[1] * 0.0) - contradiction.t});
  const Units units;
  for (double guess : {0.0, 1.0, -40.0}) {
    NonlinearExample example(no_square);
    Jet jet = jet_of(0.0, {guess});
    JetSolver solver(*example.problem, units);
    const Report report = report_of([&] { solver.solve(jet, 0); });
    EXPECT_EQ(report.status, SFDAE_NO_CONSISTENT_VALUES) << guess;
    EXPECT_NE(report.message.find(" equation 0 by "), std::string::npos) << report.message;
  }
  NonlinearExample example(no_rate);
  Jet jet = jet_of(0.0, {0.0, 1.0});
  JetSolver solver(*example.problem, units);
  solver.solve(jet, 0);
  Report report;
  for (int level = 1; level <= 2 && report.status == SFDAE_OK; ++level)
    report = report_of([&] { solver.solve(jet, level); });
  EXPECT_EQ(report.status, SFDAE_NO_CONSISTENT_VALUES);
  EXPECT_NE(report.message.find("derivative "), std::string::npos) << report.message;
}

// sqrt(x - 1) = 0.1 from x = 0, where it cannot be evaluated.
TEST(JetSolver, TellsThatTheEquationsCannotBeEvaluatedAtTheGuess) {
  sfdae_test::Recording r(1);
  NonlinearExample example(r.finish({sqrt(r.x[0] - 1.0) - 0.1}));
  const Units units;
  JetSolver solver(*example.problem, units);
  Jet outside = jet_of(0.0, {0.0}), inside = jet_of(0.0, {3.0});
  EXPECT_EQ(report_of([&] { solver.solve(outside, 0); }).status, SFDAE_NOT_FINITE);
  EXPECT_EQ(report_of([&] { solver.solve(inside, 0); }).status, SFDAE_OK);
  EXPECT_NEAR(inside.x[0], 1.01, rounding(10));
}

// 0 = x1 - 1e9 t, 0 = x2 + x1^2 / 2 at t = 0: x1' = 1e9 is a coefficient of the derivative of the second equation,
// and makes no error of x1 in the first one small.
TEST(JetEquations, MeasureEveryResidualByItsOwnEquation) {
  sfdae_test::Recording r(2);
  NonlinearExample example(r.finish({r.x[0] - 1e9 * r.t, r.x[1] + 0.5 * r.x[0] * r.x[0]}));
  const Units units;
  for (double error : {0.0, 1e-3}) {
    Jet jet = jet_of(0.0, {error, -0.5 * error * error});
    jet.set_order(2);
    jet.column(1)[0] = 1e9;
    jet.column(1)[1] = -1e9 * error;
    JetEquations equations(*example.problem, units);
    equations.linearize(jet, 1, 1.0);
    EXPECT_NEAR(equations.norm(), error, rounding(2));
    EXPECT_EQ(equations.is_converged(jet, 1e-9), error == 0.0);
  }
}

// Units of the unknowns are an aid, not part of the answer.
TEST(JetSolver, FulfilsTheEquationsInOtherUnitsOfTheUnknowns) {
  const Example e = examples().front();
  NonlinearExample example(e.record);
  const Units units({1.0, 0.125, 64.0, 1.0, 1024.0});
  Jet jet = jet_of(e.t, disturbed(e.x, 0.1, 2));
  JetSolver solver(*example.problem, units);
  solve_levels(solver, jet, 2);
  EXPECT_LE(relative_residual(*example.problem, jet, 2), rounding(50));
}

// Pivots that vanish on the manifold only are hard to tell: what cannot be told has to be named.
TEST(ConsistentJets, SupplyTheIndexAnalysisFromGuesses) {
  for (const Example& e : examples())
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      SCOPED_TRACE(e.name + ", seed " + std::to_string(seed));
      NonlinearExample example(e.record);
      const Report report = report_of([&] { example.analyze(e.t, e.t + 1.0, disturbed(e.x, 0.05, seed)); });
      if (e.name == "rising" && report.status == SFDAE_RANK_UNCLEAR) continue;
      ASSERT_EQ(report.status, SFDAE_OK) << report.message;
      EXPECT_EQ(example.analysis.values.mu, e.mu);
      EXPECT_EQ(example.analysis.values.d, e.d);
      // Where pivots vanish with the residuals convergence is linear at the end.
      EXPECT_LE(relative_residual(*example.problem, example.jet, e.mu),
                (e.name == "rising" ? 100.0 : 1.0) * rounding(10 * example.jet.n));
    }
}

// x' = 1e6 (2 - x), exp(y) = 1 + x, from x = 1: by the polynomial of the first jet y is 5e4 after 0.1, where exp(y)
// overflows.
TEST(ConsistentJets, StartFromValuesAloneWherePolynomialsLeadTooFar) {
  const auto record = sfdae::core::record_equations(
      [](sfdae_record*, sfdae_expression, const sfdae_expression* x, const sfdae_expression* xdot,
         sfdae_expression* F, void*) {
        const sfdae::Expression a(x[0]), b(x[1]), slope(xdot[0]);
        F[0] = (slope - 1e6 * (2.0 - a)).c();
        F[1] = (exp(b) - 1.0 - a).c();
        return 0;
      },
      2, 2, nullptr);
  NonlinearExample example(record);
  const std::vector<double> x = {1.0, std::log(2.0)};
  ConsistentJets jets(*example.problem, 0.0, x.data(), {});
  EXPECT_NEAR(jets.jet_at(0.0, 1).column(1)[1], 5e5, 1e-6 * 5e5);
  const Jet there = jets.jet_at(0.1, 1);
  EXPECT_EQ(there.t, 0.1);
  EXPECT_LE(relative_residual(*example.problem, there, 1), rounding(100));
}

// Away from the first point the jet is that of the solution: torus through its exact values.
TEST(ConsistentJets, StayOnTheSolutionAtPointsNearby) {
  const auto& p = sfdae_test::formula_problem("torus");
  NonlinearExample example(sfdae_test::record_of_formulas("torus"));
  const std::vector<double> x = values_of(p.exact(0.3, 0));
  ConsistentJets jets(*example.problem, 0.3, x.data(), {});
  jets.jet_at(0.3, 2);
  for (double h : {1e-3, -1e-3}) {
    const Jet there = jets.jet_at(0.3 + h, 2);
    EXPECT_LE(relative_residual(*example.problem, there, 2), rounding(70));
    // The polynomial of order 2 misses terms of h^3 |x'''| / 6, |x| about 15.
    const std::vector<double> exact = values_of(p.exact(0.3 + h, 0));
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(there.x[i], exact[i], 15.0 * std::fabs(h * h * h)) << i;
  }
  EXPECT_EQ(jets.jet_at(0.3, 2).t, 0.3);
}

}  // namespace sfdae::core
