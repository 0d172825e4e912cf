// SPDX-License-Identifier: BSD-3-Clause
// Sparse factorizations by all methods: residuals, scaling, pivots that become bad, singular matrices, copies,
// conditions.
#include "linalg/sparse_lu.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "linalg/random.h"
#include "matrix_checks.h"
#include "sparse_matrices.h"

namespace sfdae::core {

namespace {

using sfdae_test::SparseMatrix;
using ComplexNumber = std::complex<double>;

std::vector<SparseMethod> methods() {
  if (klu_is_available()) return {SparseMethod::dense, SparseMethod::band, SparseMethod::klu};
  return {SparseMethod::dense, SparseMethod::band};
}

std::vector<int> random_permutation(int size, unsigned seed) {
  std::vector<int> places(index(size));
  std::iota(places.begin(), places.end(), 0);
  std::shuffle(places.begin(), places.end(), std::minstd_rand(seed));
  return places;
}

SparseMatrix shuffled_rows(const SparseMatrix& matrix, unsigned seed) {
  const int n = matrix.pattern.size;
  return sfdae_test::permuted(matrix, random_permutation(n, seed), random_permutation(n, seed + 1));
}

struct NamedSparse {
  std::string name;
  SparseMatrix matrix;
};

std::vector<NamedSparse> sparse_matrices() {
  return {{"line", sfdae_test::reaction_diffusion(40)},
          {"line, shuffled", shuffled_rows(sfdae_test::reaction_diffusion(40), 3)},
          {"square", sfdae_test::laplacian(9, 7)},
          {"saddle point", sfdae_test::flow(6)},
          {"saddle point, shuffled", shuffled_rows(sfdae_test::flow(5), 8)},
          {"arrow", sfdae_test::arrow(60, 2)},
          {"full", sfdae_test::arrow(30, 30)},
          {"band", shuffled_rows(sfdae_test::random_band(80, 2, 5, 0.0, 4), 5)},
          {"random", sfdae_test::random_sparse(70, 2, 6)},
          {"one", sfdae_test::random_band(1, 0, 0, 2.0, 1)},
          {"two", sfdae_test::sparse_matrix(2, {{0, 1, 3.0}, {1, 0, -2.0}})}};
}

template <class Number>
Number number(std::minstd_rand& generator) {
  if constexpr (std::is_same_v<Number, double>) return symmetric_random(generator);
  else {
    const double real = symmetric_random(generator);
    return {real, symmetric_random(generator)};
  }
}

template <class Number>
std::vector<Number> random_numbers(std::size_t count, unsigned seed) {
  std::minstd_rand generator(seed);
  std::vector<Number> result(count);
  for (Number& value : result) value = number<Number>(generator);
  return result;
}

// The values of the matrix; complex ones get phases.
template <class Number>
std::vector<Number> values_of(const SparseMatrix& matrix) {
  std::minstd_rand generator(9);
  std::vector<Number> values(matrix.values.begin(), matrix.values.end());
  if constexpr (std::is_same_v<Number, ComplexNumber>)
    for (ComplexNumber& value : values) value *= std::polar(1.0, 0.3 * symmetric_random(generator));
  return values;
}

// The largest |b - op(A) x|_i / (|op(A)| |x| + |b|)_i: the smallest relative change of A and b that makes x a solution
// (Oettli and Prager, 1964).
template <class Number>
double backward_error(const SparsePattern& pattern, const std::vector<Number>& values, Op op, const Number* x,
                      const Number* b) {
  std::vector<Number> rest(b, b + pattern.size);
  std::vector<double> sizes(index(pattern.size));
  for (std::size_t i = 0; i < sizes.size(); ++i) sizes[i] = std::abs(b[i]);
  for (std::size_t j = 0; j < index(pattern.size); ++j)
    for (std::size_t k = index(pattern.first[j]); k < index(pattern.first[j + 1]); ++k) {
      const std::size_t i = index(pattern.row[k]);
      const std::size_t to = op == Op::plain ? i : j, from = op == Op::plain ? j : i;
      rest[to] -= values[k] * x[from];
      sizes[to] += std::abs(values[k] * x[from]);
    }
  double largest = 0.0;
  for (std::size_t i = 0; i < sizes.size(); ++i)
    if (std::abs(rest[i]) > 0.0) largest = std::max(largest, std::abs(rest[i]) / sizes[i]);
  return largest;
}

template <class Number>
void expect_solutions(SparseLu<Number>& lu, const SparseMatrix& matrix, const std::vector<Number>& values) {
  const std::size_t n = index(matrix.pattern.size);
  constexpr int count = 3;
  const std::vector<Number> b = random_numbers<Number>(count * n, 17);
  for (const Op op : {Op::plain, Op::transposed}) {
    std::vector<Number> x = b;
    if (op == Op::plain) lu.solve(x.data(), count);
    else lu.solve_transposed(x.data(), count);
    // Growth of factors with threshold pivoting, and rows of small |A| |x|, are worth a factor of 1000.
    for (std::size_t c = 0; c < count; ++c)
      EXPECT_LE(backward_error(matrix.pattern, values, op, x.data() + c * n, b.data() + c * n),
                1e3 * static_cast<double>(n) * sfdae_test::unit_roundoff);
  }
}

template <class Number>
class SparseLuOf : public testing::Test {};
using Numbers = testing::Types<double, ComplexNumber>;
TYPED_TEST_SUITE(SparseLuOf, Numbers);

}  // namespace

TYPED_TEST(SparseLuOf, SolvesWithSmallBackwardErrors) {
  for (const NamedSparse& named : sparse_matrices())
    for (const SparseMethod method : methods()) {
      SCOPED_TRACE(named.name + ", method " + std::to_string(static_cast<int>(method)));
      SparseLu<TypeParam> lu;
      lu.analyze(named.matrix.pattern, method);
      EXPECT_EQ(lu.method(), method);
      const std::vector<TypeParam> values = values_of<TypeParam>(named.matrix);
      ASSERT_TRUE(lu.factor(values.data()));
      expect_solutions(lu, named.matrix, values);
      EXPECT_GE(lu.fill(), named.matrix.pattern.size);
    }
}

TYPED_TEST(SparseLuOf, AgreesWithLapackOnFullMatrices) {
  const SparseMatrix matrix = sfdae_test::flow(6);
  const std::size_t n = index(matrix.pattern.size);
  const std::vector<TypeParam> values = values_of<TypeParam>(matrix), b = random_numbers<TypeParam>(n, 5);
  std::vector<TypeParam> full(n * n);
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t k = index(matrix.pattern.first[j]); k < index(matrix.pattern.first[j + 1]); ++k)
      full[index(matrix.pattern.row[k]) + n * j] = values[k];
  std::vector<int> pivots(n);
  const BasicView<TypeParam> view{full.data(), matrix.pattern.size, matrix.pattern.size, matrix.pattern.size};
  ASSERT_TRUE(factor_lu(view, pivots.data()));
  std::vector<TypeParam> expected = b;
  solve_lu(view, pivots.data(), expected.data());
  for (const SparseMethod method : methods()) {
    SparseLu<TypeParam> lu;
    lu.analyze(matrix.pattern, method);
    ASSERT_TRUE(lu.factor(values.data()));
    std::vector<TypeParam> x = b;
    lu.solve(x.data());
    const double bound = 100.0 * static_cast<double>(n) * sfdae_test::unit_roundoff / lu.reciprocal_condition();
    double size = 0.0;
    for (const TypeParam& value : expected) size = std::max(size, std::abs(value));
    for (std::size_t i = 0; i < n; ++i) EXPECT_LE(std::abs(x[i] - expected[i]), bound * size) << i;
  }
}

