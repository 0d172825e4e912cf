// A point of a linear problem, reduced.
// SPDX-License-Identifier: BSD-3-Clause
#include "linear/linear_point.h"

#include <algorithm>
#include <cmath>

#include "system/relative_orientation.h"

namespace sfdae::core {

namespace {

// sizes_i := max |a_ij| in the rows first, ..., first + count - 1.
void find_row_sizes(ConstView a, int first, int count, double* sizes) {
  std::fill_n(sizes, count, 0.0);
  for (int j = 0; j < a.cols; ++j) {
    const double* column = a.column(j) + first;
    for (int i = 0; i < count; ++i) sizes[i] = std::max(sizes[i], std::fabs(column[i]));
  }
}

}  // namespace

double LinearPoint::kept_of_rows() const {
  if (form.d == 0) return kept_differential;
  constexpr int at_once = 64;
  double in_E[at_once], in_A[at_once];
  double largest = 0.0;
  for (int first = 0; first < data.m; first += at_once) {
    const int count = std::min(at_once, data.m - first);
    find_row_sizes(data.E(0), first, count, in_E);
    find_row_sizes(data.A(0), first, count, in_A);
    for (int i = 0; i < count; ++i)
      if (in_E[i] > 0.0) largest = std::max(largest, in_E[i] / std::max(in_E[i], in_A[i]));
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
