// All models that can solve one problem.
//
// The problem's own model is the complete derivative array, or local coordinates of a mechanical system. The minimal
// extension also exists for recorded equations and for functions with patterns, if they are square, all of them may be
// differentiated, and no unknowns are prescribed. Linear equations and mechanical systems have the derivative array of
// nonlinear equations as a third model, which sensitivities use.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "array/nonlinear_model.h"
#include "extension/extension_model.h"
#include "linear/linear_model.h"
#include "multibody/multibody_model.h"

namespace sfdae::core {

struct Formulations {
  explicit Formulations(std::unique_ptr<LinearModel> model);
  explicit Formulations(std::unique_ptr<NonlinearModel> model);
  explicit Formulations(std::unique_ptr<MultibodyModel> model);

  // Builds the first-order equations of mechanical systems when needed. False: there is no structure.
  bool make_extension();
  void make_array();
  bool has_structure() const { return equations != nullptr || (multibody != nullptr && multibody->is_recorded()); }
  // Finite-difference Jacobians require the extension.
  bool has_differences() const { return has_source() && equations->source()->has_differences(); }
  // True if the equations are callbacks.
  bool has_source() const { return equations != nullptr && equations->source() != nullptr; }
  bool has_array() const { return owned_equations != nullptr || multibody != nullptr; }

  std::unique_ptr<WholeModel> own;
  // The kind of problem: one of the pointers is set.
  LinearModel* linear = nullptr;
  NonlinearModel* nonlinear = nullptr;
  MultibodyModel* multibody = nullptr;
  // Equations of the extension, or null; owned_equations: set if they are not those of `own`.
  RecordedProblem* equations = nullptr;
  std::unique_ptr<RecordedProblem> owned_equations;
  std::unique_ptr<ExtensionModel> extension;
  std::unique_ptr<NonlinearModel> array;

 private:
  void set_equations(RecordedProblem& its_equations);
  void set_equations(std::unique_ptr<RecordedProblem> its_equations);
};

}  // namespace sfdae::core
