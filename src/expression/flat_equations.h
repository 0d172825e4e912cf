// Algebraic equations that do not depend on an unknown to first order at one of its values: q |q| = h at q = 0.
//
// The equations are singular there, though the solution continues: the flow q comes to rest and starts again. The
// accuracy of q is limited: while h changes by its tolerance, q changes by the root of it. So a term may be added that
// changes the equation by no more than the tolerances do: slope (q - c) / (1 + ((q - c) / width)^2), where c is the
// value of q there. It makes the equation regular. (Laminar flow has such a resistance.)
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

// Returns the equations that are flat in an unknown at this x, with terms for them. They contain no derivatives, other
// equations do not contain the unknown's derivative, and they rise, or fall, on both sides. tolerances: of x; an
// unknown without a tolerance has no flat equation.
std::vector<FlatEquation> flat_equations(const TaylorEvaluator& evaluator, double t, const double* x,
                                         const double* tolerances);

// Returns the equations with these terms, and with their conditions that can be held, if any, numbered as before. The
// user's parameters keep their numbers.
std::shared_ptr<const Record> with_terms(const Record& record, const std::vector<FlatEquation>& terms);

}  // namespace sfdae::core
