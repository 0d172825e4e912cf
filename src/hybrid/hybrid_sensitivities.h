// Sensitivities of hybrid systems and their changes at transitions. Functions throw Failure.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "hybrid/hybrid_system.h"

namespace sfdae::core {

// Initial sensitivities, width() x count.
std::vector<double> directions_at_start(const HybridSystem& hybrid);
// Requests from the solvers of all modes the sensitivities of the system, or none.
void ask_for_sensitivities(HybridSystem& hybrid);
// Finds the derivatives of the transition time by the parameters and of x there. at_once: the time is the last one's.
void find_shifts(HybridSystem& hybrid, const HybridTransition& transition, bool at_once);
// Afterwards, with the values after the transition: finds their derivatives.
void carry_over(HybridSystem& hybrid, const sfdae_transition& given);
// Before and after a mode is entered: the request has start values only during starts by the system.
void begin_sensitivities(HybridSystem& hybrid, int mode);
void end_sensitivities(HybridSystem& hybrid, int mode);

}  // namespace sfdae::core
