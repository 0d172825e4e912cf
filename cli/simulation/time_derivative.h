// Derivatives of formulas with respect to time.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <unordered_map>
#include <utility>

#include "simulation/formulas.h"

namespace sfdae::cli {

class TimeDerivative {
 public:
  // of_variable: the derivative of a continuous variable.
  TimeDerivative(Formulas& formulas, std::function<Formula(int)> of_variable)
      : formulas_(formulas), of_variable_(std::move(of_variable)) {}

  // Derivative between events, where discrete quantities are constant. The formula must contain no derivatives.
  Formula operator()(Formula formula);

 private:
  Formula of_part(Formula formula);

  Formulas& formulas_;
  std::function<Formula(int)> of_variable_;
  std::unordered_map<Formula, Formula> known_;
};

}  // namespace sfdae::cli
