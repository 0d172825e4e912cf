// Whether a basis has kept its orientation from one point to another.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/relative_orientation.h"

#include <cmath>

#include "linalg/dense.h"
#include "linalg/small_kernels.h"

namespace sfdae::core {

namespace {

// Of |now S - then|_F^2, far enough below 2 for columns that are orthonormal to rounding only.
constexpr double near = 1.5;

}  // namespace

int relative_orientation(ConstView then, ConstView now, Arena& arena) {
  double distance = 0.0;
  int sign = 1;
  for (int j = 0; j < now.cols && distance < near; ++j) {
    const double product = small::dot(now.rows, then.column(j), now.column(j));
    distance += 2.0 - 2.0 * std::fabs(product);
    if (product < 0.0) sign = -sign;
  }
  if (distance < near) return sign;
  const Arena::Frame frame(arena);
  const View K = arena.matrix(now.cols, now.cols);
  multiply(1.0, Op::transposed, then, Op::plain, now, 0.0, K);
  return determinant_sign(K, arena);
}

// |now S - then|_F^2 / 2 as above.
double cosine_between(ConstView then, ConstView now, double enough, Arena& arena) {
  double bound = 1.0;
  for (int j = 0; j < now.cols && bound >= enough; ++j)
    bound -= 1.0 - std::fabs(small::dot(now.rows, then.column(j), now.column(j)));
  if (bound >= enough) return bound;
  const Arena::Frame frame(arena);
  const View K = arena.matrix(now.cols, now.cols);
  multiply(1.0, Op::transposed, then, Op::plain, now, 0.0, K);
  return singular_values(K).back();
}

void reserve_orientation(int d, Arena& arena) {
  const Arena::Frame frame(arena);
  const View K = arena.matrix(d, d);
  for (int j = 0; j < d; ++j)
    for (int i = 0; i < d; ++i) K(i, j) = i == j ? 1.0 : 0.0;
  determinant_sign(K, arena);
}

}  // namespace sfdae::core
