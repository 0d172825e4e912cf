// SPDX-License-Identifier: BSD-3-Clause
// Units of unknowns: inward and outward are inverse to each other, and units of 1 cost nothing.
#include "linalg/units.h"

#include <gtest/gtest.h>

#include <array>

namespace sfdae::core {

TEST(Units, OfOneHandOutTheUsersOwnValues) {
  const Units units;
  const std::array<double, 2> x = {3.0, -0.5};
  std::array<double, 2> buffer = {7.0, 7.0};
  EXPECT_TRUE(units.are_one());
  EXPECT_EQ(units.inward(x.data(), buffer.data()), x.data());
  EXPECT_EQ(buffer[0], 7.0);
  EXPECT_EQ(units[0], 1.0);
  EXPECT_EQ(units[std::size_t{1}], 1.0);
}

// Powers of two: no rounding on the way.
TEST(Units, AreTakenOutAndPutBack) {
  const Units units({0x1p-30, 1.0, 0x1p40});
  const std::array<double, 3> x = {0.1, -3.0, 1e-7};
  std::array<double, 3> inside{};
  ASSERT_EQ(units.inward(x.data(), inside.data()), inside.data());
  EXPECT_EQ(inside[0], 0.1 * 0x1p30);
  EXPECT_EQ(inside[2], 1e-7 * 0x1p-40);
  EXPECT_EQ(units[2], 0x1p40);
  units.outward(inside.data());
  EXPECT_EQ(inside, x);
}

}  // namespace sfdae::core
