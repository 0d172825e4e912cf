// SPDX-License-Identifier: BSD-3-Clause
// Anderson's method for linear iterations: two differences see two directions of errors, and no more harm is done
// than by none.
#include "system/anderson_mixing.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Errors e := G e of an iteration; what is left of them, largest entry, after the given number of changes.
template <class Map>
double error_after(int changes, Vector e, Map G) {
  AndersonMixing mixing;
  mixing.resize(e.size());
  mixing.begin();
  Vector d(e.size()), correction(e.size());
  for (int k = 0; k < changes; ++k) {
    const Vector next = G(e);
    for (std::size_t i = 0; i < e.size(); ++i) d[i] = next[i] - e[i];
    const bool is_corrected = mixing.correct(d.data(), correction.data());
    for (std::size_t i = 0; i < e.size(); ++i) e[i] += d[i] + (is_corrected ? correction[i] : 0.0);
  }
  double largest = 0.0;
  for (double value : e) largest = std::max(largest, std::fabs(value));
  return largest;
}

}  // namespace

/// x and y correct each other in turn: x := p y, y := q x has the eigenvalues +-sqrt(p q). The third change knows both.
TEST(AndersonMixing, EndsAnIterationWithTwoEigenvaluesAtTheThirdChange) {
  const auto G = [](const Vector& e) { return Vector{0.9 * e[1], 0.02 * e[0]}; };
  EXPECT_GT(error_after(2, {1.0, 1.0}, G), 1e-3);
  EXPECT_LE(error_after(3, {1.0, 1.0}, G), 1e-13);
}

TEST(AndersonMixing, LeavesAnIterationThatHasEndedAlone) {
  const auto G = [](const Vector&) { return Vector{0.0, 0.0}; };
  EXPECT_EQ(error_after(1, {1.0, -2.0}, G), 0.0);
  EXPECT_EQ(error_after(5, {1.0, -2.0}, G), 0.0);
}

/// Differences that are parallel are one; a second factor would be rounding errors over rounding errors.
TEST(AndersonMixing, IsNotConfusedByParallelDifferences) {
  const auto G = [](const Vector& e) { return Vector{0.5 * e[0], 0.5 * e[1]}; };
  EXPECT_LE(error_after(4, {1.0, -2.0}, G), 1e-14);
}

/// Eigenvalues that two differences cannot tell apart: no slower than without them.
TEST(AndersonMixing, IsNoSlowerThanTheIterationItself) {
  const auto G = [](const Vector& e) {
    Vector next(e);
    for (std::size_t i = 0; i < e.size(); ++i)
      next[i] *= (i % 2 == 0 ? 1.0 : -1.0) * 0.3 / (1.0 + static_cast<double>(i));
    return next;
  };
  EXPECT_LE(error_after(8, Vector(10, 1.0), G), std::pow(0.3, 8));
}

/// An iteration that does not contract yet would ask for factors without bound; it goes on as it is.
TEST(AndersonMixing, MakesNoLargeStepsOutOfSmallDifferences) {
  const auto G = [](const Vector& e) { return Vector{e[0] - 1.0, 0.0}; };
  EXPECT_NEAR(error_after(4, {10.0, 0.0}, G), 6.0, 1e-12);
}

}  // namespace sfdae::core
