// Tangents for few uses say the same as those for many.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_tangent.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "linalg/arena.h"
#include "linalg/index.h"

namespace sfdae::core {
namespace {

using Vector = std::vector<double>;

// Rows that are different enough; shift: of another point.
Matrix rows_at(double shift, int count, int directions) {
  Matrix C(count, directions);
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < directions; ++j)
      C(i, j) = std::sin(1.0 + 2.3 * i * j + 0.7 * j + i + shift) + (i == j ? 3.0 : 0.0);
  return C;
}

Vector numbers(int count, double start) {
  Vector values(index(count) + 1);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::cos(start + 1.7 * static_cast<double>(i));
  return values;
}

// Up to 16 rows C Q2 is inverted.
TEST(Tangent, SaysTheSameForFewUses) {
  Arena arena;
  for (const int r : {1, 2, 3, 6, 16, 17}) {
    const int n = r + 2;
    const Vector units(index(r) + 1, 2.5), residuals = numbers(r, 0.3), force = numbers(n, 0.8);
    const Matrix before = rows_at(0.0, r, n), C = rows_at(0.05, r, n);
    Partition partition;
    partition.resize(n, r);
    choose_partition({before.view(), units.data()}, Coordinates::orthogonal, -1, partition, arena);
    ASSERT_EQ(partition.rank, r);
    Tangent many, few;
    for (Tangent* tangent : {&many, &few}) tangent->resize(n, r);
    ASSERT_TRUE(many.fit(partition, {C.view(), units.data()}));
    // N of the point before does not matter.
    ASSERT_TRUE(few.fit(partition, {before.view(), units.data()}));
    ASSERT_TRUE(few.fit(partition, {C.view(), units.data()}, Tangent::Uses::few));
    ASSERT_TRUE(many.complete(partition, arena) && few.complete(partition, arena));
    EXPECT_EQ(many.sign(), few.sign());
    EXPECT_EQ(many.smallest_pivot(), few.smallest_pivot());
    const auto expect_same = [r](const Vector& a, const Vector& b, const char* what) {
      for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-12) << what << ", rank " << r;
    };
    Vector a(index(n)), b(a);
    many.correction(partition, residuals.data(), a.data(), arena);
    few.correction(partition, residuals.data(), b.data(), arena);
    expect_same(a, b, "correction");
    // C w = -residuals.
    for (int i = 0; i < r; ++i) {
      double sum = residuals[index(i)];
      for (int j = 0; j < n; ++j) sum += C(i, j) * b[index(j)];
      EXPECT_NEAR(sum, 0.0, 1e-12);
    }
    a.assign(force.begin(), force.end() - 1);
    b = a;
    many.enforce(partition, residuals.data(), a.data(), arena);
    few.enforce(partition, residuals.data(), b.data(), arena);
    expect_same(a, b, "enforce");
    Vector mu(index(r)), other(index(r));
    many.multipliers(partition, force.data(), mu.data(), arena);
    few.multipliers(partition, force.data(), other.data(), arena);
    expect_same(mu, other, "multipliers");
    int row = -1, other_row = -1;
    EXPECT_NEAR(many.fastest_change(partition, before, row, arena),
                few.fastest_change(partition, before, other_row, arena), 1e-10);
    EXPECT_EQ(row, other_row);
    EXPECT_EQ(many.rotation(), few.rotation());
  }
}

}  // namespace
}  // namespace sfdae::core
