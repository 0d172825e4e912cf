// SPDX-License-Identifier: BSD-3-Clause
#include "system/consistency_request.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"

namespace sfdae::core {

ConsistencyRequest ConsistencyRequest::trusting_digits(const double* x) const {
  // Six digits, or far below the tolerances (chosen); never above them.
  constexpr double last_digit = 1e-6, negligible = 1e-3;
  ConsistencyRequest request = *this;
  request.trusts_digits = true;
  for (std::size_t i = 0; i < tolerances.size(); ++i)
    request.tolerances[i] =
        std::max(std::min(last_digit * std::fabs(x[i]), tolerances[i]), negligible * tolerances[i]);
  return request;
}

std::vector<double> ConsistencyRequest::sizes() const {
  std::vector<double> sizes(trusts_digits ? digits : tolerances);
  const double largest = max_abs(sizes.data(), static_cast<int>(sizes.size()));
  for (double& size : sizes)
    if (size == 0.0) size = largest > 0.0 ? largest : 1.0;
  return sizes;
}

}  // namespace sfdae::core
