// The chord iteration for all equations of the extension at one point.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "extension/extension_linearization.h"
#include "extension/minimal_extension.h"
#include "system/chord_iteration.h"
#include "system/dae_system.h"
#include "system/jet.h"

namespace sfdae::core {

// x_j' = c x_j + w_rest_j for the states.
struct StepTask {
  double c;
  const double* w_rest;
  const double* inverse_weights;
  double tolerance;  // of the weighted changes of x
};

class ExtensionIteration {
 public:
  // callback_error: that of the last evaluation is kept there.
  ExtensionIteration(MinimalExtension& extension, CallbackError& callback_error)
      : extension_(extension), callback_error_(callback_error) {}

  // From the jet on, to the one that solves the task.
  PointStatus solve_step(const StepTask& task, ExtensionLinearization& linearization, Jet& jet);
  // To the jet that fulfils all equations with the states as they are, as accurately as rounding permits. scales: changes of
  // the unknowns that do not matter, n values; whether the iteration is slow stays as it was.
  PointStatus solve_held(ExtensionLinearization& linearization, const std::vector<double>& scales, Jet& jet);
  // x' of all unknowns at such a jet, to which they belong.
  PointStatus derivative(ExtensionLinearization& linearization, const Jet& jet, double* xdot);

  ChordIteration& chord() { return chord_; }
  // The step matrix is for another c, which slow iterations come from: a new one may be all that is needed.
  bool blames_matrix() const;

  // residuals, by rows, of the jet, negative.
  PointStatus evaluate(const Jet& jet, double* r);
  // The jet, but for x_j' of states, changes by `factor` times z, by slots: by how much, weighted. c: of the step.
  struct Change {
    double c, factor;
    const double* inverse_weights;
  };
  double apply_change(const Change& change, const double* z, const ExtensionLinearization& linearization, Jet& jet);
  static void set_slopes(const StateChoice& choice, double c, const double* w_rest, Jet& jet);

 private:
  bool prepare_matrix(double c, ExtensionLinearization& linearization);
  // Of x, and of its derivatives; relative.
  struct Norms {
    double of_x = 0.0, of_derivatives = 0.0;
  };
  Norms apply_held(const std::vector<double>& scales, const ExtensionLinearization& linearization, Jet& jet);

  MinimalExtension& extension_;
  CallbackError& callback_error_;
  ChordIteration chord_;
  double deviation_ = 0.0;  // of c: the contraction that keeping the matrix costs
  std::vector<double> r_;
  Jet longer_;
};

}  // namespace sfdae::core
