// The stages of an implicit Runge-Kutta step for sensitivities along the minimal extension: the linear equations of
// all stages, each with its own derivatives, and for the states j
//
//     S_j' = sum_k D_ik (S_j,k - S_j) / h        at stage i.
//
// If states are few among the unknowns, each stage is eliminated down to its states, which leaves s d equations for
// each parameter (local_stages.h). Else by iterations with the factors of x, which hold for one linearization and
// decouple the stages: residuals use the derivatives of each stage, and are removed until they are rounding errors. If
// iterations contract slowly, or x has no factors, as one sparse system for all stages.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <vector>

#include "extension/extension_linearization.h"
#include "extension/local_stages.h"
#include "linalg/archive.h"
#include "sensitivity/sensitivity_equations.h"
#include "sensitivity/sensitivity_stages_together.h"
#include "system/stage_method.h"

namespace sfdae::core {

class ExtensionSensitivityStages {
 public:
  using Task = SensitivityStagesTask;

  explicit ExtensionSensitivityStages(SensitivityEquations& equations)
      : equations_(equations), local_(equations.extension()), together_(equations) {}
  // Sets other states. choice: must live until the next call, as the slots do.
  void set_choice(const StateChoice& choice, const SensitivitySlots& slots);
  // S: n x count for each stage. Solves for the states of the stages alone. linearization: with these states; by: the
  // factors of x of the same step, or null. False: not worthwhile, or the others are not found.
  bool solve_locally(const Task& task, const ExtensionLinearization& linearization, LocalStages* by, double* S);
  // Same by the other methods. by: with the factors of x, of the step that x has taken; or null. False: singular.
  bool solve(const Task& task, ExtensionLinearization* by, double* S);
  long factorizations() const { return factorizations_; }
  // Reading: after set_choice(). Throws DamagedArchive.
  void archive(Archive& archive, const ExtensionLinearization& linearization);

 private:
  void resize(int s);
  bool copy_to(int s, double* S) const;
  template <class TakeAway>
  bool iterate(const Task& task, TakeAway take_away);
  void predict(const Task& task);
  bool extrapolate(const Task& task);
  void note_step(const Task& task);
  void set_residuals(const Task& task);
  static constexpr int at_once = 4;  // parameters
  template <int width>
  void subtract_rows(const SensitivityRows& rows, int i, int q, int used);
  void take_away(const Task& task, ExtensionLinearization& by);
  void take_away(const Task& task, LocalStages& by);
  double add_changes(const Task& task);
  int count() const { return equations_.count(); }
  int num_rows() const { return equations_.extension().num_rows(); }
  // Block of stage i and parameter q.
  double* block(std::vector<double>& of_all, int i, int q) const {
    return of_all.data() + (index(i) * index(count()) + index(q)) * index(num_rows());
  }

  SensitivityEquations& equations_;
  LocalStages local_;
  const StateChoice* choice_ = nullptr;
  const SensitivitySlots* slots_ = nullptr;
  // By slots, and by rows: a block for each stage, a column for each parameter.
  std::vector<double> unknowns_, r_, transformed_;
  std::vector<std::complex<double>> pair_;
  // States: S_j minus that at the start, S_j', blocks as above.
  std::vector<double> changes_, slopes_;
  std::vector<int> source_;  // of the entries of the extension: a slot, or behind all slots a state
  std::vector<double> sources_, per_scale_;
  // Data of the last step solved with the factors of x: times of its stages and unknowns there.
  struct LastStep {
    std::vector<double> times, unknowns;
  } before_;
  SensitivityStagesTogether together_;
  long factorizations_ = 0;
};

}  // namespace sfdae::core
