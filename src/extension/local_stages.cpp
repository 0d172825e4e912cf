// The stages of a step for the extension, with the equations linearized at each.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/local_stages.h"

#include <algorithm>
#include <utility>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// docs/design/minimal_extension.md
constexpr int fewest_stages = 3, most_coupled = 40, most_rows = 300, rows_for_a_state = 4;
// Choices of pivots in a step: one of them should suit all stages. Chosen, not measured.
constexpr int most_choices = 2;

}  // namespace

bool LocalStages::is_of_use(int s, int coupled) const {
  const int d = extension_.freedom(), q = extension_.num_rows();
  return s >= fewest_stages && d > 0 && d * s <= coupled && q <= most_rows && rows_for_a_state * d <= q;
}

bool LocalStages::is_of_use(int s) const { return is_of_use(s, most_coupled); }

// Chooses pivots by the values of that stage.
bool LocalStages::choose_pivots(const StateChoice& choice, int stage) {
  values_of_stage_.clear();
  for (const LaneBlock& value : values_) values_of_stage_.push_back(value.lane[stage]);
  return elimination_.choose(choice.pattern(true), values_of_stage_.data()) == RecordedElimination::Choice::made;
}

// Forgets data of other states, which have other matrices.
void LocalStages::note_choice(const ExtensionLinearization& linearization) {
  if (is_of(linearization)) return;
  places_.number = -1;  // until there is memory for all
  elimination_.forget();
  places_ = PlacesOfStates(extension_, linearization.choice(), linearization.choice_number());
}

// Takes pivots of an earlier step, or of the linearization, or chooses them by its values.
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
  if (archive.is_reading() || !is_of(linearization)) note_choice(linearization);
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

// Factors all stages; pivots that do not suit a stage are chosen again by the values of that stage.
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
  const bool is_factored = finish_by_tangents(equations.method, h, linearization.choice());
  return is_factored ? PointStatus::ok : PointStatus::singular;
}

void LocalStages::resize(int s) {
  s_ = s;
  q_ = extension_.num_rows();
  d_ = extension_.freedom();
}

// Completes the linearization from derivatives_.
bool LocalStages::finish_by_tangents(const StageMethod& method, double h, const StateChoice& choice) {
  by_rows_ = false;
  if (!factor(choice)) return false;
  make_tangents();
  return coupled_.factor(method, h, d_,
                         [this](int a, int b, int i) { return tangent(b)[places_.slope_slots[index(a)]].lane[i]; });
}

bool LocalStages::finish_by_rows(const StageMethod& method, double h, const StateChoice& choice, int coupled) {
  by_rows_ = true;
  find_pairs();
  coupled_.set_pairs(d_, pairs_);
  if (s_ * (d_ - coupled_.pairs()) > coupled || !factor(choice)) return false;
  make_rows_of_slopes();
  return coupled_.factor_condensed(method, h,
                                   [this](int c, int b, int i) { return slopes_[index(c * d_ + b)].lane[i]; });
}

// Pairs by values of all stages, each state in at most one.
void LocalStages::find_pairs() {
  pairs_.clear();
  is_paired_.assign(index(d_), 0);
  for (const PlacesOfStates::Candidate& candidate : places_.candidates) {
    const auto [a, b] = candidate.pair;
    const LaneBlock &of_slope = derivatives_[candidate.of_slope], &of_state = derivatives_[candidate.of_state];
    bool is_pair = is_paired_[index(a)] == 0 && is_paired_[index(b)] == 0;
    for (int i = 0; i < s_ && is_pair; ++i)
      is_pair = of_slope.lane[i] != 0.0 && of_state.lane[i] == -of_slope.lane[i];
    if (!is_pair) continue;
    is_paired_[index(a)] = is_paired_[index(b)] = 1;
    pairs_.push_back(candidate.pair);
  }
}

