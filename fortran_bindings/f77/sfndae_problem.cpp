// The user's subroutine NDIF as a problem of the core.
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/sfndae_problem.h"

#include <cstddef>

#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::f77 {

std::unique_ptr<core::CallbackProblem> SfndaeProblem::problem() {
  return std::make_unique<core::CallbackProblem>(m_, n_, callback, this, core::PrescribedInputs());
}

int SfndaeProblem::evaluate(double t, int order, const double* derivatives, Arrays arrays) {
  const std::size_t n = core::index(n_), area = core::index(m_) * n;
  count_point(t, order == 0);
  jet_.assign(derivatives, derivatives + n * core::index(order + 2));
  // An iteration that diverges: nothing to ask the user about.
  if (!core::all_finite(jet_.data(), jet_.size())) return point_failed;
  arrays.jet = jet_.data();
  const auto replace = [area](double*& wanted, std::vector<double>& unused) {
    if (wanted != nullptr) return;
    unused.assign(area, 0.0);
    wanted = unused.data();
  };
  replace(arrays.F_x, unused_x_);
  replace(arrays.F_xdot, unused_xdot_);
  const int code = call_user(t, order, arrays);
  const bool is_finite = core::all_finite(arrays.F, core::index(m_)) && core::all_finite(arrays.F_x, area) &&
                         core::all_finite(arrays.F_xdot, area);
  return result_of(code == function_ok && !is_finite ? function_failed : code);
}

}  // namespace sfdae::f77
