// Indicators of a singular point of a nonlinear system at one jet: signs and sizes that pass through zero there.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/arena.h"
#include "linalg/index.h"
#include "linalg/matrix.h"
#include "problem/taylor_data.h"
#include "reduction/null_space_form.h"

namespace sfdae::core {

struct SingularitySample {
  double t = 0.0;
  // The smallest value kept of A^, relative to |A|; that of E T2, relative to |E_0| with scaled rows and times |E_0|
  // without, as all of E may vanish; the largest entries of the rows of [E A], unscaled.
  std::vector<double> values;
  static constexpr std::size_t first_row = 2;

  // Takes the data of a reduction at t and its form. Nothing changes if memory is missing.
  void take(double at, const TaylorData& data, int mu, const NullSpaceForm& form);
  // True if the sign of det(Z1^T E T2) differs from that at `then`, with Z1 and T2 aligned to those there. False if
  // there is no sign (u > 0, d = 0).
  bool is_turned_from(const SingularitySample& then, Arena& arena) const;

 private:
  ConstView Z1() const { return {Z1_.data(), m_, d_, m_ > 0 ? m_ : 1}; }
  ConstView T2() const { return {T2_.data(), n_, d_, n_ > 0 ? n_ : 1}; }

  int m_ = 0, n_ = 0, d_ = 0;
  int sign_ = 0;  // of det(Z1^T E T2); 0: it has none
  std::vector<double> Z1_, T2_;
};

}  // namespace sfdae::core
