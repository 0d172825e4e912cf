// Taylor coefficients of a linear problem at one point: scaling.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/taylor_data.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/index.h"
#include "linalg/kernels_in_use.h"
#include "linalg/random.h"
#include "linalg/rank.h"
#include "problem/row_factors.h"

namespace sfdae::core {

namespace {

// Products of a few scaled coefficients must stay finite: five of this size do.
constexpr double largest_coefficient = 1e60;
// Factors of rows within 8 of those wanted stay, for equations that depend smoothly on t
// (docs/design/scaling_and_units.md).
constexpr double about_right = 8.0;
// Scaled data have entries of one to two, except for a tiny E with its small unit of time: below this value they get
// another factor.
constexpr double small_data = 0.125;

void multiply_entries(double* values, std::size_t count, double factor) {
  for (std::size_t i = 0; i < count; ++i) values[i] *= factor;
}

// Sizes of the rows of [E unit A]; a row that vanishes at this point only is measured by its derivatives.
void measure_rows(const TaylorData& data, double unit_of_A, std::vector<double>& sizes) {
  const kernels::ArrayLoops& loops = kernels::loops().arrays;
  std::fill(sizes.begin(), sizes.end(), 0.0);
  const auto raise = [&](ConstView a, double unit = 1.0) {
    for (int j = 0; j < data.n; ++j) loops.raise_sizes(a.column(j), unit, data.m, sizes.data());
  };
  raise(data.E(0));
  raise(data.A(0), unit_of_A);
  if (*std::min_element(sizes.begin(), sizes.end()) != 0.0) return;
  const std::vector<double> at_point = sizes;
  for (int k = 1; k <= data.orders.E; ++k) raise(data.E(k));
  for (int k = 1; k <= data.orders.A; ++k) raise(data.A(k));
  for (std::size_t i = 0; i < sizes.size(); ++i)
    if (at_point[i] != 0.0) sizes[i] = at_point[i];
}

// Returns whether all preferred factors of rows are about right.
bool are_about_right(const std::vector<double>& preferred, const std::vector<double>& wanted) {
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const double ratio = wanted[i] / preferred[i];
    if (!(ratio >= 1.0 / about_right && ratio <= about_right)) return false;
  }
  return true;
}

void choose_row_scale(TaylorData& data, double tau, RowScaling rows, const std::vector<double>* preferred) {
  std::vector<double>& row_scale = data.row_scale;
  measure_rows(data, unit_of_A(rows, tau), row_scale);
  data.row_norm = row_scale;
  become_row_factors(row_scale, rows);
  if (preferred == nullptr || rows == RowScaling::common) return;
  if (rows == RowScaling::given || are_about_right(*preferred, row_scale)) row_scale = *preferred;
}

}  // namespace

void TaylorData::resize(int rows, int cols, Orders held) {
  const std::size_t size = index(rows) * index(cols);
  first_A_ = size * index(held.E + 1);
  first_f_ = first_A_ + size * index(held.A + 1);
  entries_.resize(std::max(entries_.size(), first_f_ + index(rows) * index(held.f + 2) + 1));
  row_scale.resize(index(rows));
  row_norm.resize(index(rows));
  for (std::vector<double>& errors : errors_) errors.clear();
  m = rows;
  n = cols;
  orders = held;
}

// Order k times D tau^k / k!, for A and f once more times tau.
void TaylorData::scale_rows_and_measure(double tau) {
  const kernels::ArrayLoops& loops = kernels::loops().arrays;
  const auto scale_rows = [&](double* values, int columns, double factor) {
    for (int i = 0; i < m; ++i) row_factor()[i] = row_scale[index(i)] * factor;
    double norm = 0.0;
    for (int j = 0; j < columns; ++j)
      norm = std::max(norm, loops.scale_entries(values + static_cast<std::ptrdiff_t>(j) * m, row_factor(), m));
    return norm;
  };
  double factor = 1.0;
  for (int k = 0; k <= std::max({orders.E, orders.A, orders.f}); ++k) {
    if (k > 0) factor *= tau / k;
    if (k <= orders.E) norms_.E[index(k)] = scale_rows(E(k).data, n, factor);
    if (k <= orders.A) norms_.A[index(k)] = scale_rows(A(k).data, n, factor * tau);
    if (k <= orders.f) norms_.f[index(k)] = scale_rows(f(k), 1, factor * tau);
  }
}

double TaylorData::row_scale_ratio() const {
  const auto [smallest, largest] = std::minmax_element(row_scale.begin(), row_scale.end());
  return *largest / *smallest;
}

void TaylorData::measure() {
  for (int k = 0; k <= orders.E; ++k) norms_.E[index(k)] = max_abs(E(k));
  for (int k = 0; k <= orders.A; ++k) norms_.A[index(k)] = max_abs(A(k));
}

