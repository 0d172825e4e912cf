// Dependent equations of a diagonal block of the system Jacobian, and the equations that they depend on there; rows are
// those of equations.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "structure/structure.h"
#include "structure/system_jacobian.h"

namespace sfdae::core {

// J_equation = sum factor J_i over parts, c_i >= c_equation for all of them.
struct DependentEquation {
  struct Part {
    int equation;
    double factor;
  };
  int equation;
  std::vector<Part> parts;
};

// None if ranks are unclear. jacobian: evaluated.
std::vector<DependentEquation> dependent_equations(const Structure& structure, const SystemJacobian& jacobian,
                                                   int block);

}  // namespace sfdae::core