// Units of 1e-9 to 1e9 in rows and columns: powers of two do not round, so that solutions differ by rounding of the
// pivots chosen only.
TYPED_TEST(SparseLuOf, SolvesInAnyUnits) {
  for (const NamedSparse& named : sparse_matrices())
    for (const SparseMethod method : methods())
      for (const int range : {10, 20, 30}) {
        SCOPED_TRACE(named.name + ", method " + std::to_string(static_cast<int>(method)) + ", 2^" +
                     std::to_string(range));
        const SparsePattern& pattern = named.matrix.pattern;
        std::minstd_rand generator(21);
        std::vector<int> row(index(pattern.size)), column(row.size());
        for (int& unit : row) unit = static_cast<int>(range * symmetric_random(generator));
        for (int& unit : column) unit = static_cast<int>(range * symmetric_random(generator));
        const std::vector<TypeParam> plain = values_of<TypeParam>(named.matrix);
        std::vector<TypeParam> values = plain, x = random_numbers<TypeParam>(row.size(), 3);
        const std::vector<TypeParam> b = x;
        for (std::size_t j = 0; j < row.size(); ++j)
          for (std::size_t k = index(pattern.first[j]); k < index(pattern.first[j + 1]); ++k)
            values[k] = times_power_of_two(values[k], row[index(pattern.row[k])] + column[j]);
        for (std::size_t i = 0; i < row.size(); ++i) x[i] = times_power_of_two(x[i], row[i]);
        SparseLu<TypeParam> lu;
        lu.analyze(pattern, method);
        ASSERT_TRUE(lu.factor(values.data()));
        lu.solve(x.data());
        for (std::size_t j = 0; j < row.size(); ++j) x[j] = times_power_of_two(x[j], column[j]);
        EXPECT_LE(backward_error(pattern, plain, Op::plain, x.data(), b.data()),
                  1e4 * static_cast<double>(pattern.size) * sfdae_test::unit_roundoff);
      }
}

