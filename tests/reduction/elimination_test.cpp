// SPDX-License-Identifier: BSD-3-Clause
// What the elimination carries holds for every solution, and it is all that is free of derivatives.
#include "reduction/elimination.h"

#include <gtest/gtest.h>

#include <cfenv>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "c_api/problems.h"
#include "family_problem.h"
#include "linalg/dense.h"
#include "matrix_checks.h"
#include "problem/linear_problem.h"
#include "random_taylor_data.h"
#include "testset_linear.h"
#include "transformed_pencil.h"

namespace sfdae::core {

namespace {

using sfdae_test::distance;
using sfdae_test::largest;
using sfdae_test::random_taylor_data;
using sfdae_test::rounding;
using sfdae_test::size;
using sfdae_test::times;
using sfdae_test::transposed;
using Family = std::shared_ptr<const sfdae_test::LinearFamily>;

TaylorData data_at(const Family& family, double t, int level, double tau = 0.0) {
  sfdae_test::FamilyProblem callbacks(family);
  LinearProblem problem(functions_of(callbacks.problem));
  TaylorData data;
  EXPECT_EQ(problem.evaluate(t, {level, level, level}, tau, data).status, SFDAE_OK);
  return data;
}

// M, N and g of the array in Taylor scaling, from the formula, and Z^T M = 0 as far as y_{last}, ... are eliminated.
struct Array {
  Matrix M, N, g;
};
Array array_of(const TaylorData& data, int level) {
  const int m = data.m, n = data.n;
  Array array{Matrix((level + 1) * m, (level + 1) * n), Matrix((level + 1) * m, n), Matrix((level + 1) * m, 1)};
  for (int i = 0; i <= level; ++i)
    for (int row = 0; row < m; ++row) {
      for (int col = 0; col < n; ++col) {
        for (int j = 1; j <= i + 1; ++j)
          array.M(i * m + row, (j - 1) * n + col) =
              data.E(i + 1 - j)(row, col) - (i - j >= 0 ? data.A(i - j)(row, col) / j : 0.0);
        array.N(i * m + row, col) = data.A(i)(row, col);
      }
      array.g(i * m + row, 0) = data.f(i)[row];
    }
  return array;
}

struct Elimination {
  Arena arena;
  Judge::Settings settings;
  std::vector<RankDecision> log;
  Judge judge;
  Matrix unit;
  Carried carried;

  Elimination(const TaylorData& data, int level, int last_stage = 1, bool by_svd = false)
      : settings{0.0, by_svd, NoiseModel::carried},
        judge(data, level, settings, &log),
        unit(identity((level + 1) * data.m)),
        carried(by_svd ? eliminate_by_svd(data, level, unit, judge, arena)
                       : eliminate(data, level, unit, last_stage, judge, arena)) {}
  double tolerance(const TaylorData& data, int level) const {
    // Multipliers up to 100, and errors eps |data| / p of null vectors.
    return rounding((level + 1) * (data.m + data.n)) * 100.0 * std::max(1.0, data.norm(level)) /
           judge.smallest_pivot();
  }
};

// LAPACK computes singular values without vectors by dividing by zero on purpose: no traps around it.
class NoTraps {
 public:
  NoTraps() { std::feholdexcept(&environment_); }
  ~NoTraps() { std::fesetenv(&environment_); }

 private:
  std::fenv_t environment_;
};

struct Case {
  Family family;
  double t;
  int level;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (sfdae_test::LinearTestProblem& p : sfdae_test::linear_testset()) {
    const int mu = p.family->values().mu;
    all.push_back({std::move(p.family), p.t0 + 0.3 * (p.tf - p.t0), mu});
  }
  for (int mu = 0; mu <= 3; ++mu) all.push_back({Family(sfdae_test::kron(8, mu)), 0.4, mu});
  all.push_back({Family(sfdae_test::kron(30, 2, 1.0, 2)), 0.4, 2});
  all.push_back({Family(sfdae_test::chain(6, 2)), 0.4, 2});
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Family family = sfdae_test::random_family(seed);
    all.push_back({family, 0.2, family->values().mu});
    if (family->values().mu > 0) all.push_back({family, 0.2, family->values().mu - 1});
  }
  return all;
}

}  // namespace

TEST(TaylorArray, HasTheBlocksOfTheFormula) {
  const TaylorData data = random_taylor_data(3, 2, 3, 2, 1);
  const Array expected = array_of(data, 3);
  const Matrix array = taylor_array(data, 3);
  ASSERT_EQ(array.rows(), 12);
  ASSERT_EQ(array.cols(), 10);
  EXPECT_LE(distance(array.view().columns(0, 8), expected.M), rounding(1));
  EXPECT_EQ(distance(array.view().columns(8, 2), expected.N), 0.0);
}

