// One step of the states of a small problem by Radau IIA with three stages, or by extrapolation of the implicit Euler
// method; Newton's method in full in both.
// [HW96] E. Hairer, G. Wanner: Solving Ordinary Differential Equations II. Springer, 1996. IV.5 and IV.9.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "program.h"
#include "small_problem.h"

namespace campaign {

// Steps return false if Newton's method did not converge.
class ReferenceMethod {
 public:
  explicit ReferenceMethod(const SmallProblem& problem);

  bool step(double t, double h, const std::vector<double>& x, std::vector<double>& end) const;
  // d(end) / dx of the last step, row by row.
  const std::vector<double>& transition() const { return transition_; }

  // A second method, to judge the first: extrapolated implicit Euler steps, h, h/2, ..., h/6.
  bool extrapolated_step(double t, double h, const std::vector<double>& x, std::vector<double>& end) const;

 private:
  bool euler_step(double t, double h, const std::vector<double>& x, std::vector<double>& end) const;
  void evaluate(double t, const double* x) const;

  const SmallProblem& problem_;
  int n_;
  Program program_;  // f, then f_x row by row
  mutable std::vector<double> values_, transition_;
};

}  // namespace campaign
