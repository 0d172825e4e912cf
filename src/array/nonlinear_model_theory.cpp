// Objects of the theory for a nonlinear problem.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "array/nonlinear_model.h"
#include "starts/jet_theory.h"

namespace sfdae::core {

// Derivatives that F_level = 0 leaves undetermined are those of the last accepted point, whatever other points were
// requested, so that objects of the same jet fit each other.
Jet NonlinearModel::jet_through(double t, const double* x, int level) {
  const WithoutStructure whole(*problem_);
  const int mu = system_->analysis().values.mu;
  Jet jet = system_->accepted_jet();
  jet.t = t;
  std::copy_n(x, n(), jet.column(0));
  jet = core::jet_through(*problem_, system_->units(), jet, std::max(level, mu));
  jet.set_order(level + 1);
  return jet;
}

DerivativeArray NonlinearModel::derivative_array(const Jet& jet, int level) {
  const WithoutStructure whole(*problem_);
  return core::derivative_array(*problem_, jet, level);
}

Projectors NonlinearModel::projectors(const Jet& jet, bool) {
  const WithoutStructure whole(*problem_);
  IndexAnalysis known = system_->analysis();
  // Ranks of an array with fewer rows do not apply here.
  if (whole.changes_rows()) known.certified_ranks = {};
  return core::projectors(*problem_, system_->units(), known, system_->settings(), jet);
}

StrangenessFreeEquations NonlinearModel::strangeness_free(const Jet& jet) {
  return strangeness_free_equations(derivative_array(jet, system_->analysis().values.mu), projectors(jet, true));
}

Jet NonlinearModel::accepted_point() const {
  Jet jet = system_->accepted_jet();
  jet.set_order(0);
  return jet;
}

}  // namespace sfdae::core