// New values at which the old pivots are zero, tiny, or far too small.
TYPED_TEST(SparseLuOf, TakesNewPivotsWhereOldOnesAreBad) {
  const SparseMatrix matrix = sfdae_test::random_band(60, 3, 3, 8.0, 2);
  for (const SparseMethod method : methods())
    for (const double pivot : {1.0, 0.0, 1e-10, 1e-18, 1e-200, 1e-308}) {
      SCOPED_TRACE(pivot);
      SparseLu<TypeParam> lu;
      lu.analyze(matrix.pattern, method);
      std::vector<TypeParam> values = values_of<TypeParam>(matrix);
      ASSERT_TRUE(lu.factor(values.data()));
      expect_solutions(lu, matrix, values);
      for (std::size_t j = 0; j < index(matrix.pattern.size); ++j)
        for (std::size_t k = index(matrix.pattern.first[j]); k < index(matrix.pattern.first[j + 1]); ++k)
          if (index(matrix.pattern.row[k]) == j) values[k] = pivot;
      ASSERT_TRUE(lu.factor(values.data()));
      expect_solutions(lu, matrix, values);
    }
}

TYPED_TEST(SparseLuOf, RefusesStructurallySingularPatterns) {
  for (const SparseMatrix& matrix :
       {sfdae_test::sparse_matrix(3, {}),
        sfdae_test::sparse_matrix(3, {{0, 0, 1.0}, {0, 1, 1.0}, {0, 2, 1.0}, {2, 2, 1.0}}),
        sfdae_test::sparse_matrix(1, {}),
        sfdae_test::sparse_matrix(3, {{0, 0, 1.0}, {0, 1, 1.0}, {1, 2, 1.0}, {2, 2, 1.0}})})
    for (const SparseMethod method : methods()) {
      SparseLu<TypeParam> lu;
      lu.analyze(matrix.pattern, method);
      EXPECT_FALSE(lu.factor(values_of<TypeParam>(matrix).data()));
      EXPECT_EQ(lu.reciprocal_condition(), 0.0);
    }
}

