// The stages of an implicit Runge-Kutta step for sensitivities along the minimal extension as one sparse system.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "extension/state_matrix.h"
#include "linalg/archive.h"
#include "linalg/repeated_systems.h"
#include "linalg/sparse_pattern.h"
#include "sensitivity/sensitivity_equations.h"
#include "sensitivity/sensitivity_step_matrix.h"
#include "system/jet.h"
#include "system/stage_method.h"

namespace sfdae::core {

struct SensitivityStagesTask {
  const StageMethod& method;
  double h;
  const std::vector<Jet>& jets;              // of x at the stages
  const std::vector<SensitivityRows>& rows;  // at the stages
  const double* S_start;                     // n x count
  const std::vector<double>& scales;         // of the unknowns: changes that do not matter, or zero
};

class SensitivityStagesTogether {
 public:
  explicit SensitivityStagesTogether(const SensitivityEquations& equations) : equations_(equations) {}
  // Call when states change.
  void forget() { s_ = 0; }
  // unknowns: of all stages by slots, a block for each stage, a column for each parameter. False: singular.
  bool solve(const SensitivityStagesTask& task, const StateChoice& choice, const SensitivitySlots& slots,
             std::vector<double>& unknowns);
  // Throws DamagedArchive.
  void archive(Archive& archive, const StateChoice& choice);

 private:
  void make_pattern(int s, const StateChoice& choice);
  void set_values(const SensitivityStagesTask& task, const StateChoice& choice);
  void set_right_hand_sides(const SensitivityStagesTask& task, const SensitivitySlots& slots);
  int count() const { return equations_.count(); }
  int num_rows() const { return equations_.extension().num_rows(); }

  const SensitivityEquations& equations_;
  int s_ = 0;  // 0: there is no such system yet
  RepeatedSystems system_;
  std::vector<std::size_t> positions_;  // of entries of the extension among those of the system
  std::vector<double> values_, right_, solution_;
};

}  // namespace sfdae::core
