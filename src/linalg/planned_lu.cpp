// Sparse systems of linear equations with matrices that change little.
//
// [Z80] Z. Zlatev: On some pivotal strategies in Gaussian elimination by sparse technique. SIAM J. Numer. Anal. 17 (1980), 18-30.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/planned_lu.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

// Pivots are not smaller than this part of the largest entry of their columns, among the columns with fewest entries.
constexpr double threshold = 0.1;
constexpr std::size_t columns_searched = 4;
// Residuals, relative to the terms that they are sums of: what is refined, which is nearly all, and what is refused after that. With
// residuals up to 1e-14 left as they were the error test of sensitivities ran into their noise, and steps became ever shorter.
constexpr double rounding = 1e-16, refused = 1e-12;
// Pivots may be chosen for every eighth solution; more often they do not save anything.
constexpr long least_plans = 8, solutions_of_a_plan = 8;

// Nanoseconds, as in sparse_lu.cpp: of the list, and of a full matrix by LAPACK.
double time_of_list(double operations) { return 1.2 * operations; }
// Longer lists are read from memory, and pivots are not worth the search.
constexpr std::size_t most_operations = 500000;
double time_of_full_matrix(double n) { return n * (50.0 + 0.3 * n) + 0.022 * n * n * n; }

constexpr double golden_section = 0.6180339887;

double power_of_two(int exponent) { return times_power_of_two(1.0, exponent); }

}  // namespace

// The elimination of one matrix, pivots by Markowitz's count among those that are large enough [Z80].
class PlannedLu::Planning {
 public:
  struct Entry {
    int column, position;
    double value;
  };
  struct Step {
    int row, column;
    std::vector<int> u_columns, u_positions, l_rows, l_positions;
  };

  Planning(const SparsePattern& pattern, const double* scaled)
      : rows_(index(pattern.size)), columns_(index(pattern.size)), place_(index(pattern.size), -1) {
    for (int j = 0; j < pattern.size; ++j) {
      remaining_.push_back(j);
      for (int e = pattern.first[index(j)]; e < pattern.first[index(j) + 1]; ++e) {
        const int i = pattern.row[index(e)];
        rows_[index(i)].push_back({j, e, scaled[e]});
        columns_[index(j)].push_back(i);
      }
    }
    positions_ = static_cast<int>(pattern.row.size());
  }

  // False if no pivot is left, or there are more operations.
  bool run(std::size_t most) {
    while (!remaining_.empty()) {
      if (!find_pivot()) return false;
      eliminate();
      if (targets_.size() > most) return false;
    }
    return true;
  }

  const std::vector<Step>& steps() const { return steps_; }
  const std::vector<int>& targets() const { return targets_; }
  int positions() const { return positions_; }
  int pivot_position(std::size_t k) const { return pivot_positions_[k]; }

 private:
  const Entry& entry(int row, int column) const {
    const std::vector<Entry>& entries = rows_[index(row)];
    return *std::find_if(entries.begin(), entries.end(), [column](const Entry& e) { return e.column == column; });
  }

  bool find_pivot() {
    const std::size_t searched = std::min(columns_searched, remaining_.size());
    std::partial_sort(remaining_.begin(), remaining_.begin() + static_cast<std::ptrdiff_t>(searched),
                      remaining_.end(), [this](int one, int other) {
                        const std::size_t a = columns_[index(one)].size(), b = columns_[index(other)].size();
                        return a != b ? a < b : one < other;
                      });
    double least = std::numeric_limits<double>::infinity(), size = 0.0;
    for (std::size_t k = 0; k < searched; ++k) {
      const std::vector<int>& rows = columns_[index(remaining_[k])];
      double largest = 0.0;
      for (int i : rows) largest = std::max(largest, std::fabs(entry(i, remaining_[k]).value));
      if (largest == 0.0) return false;
      for (int i : rows) {
        const double value = std::fabs(entry(i, remaining_[k]).value);
        if (value < threshold * largest) continue;
        const double cost = static_cast<double>(rows.size() - 1) * static_cast<double>(rows_[index(i)].size() - 1);
        if (cost > least || (cost == least && value <= size)) continue;
        least = cost;
        size = value;
        row_ = i;
        column_ = remaining_[k];
      }
    }
    return true;
  }

