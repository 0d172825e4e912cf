// SPDX-License-Identifier: BSD-3-Clause
// DNFPEN, DNFVAL, DNFIND: derivative arrays and characteristic values of families that are known.

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
using sfdae::core::to_matrix;
using Family = std::shared_ptr<const LinearFamily>;

double binomial(int n, int k) {
  if (k < 0 || k > n) return 0.0;
  return std::round(factorial(n) / (factorial(k) * factorial(n - k)));
}

// The definition, entry by entry.
Matrix array_of(const LinearFamily& family, double t, int level) {
  const int n = family.n();
  Matrix EQ((level + 1) * n, (level + 1) * n);
  for (int i = 0; i <= level; ++i)
    for (int j = 0; j <= i; ++j) {
      const Matrix E = derivative(family, 'E', t, i - j);
      const Matrix A = j < i ? derivative(family, 'A', t, i - j - 1) : Matrix(n, n);
      for (int col = 0; col < n; ++col)
        for (int row = 0; row < n; ++row)
          EQ(i * n + row, j * n + col) = binomial(i, j) * E(row, col) - binomial(i, j + 1) * A(row, col);
    }
  return EQ;
}

void expect_stage(const LinearFamily& family, double t, int level, ConstView EQ, ConstView AQ, ConstView FQ) {
  const int n = family.n();
  const Matrix expected = array_of(family, t, level);
  EXPECT_LE(distance(EQ, expected), rounding(1) * std::max(1.0, largest(expected)));
  for (int k = 0; k <= level; ++k) {
    EXPECT_EQ(distance(AQ.block(k * n, 0, n, n), derivative(family, 'A', t, k)), 0.0);
    Matrix f(n, 1);
    family.f(t, k, f.data());
    EXPECT_EQ(distance(FQ.block(k * n, 0, n, 1), f), 0.0);
  }
}

std::vector<std::pair<Family, double>> square_problems() {
  std::vector<std::pair<Family, double>> problems;
  for (LinearTestProblem& p : linear_testset()) {
    const double t = p.t0 + 0.3 * (p.tf - p.t0);
    if (p.family->m() == p.family->n()) problems.emplace_back(std::move(p.family), t);
  }
  for (int mu = 0; mu <= 4; ++mu) problems.emplace_back(Family(kron(8, mu)), 0.4);
  problems.emplace_back(Family(kron(9, 1, 0.5, 2)), 0.4);
  problems.emplace_back(Family(chain(4, 1, 2.0, 100.0)), 0.4);
  return problems;
}

template <class I>
void expect_defining_properties(const Call<I>& call, double t) {
  const CharacteristicValues values = call.family->values();
  ASSERT_EQ(call.ierr, 0);
  ASSERT_EQ(call.m, values.mu);
  EXPECT_EQ(call.d, values.d);
  EXPECT_EQ(call.a, values.a);
  EXPECT_EQ(call.u, values.u);
  const int nq = call.nq(), n = call.family->n(), rank = static_cast<int>(call.ireq);
  const ConstView EQ = call.EQ.block(nq, nq);
  expect_stage(*call.family, t, values.mu, EQ, call.AQ.block(nq, n), call.FQ.block(nq, 1));
  for (int k = 0; k <= values.mu; ++k)
    EXPECT_EQ(distance(call.AH.block(nq, n).block(k * n, 0, n, n), derivative(*call.family, 'E', t, k)), 0.0);
  const ConstView ZQ = call.ZQ.block(nq, nq), Z = ZQ.columns(rank, nq - rank);
  EXPECT_LE(orthonormality_defect(ZQ), rounding(nq));
  EXPECT_LE(largest(times(transposed(Z), EQ)), rounding(nq) * largest(EQ));
  // ZQ^T EQ = S V^T: rows orthogonal to each other, no zero rows above the null space.
  const Matrix rows = times(transposed(ZQ.columns(0, rank)), EQ);
  const Matrix gram = times(rows, transposed(rows));
  const double norm = largest(gram);
  for (int i = 0; i < rank; ++i)
    for (int j = 0; j < i; ++j) EXPECT_LE(std::fabs(gram(i, j)), rounding(nq) * norm);
  EXPECT_TRUE(call.EQ.padding_kept(nq, nq) && call.ZQ.padding_kept(nq, nq) && call.AQ.padding_kept(nq, n) &&
              call.AH.padding_kept(nq, n) && call.FQ.padding_kept(nq, 1));
}

}  // namespace

