// Source of Taylor coefficients for the reduction: a linear problem, or a nonlinear one along a jet.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "problem/problem.h"
#include "problem/taylor_data.h"

namespace sfdae::core {

class CoefficientSource {
 public:
  virtual int m() const = 0;
  virtual int n() const = 0;
  // Largest number of differentiations of each equation; empty: no limit.
  virtual std::vector<int> differentiations() const { return {}; }
  // Coefficients are the same at every t.
  virtual bool is_constant() const = 0;
  // Returns whether the hypothesis has to be checked at level mu + 1 as well: for nonlinear problems, where it does not
  // follow from constant ranks.
  virtual bool checks_next_level() const { return false; }
  // Coefficients up to the orders asked for at t, scaled with the given time scale (0: chosen). rows, preferred_rows:
  // as for TaylorData::scale. A stop request ends the evaluation with SFDAE_STOPPED.
  virtual CallbackError evaluate(double t, Orders orders, double time_scale, TaylorData& data,
                                 RowScaling rows = RowScaling::each,
                                 const std::vector<double>* preferred_rows = nullptr) = 0;
  // Coefficients are those along a jet, which has residuals and rounding errors of its own.
  virtual bool is_along_jet() const { return false; }
  // evaluate() multiplies column j of E and A by scale[j] (powers of two) from now on: unknowns x_j / scale[j].
  // Empty: 1.
  virtual void set_units(Units units) = 0;

 protected:
  ~CoefficientSource() = default;
};

}  // namespace sfdae::core
