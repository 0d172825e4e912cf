// SPDX-License-Identifier: BSD-3-Clause
// DNFOTR, DNFRED, DNFIX1: projectors and strangeness-free systems by their defining properties.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "family_caller.h"
#include "linalg/dense.h"
#include "random_family.h"
#include "testset_linear.h"

namespace sfdae_test {

namespace {

using sfdae::core::ConstView;
using sfdae::core::Matrix;
using sfdae::core::singular_values;
using sfdae::core::to_matrix;
using ReducedFamily = std::shared_ptr<const LinearFamily>;

std::vector<std::pair<ReducedFamily, double>> problems_to_reduce() {
  std::vector<std::pair<ReducedFamily, double>> problems;
  for (LinearTestProblem& p : linear_testset()) {
    const double t = p.t0 + 0.3 * (p.tf - p.t0);
    if (p.family->m() == p.family->n()) problems.emplace_back(std::move(p.family), t);
  }
  for (int mu = 0; mu <= 3; ++mu) problems.emplace_back(ReducedFamily(kron(8, mu)), 0.4);
  problems.emplace_back(ReducedFamily(kron(9, 1, 0.5, 2)), 0.4);
  problems.emplace_back(ReducedFamily(chain(4, 1, 2.0, 100.0)), 0.4);
  RandomOptions options;
  options.max_size = 8;
  options.max_mu = 3;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    ReducedFamily family(random_family(seed, options));
    if (family->m() == family->n()) problems.emplace_back(std::move(family), 0.2);
  }
  return problems;
}

double smallest_singular_value(ConstView a) {
  const std::vector<double> s = singular_values(a);
  return s.empty() ? 1.0 : s.back();
}

// Rows made comparable first: equations may be written in any unit.
double smallest_singular_value_of_rows(Matrix a) {
  for (int i = 0; i < a.rows(); ++i) {
    const double row = largest(a.view().block(i, 0, 1, a.cols()));
    for (int j = 0; j < a.cols() && row > 0.0; ++j) a(i, j) /= row;
  }
  return smallest_singular_value(a);
}

// How much rounding errors of [EQ AQ] matter: a null vector of EQ is known to eps |EQ| / s_r.
template <class I>
double amplification(const Call<I>& call) {
  const int nq = call.nq(), n = call.family->n();
  const ConstView EQ = call.EQ.block(nq, nq);
  const std::vector<double> s = singular_values(EQ);
  const double least = call.ireq > 0 ? s[size(static_cast<int>(call.ireq) - 1)] : 1.0;
  const double norm = std::max(1.0, std::max(largest(EQ), largest(call.AQ.block(nq, n))));
  return norm * norm / std::min(1.0, least);
}

// Z2, Z3, Z1 as they were left in ZQ and Z1.
template <class I>
void expect_projectors(const Call<I>& call) {
  const int nq = call.nq(), n = call.family->n(), rank = static_cast<int>(call.ireq);
  const int a = static_cast<int>(call.a), d = static_cast<int>(call.d);
  const ConstView EQ = call.EQ.block(nq, nq), AQ = call.AQ.block(nq, n), E = EQ.block(0, 0, n, n);
  const double norm = std::max({1.0, largest(EQ), largest(AQ)});
  if (rank == nq) {
    EXPECT_EQ(distance(call.ZQ.block(nq, nq), unit_matrix(nq)), 0.0);
    EXPECT_EQ(distance(call.Z1.block(n, n), unit_matrix(n)), 0.0);
    return;
  }
  const ConstView Z = call.ZQ.block(nq, nq).columns(0, nq - rank), Z2 = Z.columns(0, a);
  EXPECT_LE(orthonormality_defect(Z), rounding(nq));
  EXPECT_LE(largest(times(transposed(Z), EQ)), rounding(nq) * norm);
  EXPECT_LE(largest(times(transposed(Z.columns(a, nq - rank - a)), AQ)), rounding(nq) * amplification(call));
  const Matrix A2 = times(transposed(Z2), AQ);
  if (a > 0) {
    EXPECT_GT(smallest_singular_value_of_rows(A2), 1e3 * rounding(nq));
  }
  if (d == 0) {
    EXPECT_TRUE(call.Z1.is_untouched());
    return;
  }
  // T2 spans ker A2; E T2 lies in the range of Z1 and fills it.
  const Matrix T2 = to_matrix(sfdae::core::svd(A2).V.view().columns(a, n - a));
  const ConstView Z1 = call.Z1.block(n, d);
  const Matrix ET = times(E, T2);
  EXPECT_LE(orthonormality_defect(Z1), rounding(n));
  EXPECT_LE(outside_range(Z1, ET), rounding(nq) * amplification(call) / std::min(1.0, smallest_singular_value(A2)));
  const std::vector<double> s = singular_values(times(transposed(Z1), ET));
  EXPECT_GT(s[size(d - 1)], 0.5 * singular_values(ET)[size(d - 1)]);
}

// The exact solution satisfies E x' = A x + f, row by row.
double residual(const Matrix& E, const Matrix& A, ConstView F, const ExactSolution& exact) {
  const std::vector<double> left = times(E, exact.xdot.data()), right = times(A, exact.x.data());
  double worst = 0.0;
  for (int i = 0; i < E.rows(); ++i) worst = std::max(worst, std::fabs(left[size(i)] - right[size(i)] - F(i, 0)));
  return worst;
}

template <class I>
void expect_reduced_system(const Call<I>& call, double t) {
  const int n = call.family->n(), nq = call.nq(), a = static_cast<int>(call.a), d = static_cast<int>(call.d);
  const Matrix E = to_matrix(call.E.block(n, n)), A = to_matrix(call.A.block(n, n));
  EXPECT_EQ(largest(E.view().block(d, 0, n - d, n)), 0.0);
  EXPECT_EQ(largest(A.view().block(d + a, 0, n - d - a, n)), 0.0);
  // u = 0: [E1; A2] is nonsingular.
  if (call.u == 0) {
    Matrix both = A;
    sfdae::core::copy(E.view().top(d), both.view().top(d));
    EXPECT_GT(smallest_singular_value_of_rows(both), 1e3 * rounding(nq));
  }
  if (!call.family->has_exact()) return;
  const ExactSolution exact = exact_solution(*call.family, t);
  const double x = std::max({1.0, largest(exact.x), largest(exact.xdot), largest(call.FQ.block(nq, 1))});
  EXPECT_LE(residual(E, A, call.F.block(n, 1), exact), rounding(nq) * amplification(call) * x);
  EXPECT_TRUE(call.E.padding_kept() && call.A.padding_kept() && call.F.padding_kept());
}

}  // namespace

