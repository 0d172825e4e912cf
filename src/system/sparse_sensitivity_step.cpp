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

PointStatus SparseSensitivityStep::evaluate(const Step& step) {
  const int n = problem_.n();
  std::copy_n(step.x, n, jet_.begin());
  std::copy_n(step.xdot, n, jet_.begin() + n);
  callback_error_ = problem_.gradient_entries(step.t, jet_.data(), 0, limits_, derivatives_.data());
  return callback_error_.status == SFDAE_OK ? PointStatus::ok : PointStatus::callback_error;
}

PointStatus SparseSensitivityStep::factor(double c) {
  std::fill(values_.begin(), values_.end(), 0.0);
  for (std::size_t e = 0; e < places_.size(); ++e)
    values_[index(places_[e].position)] += places_[e].of_slope ? c * derivatives_[e] : derivatives_[e];
  return lu_.factor(values_.data()) ? PointStatus::ok : PointStatus::singular;
}

PointStatus SparseSensitivityStep::solve(const Step& step, double* S) {
  const int n = problem_.n(), count = parameters_.count();
  PointStatus status = evaluate(step);
  if (status != PointStatus::ok) return status;
  callback_error_ = parameters_.values(step.t, jet_.data(), 0, View{S, n, count, n});
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  for (std::size_t i = 0; i < index(n) * index(count); ++i) S[i] = -S[i];
  for (std::size_t e = 0; e < places_.size(); ++e) {
    const Place& place = places_[e];
    if (!place.of_slope) continue;
    for (std::ptrdiff_t j = 0; j < count; ++j)
      S[place.row + j * n] -= derivatives_[e] * step.rest[place.column + j * n];
  }
  status = factor(step.c);
  if (status == PointStatus::ok) lu_.solve(S, count);
  return status;
}

PointStatus SparseSensitivityStep::solve_back(const Step& step, View weights, View gradient) {
  PointStatus status = evaluate(step);
  if (status == PointStatus::ok) status = factor(step.c);
  if (status != PointStatus::ok) return status;
  nu_.resize(index(weights.rows) * index(weights.cols));
  const View nu{nu_.data(), weights.rows, weights.cols, weights.rows};
  copy(weights, nu);
  lu_.solve_transposed(nu_.data(), weights.cols);
  callback_error_ = parameters_.add_gradient(step.t, jet_.data(), nu, gradient);
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  fill(weights, 0.0);
  for (std::size_t e = 0; e < places_.size(); ++e) {
    const Place& place = places_[e];
    if (!place.of_slope) continue;
    for (int q = 0; q < weights.cols; ++q) weights(place.column, q) -= derivatives_[e] * nu(place.row, q);
  }
  return PointStatus::ok;
}

}  // namespace sfdae::core
