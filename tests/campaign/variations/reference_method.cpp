// SPDX-License-Identifier: BSD-3-Clause
#include "reference_method.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace campaign {

namespace {

constexpr int most_iterations = 30;
constexpr double converged = 1e-12;  // the next change, by quadratic convergence, is then a rounding error
constexpr double least_size = 1e-3;  // changes are measured relative to at least that

// Solves A X = B for several right-hand sides: A n x n, B n x m, both row by row. Rows are scaled before the pivots are
// chosen.
bool solve(std::vector<double> A, std::vector<double>& B, int n, int m) {
  const auto a = [&](int i, int j) -> double& { return A[static_cast<std::size_t>(i * n + j)]; };
  const auto b = [&](int i, int j) -> double& { return B[static_cast<std::size_t>(i * m + j)]; };
  for (int i = 0; i < n; ++i) {
    double largest = 0.0;
    for (int j = 0; j < n; ++j) largest = std::max(largest, std::abs(a(i, j)));
    if (!(largest > 0.0) || !std::isfinite(largest)) return false;
    for (int j = 0; j < n; ++j) a(i, j) /= largest;
    for (int j = 0; j < m; ++j) b(i, j) /= largest;
  }
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i)
      if (std::abs(a(i, k)) > std::abs(a(pivot, k))) pivot = i;
    if (!(std::abs(a(pivot, k)) > 0.0)) return false;
    for (int j = 0; j < n; ++j) std::swap(a(k, j), a(pivot, j));
    for (int j = 0; j < m; ++j) std::swap(b(k, j), b(pivot, j));
    for (int i = k + 1; i < n; ++i) {
      const double factor = a(i, k) / a(k, k);
      if (factor == 0.0) continue;
      for (int j = k; j < n; ++j) a(i, j) -= factor * a(k, j);
      for (int j = 0; j < m; ++j) b(i, j) -= factor * b(k, j);
    }
  }
  for (int k = n - 1; k >= 0; --k) {
    for (int j = 0; j < m; ++j) {
      for (int i = k + 1; i < n; ++i) b(k, j) -= a(k, i) * b(i, j);
      b(k, j) /= a(k, k);
    }
  }
  return true;
}

// The changes have been subtracted from X: whether they are small.
double largest_change(const std::vector<double>& change, const std::vector<double>& X) {
  double largest = 0.0;
  for (std::size_t k = 0; k < X.size(); ++k) {
    const double relative = std::abs(change[k]) / (std::abs(X[k]) + least_size);
    if (!std::isfinite(relative)) return relative;
    largest = std::max(largest, relative);
  }
  return largest;
}

std::vector<Formula> right_side_and_jacobian(const SmallProblem& problem) {
  std::vector<Formula> result = problem.f;
  for (const Formula& f : problem.f)
    for (int j = 0; j < problem.num_states(); ++j) result.push_back(derivative(f, Operation::unknown, j));
  return result;
}

// [HW96] Table IV.5.6.
const double root6 = std::sqrt(6.0);
const std::array<double, 3> c = {(4.0 - root6) / 10.0, (4.0 + root6) / 10.0, 1.0};
const std::array<std::array<double, 3>, 3> A = {
    {{(88.0 - 7.0 * root6) / 360.0, (296.0 - 169.0 * root6) / 1800.0, (-2.0 + 3.0 * root6) / 225.0},
     {(296.0 + 169.0 * root6) / 1800.0, (88.0 + 7.0 * root6) / 360.0, (-2.0 - 3.0 * root6) / 225.0},
     {(16.0 - root6) / 36.0, (16.0 + root6) / 36.0, 1.0 / 9.0}}};

}  // namespace

ReferenceMethod::ReferenceMethod(const SmallProblem& problem)
    : problem_(problem),
      n_(problem.num_states()),
      program_(*problem.formulas, right_side_and_jacobian(problem)),
      values_(static_cast<std::size_t>(n_ + n_ * n_)) {}

void ReferenceMethod::evaluate(double t, const double* x) const { program_.evaluate(t, x, nullptr, values_.data()); }

