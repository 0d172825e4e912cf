// SPDX-License-Identifier: BSD-3-Clause
#include "linear/linear_values.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/matrix.h"
#include "linalg/units.h"
#include "linear/linear_point.h"
#include "reduction/null_space_form.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

double length(const Vector& v) {
  double sum = 0.0;
  const double scale = max_abs({v.data(), static_cast<int>(v.size()), 1, 1});
  if (scale == 0.0) return 0.0;
  for (double entry : v) sum += (entry / scale) * (entry / scale);
  return scale * std::sqrt(sum);
}

}  // namespace

ConstrainedPoint constraints_of(LinearSystem& system) {
  const LinearPoint& point = system.point();
  return {
      point.form, point.data,         system.problem().units(), point.rank_E, point.kept_constraints * point.pivot,
      nullptr,    point.form.kernel()};
}

ConsistencyResult make_consistent(LinearSystem& system, const ConsistencyRequest& request, Vector& user_x) {
  return make_consistent(system, constraints_of(system), request, user_x);
}

ConsistencyResult make_consistent(LinearSystem& system, const ConstrainedPoint& constraints,
                                  const ConsistencyRequest& request, Vector& user_x) {
  const NullSpaceForm& form = system.point().form;
  const std::size_t n = index(form.n);
  // Norms and reports are the user's.
  const Units& units = system.problem().units();
  const auto violation_of = [&](const Vector& values) {
    Vector scaled(values);
    for (std::size_t i = 0; i < n; ++i) scaled[i] /= units[i];
    Vector r = violation(form, scaled);
    for (std::size_t i = 0; i < n; ++i) r[i] *= units[i];
    return length(r);
  };
  ConsistencyResult result;
  result.residual_before = violation_of(user_x);
  const Vector consistent = consistent_point(constraints, request, user_x);
  report_change(request, system.t(), user_x, consistent, result);
  if (request.kind != InitialValues::accept) user_x = consistent;
  result.residual_after = request.kind == InitialValues::accept ? result.residual_before : violation_of(user_x);
  return result;
}

}  // namespace sfdae::core
