// SPDX-License-Identifier: BSD-3-Clause
// Consistent values fulfil the constraints, and the conditions of optimality that define them.
#include "linear/linear_values.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "analyzed_problem.h"
#include "c_api/problems.h"
#include "matrix_checks.h"
#include "problem/failure.h"
#include "testset_linear.h"

namespace sfdae::core {

namespace {

using sfdae_test::AnalyzedProblem;
using sfdae_test::column;
using sfdae_test::largest;
using sfdae_test::rounding;
using sfdae_test::size;
using sfdae_test::sum;
using sfdae_test::times;
using sfdae_test::transposed;
using Family = std::shared_ptr<const sfdae_test::LinearFamily>;
using Numbers = std::vector<double>;

constexpr double t0 = 0.4;

struct AtPoint : AnalyzedProblem {
  explicit AtPoint(Family family) : AnalyzedProblem(std::move(family), t0, t0 + 1.0) {
    EXPECT_EQ(system.move_to(t0), PointStatus::ok);
  }
  // (I - T2 T2^T) (x - exact): zero for consistent x.
  double violation(const Numbers& x) const {
    const Matrix change = sum(1.0, column(x), -1.0, column(exact(t0)));
    const ConstView T2 = system.point().form.T2();
    return largest(sum(1.0, change, -1.0, times(T2, times(transposed(T2), change))));
  }
  double tolerance() const {
    return rounding(10 * problem.n()) * std::max(1.0, system.point().data.norm(12)) /
           (system.quality().smallest_pivot * system.quality().kept_constraints);
  }
};

std::vector<Family> families() {
  return {Family(sfdae_test::kron(7, 0)),
          Family(sfdae_test::kron(8, 2)),
          Family(sfdae_test::kron(9, 1, 0.5, 2)),
          Family(sfdae_test::chain(4, 2)),
          Family(sfdae_test::nilpotent(3).family),
          Family(sfdae_test::free_component().family),
          Family(sfdae_test::rotated_ode(sfdae_test::RowOperation::none))};
}

Numbers shifted(Numbers x, double amount) {
  const Numbers change = sfdae_test::random_vector(static_cast<int>(x.size()), 8);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += amount * change[i];
  return x;
}

}  // namespace

// The change is orthogonal to the consistent directions: T2^T (x - x_given) = 0.
TEST(ConsistentValues, NearestIsConsistentAndChangesNothingAlongT2) {
  for (const Family& family : families()) {
    SCOPED_TRACE(family->name());
    AtPoint p(family);
    const Numbers given = shifted(p.exact(t0), 0.5);
    Numbers x = given;
    const ConsistencyResult result = make_consistent(p.system, {}, x);
    EXPECT_LE(p.violation(x), p.tolerance());
    EXPECT_LE(result.residual_after, p.tolerance());
    const Matrix change = sum(1.0, column(x), -1.0, column(given));
    EXPECT_LE(largest(times(transposed(p.system.point().form.T2()), change)), rounding(p.problem.n()));
    // The residual is the distance to the constraints.
    double squares = 0.0;
    for (int i = 0; i < p.problem.n(); ++i) squares += change(i, 0) * change(i, 0);
    EXPECT_NEAR(result.residual_before, std::sqrt(squares), p.tolerance());
    EXPECT_NEAR(result.largest_change, largest(change), rounding(1));
    const int component = std::max(result.component, 0);
    EXPECT_NEAR(std::fabs(change(component, 0)), result.component < 0 ? 0.0 : largest(change), rounding(1));
  }
}

TEST(ConsistentValues, AConsistentPointStays) {
  for (const Family& family : families()) {
    AtPoint p(family);
    for (InitialValues kind : {InitialValues::nearest, InitialValues::accept}) {
      ConsistencyRequest request;
      request.kind = kind;
      request.tolerances.assign(size(p.problem.n()), p.tolerance());
      Numbers x = p.exact(t0);
      make_consistent(p.system, request, x);
      EXPECT_LE(sfdae_test::distance(x, p.exact(t0)), p.tolerance()) << family->name();
    }
  }
}

// Minimum of sum (change_i / w_i)^2: T2^T D^-2 change = 0.
TEST(ConsistentValues, WeightedIsTheMinimumInTheWeightedNorm) {
  for (const Family& family : families()) {
    SCOPED_TRACE(family->name());
    AtPoint p(family);
    const int n = p.problem.n();
    ConsistencyRequest request;
    for (int i = 0; i < n; ++i) request.weights.push_back(std::pow(10.0, i % 3 - 1));
    const Numbers given = shifted(p.exact(t0), 0.5);
    Numbers x = given;
    make_consistent(p.system, request, x);
    EXPECT_LE(p.violation(x), p.tolerance() * std::max(1.0, largest(x)));
    Matrix gradient(n, 1);
    for (int i = 0; i < n; ++i)
      gradient(i, 0) = (x[size(i)] - given[size(i)]) / std::pow(request.weights[size(i)], 2);
    EXPECT_LE(largest(times(transposed(p.system.point().form.T2()), gradient)),
              rounding(n) * 1e4 * std::max(1.0, largest(gradient)));
  }
}

// With large weight a component may change, with small weight it hardly does.
TEST(ConsistentValues, SmallWeightsKeepComponents) {
  // x1 + x3 = sin t: the sum has to change by one.
  AtPoint p(Family(sfdae_test::scaled_row(1.0).family));
  const Numbers exact = p.exact(t0);
  for (double ratio : {1.0, 0.1, 10.0}) {
    ConsistencyRequest request;
    request.weights = {ratio, 1.0, 1.0};
    Numbers x = exact;
    x[0] += 1.0;
    make_consistent(p.system, request, x);
    // minimize (c1 / r)^2 + c3^2 with c1 + c3 = -1: c1 = -r^2 / (1 + r^2)
    EXPECT_NEAR(x[0] - exact[0] - 1.0, -ratio * ratio / (1.0 + ratio * ratio), p.tolerance());
    EXPECT_NEAR(x[1], exact[1], p.tolerance());
    EXPECT_NEAR(x[2] - exact[2], -1.0 / (1.0 + ratio * ratio), p.tolerance());
  }
}

// Fixed components keep every bit; the others change least: T2_free directions N with N_J = 0 see no change.
TEST(ConsistentValues, FixedComponentsKeepTheirValues) {
  for (const Family& family :
       {Family(sfdae_test::kron(8, 1)), Family(sfdae_test::kron(9, 1, 0.5, 2)), Family(sfdae_test::chain(4, 1))}) {
    SCOPED_TRACE(family->name());
    AtPoint p(family);
    const int n = p.problem.n();
    ConsistencyRequest request;
    request.kind = InitialValues::fixed;
    request.fixed.assign(size(n), 0);
    request.fixed[1] = 1;  // one component is no contradiction as long as T2 moves it
    ASSERT_GT(p.system.point().form.unknowns(), 1);
    Numbers x = shifted(p.exact(t0), 0.5);
    const Numbers given = x;
    make_consistent(p.system, request, x);
    EXPECT_EQ(x[1], given[1]);
    EXPECT_LE(p.violation(x), p.tolerance() * std::max(1.0, largest(x)) * 10.0);
    // Consistent directions with zero in component 1: v - e (T2_1 . v) projected; test on T2 (I - r r^T / r.r).
    const ConstView T2 = p.system.point().form.T2();
    Matrix r = transposed(T2.block(1, 0, 1, T2.cols));
    const double length = times(transposed(r), r)(0, 0);
    const Matrix open = times(T2, sum(1.0, sfdae_test::unit_matrix(T2.cols), -1.0 / length, times(r, transposed(r))));
    const Matrix change = sum(1.0, column(x), -1.0, column(given));
    EXPECT_LE(largest(times(transposed(open), change)), rounding(n) * 100.0 * std::max(1.0, largest(change)));
  }
}

// E1 change = 0 with E1 = (E T2)^T E, and nothing happens along the free directions, the kernel of [E; A2].
TEST(ConsistentValues, KeepDifferentialChangesTheNullSpaceOfE1Only) {
  for (const Family& family : families()) {
    SCOPED_TRACE(family->name());
    AtPoint p(family);
    const int n = p.problem.n(), m = p.problem.m();
    ConsistencyRequest request;
    request.kind = InitialValues::keep_differential;
    const Numbers given = shifted(p.exact(t0), 0.5);
    Numbers x = given;
    const ConsistencyResult result = make_consistent(p.system, request, x);
    const double conditioned = p.tolerance() * 10.0 * std::max(1.0, largest(x));
    EXPECT_LE(p.violation(x), conditioned);
    EXPECT_LE(result.residual_after, conditioned);
    Matrix E(m, n);
    ASSERT_EQ(p.problem.call('E', t0, 0, E.data()).status, SFDAE_OK);
    const Matrix change = sum(1.0, column(x), -1.0, column(given));
    const Matrix ET2 = times(E, p.system.point().form.T2());
    EXPECT_LE(largest(times(transposed(ET2), times(E, change))), conditioned * std::max(1.0, largest(E)));
    const Matrix free = times(p.system.point().form.T2(), p.system.point().form.Uz());
    if (free.cols() > 0) {
      EXPECT_LE(largest(times(transposed(free), change)), conditioned);
    }
    Numbers again = x;
    make_consistent(p.system, request, again);
    EXPECT_LE(sfdae_test::distance(x, again), conditioned);
  }
}

// Rows and unknowns in other units are no other problem: x1' = -x1 keeps x1, and 0 = x1 - x2 moves x2 alone.
TEST(ConsistentValues, KeepDifferentialDoesNotDependOnUnits) {
  for (double row : {1.0, 1e-12})
    for (double unit : {1.0, 1e9}) {
      double scale[] = {row, unit};
      sfdae_linear_problem callbacks;
      sfdae_linear_problem_init(&callbacks, sizeof callbacks);
      callbacks.num_equations = callbacks.num_unknowns = 2;
      callbacks.user = scale;
      callbacks.E = [](double, int, double* E, void* user) {
        E[0] = static_cast<double*>(user)[0];
        return 0;
      };
      callbacks.A = [](double, int, double* A, void* user) {
        const double* s = static_cast<double*>(user);
        A[0] = -s[0], A[1] = 1.0, A[3] = -s[1];
        return 0;
      };
      callbacks.constant_E = callbacks.constant_A = 1;
      LinearProblem problem(functions_of(callbacks));
      Arena arena;
      std::vector<RankDecision> decisions;
      LinearSystem system(problem, {}, analyze_index(problem, 0.0, 1.0, {}, arena, decisions),
                          LeadingTerm::automatic);
      ASSERT_EQ(system.move_to(0.0), PointStatus::ok);
      ConsistencyRequest request;
      request.kind = InitialValues::keep_differential;
      Numbers x = {2.0, 7.0 / unit};
      make_consistent(system, request, x);
      EXPECT_NEAR(x[0], 2.0, rounding(2) * 10.0);
      EXPECT_NEAR(x[1], 2.0 / unit, rounding(2) * 10.0);  // columns are not scaled for this one
    }
}

TEST(ConsistentValues, AllComponentsFixedPassesForConsistentValuesOnly) {
  AtPoint p(Family(sfdae_test::chain(4, 1)));
  ConsistencyRequest request;
  request.kind = InitialValues::fixed;
  request.fixed.assign(size(p.problem.n()), 1);
  Numbers x = p.exact(t0);
  EXPECT_NO_THROW(make_consistent(p.system, request, x));
  EXPECT_EQ(x, p.exact(t0));
  x[0] += 1e-3;
  const Numbers given = x;
  try {
    make_consistent(p.system, request, x);
    FAIL() << "no failure";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.status(), SFDAE_FIXED_VALUES);
    EXPECT_EQ(x, given);
  }
}

