// SPDX-License-Identifier: BSD-3-Clause
//
// Sparsity patterns through the C++ interface.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace {

// x0' = -x1, 0 = x1^3 + x1 - x0: log x1 + 3/2 x1^2 + t stays.
sfdae::NonlinearProblem cubic(int matrices) {
  sfdae::NonlinearProblem problem(2, 2);
  problem.F_x_pattern = {{0, 1, 3}, {1, 0, 1}};
  problem.F_xdot_pattern = {{0, 1, 1}, {0}};
  problem.matrices = matrices;
  problem.total_derivative = [matrices](double, int order, sfdae::ConstMatrixRef d, sfdae::TotalDerivatives to) {
    if (order > 0) return SFDAE_ORDER_NOT_AVAILABLE;
    const double v = d(1, 0), slope = 3 * v * v + 1;
    to.F[0] = d(0, 1) + v;
    to.F[1] = v * v * v + v - d(0, 0);
    EXPECT_TRUE(!to.F_x || matrices != SFDAE_MATRICES_DIFFERENCES);
    if (!to.F_x) return 0;
    if (matrices == SFDAE_MATRICES_DENSE) {
      to.F_xdot(0, 0) = 1, to.F_x(0, 1) = 1, to.F_x(1, 0) = -1, to.F_x(1, 1) = slope;
      return 0;
    }
    EXPECT_EQ(to.F_x.rows(), 3);
    EXPECT_EQ(to.F_x.columns(), 1);
    to.F_xdot(0, 0) = 1, to.F_x(0, 0) = -1, to.F_x(1, 0) = 1, to.F_x(2, 0) = slope;
    return 0;
  };
  return problem;
}

TEST(SparsityPattern, AllFormsGiveTheSolution) {
  for (const int matrices : {SFDAE_MATRICES_DENSE, SFDAE_MATRICES_COMPRESSED, SFDAE_MATRICES_DIFFERENCES}) {
    sfdae::Options options;
    options.structure = SFDAE_STRUCTURE_REQUIRED;
    options.difference_derivatives = true;
    options.rtol = options.atol = 1e-8;
    sfdae::Solver solver(cubic(matrices), options);
    sfdae::Point point{0.0, {2.0, 1.0}, {}};
    EXPECT_EQ(solver.start(point, 1.0), SFDAE_OK);
    EXPECT_EQ(solver.advance(1.0, point), SFDAE_OK);
    const double v = point.x[1];
    EXPECT_NEAR(std::log(v) + 1.5 * v * v + point.t, 1.5, 1e-6) << matrices;
  }
}

TEST(SparsityPattern, WrongNumbersOfColumnsAreRefused) {
  sfdae::NonlinearProblem problem = cubic(SFDAE_MATRICES_COMPRESSED);
  problem.F_x_pattern.col_start.pop_back();
  try {
    const sfdae::Solver solver(problem);
    FAIL();
  } catch (const sfdae::Error& error) {
    EXPECT_EQ(error.status(), SFDAE_ILLEGAL_ARGUMENT);
    EXPECT_NE(std::string(error.what()).find("F_x_pattern.col_start has 2 entries, not 3"), std::string::npos)
        << error.what();
  }
}

TEST(SparsityPattern, EntriesOfLinearProblemsAreViewsOfOneColumn) {
  sfdae::LinearProblem problem(2, 2);  // x0' = -x0, 0 = x0 - x1
  problem.E_pattern = {{0, 1, 1}, {0}};
  problem.A_pattern = {{0, 2, 3}, {0, 1, 1}};
  problem.matrices = SFDAE_MATRICES_COMPRESSED;
  problem.constant_E = problem.constant_A = true;
  problem.E = [](double, int, sfdae::MatrixRef E) { E(0, 0) = 1; };
  problem.A = [](double, int, sfdae::MatrixRef A) { A(0, 0) = -1, A(1, 0) = 1, A(2, 0) = -1; };
  for (const int structure : {SFDAE_STRUCTURE_OFF, SFDAE_STRUCTURE_REQUIRED}) {
    sfdae::Options options;
    options.structure = structure;
    sfdae::Solver solver(problem, options);
    sfdae::Point point{0.0, {1.0, 1.0}, {}};
    solver.start(point, 1.0);
    solver.advance(1.0, point);
    for (const double x : point.x) EXPECT_NEAR(x, std::exp(-1.0), 1e-5);
  }
}

}  // namespace