TEST(Dnfpen, BuildsTheArrayStageByStage) {
  Call<int> call(Family(kron(5, 2)), 3);
  const double t = 0.3;
  const int ld = call.EQ.ld;
  for (int level = 0; level <= 3; ++level) {
    int ierr = 0;
    dnfpen_(edif<int>, adif<int>, fdif<int>, &call.n, &t, &level, call.AH.data(), &ld, call.EQ.data(), &ld,
            call.AQ.data(), &ld, call.FQ.data(), nullptr, call.rpar(), &ierr);
    ASSERT_EQ(ierr, 0);
    const int nq = 5 * (level + 1);
    expect_stage(*call.family, t, level, call.EQ.block(nq, nq), call.AQ.block(nq, 5), call.FQ.block(nq, 1));
    EXPECT_TRUE(call.EQ.padding_kept(nq, nq) && call.AQ.padding_kept(nq, 5) && call.AH.padding_kept(nq, 5));
  }
}

TEST(Dnfpen, RefusesWrongArgumentsAndTouchesNothing) {
  Call<int> call(Family(kron(5, 2)), 1);
  const double t = 0.3;
  const auto ierr_of = [&](int n, int level, int ld) {
    int ierr = 0;
    dnfpen_(edif<int>, adif<int>, fdif<int>, &n, &t, &level, call.AH.data(), &ld, call.EQ.data(), &ld, call.AQ.data(),
            &ld, call.FQ.data(), nullptr, call.rpar(), &ierr);
    return ierr;
  };
  EXPECT_EQ(ierr_of(0, 0, 10), -3);
  EXPECT_EQ(ierr_of(-4, 0, 10), -3);
  EXPECT_EQ(ierr_of(5, -1, 10), -3);
  EXPECT_EQ(ierr_of(5, 1, 9), -3);
  EXPECT_EQ(ierr_of(5, 2147483647, 9), -3);
  EXPECT_TRUE(call.EQ.is_untouched() && call.AQ.is_untouched() && call.AH.is_untouched() && call.FQ.is_untouched());
  EXPECT_EQ(call.user.calls, 0);
}

TEST(Dnfpen, PassesOnWhatFunctionsReturn) {
  const double t = 0.3;
  for (const auto& [code, expected] : {std::pair{-1, -1}, {-2, -2}, {1, -1}, {-17, -1}}) {
    Call<int> call(Family(kron(5, 2)), 1);
    call.user.failing_order = 0;
    call.user.failing_code = code;
    const int ld = call.EQ.ld, level = 0;
    int ierr = 0;
    dnfpen_(edif<int>, adif<int>, fdif<int>, &call.n, &t, &level, call.AH.data(), &ld, call.EQ.data(), &ld,
            call.AQ.data(), &ld, call.FQ.data(), nullptr, call.rpar(), &ierr);
    EXPECT_EQ(ierr, expected);
  }
}

TEST(Dnfind, FindsTheValuesAndTheNullSpaceOfKnownProblems) {
  for (auto& [family, t] : square_problems()) {
    SCOPED_TRACE(family->name());
    Call<std::int32_t> call(family, std::max(family->values().mu, 3));
    call.find(t);
    expect_defining_properties(call, t);
    EXPECT_EQ(call.user.highest_asked, family->values().mu);
    EXPECT_EQ(call.user.calls, 3 * (family->values().mu + 1));
  }
}

TEST(Dnfind, IsTheSameWithIntegersOf64Bits) {
  const Family family(kron(8, 2));
  Call<std::int64_t> call(family, 3), again(family, 3);
  call.find(0.4);
  expect_defining_properties(call, 0.4);
  again.find(0.4, second_underscore_entries());
  expect_defining_properties(again, 0.4);
}

TEST(Dnfind, FindsTheValuesOfRandomProblems) {
  RandomOptions options;
  options.max_size = 10;
  options.max_mu = 3;
  int tried = 0;
  for (std::uint64_t seed = 1; tried < 200; ++seed) {
    const Family family(random_family(seed, options));
    if (family->m() != family->n()) continue;
    ++tried;
    SCOPED_TRACE(family->name());
    Call<std::int32_t> call(family, family->values().mu);
    call.find(0.2);
    expect_defining_properties(call, 0.2);
  }
}

TEST(Dnfind, AsksEachFunctionOnceAnOrderInTheDocumentedSequence) {
  Call<std::int32_t> call(Family(kron(6, 2)), 3);
  call.find(0.1);
  EXPECT_EQ(call.user.sequence, (std::vector<char>{'E', 'A', 'f', 'E', 'A', 'f', 'E', 'A', 'f'}));
}

