// SPDX-License-Identifier: BSD-3-Clause
// The classical derivative array, block by block, and the projectors of its theory.
#include "reduction/derivative_array.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <memory>
#include <utility>
#include <vector>

#include "analyzed_problem.h"
#include "c_api/problems.h"
#include "linalg/dense.h"
#include "matrix_checks.h"
#include "problem/failure.h"
#include "testset_linear.h"

namespace sfdae::core {

namespace {

using sfdae_test::AnalyzedProblem;
using sfdae_test::distance;
using sfdae_test::FamilyProblem;
using sfdae_test::largest;
using sfdae_test::orthonormality_defect;
using sfdae_test::outside_range;
using sfdae_test::rounding;
using sfdae_test::size;
using sfdae_test::sum;
using sfdae_test::times;
using sfdae_test::transposed;
using Family = std::shared_ptr<const sfdae_test::LinearFamily>;

Matrix derivative(const sfdae_test::LinearFamily& family, char which, double t, int k) {
  Matrix value(family.m(), family.n());
  if (which == 'E') family.E(t, k, value.data());
  else family.A(t, k, value.data());
  return value;
}

}  // namespace

// Two differentiations by hand: E x' = A x + f,
//   E x'' + (E' - A) x' = A' x + f',   E x''' + (2 E' - A) x'' + (E'' - 2 A') x' = A'' x + f''.
TEST(DerivativeArray, OfLevelTwoHasTheBlocksOfTwoDifferentiations) {
  const Family family = sfdae_test::kron(5, 1);
  FamilyProblem callbacks(family);
  LinearProblem problem(functions_of(callbacks.problem));
  const double t = 0.3;
  const int m = 5;
  const DerivativeArray array = derivative_array(problem, t, 2);
  ASSERT_EQ(array.M.rows(), 15);
  ASSERT_EQ(array.M.cols(), 15);
  const Matrix E = derivative(*family, 'E', t, 0), E1 = derivative(*family, 'E', t, 1);
  const Matrix E2 = derivative(*family, 'E', t, 2), A = derivative(*family, 'A', t, 0);
  const Matrix A1 = derivative(*family, 'A', t, 1), A2 = derivative(*family, 'A', t, 2);
  const Matrix zero(m, m);
  const Matrix expected[3][3] = {
      {E, zero, zero}, {sum(1.0, E1, -1.0, A), E, zero}, {sum(1.0, E2, -2.0, A1), sum(2.0, E1, -1.0, A), E}};
  const Matrix expected_N[3] = {A, A1, A2};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      EXPECT_LE(distance(array.M.view().block(i * m, j * m, m, m), expected[i][j]), rounding(1)) << i << ", " << j;
    EXPECT_EQ(distance(array.N.view().block(i * m, 0, m, m), expected_N[i]), 0.0);
    std::vector<double> f(size(m));
    family->f(t, i, f.data());
    for (int row = 0; row < m; ++row) EXPECT_EQ(array.g[size(i * m + row)], f[size(row)]);
  }
}

// Level 4, block (4, 2): C(4, 2) E'' - C(4, 3) A'.
TEST(DerivativeArray, HasBinomialCoefficients) {
  const Family family = sfdae_test::kron(3, 1);
  FamilyProblem callbacks(family);
  LinearProblem problem(functions_of(callbacks.problem));
  const DerivativeArray array = derivative_array(problem, 0.3, 4);
  const Matrix expected = sum(6.0, derivative(*family, 'E', 0.3, 2), -4.0, derivative(*family, 'A', 0.3, 1));
  EXPECT_LE(distance(array.M.view().block(12, 6, 3, 3), expected), rounding(1) * 10.0);
}

TEST(DerivativeArray, PassesOnTroubleOfCallbacks) {
  FamilyProblem callbacks((Family(sfdae_test::kron(3, 1))));
  callbacks.hooks.status = sfdae_test::return_at_call(2, -1);
  LinearProblem problem(functions_of(callbacks.problem));
  try {
    derivative_array(problem, 0.3, 1);
    FAIL() << "no failure";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.status(), SFDAE_CALLBACK_STOPPED);
  }
}

