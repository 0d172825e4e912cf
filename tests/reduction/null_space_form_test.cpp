// SPDX-License-Identifier: BSD-3-Clause
// Every matrix of the null-space form against its definition.
#include "reduction/null_space_form.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "c_api/problems.h"
#include "family_problem.h"
#include "linalg/dense.h"
#include "matrix_checks.h"
#include "problem/linear_problem.h"
#include "testset_linear.h"

namespace sfdae::core {

namespace {

using sfdae_test::column;
using sfdae_test::distance;
using sfdae_test::largest;
using sfdae_test::orthonormality_defect;
using sfdae_test::rounding;
using sfdae_test::size;
using sfdae_test::sum;
using sfdae_test::times;
using sfdae_test::transposed;
using Family = std::shared_ptr<const sfdae_test::LinearFamily>;
using Numbers = std::vector<double>;

struct Case {
  Family family;
  double t;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (sfdae_test::LinearTestProblem& p : sfdae_test::linear_testset()) {
    const double t = p.t0 + 0.3 * (p.tf - p.t0);
    all.push_back({std::move(p.family), t});
  }
  for (int mu = 0; mu <= 3; ++mu) all.push_back({Family(sfdae_test::kron(8, mu)), 0.4});
  all.push_back({Family(sfdae_test::kron(9, 2, 1.0, 2)), 0.4});
  all.push_back({Family(sfdae_test::kron(30, 1, 1.0, 2)), 0.4});
  all.push_back({Family(sfdae_test::kron(20, 0)), 0.4});
  all.push_back({Family(sfdae_test::kron(40, 0, 1.0, 2)), 0.4});
  all.push_back({Family(sfdae_test::spin(-5.0, 1.0)), 0.4});
  for (std::uint64_t seed = 1; seed <= 15; ++seed) all.push_back({Family(sfdae_test::random_family(seed)), 0.2});
  return all;
}

constexpr LeadingTerm leading_terms[] = {LeadingTerm::projector, LeadingTerm::matrix, LeadingTerm::identity};

// One reduction at t, with all that it was built from.
struct Reduction {
  TaylorData data;
  Arena arena;
  Judge::Settings settings;
  std::unique_ptr<Judge> judge;
  Carried carried;
  NullSpaceForm form;
  PointRanks ranks;

  Reduction(const Family& family, double t, LeadingTerm leading, const std::vector<int>& prescribed = {},
            const Numbers& values = {}) {
    const int mu = family->values().mu;
    sfdae_test::FamilyProblem callbacks(family);
    LinearProblem problem(functions_of(callbacks.problem));
    EXPECT_EQ(problem.evaluate(t, {std::max(mu, 1), mu, mu}, 0.0, data).status, SFDAE_OK);
    judge = std::make_unique<Judge>(data, mu, settings, nullptr);
    carried = eliminate(data, mu, data.f_stack(mu), 1, *judge, arena);
    form.resize(data.m, data.n, static_cast<int>(prescribed.size()), carried.rows);
    ranks = form.build(data, carried, {&prescribed, values.data()}, leading, *judge, arena);
  }
  Matrix xp() const { return column(Numbers(form.xp(), form.xp() + form.n)); }
  Matrix f() const { return column(Numbers(data.f(0), data.f(0) + data.m)); }
  // Errors of null vectors: eps |data| / (p sigma_a), with the sizes of the vectors involved.
  double tolerance() const {
    const double scale = std::max({1.0, data.norm(data.orders.A), data.norm_f(data.orders.f)});
    return rounding(4 * (data.m + data.n)) * scale * std::max(1.0, largest(xp())) /
           (judge->smallest_pivot() * judge->kept_constraints());
  }
  // P = I - K K^T
  Matrix projector() const {
    return sum(1.0, identity(form.n), -1.0, times(form.kernel(), transposed(form.kernel())));
  }
  // C of the definition.
  Matrix C(LeadingTerm leading) const {
    const Matrix A = to_matrix(data.A(0)), E1 = to_matrix(data.E(1));
    if (leading == LeadingTerm::identity) return A;
    if (leading == LeadingTerm::matrix) return sum(1.0, A, 1.0, E1);
    return sum(1.0, A, 1.0, times(E1, sum(1.0, identity(form.n), -1.0, projector())));
  }
};

}  // namespace

TEST(NullSpaceForm, FindsTheCharacteristicValues) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.family->name());
    const Reduction r(c.family, c.t, LeadingTerm::projector);
    const sfdae_test::CharacteristicValues values = c.family->values();
    EXPECT_EQ(r.ranks.a, values.a);
    EXPECT_EQ(r.ranks.d, values.d);
    EXPECT_EQ(r.form.u, values.u);
    EXPECT_GE(r.ranks.v_hat, values.v);
    EXPECT_EQ(r.carried.rows, r.ranks.a + r.ranks.v_hat);
    EXPECT_EQ(r.form.unknowns(), values.d + values.u);
  }
}

