// SPDX-License-Identifier: BSD-3-Clause
// Bases among the columns of sparse matrices, against dense factorizations: condition, rank, classes, units.
#include "linalg/column_basis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "linalg/arena.h"
#include "linalg/dense.h"
#include "linalg/equilibration.h"
#include "linalg/random.h"
#include "matrix_checks.h"
#include "sparse_matrices.h"

namespace sfdae::core {

namespace {

SparseRows sparse(const Matrix& a) {
  SparseRows rows;
  rows.columns = a.cols();
  rows.first.assign(1, 0);
  for (int i = 0; i < a.rows(); ++i) {
    for (int j = 0; j < a.cols(); ++j)
      if (a(i, j) != 0.0) {
        rows.column.push_back(j);
        rows.value.push_back(a(i, j));
      }
    rows.first.push_back(static_cast<int>(rows.column.size()));
  }
  return rows;
}

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  int below(int end) { return static_cast<int>(generator_() / 7 % static_cast<unsigned>(end)); }
  double symmetric() { return symmetric_random(generator_); }

 private:
  std::minstd_rand generator_;
};

// A transversal, and `per_row` further entries in each row; entries at one place replace each other.
Matrix random_rows(int rows, int columns, int per_row, unsigned seed) {
  Random random(seed);
  Matrix a(rows, columns);
  std::vector<int> columns_in_order(index(columns));
  std::iota(columns_in_order.begin(), columns_in_order.end(), 0);
  for (int i = columns - 1; i > 0; --i)
    std::swap(columns_in_order[index(i)], columns_in_order[index(random.below(i + 1))]);
  for (int i = 0; i < rows; ++i) {
    for (int k = 0; k < per_row; ++k) a(i, random.below(columns)) = random.symmetric();
    a(i, columns_in_order[index(i)]) = random.symmetric() < 0.0 ? -1.0 : 1.0;
  }
  return a;
}

// Some rows become sums of others.
void make_dependent(Matrix& a, int count, unsigned seed) {
  Random random(seed);
  for (int dependent = 0; dependent < count; ++dependent) {
    const int first = random.below(a.rows() - count), second = random.below(a.rows() - count);
    for (int j = 0; j < a.cols(); ++j) a(a.rows() - 1 - dependent, j) = a(first, j) + 0.5 * a(second, j);
  }
}

std::vector<int> random_classes(int columns, int classes, unsigned seed) {
  Random random(seed);
  std::vector<int> result(index(columns));
  for (int& value : result) value = random.below(classes);
  return result;
}

// As column_basis() scales them: conditions are those of this matrix.
Matrix scaled(const Matrix& a) {
  const SparseRows rows = sparse(a);
  Equilibration scales;
  scales.compute({rows.rows(), rows.columns, rows.first.data(), rows.column.data()}, rows.value.data());
  Matrix result = a;
  for (int j = 0; j < a.cols(); ++j)
    for (int i = 0; i < a.rows(); ++i)
      result(i, j) = times_power_of_two(a(i, j), scales.of_lines()[index(i)] + scales.of_crossings()[index(j)]);
  return result;
}

Matrix submatrix(const Matrix& a, const std::vector<int>& rows, const std::vector<int>& columns) {
  Matrix result(static_cast<int>(rows.size()), static_cast<int>(columns.size()));
  for (int j = 0; j < result.cols(); ++j)
    for (int i = 0; i < result.rows(); ++i) result(i, j) = a(rows[index(i)], columns[index(j)]);
  return result;
}

struct Basis {
  std::vector<int> rows, columns;
};

Basis basis_of(const ColumnBasis& found) {
  Basis basis;
  for (std::size_t i = 0; i < found.column_of_row.size(); ++i)
    if (found.column_of_row[i] >= 0) {
      basis.rows.push_back(static_cast<int>(i));
      basis.columns.push_back(found.column_of_row[i]);
    }
  return basis;
}

double smallest_singular_value(const Matrix& a) { return a.rows() == 0 ? 1.0 : singular_values(a).back(); }

int rank_of(const Matrix& a) {
  if (a.rows() == 0 || a.cols() == 0) return 0;
  const std::vector<double> values = singular_values(a);
  return static_cast<int>(
      std::count_if(values.begin(), values.end(), [&](double s) { return s > 1e-10 * values[0]; }));
}

// The smallest singular value of the columns that a QR factorization with column pivoting takes.
double pivoted_qr_value(const Matrix& a) {
  Matrix factors = a;
  std::vector<int> pivots(index(a.cols()));
  std::vector<double> tau(index(a.cols()));
  Arena arena;
  factor_qr_pivoted(factors, pivots.data(), tau.data(), arena);
  pivots.resize(index(a.rows()));
  std::vector<int> rows(index(a.rows()));
  std::iota(rows.begin(), rows.end(), 0);
  return smallest_singular_value(submatrix(a, rows, pivots));
}

// Rows, columns left over and rank belong together; as many columns of the lowest classes as there can be.
void expect_consistent(const Matrix& a, const ColumnBasis& found, const BasisSettings& settings) {
  const Basis basis = basis_of(found);
  EXPECT_EQ(found.rank, static_cast<int>(basis.rows.size()));
  std::set<int> all(basis.columns.begin(), basis.columns.end());
  EXPECT_EQ(all.size(), basis.columns.size());
  all.insert(found.left_over.begin(), found.left_over.end());
  EXPECT_EQ(static_cast<int>(all.size()), a.cols());
  EXPECT_EQ(basis.columns.size() + found.left_over.size(), index(a.cols()));
  const Matrix units = scaled(a);
  EXPECT_EQ(found.rank, rank_of(units));
  EXPECT_GT(smallest_singular_value(submatrix(units, basis.rows, basis.columns)), 1e-9);

  if (settings.classes.empty()) return;
  std::vector<int> rows(index(a.rows()));
  std::iota(rows.begin(), rows.end(), 0);
  const int highest = *std::max_element(settings.classes.begin(), settings.classes.end());
  for (int bound = 0; bound <= highest; ++bound) {
    std::vector<int> columns;
    for (int j = 0; j < a.cols(); ++j)
      if (settings.classes[index(j)] <= bound) columns.push_back(j);
    const auto basic = std::count_if(basis.columns.begin(), basis.columns.end(),
                                     [&](int j) { return settings.classes[index(j)] <= bound; });
    const int possible = rank_of(submatrix(units, rows, columns));
    EXPECT_EQ(basic, possible) << bound << " " << singular_values(submatrix(units, rows, columns)).back();
    if (bound == 0) {
      EXPECT_EQ(found.has_all_of_class_0, possible == static_cast<int>(columns.size()));
    }
  }
}

}  // namespace

