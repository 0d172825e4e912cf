// Radau steps of sensitivities of regular problems of strangeness index 0 with sparse matrices.
// SPDX-License-Identifier: BSD-3-Clause
#include "sensitivity/sparse_sensitivity_stages.h"

#include <algorithm>
#include <utility>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Limits on entries of the matrix of all stages, as a number and as a part of a full one. By judgement: for a full
// matrix with a third of its entries set, elimination has little advantage from zeros.
constexpr double most_entries = 100000.0, most_of_all = 0.3;

}  // namespace

void SparseSensitivityStages::prepare(const IndexAnalysis& analysis) {
  const CharacteristicValues& values = analysis.values;
  const int n = problem_.n();
  // Rows of the left kernel of F_x' are constraints as they stand if F_x' does not depend on x', which is discretized.
  fits_ = values.mu == 0 && problem_.m() == n && values.d + values.a == n && analysis.v_hat == 0 &&
          (values.d == n || !parameters_.needs_slopes());
  s_ = 0;
  if (!fits_) return;
  entries_ = recorded_entries(problem_);
  limits_.assign(index(n), 0);
  jet_.assign(2 * index(n), 0.0);
}

void SparseSensitivityStages::archive(Archive& archive, const IndexAnalysis& analysis) {
  int s = s_;
  archive.small(s);
  if (archive.is_reading()) {
    prepare(analysis);
    if (s < 0 || s > max_stages || (s > 0 && !fits_)) throw DamagedArchive();
    resize(s);
  }
  if (s_ > 0) planned_.archive(archive);
}

bool SparseSensitivityStages::is_possible(const StageMethod& method) const {
  if (!fits_) return false;
  if (method.s == s_) return planned_.is_suitable();
  const double s = method.s, order = s * problem_.n();
  double entries = 0.0;
  for (const RecordedEntry& entry : entries_) entries += entry.of_slope ? s * s : s;
  return entries <= most_entries && entries <= most_of_all * order * order;
}

void SparseSensitivityStages::resize(int s) {
  if (s == s_) return;
  s_ = 0;  // while memory may be missing
  const int n = problem_.n();
  std::vector<std::pair<int, int>> places;  // column, row
  const auto stages_of = [s](const RecordedEntry& entry, int i) {
    return entry.of_slope ? std::pair(0, s) : std::pair(i, i + 1);
  };
  for (const RecordedEntry& entry : entries_)
    for (int i = 0; i < s; ++i)
      for (auto [j, end] = stages_of(entry, i); j < end; ++j)
        places.emplace_back(j * n + entry.column, i * n + entry.row);
  pattern_ = pattern_of(s * n, places, positions_);
  planned_.analyze(pattern_);
  const std::size_t all = index(pattern_.size) * index(parameters_.count());
  values_.assign(pattern_.row.size(), 0.0);
  derivatives_.assign(entries_.size() * index(s), 0.0);
  for (std::vector<double>* v : {&F_p_, &right_, &solution_}) v->assign(all, 0.0);
  s_ = s;
}

PointStatus SparseSensitivityStages::keep(const StageMethod& method, int i, double t, const double* x,
                                          const double* xdot) {
  resize(method.s);
  const int n = problem_.n(), count = parameters_.count();
  std::copy_n(x, n, jet_.begin());
  std::copy_n(xdot, n, jet_.begin() + n);
  callback_error_ =
      problem_.gradient_entries(t, jet_.data(), 0, limits_, derivatives_.data() + index(i) * entries_.size());
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  double* const F_p = F_p_.data() + index(i) * index(n) * index(count);
  callback_error_ = parameters_.values(t, jet_.data(), 0, View{F_p, n, count, n});
  return callback_error_.status == SFDAE_OK ? PointStatus::ok : PointStatus::callback_error;
}

void SparseSensitivityStages::set_values(const StageMethod& method, double h) {
  std::fill(values_.begin(), values_.end(), 0.0);
  const std::size_t* position = positions_.data();
  for (std::size_t e = 0; e < entries_.size(); ++e)
    for (int i = 0; i < s_; ++i) {
      const double derivative = derivatives_[index(i) * entries_.size() + e];
      if (!entries_[e].of_slope) {
        values_[*position++] += derivative;
        continue;
      }
      for (int j = 0; j < s_; ++j) values_[*position++] += method.D_at(i, j) / h * derivative;
    }
}

void SparseSensitivityStages::set_right_hand_sides(const StageMethod& method, double h, const double* S_start) {
  const std::size_t n = index(problem_.n()), order = n * index(s_), count = index(parameters_.count());
  for (std::size_t i = 0; i < index(s_); ++i) {
    double sum = 0.0;
    for (int j = 0; j < s_; ++j) sum += method.D_at(static_cast<int>(i), j) / h;
    for (std::size_t q = 0; q < count; ++q) {
      double* const to = right_.data() + q * order + i * n;
      const double* const F_p = F_p_.data() + (i * count + q) * n;
      for (std::size_t k = 0; k < n; ++k) to[k] = -F_p[k];
      for (std::size_t e = 0; e < entries_.size(); ++e)
        if (entries_[e].of_slope)
          to[entries_[e].row] +=
              sum * derivatives_[i * entries_.size() + e] * S_start[q * n + index(entries_[e].column)];
    }
  }
}

bool SparseSensitivityStages::solve_system() {
  if (planned_.solve(values_.data(), right_.data(), parameters_.count(), solution_.data())) return true;
  // Used once: the next step has another method.
  SparseLu<double> lu;
  lu.analyze(pattern_);
  if (!lu.factor(values_.data())) return false;
  solution_ = right_;
  lu.solve(solution_.data(), parameters_.count());
  return true;
}

PointStatus SparseSensitivityStages::solve(const StageMethod& method, double h, const double* S_start, double* S) {
  set_values(method, h);
  set_right_hand_sides(method, h, S_start);
  if (!solve_system()) return PointStatus::singular;
  const std::size_t n = index(problem_.n()), order = n * index(s_), count = index(parameters_.count());
  for (std::size_t i = 0; i < index(s_); ++i)
    for (std::size_t q = 0; q < count; ++q)
      std::copy_n(solution_.data() + q * order + i * n, n, S + (i * count + q) * n);
  return PointStatus::ok;
}

}  // namespace sfdae::core