double TaylorData::growth(const std::array<double, max_derivative_order + 1>& norms, int order) {
  double tau = std::numeric_limits<double>::infinity();
  for (int k = 1; k <= order; ++k)
    if (norms[index(k)] > 0.0 && norms[0] > 0.0) tau = std::min(tau, std::pow(norms[0] / norms[index(k)], 1.0 / k));
  return tau;
}

double TaylorData::growth_time() const { return std::min(growth(norms_.E, orders.E), growth(norms_.A, orders.A)); }

// Smallest time in which one of the coefficients grows as large as that of order 0.
double TaylorData::choose_time_scale() const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double grown_A = growth(norms_.A, orders.A);
  // Rows without E have been scaled separately and do not depend on the unit of time.
  double E0 = norms_.E[0], A0 = 0.0;
  for (int i = 0; i < m; ++i) {
    double row_E = 0.0, row_A = 0.0;
    for (int j = 0; j < n; ++j) {
      row_E = std::max(row_E, std::fabs(E(0)(i, j)));
      row_A = std::max(row_A, std::fabs(A(0)(i, j)));
    }
    if (row_E > 0.0) A0 = std::max(A0, row_A);
  }
  if (E0 == 0.0 || A0 == 0.0) {
    const double grown = E0 == 0.0 ? grown_A : growth(norms_.E, orders.E);
    return grown < infinity ? grown : 1.0;
  }
  const double ratio = E0 / A0;
  const double grown = growth_time();
  return grown < infinity ? std::clamp(grown, shortest_growth * ratio, longest_growth * ratio) : ratio;
}

bool TaylorData::scale(double tau, RowScaling rows, const std::vector<double>* preferred) {
  time_scale = tau > 0.0 ? power_of_two_near(tau) : 1.0;
  choose_row_scale(*this, time_scale, rows, preferred);
  scale_rows_and_measure(time_scale);
  if (norm(std::max(orders.E, orders.A)) > largest_coefficient) return false;
  if (tau == 0.0) {
    rescale_time(power_of_two_near(choose_time_scale()));
    if (time_scale > 1.0 && (rows == RowScaling::each || rows == RowScaling::timed)) balance_rows();
  }
  const double largest = norm(std::max(orders.E, orders.A));
  if (largest > largest_coefficient) return false;
  // A tiny E with its small time scale: one more common factor keeps squares from underflow.
  if (largest > 0.0 && largest < small_data) multiply_all(std::ldexp(1.0, -std::ilogb(largest)));
  return norm_f(orders.f) <= largest_coefficient;
}

// Rows without E have been multiplied by the chosen unit of time.
void TaylorData::balance_rows() {
  std::vector<double> factors(index(m));
  measure_rows(*this, 1.0, factors);
  become_row_factors(factors, RowScaling::each);
  for (int i = 0; i < m; ++i) row_scale[index(i)] *= factors[index(i)];
  const auto multiply = [&](double* values, int columns) {
    double norm = 0.0;
    for (int j = 0; j < columns; ++j)
      norm = std::max(norm, kernels::loops().arrays.scale_entries(values + static_cast<std::ptrdiff_t>(j) * m,
                                                                  factors.data(), m));
    return norm;
  };
  for (int k = 0; k <= std::max({orders.E, orders.A, orders.f}); ++k) {
    if (k <= orders.E) norms_.E[index(k)] = multiply(E(k).data, n);
    if (k <= orders.A) norms_.A[index(k)] = multiply(A(k).data, n);
    if (k <= orders.f) norms_.f[index(k)] = multiply(f(k), 1);
  }
}

void TaylorData::multiply_all(double factor) {
  multiply_entries(entries_.data(), first_f_ + index(m) * index(orders.f + 1), factor);
  multiply_entries(row_scale.data(), index(m), factor);
  multiply_entries(norms_.E.data(), index(orders.E + 1), factor);
  multiply_entries(norms_.A.data(), index(orders.A + 1), factor);
  multiply_entries(norms_.f.data(), index(orders.f + 1), factor);
}

void TaylorData::scale_columns(const Units& factors) {
  const auto scale_all = [&](View block) {
    for (int j = 0; j < n; ++j)
      if (factors[j] != 1.0) multiply_entries(block.column(j), index(m), factors[j]);
  };
  for (int k = 0; k <= orders.E; ++k) scale_all(E(k));
  for (int k = 0; k <= orders.A; ++k) scale_all(A(k));
  for (int k = 0; has_errors('E') && k <= orders.E; ++k) scale_all({errors('E', k), m, n, m});
  for (int k = 0; has_errors('A') && k <= orders.A; ++k) scale_all({errors('A', k), m, n, m});
}

void TaylorData::clear_unused_rows() {
  if (differentiations.empty()) return;
  const auto clear = [this](View block, int k) {
    for (int i = 0; i < m; ++i) {
      if (has_row(i, k)) continue;
      for (int j = 0; j < block.cols; ++j) block(i, j) = 0.0;
    }
  };
  for (int k = 1; k <= orders.E; ++k) clear(E(k), k);
  for (int k = 1; k <= orders.A; ++k) clear(A(k), k);
  for (int k = 1; k <= orders.f; ++k) clear({f(k), m, 1, m}, k);
}

