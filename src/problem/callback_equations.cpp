// Callbacks with sparsity patterns as equations.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/callback_equations.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/index.h"
#include "problem/differences.h"
#include "problem/factorials.h"

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

// ---- Nonlinear -------------------------------------------------------------------------------------------------

NonlinearEquations::NonlinearEquations(CallbackProblem& problem)
    : PatternedEquations(problem, problem.m(), problem.n()), problem_(problem), F_(index(problem.m())) {}

double NonlinearEquations::noise() const { return has_differences() ? noise_of_differences : 0.0; }

const double* NonlinearEquations::derivatives_of(const double* jet, int order) {
  derivatives_of_jet(jet, index(n()), order, derivatives_);
  return derivatives_.data();
}

CallbackError NonlinearEquations::coefficient(double t, const double* jet, int k, double* F) {
  CallbackError error = problem_.call(t, k, derivatives_of(jet, k + 1), {F});
  for (int i = 0; i < m(); ++i) F[i] /= factorial(k);
  return error;
}

CallbackError NonlinearEquations::coefficient_of_entries(double t, const double* jet, int k, double* F_x,
                                                         double* F_xdot) {
  CallbackError error = problem_.call_entries(t, k, derivatives_of(jet, k + 1), {F_.data(), F_x, F_xdot});
  if (k < 2) return error;
  const double divisor = factorial(k);
  for (int e = 0; e < problem_.patterns()->F_x.entries(); ++e) F_x[e] /= divisor;
  for (int e = 0; e < problem_.patterns()->F_xdot.entries(); ++e) F_xdot[e] /= divisor;
  return error;
}

// ---- Linear ----------------------------------------------------------------------------------------------------

LinearEquations::LinearEquations(LinearProblem& problem)
    : PatternedEquations(problem, problem.m(), problem.n()), problem_(problem) {}

CallbackError LinearEquations::extend(char which, double t, int k, Series& series) {
  const ColumnPattern& pattern = which == 'E' ? problem_.patterns()->F_xdot : problem_.patterns()->F_x;
  const std::size_t count = which == 'f' ? index(m()) : index(pattern.entries());
  while (static_cast<int>(series.coefficients.size()) <= k) {
    const int order = static_cast<int>(series.coefficients.size());
    std::vector<double> values(count, 0.0);
    if (order == 0 || !problem_.is_constant(which)) {
      CallbackError error = which == 'f' ? problem_.call('f', t, order, values.data())
                                         : problem_.call_entries(which, t, order, values.data());
      if (error.status != SFDAE_OK) return error;
    }
    for (double& value : values) value /= factorial(order);
    series.coefficients.push_back(std::move(values));
  }
  return {};
}

CallbackError LinearEquations::extend_all(double t, int k, bool with_f) {
  if (t != known_t_ || problem_.stop_is_requested()) {
    if (!problem_.is_constant('E')) E_.coefficients.clear();
    if (!problem_.is_constant('A')) A_.coefficients.clear();
    f_.coefficients.clear();
    known_t_ = t;
  }
  CallbackError error = extend('E', t, k, E_);
  if (error.status == SFDAE_OK) error = extend('A', t, k, A_);
  if (error.status == SFDAE_OK && with_f) error = extend('f', t, k, f_);
  return error;
}

// F_k = sum_r E_(k-r) (r + 1) x_(r+1) - A_(k-r) x_r - f_k
CallbackError LinearEquations::coefficient(double t, const double* jet, int k, double* F) {
  CallbackError error = extend_all(t, k, true);
  if (error.status != SFDAE_OK) return error;
  for (int i = 0; i < m(); ++i) F[i] = -f_.coefficients[index(k)][index(i)];
  const auto add = [F](const ColumnPattern& pattern, const std::vector<double>& entries, double factor,
                       const double* x) {
    for (int j = 0; j < pattern.columns(); ++j)
      for (int e = pattern.start[index(j)]; e < pattern.start[index(j + 1)]; ++e)
        F[pattern.row[index(e)]] += factor * entries[index(e)] * x[j];
  };
  for (int r = 0; r <= k; ++r) {
    add(problem_.patterns()->F_xdot, E_.coefficients[index(k - r)], r + 1, jet + index(n()) * index(r + 1));
    add(problem_.patterns()->F_x, A_.coefficients[index(k - r)], -1.0, jet + index(n()) * index(r));
  }
  return error;
}

CallbackError LinearEquations::coefficient_of_entries(double t, const double*, int k, double* F_x, double* F_xdot) {
  CallbackError error = extend_all(t, k, false);
  if (error.status != SFDAE_OK) return error;
  const std::vector<double>&E = E_.coefficients[index(k)], &A = A_.coefficients[index(k)];
  std::copy(E.begin(), E.end(), F_xdot);
  std::transform(A.begin(), A.end(), F_x, [](double a) { return -a; });
  return error;
}

std::unique_ptr<RecordedProblem> opaque_problem(std::shared_ptr<PatternedEquations> source, int num_equations,
                                                const JacobianPatterns& patterns, const EquationNames& names) {
  auto record = std::make_shared<const Record>(opaque_record(num_equations, patterns, names));
  auto problem = std::make_unique<RecordedProblem>(std::move(record), source);
  source->set_targets(problem->evaluator().tape(), patterns);
  problem->set_equation_names(names);
  return problem;
}

}  // namespace sfdae::core
