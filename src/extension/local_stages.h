// The stages of an implicit Runge-Kutta step for the extension with few states: Newton's method, with the equations
// linearized at each stage.
//
// With the states x_j held, the equations of stage i determine all other unknowns and the slopes x_j'. H_i is the
// matrix with the states held; T_i = -H_i^-1 (derivatives by the states) gives the changes with the states, and its
// rows B_i of the slopes leave
//
//    sum_k D_ik / h dz_k - B_i dz_i = slopes of H_i^-1 r_i,
//
// s d equations for the changes dz of the states of all stages, which are solved directly. One linearization for all
// stages (extension_stages.h) has s (n + sum c) unknowns, and contracts slowly if the solution turns within a step, as
// for mechanisms (docs/design/minimal_extension.md). All H_i are factored side by side by one elimination.
//
// For sensitivities rows of B_i come from rows of H_i^-1, half of which are needed if states are positions and
// velocities; the changes with the states come from a second solution (docs/design/minimal_extension.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "extension/coupled_states.h"
#include "extension/extension_linearization.h"
#include "extension/minimal_extension.h"
#include "extension/places_of_states.h"
#include "linalg/lanes.h"
#include "linalg/matrix.h"
#include "linalg/recorded_elimination.h"
#include "system/jet.h"
#include "system/strangeness_free_system.h"

namespace sfdae::core {

class LocalStages {
 public:
  explicit LocalStages(MinimalExtension& extension) : extension_(extension) {}

  // True for few states among not too many equations: at most `coupled` unknowns of all stages.
  bool is_of_use(int s, int coupled) const;
  bool is_of_use(int s) const;
  // Linearizes at the jets of all stages, with the states of `linearization`. Not ok: the error, or `singular`.
  PointStatus linearize(const StageEquations& equations, const std::vector<Jet>& jets,
                        ExtensionLinearization& linearization, CallbackError& error);
  // Linearizes with known derivatives: value(e, i) is that of entry e of the extension at stage i. B_i row by row,
  // without T, and pairs of states eliminated (coupled_states.h). False: singular, or more than `coupled` unknowns of
  // all stages are left.
  template <class Value>
  bool linearize(const StageMethod& method, double h, Value value, const ExtensionLinearization& linearization,
                 int coupled);
  // Archives the pivots, which outlive steps. When reading, the states of the linearization have to be set before.
  void archive(Archive& archive, const ExtensionLinearization& linearization);
  // True if it has the states of this linearization.
  bool is_of(const ExtensionLinearization& linearization) const {
    return places_.number == linearization.choice_number();
  }
  // r: residuals times -1 by rows, a column for each stage, with any leading dimension; becomes the changes by slots,
  // with those of x_j in place of x_j' of the states.
  void solve(View r);
  // After linearize(): the stage where the states are least suitable, if they are unsuitable there; -1 if they suit all
  // stages.
  int ill_served(ExtensionLinearization& linearization);
  // The derivative of the extension by entry e at a stage.
  double derivative(std::size_t e, int stage) const { return derivatives_[e].lane[stage]; }
  // T of the last stage: by slots, a column for each state.
  ConstView end_tangents() const { return {end_tangents_.data(), q_, d_, q_ > 0 ? q_ : 1}; }

 private:
  bool choose_pivots(const StateChoice& choice, int stage);
  void note_choice(const ExtensionLinearization& linearization);
  void resize(int s);
  bool take_pivots(const ExtensionLinearization& linearization);
  void find_pairs();
  bool finish_by_tangents(const StageMethod& method, double h, const StateChoice& choice);
  bool finish_by_rows(const StageMethod& method, double h, const StateChoice& choice, int coupled);
  void make_rows_of_slopes();
  void add_changes_of_states(const double* z);
  void subtract_changes_of_states(const double* z);
  PointStatus evaluate(const std::vector<Jet>& jets, ExtensionLinearization& linearization, CallbackError& error);
  void assemble(const StateChoice& choice);
  bool factor(const StateChoice& choice);
  void make_tangents();
  LaneBlock* tangent(int state) { return tangents_.data() + index(state) * index(q_); }

  MinimalExtension& extension_;
  int s_ = 0, q_ = 0, d_ = 0;
  RecordedElimination elimination_;
  PlacesOfStates places_;
  // A lane for each stage: derivatives of the extension, values of H_i in the order of its pattern, its factors, T_i
  // and right-hand sides.
  LaneArray derivatives_, values_, factors_, tangents_, r_, given_;
  std::vector<double> values_of_stage_, end_tangents_, stage_tangents_;
  CoupledStates coupled_;
  std::vector<CoupledStates::Pair> pairs_;
  std::vector<char> is_paired_;
  bool by_rows_ = false;  // there are no tangents
  LaneArray slopes_;      // remaining rows of B_i, one after the other
};

template <class Value>
bool LocalStages::linearize(const StageMethod& method, double h, Value value,
                            const ExtensionLinearization& linearization, int coupled) {
  resize(method.s);
  derivatives_.resize(extension_.column().size());
  for (std::size_t e = 0; e < derivatives_.size(); ++e)
    for (int l = 0; l < lane_count; ++l) derivatives_[e].lane[l] = value(e, std::min(l, s_ - 1));
  return take_pivots(linearization) && finish_by_rows(method, h, linearization.choice(), coupled);
}

}  // namespace sfdae::core
