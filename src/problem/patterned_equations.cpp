// User-supplied functions with sparsity patterns as equations.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/patterned_equations.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/index.h"
#include "problem/differences.h"

namespace sfdae::core {

namespace {

// The entry at (row, column) for each column's rows: a lookup while the tape is read, row by row.
std::vector<std::vector<std::pair<int, int>>> entries_by_rows(const ColumnPattern& pattern, int rows) {
  std::vector<std::vector<std::pair<int, int>>> result(index(rows));
  for (int j = 0; j < pattern.columns(); ++j)
    for (int e = pattern.start[index(j)]; e < pattern.start[index(j + 1)]; ++e)
      result[index(pattern.row[index(e)])].push_back({j, e});
  return result;
}

// x(t + s) as the first column, x'(t + s) as the second, of a jet of order 2.
std::vector<double> moved_along(const double* jet, std::size_t n, double s) {
  std::vector<double> moved(2 * n);
  for (std::size_t j = 0; j < n; ++j) {
    moved[j] = jet[j] + s * (jet[n + j] + s * jet[2 * n + j]);
    moved[n + j] = jet[n + j] + 2.0 * s * jet[2 * n + j];
  }
  return moved;
}

// Time in which x changes by about its size; 1 if this is unknown.
double time_of_change(const double* jet, int n) {
  double x = 0.0, slope = 0.0;
  for (int j = 0; j < n; ++j) {
    x = std::max(x, std::fabs(jet[j]));
    slope = std::max(slope, std::fabs(jet[n + j]));
  }
  return x > 0.0 && slope > x ? x / slope : 1.0;
}

}  // namespace

void PatternedEquations::set_targets(const Tape& tape, const JacobianPatterns& patterns) {
  const auto of_F_x = entries_by_rows(patterns.F_x, m_), of_F_xdot = entries_by_rows(patterns.F_xdot, m_);
  places_.clear();
  for (int i = 0; i < m_; ++i)
    for (std::size_t e = tape.first_target[index(i)]; e < tape.first_target[index(i + 1)]; ++e) {
      const Tape::Variable& leaf = tape.targets[e];
      const auto& row = (leaf.derivative ? of_F_xdot : of_F_x)[index(i)];
      const auto found = std::lower_bound(row.begin(), row.end(), std::pair(leaf.unknown, 0));
      places_.push_back({found->second, i, leaf.derivative});
    }
  F_x_.resize(index(patterns.F_x.entries()));
  F_xdot_.resize(index(patterns.F_xdot.entries()));
}

bool PatternedEquations::fail(CallbackError error) {
  if (error.detail.empty()) error.detail = error.message();
  error_ = std::move(error);
  return false;
}

bool PatternedEquations::values(double t, const double* jet, int order, double* F) {
  for (int k = 0; k <= order; ++k) {
    double* const F_k = F + index(m_) * index(k);
    CallbackError error = coefficient(t, jet, k, F_k);
    if (error.status == SFDAE_ORDER_MISSING && k == 1 && differences_in_time_)
      error = difference_in_time(t, jet, F_k);
    if (error.status != SFDAE_OK) return fail(std::move(error));
  }
  return true;
}

// Difference by five points, one-sided near limits of t.
CallbackError PatternedEquations::difference_in_time(double t, const double* jet, double* F_1) {
  constexpr int points = 5;
  constexpr double part = 1e-3;  // near eps^(1/5): of the error of truncation and that of rounding the sum is least
  double step = part * time_of_change(jet, n_);
  const double below = base_.room(t, -1.0), above = base_.room(t, 1.0);
  const int shift = below >= 2 * step && above >= 2 * step ? 2 : above >= below ? 0 : points - 1;
  std::vector<double> nodes;
  for (int k = 0; k < points; ++k) nodes.push_back((k - shift) * step);
  const std::vector<double> weights = difference_weights(0.0, nodes, 1);
  std::vector<double> F(index(m_));
  std::fill_n(F_1, m_, 0.0);
  for (int k = 0; k < points; ++k) {
    const double weight = weights[index(points + k)];
    if (weight == 0.0) continue;
    const std::vector<double> moved = moved_along(jet, index(n_), nodes[index(k)]);
    CallbackError error = coefficient(t + nodes[index(k)], moved.data(), 0, F.data());
    if (error.status != SFDAE_OK) return error;
    for (int i = 0; i < m_; ++i) F_1[i] += weight * F[index(i)];
  }
  return {};
}

bool PatternedEquations::entries(double t, const double* jet, int order, const std::vector<int>& limits,
                                 double* values) {
  const int highest = std::min(order, limits.empty() ? -1 : *std::max_element(limits.begin(), limits.end()));
  const std::size_t length = index(order + 1);
  for (int k = 0; k <= highest; ++k) {
    CallbackError error = coefficient_of_entries(t, jet, k, F_x_.data(), F_xdot_.data());
    if (error.status != SFDAE_OK) return fail(std::move(error));
    for (std::size_t e = 0; e < places_.size(); ++e) {
      const auto [entry, equation, derivative] = places_[e];
      if (k <= limits[index(equation)]) values[e * length + index(k)] = (derivative ? F_xdot_ : F_x_)[index(entry)];
    }
  }
  return true;
}

}  // namespace sfdae::core
