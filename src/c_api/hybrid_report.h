// Modes and breakpoints as text.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "c_api/hybrid.h"

namespace sfdae::core {

sfdae_mode summary_of(const sfdae_hybrid& hybrid, int mode);
std::string report_of(const sfdae_hybrid& hybrid);
// Of the adjoint of so many parameters.
std::string report_of(int count, const AdjointWork& work);
// Of a solver that is a mode: of which system, and since when the system is in it.
std::string mode_report(const sfdae_solver& solver);
// Those that an integration under way is going to meet, and the jump crossed last; empty where there are none.
std::string breakpoints_report(const sfdae_solver& solver);

}  // namespace sfdae::core
