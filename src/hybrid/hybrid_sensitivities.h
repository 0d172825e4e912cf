// Sensitivities of hybrid systems: what becomes of them at transitions. Functions throw Failure.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "hybrid/hybrid_system.h"

namespace sfdae::core {

// Those of the start, width() x count.
std::vector<double> directions_at_start(const HybridSystem& hybrid);
// Asks the solvers of all modes for what the system was asked for, or for none.
void ask_for_sensitivities(HybridSystem& hybrid);
// How the time of a transition moves with the parameters, and x there. at_once: with the transition before.
void find_shifts(HybridSystem& hybrid, const HybridTransition& transition, bool at_once);
// Then, with the values after it: how these move.
void carry_over(HybridSystem& hybrid, const sfdae_transition& given);
// Before a mode is entered, and after that: a start that is none of the system's begins with nothing of it.
void begin_sensitivities(HybridSystem& hybrid, int mode);
void end_sensitivities(HybridSystem& hybrid, int mode);

}  // namespace sfdae::core
