// Switches of a hybrid system during its runs. Functions throw Failure.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hybrid/hybrid_system.h"

namespace sfdae::core {

// The mode after a transition of a switch: `to`, or the sliding mode if `to` leads back to the surface.
int mode_after(HybridSystem& hybrid, const HybridTransition& transition, int to);
// Before a sliding mode begins other than by its switch: computes the part of the mode above. Throws Failure if the
// surface does not attract.
void prepare_sliding(HybridSystem& hybrid, int mode);
// True if the equations of the sliding mode have other parameter values or derivatives than are required now.
bool is_outdated(const HybridSystem& hybrid, const Switch& surface);
// Updates surfaces and sliding modes; requests sensitivities from their solvers.
void update_switches(HybridSystem& hybrid);
// Before a sliding mode is entered: takes the options of its modes.
void take_options_of_modes(HybridSystem& hybrid, int mode);

}  // namespace sfdae::core
