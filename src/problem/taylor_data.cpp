// Taylor coefficients of a linear problem at one point: scaling.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/taylor_data.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/index.h"
#include "linalg/rank.h"

namespace sfdae::core {

namespace {

// Products of a few scaled coefficients must stay finite.
constexpr double largest_coefficient = 1e60;

// Scaling by it rounds nothing. Units of time beyond 1e39 would make right-hand sides overflow.
double power_of_two_near(double x) {
  return std::ldexp(1.0, std::clamp(static_cast<int>(std::lround(std::log2(x))), -900, 130));
}

void multiply_entries(double* values, std::size_t count, double factor) {
  for (std::size_t i = 0; i < count; ++i) values[i] *= factor;
}

}  // namespace

void TaylorData::resize(int rows, int cols, Orders held) {
  m = rows;
  n = cols;
  orders = held;
  const std::size_t size = index(rows) * index(cols);
  E_.resize(std::max(E_.size(), size * index(held.E + 1)));
  A_.resize(std::max(A_.size(), size * index(held.A + 1)));
  f_.resize(std::max(f_.size(), index(rows) * index(held.f + 1) + 1));
  row_scale.resize(index(rows));
  row_norm.resize(index(rows));
  row_factor_.resize(index(rows));
}

void TaylorData::choose_row_scale(RowScaling rows, const std::vector<double>* preferred) {
  std::fill(row_scale.begin(), row_scale.end(), 0.0);
  const auto raise = [this](ConstView a) {
    for (int j = 0; j < n; ++j) {
      const double* column = a.column(j);
      for (int i = 0; i < m; ++i) row_scale[index(i)] = std::max(row_scale[index(i)], std::fabs(column[i]));
    }
  };
  raise(E(0));
  raise(A(0));
  // A row that vanishes at this point only is measured by its derivatives.
  if (*std::min_element(row_scale.begin(), row_scale.end()) == 0.0) {
    const std::vector<double> at_point = row_scale;
    for (int k = 1; k <= orders.E; ++k) raise(E(k));
    for (int k = 1; k <= orders.A; ++k) raise(A(k));
    for (int i = 0; i < m; ++i)
      if (at_point[index(i)] != 0.0) row_scale[index(i)] = at_point[index(i)];
  }
  row_norm = row_scale;
  const double largest = *std::max_element(row_scale.begin(), row_scale.end());
  // Powers of two that bring the largest row to [1, 2) and the others to once or twice that: a common factor of all rows
  // changes nothing but a common factor.
  const auto power = [](int exponent) { return std::ldexp(1.0, std::clamp(exponent, -1020, 1020)); };
  const int top = largest == 0.0 ? 0 : std::ilogb(largest);
  const double top_mantissa = std::ldexp(largest, -top);
  for (double& size : row_scale) {
    if (size == 0.0 || rows == RowScaling::common) {
      size = power(-top);
      continue;
    }
    const int exponent = std::ilogb(size);
    size = power(-exponent + (std::ldexp(size, -exponent) < top_mantissa ? 1 : 0));
  }
  if (preferred == nullptr || rows == RowScaling::common) return;
  constexpr double about_right = 8.0;
  for (int i = 0; i < m; ++i) {
    const double ratio = row_scale[index(i)] / (*preferred)[index(i)];
    if (!(ratio >= 1.0 / about_right && ratio <= about_right)) return;
  }
  row_scale = *preferred;
}

// Order k times D tau^k / k!, for A and f once more times tau.
void TaylorData::scale_rows_and_measure(double tau) {
  const auto scale_rows = [this](double* values, int columns, double factor) {
    for (int i = 0; i < m; ++i) row_factor_[index(i)] = row_scale[index(i)] * factor;
    double norm = 0.0;
    for (int j = 0; j < columns; ++j) {
      double* __restrict column = values + static_cast<std::ptrdiff_t>(j) * m;
      const double* __restrict factors = row_factor_.data();
      for (int i = 0; i < m; ++i) column[i] *= factors[i];
      norm = std::max(norm, max_abs(column, m));
    }
    return norm;
  };
  double factor = 1.0;
  for (int k = 0; k <= std::max({orders.E, orders.A, orders.f}); ++k) {
    if (k > 0) factor *= tau / k;
    if (k <= orders.E) norm_E_[index(k)] = scale_rows(E(k).data, n, factor);
    if (k <= orders.A) norm_A_[index(k)] = scale_rows(A(k).data, n, factor * tau);
    if (k <= orders.f) norm_f_[index(k)] = scale_rows(f(k), 1, factor * tau);
  }
}

double TaylorData::row_scale_ratio() const {
  const auto [smallest, largest] = std::minmax_element(row_scale.begin(), row_scale.end());
  return *largest / *smallest;
}

void TaylorData::measure() {
  for (int k = 0; k <= orders.E; ++k) norm_E_[index(k)] = max_abs(E(k));
  for (int k = 0; k <= orders.A; ++k) norm_A_[index(k)] = max_abs(A(k));
}

// Smallest time in which one of the coefficients grows as large as that of order 0.
double TaylorData::choose_time_scale() const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const auto growth = [](const auto& norms, int order) {
    double tau = infinity;
    for (int k = 1; k <= order; ++k)
      if (norms[index(k)] > 0.0 && norms[0] > 0.0) tau = std::min(tau, std::pow(norms[0] / norms[index(k)], 1.0 / k));
    return tau;
  };
  const double grown_A = growth(norm_A_, orders.A);
  // Rows without E have been scaled for themselves: they say nothing about time.
  double E0 = norm_E_[0], A0 = 0.0;
  for (int i = 0; i < m; ++i) {
    double row_E = 0.0, row_A = 0.0;
    for (int j = 0; j < n; ++j) {
      row_E = std::max(row_E, std::fabs(E(0)(i, j)));
      row_A = std::max(row_A, std::fabs(A(0)(i, j)));
    }
    if (row_E > 0.0) A0 = std::max(A0, row_A);
  }
  if (E0 == 0.0 || A0 == 0.0) {
    const double grown = E0 == 0.0 ? grown_A : growth(norm_E_, orders.E);
    return grown < infinity ? grown : 1.0;
  }
  const double ratio = E0 / A0;
  const double grown = std::min(growth(norm_E_, orders.E), grown_A);
  return grown < infinity ? std::clamp(grown, 0.1 * ratio, 1e3 * ratio) : ratio;
}

