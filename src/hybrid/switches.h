// Switches of a hybrid system in its runs. Functions throw Failure.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hybrid/hybrid_system.h"

namespace sfdae::core {

// The mode that the transition of a switch leads to: `to`, or that along the surface if `to` leads back.
int mode_after(HybridSystem& hybrid, const HybridTransition& transition, int to);
// Before a sliding mode begins other than by its switch: the part of the mode above. Fails where the surface does not
// attract.
void prepare_sliding(HybridSystem& hybrid, int mode);
// The equations of its sliding mode are made of other values of parameters, or for derivatives by others, than they
// are now.
bool is_outdated(const HybridSystem& hybrid, const Switch& surface);
// Surfaces and sliding modes for what they are now; their solvers are asked for sensitivities.
void update_switches(HybridSystem& hybrid);
// Before a mode is entered: if it slides, with the options of its modes.
void take_options_of_modes(HybridSystem& hybrid, int mode);

}  // namespace sfdae::core
