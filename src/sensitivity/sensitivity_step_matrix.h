// The matrix of steps of sensitivities along the minimal extension: derivatives by x_j^(l), and c times those by x_j'
// of the states in the columns of x_j. Constant entries are copied once.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "extension/state_matrix.h"
#include "linalg/archive.h"
#include "linalg/repeated_systems.h"
#include "sensitivity/sensitivity_equations.h"

namespace sfdae::core {

class SensitivityStepMatrix {
 public:
  // varying: entries of the extension, as in SensitivityEquations.
  // accepted: as for PlannedLu.
  void set(const StateChoice& choice, const SensitivitySlots& slots, const std::vector<int>& varying,
           double accepted);
  // As RepeatedSystems::solve.
  bool solve(const SensitivityRows& rows, double c, const double* b, int count, double* x) {
    assemble(rows, c);
    return systems_.solve(values_, b, count, x);
  }
  // Reading: after set(). Throws DamagedArchive.
  void archive(Archive& archive) { systems_.archive(archive); }

 private:
  void assemble(const SensitivityRows& rows, double c);

  // Entries go to values_, those by x_j' and those by x_j in the same place to mixed_, after each other.
  struct Copy {
    int entry, to;
  };
  std::vector<Copy> all_values_, all_mixed_, varying_values_, varying_mixed_;
  std::vector<int> places_;             // of sums: mixed_[2 k] + c mixed_[2 k + 1]
  std::vector<double> values_, mixed_;  // values_: in the order of the pattern
  RepeatedSystems systems_;
  long version_ = -1;  // of the entries that do not vary
};

}  // namespace sfdae::core