  void eliminate() {
    Step step{row_, column_, {}, {}, {}, {}};
    std::vector<Entry> pivot_row = std::move(rows_[index(row_)]);
    rows_[index(row_)].clear();
    const auto pivot =
        std::find_if(pivot_row.begin(), pivot_row.end(), [this](const Entry& e) { return e.column == column_; });
    const double pivot_value = pivot->value;
    pivot_positions_.push_back(pivot->position);
    pivot_row.erase(pivot);
    for (const Entry& e : pivot_row) {
      step.u_columns.push_back(e.column);
      step.u_positions.push_back(e.position);
      std::erase(columns_[index(e.column)], row_);
    }
    for (int i : columns_[index(column_)]) {
      if (i == row_) continue;
      std::vector<Entry>& entries = rows_[index(i)];
      const auto own =
          std::find_if(entries.begin(), entries.end(), [this](const Entry& e) { return e.column == column_; });
      step.l_rows.push_back(i);
      step.l_positions.push_back(own->position);
      const double multiplier = own->value / pivot_value;
      entries.erase(own);
      for (std::size_t k = 0; k < entries.size(); ++k) place_[index(entries[k].column)] = static_cast<int>(k);
      for (const Entry& u : pivot_row) {
        int& place = place_[index(u.column)];
        if (place < 0) {
          place = static_cast<int>(entries.size());
          entries.push_back({u.column, positions_++, 0.0});
          columns_[index(u.column)].push_back(i);
        }
        Entry& target = entries[index(place)];
        target.value -= multiplier * u.value;
        targets_.push_back(target.position);
      }
      for (const Entry& e : entries) place_[index(e.column)] = -1;
    }
    columns_[index(column_)].clear();
    std::erase(remaining_, column_);
    steps_.push_back(std::move(step));
  }

  std::vector<std::vector<Entry>> rows_;   // of what is left
  std::vector<std::vector<int>> columns_;  // rows with entries there
  std::vector<int> remaining_, place_, pivot_positions_, targets_;
  std::vector<Step> steps_;
  int positions_ = 0, row_ = 0, column_ = 0;
};

void PlannedLu::analyze(const SparsePattern& pattern) {
  pattern_ = pattern;
  is_suitable_ = true;
  has_plan_ = false;
  plans_ = solutions_ = 0;
  scales_ = Equilibration();
  target_.clear();
}

bool PlannedLu::is_worthwhile(std::size_t operations) const {
  return operations <= most_operations &&
         time_of_list(static_cast<double>(operations)) <= time_of_full_matrix(pattern_.size);
}

bool PlannedLu::plan(const double* values) {
  const QuietArithmetic quiet;
  return choose_pivots(values);
}

bool PlannedLu::choose_pivots(const double* values) {
  has_plan_ = false;
  ++plans_;
  if (!is_suitable_ || !all_finite_numbers(values, pattern_.row.size())) return false;
  is_suitable_ = plans_ <= least_plans + solutions_ / solutions_of_a_plan;
  const CompressedLines columns{pattern_.size, pattern_.size, pattern_.first.data(), pattern_.row.data()};
  if (!is_suitable_ || !scales_.compute(columns, values)) return false;
  const std::size_t size = index(pattern_.size);
  row_factor_.resize(size);
  column_factor_.resize(size);
  entry_factor_.resize(pattern_.row.size());
  scaled_.resize(pattern_.row.size());
  constexpr int harmless = 400;  // products of two factors and their inverses are numbers
  for (std::size_t k = 0; k < size; ++k) {
    const int of_row = scales_.of_crossings()[k], of_column = scales_.of_lines()[k];
    if (std::abs(of_row) > harmless || std::abs(of_column) > harmless) return is_suitable_ = false;
    row_factor_[k] = power_of_two(of_row);
    column_factor_[k] = power_of_two(of_column);
  }
  for (std::size_t j = 0; j < size; ++j)
    for (std::size_t e = index(pattern_.first[j]); e < index(pattern_.first[j + 1]); ++e) {
      entry_factor_[e] = row_factor_[index(pattern_.row[e])] * column_factor_[j];
      scaled_[e] = entry_factor_[e] * values[e];
    }
  std::size_t most = 0;
  while (is_worthwhile(most + 1)) most = 2 * most + 1;
  Planning planning(pattern_, scaled_.data());
  if (!planning.run(most)) {
    is_suitable_ = planning.targets().size() <= most;
    return false;
  }
  if (!is_worthwhile(planning.targets().size())) return is_suitable_ = false;
  take(planning);
  planned_values_.assign(values, values + pattern_.row.size());
  return has_plan_ = true;
}

void PlannedLu::archive(Archive& archive) {
  bool is_suitable = is_suitable_, has_plan = has_plan_;
  long plans = plans_, solutions = solutions_;
  archive.small(is_suitable, has_plan);
  archive.counts(plans, solutions);
  if (has_plan) archive.reals(planned_values_, pattern_.row.size());
  if (!archive.is_reading()) return;
  if (has_plan) {
    const std::vector<double> values = planned_values_;
    if (!plan(values.data())) throw DamagedArchive();
  }
  is_suitable_ = is_suitable;
  plans_ = plans;
  solutions_ = solutions;
}

