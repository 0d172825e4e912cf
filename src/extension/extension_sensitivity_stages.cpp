// The stages of an implicit Runge-Kutta step for sensitivities along the minimal extension.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/extension_sensitivity_stages.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Changes of S, relative to its largest entries in units of x, that are let be; and where they stop becoming smaller, those that may
// be rounding errors.
constexpr double negligible = 1e-12, rounding = 1e-10;
// One system for all stages takes less time than more iterations, or slower ones.
constexpr int most_iterations = 12;
constexpr double slowest = 0.2;

}  // namespace

void ExtensionSensitivityStages::set_choice(const StateChoice& choice, const SensitivitySlots& slots) {
  choice_ = &choice;
  slots_ = &slots;
  s_ = 0;
}

bool ExtensionSensitivityStages::solve(const Task& task, ExtensionLinearization* by, double* S) {
  const std::size_t size = index(num_rows()) * index(count()) * index(task.method.s) + 1;
  for (auto* v : {&unknowns_, &r_, &transformed_})
    if (v->size() < size) v->resize(size);
  if ((by == nullptr || !iterate(task, *by)) && !solve_together(task)) return false;
  for (int i = 0; i < task.method.s; ++i)
    for (int q = 0; q < count(); ++q) {
      const double* const from = block(unknowns_, i, q);
      for (int j = 0; j < equations_.extension().n(); ++j) *S++ = from[slots_->of_x(j)];
    }
  return all_finite(unknowns_.data(), size - 1);
}

// ---- Iterations ------------------------------------------------------------------------------------------------

bool ExtensionSensitivityStages::iterate(const Task& task, ExtensionLinearization& by) {
  const int n = equations_.extension().n();
  std::fill(unknowns_.begin(), unknowns_.end(), 0.0);
  for (int i = 0; i < task.method.s; ++i)
    for (int q = 0; q < count(); ++q)
      for (int j = 0; j < n; ++j) block(unknowns_, i, q)[slots_->of_x(j)] = task.S_start[std::ptrdiff_t(q) * n + j];
  double before = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    set_residuals(task);
    take_away(task, by);
    const double change = add_changes(task);
    if (!(change <= std::numeric_limits<double>::max())) return false;
    // The first change takes S from where it was at the start of the step.
    const double rate = iteration > 1 ? change / before : iteration == 1 ? std::min(change, slowest) : 1.0;
    if (change * std::min(rate, 1.0) <= negligible) return true;
    if (iteration > 1 && rate > slowest) return change <= rounding;
    before = change;
  }
  return false;
}

// r_: right-hand sides less what the unknowns make of the rows.
void ExtensionSensitivityStages::set_residuals(const Task& task) {
  const int n = equations_.extension().n(), s = task.method.s;
  slopes_.resize(index(n) * index(count()) + 1);
  for (int i = 0; i < s; ++i) {
    for (int q = 0; q < count(); ++q) {
      double* const slopes = slopes_.data() + index(q) * index(n);
      const double* const start = task.S_start + std::ptrdiff_t(q) * n;
      for (int j : choice_->states()) slopes[j] = 0.0;
      for (int k = 0; k < s; ++k) {
        const double D = task.method.D_at(i, k) / task.h;
        const double* const at = block(unknowns_, k, q);
        for (int j : choice_->states()) slopes[j] += D * (at[slots_->of_x(j)] - start[j]);
      }
    }
    subtract_rows(task, i);
  }
}

void ExtensionSensitivityStages::subtract_rows(const Task& task, int i) {
  const MinimalExtension& extension = equations_.extension();
  const std::vector<int>& first = extension.first();
  const std::vector<int>& column = extension.column();
  const SensitivityRows& rows = task.rows[index(i)];
  for (int q = 0; q < count(); ++q) {
    const double* const at = block(unknowns_, i, q);
    const double* const slopes = slopes_.data() + index(q) * index(extension.n());
    double* const r = block(r_, i, q);
    for (int row = 0; row < num_rows(); ++row) {
      double sum = rows.right[index(q) * index(num_rows()) + index(row)];
      for (int e = first[index(row)]; e < first[index(row + 1)]; ++e) {
        const int of = column[index(e)];
        const double value =
            choice_->is_slope(of) ? slopes[extension.columns()[index(of)].unknown] : at[choice_->slot(of)];
        sum -= rows.values[index(e)] * value;
      }
      r[row] = sum;
    }
  }
}

// As the stages of x: multiplied by T^-1 they are one real system and (s - 1) / 2 complex ones. r_ becomes the changes.
void ExtensionSensitivityStages::take_away(const Task& task, ExtensionLinearization& by) {
  const StageMethod& method = task.method;
  const int s = method.s, size = num_rows() * count();
  const View r{r_.data(), size, s, size}, transformed{transformed_.data(), size, s, size};
  multiply(1.0, Op::plain, r, Op::transposed, ConstView{method.T_inverse.data(), s, s, s}, 0.0, transformed);
  by.solve_step(transformed.column(0), count());
  pair_.resize(index(size) + 1);
  for (int k = 0; 2 * k + 2 < s; ++k) {
    double *const first = transformed.column(2 * k + 1), *const second = transformed.column(2 * k + 2);
    for (int i = 0; i < size; ++i) pair_[index(i)] = {first[i], -second[i]};
    by.solve_pair(index(k), pair_.data(), count());
    for (int i = 0; i < size; ++i) {
      first[i] = pair_[index(i)].real();
      second[i] = -pair_[index(i)].imag();
    }
  }
  multiply(1.0, Op::plain, transformed, Op::transposed, ConstView{method.T.data(), s, s, s}, 0.0, r);
}