// nilpotent: every component is given by the constraints, a fixed one that differs contradicts them.
TEST(ConsistentValues, AFixedComponentThatIsAlgebraicMustBeRight) {
  AtPoint p(Family(sfdae_test::nilpotent(2).family));
  ConsistencyRequest request;
  request.kind = InitialValues::fixed;
  request.fixed = {0, 1};
  Numbers x = p.exact(t0);
  x[0] += 1.0;
  EXPECT_NO_THROW(make_consistent(p.system, request, x));
  EXPECT_LE(sfdae_test::distance(x, p.exact(t0)), p.tolerance());
  x[1] += 1e-6;
  EXPECT_THROW(make_consistent(p.system, request, x), Failure);
}

TEST(ConsistentValues, AcceptMeasuresTheChangeOfEveryComponentByItsTolerance) {
  // x1 + x3 = sin t: a violation of 2 delta means changes of delta in x1 and x3, none in x2.
  AtPoint p(Family(sfdae_test::scaled_row(1.0).family));
  const double delta = 1e-3;
  ConsistencyRequest request;
  request.kind = InitialValues::accept;
  Numbers x = p.exact(t0);
  x[0] += 2.0 * delta;
  const Numbers given = x;
  request.tolerances = {1.01 * delta, 0.0 + p.tolerance(), 1.01 * delta};
  const ConsistencyResult result = make_consistent(p.system, request, x);
  EXPECT_EQ(x, given);
  EXPECT_NEAR(result.residual_before, std::sqrt(2.0) * delta, p.tolerance());
  EXPECT_EQ(result.residual_after, result.residual_before);
  for (std::size_t tight : {0u, 2u}) {
    ConsistencyRequest tighter = request;
    tighter.tolerances[tight] = 0.99 * delta;
    try {
      make_consistent(p.system, tighter, x);
      FAIL() << "no failure";
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.status(), SFDAE_INCONSISTENT_VALUES);
      EXPECT_EQ(x, given);
    }
  }
}