TEST(Dnfind, SaysMinusOneWhenTheIndexIsHigherThanAllowed) {
  for (int most : {0, 1, 2}) {
    Call<std::int32_t> call(Family(kron(8, 3)), most);
    call.find(0.4);
    EXPECT_EQ(call.ierr, 0);
    EXPECT_EQ(call.m, -1);
    EXPECT_EQ(call.user.highest_asked, most);
    EXPECT_TRUE(call.EQ.is_untouched() && call.ZQ.is_untouched());
  }
}

TEST(Dnfind, LooksAtThePointAlone) {
  // E = [0 t; 0 0], A = I: at t = 0 purely algebraic, elsewhere of index 1.
  Call<std::int32_t> call(Family(rankdrop_t().family), 3);
  call.find(0.0);
  EXPECT_EQ(call.ierr, 0);
  EXPECT_EQ(call.m, 0);
  EXPECT_EQ(call.a, 2);
}

TEST(Dnfind, RefusesWrongArgumentsAndTouchesNothing) {
  const auto expect_refused = [](int expected, auto change) {
    Call<std::int32_t> call(Family(kron(5, 1)), 2);
    change(call);
    call.find(0.1);
    EXPECT_EQ(call.ierr, expected);
    EXPECT_EQ(call.m, 55);
    EXPECT_TRUE(call.EQ.is_untouched() && call.ZQ.is_untouched() && call.AQ.is_untouched());
  };
  expect_refused(-3, [](auto& call) { call.n = 0; });
  expect_refused(-3, [](auto& call) { call.n = -2; });
  expect_refused(-3, [](auto& call) { call.lmax = -1; });
  expect_refused(-3, [](auto& call) { call.lmax = 4; });  // leading dimensions are too small
  expect_refused(-3, [](auto& call) { call.lmax = 2147483647; });
  expect_refused(-5, [](auto& call) { --call.lrwork; });
  expect_refused(-5, [](auto& call) { call.lrwork = -1; });
  expect_refused(-2, [](auto& call) { call.user.highest_order = 0; });
  expect_refused(-1, [](auto& call) { call.user.poison = true; });
  expect_refused(-1, [](auto& call) { call.user.failing_order = 1, call.user.failing_code = 5; });
  expect_refused(-2, [](auto& call) { call.user.failing_order = 1, call.user.failing_code = -2; });
  Call<std::int32_t> call(Family(kron(5, 1)), 2);
  call.find(std::nan(""));
  EXPECT_EQ(call.ierr, -3);
}

TEST(Dnfind, NoticesFunctionsOfTheOtherWidth) {
  Call<std::int64_t> call(Family(kron(5, 1)), 2);
  const double t = 0.1;
  const std::int64_t ld = call.EQ.ld;
  const auto narrow_edif = [](const std::int64_t*, const double*, const std::int64_t*, double*, const std::int64_t*,
                              std::int64_t*, double*, std::int64_t* ierr) {
    *reinterpret_cast<unsigned char*>(ierr) = 0xff;  // what -1 of 32 bits leaves, byte by byte
    for (int i = 1; i < 4; ++i) reinterpret_cast<unsigned char*>(ierr)[i] = 0xff;
  };
  dnfind_64_(narrow_edif, adif<std::int64_t>, fdif<std::int64_t>, &call.n, &t, &call.lmax, &call.m, &call.d, &call.a,
             &call.u, &call.ireq, call.AH.data(), &ld, call.EQ.data(), &ld, call.AQ.data(), &ld, call.FQ.data(),
             call.ZQ.data(), &ld, nullptr, call.rpar(), nullptr, &call.lrwork, &call.ierr);
  EXPECT_EQ(call.ierr, -140);
}

namespace {

struct PairResult {
  int r = 9, a = 9, s = 9, d = 9, u = 9, ierr = 9;
  Matrix ZQ;
};

PairResult pair_values(const Matrix& EQ, const Matrix& AQ, int lrwork = -1) {
  PairResult result;
  const int n = AQ.cols(), nq = EQ.rows();
  if (lrwork < 0) lrwork = 3 * nq * nq + 6 * nq;
  result.ZQ = Matrix(nq, nq);
  dnfval_(&n, &nq, EQ.data(), &nq, AQ.data(), &nq, &result.r, &result.a, &result.s, &result.d, &result.u,
          result.ZQ.data(), &nq, nullptr, &lrwork, &result.ierr);
  return result;
}

}  // namespace