// Positions become those of values_: pivots, then the entries of rows and the multipliers in the order of the steps.
void PlannedLu::take(const Planning& planning) {
  const std::size_t size = index(pattern_.size);
  std::vector<int> moved(index(planning.positions()));
  step_of_row_.resize(size);
  step_of_column_.resize(size);
  first_u_.assign(1, 0);
  first_l_.assign(1, 0);
  int next = pattern_.size;
  for (std::size_t k = 0; k < size; ++k) {
    const Planning::Step& step = planning.steps()[k];
    step_of_row_[index(step.row)] = step_of_column_[index(step.column)] = static_cast<int>(k);
    moved[index(planning.pivot_position(k))] = static_cast<int>(k);
    for (int position : step.u_positions) moved[index(position)] = next++;
    first_u_.push_back(first_u_.back() + static_cast<int>(step.u_positions.size()));
  }
  for (std::size_t k = 0; k < size; ++k) {
    for (int position : planning.steps()[k].l_positions) moved[index(position)] = next++;
    first_l_.push_back(first_l_.back() + static_cast<int>(planning.steps()[k].l_positions.size()));
  }
  u_column_.clear();
  l_row_.clear();
  for (const Planning::Step& step : planning.steps()) {
    for (int column : step.u_columns) u_column_.push_back(step_of_column_[index(column)]);
    for (int row : step.l_rows) l_row_.push_back(step_of_row_[index(row)]);
  }
  target_.clear();
  for (int position : planning.targets()) target_.push_back(moved[index(position)]);
  for (std::vector<int>* v : {&position_, &row_step_, &column_step_}) v->resize(pattern_.row.size());
  for (std::size_t j = 0; j < size; ++j)
    for (std::size_t e = index(pattern_.first[j]); e < index(pattern_.first[j + 1]); ++e) {
      position_[e] = moved[e];
      row_step_[e] = step_of_row_[index(pattern_.row[e])];
      column_step_[e] = step_of_column_[j];
    }
  values_.assign(moved.size(), 0.0);
  inverse_.assign(size, 0.0);
  for (std::vector<double>* v : {&b_, &y_, &r_, &sums_}) v->assign(size * index(at_once), 0.0);
  for (std::vector<double>* v : {&b_sum_, &y_sum_}) v->assign(size, 0.0);
}

bool PlannedLu::factor(const double* values) {
  std::fill(values_.begin(), values_.end(), 0.0);
  for (std::size_t e = 0; e < position_.size(); ++e) {
    scaled_[e] = entry_factor_[e] * values[e];
    values_[index(position_[e])] = scaled_[e];
  }
  const std::size_t size = index(pattern_.size);
  double* const U = values_.data() + size;
  double* const L = U + first_u_[size];
  const int* target = target_.data();
  for (std::size_t k = 0; k < size; ++k) {
    const double pivot = values_[k];
    if (pivot == 0.0) return false;
    inverse_[k] = 1.0 / pivot;
    const int first = first_u_[k], last = first_u_[k + 1];
    for (int l = first_l_[k]; l < first_l_[k + 1]; ++l) {
      const double multiplier = L[l] *= inverse_[k];
      for (int u = first; u < last; ++u) values_[index(*target++)] -= multiplier * U[u];
    }
  }
  return true;
}

// By steps, `width` columns side by side: right-hand sides become the solution.
template <int width>
void PlannedLu::substitute(double* z) const {
  const std::size_t size = index(pattern_.size);
  const double* const U = values_.data() + size;
  const double* const L = U + first_u_[size];
  for (std::size_t k = 0; k < size; ++k) {
    const double* const known = z + k * width;
    for (int l = first_l_[k]; l < first_l_[k + 1]; ++l) {
      double* const to = z + index(l_row_[index(l)]) * width;
      for (int c = 0; c < width; ++c) to[c] -= L[l] * known[c];
    }
  }
  for (std::size_t k = size; k-- > 0;) {
    double sum[width];
    std::copy_n(z + k * width, width, sum);
    for (int u = first_u_[k]; u < first_u_[k + 1]; ++u) {
      const double* const from = z + index(u_column_[index(u)]) * width;
      for (int c = 0; c < width; ++c) sum[c] -= U[u] * from[c];
    }
    for (int c = 0; c < width; ++c) z[k * width + index(c)] = sum[c] * inverse_[k];
  }
}

