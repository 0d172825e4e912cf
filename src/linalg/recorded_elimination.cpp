// LU factors of small sparse matrices by a recorded elimination.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/recorded_elimination.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <utility>

#include "linalg/condition.h"
#include "linalg/dense_factors.h"
#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

// Least size of a pivot relative to the largest entry in its row: when it is chosen (the usual bound [DER86, 5.4]), and
// when the elimination is repeated, as for lanes (docs/design/radau.md).
constexpr double large_enough = 0.1, still_large_enough = 0.01;
constexpr double largest_number = std::numeric_limits<double>::max();
// Products of two scales and their inverses are numbers.
constexpr int largest_exponent = 400;
// Search among rows with fewest entries, after Zlatev [DER86, 7.2].
constexpr std::size_t rows_searched = 4;
// Reserved entries of rows and columns for fill.
constexpr int usual_fill = 3;
// KLU is faster with more. Chosen: matrices of mechanisms and circuits have 2 to 11
// (docs/design/sparse_algebra.md).
constexpr std::size_t most_updates_for_a_row = 20, few_updates = 1000;
// Relative times; see docs/design/sparse_algebra.md.
constexpr double time_of_pivot = 6.0, time_of_entry = 1.5, time_of_update = 1.0, time_of_unknown = 4.0;

// Size of an entry for comparisons of pivots, at most sqrt(2) times the modulus.
double size_of(double x) { return std::fabs(x); }
double size_of(std::complex<double> x) { return std::fabs(x.real()) + std::fabs(x.imag()); }
// Products and reciprocals of finite numbers; operators of std::complex look for infinities, at twice the cost.
double product(double x, double y) { return x * y; }
std::complex<double> product(std::complex<double> x, std::complex<double> y) {
  return {x.real() * y.real() - x.imag() * y.imag(), x.real() * y.imag() + x.imag() * y.real()};
}
double reciprocal(double x) { return 1.0 / x; }
// In sizes relative to the larger part, whose square may overflow or vanish.
std::complex<double> reciprocal(std::complex<double> x) {
  const double unit = 1.0 / std::max(std::fabs(x.real()), std::fabs(x.imag()));
  const double re = unit * x.real(), im = unit * x.imag(), scale = unit / (re * re + im * im);
  return {scale * re, -scale * im};
}

}  // namespace

const RecordedElimination::PivotBounds RecordedElimination::pivot_bounds{vanishing_pivot, still_large_enough,
                                                                         largest_number};

// The matrix while pivots are being chosen. Entries have slots, which stay where they are.
template <class Number>
class RecordedElimination::Search {
 public:
  explicit Search(const SparsePattern& pattern)
      : rows(index(pattern.size)),
        columns(index(pattern.size)),
        n_(pattern.size),
        place_(index(n_) * index(n_), -1),
        left_(index(n_)) {
    value.reserve(4 * pattern.row.size());
    std::iota(left_.begin(), left_.end(), 0);
    std::vector<int> entries(index(n_), 0);
    for (int i : pattern.row) ++entries[index(i)];
    for (int k = 0; k < n_; ++k) {
      rows[index(k)].reserve(index(entries[index(k)] + usual_fill));
      columns[index(k)].reserve(index(pattern.first[index(k) + 1] - pattern.first[index(k)] + usual_fill));
    }
  }

  int slot(int row, int column) const { return place_[index(row) * index(n_) + index(column)]; }
  int add(int row, int column, Number v) {
    int& slot = place_[index(row) * index(n_) + index(column)];
    if (slot < 0) {
      slot = static_cast<int>(value.size());
      value.push_back(Number(0));
      rows[index(row)].push_back(column);
      columns[index(column)].push_back(row);
    }
    value[index(slot)] += v;
    return slot;
  }