// The largest change of S relative to the largest entry of its column, both in units of x.
double ExtensionSensitivityStages::add_changes(const Task& task) {
  const int n = equations_.extension().n();
  double largest = 0.0;
  for (int q = 0; q < count(); ++q) {
    double size = 0.0, change = 0.0;
    bool is_finite = true;
    for (int i = 0; i < task.method.s; ++i) {
      double *const to = block(unknowns_, i, q), *const by = block(r_, i, q);
      for (int row = 0; row < num_rows(); ++row) {
        to[row] += by[row];
        is_finite = is_finite && std::isfinite(to[row]);
      }
      for (int j = 0; j < n; ++j) {
        const double scale = task.scales[index(j)] > 0.0 ? task.scales[index(j)] : 1.0;
        size = std::max(size, std::fabs(to[slots_->of_x(j)]) / scale);
        change = std::max(change, std::fabs(by[slots_->of_x(j)]) / scale);
      }
    }
    if (!is_finite) return std::numeric_limits<double>::infinity();
    if (change > 0.0) largest = std::max(largest, size > 0.0 ? change / size : 1.0);
  }
  return largest;
}

// ---- Together --------------------------------------------------------------------------------------------------

// Entries of S_j' of a state are in the columns of S_j of all stages.
void ExtensionSensitivityStages::make_pattern(int s) {
  if (s == s_) return;
  s_ = 0;  // while memory may be missing
  const MinimalExtension& extension = equations_.extension();
  const int q = num_rows();
  std::vector<std::pair<int, int>> places;  // column, row
  const auto for_each = [&](auto action) {
    for (int row = 0; row < q; ++row)
      for (int e = extension.first()[index(row)]; e < extension.first()[index(row + 1)]; ++e)
        action(row, extension.column()[index(e)]);
  };
  for_each([&](int row, int column) {
    for (int i = 0; i < s; ++i)
      for (int k = choice_->is_slope(column) ? 0 : i; k < (choice_->is_slope(column) ? s : i + 1); ++k)
        places.emplace_back(k * q + choice_->slot(column), i * q + row);
  });
  std::vector<std::pair<int, int>> sorted = places;
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  positions_.clear();
  for (const auto& place : places)
    positions_.push_back(
        static_cast<std::size_t>(std::lower_bound(sorted.begin(), sorted.end(), place) - sorted.begin()));
  SparsePattern pattern;
  pattern.size = s * q;
  pattern.first.assign(index(pattern.size) + 1, 0);
  for (const auto& [column, row] : sorted) {
    pattern.row.push_back(row);
    ++pattern.first[index(column) + 1];
  }
  std::partial_sum(pattern.first.begin(), pattern.first.end(), pattern.first.begin());
  together_.analyze(pattern);
  values_.assign(sorted.size(), 0.0);
  right_.assign(index(pattern.size) * index(count()) + 1, 0.0);
  solution_ = right_;
  s_ = s;
}

void ExtensionSensitivityStages::set_values(const Task& task) {
  std::fill(values_.begin(), values_.end(), 0.0);
  const std::vector<int>& column = equations_.extension().column();
  const std::size_t* position = positions_.data();
  for (std::size_t e = 0; e < column.size(); ++e)
    for (int i = 0; i < s_; ++i) {
      const double value = task.rows[index(i)].values[e];
      if (!choice_->is_slope(column[e])) {
        values_[*position++] += value;
        continue;
      }
      for (int k = 0; k < s_; ++k) values_[*position++] += task.method.D_at(i, k) / task.h * value;
    }
}

void ExtensionSensitivityStages::set_right_hand_sides(const Task& task) {
  const std::size_t q = index(num_rows()), n = index(equations_.extension().n());
  for (int i = 0; i < s_; ++i) {
    const SensitivityRows& rows = task.rows[index(i)];
    double sum = 0.0;
    for (int k = 0; k < s_; ++k) sum += task.method.D_at(i, k) / task.h;
    for (std::size_t j = 0; j < index(count()); ++j) {
      double* const to = right_.data() + (j * index(s_) + index(i)) * q;
      std::copy_n(rows.right.data() + j * q, q, to);
      for (const SensitivitySlots::Entry& entry : slots_->slopes())
        to[entry.row] += sum * rows.values[entry.entry] * task.S_start[j * n + index(entry.state)];
    }
  }
}

bool ExtensionSensitivityStages::solve_together(const Task& task) {
  make_pattern(task.method.s);
  set_values(task);
  set_right_hand_sides(task);
  ++factorizations_;
  if (!together_.solve(values_, right_.data(), count(), solution_.data())) return false;
  for (int i = 0; i < s_; ++i)
    for (int q = 0; q < count(); ++q)
      std::copy_n(solution_.data() + index(q * s_ + i) * index(num_rows()), num_rows(), block(unknowns_, i, q));
  return true;
}

void ExtensionSensitivityStages::archive(Archive& archive) {
  int s = s_;
  archive.small(s);
  if (archive.is_reading()) {
    if (s < 0 || s > max_stages || (s > 0 && s % 2 == 0)) throw DamagedArchive();
    s_ = 0;
    if (s > 0) make_pattern(s);
  }
  if (s_ > 0) together_.archive(archive);
}

}  // namespace sfdae::core
