// Replacement of equations that depend on others in the system Jacobian for all t and x, so that the structural
// analysis fails: combinations with constant coefficients take their place until it succeeds, or nothing is left to be
// combined [TNP17].
//
// [TNP17] G. Tan, N. S. Nedialkov, J. D. Pryce: Conversion methods for improving structural analysis of
//         differential-algebraic equation systems. BIT 57 (2017), 845-865.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "structure/structure.h"

namespace sfdae::core {

// Points at which equations are evaluated: near x, n values, within its sizes.
struct Neighbourhood {
  double t;
  const double* x;
  const std::vector<double>& sizes;
};

struct ReplacedStructure {
  // Null if no block is singular there, or if such combinations do not make all blocks nonsingular. Otherwise all
  // blocks of the structure found are nonsingular.
  std::shared_ptr<const Structure> structure;
  // Ordered blocks of the given structure, if that stays, for the next judge.
  std::shared_ptr<OrderedBlocks> ordered;
};

// Entries count as cancelled if they cancel at several random points.
ReplacedStructure structure_with_replacements(const Structure& structure, TaylorEvaluator& evaluator,
                                              const Neighbourhood& neighbourhood);

// True if entries that cancelled when equations were replaced still cancel at that point. jet: as for
// certify_structure().
bool still_cancel(const Structure& structure, TaylorEvaluator& evaluator, double t, const double* jet);

}  // namespace sfdae::core
