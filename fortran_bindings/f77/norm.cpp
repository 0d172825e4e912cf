// DGENRM: weighted norm.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "f77/routine.h"

using namespace sfdae::f77;

// sqrt( 1/NEQ sum (V(i) RWT(i))^2 ), RWT the reciprocal weights; no square overflows or underflows. NaN and Inf in
// the products are passed on; 0 for NEQ <= 0.
SFDAE_F77_ROUTINE(double, dgenrm, (const Integer* neq, const double* v, const double* rwt), (neq, v, rwt)) {
  const std::int64_t n = *neq;
  double largest = 0.0;
  for (std::int64_t i = 0; i < n; ++i) {
    const double size = std::fabs(v[i] * rwt[i]);
    if (!std::isfinite(size)) return size;
    largest = std::max(largest, size);
  }
  if (largest == 0.0) return 0.0;
  double sum = 0.0;
  for (std::int64_t i = 0; i < n; ++i) {
    const double ratio = v[i] * rwt[i] / largest;
    sum += ratio * ratio;
  }
  return largest * std::sqrt(sum / static_cast<double>(n));
}
