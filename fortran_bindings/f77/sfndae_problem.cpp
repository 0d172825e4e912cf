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

// Along x with derivatives of zero. The order stays as it is: columns of XJET are numbered by it.
bool SfndaeProblem::has_other_width(double t, const double* x) {
  const std::size_t n = core::index(n_), m = core::index(m_), area = m * n;
  if (!core::all_finite(x, n)) return false;
  const auto call = [&](HighWord given, double* values) {
    jet_.assign(x, x + n);
    jet_.resize(2 * n, 0.0);
    return call_user(t, 0, {jet_.data(), values, values + m, values + m + area}, given);
  };
  return sees(HighWord::ones_in_dimension, m + 2 * area, call) || sees(HighWord::ones_in_leading, m + 2 * area, call);
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
