// Request for consistent initial values, and its outcome.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "system/tolerances.h"

namespace sfdae::core {

// keep_differential: x changes in the null space of E1 = Z1^T E only, where Z1 spans the range of E T2 with rows as the
// user scaled them. Exactly one such point is consistent if u = 0, and at least one otherwise, as E1 T2 has full row
// rank.
enum class InitialValues { nearest, fixed, accept, keep_differential };

struct ConsistencyRequest {
  InitialValues kind = InitialValues::nearest;
  std::vector<char> fixed;      // kind fixed: n flags
  std::vector<double> weights;  // empty or n positive weights
  // nearest, fixed: unknowns whose derivative occurs move only if the others cannot make x consistent. Weights take
  // precedence.
  bool keeps_differentiated = false;
  bool differentiated_stay() const {
    return keeps_differentiated && weights.empty() &&
           (kind == InitialValues::nearest || kind == InitialValues::fixed);
  }
  // The weighted sum of all changes is minimized.
  bool is_weighted() const {
    return !weights.empty() && (kind == InitialValues::nearest || kind == InitialValues::fixed);
  }
  // Changes of the differential variables are reported, except with fixed components: there the user has chosen what
  // stays.
  bool reports_changes() const { return differentiated_stay() && kind == InitialValues::nearest; }
  // Changes that count as one where differentiated_stay(): the tolerances. While digits are trusted, which ends when
  // they cannot explain the changes, absolute parts count a millionth: published values are off by their last digit. If
  // neither a value nor its tolerance gives a size, the largest size is used.
  bool trusts_digits = false;
  std::vector<double> sizes() const;
  // The same request for values whose digits are trusted. Its tolerances are changes that their last digits explain.
  ConsistencyRequest trusting_digits(const double* x) const;
  // Fixed components fit the constraints if the rest is small against this.
  double least_size = 0.0;
  // n of them. accept: largest |change_i| to the nearest consistent point that passes.
  std::vector<double> tolerances;
  std::vector<double> digits;  // the same with a small absolute part
  void set_tolerances(const Tolerances& of, const double* x) {
    constexpr double absolute_part = 1e-6;
    tolerances.resize(of.rtol.size());
    digits.resize(of.rtol.size());
    for (std::size_t i = 0; i < of.rtol.size(); ++i) {
      const double relative = of.rtol[i] * (x[i] < 0.0 ? -x[i] : x[i]);
      tolerances[i] = relative + of.atol[i];
      digits[i] = relative + absolute_part * of.atol[i];
    }
  }
};

struct ConsistencyResult {
  double residual_before = 0.0;  // 2-norm of A2 x + f2, rows of A2 orthonormal: distance to the constraints
  double residual_after = 0.0;
  double largest_change = 0.0;
  int component = -1;  // of the largest change
};

}  // namespace sfdae::core
