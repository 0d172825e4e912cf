// SPDX-License-Identifier: BSD-3-Clause
// Orientations of bases by their distance are those of the determinant.
#include "system/relative_orientation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "linalg/dense.h"

namespace sfdae::core {

namespace {

// Orthonormal columns, from random ones.
Matrix random_basis(int rows, int cols, std::mt19937& generator, Arena& arena) {
  std::normal_distribution<double> normal;
  Matrix factors(rows, cols), basis(rows, cols);
  for (int j = 0; j < cols; ++j)
    for (int i = 0; i < rows; ++i) factors(i, j) = normal(generator);
  std::vector<double> tau(static_cast<std::size_t>(cols));
  factor_qr(factors, tau.data(), arena);
  form_q(factors, cols, tau.data(), basis, arena);
  return basis;
}

// The basis turned by a random rotation of the space, of so much; columns then exchanged and negated.
Matrix turned(const Matrix& basis, double angle, int exchanges, int negations, std::mt19937& generator) {
  Matrix to = basis;
  std::uniform_int_distribution<int> row(0, to.rows() - 1), column(0, to.cols() - 1);
  std::uniform_real_distribution<double> part(-angle, angle);
  for (int k = 0; k < 3 * to.rows(); ++k) {
    const int p = row(generator), q = row(generator);
    if (p == q) continue;
    const double c = std::cos(part(generator)), s = std::sqrt(1.0 - c * c);
    for (int j = 0; j < to.cols(); ++j) {
      const double a = to(p, j), b = to(q, j);
      to(p, j) = c * a - s * b;
      to(q, j) = s * a + c * b;
    }
  }
  for (int k = 0; k < exchanges; ++k) {
    const int p = column(generator), q = column(generator);
    for (int i = 0; i < to.rows(); ++i) std::swap(to(i, p), to(i, q));
  }
  for (int k = 0; k < negations; ++k) {
    const int p = column(generator);
    for (int i = 0; i < to.rows(); ++i) to(i, p) = -to(i, p);
  }
  return to;
}

TEST(RelativeOrientation, IsTheSignOfTheDeterminant) {
  std::mt19937 generator(7);
  Arena arena;
  int positive = 0, negative = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const int rows = 2 + trial % 9, cols = 1 + trial % rows;
    const Matrix then = random_basis(rows, cols, generator, arena);
    const double angle = trial % 4 == 3 ? 1.5 : 0.05 * (trial % 4);
    const Matrix now = turned(then, angle, trial % 3, trial % 5, generator);
    Matrix K = transpose_product(then, now);
    // By elimination with exchanges: independent of what is tested.
    double determinant = 1.0;
    for (int k = 0; k < cols; ++k) {
      int pivot = k;
      for (int i = k; i < cols; ++i)
        if (std::fabs(K(i, k)) > std::fabs(K(pivot, k))) pivot = i;
      for (int j = 0; j < cols; ++j) std::swap(K(k, j), K(pivot, j));
      determinant *= pivot == k ? K(k, k) : -K(k, k);
      for (int i = k + 1; i < cols; ++i) {
        const double factor = K(i, k) / K(k, k);
        for (int j = k; j < cols; ++j) K(i, j) -= factor * K(k, j);
      }
    }
    if (std::fabs(determinant) < 1e-8) continue;
    const int sign = determinant > 0.0 ? 1 : -1;
    EXPECT_EQ(relative_orientation(then, now, arena), sign) << rows << " x " << cols << ", trial " << trial;
    (sign > 0 ? positive : negative) += 1;
  }
  EXPECT_GE(positive, 50);
  EXPECT_GE(negative, 50);
}

}  // namespace

}  // namespace sfdae::core
