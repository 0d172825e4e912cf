// SPDX-License-Identifier: BSD-3-Clause
// Views address what they say, copies copy, norms and finiteness see every entry.
#include "linalg/matrix.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "matrix_checks.h"

namespace sfdae::core {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

// 3 x 2 inside an array with leading dimension 5; entries 10 i + j, the rest is marked.
struct Padded {
  std::vector<double> entries = std::vector<double>(10, -1.0);
  View view{entries.data(), 3, 2, 5};
  Padded() {
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 3; ++i) view(i, j) = 10.0 * i + j;
  }
};

}  // namespace

TEST(View, AddressesColumnsByTheLeadingDimension) {
  const Padded a;
  EXPECT_EQ(a.entries[7], 21.0);
  EXPECT_EQ(a.view.column(1), a.entries.data() + 5);
}

TEST(View, BlocksColumnsAndTopRowsShareTheEntries) {
  const Padded a;
  const View block = a.view.block(1, 1, 2, 1), right = a.view.columns(1, 1), top = a.view.top(2);
  EXPECT_EQ(block(0, 0), 11.0);
  EXPECT_EQ(block(1, 0), 21.0);
  EXPECT_EQ(right(2, 0), 21.0);
  EXPECT_EQ(right.rows, 3);
  EXPECT_EQ(top(1, 1), 11.0);
  EXPECT_EQ(top.rows, 2);
  block(0, 0) = 5.0;
  EXPECT_EQ(a.view(1, 1), 5.0);
}

// Columns a power of two apart fall into the same cache sets from 64 doubles (one page of 512 bytes) on.
TEST(PaddedRows, AreEnoughAndNoPowerOfTwoFromSixtyFourOn) {
  for (int rows = 0; rows <= 5000; ++rows) {
    const int ld = padded_rows(rows);
    EXPECT_GE(ld, std::max(rows, 1));
    EXPECT_LE(ld, std::max(rows, 1) + 8);
    EXPECT_FALSE(ld >= 64 && (ld & (ld - 1)) == 0) << rows;
  }
}

TEST(Matrix, StartsAsZeroAlsoWithoutRowsOrColumns) {
  for (int rows : {0, 1, 3})
    for (int cols : {0, 1, 4}) {
      const Matrix a(rows, cols);
      EXPECT_EQ(a.rows(), rows);
      EXPECT_EQ(a.cols(), cols);
      EXPECT_GE(a.view().ld, 1);
      EXPECT_EQ(max_abs(a), 0.0);
    }
}

TEST(Matrix, CopyAndFillTouchTheViewOnly) {
  Padded a;
  Matrix source(3, 2);
  source(2, 1) = 7.0;
  copy(source, a.view);
  EXPECT_EQ(sfdae_test::distance(a.view, source), 0.0);
  fill(a.view, 2.0);
  for (int k : {3, 4, 8, 9}) EXPECT_EQ(a.entries[static_cast<std::size_t>(k)], -1.0);
  for (int k : {0, 1, 2, 5, 6, 7}) EXPECT_EQ(a.entries[static_cast<std::size_t>(k)], 2.0);
}

TEST(Matrix, ToMatrixAndTransposeReadThroughPadding) {
  const Padded a;
  const Matrix same = to_matrix(a.view), turned = transpose(a.view);
  ASSERT_EQ(turned.rows(), 2);
  ASSERT_EQ(turned.cols(), 3);
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(same(i, j), 10.0 * i + j);
      EXPECT_EQ(turned(j, i), 10.0 * i + j);
    }
}

TEST(Matrix, IdentityHasOnesOnTheDiagonalAlone) {
  const Matrix one = identity(4);
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) EXPECT_EQ(one(i, j), i == j ? 1.0 : 0.0);
}

TEST(MaxAbs, FindsTheLargestEntryWhereverItIsAndIgnoresPadding) {
  std::vector<double> entries(10, 1e9);
  const View a{entries.data(), 3, 2, 5};
  fill(a, 1.0);
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 3; ++i) {
      a(i, j) = -3.0;
      EXPECT_EQ(max_abs(a), 3.0);
      a(i, j) = 1.0;
    }
}

TEST(AllFinite, AcceptsExtremesAndRefusesNanAndInfinityAtEveryPlace) {
  std::vector<double> values{0.0,
                             -0.0,
                             std::numeric_limits<double>::max(),
                             -std::numeric_limits<double>::max(),
                             std::numeric_limits<double>::denorm_min(),
                             std::numeric_limits<double>::min(),
                             1.0};
  EXPECT_TRUE(all_finite(values.data(), values.size()));
  EXPECT_TRUE(all_finite(values.data(), 0));
  for (double& value : values)
    for (double bad : {infinity, -infinity, not_a_number, -not_a_number}) {
      const double good = value;
      value = bad;
      EXPECT_FALSE(all_finite(values.data(), values.size()));
      // Two carries must not cancel.
      EXPECT_FALSE(all_finite(&value, 1));
      value = good;
    }
  const std::vector<double> many(16, not_a_number);
  EXPECT_FALSE(all_finite(many.data(), many.size()));
}

}  // namespace sfdae::core
