// Relative orientation of a basis at two points.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/relative_orientation.h"

#include <cmath>

#include "linalg/dense.h"
#include "linalg/small_kernels.h"

namespace sfdae::core {

namespace {

// Bound of |now S - then|_F^2, far enough below 2 for columns that are orthonormal only up to roundoff.
constexpr double near = 1.5;

// |now S - then|_F^2, or more than `most`, with the signs S of columns that make it least; sign: of det S.
double least_distance(ConstView then, ConstView now, double most, int& sign) {
  double distance = 0.0;
  sign = 1;
  for (int j = 0; j < now.cols && distance <= most; ++j) {
    const double product = small::dot(now.rows, then.column(j), now.column(j));
    distance += 2.0 - 2.0 * std::fabs(product);
    if (product < 0.0) sign = -sign;
  }
  return distance;
}

View transposed_product(ConstView then, ConstView now, Arena& arena) {
  const View K = arena.matrix(now.cols, now.cols);
  multiply(1.0, Op::transposed, then, Op::plain, now, 0.0, K);
  return K;
}

}  // namespace

int relative_orientation(ConstView then, ConstView now, Arena& arena) {
  int sign;
  if (least_distance(then, now, near, sign) < near) return sign;
  const Arena::Frame frame(arena);
  return determinant_sign(transposed_product(then, now, arena), arena);
}

// The smallest singular value of then^T now, which is at least the smallest x^T then^T now S x.
double cosine_between(ConstView then, ConstView now, double enough, Arena& arena) {
  int sign;
  const double bound = 1.0 - 0.5 * least_distance(then, now, 2.0 - 2.0 * enough, sign);
  if (bound >= enough) return bound;
  const Arena::Frame frame(arena);
  return singular_values(transposed_product(then, now, arena)).back();
}

void reserve_orientation(int d, Arena& arena) {
  const Arena::Frame frame(arena);
  const View K = arena.matrix(d, d);
  for (int j = 0; j < d; ++j)
    for (int i = 0; i < d; ++i) K(i, j) = i == j ? 1.0 : 0.0;
  determinant_sign(K, arena);
}

}  // namespace sfdae::core