TEST(Dnfred, GivesProjectorsAndASystemThatTheSolutionSatisfies) {
  for (auto& [family, t] : problems_to_reduce()) {
    SCOPED_TRACE(family->name());
    Call<std::int32_t> call(family, family->values().mu);
    call.find(t);
    ASSERT_EQ(call.ierr, 0);
    call.reduce();
    ASSERT_EQ(call.ierr, 0);
    expect_projectors(call);
    expect_reduced_system(call, t);
  }
}

TEST(Dnfred, IsTheSameWithIntegersOf64Bits) {
  for (int mu = 0; mu <= 2; ++mu) {
    Call<std::int64_t> call(ReducedFamily(kron(8, mu)), 3);
    call.find(0.4, second_underscore_entries());
    call.reduce(second_underscore_entries());
    ASSERT_EQ(call.ierr, 0);
    expect_projectors(call);
    expect_reduced_system(call, 0.4);
  }
}

// Rows of size 1e-12 ... 1e12 in the unscaled system: the small ones keep their digits.
TEST(Dnfred, KeepsRowsOfVeryDifferentSize) {
  for (double factor : {1e-10, 1e10}) {
    const ReducedFamily family(scaled_row(factor).family);
    Call<std::int32_t> call(family, 2);
    call.find(0.3);
    ASSERT_EQ(call.ierr, 0);
    EXPECT_EQ(call.d, family->values().d);
    EXPECT_EQ(call.a, family->values().a);
    call.reduce();
    ASSERT_EQ(call.ierr, 0);
    const int n = family->n();
    const ExactSolution exact = exact_solution(*family, 0.3);
    const Matrix E = to_matrix(call.E.block(n, n)), A = to_matrix(call.A.block(n, n));
    const std::vector<double> left = times(E, exact.xdot.data()), right = times(A, exact.x.data());
    for (int i = 0; i < n; ++i) {
      const double row = std::max(largest(E.view().block(i, 0, 1, n)), largest(A.view().block(i, 0, 1, n)));
      EXPECT_LE(std::fabs(left[size(i)] - right[size(i)] - call.F.block(n, 1)(i, 0)), rounding(n) * row);
    }
  }
}

