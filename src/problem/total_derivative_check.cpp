// Comparison of total derivatives that a callback supplies along a jet with differences.
//
//     F^(k)     = d/ds F^(k-1) along the polynomial with the derivatives given, at t + s
//     F_x^(k)   = dF^(k)/dx
//     F_x'^(k)  = dF^(k)/dx' - k F_x^(k-1)
//
// The last two are j = 0 and j = 1 of  dF^(k)/dx^(j) = C(k, j) F_x^(k-j) + C(k, j-1) F_x'^(k-j+1).
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/total_derivative_check.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/index.h"
#include "problem/failure.h"
#include "problem/shifted_jet.h"

namespace sfdae::core {

namespace {

class Checker {
 public:
  Checker(CallbackProblem& problem, double t, const double* derivatives, int max_order)
      : problem_(problem),
        t_(t),
        jet_(derivatives, derivatives + index(problem.n()) * index(max_order + 2)),
        F_(index(problem.m())),
        F_x_(F_.size() * index(problem.n())),
        F_xdot_(F_x_.size()),
        F_x_below_(F_x_.size()) {}

  // False if the order is not available.
  bool check(int order) {
    F_x_below_.swap(F_x_);
    const CallbackError error = call(t_, order, jet_, {F_.data(), F_x_.data(), F_xdot_.data()});
    if (error.status == SFDAE_ORDER_MISSING) return false;
    if (error.status != SFDAE_OK) error.raise();
    if (order > 0) compare_F(order);
    // Jacobians are compared only if F is right.
    for (int j = 0; j < problem_.n() && !worst_.suspicious(); ++j) compare_column('x', order, j);
    for (int j = 0; j < problem_.n() && !worst_.suspicious(); ++j) compare_column('d', order, j);
    return true;
  }

  const DerivativeMismatch& worst() const { return worst_; }

 private:
  CallbackError call(double t, int order, const std::vector<double>& jet, const CallbackProblem::Outputs& to) {
    if (!problem_.stop_is_requested()) return problem_.call(t, order, jet.data(), to);
    CallbackError stopped;
    stopped.status = SFDAE_STOPPED;
    stopped.t = t;
    return stopped;
  }

  void compare_F(int order) {
    const double unit = unit_of_time(t_);
    const auto below = [&](double s, double* values) {
      return call(t_ + s, order - 1, shifted_jet(jet_, index(problem_.n()), s), {values});
    };
    compare_with_differences({'F', order, problem_.m(), 0, F_}, unit, below, worst_);
  }

  void compare_column(char which, int order, int j) {
    const std::vector<double>& supplied = which == 'x' ? F_x_ : F_xdot_;
    const std::ptrdiff_t m = problem_.m(), first = m * j;
    // x_j or x'_j
    const std::size_t position = index(which == 'x' ? 0 : problem_.n()) + index(j);
    const double* F_x_below = which == 'd' && order > 0 ? F_x_below_.data() + first : nullptr;
    std::vector<double> jet(jet_);
    const auto F = [&](double offset, double* values) {
      jet[position] = jet_[position] + offset;
      const CallbackError error = call(t_, order, jet, {values});
      for (int i = 0; i < m && F_x_below != nullptr; ++i) values[i] -= order * offset * F_x_below[i];
      return error;
    };
    compare_with_differences(
        {which, order, problem_.m(), j, {supplied.begin() + first, supplied.begin() + first + m}},
        std::max(1.0, std::fabs(jet_[position])), F, worst_);
  }

  CallbackProblem& problem_;
  double t_;
  std::vector<double> jet_, F_, F_x_, F_xdot_, F_x_below_;
  DerivativeMismatch worst_;
};

}  // namespace

DerivativeMismatch check_total_derivatives(CallbackProblem& problem, double t, const double* derivatives,
                                           int max_order) {
  Checker checker(problem, t, derivatives, max_order);
  // Each order is compared with the one below: no statement is possible beyond the first mistake.
  for (int order = 0; order <= max_order && !checker.worst().suspicious(); ++order)
    if (!checker.check(order)) break;
  return checker.worst();
}

}  // namespace sfdae::core
