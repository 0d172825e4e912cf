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
// Pivots may be chosen for every eighth solution; more often they do not save anything.
constexpr long least_plans = 8, solutions_of_a_plan = 8;

// Nanoseconds, as in sparse_lu.cpp: of the list, and of a full matrix by LAPACK.
double time_of_list(double operations) { return 1.2 * operations; }
// Longer lists are read from memory, and pivots are not worth the search.
constexpr std::size_t most_operations = 500000;
double time_of_full_matrix(double n) { return n * (50.0 + 0.3 * n) + 0.022 * n * n * n; }

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

void PlannedLu::analyze(const SparsePattern& pattern, double accepted) {
  accepted_ = accepted;
  pattern_ = pattern;
  is_suitable_ = true;
  has_plan_ = false;
  plans_ = solutions_ = 0;
  scales_ = Equilibration();
  list_.target.clear();
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
  list_.row_factor.resize(size);
  list_.column_factor.resize(size);
  list_.entry_factor.resize(pattern_.row.size());
  scaled_.resize(pattern_.row.size());
  constexpr int harmless = 400;  // products of two factors and their inverses are numbers
  for (std::size_t k = 0; k < size; ++k) {
    const int of_row = scales_.of_crossings()[k], of_column = scales_.of_lines()[k];
    if (std::abs(of_row) > harmless || std::abs(of_column) > harmless) return is_suitable_ = false;
    list_.row_factor[k] = power_of_two(of_row);
    list_.column_factor[k] = power_of_two(of_column);
  }
  for (std::size_t j = 0; j < size; ++j)
    for (std::size_t e = index(pattern_.first[j]); e < index(pattern_.first[j + 1]); ++e) {
      list_.entry_factor[e] = list_.row_factor[index(pattern_.row[e])] * list_.column_factor[j];
      scaled_[e] = list_.entry_factor[e] * values[e];
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
  list_.step_of_row.resize(size);
  list_.step_of_column.resize(size);
  list_.first_u.assign(1, 0);
  list_.first_l.assign(1, 0);
  int next = pattern_.size;
  for (std::size_t k = 0; k < size; ++k) {
    const Planning::Step& step = planning.steps()[k];
    list_.step_of_row[index(step.row)] = list_.step_of_column[index(step.column)] = static_cast<int>(k);
    moved[index(planning.pivot_position(k))] = static_cast<int>(k);
    for (int position : step.u_positions) moved[index(position)] = next++;
    list_.first_u.push_back(list_.first_u.back() + static_cast<int>(step.u_positions.size()));
  }
  for (std::size_t k = 0; k < size; ++k) {
    for (int position : planning.steps()[k].l_positions) moved[index(position)] = next++;
    list_.first_l.push_back(list_.first_l.back() + static_cast<int>(planning.steps()[k].l_positions.size()));
  }
  list_.u_column.clear();
  list_.l_row.clear();
  for (const Planning::Step& step : planning.steps()) {
    for (int column : step.u_columns) list_.u_column.push_back(list_.step_of_column[index(column)]);
    for (int row : step.l_rows) list_.l_row.push_back(list_.step_of_row[index(row)]);
  }
  list_.target.clear();
  for (int position : planning.targets()) list_.target.push_back(moved[index(position)]);
  for (std::vector<int>* v : {&list_.position, &list_.row_step, &list_.column_step}) v->resize(pattern_.row.size());
  for (std::size_t j = 0; j < size; ++j)
    for (std::size_t e = index(pattern_.first[j]); e < index(pattern_.first[j + 1]); ++e) {
      list_.position[e] = moved[e];
      list_.row_step[e] = list_.step_of_row[index(pattern_.row[e])];
      list_.column_step[e] = list_.step_of_column[j];
    }
  list_.fill = moved.size();
  values_.assign(moved.size(), 0.0);
  inverse_.assign(size, 0.0);
  for (std::vector<double>* v : {&b_, &y_, &r_, &sums_}) v->assign(size * index(at_once), 0.0);
}

bool PlannedLu::factor(const double* values) {
  const EliminationList& list = list_;
  std::fill(values_.begin(), values_.end(), 0.0);
  for (std::size_t e = 0; e < list.position.size(); ++e) {
    scaled_[e] = list.entry_factor[e] * values[e];
    values_[index(list.position[e])] = scaled_[e];
  }
  const std::size_t size = list.size();
  double* const U = values_.data() + size;
  double* const L = U + list.first_u[size];
  const int* target = list.target.data();
  for (std::size_t k = 0; k < size; ++k) {
    const double pivot = values_[k];
    if (pivot == 0.0) return false;
    inverse_[k] = 1.0 / pivot;
    const int first = list.first_u[k], last = list.first_u[k + 1];
    for (int l = list.first_l[k]; l < list.first_l[k + 1]; ++l) {
      const double multiplier = L[l] *= inverse_[k];
      for (int u = first; u < last; ++u) values_[index(*target++)] -= multiplier * U[u];
    }
  }
  return true;
}

// By steps, `width` columns side by side: right-hand sides become the solution.
template <int width>
void PlannedLu::substitute(double* z) const {
  const std::size_t size = list_.size();
  const double* const U = values_.data() + size;
  const double* const L = U + list_.first_u[size];
  const int *const first_l = list_.first_l.data(), *const first_u = list_.first_u.data();
  const int *const l_row = list_.l_row.data(), *const u_column = list_.u_column.data();
  for (std::size_t k = 0; k < size; ++k) {
    const double* const known = z + k * width;
    for (int l = first_l[k]; l < first_l[k + 1]; ++l) {
      double* const to = z + index(l_row[l]) * width;
      for (int c = 0; c < width; ++c) to[c] -= L[l] * known[c];
    }
  }
  for (std::size_t k = size; k-- > 0;) {
    double sum[width];
    std::copy_n(z + k * width, width, sum);
    for (int u = first_u[k]; u < first_u[k + 1]; ++u) {
      const double* const from = z + index(u_column[u]) * width;
      for (int c = 0; c < width; ++c) sum[c] -= U[u] * from[c];
    }
    for (int c = 0; c < width; ++c) z[k * width + index(c)] = sum[c] * inverse_[k];
  }
}

// r := b - A y, of scaled equations, by steps; the largest error of its columns: their largest entry relative to the largest sum of
// the sizes of its terms. NaN where anything is not finite.
template <int width>
double PlannedLu::residual() {
  const std::size_t size = list_.size();
  std::copy_n(b_.begin(), size * width, r_.begin());
  for (std::size_t k = 0; k < size * width; ++k) sums_[k] = std::fabs(r_[k]);
  for (std::size_t e = 0; e < scaled_.size(); ++e) {
    const double a = scaled_[e];
    const double* const y = y_.data() + index(list_.column_step[e]) * width;
    double* const r = r_.data() + index(list_.row_step[e]) * width;
    double* const sums = sums_.data() + index(list_.row_step[e]) * width;
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

// The first `count` columns of x, of at most `width`: others repeat the last. Where the residual is what may be left after a
// refinement it is not evaluated again.
template <int width>
bool PlannedLu::solve_columns(const double* b, int count, double* x) {
  const std::size_t size = list_.size();
  for (std::size_t i = 0; i < size; ++i)
    for (int c = 0; c < width; ++c)
      b_[index(list_.step_of_row[i]) * width + index(c)] =
          list_.row_factor[i] * b[index(std::min(c, count - 1)) * size + i];
  std::copy_n(b_.begin(), size * width, y_.begin());
  substitute<width>(y_.data());
  const double error = residual<width>();
  if (!(error <= accepted_)) {
    substitute<width>(r_.data());
    for (std::size_t k = 0; k < size * width; ++k) y_[k] += r_[k];
    if (!(error <= refused_residuals) && !(residual<width>() <= refused_residuals)) return false;
  }
  for (std::size_t j = 0; j < size; ++j)
    for (int c = 0; c < count; ++c)
      x[index(c) * size + j] = list_.column_factor[j] * y_[index(list_.step_of_column[j]) * width + index(c)];
  return true;
}

bool PlannedLu::solve_with_plan(const double* values, const double* b, int count, double* x) {
  if (!factor(values)) return false;
  const std::size_t size = list_.size();
  for (int c = 0; c < count; c += at_once) {
    const int columns = std::min(at_once, count - c);
    const double* const from = b + index(c) * size;
    double* const to = x + index(c) * size;
    const bool is_solved = columns == 1   ? solve_columns<1>(from, 1, to)
                           : columns == 2 ? solve_columns<2>(from, 2, to)
                                          : solve_columns<at_once>(from, columns, to);
    if (!is_solved) return false;
  }
  return true;
}

bool PlannedLu::solve(const double* values, const double* b, int count, double* x) {
  const QuietArithmetic quiet;
  ++solutions_;
  if (has_plan_ && solve_with_plan(values, b, count, x)) return true;
  return choose_pivots(values) && solve_with_plan(values, b, count, x);
}

}  // namespace sfdae::core
