// Counts of an integration; those of its system continue from one integration to the next.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "integrate/integration_options.h"
#include "linalg/archive.h"
#include "system/dae_system.h"

namespace sfdae::core {

class WorkCounts {
 public:
  explicit WorkCounts(const DaeSystem& system) : before_(system.counts()) {}

  IntegrationCounts all(const DaeSystem& system) const {
    IntegrationCounts counts = own;
    counts.reductions = system.counts().reductions - before_.reductions;
    counts.factorizations = system.counts().factorizations - before_.factorizations;
    return counts;
  }
  // Continues from the counts of an integration that is restored.
  void restore(const IntegrationCounts& counts, const DaeSystem& system) {
    own = counts;
    before_.reductions = system.counts().reductions - counts.reductions;
    before_.factorizations = system.counts().factorizations - counts.factorizations;
  }

  IntegrationCounts own;  // excluding those of the system

 private:
  SystemCounts before_;
};

// is_short: without data that only statistics need.
inline void archive_counts(Archive& archive, IntegrationCounts& counts, bool is_short) {
  archive.counts(counts.steps, counts.error_failures);
  archive.counts(counts.other_failures, counts.reductions);
  long unused = 0;
  archive.counts(counts.factorizations, unused);
  if (is_short) return;
  for (double* value : {&counts.first_step, &counts.smallest_kept, &counts.inconsistency}) archive.real(*value);
}

}  // namespace sfdae::core
