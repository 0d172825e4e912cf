// SPDX-License-Identifier: BSD-3-Clause
// Sensitivities of 1,000 random problems, linear and nonlinear ones of index 0 ... 3, against exact ones: 250 for each
// kind and method, of which scaled_count takes the first; and gradients of a functional by the adjoint.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "family_run.h"
#include "sfdae/sfdae.hpp"
#include "transformed_system.h"

namespace {

constexpr int count_of_each = 250;
constexpr double tolerance = 1e-9, largest_accepted = 1e-6;

class ManyRandomSensitivities : public testing::TestWithParam<int> {
 protected:
  // The largest error of S at the start and three later times, and of the gradient.
  template <class System>
  static double error_of(const System& system, int method) {
    sfdae::Options options;
    options.rtol = options.atol = tolerance;
    options.method = method;
    sfdae::Solver solver(system.problem(), options);
    sfdae::Point point;
    sfdae::Sensitivities wanted;
    wanted.parameters = {"p", "q"};
    system.exact(0.0, point.x, wanted.directions);
    solver.set_sensitivities(wanted);
    solver.start(point, 2.0);
    double error = sfdae_test::largest_error(solver.sensitivities(0.0).S, wanted.directions);
    for (double t : {0.7, 1.3, 2.0}) {
      solver.advance(t, point);
      std::vector<double> x;
      sfdae::Matrix exact;
      system.exact(t, x, exact);
      error = std::max(error, sfdae_test::largest_error(solver.sensitivities(t).S, exact));
    }
    return std::max(error, error_of_gradient(system, options, wanted));
  }

  // Of sum_k w_k^T S(t_k) by the adjoint, for the same points.
  template <class System>
  static double error_of_gradient(const System& system, const sfdae::Options& options, sfdae::Sensitivities wanted) {
    const std::vector<double> times = {0.0, 0.7, 1.3, 2.0};
    sfdae::Solver solver(system.problem(), options);
    wanted.adjoint = true;
    solver.set_sensitivities(wanted);
    sfdae::Point point;
    sfdae::Matrix weights(wanted.directions.rows(), 4), exact(2, 1);
    for (int k = 0; k < 4; ++k) {
      std::vector<double> x;
      sfdae::Matrix S;
      system.exact(times[std::size_t(k)], x, S);
      if (k == 0) point.x = x;
      for (int i = 0; i < weights.rows(); ++i) {
        weights(i, k) = std::cos(1.0 + i + 3.0 * k);
        for (int j = 0; j < 2; ++j) exact(j, 0) += weights(i, k) * S(i, j);
      }
    }
    solver.start(point, 2.0);
    for (int k = 1; k < 4; ++k) solver.advance(times[std::size_t(k)], point);
    return sfdae_test::largest_error(solver.gradient(times, weights), exact);
  }

  template <class System>
  static void expect_exact(unsigned first_seed, int method) {
    const int count = sfdae_test::scaled_count(count_of_each);
    int solved[4] = {0, 0, 0, 0};
    double largest = 0.0;
    for (unsigned seed = first_seed; seed < first_seed + unsigned(count); ++seed) {
      const System system(seed);
      SCOPED_TRACE("seed " + std::to_string(seed) + ", mu = " + std::to_string(system.mu()));
      try {
        const double error = error_of(system, method);
        EXPECT_LE(error, largest_accepted);
        largest = std::max(largest, error);
        ++solved[std::min(system.mu(), 3)];
      } catch (const sfdae::Error& error) {
        ADD_FAILURE() << error.what();
      }
    }
    RecordProperty("largest_error_in_tolerances", std::to_string(largest / tolerance));
    if (count < 40) return;
    for (int of_index : solved) EXPECT_GE(of_index, 1);
  }
};
INSTANTIATE_TEST_SUITE_P(Methods, ManyRandomSensitivities, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

// Other problems for each method.
TEST_P(ManyRandomSensitivities, AreExactForNonlinearProblems) {
  expect_exact<sfdae_test::TransformedSystem>(GetParam() == SFDAE_METHOD_BDF ? 1000 : 2000, GetParam());
}

TEST_P(ManyRandomSensitivities, AreExactForLinearProblems) {
  expect_exact<sfdae_test::LinearTransformedSystem>(GetParam() == SFDAE_METHOD_BDF ? 3000 : 4000, GetParam());
}

// With S in the error test of Radau, at tolerances for which it takes seven stages: 38 of 280 runs ended with a step of
// 1e-15, because S at the start of a step and at its stages differ by what iterations leave of x.
template <class System>
void expect_steps_to_end(unsigned first_seed) {
  const int count = sfdae_test::scaled_count(40);
  for (unsigned seed = first_seed; seed < first_seed + unsigned(count); ++seed)
    for (const double tol : {8e-9, 1e-9, 1e-10}) {
      const System system(seed);
      SCOPED_TRACE("seed " + std::to_string(seed) + ", tolerance " + std::to_string(tol));
      sfdae::Options options;
      options.rtol = options.atol = tol;
      options.method = SFDAE_METHOD_RADAU;
      options.max_steps = 3000;
      sfdae::Solver solver(system.problem(), options);
      sfdae::Sensitivities wanted;
      wanted.parameters = {"p", "q"};
      wanted.error_test = true;
      sfdae::Point point;
      system.exact(0.0, point.x, wanted.directions);
      solver.set_sensitivities(wanted);
      ASSERT_NO_THROW(solver.start(point, 2.0));
      ASSERT_NO_THROW(solver.advance(2.0, point)) << solver.message();
      std::vector<double> x;
      sfdae::Matrix exact;
      system.exact(2.0, x, exact);
      EXPECT_LE(sfdae_test::largest_error(solver.sensitivities(2.0).S, exact), 1e3 * tol + 1e-9);
    }
}

TEST(RadauWithSInTheErrorTest, ReachesTheEnd) {
  expect_steps_to_end<sfdae_test::TransformedSystem>(7000);
  expect_steps_to_end<sfdae_test::LinearTransformedSystem>(8000);
}

}  // namespace
