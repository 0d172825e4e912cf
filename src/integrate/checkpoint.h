// Checkpoints: an integration with its system, saved to and restored from a sequence of doubles.
//
// A checkpoint does not contain the problem, analysis settings, tolerances and other options. The caller supplies them
// again; the problem, its parameters and the settings must be unchanged (checkpoint_identity.h). It contains
// sensitivities and their parameters.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "integrate/integration.h"
#include "system/model.h"

namespace sfdae::core {

// Number of doubles needed.
std::size_t checkpoint_size(DaeSystem& system, Integration& integration);
void save_checkpoint(DaeSystem& system, Integration& integration, double* to);

struct SavedCheckpoint {
  const double* values;
  std::size_t length;  // may be larger than the checkpoint
};

// Sensitivities expected in a checkpoint.
struct WantedSensitivities {
  const std::vector<int>& parameters;
  const SensitivityOptions& options;
};

// wanted: null if no sensitivities are expected. Restores the system of the model, too. Throws Failure
// SFDAE_ILLEGAL_ARGUMENT if the checkpoint is damaged or belongs to another problem. Any failure leaves everything
// unchanged. No callback of a linear problem is called.
std::unique_ptr<Integration> restore_checkpoint(Model& model, const ModelOptions& model_options,
                                                const IntegrationOptions& options, const SavedCheckpoint& saved,
                                                const WantedSensitivities* wanted = nullptr);

}  // namespace sfdae::core
