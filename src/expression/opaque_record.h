// The record of equations that are known by the unknowns and derivatives they contain, and no further.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

}  // namespace sfdae::core
