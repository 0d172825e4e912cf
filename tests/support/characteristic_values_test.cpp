// SPDX-License-Identifier: BSD-3-Clause
// Characteristic values of the test problems, read off singular values of the whole derivative array.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <ostream>
#include <vector>

#include "linear_family.h"
#include "random_family.h"
#include "testset_linear.h"

extern "C" void dgesvd_(const char* jobu, const char* jobvt, const int* m, const int* n, double* a, const int* lda,
                        double* s, double* u, const int* ldu, double* vt, const int* ldvt, double* work,
                        const int* lwork, int* info);

namespace sfdae_test {

// For messages of EXPECT_EQ.
void PrintTo(const CharacteristicValues& c, std::ostream* out) {
  *out << "mu " << c.mu << ", d " << c.d << ", a " << c.a << ", u " << c.u << ", v " << c.v;
}

namespace {

std::size_t size(int i) { return static_cast<std::size_t>(i); }

double max_abs(const std::vector<double>& x) {
  double largest = 0.0;
  for (double value : x) largest = std::max(largest, std::abs(value));
  return largest;
}

struct Matrix {
  int rows, columns;
  std::vector<double> data;
  Matrix(int r, int c) : rows(r), columns(c), data(size(r) * size(c)) {}
  double& operator()(int i, int j) { return data[size(i) + size(j) * size(rows)]; }
  double operator()(int i, int j) const { return data[size(i) + size(j) * size(rows)]; }
};

struct Svd {
  std::vector<double> values;
  Matrix U, VT;
};

Svd svd(Matrix M) {
  const int k = std::min(M.rows, M.columns), workspace = 10 * (M.rows + M.columns) + 100;
  Svd result{std::vector<double>(size(k)), Matrix(M.rows, M.rows), Matrix(M.columns, M.columns)};
  if (k == 0) {
    for (int i = 0; i < M.rows; ++i) result.U(i, i) = 1.0;
    for (int i = 0; i < M.columns; ++i) result.VT(i, i) = 1.0;
    return result;
  }
  std::vector<double> work(size(workspace));
  int info = 0;
  dgesvd_("A", "A", &M.rows, &M.columns, M.data.data(), &M.rows, result.values.data(), result.U.data.data(), &M.rows,
          result.VT.data.data(), &M.columns, work.data(), &workspace, &info);
  EXPECT_EQ(info, 0);
  return result;
}

Matrix product(const Matrix& A, const Matrix& B) {
  Matrix C(A.rows, B.columns);
  for (int j = 0; j < B.columns; ++j)
    for (int l = 0; l < A.columns; ++l)
      for (int i = 0; i < A.rows; ++i) C(i, j) += A(i, l) * B(l, j);
  return C;
}

// Zero is what lies below 1e-9 |data|; the reading is clear if nothing lies between 1e-12 and 1e-7.
struct Reading {
  bool clear = true;
  int rank(const std::vector<double>& values, double norm) {
    int r = 0;
    for (double s : values) {
      if (s > 1e-9 * norm) ++r;
      if (s > 1e-12 * norm && s < 1e-7 * norm) clear = false;
    }
    return r;
  }
};

// Taylor coefficients of E and A with the rows divided by the largest entry they have in any coefficient.
struct Coefficients {
  int m, n, order;
  std::vector<double> E, A;
  Coefficients(const LinearFamily& p, double t, int l) : m(p.m()), n(p.n()), order(l) {
    const int length = m * n * (l + 1);
    E.resize(size(length));
    A.resize(size(length));
    p.matrix_coefficients(t, l, E.data(), A.data());
    for (int i = 0; i < m; ++i) {
      double largest = 0.0;
      for (int j = i; j < length; j += m) largest = std::max({largest, std::abs(E[size(j)]), std::abs(A[size(j)])});
      for (int j = i; largest > 0.0 && j < length; j += m) {
        E[size(j)] /= largest;
        A[size(j)] /= largest;
      }
    }
  }
  double E_at(int k, int i, int j) const { return E[size(i + j * m + k * m * n)]; }
  double A_at(int k, int i, int j) const { return k < 0 ? 0.0 : A[size(i + j * m + k * m * n)]; }
};

struct LevelValues {
  int a, v_hat, rank_ET2;
  bool clear;
};

// M y = N x + g with block (i, j) of M: E_{i+1-j} - A_{i-j}/j, j = 1..l+1, and block i of N: A_i, i = 0..l.
// Z^T M = 0, a = rank(Z^T N), v_hat = corank [N M], A2 T2 = 0 for A2 = Z^T N.
LevelValues level_values(const Coefficients& c, int l) {
  const int m = c.m, n = c.n;
  Matrix M((l + 1) * m, (l + 1) * n), N((l + 1) * m, n), E(m, n);
  for (int i = 0; i <= l; ++i)
    for (int r = 0; r < m; ++r)
      for (int s = 0; s < n; ++s) {
        N(i * m + r, s) = c.A_at(i, r, s);
        for (int j = 1; j <= i + 1; ++j)
          M(i * m + r, (j - 1) * n + s) = c.E_at(i + 1 - j, r, s) - c.A_at(i - j, r, s) / j;
      }
  for (int r = 0; r < m; ++r)
    for (int s = 0; s < n; ++s) E(r, s) = c.E_at(0, r, s);
  const double norm = std::max({max_abs(M.data), max_abs(N.data), std::numeric_limits<double>::min()});

  Reading reading;
  const Svd M_svd = svd(M);
  const int rank_M = reading.rank(M_svd.values, norm);
  Matrix ZT(M.rows - rank_M, M.rows);
  for (int i = 0; i < ZT.rows; ++i)
    for (int j = 0; j < M.rows; ++j) ZT(i, j) = M_svd.U(j, rank_M + i);

  const Svd A2_svd = svd(product(ZT, N));
  const int a = reading.rank(A2_svd.values, norm);
  Matrix T2(n, n - a);
  for (int i = 0; i < n - a; ++i)
    for (int j = 0; j < n; ++j) T2(j, i) = A2_svd.VT(a + i, j);

  const int rank_ET2 = reading.rank(svd(product(E, T2)).values, norm);
  return {a, ZT.rows - a, rank_ET2, reading.clear};
}

struct Determination {
  CharacteristicValues values;
  bool clear;
};

Determination characteristic_values(const LinearFamily& p, double t, int max_level) {
  bool clear = true;
  int v_hat = 0;
  for (int l = 0; l <= max_level; ++l) {
    const LevelValues level = level_values(Coefficients(p, t, l), l);
    clear = clear && level.clear;
    const int v = level.v_hat - v_hat, d = p.m() - level.a - v;
    v_hat = level.v_hat;
    if (level.rank_ET2 == d) return {{l, d, level.a, p.n() - d - level.a, v}, clear};
  }
  return {{-1, 0, 0, 0, 0}, clear};
}

// Number of families whose values the singular values do not show clearly.
int expect_characteristic_values(const std::vector<std::unique_ptr<LinearFamily>>& families, double t) {
  int unclear = 0;
  for (const auto& family : families) {
    SCOPED_TRACE(family->name());
    const Determination found = characteristic_values(*family, t, family->values().mu + 1);
    if (found.clear) EXPECT_EQ(found.values, family->values());
    else ++unclear;
  }
  return unclear;
}

std::vector<std::unique_ptr<LinearFamily>> random_families(int first_seed, int last_seed, const RandomOptions& o) {
  std::vector<std::unique_ptr<LinearFamily>> families;
  for (int seed = first_seed; seed <= last_seed; ++seed)
    families.push_back(random_family(static_cast<std::uint64_t>(seed), o));
  return families;
}

}  // namespace

TEST(CharacteristicValues, OfTheTestSetAreThoseOfTheDerivativeArray) {
  for (const LinearTestProblem& p : linear_testset()) {
    SCOPED_TRACE(p.family->name());
    const Determination found =
        characteristic_values(*p.family, p.t0 + 0.21 * (p.tf - p.t0), p.family->values().mu + 1);
    EXPECT_TRUE(found.clear);
    EXPECT_EQ(found.values, p.family->values());
  }
}

TEST(CharacteristicValues, ChangeWhereTheProblemsSayThatTheyDo) {
  EXPECT_EQ(characteristic_values(*changing_structure(0.4).family, 0.41, 1).values,
            (CharacteristicValues{0, 1, 1, 0, 0}));
  EXPECT_EQ(characteristic_values(*vanishing_E().family, 0.5, 1).values, (CharacteristicValues{0, 1, 1, 0, 0}));
  EXPECT_EQ(characteristic_values(*vanishing_A().family, 0.5, 1).values, (CharacteristicValues{0, 1, 0, 1, 1}));
  EXPECT_EQ(characteristic_values(*rankdrop_t().family, 0.0, 2).values, (CharacteristicValues{0, 0, 2, 0, 0}));
}

TEST(CharacteristicValues, OfKnownFamiliesAreThoseOfTheDerivativeArray) {
  std::vector<std::unique_ptr<LinearFamily>> families;
  for (int mu = 0; mu <= 3; ++mu)
    for (int n : {5, 8, 13}) families.push_back(kron(n, mu));
  families.push_back(kron(9, 2, 0.5, 2));
  families.push_back(chain(4, 1));
  families.push_back(chain(6, 3));
  families.push_back(spin(-5.0, 1.0));
  families.push_back(rotated_ode(RowOperation::rotation, 5.0));
  families.push_back(rotated_ode(RowOperation::scaling, 5.0));
  EXPECT_EQ(expect_characteristic_values(families, 0.3), 0);
}

// Turning at moderate speed the singular values leave a clear gap, and the values that the problem was built from
// must come out.
TEST(CharacteristicValues, OfRandomFamiliesAreThoseOfTheDerivativeArray) {
  EXPECT_EQ(expect_characteristic_values(random_families(1, 400, {.max_size = 10}), 0.3), 0);
  EXPECT_EQ(expect_characteristic_values(random_families(401, 450, {.w = 1.0}), 0.3), 0);
}

// At four times the speed some gaps close; those that are left must not mislead.
TEST(CharacteristicValues, OfFastRandomFamiliesAreRightWhereTheGapIsClear) {
  EXPECT_LT(expect_characteristic_values(random_families(1, 100, {.max_size = 10, .w = 4.0}), 0.3), 50);
}

TEST(CharacteristicValues, OfRandomFamiliesSurviveRowScaling) {
  EXPECT_EQ(expect_characteristic_values(random_families(1, 50, {.max_size = 10, .row_decades = 10}), 0.3), 0);
}

}  // namespace sfdae_test
