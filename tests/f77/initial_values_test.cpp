// SPDX-License-Identifier: BSD-3-Clause
// DNFINI, DGEINI: consistent initial values and derivatives; DGENRM.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "family_caller.h"
#include "linalg/dense.h"
#include "random_family.h"
#include "testset_linear.h"

namespace sfdae_test {

namespace {

using sfdae::core::ConstView;
using sfdae::core::Matrix;
using sfdae::core::to_matrix;
using Family = std::shared_ptr<const LinearFamily>;

// E1 random d x n, A2 random a x n, in the first d + a rows of square matrices.
struct System {
  System(int order, int differential, int algebraic, std::uint64_t seed)
      : n(order),
        d(differential),
        a(algebraic),
        u(order - differential - algebraic),
        E(order, order),
        A(random_matrix(order, order, seed + 1)),
        f(random_vector(order, seed + 2)),
        x(random_vector(order, seed + 3)),
        lrwork(algebraic + order) {
    const Matrix rows = random_matrix(order, order, seed);
    sfdae::core::copy(rows.view().top(d), E.view().top(d));
  }
  int solve(int method) {
    ierr = 33;
    dnfini_(&n, &d, &a, &u, x.data(), E.data(), &n, A.data(), &n, f.data(), nullptr, nullptr, nullptr, &lrwork,
            &method, &ierr);
    return ierr;
  }
  ConstView A2() const { return A.view().block(d, 0, a, n); }
  double residual() const {
    std::vector<double> r = times(A2(), x.data());
    for (int i = 0; i < a; ++i) r[size(i)] += f[size(d + i)];
    return largest(r);
  }
  double tolerance() const { return rounding(n) / sfdae::core::singular_values(A2()).back(); }

  int n, d, a, u;
  Matrix E, A;
  std::vector<double> f, x;
  int lrwork, ierr = 33;
};

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> c = a;
  for (std::size_t i = 0; i < c.size(); ++i) c[i] -= b[i];
  return c;
}

}  // namespace

// The change is orthogonal to every direction that keeps the constraints.
TEST(Dnfini, GoesToTheNearestConsistentPoint) {
  for (const auto& [d, a] : {std::pair{3, 4}, {0, 5}, {2, 2}, {1, 6}}) {
    System system(7, d, a, 5);
    const std::vector<double> guess = system.x;
    ASSERT_EQ(system.solve(0), 0);
    EXPECT_LE(system.residual(), system.tolerance());
    const Matrix T = to_matrix(sfdae::core::svd(system.A2()).V.view().columns(a, 7 - a));
    const std::vector<double> change = difference(system.x, guess);
    EXPECT_LE(largest(times(transposed(T), change.data())), system.tolerance() * largest(change));
  }
}

TEST(Dnfini, KeepsDifferentialComponentsIfToldTo) {
  for (const auto& [d, a] : {std::pair{3, 4}, {4, 1}, {0, 5}}) {
    System system(7, d, a, 9);
    const std::vector<double> guess = system.x;
    ASSERT_EQ(system.solve(1), 0);
    EXPECT_LE(system.residual(), 100.0 * system.tolerance());
    const std::vector<double> change = difference(system.x, guess);
    EXPECT_LE(largest(times(system.E.view().top(d), change.data())), rounding(7) * largest(change) * 10.0);
  }
}

// A2 acts on what E1 differentiates: no change in ker E1 helps.
TEST(Dnfini, SaysWhenThereIsNoSuchPoint) {
  System system(2, 1, 1, 1);
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) system.E(i, j) = system.A(i, j) = 0.0;
  system.E(0, 0) = system.A(1, 0) = 0.3;
  const std::vector<double> guess = system.x;
  EXPECT_EQ(system.solve(1), -24);
  EXPECT_EQ(system.x, guess);
  EXPECT_EQ(system.solve(0), 0);
  system.A(1, 0) = 0.0;
  EXPECT_EQ(system.solve(0), -24);
}

TEST(Dnfini, RefusesWrongArguments) {
  System system(5, 2, 3, 1);
  const std::vector<double> guess = system.x;
  --system.lrwork;
  EXPECT_EQ(system.solve(0), -5);
  ++system.lrwork;
  EXPECT_EQ(system.solve(2), -3);
  system.f[3] = std::nan("");
  EXPECT_EQ(system.solve(0), -4);
  system.n = -1;
  EXPECT_EQ(system.solve(0), -3);
  EXPECT_EQ(system.x, guess);
  system.a = 0;  // nothing to be done
  EXPECT_EQ(system.solve(0), 33);
}

namespace {

template <class I>
struct Start : Call<I> {
  Start(Family f, int most_levels)
      : Call<I>(std::move(f), most_levels), x(size(this->family->n()), 0.5), xdot(size(this->family->n()), 44.0) {}