// Taylor coefficients of a solution fulfil M y = N x + g, y_j = j x_j tau^j: the array is that of the problem.
TEST(TaylorArray, HoldsForTheTaylorCoefficientsOfASolution) {
  for (int mu : {0, 2, 3}) {
    const Family family = sfdae_test::kron(7, mu);
    const auto& pencil = dynamic_cast<const sfdae_test::TransformedPencil&>(*family);
    const double t = 0.4;
    const int level = 3, n = family->n();
    const TaylorData data = data_at(family, t, level);
    sfdae_test::JetColumns x(1, n, level + 1);  // x = Q^-1 y
    for (int j = 0; j < n; ++j) {
      const sfdae_test::Jet component = sfdae_test::smooth_component(j + 1, t, level + 1);
      for (int k = 0; k <= level + 1; ++k) *x.at(j, k) = component[k];
    }
    multiply(x, pencil.Q(), sfdae_test::Factor::inverse_transposed, t);
    Matrix y((level + 1) * n, 1), x0(n, 1);
    for (int j = 0; j < n; ++j) {
      x0(j, 0) = *x.at(j, 0);
      for (int k = 1; k <= level + 1; ++k) y((k - 1) * n + j, 0) = k * *x.at(j, k) * std::pow(data.time_scale, k);
    }
    const Array array = array_of(data, level);
    const Matrix right = sfdae_test::sum(1.0, times(array.N, x0), 1.0, array.g);
    EXPECT_LE(distance(times(array.M, y), right),
              rounding((level + 2) * n) * std::max(1.0, data.norm(level)) * std::max(1.0, largest(y)));
  }
}

// The identity carried along becomes Z^T: Z^T M = 0, A^ = Z^T N, and no row of Z depends on others.
TEST(Elimination, AnnihilatesTheDerivativesAndKeepsAllOtherRows) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.family->name() + ", level " + std::to_string(c.level));
    const TaylorData data = data_at(c.family, c.t, c.level);
    const Elimination e(data, c.level);
    const Array array = array_of(data, c.level);
    const ConstView Zt = e.carried.rhs;
    ASSERT_EQ(Zt.rows, e.carried.rows);
    EXPECT_LE(largest(times(Zt, array.M)), e.tolerance(data, c.level));
    EXPECT_LE(distance(times(Zt, array.N), e.carried.constraints), e.tolerance(data, c.level));
    const std::vector<double> s = svd(Zt).s;
    EXPECT_TRUE(s.empty() || s.back() > 1e-4 * s.front());
    // As many rows as the left null space has dimensions.
    int rank = 0;
    for (const RankDecision& decision : e.log) rank += decision.rank;
    const int rank_of_M = (c.level + 1) * data.m - e.carried.rows;
    EXPECT_EQ(e.carried.rank_E * (c.level + 1) + rank - e.log[0].rank, rank_of_M);
  }
}

TEST(Elimination, CarriedRowsHoldForTheExactSolution) {
  for (const Case& c : cases()) {
    if (!c.family->has_exact()) continue;
    SCOPED_TRACE(c.family->name() + ", level " + std::to_string(c.level));
    const TaylorData data = data_at(c.family, c.t, c.level);
    const Judge::Settings settings;
    Judge judge(data, c.level, settings, nullptr);
    Arena arena;
    const Carried carried = eliminate(data, c.level, data.f_stack(c.level), 1, judge, arena);
    std::vector<double> x(size(data.n));
    c.family->exact(c.t, x.data(), nullptr);
    const Matrix residual = sfdae_test::sum(1.0, times(carried.constraints, sfdae_test::column(x)), 1.0, carried.rhs);
    const double scale = std::max({1.0, data.norm(c.level) * largest(x), data.norm_f(c.level)});
    EXPECT_LE(largest(residual),
              rounding((c.level + 1) * (data.m + data.n)) * 100.0 * scale / judge.smallest_pivot());
    EXPECT_EQ(carried.y.cols, 0);
  }
}

