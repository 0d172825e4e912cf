// Collocation polynomial of the last step of a Radau method: the solution within the step.
//
// u of degree s interpolates the start and the stages. Its error within the step is O(h^(s+1)), with known leading term
// for w: w' - u' = (w' - u')(start) M(tau) / M(0), M(tau) = prod (tau - c_i). Therefore adding
//
//     h (w' - u')(start) Q(tau),   Q(tau) = integral of M / M(0) from 0 to tau,   Q(0) = Q(1) = 0,
//
// gains an order if the equations are not stiff (docs/design/error_control.md). The factor is the embedded error of the
// step, Radau's own estimate.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "integrate/radau_stages.h"
#include "linalg/archive.h"

namespace sfdae::core {

// Errors of the polynomial according to the error estimate of the step: maxima within the step, in units of the
// weights.
struct InteriorErrors {
  double w = std::numeric_limits<double>::infinity();  // of w, mapped to x: not determined by constraints
  double x = std::numeric_limits<double>::infinity();  // of all components
  std::vector<double> correction_w, correction_x;      // h (w' - u')(start), and mapped to x
};

class RadauPolynomial {
 public:
  void resize(std::size_t n, std::size_t size_w, int most_stages);
  void forget() { s_ = 0; }
  // Sets the polynomial of an accepted step from `start`.
  void set(const RadauNode& start, const RadauStep& step, const InteriorErrors& errors);

  // 0: no polynomial.
  int stages() const { return s_; }
  // x at the start, i = 0, and at the stages.
  const double* x_at(int i) const { return x_.data() + size_x_ * index(i); }
  double error_of_w() const { return error_w_; }
  double error_of_x() const { return error_x_; }
  // Notes the error found by comparison with a point within the step, or 0.
  void note_test(double error) {
    is_tested_ = true;
    error_w_ = std::max(error_w_, error);
    error_x_ = std::max(error_x_, error);
  }
  bool is_tested() const { return is_tested_; }

  // xdot may be null.
  void evaluate_x(double t, double* x, double* xdot) const;
  void evaluate_w(double t, double* w) const;
  // Taylor coefficients of x at t: n x (order + 1).
  void taylor(double t, int order, double* coefficients) const;

  // s: that of the last step. with_w: otherwise w is part of x.
  void archive(Archive& archive, int s, bool with_w);

 private:
  double scaled(double t) const { return (t - t_) / h_; }

  int s_ = 0;
  double t_ = 0.0, h_ = 1.0;
  double error_w_ = std::numeric_limits<double>::infinity(), error_x_ = std::numeric_limits<double>::infinity();
  bool is_tested_ = false;
  // At the start, at the stages, and the correction: s + 2 columns.
  std::size_t size_x_ = 0, size_w_ = 0;
  std::vector<double> x_, w_;
};

}  // namespace sfdae::core
