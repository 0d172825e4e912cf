// A formula as a sum: constant + sum of coefficient times variable + sum of factor times other formulas.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "simulation/formulas.h"

namespace sfdae::cli {

struct LinearForm {
  double constant = 0.0;
  std::map<int, double> coefficients;              // of variables of type Real; numbers
  std::vector<std::pair<double, Formula>> others;  // anything else
  bool is_whole = true;                            // false: too long, and truncated
};

LinearForm linear_form(const Formulas& formulas, Formula formula);

// Solves 0 = coefficient x + form for x.
Formula solved(Formulas& formulas, const LinearForm& form, double coefficient);

}  // namespace sfdae::cli
