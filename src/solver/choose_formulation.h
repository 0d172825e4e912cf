// The formulation that solves a problem from a point on.
//
// Each analysis chooses anew, by options, size and numbers. The minimal extension comes first if the options require
// it, if the derivative array were large or the units of its unknowns far apart, and for large sparse mechanical
// systems. If numbers do not confirm the structure, the whole derivative array or local coordinates are analyzed; if
// an array leaves its ranks in doubt, the extension is asked once more
// (docs/design/minimal_extension.md, docs/design/scaling_and_units.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "solver/formulations.h"

namespace sfdae::core {

// One of the formulations, which has been analyzed at the point. decisions: as of Model::analyze. Throws Failure.
Model& choose_formulation(Formulations& formulations, const PointOfInterest& point, const ModelOptions& options,
                          std::vector<RankDecision>& decisions);

}  // namespace sfdae::core