// The kernel that the projector has, and the one that is found from E: nothing else is different.
TEST(ConsistentValues, DoNotDependOnWhereTheKernelOfEComesFrom) {
  for (const Family& family : {Family(sfdae_test::kron(7, 0)), Family(sfdae_test::kron(8, 2)),
                               Family(sfdae_test::kron(20, 1)), Family(sfdae_test::chain(4, 2))}) {
    AtPoint at(family);
    const int n = family->n();
    const ConstrainedPoint known = constraints_of(at.system);
    ConstrainedPoint unknown = known;
    unknown.known_kernel = {};
    const Numbers exact = at.exact(t0);
    Numbers guess(exact);
    for (int i = 0; i < n; ++i) guess[size(i)] += 1e-3 * std::sin(1.0 + 7.0 * i);
    ConsistencyRequest request;
    request.keeps_differentiated = true;
    request.tolerances = request.digits = Numbers(size(n), 1e-6);
    const Numbers one = consistent_point(known, request, guess), other = consistent_point(unknown, request, guess);
    const Numbers dx = [&] {
      Numbers change(one);
      for (int i = 0; i < n; ++i) change[size(i)] -= guess[size(i)];
      return change;
    }();
    const Numbers part = differentiated_change(known, request, dx),
                  part_of_other = differentiated_change(unknown, request, dx);
    for (int i = 0; i < n; ++i) {
      EXPECT_NEAR(one[size(i)], other[size(i)], at.tolerance()) << family->name();
      EXPECT_NEAR(part[size(i)], part_of_other[size(i)], at.tolerance()) << family->name();
    }
    EXPECT_LE(at.violation(one), at.tolerance());
  }
}

}  // namespace sfdae::core
