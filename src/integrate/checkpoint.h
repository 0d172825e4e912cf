// An integration with its system, saved to and restored from a sequence of doubles.
//
// The problem, the settings of the analysis, tolerances and other options are not part of it: they are given anew,
// the problem and the settings as they were.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>

#include "integrate/integration.h"
#include "system/model.h"

namespace sfdae::core {

// Doubles needed.
std::size_t checkpoint_size(DaeSystem& system, Integration& integration);
void save_checkpoint(DaeSystem& system, Integration& integration, double* to);

// The model gets its system again. Throws Failure SFDAE_ILLEGAL_ARGUMENT if it is not a checkpoint of such a problem,
// or damaged; then, and where anything else fails, nothing has changed. length may be larger than the checkpoint. No
// callback of a linear problem is called.
std::unique_ptr<Integration> restore_checkpoint(Model& model, const ModelOptions& model_options,
                                                const IntegrationOptions& options, const double* from,
                                                std::size_t length);

}  // namespace sfdae::core