// Stopped before y_1, what is carried holds for (y_1, x) = (tau x', x): Y y_1 = A^ x + f^.
TEST(Elimination, StoppedBeforeTheLastStageHoldsForTheDerivativeToo) {
  for (int mu : {1, 2, 3}) {
    const Family family = sfdae_test::kron(8, mu);
    const double t = 0.4;
    const TaylorData data = data_at(family, t, mu + 1);
    const Judge::Settings settings;
    Judge judge(data, mu + 1, settings, nullptr);
    Arena arena;
    const Carried carried = eliminate(data, mu + 1, data.f_stack(mu + 1), 2, judge, arena);
    ASSERT_EQ(carried.y.cols, data.n);
    ASSERT_EQ(carried.y.rows, carried.rows);
    std::vector<double> x(size(data.n)), xdot(x);
    family->exact(t, x.data(), xdot.data());
    for (double& value : xdot) value *= data.time_scale;
    const Matrix left = times(carried.y, sfdae_test::column(xdot));
    const Matrix right = sfdae_test::sum(1.0, times(carried.constraints, sfdae_test::column(x)), 1.0, carried.rhs);
    EXPECT_LE(distance(left, right),
              rounding((mu + 2) * 16) * 100.0 * std::max(1.0, data.norm(mu + 1)) / judge.smallest_pivot());
  }
}

// Both ways carry the same row space: Z of each lies in the range of the other.
TEST(Elimination, AgreesWithTheSingularValueDecompositionOfTheArray) {
  const NoTraps no_traps;
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.family->name() + ", level " + std::to_string(c.level));
    const TaylorData data = data_at(c.family, c.t, c.level);
    const Elimination staged(data, c.level), whole(data, c.level, 1, true);
    if (!staged.judge.all_clear() || !whole.judge.all_clear()) continue;  // an oracle where its own gap is clear
    ASSERT_EQ(staged.carried.rows, whole.carried.rows);
    EXPECT_EQ(staged.carried.rank_E, whole.carried.rank_E);
    const Matrix Z = transposed(whole.carried.rhs);
    EXPECT_LE(sfdae_test::orthonormality_defect(Z), rounding(Z.rows()));
    EXPECT_LE(sfdae_test::outside_range(Z, transposed(staged.carried.rhs)),
              staged.tolerance(data, c.level) / whole.judge.smallest_pivot());
  }
}

TEST(Elimination, OfRectangularAndRandomDataAnnihilatesTheDerivatives) {
  struct Shape {
    int m, n, rank;
  };
  for (const Shape s : {Shape{3, 5, 2},
                        {5, 3, 2},
                        {4, 4, 0},
                        {4, 4, 4},
                        {3, 5, 3},
                        {5, 3, 3},
                        {1, 1, 0},
                        {1, 1, 1},
                        {30, 30, 12},
                        {26, 40, 25},
                        {55, 30, 20}})
    for (int level : {0, 1, 3}) {
      SCOPED_TRACE(std::to_string(s.m) + " x " + std::to_string(s.n) + ", " + std::to_string(level));
      const TaylorData data = random_taylor_data(s.m, s.n, level, s.rank, 7);
      const Elimination e(data, level);
      EXPECT_EQ(e.carried.rank_E, s.rank);
      const Array array = array_of(data, level);
      EXPECT_LE(largest(times(e.carried.rhs, array.M)), e.tolerance(data, level) * largest(e.carried.rhs));
      EXPECT_LE(distance(times(e.carried.rhs, array.N), e.carried.constraints),
                e.tolerance(data, level) * std::max(1.0, largest(e.carried.rhs)));
      // dim ker M^T = (l + 1) m - rank M, with rank M from the singular values of random (hence clear) data.
      const std::vector<double> values = svd(array.M).s;
      int rank = 0;
      for (double value : values) rank += value > 1e-9 * values[0] ? 1 : 0;
      EXPECT_EQ(e.carried.rows, (level + 1) * s.m - rank);
    }
}

TEST(Elimination, OfARegularELeavesNothingAndOfEZeroEverything) {
  const TaylorData regular = random_taylor_data(4, 4, 2, 4, 3);
  EXPECT_EQ(Elimination(regular, 2).carried.rows, 0);
  TaylorData without = random_taylor_data(3, 3, 0, 0, 3);
  const Elimination e(without, 0);
  EXPECT_EQ(e.carried.rows, 3);
  EXPECT_EQ(e.carried.rank_E, 0);
  EXPECT_LE(sfdae_test::orthonormality_defect(e.carried.rhs), rounding(3));
}

