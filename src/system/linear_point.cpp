// A point of a linear problem, reduced.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/linear_point.h"

#include "linalg/dense.h"

namespace sfdae::core {

double inconsistency(const LinearPoint& point, int mu) {
  // Rounding errors and errors of derivatives, carried on by the elimination. Three digits of safety, not measured:
  // as many as a rank needs to be clear (clear_gap).
  constexpr double safety = 1e3;
  const double noise = std::max(point.data.noise(mu), point.data.noise_f(mu)) / point.pivot;
  const double found = point.form.inconsistency();
  return found > safety * noise ? found : 0.0;
}

bool orientation_kept(const LinearPoint& then, const LinearPoint& now, Arena& arena) {
  const int d = now.form.d;
  const Arena::Frame frame(arena);
  const View K = arena.matrix(d, d), T = arena.matrix(d, d);
  multiply(1.0, Op::transposed, then.form.Z1(), Op::plain, now.form.Z1(), 0.0, K);
  multiply(1.0, Op::transposed, then.form.T2(), Op::plain, now.form.T2(), 0.0, T);
  const int aligned = determinant_sign(K, arena) * determinant_sign(T, arena) * now.form.sign_of_G();
  return aligned == then.det_sign;
}

}  // namespace sfdae::core
