// The user's subroutine NDIF as a problem of the core.
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/sfndae_problem.h"

#include <cstddef>

namespace sfdae::f77 {

sfdae_nonlinear_problem SfndaeProblem::callbacks() {
  sfdae_nonlinear_problem problem{};
  problem.size = sizeof problem;
  problem.num_equations = m_;
  problem.num_unknowns = n_;
  problem.total_derivative = callback;
  problem.user = this;
  return problem;
}

int SfndaeProblem::evaluate(double t, int order, const double* derivatives, Arrays arrays) {
  const std::size_t n = static_cast<std::size_t>(n_), area = static_cast<std::size_t>(m_) * n;
  count_point(t, order == 0);
  jet_.assign(derivatives, derivatives + n * static_cast<std::size_t>(order + 2));
  arrays.jet = jet_.data();
  const auto replace = [area](double*& wanted, std::vector<double>& unused) {
    if (wanted != nullptr) return;
    unused.assign(area, 0.0);
    wanted = unused.data();
  };
  replace(arrays.F_x, unused_x_);
  replace(arrays.F_xdot, unused_xdot_);
  return result_of(call_user(t, order, arrays));
}

}  // namespace sfdae::f77
