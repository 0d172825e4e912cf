// SPDX-License-Identifier: BSD-3-Clause
// Points that an integration has come through: what is kept of them.
#include "watch/trail.h"

#include <gtest/gtest.h>

#include <vector>

namespace sfdae::core {

// The first point and the newest 16 always; the others are nowhere further apart than a part of their distance from
// the end.
TEST(Trail, ReachesFarBackAndIsDenseAtTheEnd) {
  for (const std::size_t n : {std::size_t{2}, std::size_t{1500}}) {
    SCOPED_TRACE(n);
    Trail trail;
    std::vector<double> x(n, 0.0);
    trail.start(0.0, x.data(), n);
    constexpr int steps = 1000;
    for (int k = 1; k <= steps; ++k) {
      x[1] = k;
      trail.add(k, x.data());
    }
    EXPECT_GE(trail.count(), 32u);
    EXPECT_EQ(trail.node(0).t, 0.0);
    for (std::size_t i = 0; i < trail.count(); ++i) EXPECT_EQ(trail.node(i).x[1], trail.node(i).t);
    for (std::size_t i = 0; i < 16; ++i)
      EXPECT_EQ(trail.node(trail.count() - 1 - i).t, steps - static_cast<double>(i));
    for (std::size_t i = 0; i + 16 < trail.count(); ++i) {
      const double gap = trail.node(i + 1).t - trail.node(i).t, distance = steps - trail.node(i).t;
      EXPECT_LE(gap, 0.6 * distance);
    }
  }
}

}  // namespace sfdae::core