// After a failure good values are factored as if nothing had been.
TYPED_TEST(SparseLuOf, RefusesSingularAndNonFiniteValues) {
  const double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  for (const NamedSparse& named : sparse_matrices())
    for (const SparseMethod method : methods()) {
      SCOPED_TRACE(named.name);
      SparseLu<TypeParam> lu;
      lu.analyze(named.matrix.pattern, method);
      const std::vector<TypeParam> good = values_of<TypeParam>(named.matrix);
      for (const double bad : {nan, infinity, -infinity}) {
        std::vector<TypeParam> values = good;
        values[values.size() / 2] = bad;
        EXPECT_FALSE(lu.factor(values.data()));
        EXPECT_EQ(lu.reciprocal_condition(), 0.0);
      }
      std::vector<TypeParam> values = good;
      for (int k = named.matrix.pattern.first[0]; k < named.matrix.pattern.first[1]; ++k) values[index(k)] = 0.0;
      EXPECT_FALSE(lu.factor(values.data()));  // a column of zeros
      EXPECT_TRUE(lu.factor(good.data()));
      EXPECT_FALSE(lu.factor(std::vector<TypeParam>(good.size()).data()));
      ASSERT_TRUE(lu.factor(good.data()));
      expect_solutions(lu, named.matrix, good);
    }
}

// Two equal rows in exact arithmetic: the last pivot is 0.
TYPED_TEST(SparseLuOf, RefusesDependentRows) {
  const SparseMatrix matrix = sfdae_test::sparse_matrix(
      3, {{0, 0, 1.0}, {0, 1, 2.0}, {1, 0, 1.0}, {1, 1, 2.0}, {2, 2, 1.0}, {0, 2, 1.0}, {1, 2, 1.0}});
  for (const SparseMethod method : methods()) {
    SparseLu<TypeParam> lu;
    lu.analyze(matrix.pattern, method);
    EXPECT_FALSE(lu.factor(std::vector<TypeParam>(matrix.values.begin(), matrix.values.end()).data()));
  }
}

TYPED_TEST(SparseLuOf, SolvesForNothingWithoutUnknowns) {
  for (const SparseMethod method : methods()) {
    SparseLu<TypeParam> lu;
    lu.analyze(sfdae_test::sparse_matrix(0, {}).pattern, method);
    EXPECT_TRUE(lu.factor(nullptr));
    lu.solve(nullptr);
    lu.solve_transposed(nullptr, 2);
    EXPECT_EQ(lu.reciprocal_condition(), 1.0);
    EXPECT_EQ(lu.fill(), 0u);
  }
}

TYPED_TEST(SparseLuOf, CopiesGoOnWithTheSameBits) {
  const SparseMatrix matrix = sfdae_test::flow(8);
  const std::vector<TypeParam> values = values_of<TypeParam>(matrix),
                               b = random_numbers<TypeParam>(index(matrix.pattern.size), 5);
  std::vector<TypeParam> changed = values;
  for (TypeParam& value : changed) value *= 1.0 + 0.1 * std::abs(value);
  for (const SparseMethod method : methods()) {
    SparseLu<TypeParam> lu;
    lu.analyze(matrix.pattern, method);
    SparseLu<TypeParam> analyzed = lu;
    ASSERT_TRUE(lu.factor(values.data()));
    ASSERT_TRUE(lu.factor(changed.data()));
    SparseLu<TypeParam> copy = lu, assigned;
    assigned = lu;
    std::vector<TypeParam> x = b, y = b, z = b;
    copy.solve(y.data());
    ASSERT_TRUE(copy.factor(values.data()));  // leaves the others alone
    lu.solve(x.data());
    assigned.solve(z.data());
    EXPECT_EQ(x, y);
    EXPECT_EQ(x, z);
    ASSERT_TRUE(assigned.factor(values.data()));
    expect_solutions(assigned, matrix, values);
    ASSERT_TRUE(analyzed.factor(values.data()));
    const SparseLu<TypeParam> moved = std::move(assigned);
    EXPECT_EQ(moved.fill(), analyzed.fill());
  }
}