  struct Pivot {
    int row = -1, column = -1;
  };
  // The entry that causes the least fill, the larger one of several.
  Pivot choose() {
    Pivot best;
    std::size_t least = std::numeric_limits<std::size_t>::max();
    double size = 0.0;
    const std::size_t searched = std::min(rows_searched, left_.size());
    std::partial_sort(left_.begin(), left_.begin() + static_cast<std::ptrdiff_t>(searched), left_.end(),
                      [this](int one, int other) {
                        const std::size_t a = rows[index(one)].size(), b = rows[index(other)].size();
                        return a != b ? a < b : one < other;
                      });
    for (std::size_t k = 0; k < searched; ++k) {
      const int i = left_[k];
      const std::vector<int>& row = rows[index(i)];
      double largest = 0.0;
      for (int j : row) largest = std::max(largest, size_of(value[index(slot(i, j))]));
      for (int j : row) {
        const std::size_t cost = (row.size() - 1) * (columns[index(j)].size() - 1);
        if (cost > least) continue;
        const double here = size_of(value[index(slot(i, j))]);
        if (!(here >= large_enough * largest && here > vanishing_pivot) || (cost == least && here <= size)) continue;
        best = {i, j};
        least = cost;
        size = here;
      }
    }
    return best;
  }
  // Both leave the search: the row without the pivot, and the column without it.
  std::pair<std::vector<int>, std::vector<int>> take(const Pivot& pivot) {
    std::erase(left_, pivot.row);
    std::vector<int> row = std::move(rows[index(pivot.row)]), column = std::move(columns[index(pivot.column)]);
    std::erase(row, pivot.column);
    std::erase(column, pivot.row);
    for (int j : row) std::erase(columns[index(j)], pivot.row);
    for (int i : column) std::erase(rows[index(i)], pivot.column);
    return {std::move(row), std::move(column)};
  }

  std::vector<std::vector<int>> rows, columns;  // of the remaining matrix, the other index of its entries
  std::vector<Number> value;                    // by slots

 private:
  int n_;
  std::vector<int> place_, left_;
};

template <class Number>
RecordedElimination::Choice RecordedElimination::choose(const SparsePattern& pattern, const Number* values) {
  forget();
  const int n = pattern.size;
  if (!all_finite_numbers(values, pattern.row.size())) return Choice::singular;
  if (!equilibration_.compute(CompressedLines{n, n, pattern.first.data(), pattern.row.data()}, values))
    return Choice::singular;
  row_exponent_ = equilibration_.of_crossings();
  column_exponent_ = equilibration_.of_lines();
  for (const std::vector<int>* exponents : {&row_exponent_, &column_exponent_})
    for (int exponent : *exponents)
      if (std::abs(exponent) > largest_exponent) return Choice::too_long;
  return record(pattern, values, Pivots::wanted);
}

// values: null if pivots are known.
template <class Number>
RecordedElimination::Choice RecordedElimination::record(const SparsePattern& pattern, const Number* values,
                                                        Pivots pivots) {
  const int n = pattern.size;
  Search<Number> search(pattern);
  list_.slot_of_entry.clear();
  list_.slot_of_entry.reserve(pattern.row.size());
  column_of_entry_.clear();
  column_of_entry_.reserve(pattern.row.size());
  list_.scale.clear();
  list_.scale.reserve(pattern.row.size());
  for (int j = 0; j < n; ++j)
    for (int k = pattern.first[index(j)]; k < pattern.first[index(j) + 1]; ++k) {
      const int i = pattern.row[index(k)];
      list_.scale.push_back(times_power_of_two(1.0, column_exponent_[index(j)] + row_exponent_[index(i)]));
      list_.slot_of_entry.push_back(search.add(i, j, values != nullptr ? list_.scale.back() * values[k] : Number(0)));
      column_of_entry_.push_back(j);
    }
  const Choice choice = eliminate(search, pivots);
  if (choice != Choice::made) return choice;
  list_.row_scale.resize(index(n));
  list_.column_scale.resize(index(n));
  for (std::size_t k = 0; k < index(n); ++k) {
    list_.row_scale[k] = times_power_of_two(1.0, row_exponent_[index(list_.row[k])]);
    list_.column_scale[k] = times_power_of_two(1.0, column_exponent_[index(list_.column[k])]);
  }
  std::vector<int> column_of_row(index(n));
  for (int k = 0; k < n; ++k) column_of_row[index(list_.row[index(k)])] = list_.column[index(k)];
  is_odd_ = is_odd(column_of_row.data(), n);
  list_.size = n;
  list_.slots = static_cast<int>(search.value.size());
  return Choice::made;
}

