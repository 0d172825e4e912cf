// The chord iteration for all equations of the extension at one point.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "extension/extension_linearization.h"
#include "extension/minimal_extension.h"
#include "linalg/index.h"
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
  // callback_error receives the error of the last evaluation.
  ExtensionIteration(MinimalExtension& extension, CallbackError& callback_error)
      : extension_(extension), callback_error_(callback_error) {}

  // jet: a guess; becomes the jet that satisfies all equations and the task.
  PointStatus solve_step(const StepTask& task, ExtensionLinearization& linearization, Jet& jet);
  // jet: a guess; becomes the jet that satisfies all equations with the states held, to machine precision. scales:
  // negligible changes of the unknowns, n values. The rate flag of the chord iteration is not changed. Hope::none:
  // there is no better linearization, so small changes that no longer decrease are rounding errors.
  enum class Hope { other_linearization, none };
  PointStatus solve_held(ExtensionLinearization& linearization, const std::vector<double>& scales, Hope hope,
                         Jet& jet);
  // x' of all unknowns at such a jet, n values, even if x_j' is not in the extension.
  PointStatus derivative(ExtensionLinearization& linearization, Hope hope, const Jet& jet, double* xdot);
  // The jet that derivative() found last, of one order more, with x_j^(d_j + 1) if not all x_j' are in the extension.
  const Jet& longer_jet() const { return longer_; }

  ChordIteration& chord() { return chord_; }
  CallbackError& callback_error() { return callback_error_; }
  // True if slow iterations may be due to a step matrix for another c: a new one may be all that is needed.
  bool blames_matrix() const;
  // Archives the data besides the linearization that steps depend on.
  void archive(Archive& archive) {
    chord_.archive_rate(archive);
    archive.real(waste_);
  }

  // The residuals of the jet, by rows, times -1.
  PointStatus evaluate(const Jet& jet, double* r);
  // Adds `factor` times z, by slots, to the jet, except to x_j' of states. Returns the largest weighted change.
  double apply_change(double factor, const double* z, const ExtensionLinearization& linearization, Jet& jet);
  // Sets the weights of the changes of a step with this c, until they are set again.
  void set_weights(double c, const double* inverse_weights, const StateChoice& choice);
  static void set_slopes(const StateChoice& choice, double c, const double* w_rest, Jet& jet);
  // Size of the unknown of a column of the extension at a jet, of its tolerance or of its last change, in a step with
  // these weights. slope(j): that of x_j' of a state.
  struct Place {
    const Jet& now;
    const double* change;  // the last one, by slots
    const StateChoice& choice;
  };
  template <class Slope>
  double size_of(RowSums kind, const Place& place, int column, Slope slope) const;
  // Adds up terms of the rows. value(e): derivatives of the extension by its entries; size(column).
  template <class Value, class Size>
  void add_terms(Value value, Size size, double* rows) const;

 private:
  class StepEquations;
  bool prepare_matrix(double c, ExtensionLinearization& linearization);
  // Relative changes of x and of its derivatives.
  struct Norms {
    double of_x = 0.0, of_derivatives = 0.0;
  };
  struct Yardsticks {
    const std::vector<double>& scales;  // of the unknowns x_j
    const std::vector<double>& noise;   // by columns of the extension
  };
  Norms apply_held(const Yardsticks& yardsticks, const StateChoice& choice, Jet& jet);

  MinimalExtension& extension_;
  CallbackError& callback_error_;
  ChordIteration chord_;
  double deviation_ = 0.0;  // of c: the contraction due to reuse of the matrix
  double waste_ = 0.0;      // iterations that its reuse has cost so far
  std::vector<double> r_, weights_;
  double c_ = 0.0;  // of the step, with the weights of x, which live as long
  const double* inverse_weights_ = nullptr;
  Jet longer_;
};

template <class Slope>
double ExtensionIteration::size_of(RowSums kind, const Place& place, int column, Slope slope) const {
  const auto [unknown, order] = extension_.columns()[index(column)];
  if (kind == RowSums::of_tolerances) return std::pow(std::fabs(c_), order) / inverse_weights_[unknown];
  if (place.choice.is_slope(column)) return slope(unknown);
  return std::fabs(kind == RowSums::of_change ? place.change[place.choice.slot(column)]
                                              : place.now.column(order)[unknown]);
}

template <class Value, class Size>
void ExtensionIteration::add_terms(Value value, Size size, double* rows) const {
  const int* column = extension_.column().data();
  const int* const first = extension_.first().data();
  for (int i = 0; i < extension_.num_rows(); ++i) {
    double sum = 0.0;
    for (int e = first[i]; e < first[i + 1]; ++e) sum += std::fabs(value(index(e))) * size(*column++);
    rows[i] += sum;
  }
}

}  // namespace sfdae::core
