// Comparison of derivatives that callbacks of a mechanical system supply with differences.
//
//     g_q, g_t            of g
//     s = (gamma, eta)    of C v + r along (t + s, q + s S v), v held
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_derivative_check.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

class Checker {
 public:
  Checker(CallbackMultibody& problem, double t, const double* q, const double* v)
      : problem_(problem),
        t_(t),
        q_(q, q + sizes().positions),
        v_(v, v + sizes().velocities),
        terms_(sizes()),
        moved_terms_(sizes()),
        moved_q_(q_) {
    const CallbackError error = problem_.at_velocity(t_, q_.data(), v_.data(), terms_);
    if (error.status != SFDAE_OK) error.raise();
  }

  DerivativeMismatch worst() {
    check_gradient();
    check_rate();
    // Higher derivatives are compared only if g_q and g_t are right.
    if (!worst_.suspicious()) check_curvatures();
    return worst_;
  }

 private:
  const MultibodySizes& sizes() const { return problem_.sizes(); }

  void check_gradient() {
    const int nl = sizes().holonomic;
    for (int j = 0; nl > 0 && j < sizes().positions; ++j) {
      const double* const column = terms_.g_q.view().column(j);
      const auto g = [&](double offset, double* values) {
        moved_q_ = q_;
        moved_q_[index(j)] += offset;
        return problem_.constraints(t_, moved_q_.data(), values);
      };
      compare_with_differences({'G', 1, nl, j, {column, column + nl}}, std::max(1.0, std::fabs(q_[index(j)])), g,
                               worst_);
    }
  }

  void check_rate() {
    const int nl = sizes().holonomic;
    if (nl == 0) return;
    const std::vector<double> g_t(terms_.velocity_rest.begin(), terms_.velocity_rest.begin() + nl);
    const auto g = [&](double offset, double* values) {
      return problem_.constraints(t_ + offset, q_.data(), values);
    };
    compare_with_differences({'T', 1, nl, 0, g_t}, unit_of_time(t_), g, worst_);
  }

  void check_curvatures() {
    const int nl = sizes().holonomic, nk = sizes().nonholonomic;
    if (nl > 0 && problem_.functions().constraint_curvature != nullptr) check_curvature('C', 0, nl);
    if (nk > 0 && problem_.functions().nonholonomic_curvature != nullptr) check_curvature('H', nl, nk);
  }

  // Rows of s from the first one.
  void check_curvature(char name, int first, int rows) {
    std::vector<double> velocity(v_), residual(index(sizes().constraints()));
    if (problem_.has_kinematics()) {
      velocity.resize(q_.size());
      multiply(1.0, Op::plain, terms_.S, v_.data(), 0.0, velocity.data());
    }
    double unit = unit_of_time(t_);
    for (std::size_t j = 0; j < q_.size(); ++j)
      if (velocity[j] != 0.0) unit = std::min(unit, std::max(1.0, std::fabs(q_[j])) / std::fabs(velocity[j]));
    const auto of_velocities = [&](double offset, double* values) {
      for (std::size_t j = 0; j < q_.size(); ++j) moved_q_[j] = q_[j] + offset * velocity[j];
      const CallbackError error = problem_.at_position(t_ + offset, moved_q_.data(), moved_terms_);
      residual = moved_terms_.velocity_rest;
      multiply(1.0, Op::plain, moved_terms_.C, v_.data(), 1.0, residual.data());
      std::copy_n(residual.begin() + first, rows, values);
      return error;
    };
    const auto s = terms_.acceleration_rest.begin() + first;
    compare_with_differences({name, 1, rows, 0, {s, s + rows}}, unit, of_velocities, worst_);
  }

  CallbackMultibody& problem_;
  double t_;
  std::vector<double> q_, v_;
  MultibodyTerms terms_, moved_terms_;
  std::vector<double> moved_q_;
  DerivativeMismatch worst_;
};

}  // namespace

DerivativeMismatch check_multibody_derivatives(CallbackMultibody& problem, double t, const double* q,
                                               const double* v) {
  return Checker(problem, t, q, v).worst();
}

}  // namespace sfdae::core