namespace {

// The solution satisfies each row to `tolerance` times the size of that row.
void expect_accurate_rows(const ReducedFamily& family, double tolerance) {
  Call<std::int32_t> call(family, family->values().mu);
  call.find(0.2);
  ASSERT_EQ(call.ierr, 0);
  ASSERT_EQ(call.m, family->values().mu);
  call.reduce();
  ASSERT_EQ(call.ierr, 0);
  const int n = family->n();
  const ExactSolution exact = exact_solution(*family, 0.2);
  const double x = std::max({1.0, largest(exact.x), largest(exact.xdot)});
  const Matrix E = to_matrix(call.E.block(n, n)), A = to_matrix(call.A.block(n, n));
  const std::vector<double> left = times(E, exact.xdot.data()), right = times(A, exact.x.data());
  for (int i = 0; i < call.d + call.a; ++i) {
    const double row = std::max(largest(E.view().block(i, 0, 1, n)), largest(A.view().block(i, 0, 1, n)));
    EXPECT_LE(std::fabs(left[size(i)] - right[size(i)] - call.F.block(n, 1)(i, 0)),
              rounding(call.nq()) * tolerance * row * x);
  }
}

}  // namespace

// Rows of random problems are multiplied by 10^k, |k| <= decades. The last two seeds have redundant rows of zeros
// besides, and coefficients that turn fast.
TEST(Dnfred, KeepsRowsOfRandomProblemsInRandomUnits) {
  RandomOptions options;
  options.max_size = 12;
  options.max_mu = 3;
  for (int decades : {3, 6}) {
    options.row_decades = decades;
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
      const ReducedFamily family(random_family(seed, options));
      SCOPED_TRACE(testing::Message() << family->name() << ", decades " << decades);
      if (family->m() == family->n()) expect_accurate_rows(family, std::pow(10.0, decades));
    }
  }
  options = {};
  options.row_decades = 6;
  options.w = 5.0;
  for (std::uint64_t seed : {176u, 1116u}) expect_accurate_rows(ReducedFamily(random_family(seed, options)), 1e6);
}

// The rest of F is what the redundant equations contradict each other by.
TEST(Dnfred, ReportsContradictionsInTheLastEntriesOfF) {
  int tried = 0;
  for (std::uint64_t seed = 1; tried < 10; ++seed) {
    RandomOptions options;
    options.max_size = 8;
    options.mu = 0;
    const CharacteristicValues values = random_family(seed, options)->values();
    if (values.u == 0 || values.u != values.v) continue;
    ++tried;
    for (double rho : {0.0, 1.0}) {
      options.rho = rho;
      Call<std::int32_t> call(ReducedFamily(random_family(seed, options)), 1);
      call.find(0.4);
      ASSERT_EQ(call.ierr, 0);
      call.reduce();
      ASSERT_EQ(call.ierr, 0);
      const ConstView rest = call.F.block(call.n, 1).block(call.d + call.a, 0, call.u, 1);
      if (rho == 0.0)
        EXPECT_LE(largest(rest), rounding(call.n) * std::max(1.0, largest(call.FQ.block(call.nq(), 1))));
      else EXPECT_GT(largest(rest), 1e-3) << seed;
    }
  }
}

TEST(Dnfred, RefusesWrongArgumentsAndTouchesNothing) {
  const auto expect_refused = [](int expected, auto change) {
    Call<std::int32_t> call(ReducedFamily(kron(5, 1)), 1);
    call.find(0.1);
    const Matrix ZQ = to_matrix(call.ZQ.block(call.nq(), call.nq()));
    change(call);
    call.reduce();
    EXPECT_EQ(call.ierr, expected);
    EXPECT_TRUE(call.E.is_untouched() && call.A.is_untouched() && call.F.is_untouched() && call.Z1.is_untouched());
    if (expected != -4) {
      EXPECT_EQ(distance(call.ZQ.block(10, 10), ZQ), 0.0);
    }
  };
  expect_refused(-5, [](auto& call) { call.lrwork = 3 * 5 + 2 * 10 + 2 * 100 - 1; });
  expect_refused(-3, [](auto& call) { call.n = 0; });
  expect_refused(-3, [](auto& call) { call.a = 6; });
  expect_refused(-3, [](auto& call) { call.a = -1; });
  expect_refused(-3, [](auto& call) { call.ireq = 11; });
  expect_refused(-3, [](auto& call) { call.ireq = 9; });
  expect_refused(-3, [](auto& call) { call.m = 200, call.lrwork = 2147483647; });
  expect_refused(-4, [](auto& call) { call.EQ.block(10, 10)(3, 3) = std::nan(""); });
  expect_refused(-4, [](auto& call) { call.AQ.block(10, 5)(3, 3) = HUGE_VAL; });
  expect_refused(-4, [](auto& call) { call.ZQ.block(10, 10)(3, 9) = std::nan(""); });
}