// Z2^T M = 0, Z3^T [M N] = 0, [Z2 Z3] complete, A2 T2 = 0, Z1 spans the range of E T2; all orthonormal.
TEST(Projectors, HaveThePropertiesThatDefineThem) {
  std::vector<std::pair<Family, double>> cases;
  for (sfdae_test::LinearTestProblem& p : sfdae_test::linear_testset()) {
    const double t = p.t0 + 0.3 * (p.tf - p.t0);
    cases.emplace_back(std::move(p.family), t);
  }
  for (int mu = 0; mu <= 3; ++mu) cases.emplace_back(Family(sfdae_test::kron(8, mu)), 0.4);
  cases.emplace_back(Family(sfdae_test::kron(9, 1, 1.0, 2)), 0.4);
  cases.emplace_back(Family(sfdae_test::chain(4, 1, 2.0, 100.0)), 0.4);
  for (auto& [family, t] : cases) {
    SCOPED_TRACE(family->name());
    AnalyzedProblem p(family, t, t + 0.5);
    ASSERT_EQ(p.system.move_to(t), PointStatus::ok);
    const Projectors q = projectors(p.problem, p.system.analysis(), p.settings, t);
    const int mu = family->values().mu, m = family->m();
    const DerivativeArray array = derivative_array(p.problem, t, mu);
    ASSERT_EQ(q.Z1.rows(), m);
    ASSERT_EQ(q.Z1.cols(), family->values().d);
    ASSERT_EQ(q.Z2.rows(), (mu + 1) * m);
    ASSERT_EQ(q.Z2.cols(), family->values().a);
    ASSERT_EQ(q.Z3.cols(), p.system.analysis().v_hat);
    ASSERT_EQ(q.T2.rows(), family->n());
    ASSERT_EQ(q.T2.cols(), family->n() - family->values().a);

    // Rounding errors of null vectors, in the units of the array.
    const double size_of_array = std::max({1.0, largest(array.M), largest(array.N)});
    const double tolerance = rounding(10 * (mu + 1) * m) * size_of_array /
                             (p.system.quality().smallest_pivot * p.system.quality().kept_constraints);
    for (const Matrix* basis : {&q.Z1, &q.Z2, &q.Z3, &q.T2})
      EXPECT_LE(orthonormality_defect(*basis), rounding((mu + 1) * m));
    EXPECT_LE(largest(times(transposed(q.Z2), q.Z3)), rounding((mu + 1) * m));
    EXPECT_LE(largest(times(transposed(q.Z2), array.M)), tolerance);
    EXPECT_LE(largest(times(transposed(q.Z3), array.M)), tolerance);
    EXPECT_LE(largest(times(transposed(q.Z3), array.N)), tolerance);
    const Matrix A2 = times(transposed(q.Z2), array.N);
    EXPECT_LE(largest(times(A2, q.T2)), tolerance);
    EXPECT_LE(outside_range(q.Z1, times(derivative(*family, 'E', t, 0), q.T2)), tolerance);

    // 0 = A2 x + Z2^T g for the exact solution.
    const Matrix x = sfdae_test::column(p.exact(t));
    const Matrix residual = sum(1.0, times(A2, x), 1.0, times(transposed(q.Z2), sfdae_test::column(array.g)));
    EXPECT_LE(largest(residual), tolerance * std::max(1.0, largest(x)));
  }
}

// The classical and the staged way describe the same spaces.
TEST(Projectors, AreTheSameSpacesByBothReductions) {
  for (int mu : {0, 1, 2}) {
    const Family family = sfdae_test::kron(7, mu);
    AnalysisSettings by_svd;
    by_svd.by_svd = true;
    std::fenv_t environment;  // singular values without vectors: LAPACK divides by zero on purpose
    std::feholdexcept(&environment);
    AnalyzedProblem staged(family, 0.4, 1.0), classical(family, 0.4, 1.0, LeadingTerm::automatic, by_svd);
    ASSERT_EQ(staged.system.move_to(0.4), PointStatus::ok);
    ASSERT_EQ(classical.system.move_to(0.4), PointStatus::ok);
    const Projectors one = projectors(staged.problem, staged.system.analysis(), staged.settings, 0.4),
                     other = projectors(classical.problem, classical.system.analysis(), classical.settings, 0.4);
    const double tolerance = rounding(10 * (mu + 1) * 7) /
                             (staged.system.quality().smallest_pivot * classical.system.quality().smallest_pivot *
                              staged.system.quality().kept_constraints);
    EXPECT_LE(outside_range(one.Z2, other.Z2), tolerance);
    EXPECT_LE(outside_range(one.T2, other.T2), tolerance);
    EXPECT_LE(outside_range(one.Z1, other.Z1), tolerance);
    std::fesetenv(&environment);
  }
}

// A row scaled by 1e-8 has large entries in Z2 for it; Z2 is orthonormal all the same and belongs to the array as
// the user wrote it.
TEST(Projectors, BelongToTheUnscaledArray) {
  const Family family = sfdae_test::scaled_row(1e-8).family;
  AnalyzedProblem p(family, 0.4, 1.0);
  ASSERT_EQ(p.system.move_to(0.4), PointStatus::ok);
  const Projectors q = projectors(p.problem, p.system.analysis(), p.settings, 0.4);
  const DerivativeArray array = derivative_array(p.problem, 0.4, 0);
  EXPECT_LE(largest(times(transposed(q.Z2), array.M)), rounding(3));
  EXPECT_LE(outside_range(q.Z1, times(derivative(*family, 'E', 0.4, 0), q.T2)), rounding(3) * 1e-8);
}

}  // namespace sfdae::core
