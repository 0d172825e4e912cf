// The equations of the motion along a surface that two modes lead to.
//
// [Fil88] A. F. Filippov: Differential Equations with Discontinuous Righthand Sides. Kluwer, 1988. Paragraph 4: the sets of
// fields that the motion along a surface may follow.
//
// With F_b = 0 below the surface g(t, x) = 0 and F_a = 0 above it: (1 - s) F_b + s F_a = 0, g = 0 for x and the part s of
// the mode above, 0 ... 1. Equations that both modes have are taken once. x' is in the others with the same factors, so
// that fields are combined as in [Fil88] where these equations contain nothing else that differs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "expression/taylor_evaluator.h"

namespace sfdae::core {

// g(t, x) with the values that its parameters have in the modes, where these have them. Throws Failure: x' in it, no x.
std::shared_ptr<const Record> surface_of_modes(const Record& surface, const TaylorEvaluator& below,
                                               const TaylorEvaluator& above);

// m + 1 equations for n + 1 unknowns, with the numbers that parameters have now. Throws Failure for equations that cannot be
// combined.
std::shared_ptr<const Record> sliding_equations(const TaylorEvaluator& below, const TaylorEvaluator& above,
                                                const Record& surface);

}  // namespace sfdae::core