// A = L U with ones on the diagonal of U.
template <class Number>
RecordedElimination::Choice RecordedElimination::eliminate(Search<Number>& search, Pivots pivots) {
  const std::size_t n = search.rows.size(), most = std::max(most_updates_for_a_row * n, few_updates);
  list_.row.resize(n);
  list_.column.resize(n);
  list_.pivot.clear();
  list_.pivot.reserve(n);
  for (auto* list : {&list_.lower, &list_.upper}) {
    list->clear();
    list->reserve(search.value.size());
  }
  for (auto* first : {&list_.first_lower, &list_.first_upper, &list_.first_update}) {
    first->reserve(n + 1);
    first->assign(1, 0);
  }
  list_.updates.clear();
  list_.updates.reserve(2 * search.value.size());
  std::vector<int> place_of_row(n), place_of_column(n);
  for (std::size_t k = 0; k < n; ++k) {
    if (pivots == Pivots::wanted) {
      const auto pivot = search.choose();
      if (pivot.row < 0) return Choice::singular;
      list_.row[k] = pivot.row;
      list_.column[k] = pivot.column;
    }
    const int slot = search.slot(list_.row[k], list_.column[k]);
    if (slot < 0) return Choice::singular;
    const auto [row, column] = search.take({list_.row[k], list_.column[k]});
    if (list_.updates.size() + row.size() * column.size() > most) return Choice::too_long;
    list_.pivot.push_back(slot);
    place_of_row[index(list_.row[k])] = place_of_column[index(list_.column[k])] = static_cast<int>(k);
    for (int i : column) list_.lower.push_back({search.slot(i, list_.column[k]), i});
    for (int j : row) {
      const int right = search.slot(list_.row[k], j);
      list_.upper.push_back({right, j});
      const Number factor = pivots == Pivots::wanted ? search.value[index(right)] /= search.value[index(slot)] : 0.0;
      for (int i : column) {
        const int left = search.slot(i, list_.column[k]);
        list_.updates.push_back({search.add(i, j, -factor * search.value[index(left)]), left, right});
      }
    }
    list_.first_lower.push_back(static_cast<int>(list_.lower.size()));
    list_.first_upper.push_back(static_cast<int>(list_.upper.size()));
    list_.first_update.push_back(static_cast<int>(list_.updates.size()));
  }
  for (Entry& entry : list_.lower) entry.place = place_of_row[index(entry.place)];
  for (Entry& entry : list_.upper) entry.place = place_of_column[index(entry.place)];
  return Choice::made;
}

double RecordedElimination::factorization_in_solutions() const {
  const double entries = static_cast<double>(list_.scale.size()), updates = static_cast<double>(list_.updates.size());
  const double off_diagonal = static_cast<double>(list_.lower.size() + list_.upper.size()), n = list_.size;
  return (time_of_pivot * n + time_of_entry * (entries + off_diagonal) + time_of_update * updates) /
         (time_of_unknown * n + time_of_update * off_diagonal);
}

// Pivots are replaced by their reciprocals.
template <class Number>
bool RecordedElimination::factor(const Number* values, Number* factors) const {
  std::fill_n(factors, list_.slots, Number(0));
  for (std::size_t e = 0; e < list_.slot_of_entry.size(); ++e)
    factors[list_.slot_of_entry[e]] += list_.scale[e] * values[e];
  for (std::size_t k = 0; k < index(list_.size); ++k) {
    Number& pivot = factors[list_.pivot[k]];
    double largest = 0.0;
    for (int u = list_.first_upper[k]; u < list_.first_upper[k + 1]; ++u)
      largest = std::max(largest, size_of(factors[list_.upper[index(u)].slot]));
    const double size = size_of(pivot);
    if (!(size > pivot_bounds.least && size >= pivot_bounds.least_of_row * largest && size <= pivot_bounds.largest))
      return false;
    pivot = reciprocal(pivot);
    for (int u = list_.first_upper[k]; u < list_.first_upper[k + 1]; ++u) {
      Number& entry = factors[list_.upper[index(u)].slot];
      entry = product(entry, pivot);
    }
    for (int u = list_.first_update[k]; u < list_.first_update[k + 1]; ++u) {
      const Update& update = list_.updates[index(u)];
      factors[update.target] -= product(factors[update.left], factors[update.right]);
    }
  }
  return true;
}

// Local pointers, as written values could alias any of the lists for the compiler.
template <class Number>
void RecordedElimination::substitute(const Number* factors, Number* y) const {
  const std::size_t size = index(list_.size);
  const int* const first_lower = list_.first_lower.data();
  const Entry* entry = list_.lower.data();
  for (std::size_t k = 0; k < size; ++k) {
    const Number solved = product(y[k], factors[list_.pivot[k]]);
    y[k] = solved;
    for (const Entry* const last = list_.lower.data() + first_lower[k + 1]; entry != last; ++entry)
      y[entry->place] -= product(factors[entry->slot], solved);
  }
  const int* const first_upper = list_.first_upper.data();
  const Entry* const upper = list_.upper.data();
  for (std::size_t k = size; k-- > 0;) {
    Number sum = y[k];
    const Entry* const last = upper + first_upper[k + 1];
    for (const Entry* next = upper + first_upper[k]; next != last; ++next)
      sum -= product(factors[next->slot], y[next->place]);
    y[k] = sum;
  }
}

