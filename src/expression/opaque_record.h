// The record of equations that are known by the unknowns and derivatives they contain, and no further.
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

// Each equation is a function of t, of these x_j and of these x_j' that cannot be evaluated by itself: what evaluates
// all is an EquationSource.
Record opaque_record(int num_equations, const JacobianPatterns& patterns, const EquationNames& names);
// The same with functions of these names, which are conditions, too: their parameters are the only ones.
Record opaque_conditions(int count, const JacobianPatterns& patterns, const std::vector<std::string>& names);

}  // namespace sfdae::core
