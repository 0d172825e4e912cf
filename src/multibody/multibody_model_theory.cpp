// Objects of the theory for a mechanical system.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "linalg/index.h"
#include "multibody/multibody_model.h"
#include "problem/failure.h"
#include "starts/jet_theory.h"

namespace sfdae::core {

RecordedProblem& MultibodyModel::first_order_problem() {
  if (recorded_ == nullptr)
    throw Failure(
        SFDAE_ORDER_MISSING,
        "callbacks of mechanical systems provide no derivatives for arrays of level 1 and above, nor for jets, "
        "Z2 and Z3 of these: write the system as formulas (equations).");
  if (!first_order_) first_order_ = recorded_->first_order_problem();
  return *first_order_;
}

Jet MultibodyModel::jet_through(double t, const double* x, int level) {
  Jet jet;
  jet.t = t;
  jet.n = n();
  jet.x.assign(x, x + n());
  const std::vector<double> xdot = theory_at(t, x).derivative(*problem_);
  jet.x.insert(jet.x.end(), xdot.begin(), xdot.end());
  jet.order = 1;
  if (level == 0 && recorded_ == nullptr) return jet;
  // Starts at level 0: the values computed so far are only an initial guess.
  jet = core::jet_through(first_order_problem(), {}, jet, std::max(level, system_->analysis().values.mu));
  jet.set_order(level + 1);
  return jet;
}

DerivativeArray MultibodyModel::derivative_array(const Jet& jet, int level) {
  if (level == 0 && recorded_ == nullptr) return array_of_level_0(*problem_, jet);
  return core::derivative_array(first_order_problem(), jet, level);
}

// The derivative array does not contain the least norm of multipliers: that many columns of Z2 are zero.
Projectors MultibodyModel::projectors(const Jet& jet, bool of_array) {
  const MultibodyTheory theory = theory_at(jet.t, jet.column(0));
  Projectors result;
  if (of_array) {
    const int a = system_->analysis().values.a;
    IndexAnalysis known = system_->analysis();
    known.values.a -= problem_->sizes().constraints() - system_->settings().ranks.velocities;
    known.time_scale = 0.0;
    known.v_hat = -1;
    result = core::projectors(first_order_problem(), {}, known, {}, jet);
    Matrix Z2(result.Z2.rows(), a);
    copy(result.Z2, Z2.view().columns(0, known.values.a));
    result.Z2 = std::move(Z2);
  }
  result.Z1 = theory.Z1();
  result.T2 = theory.T2();
  return result;
}

StrangenessFreeEquations MultibodyModel::strangeness_free(const Jet& jet) {
  const MultibodyTheory theory = theory_at(jet.t, jet.column(0));
  const DerivativeArray array = array_of_level_0(*problem_, jet);
  const Matrix Z1 = theory.Z1();
  const int nq = problem_->sizes().positions, nv = problem_->sizes().velocities;
  const ConstView g{array.g.data(), m(), 1, m()};
  return {transpose_product(Z1, array.M),     transpose_product(Z1, array.N), transpose_product(Z1, g), theory.A2(),
          theory.f2(jet.column(0) + nq + nv), theory.redundant_residual()};
}

Jet MultibodyModel::accepted_point() const {
  const MultibodyPoint& point = system_->accepted_point();
  Jet jet;
  jet.t = point.t;
  jet.n = n();
  jet.x = point.q;
  jet.x.insert(jet.x.end(), point.v.begin(), point.v.end());
  jet.x.insert(jet.x.end(), point.mu.begin(), point.mu.begin() + problem_->sizes().constraints());
  return jet;
}

ExtendedSystem MultibodyModel::extended_system(double t, const double* x) {
  return theory_at(t, x).extended(system_->position_partition(), system_->partition(), x);
}

}  // namespace sfdae::core
