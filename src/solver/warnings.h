// Warnings of the calls that analyze and start, for problems of all kinds.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "integrate/integration_options.h"
#include "system/dae_system.h"
#include "system/model.h"

namespace sfdae::core {

// SFDAE_NOT_UNIQUE or SFDAE_OK.
CallResult warning_of(const DaeSystem& system);

// Warning about initial values: the first applicable one of SFDAE_INCONSISTENCY_IGNORED, SFDAE_VALUES_CHANGED and
// SFDAE_NOT_UNIQUE, with the messages of all that apply. The order is: doubtful results, this call, the problem.
CallResult warning_of(const DaeSystem& system, const ConsistentPoint& point);

}  // namespace sfdae::core
