// The stages of a step for sensitivities as one sparse system.
// SPDX-License-Identifier: BSD-3-Clause
#include "sensitivity/sensitivity_stages_together.h"

#include <algorithm>
#include <utility>

#include "linalg/index.h"

namespace sfdae::core {

// Entries of S_j' of a state are in the columns of S_j of all stages.
void SensitivityStagesTogether::make_pattern(int s, const StateChoice& choice) {
  if (s == s_) return;
  s_ = 0;  // while memory may be missing
  const MinimalExtension& extension = equations_.extension();
  const int q = num_rows();
  std::vector<std::pair<int, int>> places;  // column, row
  const auto add_places = [&](int row, int column) {
    const bool is_slope = choice.is_slope(column);
    for (int i = 0; i < s; ++i)
      for (int k = is_slope ? 0 : i; k < (is_slope ? s : i + 1); ++k)
        places.emplace_back(k * q + choice.slot(column), i * q + row);
  };
  for (int row = 0; row < q; ++row)
    for (int e = extension.first()[index(row)]; e < extension.first()[index(row + 1)]; ++e)
      add_places(row, extension.column()[index(e)]);
  const SparsePattern pattern = pattern_of(s * q, places, positions_);
  system_.analyze(pattern);
  values_.assign(pattern.row.size(), 0.0);
  right_.assign(index(pattern.size) * index(count()) + 1, 0.0);
  solution_ = right_;
  s_ = s;
}

void SensitivityStagesTogether::set_values(const SensitivityStagesTask& task, const StateChoice& choice) {
  std::fill(values_.begin(), values_.end(), 0.0);
  const std::vector<int>& column = equations_.extension().column();
  const std::size_t* position = positions_.data();
  for (std::size_t e = 0; e < column.size(); ++e)
    for (int i = 0; i < s_; ++i) {
      const double value = task.rows[index(i)].values[e];
      if (!choice.is_slope(column[e])) {
        values_[*position++] += value;
        continue;
      }
      for (int k = 0; k < s_; ++k) values_[*position++] += task.method.D_at(i, k) / task.h * value;
    }
}

void SensitivityStagesTogether::set_right_hand_sides(const SensitivityStagesTask& task,
                                                     const SensitivitySlots& slots) {
  const std::size_t q = index(num_rows()), n = index(equations_.extension().n());
  for (int i = 0; i < s_; ++i) {
    const SensitivityRows& rows = task.rows[index(i)];
    double sum = 0.0;
    for (int k = 0; k < s_; ++k) sum += task.method.D_at(i, k) / task.h;
    for (std::size_t j = 0; j < index(count()); ++j) {
      double* const to = right_.data() + (j * index(s_) + index(i)) * q;
      std::copy_n(rows.right.data() + j * q, q, to);
      for (const SensitivitySlots::Entry& entry : slots.slopes())
        to[entry.row] += sum * rows.values[entry.entry] * task.S_start[j * n + index(entry.state)];
    }
  }
}

bool SensitivityStagesTogether::solve(const SensitivityStagesTask& task, const StateChoice& choice,
                                      const SensitivitySlots& slots, std::vector<double>& unknowns) {
  make_pattern(task.method.s, choice);
  set_values(task, choice);
  set_right_hand_sides(task, slots);
  if (!system_.solve(values_, right_.data(), count(), solution_.data())) return false;
  const std::size_t rows = index(num_rows());
  double* to = unknowns.data();
  for (int i = 0; i < s_; ++i)
    for (int q = 0; q < count(); ++q, to += rows) std::copy_n(solution_.data() + index(q * s_ + i) * rows, rows, to);
  return true;
}

void SensitivityStagesTogether::archive(Archive& archive, const StateChoice& choice) {
  int s = s_;
  archive.small(s);
  if (archive.is_reading()) {
    if (s < 0 || s > max_stages || (s > 0 && s % 2 == 0)) throw DamagedArchive();
    s_ = 0;
    if (s > 0) make_pattern(s, choice);
  }
  if (s_ > 0) system_.archive(archive);
}

}  // namespace sfdae::core
