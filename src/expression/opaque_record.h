// Record of equations of which only the unknowns and derivatives in them are known.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "expression/equation_names.h"
#include "expression/record.h"
#include "linalg/column_pattern.h"

namespace sfdae::core {

// Sparsity of F_x and F_x', as many columns as unknowns each.
struct JacobianPatterns {
  ColumnPattern F_x, F_xdot;
};

// Each equation is a function of t, of these x_j and of these x_j' that cannot be evaluated by itself: an
// EquationSource evaluates all of them.
Record opaque_record(int num_equations, const JacobianPatterns& patterns, const EquationNames& names);
// Same for functions of these names that are also conditions: the record's parameters are those of the conditions.
Record opaque_conditions(int count, const JacobianPatterns& patterns, const std::vector<std::string>& names);

}  // namespace sfdae::core