namespace {

// DNFOTR for what DNFIND left in `call`.
struct Transformed {
  explicit Transformed(Call<int>& call, int lrwork = -1, int leading = -1)
      : Z2Q(call.nq(), call.nq()), Z1(call.n, call.n) {
    const int nq = call.nq(), n = call.n, kernel = nq - call.ireq, ld = call.EQ.ld;
    const int ld_z = leading < 0 ? Z2Q.ld : leading;
    if (lrwork < 0) lrwork = 3 * n + 2 * nq + 2 * nq * nq;
    sfdae::core::copy(call.ZQ.block(nq, nq).columns(call.ireq, kernel), Z2Q.block(nq, kernel));
    dnfotr_(&n, &nq, &call.d, &call.a, &call.ireq, call.EQ.data(), &ld, call.AQ.data(), &ld, Z2Q.data(), &ld_z,
            Z1.data(), &Z1.ld, nullptr, &ld, nullptr, &lrwork, &ierr);
  }
  PaddedArray Z2Q, Z1;
  int ierr = 10;
};

}  // namespace

TEST(Dnfotr, GivesWhatDnfredUses) {
  for (int mu = 0; mu <= 2; ++mu) {
    Call<int> call(ReducedFamily(kron(7, mu)), 3);
    call.find(0.4);
    ASSERT_EQ(call.ierr, 0);
    const Transformed found(call);
    EXPECT_EQ(found.ierr, 0);
    call.reduce();
    const int nq = call.nq(), kernel = nq - call.ireq;
    EXPECT_EQ(distance(found.Z2Q.block(nq, kernel), call.ZQ.block(nq, kernel)), 0.0);
    EXPECT_EQ(distance(found.Z1.block(call.n, call.d), call.Z1.block(call.n, call.d)), 0.0);
    EXPECT_TRUE(found.Z2Q.padding_kept(nq, kernel) && found.Z1.padding_kept(call.n, call.d));
  }
}

TEST(Dnfotr, GivesIdentitiesForAnOde) {
  Call<int> call(ReducedFamily(rotated_ode(RowOperation::rotation)), 1);
  call.find(0.4);
  ASSERT_EQ(call.ireq, 2);
  const Transformed found(call);
  EXPECT_EQ(found.ierr, 0);
  EXPECT_EQ(distance(found.Z2Q.block(2, 2), unit_matrix(2)), 0.0);
  EXPECT_EQ(distance(found.Z1.block(2, 2), unit_matrix(2)), 0.0);
}

TEST(Dnfotr, RefusesShortWorkSpaceAndNaN) {
  Call<int> call(ReducedFamily(kron(5, 1)), 1);
  call.find(0.1);
  const Transformed refused(call, 3 * 5 + 2 * 10 + 2 * 100 - 1);
  EXPECT_EQ(refused.ierr, -5);
  EXPECT_TRUE(refused.Z1.is_untouched());
  EXPECT_EQ(Transformed(call, -1, 9).ierr, -3);
  call.AQ.block(10, 5)(9, 0) = std::nan("");
  EXPECT_EQ(Transformed(call).ierr, -4);
}

namespace {

template <class I>
struct Fixed : Call<I> {
  using Call<I>::Call;

