// BDF steps of sensitivities of regular problems of strangeness index 0, where matrices are sparse.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/sparse_sensitivity_step.h"

#include <algorithm>
#include <numeric>

#include "linalg/index.h"

namespace sfdae::core {

bool SparseSensitivityStep::prepare(const IndexAnalysis& analysis) {
  const CharacteristicValues& values = analysis.values;
  const int n = problem_.n();
  is_possible_ = values.mu == 0 && problem_.m() == n && values.d + values.a == n && analysis.v_hat == 0;
  if (!is_possible_) return false;
  const SparsePattern pattern = find_pattern();
  limits_.assign(index(n), 0);
  jet_.assign(2 * index(n), 0.0);
  derivatives_.assign(places_.size(), 0.0);
  values_.assign(pattern.row.size(), 0.0);
  lu_.analyze(pattern);
  is_possible_ = lu_.method() != SparseMethod::dense;
  return is_possible_;
}

SparsePattern SparseSensitivityStep::find_pattern() {
  const Tape& tape = problem_.evaluator().tape();
  places_.clear();
  for (int i = 0; i < problem_.m(); ++i)
    for (std::size_t e = tape.first_target[index(i)]; e < tape.first_target[index(i) + 1]; ++e)
      places_.push_back({i, tape.targets[e].unknown, tape.targets[e].derivative, -1});
  std::vector<int> order(places_.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int e) { return std::pair(places_[index(e)].column, places_[index(e)].row); };
  std::sort(order.begin(), order.end(), [&](int left, int right) { return key(left) < key(right); });
  SparsePattern pattern;
  pattern.size = problem_.n();
  pattern.first.assign(index(pattern.size) + 1, 0);
  for (std::size_t k = 0; k < order.size(); ++k) {
    Place& place = places_[index(order[k])];
    if (k == 0 || key(order[k]) != key(order[k - 1])) {
      pattern.row.push_back(place.row);
      ++pattern.first[index(place.column) + 1];
    }
    place.position = static_cast<int>(pattern.row.size()) - 1;
  }
  std::partial_sum(pattern.first.begin(), pattern.first.end(), pattern.first.begin());
  return pattern;
}

PointStatus SparseSensitivityStep::solve(const Step& step, double* S) {
  const int n = problem_.n(), count = parameters_.count();
  std::copy_n(step.x, n, jet_.begin());
  std::copy_n(step.xdot, n, jet_.begin() + n);
  callback_error_ = problem_.gradient_entries(step.t, jet_.data(), 0, limits_, derivatives_.data());
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  callback_error_ = parameters_.values(step.t, jet_.data(), 0, View{S, n, count, n});
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  for (std::size_t i = 0; i < index(n) * index(count); ++i) S[i] = -S[i];
  std::fill(values_.begin(), values_.end(), 0.0);
  for (std::size_t e = 0; e < places_.size(); ++e) {
    const Place& place = places_[e];
    const double derivative = derivatives_[e];
    values_[index(place.position)] += place.of_slope ? step.c * derivative : derivative;
    if (!place.of_slope) continue;
    for (std::ptrdiff_t j = 0; j < count; ++j) S[place.row + j * n] -= derivative * step.rest[place.column + j * n];
  }
  if (!lu_.factor(values_.data())) return PointStatus::singular;
  lu_.solve(S, count);
  return PointStatus::ok;
}

}  // namespace sfdae::core
