// Small problems with one parameter that is a unit of measurement.
// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include <cmath>

#include "extent.h"
#include "tally.h"

namespace campaign {
namespace {

enum Family { unit_of_unknown_family = 400, rotated_chain_family };

// All may be refused.
constexpr double any_share = 1.0;

Coefficients constant_coefficients(const DenseMatrix& E, const DenseMatrix& A) {
  return [E, A](double, int, TaylorMatrix& E_series, TaylorMatrix& A_series) {
    for (std::size_t k = 0; k < E.entries.size(); ++k) {
      E_series.entries[k][0] = E.entries[k];
      A_series.entries[k][0] = A.entries[k];
    }
  };
}

LinearProblem constant_problem(const DenseMatrix& E, const DenseMatrix& A, const CharacteristicValues& values) {
  LinearProblem problem;
  problem.m = E.rows;
  problem.n = E.columns;
  problem.values = values;
  problem.units = Units(problem.m, problem.n);
  problem.constant = true;
  problem.coefficients = constant_coefficients(E, A);
  return problem;
}

// x' = -x, multiplied by [1 r; 1 -r]: regular for every r > 0, r is the unit of x_2.
LinearProblem decay(double r) {
  DenseMatrix E(2, 2), A(2, 2);
  E(0, 0) = E(1, 0) = 1.0;
  E(0, 1) = r;
  E(1, 1) = -r;
  for (std::size_t k = 0; k < 4; ++k) A.entries[k] = -E.entries[k];
  return constant_problem(E, A, {0, 2, 0, 0, 0});
}

// 1e-4, ..., 1e-18, then others.
constexpr int decades = 15;
double unit_of_unknown(int number, RandomNumbers& random) {
  return number < decades ? std::pow(10.0, -4 - number) : random.log_uniform(1e-18, 1e-4);
}

TEST(SmallCampaign, TinyUnitOfOneUnknownLosesNoEquation) {
  Tally tally("x' = -x times [1 r; 1 -r]");
  for (int number : problem_numbers(1000, decades)) {
    RandomNumbers random(unit_of_unknown_family, static_cast<std::uint64_t>(number));
    const LinearProblem problem = decay(unit_of_unknown(number, random));
    tally.add(number, problem, analyze(problem));
  }
  tally.expect_at_most(any_share);
}

// Rounding errors of the rows are 1e-16 / r in x_2.
TEST(SmallCampaign, SmallUnitOfOneUnknownIsIntegrated) {
  Tally tally("x' = -x times [1 r; 1 -r], integrated");
  for (int number : problem_numbers(300, decades)) {
    RandomNumbers random(unit_of_unknown_family, static_cast<std::uint64_t>(number));
    const double r = unit_of_unknown(number, random);
    if (r < 1e-7) continue;
    const LinearProblem problem = decay(r);
    ExactSolution exact;
    exact.x = [](double t) { return std::vector<double>{std::exp(-t), std::exp(-t)}; };
    exact.sizes = {1.0, 1.0};
    const IntegrationSettings settings;
    const IntegrationOutcome outcome = integrate(problem, exact, settings);
    tally.add(number, problem, outcome, error_fits(exact, settings.tolerance, outcome));
  }
  tally.expect_at_most(0.0);
}

// T R J S x' = R S x with rotations R, S and one chain J of three: mu = 2, a = 3 in every unit of time T.
TEST(SmallCampaign, ChainKeepsItsIndexInSlowUnitsOfTime) {
  Tally tally("rotated chain of three in slow units of time");
  for (int number : problem_numbers(1000, 100)) {
    RandomNumbers random(rotated_chain_family, static_cast<std::uint64_t>(number));
    const DenseMatrix R = random_orthogonal(3, random), S = random_orthogonal(3, random);
    DenseMatrix J(3, 3);
    J(0, 1) = J(1, 2) = 1.0;
    LinearProblem problem = constant_problem(product(product(R, J), S), product(R, S), {2, 0, 3, 0, 0});
    problem.units.time = random.log_uniform(1.0, 1e9);
    problem.constant = random.chance(0.5);  // declared so
    problem.end = random.log_uniform(1e-9, 1e2);
    tally.add(number, problem, analyze(problem));
  }
  tally.expect_at_most(0.03);
}

}  // namespace
}  // namespace campaign
