// Sets of equations that contradict each other, minimal: none of them can be left out.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "expression/equation_names.h"
#include "reduction/derivative_array.h"

namespace sfdae::core {

// Equation and number of its differentiations.
struct ContradictingEquation {
  int equation, derivatives;
};

// M y = N x + g, m rows to each order, for all y and those x that are not fixed (n flags, or none; fixed x has to be
// that of the array: g with N x added); empty if nothing contradicts, or there are too many equations to try.
std::vector<ContradictingEquation> contradicting_equations(const DerivativeArray& array, int m,
                                                           const std::vector<char>& fixed, const double* x);

// "equations 0 and 2 (mass, differentiated once)"; empty for none.
std::string in_words(const std::vector<ContradictingEquation>& equations, const EquationNames& names);

}  // namespace sfdae::core
