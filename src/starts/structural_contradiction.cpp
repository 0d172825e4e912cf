// Ranks of the derivative array compared with the structural analysis.
// SPDX-License-Identifier: BSD-3-Clause
#include "starts/structural_contradiction.h"

#include "linalg/format.h"
#include "reduction/balanced_units.h"
#include "reduction/usual_units.h"
#include "structure/structure.h"
#include "system/jet_coefficients.h"

namespace sfdae::core {

std::string contradiction_of_structure(NonlinearProblem& problem, const Jet& jet, const CharacteristicValues& values,
                                       double rank_tol) {
  const Structure* const structure = problem.counts_are_given() ? nullptr : problem.structure();
  if (structure == nullptr || !problem.prescribed().empty() || rank_tol > 0.0) return {};
  const int freedom = structure->offsets.freedom();
  if (values.u == 0 && values.v == 0 && values.d == freedom) return {};
  Certificate certificate;
  if (!certify_structure(*structure, *problem.structure_evaluator(), {jet.t, jet.x.data()}, 0.0, certificate) ||
      !certificate.is_given())
    return {};
  JetCoefficients source(problem, jet, {});
  const UsualUnits usual = usual_units(source, jet.t);
  const BalancedUnits balanced = balanced_units(usual.data, usual.units);
  if (!balanced.suspects_E.empty() || !balanced.suspects_A.empty()) return {};
  return format(
      "the derivative array and the structure of the equations disagree at t = %.15g: ranks say d = %d, u = %d, v = "
      "%d, "
      "but all blocks of the system Jacobian are regular, which means d = %d, u = v = 0. Scale the equations and "
      "unknowns, or set structure = SFDAE_STRUCTURE_REQUIRED, or rank_tol.",
      jet.t, values.d, values.u, values.v, freedom);
}

}  // namespace sfdae::core
