// All models that can solve one problem.
//
// Its own one is the whole derivative array, or local coordinates of a mechanical system. Recorded equations, and
// functions with patterns, as many as unknowns, all of which may be differentiated and none of the unknowns of which
// are prescribed, also have their minimal extension. Linear equations and mechanical systems have the derivative array
// of nonlinear equations as a third one, which sensitivities are asked of.
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

  // The first-order equations of mechanical systems are made when they are needed. False: there is no structure.
  bool make_extension();
  void make_array();
  bool has_structure() const { return equations != nullptr || (multibody != nullptr && multibody->is_recorded()); }
  // Jacobians by differences have nothing else to be solved by than the extension.
  bool has_differences() const { return has_source() && equations->source()->has_differences(); }
  // The equations are functions.
  bool has_source() const { return equations != nullptr && equations->source() != nullptr; }
  bool has_array() const { return owned_equations != nullptr || multibody != nullptr; }

  std::unique_ptr<WholeModel> own;
  // What it is: one of the pointers is set.
  LinearModel* linear = nullptr;
  NonlinearModel* nonlinear = nullptr;
  MultibodyModel* multibody = nullptr;
  // Equations of the extension, or null; owned_equations: these if they are not those of `own`.
  RecordedProblem* equations = nullptr;
  std::unique_ptr<RecordedProblem> owned_equations;
  std::unique_ptr<ExtensionModel> extension;
  std::unique_ptr<NonlinearModel> array;

 private:
  void set_equations(RecordedProblem& its_equations);
  void set_equations(std::unique_ptr<RecordedProblem> its_equations);
};

}  // namespace sfdae::core
