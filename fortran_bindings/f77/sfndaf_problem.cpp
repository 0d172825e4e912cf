// The user's subroutine NARR as a problem of the core.
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/sfndaf_problem.h"

#include <cstddef>

#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::f77 {

SfndafProblem::SfndafProblem(int m, int n)
    : m_(m), n_(n), array_(std::make_shared<core::DerivativeArrayFunction>(m, n, callback, this)) {}

std::unique_ptr<core::CallbackProblem> SfndafProblem::problem() {
  return std::make_unique<core::CallbackProblem>(array_, core::PrescribedInputs());
}

// Along x with derivatives of zero, for the array of order 0. The order stays as it is, as it numbers the columns of
// XJET.
bool SfndafProblem::has_other_width(double t, const double* x) {
  const std::size_t n = core::index(n_), m = core::index(m_), size = m + 2 * m * n;
  if (!core::all_finite(x, n)) return false;
  const auto call = [&](HighWord given, double* values) {
    jet_.assign(x, x + n);
    jet_.resize(2 * n, 0.0);
    return call_user(t, 0, {jet_.data(), values, values + m}, given);
  };
  return sees(HighWord::ones_in_dimension, size, call) || sees(HighWord::ones_in_leading, size, call);
}

int SfndafProblem::evaluate(double t, int order, const double* derivatives, double* F, double* jacobian) {
  const core::ArrayShape shape{m_, n_, order};
  const std::size_t entries = shape.rows() * shape.columns();
  jet_.assign(derivatives, derivatives + shape.columns());
  // An iteration that diverges: the user's subroutine is not called.
  if (!core::all_finite(jet_.data(), jet_.size())) return point_failed;
  if (jacobian == nullptr) {
    unused_.assign(entries, 0.0);
    jacobian = unused_.data();
  }
  const int code = call_user(t, order, {jet_.data(), F, jacobian});
  // If an order is not available, a lower one is requested at the same jet.
  count_point(t, code != order_not_available);
  const bool is_finite = core::all_finite(F, shape.rows()) && core::all_finite(jacobian, entries);
  return result_of(code == function_ok && !is_finite ? function_failed : code);
}

}  // namespace sfdae::f77