// r_ := b - A y, of scaled equations, by steps; the largest error of its columns: their largest entry relative to the largest sum of
// the sizes of its terms. NaN where anything is not finite.
template <int width>
double PlannedLu::residual(const double* b, const double* y_of_all) {
  const std::size_t size = index(pattern_.size);
  std::copy_n(b, size * width, r_.begin());
  for (std::size_t k = 0; k < size * width; ++k) sums_[k] = std::fabs(r_[k]);
  for (std::size_t e = 0; e < scaled_.size(); ++e) {
    const double a = scaled_[e];
    const double* const y = y_of_all + index(column_step_[e]) * width;
    double* const r = r_.data() + index(row_step_[e]) * width;
    double* const sums = sums_.data() + index(row_step_[e]) * width;
    for (int c = 0; c < width; ++c) {
      const double term = a * y[c];
      r[c] -= term;
      sums[c] += std::fabs(term);
    }
  }
  double largest[width] = {}, sum[width] = {}, all[width] = {};
  for (std::size_t k = 0; k < size; ++k)
    for (int c = 0; c < width; ++c) {
      largest[c] = std::max(largest[c], std::fabs(r_[k * width + index(c)]));
      sum[c] = std::max(sum[c], sums_[k * width + index(c)]);
      all[c] += sums_[k * width + index(c)];
    }
  double error = 0.0;
  for (int c = 0; c < width; ++c) {
    if (!std::isfinite(all[c])) return all[c] - all[c];
    if (sum[c] > 0.0) error = std::max(error, largest[c] / sum[c]);
  }
  return error;
}

// The first `count` columns of x, of at most `width`: others repeat the last. checked: each of them, refined where necessary; else all
// are added to the sum that is looked at later.
template <int width>
bool PlannedLu::solve_columns(const double* b, int count, bool checked, double* x) {
  const std::size_t size = index(pattern_.size);
  for (std::size_t i = 0; i < size; ++i)
    for (int c = 0; c < width; ++c)
      b_[index(step_of_row_[i]) * width + index(c)] = row_factor_[i] * b[index(std::min(c, count - 1)) * size + i];
  std::copy_n(b_.begin(), size * width, y_.begin());
  substitute<width>(y_.data());
  if (checked) {
    double error = residual<width>(b_.data(), y_.data());
    if (error > rounding) {
      substitute<width>(r_.data());
      for (std::size_t k = 0; k < size * width; ++k) y_[k] += r_[k];
      error = residual<width>(b_.data(), y_.data());
    }
    if (!(error <= refused)) return false;
  } else {
    add_to_sum<width>();
  }
  for (std::size_t j = 0; j < size; ++j)
    for (int c = 0; c < count; ++c)
      x[index(c) * size + j] = column_factor_[j] * y_[index(step_of_column_[j]) * width + index(c)];
  return true;
}

// Columns of about the same size, with weights that no structure makes cancel.
template <int width>
void PlannedLu::add_to_sum() {
  const std::size_t size = index(pattern_.size);
  double largest[width] = {};
  for (std::size_t k = 0; k < size; ++k)
    for (int c = 0; c < width; ++c)
      largest[c] = std::max({largest[c], std::fabs(y_[k * width + index(c)]), std::fabs(b_[k * width + index(c)])});
  double weight[width];
  for (int c = 0; c < width; ++c) {
    weight_ += weight_ < 0.9 ? golden_section : golden_section - 1.0;  // from 0.5 to 1.5
    weight[c] = largest[c] > 0.0 ? weight_ / largest[c] : 0.0;
  }
  for (std::size_t k = 0; k < size; ++k)
    for (int c = 0; c < width; ++c) {
      b_sum_[k] += weight[c] * b_[k * width + index(c)];
      y_sum_[k] += weight[c] * y_[k * width + index(c)];
    }
}

bool PlannedLu::solve_all(const double* b, int count, bool checked, double* x) {
  const std::size_t size = index(pattern_.size);
  for (int c = 0; c < count; c += at_once) {
    const int columns = std::min(at_once, count - c);
    const std::size_t first = index(c) * size;
    const bool is_solved = columns == 1 ? solve_columns<1>(b + first, 1, checked, x + first)
                                        : solve_columns<at_once>(b + first, columns, checked, x + first);
    if (!is_solved) return false;
  }
  return true;
}

// What is wrong with the factors is wrong with a sum of solutions: that of many columns costs one residual. Where it is not small
// each of them is looked at.
bool PlannedLu::solve_with_plan(const double* values, const double* b, int count, double* x) {
  if (!factor(values)) return false;
  if (count > 1) {
    std::fill(b_sum_.begin(), b_sum_.end(), 0.0);
    std::fill(y_sum_.begin(), y_sum_.end(), 0.0);
    weight_ = 1.0;
    if (solve_all(b, count, false, x) && residual<1>(b_sum_.data(), y_sum_.data()) <= rounding) return true;
  }
  return solve_all(b, count, true, x);
}

bool PlannedLu::solve(const double* values, const double* b, int count, double* x) {
  const QuietArithmetic quiet;
  ++solutions_;
  if (has_plan_ && solve_with_plan(values, b, count, x)) return true;
  return choose_pivots(values) && solve_with_plan(values, b, count, x);
}

}  // namespace sfdae::core