TEST(NullSpaceForm, T2IsAnOrthonormalBasisOfTheKernelOfTheConstraints) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.family->name());
    const Reduction r(c.family, c.t, LeadingTerm::projector);
    EXPECT_LE(orthonormality_defect(r.form.T2()), rounding(r.form.n));
    EXPECT_LE(largest(times(r.carried.constraints, r.form.T2())), r.tolerance());
  }
}

// A^ xp + f^ = 0, and nothing of xp lies in the kernel: the smallest solution.
TEST(NullSpaceForm, XpIsTheConsistentPointOfSmallestNorm) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.family->name());
    const Reduction r(c.family, c.t, LeadingTerm::projector);
    EXPECT_LE(distance(times(r.carried.constraints, r.xp()), sum(-1.0, r.carried.rhs, 0.0, r.carried.rhs)),
              r.tolerance());
    EXPECT_LE(largest(times(transposed(r.form.T2()), r.xp())), rounding(r.form.n) * largest(r.xp()) * r.form.n);
  }
}

TEST(NullSpaceForm, Z1IsAnOrthonormalBasisOfTheRangeOfET2) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.family->name());
    const Reduction r(c.family, c.t, LeadingTerm::projector);
    EXPECT_LE(orthonormality_defect(r.form.Z1()), rounding(r.form.m));
    EXPECT_LE(sfdae_test::outside_range(r.form.Z1(), times(r.data.E(0), r.form.T2())), r.tolerance());
  }
}

TEST(NullSpaceForm, GBAndTheirInhomogeneitiesAreWhatTheDefinitionSays) {
  for (const Case& c : cases())
    for (LeadingTerm leading : leading_terms) {
      SCOPED_TRACE(c.family->name() + ", leading term " + std::to_string(static_cast<int>(leading)));
      const Reduction r(c.family, c.t, leading);
      const Matrix Z1t = transposed(r.form.Z1()), C = r.C(leading);
      EXPECT_LE(distance(r.form.G(), times(Z1t, times(r.data.E(0), r.form.T2()))), r.tolerance());
      EXPECT_LE(distance(r.form.B(), times(Z1t, times(C, r.form.T2()))), r.tolerance());
      const Matrix b = times(Z1t, sum(1.0, times(C, r.xp()), 1.0, r.f()));
      EXPECT_LE(distance(ConstView{r.form.b(), r.form.d, 1, std::max(r.form.d, 1)}, b), r.tolerance());
      const Matrix g0 = times(Z1t, times(r.data.E(0), r.xp()));
      EXPECT_LE(distance(ConstView{r.form.g0(), r.form.d, 1, std::max(r.form.d, 1)}, g0), r.tolerance());
    }
}

TEST(NullSpaceForm, KernelIsAnOrthonormalBasisOfKerE) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.family->name());
    const Reduction r(c.family, c.t, LeadingTerm::projector);
    EXPECT_EQ(r.form.kernel().cols, r.form.n - r.ranks.rank_E);
    EXPECT_LE(orthonormality_defect(r.form.kernel()), rounding(r.form.n));
    EXPECT_LE(largest(times(r.data.E(0), r.form.kernel())), r.tolerance());
    Arena arena;
    const Numbers y = sfdae_test::random_vector(r.form.n, 3);
    Numbers projected = y;
    r.form.project(projected.data(), arena);
    EXPECT_LE(distance(projected, times(r.projector(), y.data())), rounding(r.form.n));
  }
}

TEST(NullSpaceForm, UzSpansTheKernelOfGAndSolveGGivesTheSmallestSolution) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.family->name());
    const Reduction r(c.family, c.t, LeadingTerm::projector);
    const ConstView G = r.form.G(), Uz = r.form.Uz();
    EXPECT_LE(orthonormality_defect(Uz), rounding(r.form.n));
    EXPECT_LE(largest(times(G, Uz)), r.tolerance());
    Arena arena;
    const Numbers q = sfdae_test::random_vector(r.form.d, 5);
    Numbers z(size(r.form.unknowns()) + 1, 0.0);
    if (r.form.unknowns() == 0) continue;
    r.form.solve_G(q.data(), z.data(), arena);
    z.pop_back();
    EXPECT_LE(distance(times(G, z.data()), q), rounding(r.form.n) * std::max(1.0, largest(z)));
    EXPECT_LE(largest(times(transposed(Uz), column(z))), rounding(r.form.n) * std::max(1.0, largest(z)));
  }
}

