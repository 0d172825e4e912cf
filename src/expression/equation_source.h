// Equations that are not formulas: what evaluates them in place of a tape.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace sfdae::core {

// Both as the functions of TaylorEvaluator of these names. False: they cannot be evaluated there.
class EquationSource {
 public:
  virtual ~EquationSource() = default;
  virtual bool values(double t, const double* jet, int order, double* F) = 0;
  // Of entries, relative to the largest in their rows and columns, far above roundings; 0: they have no other errors.
  virtual double noise() const { return 0.0; }
  virtual bool entries(double t, const double* jet, int order, const std::vector<int>& limits, double* values) = 0;
};

}  // namespace sfdae::core
