// A point of a linear problem, reduced.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/linear_point.h"

#include <algorithm>
#include <cmath>

#include "system/relative_orientation.h"

namespace sfdae::core {

double LinearPoint::kept_of_rows() const {
  if (form.d == 0) return kept_differential;
  const ConstView E = data.E(0), A = data.A(0);
  double largest = 0.0;
  for (int i = 0; i < E.rows; ++i) {
    double in_E = 0.0, in_A = 0.0;
    for (int j = 0; j < E.cols; ++j) {
      in_E = std::max(in_E, std::fabs(E(i, j)));
      in_A = std::max(in_A, std::fabs(A(i, j)));
    }
    if (in_E > 0.0) largest = std::max(largest, in_E / std::max(in_E, in_A));
  }
  return kept_differential * largest;
}

double inconsistency(const LinearPoint& point, int mu) {
  // Rounding errors and errors of derivatives, carried on by the elimination. Three digits of safety, not measured:
  // as many as a rank needs to be clear (clear_gap).
  constexpr double safety = 1e3;
  const double noise = std::max(point.data.noise(mu), point.data.noise_f(mu)) / point.pivot;
  const double found = point.form.inconsistency();
  return found > safety * noise ? found : 0.0;
}

bool orientation_kept(const LinearPoint& then, const LinearPoint& now, Arena& arena) {
  if (now.form.orientation() != 0) return now.form.orientation() == then.det_sign;
  const int aligned = relative_orientation(then.form.Z1(), now.form.Z1(), arena) *
                      relative_orientation(then.form.T2(), now.form.T2(), arena) * now.form.sign_of_G();
  return aligned == then.det_sign;
}

}  // namespace sfdae::core
