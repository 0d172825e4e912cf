// Predicted stages of a Radau step, for nonlinear systems.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "integrate/hermite_table.h"
#include "integrate/radau_history.h"

namespace sfdae::core {

// A polynomial for x, or the tangent at the newest node.
struct RadauPredictor {
  void taylor(double t, int order, double* coefficients) const;

  const RadauHistory& history;
  const HermiteTable* polynomial;  // null: the tangent
};

class RadauGuess {
 public:
  // Prediction for a step from t_start to t_end: Taylor coefficients up to the order given.
  Guess predict(const RadauPredictor& predictor, const StageMethod& method, double t_start, double t_end, int order);
  // Coefficients at the start of the last step; requires two nodes.
  const double* at_start(const RadauPredictor& predictor, int order);

 private:
  std::vector<double> stages_, before_, start_;
};

}  // namespace sfdae::core
