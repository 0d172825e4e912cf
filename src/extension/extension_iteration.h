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
  // callback_error: that of the last evaluation is kept there.
  ExtensionIteration(MinimalExtension& extension, CallbackError& callback_error)
      : extension_(extension), callback_error_(callback_error) {}

  // jet: in: a guess, out: the jet that fulfils all equations and the task.
  PointStatus solve_step(const StepTask& task, ExtensionLinearization& linearization, Jet& jet);
  // jet: in: a guess, out: the jet that fulfils all equations with the states as they are, as accurately as rounding
  // permits. scales: changes of the unknowns that do not matter, n values. Whether the iteration is slow stays as it
  // was. There is no better linearization: changes that have stopped becoming smaller are rounding errors, if they
  // are small.
  enum class Hope { other_linearization, none };
  PointStatus solve_held(ExtensionLinearization& linearization, const std::vector<double>& scales, Hope hope,
                         Jet& jet);
  // x' of all unknowns at such a jet, n values, also where the extension has no x_j'.
  PointStatus derivative(ExtensionLinearization& linearization, Hope hope, const Jet& jet, double* xdot);
  // The jet that it has found last, of one order more, with x_j^(d_j + 1) if not all x_j' are in the extension.
  const Jet& longer_jet() const { return longer_; }

  ChordIteration& chord() { return chord_; }
  CallbackError& callback_error() { return callback_error_; }
  // The step matrix is for another c, which slow iterations come from: a new one may be all that is needed.
  bool blames_matrix() const;
  // What steps depend on besides the linearization.
  void archive(Archive& archive) {
    chord_.archive_rate(archive);
    archive.real(waste_);
  }

  // The residuals of the jet, by rows, times -1.
  PointStatus evaluate(const Jet& jet, double* r);
  // Adds `factor` times z, by slots, to the jet, but for x_j' of states. Returns the largest change, by the weights.
  double apply_change(double factor, const double* z, const ExtensionLinearization& linearization, Jet& jet);
  // Those of the changes of a step with this c, until they are set again.
  void set_weights(double c, const double* inverse_weights, const StateChoice& choice);
  static void set_slopes(const StateChoice& choice, double c, const double* w_rest, Jet& jet);
  // Adds up terms of the rows at a jet, in a step with these weights. value(e): derivatives of the extension by its
  // entries; slope(j): by how much x_j' of a state differs by x.
  struct Place {
    const Jet& now;
    const double* change;  // the last one, by slots
    const StateChoice& choice;
  };
  template <class Value, class Slope>
  void add_terms(RowSums kind, const Place& place, Value value, Slope slope, double* rows) const;

 private:
  class StepEquations;
  bool prepare_matrix(double c, ExtensionLinearization& linearization);
  // Of changes of x, and of its derivatives, relative.
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
  double deviation_ = 0.0;  // of c: the contraction that keeping the matrix costs
  double waste_ = 0.0;      // iterations that the matrix kept has cost so far
  std::vector<double> r_, weights_;
  double c_ = 0.0;  // of the step, with the weights of x, which live as long
  const double* inverse_weights_ = nullptr;
  Jet longer_;
};

template <class Value, class Slope>
void ExtensionIteration::add_terms(RowSums kind, const Place& place, Value value, Slope slope, double* rows) const {
  for (int i = 0; i < extension_.num_rows(); ++i)
    for (int e = extension_.first()[index(i)]; e < extension_.first()[index(i + 1)]; ++e) {
      const int column = extension_.column()[index(e)];
      const auto [unknown, order] = extension_.columns()[index(column)];
      double size;
      if (kind == RowSums::of_tolerances) size = std::pow(std::fabs(c_), order) / inverse_weights_[unknown];
      else if (place.choice.is_slope(column)) size = slope(unknown);
      else if (kind == RowSums::of_change) size = place.change[place.choice.slot(column)];
      else size = place.now.column(order)[unknown];
      rows[i] += std::fabs(value(index(e)) * size);
    }
}

}  // namespace sfdae::core