TEST(NullSpaceForm, SignOfGIsThatOfItsDeterminant) {
  int compared = 0;
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.family->name());
    const Reduction r(c.family, c.t, LeadingTerm::projector);
    if (r.form.u > 0 || r.form.d == 0) continue;
    ++compared;
    Arena arena;
    Matrix G = to_matrix(r.form.G());
    EXPECT_EQ(r.form.sign_of_G(), determinant_sign(G, arena));
  }
  EXPECT_GE(compared, 10);
}

// det(Q1 Q1^T E + (I - Q1 Q1^T) A), Q1 a basis of range E: from an SVD of E, for regular problems of mu = 0.
TEST(NullSpaceForm, OrientationIsThatOfTheDifferentialAndTheAlgebraicRows) {
  int compared = 0, negative = 0;
  for (int n : {2, 3, 5, 8, 13, 20, 33})
    for (double t : {-0.9, 0.4, 1.3})
      for (double scale : {1.0, -1.0}) {
        const Family family(sfdae_test::kron(n, 0, 1.0, 0, 0, 1.0, scale));
        SCOPED_TRACE(family->name());
        const Reduction r(family, t, LeadingTerm::projector);
        const Matrix Q1 = range_basis(r.data.E(0), r.ranks.rank_E);
        const Matrix onto = times(Q1, transposed(Q1));
        Matrix joined =
            sum(1.0, times(onto, r.data.E(0)), 1.0, times(sum(1.0, identity(n), -1.0, onto), r.data.A(0)));
        Arena arena;
        const int sign = determinant_sign(joined, arena);
        EXPECT_EQ(r.form.orientation(), sign);
        ++compared;
        if (sign < 0) ++negative;
      }
  EXPECT_GT(negative, 0);
  EXPECT_LT(negative, compared);
  EXPECT_EQ(Reduction(Family(sfdae_test::kron(8, 1)), 0.4, LeadingTerm::projector).form.orientation(), 0);
  EXPECT_EQ(Reduction(Family(sfdae_test::kron(9, 0, 1.0, 2)), 0.4, LeadingTerm::projector).form.orientation(), 0);
}

// Every solution satisfies 0 = A2 x + f2 and Z1^T (tau E x' - A x - f) = 0.
TEST(NullSpaceForm, HoldsForTheExactSolution) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.family->name());
    const Reduction r(c.family, c.t, LeadingTerm::identity);
    Matrix x(r.form.n, 1), xdot(r.form.n, 1);
    c.family->exact(c.t, x.data(), xdot.data());
    const Matrix inside = times(r.form.T2(), times(transposed(r.form.T2()), x));
    EXPECT_LE(distance(x, sum(1.0, r.xp(), 1.0, inside)), r.tolerance() * std::max(1.0, largest(x)));
    const Matrix left = times(r.data.E(0), xdot), right = sum(1.0, times(r.data.A(0), x), 1.0, r.f());
    EXPECT_LE(largest(times(transposed(r.form.Z1()), sum(r.data.time_scale, left, -1.0, right))),
              r.tolerance() * std::max(1.0, std::max(largest(x), largest(xdot) * r.data.time_scale)));
  }
}

// ---- Prescribed components ----

// kron with u = 2: prescribing two components leaves none free. x_J = values, A2 x + f2 = 0 for every z.
TEST(NullSpaceForm, PrescribedComponentsHaveTheirValuesWhateverZIs) {
  const Family family = sfdae_test::kron(8, 1, 0.5, 2);
  for (const std::vector<int>& J : {std::vector<int>{3}, {3, 6}, {6, 0}}) {
    const Numbers values = sfdae_test::random_vector(static_cast<int>(J.size()), 4);
    const Reduction r(family, 0.4, LeadingTerm::projector, J, values);
    ASSERT_TRUE(r.ranks.prescription_fits);
    const int count = static_cast<int>(J.size());
    EXPECT_EQ(r.form.u, 2 - count);
    EXPECT_EQ(r.form.unknowns(), 8 - family->values().a - count);
    EXPECT_LE(orthonormality_defect(r.form.T2()), rounding(8));
    EXPECT_LE(largest(times(r.carried.constraints, r.form.T2())), r.tolerance());
    EXPECT_LE(distance(times(r.carried.constraints, r.xp()), sum(-1.0, r.carried.rhs, 0.0, r.carried.rhs)),
              r.tolerance());
    for (int i = 0; i < count; ++i) {
      EXPECT_NEAR(r.form.xp()[J[size(i)]], values[size(i)], r.tolerance());
      for (int j = 0; j < r.form.unknowns(); ++j) EXPECT_NEAR(r.form.T2()(J[size(i)], j), 0.0, rounding(8));
    }
    // xp is the smallest such point: orthogonal to what is left of T2.
    EXPECT_LE(largest(times(transposed(r.form.T2()), r.xp())), rounding(8) * std::max(1.0, largest(r.xp())));
    EXPECT_LE(distance(r.form.G(), times(transposed(r.form.Z1()), times(r.data.E(0), r.form.T2()))), r.tolerance());
  }
}

