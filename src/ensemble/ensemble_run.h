// The instances of an ensemble, divided among threads.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ensemble/ensemble_worker.h"

namespace sfdae::core {

struct EnsembleSummary {
  int stopped = 0, failed = 0;  // instances
  int analyses = 0;
  int threads = 0;
  int first_failed = -1;  // the smallest number of an instance that failed
  InstanceOutcome failure;
  bool monitor_threw = false;
};

// Solves all instances. Throws std::bad_alloc before anything has been written, if there is no memory to begin with.
EnsembleSummary solve_ensemble(Solver& prototype, const EnsembleTask& task);

}  // namespace sfdae::core