void RecordedElimination::substitute_transposed(const double* factors, double* y) const {
  for (std::size_t k = 0; k < index(list_.size); ++k)
    for (int u = list_.first_upper[k]; u < list_.first_upper[k + 1]; ++u)
      y[list_.upper[index(u)].place] -= factors[list_.upper[index(u)].slot] * y[k];
  for (std::size_t k = index(list_.size); k-- > 0;) {
    double sum = y[k];
    for (int l = list_.first_lower[k]; l < list_.first_lower[k + 1]; ++l)
      sum -= factors[list_.lower[index(l)].slot] * y[list_.lower[index(l)].place];
    y[k] = sum * factors[list_.pivot[k]];
  }
}

template <class Number>
void RecordedElimination::solve(const Number* factors, Number* b, Number* work) const {
  for (std::size_t k = 0; k < index(list_.size); ++k) work[k] = list_.row_scale[k] * b[list_.row[k]];
  substitute(factors, work);
  for (std::size_t k = 0; k < index(list_.size); ++k) b[list_.column[k]] = list_.column_scale[k] * work[k];
}

// Works in the order of the pivots: the norms of rows and columns are the same in another order.
double RecordedElimination::reciprocal_condition(const double* values, const double* factors) const {
  const QuietArithmetic quiet;
  std::vector<double> sums(index(list_.size), 0.0);
  for (std::size_t e = 0; e < list_.scale.size(); ++e)
    sums[index(column_of_entry_[e])] += std::fabs(list_.scale[e] * values[e]);
  const double inverse_norm = estimate_inverse_norm<double>(
      list_.size, [&](double* x) { substitute(factors, x); }, [&](double* x) { substitute_transposed(factors, x); });
  return inverse_norm > 0.0 ? 1.0 / *std::max_element(sums.begin(), sums.end()) / inverse_norm : 0.0;
}

Determinant<double> RecordedElimination::determinant(const double* factors) const {
  Determinant<double> determinant;
  for (int slot : list_.pivot) determinant.multiply(1.0 / factors[slot]);
  determinant.change_sign_if(is_odd_);
  for (const std::vector<int>* exponents : {&row_exponent_, &column_exponent_})
    for (int exponent : *exponents) determinant.log2 -= exponent;
  return determinant;
}

bool RecordedElimination::are_pivots_sound(const SparsePattern& pattern) const {
  for (const std::vector<int>* list : {&list_.row, &list_.column}) {
    std::vector<char> is_met(index(pattern.size), 0);
    for (int place : *list) {
      if (place < 0 || place >= pattern.size || is_met[index(place)] != 0) return false;
      is_met[index(place)] = 1;
    }
  }
  for (const std::vector<int>* exponents : {&row_exponent_, &column_exponent_})
    for (int exponent : *exponents)
      if (std::abs(exponent) > largest_exponent) return false;
  return true;
}

void RecordedElimination::archive(const SparsePattern& pattern, Archive& archive) {
  bool has_any = has_pivots();
  archive.small(has_any);
  if (archive.is_reading()) forget();
  if (!has_any) return;
  const std::size_t n = index(pattern.size);
  std::vector<int> packed;
  for (const std::vector<int>* list : {&list_.row, &list_.column})
    packed.insert(packed.end(), list->begin(), list->end());
  for (const std::vector<int>* exponents : {&row_exponent_, &column_exponent_})
    for (int exponent : *exponents) packed.push_back(exponent + largest_exponent);
  packed.resize(4 * n);
  archive.small(packed.data(), packed.size());
  if (!archive.is_reading()) return;
  auto next = packed.begin();
  for (std::vector<int>* list : {&list_.row, &list_.column, &row_exponent_, &column_exponent_}) {
    list->assign(next, next + pattern.size);
    next += pattern.size;
  }
  for (std::vector<int>* exponents : {&row_exponent_, &column_exponent_})
    for (int& exponent : *exponents) exponent -= largest_exponent;
  if (!are_pivots_sound(pattern) || record<double>(pattern, nullptr, Pivots::known) != Choice::made)
    throw DamagedArchive();
}

template RecordedElimination::Choice RecordedElimination::choose(const SparsePattern&, const double*);
template RecordedElimination::Choice RecordedElimination::choose(const SparsePattern&, const std::complex<double>*);
template bool RecordedElimination::factor(const double*, double*) const;
template bool RecordedElimination::factor(const std::complex<double>*, std::complex<double>*) const;
template void RecordedElimination::solve(const double*, double*, double*) const;
template void RecordedElimination::solve(const std::complex<double>*, std::complex<double>*,
                                         std::complex<double>*) const;

}  // namespace sfdae::core
