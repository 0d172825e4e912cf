// Equations without formulas: an object evaluates them in place of a tape.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace sfdae::core {

// Both functions as those of TaylorEvaluator of these names. False: they cannot be evaluated there.
class EquationSource {
 public:
  virtual ~EquationSource() = default;
  virtual bool values(double t, const double* jet, int order, double* F) = 0;
  // Relative errors of entries far above rounding errors, compared with the largest in their rows and columns; 0: none.
  virtual double noise() const { return 0.0; }
  virtual bool entries(double t, const double* jet, int order, const std::vector<int>& limits, double* values) = 0;
};

}  // namespace sfdae::core
