// Modes and breakpoints as text.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "c_api/hybrid.h"

namespace sfdae::core {

sfdae_mode summary_of(const sfdae_hybrid& hybrid, int mode);
std::string report_of(const sfdae_hybrid& hybrid);
// Of a solver that is a mode: of which system, and since when the system is in it.
std::string mode_report(const sfdae_solver& solver);

}  // namespace sfdae::core