TEST(ColumnBasis, IsNearlyAsWellConditionedAsThatOfPivotedQr) {
  double sum = 0.0;
  int count = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const int rows = 10 + static_cast<int>(seed), columns = rows + static_cast<int>(seed % 30);
    const Matrix a = random_rows(rows, columns, 1 + static_cast<int>(seed % 4), seed);
    const ColumnBasis found = column_basis(sparse(a));
    expect_consistent(a, found, {});
    const Matrix units = scaled(a);
    const Basis basis = basis_of(found);
    const double value = smallest_singular_value(submatrix(units, basis.rows, basis.columns));
    const double best = pivoted_qr_value(units);
    EXPECT_GT(value, 1e-3 * best) << seed;  // threshold pivoting has no bound that is better than exponential
    sum += std::log(best / value);
    ++count;
    EXPECT_GE(found.fill, index(rows));
  }
  EXPECT_LT(std::exp(sum / count), 5.0);
}

TEST(ColumnBasis, LeavesDependentRowsOut) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const int rows = 12 + static_cast<int>(seed);
    Matrix a = random_rows(rows, rows + 5, 2, seed);
    const int dependent = 1 + static_cast<int>(seed % 5);
    make_dependent(a, dependent, seed);
    const ColumnBasis found = column_basis(sparse(a));
    expect_consistent(a, found, {});
    EXPECT_EQ(found.rank, rows - dependent);
    for (std::size_t i = 0; i < index(rows); ++i) {
      const bool is_dependent = found.column_of_row[i] < 0;
      EXPECT_TRUE(is_dependent ? found.remaining[i] < 1e-12 : found.remaining[i] > 1e-9) << found.remaining[i];
    }
  }
}

TEST(ColumnBasis, TakesAsManyColumnsOfLowClassesAsPossible) {
  int exchanges = 0, complete = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const int rows = 5 + static_cast<int>(seed % 40), columns = rows + static_cast<int>(seed % 23);
    Matrix a = random_rows(rows, columns, static_cast<int>(seed % 4), seed);
    if (seed % 3 == 0) make_dependent(a, 2, seed);
    BasisSettings settings;
    settings.classes = random_classes(columns, 1 + static_cast<int>(seed % 5), seed);
    const ColumnBasis found = column_basis(sparse(a), settings);
    expect_consistent(a, found, settings);
    exchanges += found.exchanges;
    complete += found.has_all_of_class_0;
  }
  EXPECT_GT(exchanges, 30);  // otherwise the tests test nothing
  EXPECT_GT(complete, 10);
  EXPECT_LT(complete, 190);
}

