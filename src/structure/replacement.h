// Equations that depend on others in the system Jacobian, whatever t and x, so that structure misleads: combinations
// with constant coefficients take their place until structure tells the truth, or nothing is left to be combined
// [TNP17].
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

// Where equations are looked at: near x, n values, as far as its sizes.
struct Neighbourhood {
  double t;
  const double* x;
  const std::vector<double>& sizes;
};

struct ReplacedStructure {
  // Null: no block is singular there, or structure cannot be made to agree with the numbers by such combinations.
  // Else all blocks of the structure found are regular.
  std::shared_ptr<const Structure> structure;
  // Of the structure as it was given, where that stays, for those who judge it next.
  std::shared_ptr<OrderedBlocks> ordered;
};

// Entries that cancel are those that do so at several points chosen at random.
ReplacedStructure structure_with_replacements(const Structure& structure, TaylorEvaluator& evaluator,
                                              const Neighbourhood& neighbourhood);

// Entries that have cancelled where equations were replaced still do so at that point. jet: as certify_structure()
// wants it.
bool still_cancel(const Structure& structure, TaylorEvaluator& evaluator, double t, const double* jet);

}  // namespace sfdae::core