// Stages X_i: X_i - x - h sum a_ij f(X_j) = 0 for differential states, f(X_i) = 0 for others.
bool ReferenceMethod::step(double t, double h, const std::vector<double>& x, std::vector<double>& end) const {
  const int size = 3 * n_;
  std::vector<double> X, matrix(static_cast<std::size_t>(size * size)), residual(static_cast<std::size_t>(size));
  const auto entry = [&](int i, int j) -> double& { return matrix[static_cast<std::size_t>(i * size + j)]; };
  for (int i = 0; i < 3; ++i) X.insert(X.end(), x.begin(), x.end());
  for (int iteration = 0;; ++iteration) {
    if (iteration == most_iterations) return false;
    std::fill(matrix.begin(), matrix.end(), 0.0);
    for (int i = 0; i < size; ++i) {
      const auto state = static_cast<std::size_t>(i % n_);
      residual[static_cast<std::size_t>(i)] =
          problem_.differential[state] ? X[static_cast<std::size_t>(i)] - x[state] : 0.0;
      if (problem_.differential[state]) entry(i, i) = 1.0;
    }
    for (int j = 0; j < 3; ++j) {
      evaluate(t + c[static_cast<std::size_t>(j)] * h, X.data() + j * n_);
      for (int i = 0; i < size; ++i) {
        const int state = i % n_, stage = i / n_;
        const bool differential = problem_.differential[static_cast<std::size_t>(state)];
        if (!differential && stage != j) continue;
        const double factor =
            differential ? -h * A[static_cast<std::size_t>(stage)][static_cast<std::size_t>(j)] : 1.0;
        residual[static_cast<std::size_t>(i)] += factor * values_[static_cast<std::size_t>(state)];
        for (int k = 0; k < n_; ++k)
          entry(i, j * n_ + k) += factor * values_[static_cast<std::size_t>(n_ + state * n_ + k)];
      }
    }
    if (!solve(matrix, residual, size, 1)) return false;
    for (std::size_t k = 0; k < X.size(); ++k) X[k] -= residual[k];
    const double change = largest_change(residual, X);
    if (!std::isfinite(change)) return false;
    if (change <= converged) break;
  }
  // dX by x: the differential rows depend on it.
  std::vector<double> right(static_cast<std::size_t>(size * n_), 0.0);
  for (int i = 0; i < size; ++i)
    if (problem_.differential[static_cast<std::size_t>(i % n_)])
      right[static_cast<std::size_t>(i * n_ + i % n_)] = 1.0;
  if (!solve(matrix, right, size, n_)) return false;
  transition_.assign(right.end() - n_ * n_, right.end());
  end.assign(X.end() - n_, X.end());
  return true;
}

bool ReferenceMethod::euler_step(double t, double h, const std::vector<double>& x, std::vector<double>& end) const {
  std::vector<double> X = x, matrix(static_cast<std::size_t>(n_ * n_)), residual(static_cast<std::size_t>(n_));
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    evaluate(t + h, X.data());
    for (int i = 0; i < n_; ++i) {
      const auto row = static_cast<std::size_t>(i);
      const bool differential = problem_.differential[row];
      residual[row] = differential ? X[row] - x[row] - h * values_[row] : values_[row];
      for (int k = 0; k < n_; ++k) {
        const double slope = values_[static_cast<std::size_t>(n_ + i * n_ + k)];
        matrix[static_cast<std::size_t>(i * n_ + k)] = differential ? (i == k ? 1.0 : 0.0) - h * slope : slope;
      }
    }
    if (!solve(matrix, residual, n_, 1)) return false;
    for (std::size_t k = 0; k < X.size(); ++k) X[k] -= residual[k];
    const double change = largest_change(residual, X);
    if (!std::isfinite(change)) return false;
    if (change <= converged) {
      end = X;
      return true;
    }
  }
  return false;
}

// Aitken and Neville, [HW96] (IV.9.25): n_j = 1, 2, ..., 6, order 6.
bool ReferenceMethod::extrapolated_step(double t, double h, const std::vector<double>& x,
                                        std::vector<double>& end) const {
  constexpr int columns = 6;
  std::vector<std::vector<double>> row, previous;
  for (int j = 1; j <= columns; ++j) {
    std::vector<double> X = x;
    for (int k = 0; k < j; ++k)
      if (!euler_step(t + k * h / j, h / j, X, X)) return false;
    row = {X};
    for (int k = 1; k < j; ++k) {
      std::vector<double> next = row.back();
      const double ratio = static_cast<double>(j) / (j - k) - 1.0;
      for (std::size_t i = 0; i < next.size(); ++i)
        next[i] += (next[i] - previous[static_cast<std::size_t>(k) - 1][i]) / ratio;
      row.push_back(next);
    }
    previous = row;
  }
  end = row.back();
  return true;
}

}  // namespace campaign
