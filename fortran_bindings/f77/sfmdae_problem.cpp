// The user's subroutines MASS, FORCE, CONSTR and CJAC as a problem of the core.
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/sfmdae_problem.h"

#include <algorithm>
#include <cstddef>

#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::f77 {

std::unique_ptr<core::CallbackMultibody> SfmdaeProblem::problem() {
  sfdae_multibody_problem problem{};
  problem.size = sizeof problem;
  problem.num_positions = problem.num_velocities = nq_;
  problem.num_constraints = nl_;
  problem.mass = of_position<Which::mass>;
  problem.forces = forces;
  if (nl_ > 0) {
    problem.constraints = of_position<Which::constraints>;
    problem.constraint_jacobian = of_position<Which::gradient>;
    problem.constraint_rate = rates;
  }
  problem.user = this;
  return std::make_unique<core::CallbackMultibody>(problem);
}

int SfmdaeProblem::evaluate(Which which, double t, const double* q, const double* v, double* result) {
  const std::size_t nq = core::index(nq_);
  count_point(t, which == Which::forces);
  q_.assign(q, q + nq);
  // An iteration that diverges: nothing to ask the user about.
  if (!core::all_finite(q_.data(), nq)) return point_failed;
  if (v != nullptr) {
    v_.assign(v, v + nq);
    if (!core::all_finite(v_.data(), nq)) return point_failed;
  }
  if (which == Which::gradient) g_t_.assign(core::index(nl_), 0.0);
  const int code = call_user({which, t, q_.data(), v_.data(), result, g_t_.data()});
  const std::size_t rows = core::index(which == Which::mass || which == Which::forces ? nq_ : nl_);
  const bool is_matrix = which == Which::mass || which == Which::gradient;
  bool is_finite = core::all_finite(result, is_matrix ? rows * nq : rows);
  if (which == Which::gradient) {
    gradient_t_ = t;
    gradient_q_.assign(q, q + nq);
    is_finite = is_finite && core::all_finite(g_t_.data(), g_t_.size());
    // What is not known there is not to be used.
    if (code != function_ok || !is_finite) gradient_q_.clear();
  }
  return result_of(code == function_ok && !is_finite ? function_failed : code);
}

int SfmdaeProblem::rate(double t, const double* q, double* g_t) {
  const bool is_known = t == gradient_t_ && gradient_q_.size() == core::index(nq_) &&
                        std::equal(gradient_q_.begin(), gradient_q_.end(), q);
  if (!is_known) {
    unused_.assign(core::index(nl_) * core::index(nq_), 0.0);
    if (const int code = evaluate(Which::gradient, t, q, nullptr, unused_.data()); code != 0) return code;
  }
  std::copy(g_t_.begin(), g_t_.end(), g_t);
  return 0;
}

bool SfmdaeProblem::has_other_width(double t, const double* x) {
  const std::size_t nq = core::index(nq_), nl = core::index(nl_);
  if (!core::all_finite(x, 2 * nq)) return false;
  std::vector<double> q, v, g_t(nl);
  for (const HighWord high_word : {HighWord::ones_in_dimension, HighWord::ones_in_leading})
    for (const Which which : {Which::forces, Which::mass, Which::constraints, Which::gradient}) {
      const bool is_of_constraints = which == Which::constraints || which == Which::gradient;
      const bool is_matrix = which == Which::mass || which == Which::gradient;
      if (is_of_constraints && nl == 0) continue;
      const auto call = [&](HighWord given, double* values) {
        q.assign(x, x + nq);
        v.assign(x + nq, x + 2 * nq);
        return call_user({which, t, q.data(), v.data(), values, g_t.data(), given});
      };
      if (sees(high_word, (is_of_constraints ? nl : nq) * (is_matrix ? nq : 1), call)) return true;
    }
  return false;
}

}  // namespace sfdae::f77