// Solutions of 1e200 and 1e-200, right-hand sides likewise, with rows and columns whose scales are beyond the
// exponents of double in sum.
TYPED_TEST(SparseLuOf, ScalesRightHandSidesWithoutOverflow) {
  const SparseMatrix matrix =
      sfdae_test::sparse_matrix(2, {{0, 0, 1e-200}, {0, 1, 1e-200}, {1, 0, 1e-200}, {1, 1, -1e-200}});
  const SparseMatrix large =
      sfdae_test::sparse_matrix(2, {{0, 0, 1e200}, {0, 1, 1e200}, {1, 0, 1e200}, {1, 1, -1e200}});
  for (const SparseMethod method : methods()) {
    SparseLu<TypeParam> lu;
    for (const double exponent : {0.0, 1.0}) {
      lu.analyze(matrix.pattern, method);
      ASSERT_TRUE(lu.factor(values_of<TypeParam>(exponent > 0.0 ? large : matrix).data()));
      std::vector<TypeParam> b = {TypeParam(exponent > 0.0 ? 1e200 : 1e100), TypeParam(0.0)};
      const std::vector<TypeParam> values = values_of<TypeParam>(exponent > 0.0 ? large : matrix), right = b;
      lu.solve(b.data());
      EXPECT_TRUE(std::isfinite(std::abs(b[0])));
      EXPECT_LE(backward_error(matrix.pattern, values, Op::plain, b.data(), right.data()),
                100.0 * sfdae_test::unit_roundoff);
    }
  }
}

TEST(SparseLu, EstimatesConditions) {
  for (const NamedSparse& named : sparse_matrices()) {
    const SparsePattern& pattern = named.matrix.pattern;
    const std::size_t n = index(pattern.size);
    // Entries scaled as the factorization does it.
    Equilibration scales;
    scales.compute({pattern.size, pattern.size, pattern.first.data(), pattern.row.data()},
                   named.matrix.values.data());
    Matrix full(pattern.size, pattern.size);
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t k = index(pattern.first[j]); k < index(pattern.first[j + 1]); ++k)
        full(pattern.row[k], static_cast<int>(j)) = times_power_of_two(
            named.matrix.values[k], scales.of_lines()[j] + scales.of_crossings()[index(pattern.row[k])]);
    const auto norm = [&](const Matrix& a) {
      double largest = 0.0;
      for (int j = 0; j < a.cols(); ++j) {
        double sum = 0.0;
        for (int i = 0; i < a.rows(); ++i) sum += std::fabs(a(i, j));
        largest = std::max(largest, sum);
      }
      return largest;
    };
    Matrix inverse = identity(pattern.size), factors = full;
    std::vector<int> pivots(n);
    ASSERT_TRUE(factor_lu(factors, pivots.data()));
    solve_lu(factors, pivots.data(), View(inverse));
    const double exact = 1.0 / (norm(full) * norm(inverse));
    for (const SparseMethod method : methods()) {
      SparseLu<double> lu;
      lu.analyze(pattern, method);
      ASSERT_TRUE(lu.factor(named.matrix.values.data()));
      EXPECT_GE(lu.reciprocal_condition(), 0.999 * exact) << named.name;
      EXPECT_LE(lu.reciprocal_condition(), 3.0 * exact) << named.name;  // [H88]: seldom more
    }
  }
}

// A bidiagonal matrix whose inverse overflows: no floating-point exception, 0.
TEST(SparseLu, EstimatesZeroWhereTheInverseOverflows) {
  std::vector<sfdae_test::Triplet> entries;
  for (int i = 0; i < 400; ++i) {
    entries.push_back({i, i, i == 399 ? 1.0 : 0x1p-10});
    if (i > 0) entries.push_back({i - 1, i, 1.0});
  }
  const SparseMatrix matrix = sfdae_test::sparse_matrix(400, entries);
  for (const SparseMethod method : methods()) {
    SparseLu<double> lu;
    lu.analyze(matrix.pattern, method);
    if (lu.factor(matrix.values.data())) {
      EXPECT_EQ(lu.reciprocal_condition(), 0.0);
    }
  }
}

TEST(SparseLu, ChoosesFullMatricesAndBands) {
  SparseLu<double> lu;
  lu.analyze(sfdae_test::arrow(100, 80).pattern);
  EXPECT_EQ(lu.method(), SparseMethod::dense);
  lu.analyze(sfdae_test::flow(20).pattern);
  EXPECT_EQ(lu.method(), SparseMethod::band);
  lu.analyze(sfdae_test::laplacian(60, 60).pattern);
  EXPECT_EQ(lu.method(), klu_is_available() ? SparseMethod::klu : SparseMethod::band);
}

