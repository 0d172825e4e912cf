// Derivatives of recorded equations by their parameters, recorded themselves.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "expression/record.h"

namespace sfdae::core {

// The entries of F_p that are not identically zero, for the parameters chosen (by their numbers).
struct ParameterGradient {
  struct Place {
    int equation, column;  // the derivative of an equation by the parameter number `column` of those chosen
  };
  std::shared_ptr<const Record>
      formulas;  // one for each place; parameters have the numbers that they have in the record
  std::vector<Place> places;
};
ParameterGradient parameter_gradient(const Record& record, const std::vector<int>& parameters);

}  // namespace sfdae::core