// A pair equivalent to [I_d 0 0; 0 I_s 0; 0; 0; 0], [0; 0; 0 I_a; I_s; 0]: hidden by nonsingular P, Q, rows scaled.
TEST(Dnfval, FindsTheInvariantsOfAPair) {
  for (int d = 0; d <= 2; ++d)
    for (int s = 0; s <= 2; ++s)
      for (int a = 0; a <= 2; ++a)
        for (int u = 0; u <= 1; ++u) {
          const int n = d + 2 * s + a + u;
          if (n == 0) continue;
          Matrix E(n, n), A(n, n);
          for (int i = 0; i < d + s; ++i) E(i, i) = 1.0;
          for (int i = 0; i < a; ++i) A(d + s + i, d + s + i) = 1.0;
          for (int i = 0; i < s; ++i) A(d + s + a + i, d + i) = 1.0;
          const Matrix P = random_matrix(n, n, 3), Q = random_matrix(n, n, 4);
          Matrix EQ = times(times(P, E), Q), AQ = times(times(P, A), Q);
          for (int j = 0; j < n; ++j) {
            EQ(0, j) *= 1e-9;
            AQ(0, j) *= 1e-9;
          }
          const PairResult found = pair_values(EQ, AQ);
          SCOPED_TRACE(testing::Message() << "d " << d << " s " << s << " a " << a << " u " << u);
          ASSERT_EQ(found.ierr, 0);
          EXPECT_EQ(found.r, d + s);
          EXPECT_EQ(found.a, a);
          EXPECT_EQ(found.s, s);
          EXPECT_EQ(found.d, d);
          EXPECT_EQ(found.u, n - found.r - a - s);
          EXPECT_LE(orthonormality_defect(found.ZQ), rounding(n));
          const Matrix Z = to_matrix(found.ZQ.view().columns(found.r, n - found.r));
          EXPECT_LE(largest(times(transposed(Z), EQ)), rounding(n) * std::max(1.0, largest(EQ)));
        }
}

// E T2 of rounding errors alone: the rank of a product is not judged against itself.
TEST(Dnfval, DoesNotTakeRoundingErrorsForEquations) {
  const Matrix Q = random_matrix(6, 6, 1);
  Matrix N(6, 6);
  for (int i = 0; i < 3; ++i) N(i, i) = 1.0;
  const Matrix EQ = times(times(Q, N), transposed(Q));
  const PairResult found = pair_values(EQ, EQ);  // A = E: Z^T A = 0 but for rounding
  EXPECT_EQ(found.r, 3);
  EXPECT_EQ(found.a, 0);
  EXPECT_EQ(found.s, 0);
  EXPECT_EQ(found.u, 3);
}

TEST(Dnfval, GivesTheValuesOfTheArraysThatDnfindMakes) {
  for (auto& [family, t] : square_problems()) {
    SCOPED_TRACE(family->name());
    Call<std::int32_t> call(family, family->values().mu);
    call.find(t);
    ASSERT_EQ(call.ierr, 0);
    const int nq = call.nq();
    const PairResult found = pair_values(to_matrix(call.EQ.block(nq, nq)), to_matrix(call.AQ.block(nq, family->n())));
    EXPECT_EQ(found.ierr, 0);
    EXPECT_EQ(found.r, call.ireq);
  }
}

TEST(Dnfval, RefusesNaNAndShortWorkSpace) {
  const Matrix EQ = random_matrix(4, 4, 1), AQ = random_matrix(4, 2, 2);
  EXPECT_EQ(pair_values(EQ, AQ).ierr, 0);
  EXPECT_EQ(pair_values(EQ, AQ, 3 * 16 + 24 - 1).ierr, -5);
  EXPECT_EQ(pair_values(EQ, AQ, 3 * 16 + 24 - 1).r, 9);
  for (double bad : {std::nan(""), HUGE_VAL}) {
    Matrix poisoned = EQ;
    poisoned(2, 3) = bad;
    const PairResult found = pair_values(poisoned, AQ);
    EXPECT_EQ(found.ierr, -4);
    EXPECT_EQ(found.r, 9);
    EXPECT_EQ(largest(found.ZQ), 0.0);
    Matrix poisoned_A = AQ;
    poisoned_A(0, 1) = bad;
    EXPECT_EQ(pair_values(EQ, poisoned_A).ierr, -4);
  }
}

}  // namespace sfdae_test
