// The stages of a step for the extension, with the equations linearized at each.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/local_stages.h"

#include <algorithm>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// docs/decisions/62-stages-with-few-states.md
constexpr int fewest_stages = 3, most_coupled = 40, most_rows = 300, rows_for_a_state = 4;
// In a step: one that suits all stages should be among them. Chosen, not measured.
constexpr int most_choices = 2;

}  // namespace

bool LocalStages::is_of_use(int s) const {
  const int d = extension_.freedom(), q = extension_.num_rows();
  return s >= fewest_stages && d > 0 && d * s <= most_coupled && q <= most_rows && rows_for_a_state * d <= q;
}

// By the values that were factored last.
bool LocalStages::choose_pivots(const StateChoice& choice) {
  pivots_of_ = -1;
  return elimination_.choose(choice.layout(true).pattern, values_.data()) == RecordedElimination::Choice::made;
}

// Those that the linearization has, which are archived.
bool LocalStages::take_pivots(const ExtensionLinearization& linearization) {
  if (pivots_of_ == linearization.number()) return true;
  const RecordedElimination* known = linearization.held().elimination();
  if (known == nullptr) return false;
  elimination_ = *known;
  pivots_of_ = linearization.number();
  return true;
}

bool LocalStages::factor(int stage, const StateChoice& choice, const ExtensionDerivatives& derivatives) {
  factors_.resize(std::max(factors_.size(), elimination_.fill() * index(s_)));
  choice.assemble(choice.layout(true), derivatives, 0.0, values_);
  return elimination_.factor(values_.data(), factors(stage));
}

// Pivots are those of the linearization; where they do not suit a stage, those of that stage, for this step alone.
PointStatus LocalStages::linearize(const StageEquations& equations, const std::vector<Jet>& jets,
                                   ExtensionLinearization& linearization, CallbackError& error) {
  const StateChoice& choice = linearization.choice();
  s_ = equations.method.s;
  q_ = extension_.num_rows();
  d_ = extension_.freedom();
  if (!take_pivots(linearization)) return PointStatus::singular;
  tangents_.resize(std::max(tangents_.size(), index(s_) * index(q_) * index(d_)));
  slope_slots_.clear();
  for (int j : choice.states()) slope_slots_.push_back(choice.slot(extension_.column_of(j, 1)));
  int choices = 0;
  for (int i = 0; i < s_; ++i) {
    error = extension_.linearize(jets[index(i)]);
    if (error.status != SFDAE_OK) return PointStatus::callback_error;
    linearization.count_local();
    if (factor(i, choice, {extension_, extension_.values()})) {
      make_tangents(i, choice);
      continue;
    }
    if (choices++ == most_choices || !choose_pivots(choice)) return PointStatus::singular;
    i = -1;
  }
  return factor_coupled(equations) ? PointStatus::ok : PointStatus::singular;
}

void LocalStages::make_tangents(int stage, const StateChoice& choice) {
  double* const T = tangents_.data() + index(stage) * index(q_) * index(d_);
  std::fill_n(T, index(q_) * index(d_), 0.0);
  const std::vector<int>& states = choice.states();
  for (int b = 0; b < d_; ++b) {
    const int held = extension_.column_of(states[index(b)], 0);
    double* const column = T + index(b) * index(q_);
    for (int row = 0; row < q_; ++row)
      for (int e = extension_.first()[index(row)]; e < extension_.first()[index(row + 1)]; ++e)
        if (extension_.column()[index(e)] == held) column[row] -= extension_.values()[index(e)];
    elimination_.solve(factors(stage), column);
  }
}

bool LocalStages::factor_coupled(const StageEquations& equations) {
  const int size = s_ * d_;
  const double h = equations.t_end - equations.t;
  coupled_.resize(std::max(coupled_.size(), index(size) * index(size)));
  z_.resize(std::max(z_.size(), index(size)));
  pivots_.resize(std::max(pivots_.size(), index(size)));
  const View M{coupled_.data(), size, size, size};
  std::fill_n(coupled_.data(), index(size) * index(size), 0.0);
  for (int i = 0; i < s_; ++i) {
    for (int k = 0; k < s_; ++k)
      for (int a = 0; a < d_; ++a) M(i * d_ + a, k * d_ + a) = equations.method.D_at(i, k) / h;
    const ConstView T = tangents(i);
    for (int b = 0; b < d_; ++b)
      for (int a = 0; a < d_; ++a) M(i * d_ + a, i * d_ + b) -= T(slope_slots_[index(a)], b);
  }
  return factor_lu(M, pivots_.data());
}

void LocalStages::solve(View r) {
  for (int i = 0; i < s_; ++i) {
    elimination_.solve(factors(i), r.column(i));
    for (int a = 0; a < d_; ++a) z_[index(i * d_ + a)] = r(slope_slots_[index(a)], i);
  }
  const int size = s_ * d_;
  solve_lu(ConstView{coupled_.data(), size, size, size}, pivots_.data(), z_.data());
  for (int i = 0; i < s_; ++i) {
    const ConstView T = tangents(i);
    double* const column = r.column(i);
    for (int b = 0; b < d_; ++b) {
      const double dz = z_[index(i * d_ + b)];
      for (int row = 0; row < q_; ++row) column[row] += T(row, b) * dz;
    }
    for (int a = 0; a < d_; ++a) column[slope_slots_[index(a)]] = z_[index(i * d_ + a)];
  }
}

}  // namespace sfdae::core