// Row 0 would take column 0 of class 1, as column 1 is small there; all else in column 1 is zero.
TEST(ColumnBasis, ExchangesWhatTheThresholdRefused) {
  Matrix a(2, 3);
  a(0, 0) = 1.0;
  a(0, 1) = 1e-3;
  a(1, 0) = 1.0;
  a(1, 1) = 1.0;
  a(1, 2) = 1.0;
  BasisSettings settings;
  settings.classes = {1, 0, 0};
  settings.order = {0, 1};
  const ColumnBasis found = column_basis(sparse(a), settings);
  EXPECT_EQ(found.exchanges, 1);
  EXPECT_TRUE(found.has_all_of_class_0);
  EXPECT_EQ(found.left_over, std::vector<int>{0});
}

// Two wanted columns that are equal: one of them is left over, whatever is tried.
TEST(ColumnBasis, ReportsWantedColumnsThatAreDependent) {
  Matrix a(2, 3);
  a(0, 0) = a(0, 1) = 1.0;
  a(1, 0) = a(1, 1) = 2.0;
  a(1, 2) = 1.0;
  BasisSettings settings;
  settings.classes = {0, 0, 1};
  const ColumnBasis found = column_basis(sparse(a), settings);
  EXPECT_FALSE(found.has_all_of_class_0);
  ASSERT_EQ(found.left_over.size(), 1u);
  EXPECT_LT(found.left_over[0], 2);
  EXPECT_EQ(found.rank, 2);
}

TEST(ColumnBasis, HasTheSameClassesInRowsOfOtherUnits) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    Matrix a = random_rows(40, 55, 3, seed), other = a;
    Random random(seed);
    for (int i = 0; i < a.rows(); ++i) {
      const int unit = static_cast<int>(13.0 * random.symmetric());
      for (int j = 0; j < a.cols(); ++j) other(i, j) = times_power_of_two(other(i, j), unit);
    }
    BasisSettings settings;
    settings.classes = random_classes(55, 3, seed);
    const ColumnBasis found = column_basis(sparse(other), settings);
    expect_consistent(a, found, settings);
    EXPECT_EQ(found.rank, 40);
  }
}

// Units of 1e-6 to 1e6 for rows and columns.
TEST(ColumnBasis, IsWellConditionedInAnyUnits) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const int rows = 20 + static_cast<int>(seed % 30);
    const Matrix plain = random_rows(rows, rows + 12, 3, seed);
    Matrix a = plain;
    Random random(seed + 1000);
    std::vector<double> row(index(a.rows())), column(index(a.cols()));
    for (double& unit : row) unit = std::pow(10.0, 6.0 * random.symmetric());
    for (double& unit : column) unit = std::pow(10.0, 6.0 * random.symmetric());
    for (int j = 0; j < a.cols(); ++j)
      for (int i = 0; i < a.rows(); ++i) a(i, j) *= row[index(i)] * column[index(j)];
    const ColumnBasis found = column_basis(sparse(a));
    EXPECT_EQ(found.rank, rows);
    const Basis basis = basis_of(found);
    EXPECT_GT(smallest_singular_value(submatrix(plain, basis.rows, basis.columns)), 1e-5 * pivoted_qr_value(plain))
        << seed;
  }
}

TEST(ColumnBasis, OfASquareMatrixIsAllOfIt) {
  const Matrix a = random_rows(30, 30, 3, 4);
  const ColumnBasis found = column_basis(sparse(a));
  expect_consistent(a, found, {});
  EXPECT_TRUE(found.left_over.empty());
  EXPECT_TRUE(found.has_all_of_class_0);
}

TEST(ColumnBasis, OfNothingIsEmpty) {
  SparseRows none;
  none.columns = 3;
  for (int pass = 0; pass < 2; ++pass) {
    const ColumnBasis found = column_basis(none);
    EXPECT_EQ(found.rank, 0);
    EXPECT_EQ(found.left_over.size(), 3u);
    EXPECT_FALSE(found.has_all_of_class_0);
    none.first = {0};
  }
  const ColumnBasis zero = column_basis(sparse(Matrix(2, 2)));
  EXPECT_EQ(zero.column_of_row, (std::vector<int>{-1, -1}));
  EXPECT_EQ(zero.remaining, (std::vector<double>{0.0, 0.0}));
  EXPECT_TRUE(column_basis(SparseRows()).has_all_of_class_0);
}

TEST(ColumnBasis, FollowsAGivenOrderOfRows) {
  Matrix a(2, 2);
  a(0, 0) = a(1, 0) = a(1, 1) = 1.0;
  a(0, 1) = 0.9;
  BasisSettings settings;
  settings.order = {1, 0};
  EXPECT_EQ(column_basis(sparse(a), settings).rank, 2);
}

}  // namespace sfdae::core
