// Report on modes and transitions as text.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "hybrid/hybrid_system.h"

namespace sfdae::core {

std::string report_of(const HybridSystem& hybrid);
// Report on a mode, with the state of the system.
std::string mode_report(const HybridSystem& hybrid, int mode);

}  // namespace sfdae::core