bool TaylorData::scale(double tau, RowScaling rows, const std::vector<double>* preferred) {
  choose_row_scale(rows, preferred);
  time_scale = tau > 0.0 ? power_of_two_near(tau) : 1.0;
  scale_rows_and_measure(time_scale);
  if (norm(std::max(orders.E, orders.A)) > largest_coefficient) return false;
  if (tau == 0.0) rescale_time(power_of_two_near(choose_time_scale()));
  const double largest = norm(std::max(orders.E, orders.A));
  if (largest > largest_coefficient) return false;
  // A tiny E with its small time scale: one more common factor keeps squares from underflow.
  if (largest > 0.0 && largest < 0.125) multiply_all(std::ldexp(1.0, -std::ilogb(largest)));
  return norm_f(orders.f) <= largest_coefficient;
}

void TaylorData::multiply_all(double factor) {
  const std::size_t size = index(m) * index(n);
  multiply_entries(E_.data(), size * index(orders.E + 1), factor);
  multiply_entries(A_.data(), size * index(orders.A + 1), factor);
  multiply_entries(f_.data(), index(m) * index(orders.f + 1), factor);
  multiply_entries(row_scale.data(), index(m), factor);
  multiply_entries(norm_E_.data(), index(orders.E + 1), factor);
  multiply_entries(norm_A_.data(), index(orders.A + 1), factor);
  multiply_entries(norm_f_.data(), index(orders.f + 1), factor);
}

void TaylorData::scale_columns(const Units& factors) {
  const auto scale_all = [&](View block) {
    for (int j = 0; j < n; ++j)
      if (factors[j] != 1.0) multiply_entries(block.column(j), index(m), factors[j]);
  };
  for (int k = 0; k <= orders.E; ++k) scale_all(E(k));
  for (int k = 0; k <= orders.A; ++k) scale_all(A(k));
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
      if (k <= orders.E && norm_E_[index(k)] > 0.0) {
        multiply_entries(E(k).data, size, power);
        norm_E_[index(k)] *= power;
      }
    }
    if (k <= orders.A && norm_A_[index(k)] > 0.0) {
      multiply_entries(A(k).data, size, power * factor);
      norm_A_[index(k)] *= power * factor;
    }
    if (k <= orders.f && norm_f_[index(k)] > 0.0) {
      multiply_entries(f(k), index(m), power * factor);
      norm_f_[index(k)] *= power * factor;
    }
  }
}

double TaylorData::norm(int level) const { return std::max(norm_E(level), norm_A(level)); }

double TaylorData::norm_E(int level) const {
  double largest = 0.0;
  for (int k = 0; k <= std::min(level, orders.E); ++k) largest = std::max(largest, norm_E_[index(k)]);
  return largest;
}

double TaylorData::norm_A(int level) const {
  double largest = 0.0;
  for (int k = 0; k <= std::min(level, orders.A); ++k) largest = std::max(largest, norm_A_[index(k)]);
  return largest;
}

double TaylorData::norm_f(int level) const {
  double largest = least_norm_f;
  for (int k = 0; k <= std::min(level, orders.f); ++k) largest = std::max(largest, norm_f_[index(k)]);
  return largest;
}

double TaylorData::noise(int level) const {
  // Errors of the coefficients of order k relative to the norm of all.
  const double size = norm(level);
  double relative = std::max(unit_roundoff, residual_noise), factor = 1.0;
  for (int k = 1; k <= level && size > 0.0; ++k) {
    factor *= time_scale / k;
    const double absolute = std::max(error_E[index(k)] * norm_E_[0], error_A[index(k)] * norm_A_[0]);
    relative = std::max(relative, absolute * factor / size);
  }
  return relative;
}

double TaylorData::noise_f(int level) const {
  const double size = norm_f(level);
  double relative = unit_roundoff, factor = 1.0;
  for (int k = 1; k <= std::min(level, orders.f) && size > 0.0; ++k) {
    factor *= time_scale / k;
    relative = std::max(relative, error_f[index(k)] * norm_f_[0] * factor / size);
  }
  return relative;
}

}  // namespace sfdae::core