void LocalStages::make_rows_of_slopes() {
  const std::vector<int>& equations = coupled_.equations();
  slopes_.resize(std::max(slopes_.size(), equations.size() * index(d_)));
  r_.resize(index(q_));
  LaneBlock* to = slopes_.data();
  for (int c : equations) {
    elimination_.row_of_inverse_lanes(factors_.data(), s_, places_.slope_slots[index(c)], r_.data());
    const PlacesOfStates::Entry* held = places_.entries.data();
    for (int b = 0; b < d_; ++b) {
      Lanes sum{};
      for (const PlacesOfStates::Entry* const last = places_.entries.data() + places_.first[index(b + 1)];
           held != last; ++held)
        sum -= lanes(r_[index(held->row)]) * lanes(derivatives_[held->entry]);
      lanes(*to++) = sum;
    }
  }
}

void LocalStages::make_tangents() {
  tangents_.assign(index(q_) * index(d_), LaneBlock());
  for (const PlacesOfStates::Entry& held : places_.entries) {
    LaneBlock& b = tangent(held.state)[held.row];
    for (int l = 0; l < lane_count; ++l) b.lane[l] -= derivatives_[held.entry].lane[l];
  }
  for (int b = 0; b < d_; ++b) elimination_.solve_lanes(factors_.data(), tangent(b));
  end_tangents_.clear();
  for (const LaneBlock& block : tangents_) end_tangents_.push_back(block.lane[s_ - 1]);
}

int LocalStages::ill_served(ExtensionLinearization& linearization) {
  int worst = 0;
  double largest = 0.0;
  stage_tangents_.resize(tangents_.size());
  for (int i = 0; i < s_; ++i) {
    for (std::size_t k = 0; k < tangents_.size(); ++k) stage_tangents_[k] = tangents_[k].lane[i];
    const double sensitivity = linearization.sensitivity({stage_tangents_.data(), q_, d_, std::max(q_, 1)});
    if (sensitivity >= largest) {
      largest = sensitivity;
      worst = i;
    }
  }
  if (!linearization.is_harmless(largest)) return worst;
  linearization.note_sensitivity(largest);
  return -1;
}

// Adds T times the changes of the states.
void LocalStages::add_changes_of_states(const double* z) {
  LaneBlock dz;
  for (int b = 0; b < d_; ++b) {
    for (int i = 0; i < s_; ++i) dz.lane[i] = z[i * d_ + b];
    for (int row = 0; row < q_; ++row)
      for (int l = 0; l < lane_count; ++l) r_[index(row)].lane[l] += tangent(b)[row].lane[l] * dz.lane[l];
  }
}

// Solves once more with the changed states.
void LocalStages::subtract_changes_of_states(const double* z) {
  std::swap(r_, given_);
  for (const PlacesOfStates::Entry& held : places_.entries)
    for (int i = 0; i < s_; ++i)
      r_[index(held.row)].lane[i] -= derivatives_[held.entry].lane[i] * z[i * d_ + held.state];
  elimination_.solve_lanes(factors_.data(), s_, r_.data());
}

void LocalStages::solve(View r) {
  r_.resize(index(q_));
  for (int l = 0; l < lane_count; ++l)
    for (int row = 0; row < q_; ++row) r_[index(row)].lane[l] = r(row, std::min(l, s_ - 1));
  if (by_rows_) given_ = r_;
  elimination_.solve_lanes(factors_.data(), by_rows_ ? s_ : lane_count, r_.data());
  double* const z = coupled_.right();
  for (int i = 0; i < s_; ++i)
    for (int a = 0; a < d_; ++a) z[i * d_ + a] = r_[index(places_.slope_slots[index(a)])].lane[i];
  coupled_.solve();
  if (by_rows_) subtract_changes_of_states(z);
  else add_changes_of_states(z);
  for (int i = 0; i < s_; ++i)
    for (int a = 0; a < d_; ++a) r_[index(places_.slope_slots[index(a)])].lane[i] = z[i * d_ + a];
  for (int i = 0; i < s_; ++i)
    for (int row = 0; row < q_; ++row) r(row, i) = r_[index(row)].lane[i];
}

}  // namespace sfdae::core
