// BDF steps of sensitivities of regular problems of strangeness index 0 with sparse matrices.
// SPDX-License-Identifier: BSD-3-Clause
#include "sensitivity/sparse_sensitivity_step.h"

#include <algorithm>
#include <numeric>

#include "linalg/index.h"

namespace sfdae::core {

std::vector<RecordedEntry> recorded_entries(RecordedProblem& problem) {
  const Tape& tape = problem.evaluator().tape();
  std::vector<RecordedEntry> entries;
  for (int i = 0; i < problem.m(); ++i)
    for (std::size_t e = tape.first_target[index(i)]; e < tape.first_target[index(i) + 1]; ++e)
      entries.push_back({i, tape.targets[e].unknown, tape.targets[e].derivative});
  return entries;
}

bool SparseSensitivityStep::prepare(const IndexAnalysis& analysis) {
  const CharacteristicValues& values = analysis.values;
  const int n = problem_.n();
  is_possible_ = values.mu == 0 && problem_.m() == n && values.d + values.a == n && analysis.v_hat == 0;
  if (!is_possible_) return false;
  const SparsePattern pattern = find_pattern();
  varying_.version = -1;
  jet_.assign(2 * index(n), 0.0);
  derivatives_.assign(entries_.size(), 0.0);
  values_.assign(pattern.row.size(), 0.0);
  right_.assign(index(n) * index(parameters_.count()), 0.0);
  lu_.analyze(pattern);
  pivots_.forget();
  planned_.analyze(pattern);
  is_possible_ = lu_.method() != SparseMethod::dense;
  return is_possible_;
}

// If there are no sparse factors, the derivative array solves the same equations, except constraints that depend on x',
// which is discretized here.
bool SparseSensitivityStep::prepare(const IndexAnalysis& analysis, const Jet& jet) {
  if (prepare(analysis) || values_.empty()) return is_possible_;
  if (analysis.values.mu > 0 || (analysis.values.d < jet.n && parameters_.needs_slopes())) return false;
  const double c = analysis.time_scale > 0.0 ? 1.0 / analysis.time_scale : 1.0;
  if (evaluate({jet.t, jet.x.data(), jet.column(1), c, nullptr}) != PointStatus::ok) return false;
  set_values(c);
  is_possible_ = planned_.plan(values_.data());
  return is_possible_;
}

void SparseSensitivityStep::archive(Archive& archive, const IndexAnalysis& analysis) {
  bool is_possible = is_possible_;
  archive.small(is_possible);
  if (archive.is_reading()) {
    prepare(analysis);
    if (is_possible && values_.empty()) throw DamagedArchive();
    is_possible_ = is_possible;
  }
  if (!is_possible_) return;
  planned_.archive(archive);
  pivots_.archive(archive, lu_, values_.size());
}

SparsePattern SparseSensitivityStep::find_pattern() {
  entries_ = recorded_entries(problem_);
  positions_.assign(entries_.size(), 0);
  std::vector<int> order(entries_.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int e) { return std::pair(entries_[index(e)].column, entries_[index(e)].row); };
  std::sort(order.begin(), order.end(), [&](int left, int right) { return key(left) < key(right); });
  SparsePattern pattern;
  pattern.size = problem_.n();
  pattern.first.assign(index(pattern.size) + 1, 0);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const RecordedEntry& entry = entries_[index(order[k])];
    if (k == 0 || key(order[k]) != key(order[k - 1])) {
      pattern.row.push_back(entry.row);
      ++pattern.first[index(entry.column) + 1];
    }
    positions_[index(order[k])] = static_cast<int>(pattern.row.size()) - 1;
  }
  std::partial_sum(pattern.first.begin(), pattern.first.end(), pattern.first.begin());
  return pattern;
}

PointStatus SparseSensitivityStep::evaluate(const Step& step) {
  const int n = problem_.n();
  std::copy_n(step.x, n, jet_.begin());
  std::copy_n(step.xdot, n, jet_.begin() + n);
  callback_error_ = problem_.gradient_entries(step.t, jet_.data(), varying_, derivatives_.data());
  return callback_error_.status == SFDAE_OK ? PointStatus::ok : PointStatus::callback_error;
}

void SparseSensitivityStep::set_values(double c) {
  std::fill(values_.begin(), values_.end(), 0.0);
  for (std::size_t e = 0; e < entries_.size(); ++e)
    values_[index(positions_[e])] += entries_[e].of_slope ? c * derivatives_[e] : derivatives_[e];
}

PointStatus SparseSensitivityStep::factor_and_solve(double* S) {
  if (planned_.is_suitable() && planned_.solve(values_.data(), right_.data(), parameters_.count(), S))
    return PointStatus::ok;
  if (!pivots_.factor(lu_, values_)) return PointStatus::singular;
  std::copy(right_.begin(), right_.end(), S);
  lu_.solve(S, parameters_.count());
  return PointStatus::ok;
}

PointStatus SparseSensitivityStep::solve(const Step& step, double* S) {
  const int n = problem_.n(), count = parameters_.count();
  PointStatus status = evaluate(step);
  if (status != PointStatus::ok) return status;
  callback_error_ = parameters_.values(step.t, jet_.data(), 0, View{right_.data(), n, count, n});
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  for (double& value : right_) value = -value;
  for (std::size_t e = 0; e < entries_.size(); ++e) {
    const RecordedEntry& entry = entries_[e];
    if (!entry.of_slope) continue;
    for (std::ptrdiff_t j = 0; j < count; ++j)
      right_[index(entry.row) + index(n) * index(static_cast<int>(j))] -=
          derivatives_[e] * step.rest[entry.column + j * n];
  }
  set_values(step.c);
  return factor_and_solve(S);
}

PointStatus SparseSensitivityStep::solve_back(const Step& step, View weights, View gradient) {
  PointStatus status = evaluate(step);
  if (status != PointStatus::ok) return status;
  set_values(step.c);
  if (!pivots_.factor(lu_, values_)) return PointStatus::singular;
  nu_.resize(index(weights.rows) * index(weights.cols));
  const View nu{nu_.data(), weights.rows, weights.cols, weights.rows};
  copy(weights, nu);
  lu_.solve_transposed(nu_.data(), weights.cols);
  callback_error_ = parameters_.add_gradient(step.t, jet_.data(), nu, gradient);
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  fill(weights, 0.0);
  for (std::size_t e = 0; e < entries_.size(); ++e) {
    const RecordedEntry& entry = entries_[e];
    if (!entry.of_slope) continue;
    for (int q = 0; q < weights.cols; ++q) weights(entry.column, q) -= derivatives_[e] * nu(entry.row, q);
  }
  return PointStatus::ok;
}

}  // namespace sfdae::core