// Quotients, scaled by powers of two as ever: the bits of KLU.
TEST(SparseLu, DividesByDiagonalMatrices) {
  const int n = 50;
  std::vector<sfdae_test::Triplet> entries;
  for (int i = 0; i < n; ++i) entries.push_back({i, i, std::ldexp(1.1 + 0.3 * std::sin(i), 40 * (i % 5 - 2))});
  const SparseMatrix matrix = sfdae_test::sparse_matrix(n, entries);
  SparseLu<double> lu, other;
  lu.analyze(matrix.pattern);
  EXPECT_EQ(lu.method(), SparseMethod::diagonal);
  for (const SparseMethod method : methods()) {
    other.analyze(matrix.pattern, method);
    ASSERT_TRUE(lu.factor(matrix.values.data()) && other.factor(matrix.values.data()));
    std::vector<double> b(3 * index(n)), of_other;
    for (std::size_t i = 0; i < b.size(); ++i) b[i] = std::cos(static_cast<double>(i));
    of_other = b;
    lu.solve(b.data(), 2);
    lu.solve_transposed(b.data() + 2 * n);
    other.solve(of_other.data(), 2);
    other.solve_transposed(of_other.data() + 2 * n);
    for (std::size_t i = 0; i < b.size(); ++i)
      EXPECT_NEAR(b[i], of_other[i], 4.0 * sfdae_test::unit_roundoff * std::fabs(b[i]));
    EXPECT_NEAR(lu.reciprocal_condition(), other.reciprocal_condition(), 1e-12);
    EXPECT_NEAR(lu.determinant().log2, other.determinant().log2, 1e-9);
    if (method == SparseMethod::klu) {
      EXPECT_EQ(b, of_other);
      EXPECT_EQ(lu.reciprocal_condition(), other.reciprocal_condition());
      EXPECT_EQ(lu.fill(), other.fill());
    }
  }
  std::vector<double> singular = matrix.values;
  singular[7] = 0.0;
  EXPECT_FALSE(lu.factor(singular.data()));
  SparseLu<double> zero_line;
  zero_line.analyze(sfdae_test::sparse_matrix(2, {{0, 0, 1.0}}).pattern);
  EXPECT_NE(zero_line.method(), SparseMethod::diagonal);
}

// Values may stand where the factorization scales them.
TEST(SparseLu, TakesItsOwnValues) {
  for (const NamedSparse& named : sparse_matrices())
    for (const SparseMethod method : methods()) {
      SparseLu<double> lu, other;
      lu.analyze(named.matrix.pattern, method);
      other.analyze(named.matrix.pattern, method);
      for (const double factor : {1.0, 3.0}) {
        std::vector<double> values = named.matrix.values;
        for (double& value : values) value *= factor;
        std::copy(values.begin(), values.end(), lu.own_values());
        ASSERT_TRUE(lu.factor(lu.own_values()) && other.factor(values.data())) << named.name;
        std::vector<double> b(index(named.matrix.pattern.size), 1.0), of_other = b;
        lu.solve(b.data());
        other.solve(of_other.data());
        EXPECT_EQ(b, of_other) << named.name;
      }
    }
}

// A band of one off-diagonal line takes a few solutions, a full matrix n / 45 of them and more (2/3 n^3 operations at
// three times the speed of 2 n^2), and both kinds the more the more is filled in.
TEST(SparseLu, EstimatesWhatFactorizationsTake) {
  const auto cost = [](const SparsePattern& pattern) {
    SparseLu<double> lu;
    lu.analyze(pattern);
    return lu.factorization_in_solutions();
  };
  const double line = cost(sfdae_test::laplacian(2000, 1).pattern);
  EXPECT_GT(line, 0.5);
  EXPECT_LT(line, 10.0);
  EXPECT_GT(cost(sfdae_test::laplacian(60, 60).pattern), 2.0 * line);
  SparseLu<double> full;
  full.analyze(sfdae_test::laplacian(20, 20).pattern, SparseMethod::dense);
  EXPECT_GT(full.factorization_in_solutions(), 400.0 / 45.0);
}

}  // namespace sfdae::core
