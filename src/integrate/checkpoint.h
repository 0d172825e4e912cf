// An integration with its system, saved to and restored from a sequence of doubles.
//
// The problem, the settings of the analysis, tolerances and other options are not part of it: they are given anew,
// the problem, its parameters and the settings as they were (checkpoint_identity.h). Sensitivities are in it, and
// which ones they are.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "integrate/integration.h"
#include "system/model.h"

namespace sfdae::core {

// Doubles needed.
std::size_t checkpoint_size(DaeSystem& system, Integration& integration);
void save_checkpoint(DaeSystem& system, Integration& integration, double* to);

struct SavedCheckpoint {
  const double* values;
  std::size_t length;  // may be larger than the checkpoint
};

// Those that are to be in it.
struct WantedSensitivities {
  const std::vector<int>& parameters;
  const SensitivityOptions& options;
};

// wanted: null where there are to be no sensitivities. The model gets its system again. Throws Failure
// SFDAE_ILLEGAL_ARGUMENT if it is not a checkpoint of such a problem, or damaged; then, and where anything else
// fails, nothing has changed. No callback of a linear problem is called.
std::unique_ptr<Integration> restore_checkpoint(Model& model, const ModelOptions& model_options,
                                                const IntegrationOptions& options, const SavedCheckpoint& saved,
                                                const WantedSensitivities* wanted = nullptr);

}  // namespace sfdae::core
