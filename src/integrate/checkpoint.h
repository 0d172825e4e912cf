// An integration with its system, saved to and restored from a sequence of doubles.
//
// The problem, the settings of the analysis, tolerances and other options are not part of it: they are given anew, the
// problem and the settings as they were.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include "integrate/integration.h"
#include "system/linear_system.h"

namespace sfdae::core {

// Doubles needed.
std::size_t checkpoint_size(DaeSystem& system, Integration& integration);
void save_checkpoint(DaeSystem& system, Integration& integration, double* to);

// What a checkpoint is restored to.
struct CheckpointTarget {
  int m, n;
  std::function<std::unique_ptr<DaeSystem>(Archive&)> system;
  std::function<std::unique_ptr<ChangeDetector>(DaeSystem&)> detector;
};

struct Restored {
  std::unique_ptr<DaeSystem> system;
  std::unique_ptr<Integration> integration;
};

// Throws Failure SFDAE_ILLEGAL_ARGUMENT if it is not a checkpoint of such a problem, or damaged. length may be larger
// than the checkpoint. No callback is called.
Restored restore_checkpoint(const CheckpointTarget& target, const IntegrationOptions& options, const double* from,
                            std::size_t length);

// system is a LinearSystem. The problem has to live on.
CheckpointTarget linear_target(LinearProblem& problem, const AnalysisSettings& settings);

}  // namespace sfdae::core