// x1 = sin t is the constraint of purely_algebraic, x2 is free: x1 cannot be prescribed, x2 can.
TEST(NullSpaceForm, ComponentsThatTheConstraintsFixCannotBePrescribed) {
  const Family family = sfdae_test::purely_algebraic().family;
  EXPECT_FALSE(Reduction(family, 0.4, LeadingTerm::projector, {0}, {1.0}).ranks.prescription_fits);
  EXPECT_TRUE(Reduction(family, 0.4, LeadingTerm::projector, {1}, {1.0}).ranks.prescription_fits);
  EXPECT_FALSE(Reduction(family, 0.4, LeadingTerm::projector, {0, 1}, {1.0, 1.0}).ranks.prescription_fits);
}

// ---- Redundant rows ----

// 0 = x2 - sin t and 0 = x2 - sin t + rho sin t: rows (1; 1) of A^, f^ = -(1, 1 - rho) sin t. The redundant
// combination leaves rho sin t / 2 up to the choice of the pivot row, relative to entries of size sin t.
TEST(NullSpaceForm, ContradictionsOfRedundantRowsAreMeasuredRelatively) {
  for (double rho : {0.0, 1e-9, 1e-3, 0.5}) {
    const Family family = sfdae_test::redundant_row(rho).family;
    const Reduction r(family, 1.0, LeadingTerm::projector);
    ASSERT_EQ(r.ranks.v_hat, 1);
    EXPECT_LE(r.form.inconsistency(), 2.0 * rho + rounding(4));
    EXPECT_GE(r.form.inconsistency(), 0.25 * rho - rounding(4));
  }
}

TEST(NullSpaceForm, ConsistentRedundantRowsHaveNoContradiction) {
  for (const Case& c : cases()) {
    if (c.family->values().v == 0) continue;
    SCOPED_TRACE(c.family->name());
    const Reduction r(c.family, c.t, LeadingTerm::projector);
    EXPECT_LE(r.form.inconsistency(), 1e3 * r.tolerance());
  }
}

// ---- A new right-hand side ----

TEST(NullSpaceForm, ReplacingTheRightHandSideIsTheSameAsBuildingWithIt) {
  for (int u : {0, 2}) {
    const Family family = sfdae_test::kron(8, 2, 0.0, u);  // constant E and A
    const std::vector<int> J = u > 0 ? std::vector<int>{3} : std::vector<int>{};
    const Numbers one(J.size(), 0.5), two(J.size(), -1.5);
    Reduction moved(family, 0.4, LeadingTerm::projector, J, one);
    const Reduction target(family, 0.9, LeadingTerm::projector, J, two);
    ASSERT_EQ(moved.data.time_scale, target.data.time_scale);
    for (int k = 0; k <= 2; ++k) std::copy_n(target.data.f(k), 8, moved.data.f(k));
    Numbers f_hat(target.carried.rhs.data, target.carried.rhs.data + target.carried.rows);
    moved.form.replace_rhs(moved.data, f_hat.data(), {&J, two.data()}, moved.arena);
    EXPECT_LE(distance(moved.xp(), target.xp()), target.tolerance());
    const auto rows = [](const double* values, int count) { return Numbers(values, values + count); };
    EXPECT_LE(distance(rows(moved.form.b(), moved.form.d), rows(target.form.b(), target.form.d)), target.tolerance());
    EXPECT_LE(distance(rows(moved.form.g0(), moved.form.d), rows(target.form.g0(), target.form.d)),
              target.tolerance());
    EXPECT_EQ(distance(moved.form.T2(), target.form.T2()), 0.0);
  }
}

}  // namespace sfdae::core
