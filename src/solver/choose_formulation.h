// Choice of the formulation that solves a problem from a point on.
//
// Each analysis chooses a formulation by options, size and numerical tests. The minimal extension comes first if the
// options require it, if the derivative array were large or the units of its unknowns differ widely, and for large
// sparse mechanical systems. If the structural analysis is not confirmed numerically, the whole derivative array or
// local coordinates are analyzed. If the ranks of an array are in doubt, the minimal extension is tried
// (docs/design/minimal_extension.md, docs/design/scaling_and_units.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "solver/formulations.h"

namespace sfdae::core {

// Returns a formulation that has been analyzed at the point. decisions: see Model::analyze. Throws Failure.
Model& choose_formulation(Formulations& formulations, const PointOfInterest& point, const ModelOptions& options,
                          std::vector<RankDecision>& decisions);

}  // namespace sfdae::core
