// Callbacks with sparsity patterns as equations.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/callback_equations.h"

#include <algorithm>
#include <utility>

#include "linalg/index.h"
#include "problem/factorials.h"

namespace sfdae::core {

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
