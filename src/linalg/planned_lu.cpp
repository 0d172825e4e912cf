// Sparse systems of linear equations with matrices that change little.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/planned_lu.h"

#include <algorithm>
#include <cmath>

#include "linalg/elimination_planning.h"
#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

// Limit: one choice of pivots per eight solutions; more frequent choices save nothing.
constexpr long least_plans = 8, solutions_of_a_plan = 8;

// Nanoseconds, as in sparse_lu.cpp: of the list, and of a full matrix by LAPACK.
double time_of_list(double operations) { return 1.2 * operations; }
// Longer lists are read from memory, and pivots are not worth the search.
constexpr std::size_t most_operations = 500000;
double time_of_full_matrix(double n) { return n * (50.0 + 0.3 * n) + 0.022 * n * n * n; }

double power_of_two(int exponent) { return times_power_of_two(1.0, exponent); }

// Eliminates with a row of `count` entries besides its pivot, in all rows that have multipliers.
template <int count>
double* eliminate_rows(double* all, const double* u, double inverse, double* L, const double* last,
                       const int*& target) {
  const int* next = target;
  for (; L != last; ++L, next += count) {
    const double multiplier = *L *= inverse;
    for (int c = 0; c < count; ++c) all[next[c]] -= multiplier * u[c];
  }
  target = next;
  return L;
}

}  // namespace

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
  EliminationPlanning planning(pattern_, scaled_.data());
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
void PlannedLu::take(const EliminationPlanning& planning) {
  const std::size_t size = index(pattern_.size);
  std::vector<int> moved(index(planning.positions()));
  list_.step_of_row.resize(size);
  list_.step_of_column.resize(size);
  list_.first_u.assign(1, 0);
  list_.first_l.assign(1, 0);
  int next = pattern_.size;
  for (std::size_t k = 0; k < size; ++k) {
    const EliminationPlanning::Step& step = planning.steps()[k];
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
  for (const EliminationPlanning::Step& step : planning.steps()) {
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
  list_rows();
  values_.assign(moved.size(), 0.0);
  inverse_.assign(size, 0.0);
  for (std::vector<double>* v : {&b_, &y_, &r_}) v->assign(size * index(at_once), 0.0);
}

// Lists the entries of rows in the order of the pattern.
void PlannedLu::list_rows() {
  const std::size_t size = list_.size(), entries = list_.position.size();
  first_of_row_.assign(size + 1, 0);
  for (int step : list_.row_step) ++first_of_row_[index(step) + 1];
  for (std::size_t k = 0; k < size; ++k) first_of_row_[k + 1] += first_of_row_[k];
  std::vector<int> next(first_of_row_.begin(), first_of_row_.end() - 1);
  rows_.resize(entries);
  column_in_row_.resize(entries);
  for (std::size_t e = 0; e < entries; ++e) {
    const std::size_t k = index(next[index(list_.row_step[e])]++);
    rows_[k] = {static_cast<int>(e), list_.position[e], list_.entry_factor[e]};
    column_in_row_[k] = list_.column_step[e];
  }
}

bool PlannedLu::factor(const double* values) {
  const EliminationList& list = list_;
  double* const all = values_.data();
  std::fill(values_.begin(), values_.end(), 0.0);
  double* scaled = scaled_.data();
  for (const RowEntry& of_row : rows_) all[of_row.position] = *scaled++ = of_row.factor * values[of_row.entry];
  const std::size_t size = list.size();
  double* const U = all + size;
  double* L = U + list.first_u[size];
  const int* target = list.target.data();
  for (std::size_t k = 0; k < size; ++k) {
    const double pivot = all[k];
    if (pivot == 0.0) return false;
    const double inverse = inverse_[k] = 1.0 / pivot;
    const double* const u = U + list.first_u[k];
    const int count = list.first_u[k + 1] - list.first_u[k];
    double* const last = L + (list.first_l[k + 1] - list.first_l[k]);
    // Most rows are short.
    switch (count) {
      case 0:
        for (; L != last; ++L) *L *= inverse;
        break;
      case 1: L = eliminate_rows<1>(all, u, inverse, L, last, target); break;
      case 2: L = eliminate_rows<2>(all, u, inverse, L, last, target); break;
      case 3: L = eliminate_rows<3>(all, u, inverse, L, last, target); break;
      case 4: L = eliminate_rows<4>(all, u, inverse, L, last, target); break;
      default:
        for (; L != last; ++L) {
          const double multiplier = *L *= inverse;
          for (int c = 0; c < count; ++c) all[*target++] -= multiplier * u[c];
        }
    }
  }
  return true;
}

// Solves, by steps, `width` columns side by side: right-hand sides become the solution.
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

// r := b - A y, of scaled equations, by steps; the largest error of its columns: their largest entry relative to the
// largest sum of the sizes of its terms, or, which is not less, relative to the largest of the last terms of rows.
// NaN where anything is not finite.
template <int width, PlannedLu::Terms terms>
double PlannedLu::residual() {
  const std::size_t size = list_.size();
  const int *const columns = column_in_row_.data(), *const ends = first_of_row_.data() + 1;
  const double *const scaled = scaled_.data(), *const y = y_.data(), *b = b_.data();
  double* r = r_.data();
  double largest[width] = {}, term[width] = {}, largest_sum[width] = {}, all[width] = {};
  std::ptrdiff_t e = 0;
  for (std::size_t k = 0; k < size; ++k, b += width, r += width) {
    double difference[width], sum[width];
    for (int c = 0; c < width; ++c) {
      difference[c] = b[c];
      sum[c] = std::fabs(b[c]);
    }
    for (const std::ptrdiff_t last = ends[k]; e < last; ++e) {
      const double a = scaled[e];
      const double* const of_column = y + std::ptrdiff_t(columns[e]) * width;
      for (int c = 0; c < width; ++c) {
        term[c] = a * of_column[c];
        difference[c] -= term[c];
        if (terms == Terms::all) sum[c] += std::fabs(term[c]);
      }
    }
    for (int c = 0; c < width; ++c) {
      r[c] = difference[c];
      const double size_of_r = std::fabs(difference[c]),
                   size_of_row = terms == Terms::all ? sum[c] : std::fabs(term[c]);
      largest[c] = size_of_r > largest[c] ? size_of_r : largest[c];
      largest_sum[c] = size_of_row > largest_sum[c] ? size_of_row : largest_sum[c];
      all[c] += terms == Terms::all ? size_of_row : size_of_r;
    }
  }
  double error = 0.0;
  for (int c = 0; c < width; ++c) {
    if (!std::isfinite(all[c])) return all[c] - all[c];
    if (largest[c] > 0.0) error = std::max(error, largest[c] / largest_sum[c]);
  }
  return error;
}

// The first `count` columns of x, of at most `width`: others repeat the last. After a refinement the residual is
// evaluated again only if it was above the limit of refusal.
template <int width>
bool PlannedLu::solve_columns(const double* b, int count, double* x) {
  const std::size_t size = list_.size();
  for (std::size_t i = 0; i < size; ++i)
    for (int c = 0; c < width; ++c)
      b_[index(list_.step_of_row[i]) * width + index(c)] =
          list_.row_factor[i] * b[index(std::min(c, count - 1)) * size + i];
  std::copy_n(b_.begin(), size * width, y_.begin());
  substitute<width>(y_.data());
  double error = accepted_ > rounding_of_residuals ? residual<width, Terms::last>() : HUGE_VAL;
  if (!(error <= accepted_)) error = residual<width, Terms::all>();
  if (!(error <= accepted_)) {
    substitute<width>(r_.data());
    for (std::size_t k = 0; k < size * width; ++k) y_[k] += r_[k];
    if (!(error <= refused_residuals) && !(residual<width, Terms::all>() <= refused_residuals)) return false;
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
