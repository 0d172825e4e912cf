// Structural test that rules out singular points of recorded equations.
// SPDX-License-Identifier: BSD-3-Clause
#include "array/structural_witness.h"

#include <algorithm>
#include <cmath>

namespace sfdae::core {

namespace {

// A determinant that keeps more than this fraction of the smaller one at the ends has not fallen, as for kept values
// (docs/design/singular_points.md).
constexpr double determinant_not_fallen = 0.7;

}  // namespace

bool StructuralWitness::is_confirmed_at(const AnalyzedEquations& equations, const Jet& jet) {
  const CharacteristicValues& known = equations.analysis().values;
  if (known.u != 0 || known.v != 0 || structure_->offsets.freedom() != known.d) return false;
  Certificate certificate;
  return certify_structure(*structure_, *equations.problem().structure_evaluator(), {jet.t, jet.x.data()},
                           equations.settings().rank_tol, certificate) &&
         certificate.is_given();
}

StructuralWitness::StructuralWitness(const AnalyzedEquations& equations, const Jet& jet) {
  NonlinearProblem& problem = equations.problem();
  structure_ = problem.structure();
  if (structure_ == nullptr || !problem.prescribed().empty()) return;
  TaylorEvaluator& evaluator = *problem.structure_evaluator();
  if (evaluator.has_source() || !is_confirmed_at(equations, jet)) return;
  jacobian_ = std::make_unique<SystemJacobian>(*structure_, evaluator.tape());
  determinants_ = std::make_unique<BlockDeterminants>(*structure_, *jacobian_, evaluator);
}

bool StructuralWitness::measure(const Jet& jet, const Jet& before, const Jet& after) {
  return determinants_ && determinants_->measure(before.t, before.x.data(), before_) &&
         determinants_->measure(after.t, after.x.data(), after_) &&
         determinants_->measure(jet.t, jet.x.data(), here_);
}

bool StructuralWitness::keeps_signs(const Jet& jet, const Jet& before, const Jet& after) {
  if (!measure(jet, before, after)) return false;
  for (std::size_t k = 0; k < here_.size(); ++k)
    if (here_[k].sign == 0 || here_[k].sign != before_[k].sign || here_[k].sign != after_[k].sign) return false;
  return true;
}

bool StructuralWitness::is_regular_at(const Jet& jet, const Jet& before, const Jet& after) {
  if (!keeps_signs(jet, before, after)) return false;
  for (std::size_t k = 0; k < here_.size(); ++k)
    if (!(here_[k].log2 >= std::min(before_[k].log2, after_[k].log2) + std::log2(determinant_not_fallen)))
      return false;
  return true;
}

}  // namespace sfdae::core
