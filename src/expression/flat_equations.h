// Algebraic equations that do not depend on an unknown to first order at one of its values: q |q| = h at q = 0.
//
// There the equations are singular, though the solution goes on: the flow q comes to rest, and starts again. It is
// known no better than other unknowns are: while h changes by its tolerance, q changes by the root of it. So a term may
// be added that changes the equation by no more than these tolerances do: slope (q - c) / (1 + ((q - c) / width)^2),
// with c the value of q there. With it the equation is regular. (A laminar flow is resisted by such a term.)
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "expression/record.h"
#include "expression/taylor_evaluator.h"

namespace sfdae::core {

struct FlatEquation {
  int equation, unknown;
  double center, width, slope;  // in the units of x, and of the equation over that of x
  bool operator==(const FlatEquation&) const = default;
};

// Returns the equations that are flat in an unknown at this x, with terms for them. They contain no derivatives, nor
// do others contain that of the unknown; and they rise, or fall, on both sides. tolerances: of x; an equation in an
// unknown without one is not flat.
std::vector<FlatEquation> flat_equations(const TaylorEvaluator& evaluator, double t, const double* x,
                                         const double* tolerances);

// Returns the equations with these terms, and with conditions that can be held, if they have any, with the numbers that
// they had. The user's parameters keep their numbers.
std::shared_ptr<const Record> with_terms(const Record& record, const std::vector<FlatEquation>& terms);

}  // namespace sfdae::core