// E_0 = diag(1, p, 0), and row 3 of -A_0 couples y_1 with weight 1: the multiplier is 1 / p, beyond 100 from
// p = 1e-2 on. Both branches must carry the same space and annihilate M; rotations keep Z orthonormal.
TEST(Elimination, LargeMultipliersAreReplacedByReflections) {
  const NoTraps no_traps;
  for (double p : {0.5, 0.02, 0.009, 1e-3, 1e-6}) {
    TaylorData data = random_taylor_data(3, 3, 1, 3, 5);
    fill(data.E(0), 0.0);
    data.E(0)(0, 0) = 1.0;
    data.E(0)(1, 1) = p;
    for (int j = 0; j < 3; ++j) {
      data.E(1)(2, j) = 0.0;
      data.A(0)(2, j) = j == 1 ? 1.0 : 0.0;
    }
    data.measure();
    const Elimination e(data, 1), whole(data, 1, 1, true);
    const Array array = array_of(data, 1);
    const ConstView Zt = e.carried.rhs;
    ASSERT_EQ(e.carried.rows, whole.carried.rows);
    // Errors are those of rounding relative to the rows of Z, which no multiplier above 100 has made long.
    EXPECT_LE(largest(Zt), 101.0);
    EXPECT_LE(largest(times(Zt, array.M)), rounding(6) * 101.0 * data.norm(1)) << p;
    EXPECT_LE(distance(times(Zt, array.N), e.carried.constraints), rounding(6) * 101.0 * data.norm(1)) << p;
    EXPECT_LE(sfdae_test::outside_range(transposed(whole.carried.rhs), transposed(Zt)),
              rounding(6) * 101.0 * data.norm(1) / e.judge.smallest_pivot())
        << p;
  }
}

// A redundant equation leaves a row of A^ that is nothing but rounding errors, multiplied by |E^-1 A| tau at every
// stage: they have to lie below the threshold, and the noise must not be so large that it hides the constraints.
TEST(Elimination, ErrorsThatGrowFromStageToStageStayBelowTheThreshold) {
  const NoTraps no_traps;
  for (double w : {2.0, 0.1, 0.01, 0.003})
    for (int seed = 1; seed <= 20; ++seed) {
      const Family family = sfdae_test::kron(8, 3, w, 1, seed);
      const TaylorData data = data_at(family, 0.3, 3);
      Elimination e(data, 3);
      Matrix constraints = to_matrix(e.carried.constraints);
      const std::vector<double> values = singular_values(constraints);
      const int a = family->values().a;
      ASSERT_GT(static_cast<int>(values.size()), a);
      Arena arena;
      std::vector<int> pivots(size(e.carried.rows));
      std::vector<double> tau(size(data.n));
      Matrix transposed_rows = transposed(constraints);
      factor_qr_pivoted(transposed_rows, pivots.data(), tau.data(), arena);
      EXPECT_EQ(e.judge.decide_constraints(transposed_rows, transposed(constraints)), a) << w << ' ' << seed;
      const RankDecision& decision = e.log.back();
      EXPECT_LE(values[size(a)], decision.threshold * data.norm_A(3)) << w << ' ' << seed;
      EXPECT_GE(values[size(a - 1)], 1e3 * decision.noise * data.norm_A(3)) << w << ' ' << seed;
    }
}

// A right-hand side of several columns is transformed column by column.
TEST(Elimination, TransformsEveryColumnOfTheRightHandSide) {
  const NoTraps no_traps;
  const TaylorData data = random_taylor_data(4, 4, 2, 2, 9);
  const Matrix rhs = sfdae_test::random_matrix(12, 3, 77);
  const Elimination e(data, 2);
  for (bool by_svd : {false, true}) {
    Judge judge(data, 2, e.settings, nullptr);
    Arena arena;
    const Elimination reference(data, 2, 1, by_svd);
    const Carried carried =
        by_svd ? eliminate_by_svd(data, 2, rhs, judge, arena) : eliminate(data, 2, rhs, 1, judge, arena);
    EXPECT_LE(distance(carried.rhs, times(reference.carried.rhs, rhs)), reference.tolerance(data, 2));
  }
}

// E_0 P = Q [R11 R12; 0 0]: E_0^T E_0 = P R^T R P^T.
TEST(Elimination, HandsOutTheFactorizationOfE) {
  for (int rank : {0, 2, 4}) {
    const TaylorData data = random_taylor_data(4, 5, 1, rank, 11);
    const Elimination e(data, 1);
    ASSERT_EQ(e.carried.rank_E, rank);
    Matrix R(rank, 5);
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i <= std::min(j, rank - 1); ++i) R(i, e.carried.pivots[j]) = e.carried.R(i, j);
    EXPECT_LE(distance(times(transposed(R), R), times(transposed(data.E(0)), data.E(0))), rounding(10) * 4.0);
  }
}

}  // namespace sfdae::core
