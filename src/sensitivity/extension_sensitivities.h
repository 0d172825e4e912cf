// Sensitivities of equations that are solved by their minimal extension: linear equations along its jets, with sparse
// matrices.
//
// Steps and stages are those of x differentiated by p: the states of x are discretized, all other unknowns follow from
// the equations of the extension, which hold for S including all hidden constraints (docs/design/sensitivities.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "extension/extension_system.h"
#include "linalg/repeated_systems.h"
#include "problem/parameter_series.h"
#include "sensitivity/extension_sensitivity_stages.h"
#include "sensitivity/sensitivity_equations.h"
#include "sensitivity/sensitivity_step_matrix.h"
#include "system/sensitivity_system.h"

namespace sfdae::core {

class ExtensionSensitivities final : public SensitivitySystem {
 public:
  // Possible if no equation is replaced.
  static bool are_possible(const Structure& structure) { return structure.equations.num_replaced() == 0; }
  // parameters: as for ParameterSeries. The system and its problem must outlive this object.
  ExtensionSensitivities(ExtensionSystem& system, std::vector<int> parameters);

  int unknowns() const override { return system_.unknowns(); }
  const std::vector<int>& parameters() const override { return numbers_; }
  void parameters_changed() override { equations_.take_parameters(); }
  PointStatus solve_step(double c, const double* rest, const double* xdot, double* S) override;
  PointStatus keep_stage_of_step(const StageMethod& method, int i, const double* xdot) override;
  PointStatus keep_stage(const StageMethod& method, int i, const double* xdot) override;
  PointStatus solve_kept_stages(const StageMethod& method, double h, const double* S_start, double* S) override;
  PointStatus restore(const double* guess, double* S) override;
  void error_in_S(const double* errors, double* mapped) override { system_.error_in_x(errors, count(), mapped); }
  PointStatus derivative(const double* S, double* Sdot) override;
  void start(const ConsistencyRequest& request, const double* directions, double* S) override;
  // Null: only the derivative array provides one.
  std::unique_ptr<AdjointSystem> adjoint() override { return nullptr; }
  double inconsistency() const override { return 0.0; }
  const CallbackError& callback_error() const override { return callback_error_; }
  SensitivityCounts counts() const override { return {linearizations_, factorizations_ + stages_.factorizations()}; }
  void archive(Archive& archive) override;

 private:
  void take_choice();
  PointStatus linearize(const Jet& jet);
  void keep(const StageMethod& method, int i, const Jet& jet);
  // Writes to solution_ by slots; the states are those of S.
  bool solve_held(const double* S);
  bool states_are_differentiated() const;
  PointStatus find_next_coefficients(const Jet& longer, double* Sdot);
  void copy_x(const double* from_slots, double* S) const;
  void copy_held(const double* from, double* S) const;

  ExtensionSystem& system_;
  MinimalExtension& extension_;
  std::vector<int> numbers_;  // of the parameters
  ParameterSeries parameters_;
  SensitivityEquations equations_;
  long choice_number_ = -1;
  SensitivitySlots slots_;
  SensitivityStepMatrix step_;
  RepeatedSystems held_;
  ExtensionSensitivityStages stages_;
  SensitivityRows here_;
  // Stages that are stored until they are solved for; those of a step have its factors.
  struct KeptStages {
    std::vector<Jet> jets;
    std::vector<SensitivityRows> rows;
    bool are_of_step = false;
  } kept_;
  std::vector<double> values_, right_, solution_, taylor_;
  long linearizations_ = 0, factorizations_ = 0;
  CallbackError callback_error_;
};

}  // namespace sfdae::core