void TaylorData::rescale_time(double factor) {
  time_scale *= factor;
  if (factor == 1.0) return;
  const std::size_t size = index(m) * index(n);
  double power = 1.0;
  for (int k = 0; k <= std::max({orders.E, orders.A, orders.f}); ++k) {
    if (k > 0) {
      power *= factor;
      if (k <= orders.E && norms_.E[index(k)] > 0.0) {
        multiply_entries(E(k).data, size, power);
        norms_.E[index(k)] *= power;
      }
    }
    if (k <= orders.A && norms_.A[index(k)] > 0.0) {
      multiply_entries(A(k).data, size, power * factor);
      norms_.A[index(k)] *= power * factor;
    }
    if (k <= orders.f && norms_.f[index(k)] > 0.0) {
      multiply_entries(f(k), index(m), power * factor);
      norms_.f[index(k)] *= power * factor;
    }
  }
}

double TaylorData::norm(int level) const { return std::max(norm_E(level), norm_A(level)); }

double TaylorData::norm_E(int level) const {
  double largest = 0.0;
  for (int k = 0; k <= std::min(level, orders.E); ++k) largest = std::max(largest, norms_.E[index(k)]);
  return largest;
}

double TaylorData::norm_A(int level) const {
  double largest = 0.0;
  for (int k = 0; k <= std::min(level, orders.A); ++k) largest = std::max(largest, norms_.A[index(k)]);
  return largest;
}

double TaylorData::norm_f(int level) const {
  double largest = least_norm_f;
  for (int k = 0; k <= std::min(level, orders.f); ++k) largest = std::max(largest, norms_.f[index(k)]);
  return largest;
}

double TaylorData::noise(int level) const {
  const double size = norm(level);
  double relative = std::max({unit_roundoff, residual_noise, difference_noise.E});
  for (int k = 1; k <= level && size > 0.0; ++k)
    relative = std::max({relative, largest_scaled_error('E', k) / size, largest_scaled_error('A', k) / size});
  return relative;
}

double TaylorData::noise_f(int level) const {
  const double size = norm_f(level);
  double relative = unit_roundoff;
  for (int k = 1; k <= level && size > 0.0; ++k) relative = std::max(relative, largest_scaled_error('f', k) / size);
  return relative;
}

// ---- Errors of derivatives -------------------------------------------------------------------------------------

double* TaylorData::errors(char which, int order) {
  std::vector<double>& errors = errors_[slot(which)];
  if (errors.empty()) errors.assign(index(highest(which) + 1) * static_cast<std::size_t>(size_of(which)), 0.0);
  return errors.data() + order * size_of(which);
}

const double* TaylorData::errors(char which, int order) const {
  return errors_[slot(which)].data() + order * size_of(which);
}

double TaylorData::error_of_row(char which, int order, int row) const {
  if (order < 1 || order > highest(which) || !has_errors(which)) return 0.0;
  const double* error = errors(which, order) + row;
  double largest = 0.0;
  for (int j = 0; j < (which == 'f' ? 1 : n); ++j, error += m) largest = std::max(largest, *error);
  return largest;
}

double TaylorData::scaled_error(char which, int order, int entry) const {
  if (order < 1 || order > highest(which) || !has_errors(which)) return 0.0;
  return row_scale[index(entry % m)] * factor_of_order(which, order) * errors(which, order)[entry];
}

double TaylorData::scaled_error_of_row(char which, int order, int row) const {
  return row_scale[index(row)] * factor_of_order(which, order) * error_of_row(which, order, row);
}

// tau^k / k!, for A and f once more times tau.
double TaylorData::factor_of_order(char which, int order) const {
  double factor = which == 'E' ? 1.0 : time_scale;
  for (int k = 1; k <= order; ++k) factor *= time_scale / k;
  return factor;
}

void TaylorData::change_by_errors(std::minstd_rand& generator) {
  for (const char which : {'E', 'A', 'f'})
    for (int k = 1; has_errors(which) && k <= highest(which); ++k) {
      double* values = which == 'E' ? E(k).data : which == 'A' ? A(k).data : f(k);
      const double* error = errors(which, k);
      const double factor = factor_of_order(which, k);
      for (std::ptrdiff_t e = 0; e < size_of(which); ++e)
        values[e] +=
            std::copysign(error[e] * factor * row_scale[index(static_cast<int>(e % m))], symmetric_random(generator));
    }
  measure();
}

double TaylorData::largest_scaled_error(char which, int order) const {
  double largest = 0.0;
  for (int i = 0; has_errors(which) && i < m; ++i) largest = std::max(largest, scaled_error_of_row(which, order, i));
  return largest;
}

}  // namespace sfdae::core