  // The values expected are those of the family unless set.
  void fix(double t, bool constant = false, const Entries<I>& entry = entries<I>()) {
    const I ld = static_cast<I>(this->EQ.ld), ld_n = static_cast<I>(this->E.ld), mconst = constant ? 1 : 0;
    this->ierr = 77;
    entry.dnfix1(edif<I>, adif<I>, fdif<I>, &this->n, &t, &this->lmax, &known_m, &known_d, &known_a, &known_u,
                 &this->ireq, &this->m, &this->d, &this->a, &this->u, this->E.data(), &ld_n, this->A.data(), &ld_n,
                 this->F.data(), this->EQ.data(), &ld, this->AQ.data(), &ld, this->FQ.data(), this->Z1.data(), &ld_n,
                 this->ZQ.data(), &ld, this->AH.data(), &ld, nullptr, this->rpar(), nullptr, &this->lrwork, &mconst,
                 &this->ierr);
  }
  I known_m = static_cast<I>(this->family->values().mu), known_d = static_cast<I>(this->family->values().d),
    known_a = static_cast<I>(this->family->values().a), known_u = static_cast<I>(this->family->values().u);
};

}  // namespace

// mu = 0 is reduced like any other index.
TEST(Dnfix1, GivesTheReducedSystem) {
  for (int mu = 0; mu <= 2; ++mu) {
    Fixed<std::int32_t> call(ReducedFamily(kron(8, mu)), 3);
    call.fix(0.4);
    ASSERT_EQ(call.ierr, 0);
    expect_projectors(call);
    expect_reduced_system(call, 0.4);
    EXPECT_GT(call.a, 0);
    Fixed<std::int64_t> wide(ReducedFamily(kron(8, mu)), 3);
    wide.fix(0.4, false, second_underscore_entries());
    ASSERT_EQ(wide.ierr, 0);
    EXPECT_EQ(distance(wide.A.block(8, 8), call.A.block(8, 8)), 0.0);
  }
}

TEST(Dnfix1, UsesTransformationsAgainIfMatricesAreConstant) {
  for (int mu = 0; mu <= 2; ++mu) {
    const ReducedFamily family(kron(8, mu, 0.0));
    Fixed<std::int32_t> call(family, 3);
    call.fix(0.1);
    ASSERT_EQ(call.ierr, 0);
    const Matrix E = to_matrix(call.E.block(8, 8)), A = to_matrix(call.A.block(8, 8));
    call.user.sequence.clear();
    call.m = 66;
    call.fix(0.7, true);
    ASSERT_EQ(call.ierr, 0);
    EXPECT_EQ(call.user.sequence, std::vector<char>(size(mu + 1), 'f'));
    EXPECT_EQ(call.m, 66);
    EXPECT_EQ(distance(call.E.block(8, 8), E), 0.0);
    call.m = call.known_m;
    EXPECT_LE(residual(E, A, call.F.block(8, 1), exact_solution(*family, 0.7)), rounding(8) * amplification(call));
    call.user.highest_order = -1;
    call.fix(0.7, true);
    EXPECT_EQ(call.ierr, -2);
    call.user.highest_order = 5;
    call.user.poison = true;
    call.fix(0.7, true);
    EXPECT_EQ(call.ierr, -1);
    call.known_a = 9;
    call.fix(0.7, true);
    EXPECT_EQ(call.ierr, -22);
  }
}

TEST(Dnfix1, ReportsValuesThatChanged) {
  Fixed<std::int32_t> call(ReducedFamily(kron(8, 1)), 3);
  --call.known_d;
  call.fix(0.4);
  EXPECT_EQ(call.ierr, -26);
  EXPECT_EQ(call.m, 1);
  EXPECT_EQ(call.d, call.known_d + 1);
  EXPECT_TRUE(call.E.is_untouched() && call.F.is_untouched());

  Fixed<std::int32_t> higher(ReducedFamily(kron(8, 2)), 1);
  higher.fix(0.4);
  EXPECT_EQ(higher.ierr, -26);
  EXPECT_EQ(higher.m, -1);
}

TEST(Dnfix1, CallsAllFailuresOfDnfindBy22) {
  const auto expect_22 = [](auto change) {
    Fixed<std::int32_t> call(ReducedFamily(kron(5, 1)), 2);
    change(call);
    call.fix(0.1);
    EXPECT_EQ(call.ierr, -22);
    EXPECT_TRUE(call.E.is_untouched() && call.F.is_untouched() && call.EQ.is_untouched());
  };
  expect_22([](auto& call) { call.user.highest_order = 0; });
  expect_22([](auto& call) { call.user.poison = true; });
  expect_22([](auto& call) { --call.lrwork; });
  expect_22([](auto& call) { call.n = 0; });
}

}  // namespace sfdae_test