  void initialise(double t, bool take_x, const Entries<I>& entry = entries<I>()) {
    const I ld = static_cast<I>(this->EQ.ld), ld_n = static_cast<I>(this->E.ld), inival = take_x ? 1 : 0;
    this->ierr = 0;
    entry.dgeini(edif<I>, adif<I>, fdif<I>, &this->n, &t, &this->lmax, x.data(), xdot.data(), &this->m, &this->d,
                 &this->a, &this->u, &this->ireq, this->EQ.data(), &ld, this->AQ.data(), &ld, this->FQ.data(),
                 this->E.data(), &ld_n, this->A.data(), &ld_n, this->F.data(), this->Z1.data(), &ld_n,
                 this->ZQ.data(), &ld, nullptr, this->AH.data(), &ld, nullptr, nullptr, this->rpar(), nullptr,
                 &this->lrwork, &inival, &this->ierr);
  }
  std::vector<double> x, xdot;
};

template <class I>
void expect_start(const Start<I>& start) {
  const int n = start.family->n(), d = static_cast<int>(start.d), a = static_cast<int>(start.a);
  const Matrix E1 = to_matrix(start.E.block(n, n).top(d)), A1 = to_matrix(start.A.block(n, n).top(d));
  const Matrix A2 = to_matrix(start.A.block(n, n).block(d, 0, a, n));
  const ConstView F = start.F.block(n, 1);
  const double unit = rounding(n) * std::max({1.0, largest(A1), largest(A2), largest(F)});
  const double x_size = std::max(1.0, largest(start.x)), slope = std::max(1.0, largest(start.xdot));
  std::vector<double> r = times(A2, start.x.data());
  for (int i = 0; i < a; ++i) EXPECT_LE(std::fabs(r[size(i)] + F(d + i, 0)), unit * x_size);
  const std::vector<double> left = times(E1, start.xdot.data()), right = times(A1, start.x.data());
  for (int i = 0; i < d; ++i)
    EXPECT_LE(std::fabs(left[size(i)] - right[size(i)] - F(i, 0)), unit * std::max(x_size, slope));
  // Smallest norm: orthogonal to ker E1.
  const Matrix K = to_matrix(sfdae::core::svd(E1).V.view().columns(d, n - d));
  EXPECT_LE(largest(times(transposed(K), start.xdot.data())), 10.0 * unit * std::max(x_size, slope));
}

}  // namespace

TEST(Dgeini, GivesConsistentValuesAndTheSmallestDerivative) {
  for (int mu = 0; mu <= 3; ++mu) {
    SCOPED_TRACE(mu);
    Start<std::int32_t> start(Family(kron(8, mu)), 3);
    start.initialise(0.4, false);
    ASSERT_EQ(start.ierr, 0);
    EXPECT_EQ(start.m, mu);
    expect_start(start);
    Start<std::int64_t> wide(Family(kron(8, mu)), 3);
    wide.initialise(0.4, false, second_underscore_entries());
    ASSERT_EQ(wide.ierr, 0);
    EXPECT_EQ(wide.x, start.x);
  }
  Start<std::int32_t> undetermined(Family(kron(9, 1, 0.5, 2)), 2);
  undetermined.initialise(0.4, false);
  ASSERT_EQ(undetermined.ierr, 0);
  expect_start(undetermined);
}

// INIVAL = 1: X is taken as it is.
TEST(Dgeini, LeavesConsistentValuesAlone) {
  const Family family(kron(8, 1));
  Start<std::int32_t> start(family, 3);
  const std::vector<double> exact = start.x = exact_solution(*family, 0.4).x;
  start.initialise(0.4, true);
  ASSERT_EQ(start.ierr, 0);
  EXPECT_EQ(start.x, exact);
  start.initialise(0.4, false);
  EXPECT_LE(distance(start.x, exact), rounding(100));
}

// x1' = -x1, 0 = x1 - x2: x' of smallest norm is (-1, 0) at (1, 1).
TEST(Dgeini, DoesNotDifferentiateAlgebraicEquations) {
  Start<std::int32_t> start(Family(brenan_index1().family), 2);
  start.initialise(0.3, false);
  ASSERT_EQ(start.ierr, 0);
  expect_start(start);
}

TEST(Dgeini, ReportsFailures) {
  Start<std::int32_t> higher(Family(kron(8, 3)), 1);
  higher.initialise(0.4, false);
  EXPECT_EQ(higher.ierr, -22);
  EXPECT_EQ(higher.m, -1);
  Start<std::int32_t> poisoned(Family(kron(8, 1)), 3);
  poisoned.user.poison = true;
  poisoned.initialise(0.4, false);
  EXPECT_EQ(poisoned.ierr, -22);
  EXPECT_EQ(poisoned.m, 55);
  Start<std::int32_t> bad_guess(Family(kron(8, 1)), 3);
  bad_guess.x[2] = std::nan("");
  bad_guess.initialise(0.4, false);
  EXPECT_EQ(bad_guess.ierr, -24);
  EXPECT_EQ(bad_guess.xdot[0], 44.0);
  Start<std::int32_t> small(Family(kron(8, 1)), 3);
  --small.lrwork;
  small.initialise(0.4, false);
  EXPECT_EQ(small.ierr, -22);
}

TEST(Dgenrm, IsTheRootMeanSquareWithoutOverflow) {
  const double big = std::numeric_limits<double>::max() / 4.0, tiny = 1e-300;
  const auto norm = [](std::vector<double> v, std::vector<double> w) {
    const std::int32_t n = static_cast<std::int32_t>(v.size());
    const std::int64_t wide = n;
    const double value = dgenrm_(&n, v.data(), w.data());
    const double again = dgenrm_64_(&wide, v.data(), w.data());
    EXPECT_TRUE(value == again || (std::isnan(value) && std::isnan(again)));
    return value;
  };
  EXPECT_DOUBLE_EQ(norm({3.0, 4.0}, {1.0, 1.0}), 5.0 / std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(norm({3.0, -4.0}, {2.0, 0.5}), std::sqrt(20.0));
  EXPECT_DOUBLE_EQ(norm({big, big, big}, {1.0, -1.0, 1.0}), big);
  EXPECT_DOUBLE_EQ(norm({tiny, tiny}, {1.0, 1.0}), tiny);
  EXPECT_EQ(norm({0.0, 0.0}, {1.0, 1.0}), 0.0);
  EXPECT_EQ(norm({}, {}), 0.0);
  EXPECT_TRUE(std::isnan(norm({1.0, std::nan("")}, {1.0, 1.0})));
  EXPECT_TRUE(std::isinf(norm({1.0, HUGE_VAL}, {1.0, 1.0})));
}

}  // namespace sfdae_test
