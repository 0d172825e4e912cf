// The stages of a step for the extension, with the equations linearized at each.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/local_stages.h"

#include <algorithm>
#include <utility>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/small_kernels.h"

namespace sfdae::core {

namespace {

// docs/decisions/62-stages-with-few-states.md
constexpr int fewest_stages = 3, most_coupled = 40, most_rows = 300, rows_for_a_state = 4;
// In a step: one that suits all stages should be among them. Chosen, not measured.
constexpr int most_choices = 2;

}  // namespace

bool LocalStages::is_of_use(int s, int coupled) const {
  const int d = extension_.freedom(), q = extension_.num_rows();
  return s >= fewest_stages && d > 0 && d * s <= coupled && q <= most_rows && rows_for_a_state * d <= q;
}

bool LocalStages::is_of_use(int s) const { return is_of_use(s, most_coupled); }

// By the values of that stage.
bool LocalStages::choose_pivots(const StateChoice& choice, int stage) {
  values_of_stage_.clear();
  for (const LaneBlock& value : values_) values_of_stage_.push_back(value.lane[stage]);
  return elimination_.choose(choice.pattern(true), values_of_stage_.data()) == RecordedElimination::Choice::made;
}

// Other states have other matrices.
void LocalStages::note_choice(const ExtensionLinearization& linearization) {
  if (choice_ == linearization.choice_number()) return;
  choice_ = -1;  // until there is memory for all
  elimination_.forget();
  const StateChoice& choice = linearization.choice();
  slope_slots_.clear();
  held_entries_.clear();
  for (int j : choice.states()) slope_slots_.push_back(choice.slot(extension_.column_of(j, 1)));
  for (int row = 0; row < extension_.num_rows(); ++row)
    for (int e = extension_.first()[index(row)]; e < extension_.first()[index(row + 1)]; ++e) {
      const int column = extension_.column()[index(e)];
      if (!choice.is_held(column)) continue;
      const auto state =
          std::find(choice.states().begin(), choice.states().end(), extension_.columns()[index(column)].unknown);
      held_entries_.push_back({row, static_cast<int>(state - choice.states().begin()), index(e)});
    }
  choice_ = linearization.choice_number();
}

// Those of an earlier step, or of the linearization, or by its values.
bool LocalStages::take_pivots(const ExtensionLinearization& linearization) {
  note_choice(linearization);
  if (elimination_.has_pivots()) return true;
  if (const RecordedElimination* known = linearization.held().elimination()) {
    RecordedElimination copy = *known;
    elimination_ = std::move(copy);
    return true;
  }
  const StateChoice& choice = linearization.choice();
  values_of_stage_.resize(choice.pattern(true).row.size());
  choice.assemble(true, linearization.derivatives(), 0.0, values_of_stage_.data());
  return elimination_.choose(choice.pattern(true), values_of_stage_.data()) == RecordedElimination::Choice::made;
}

void LocalStages::archive(Archive& archive, const ExtensionLinearization& linearization) {
  if (archive.is_reading() || choice_ != linearization.choice_number()) note_choice(linearization);
  elimination_.archive(linearization.choice().pattern(true), archive);
}

// Lanes beyond those of the stages repeat the last one.
PointStatus LocalStages::evaluate(const std::vector<Jet>& jets, ExtensionLinearization& linearization,
                                  CallbackError& error) {
  if (extension_.linearize_side_by_side(jets, s_, derivatives_)) {
    for (int i = 0; i < s_; ++i) linearization.count_local();
    return PointStatus::ok;
  }
  derivatives_.resize(extension_.column().size());
  for (int i = 0; i < s_; ++i) {
    error = extension_.linearize(jets[index(i)]);
    if (error.status != SFDAE_OK) return PointStatus::callback_error;
    linearization.count_local();
    const int last = i < s_ - 1 ? i : lane_count - 1;
    for (std::size_t e = 0; e < derivatives_.size(); ++e)
      for (int l = i; l <= last; ++l) derivatives_[e].lane[l] = extension_.values()[e];
  }
  return PointStatus::ok;
}

void LocalStages::assemble(const StateChoice& choice) {
  const std::vector<int>& entries = choice.entries_of_held();
  values_.resize(entries.size());
  // 0: not -0
  for (std::size_t k = 0; k < entries.size(); ++k)
    for (int l = 0; l < lane_count; ++l) values_[k].lane[l] = 0.0 + derivatives_[index(entries[k])].lane[l];
}

// Where pivots do not suit a stage, with those of that stage.
bool LocalStages::factor(const StateChoice& choice) {
  assemble(choice);
  for (int choices = 0; choices <= most_choices; ++choices) {
    factors_.resize(std::max(factors_.size(), elimination_.fill()));
    const int refusing = elimination_.factor_lanes(values_.data(), factors_.data());
    if (refusing < 0) return true;
    if (!choose_pivots(choice, std::min(refusing, s_ - 1))) return false;
  }
  return false;
}

PointStatus LocalStages::linearize(const StageEquations& equations, const std::vector<Jet>& jets,
                                   ExtensionLinearization& linearization, CallbackError& error) {
  resize(equations.method.s);
  if (!take_pivots(linearization)) return PointStatus::singular;
  const PointStatus status = evaluate(jets, linearization, error);
  if (status != PointStatus::ok) return status;
  const double h = equations.t_end - equations.t;
  return finish(equations.method, h, linearization.choice()) ? PointStatus::ok : PointStatus::singular;
}

void LocalStages::resize(int s) {
  s_ = s;
  q_ = extension_.num_rows();
  d_ = extension_.freedom();
}

// From derivatives_.
bool LocalStages::finish(const StageMethod& method, double h, const StateChoice& choice) {
  if (!factor(choice)) return false;
  make_tangents();
  return factor_coupled(method, h);
}

void LocalStages::make_tangents() {
  tangents_.assign(index(q_) * index(d_), LaneBlock());
  for (const HeldEntry& held : held_entries_) {
    LaneBlock& b = tangent(held.state)[held.row];
    for (int l = 0; l < lane_count; ++l) b.lane[l] -= derivatives_[held.entry].lane[l];
  }
  for (int b = 0; b < d_; ++b) elimination_.solve_lanes(factors_.data(), tangent(b));
  end_tangents_.clear();
  for (const LaneBlock& block : tangents_) end_tangents_.push_back(block.lane[s_ - 1]);
}

bool LocalStages::factor_coupled(const StageMethod& method, double h) {
  const int size = s_ * d_;
  coupled_.resize(std::max(coupled_.size(), index(size) * index(size)));
  z_.resize(std::max(z_.size(), index(size)));
  pivots_.resize(std::max(pivots_.size(), index(size)));
  const View M{coupled_.data(), size, size, size};
  std::fill_n(coupled_.data(), index(size) * index(size), 0.0);
  for (int i = 0; i < s_; ++i) {
    for (int k = 0; k < s_; ++k)
      for (int a = 0; a < d_; ++a) M(i * d_ + a, k * d_ + a) = method.D_at(i, k) / h;
    for (int b = 0; b < d_; ++b)
      for (int a = 0; a < d_; ++a) M(i * d_ + a, i * d_ + b) -= tangent(b)[slope_slots_[index(a)]].lane[i];
  }
  // LAPACK takes 1.6 times the instructions for 20 equations.
  return size <= most_coupled ? small::factor_lu(M, pivots_.data()) : factor_lu(M, pivots_.data());
}

void LocalStages::solve(View r) {
  r_.resize(index(q_));
  for (int l = 0; l < lane_count; ++l)
    for (int row = 0; row < q_; ++row) r_[index(row)].lane[l] = r(row, std::min(l, s_ - 1));
  elimination_.solve_lanes(factors_.data(), r_.data());
  for (int i = 0; i < s_; ++i)
    for (int a = 0; a < d_; ++a) z_[index(i * d_ + a)] = r_[index(slope_slots_[index(a)])].lane[i];
  const int size = s_ * d_;
  solve_lu(ConstView{coupled_.data(), size, size, size}, pivots_.data(), z_.data());
  LaneBlock dz;
  for (int b = 0; b < d_; ++b) {
    for (int i = 0; i < s_; ++i) dz.lane[i] = z_[index(i * d_ + b)];
    for (int row = 0; row < q_; ++row)
      for (int l = 0; l < lane_count; ++l) r_[index(row)].lane[l] += tangent(b)[row].lane[l] * dz.lane[l];
  }
  for (int i = 0; i < s_; ++i)
    for (int a = 0; a < d_; ++a) r_[index(slope_slots_[index(a)])].lane[i] = z_[index(i * d_ + a)];
  for (int i = 0; i < s_; ++i)
    for (int row = 0; row < q_; ++row) r(row, i) = r_[index(row)].lane[i];
}

}  // namespace sfdae::core
