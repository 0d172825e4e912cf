// The structural analysis of a DAE [P01], and its numerical confirmation.
//
// If the system Jacobian is nonsingular at a consistent point, the offsets tell how often each equation has to be
// differentiated, and how many initial values are free. If it is singular, there is cancellation that the structural
// analysis cannot see, and the offsets mean nothing.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "linalg/rank.h"
#include "structure/blocks.h"
#include "structure/equation_terms.h"
#include "structure/offsets.h"
#include "structure/signature.h"
#include "structure/transversal.h"

namespace sfdae::core {

// Structure of as many equations as unknowns that have a transversal.
struct Structure {
  // rows: of the equations that the terms define.
  Structure(const Signature& rows, const Transversal& assignment, EquationTerms terms)
      : equations(std::move(terms)),
        signature(rows),
        transversal(assignment),
        offsets(canonical_offsets(rows, assignment)),
        blocks(rows, assignment, offsets) {}
  // Structure of the equations as they are recorded.
  Structure(const Signature& rows, const Transversal& assignment)
      : Structure(rows, assignment, EquationTerms(rows.size())) {}

  EquationTerms equations;
  Signature signature;
  Transversal transversal;
  Offsets offsets;
  Blocks blocks;
};

enum class BlockVerdict { regular, singular, unclear };

// The diagonal blocks of the system Jacobian at a point, each judged by itself, rows and columns scaled by powers of
// two.
struct Certificate {
  std::vector<RankDecision> blocks;
  BlockVerdict verdict(int block) const;
  // The first block of that verdict, -1: none.
  int first(BlockVerdict verdict) const;
  // True if all blocks are clearly nonsingular.
  bool is_given() const { return first(BlockVerdict::singular) < 0 && first(BlockVerdict::unclear) < 0; }
  double smallest_kept() const { return core::smallest_kept(blocks); }
};

// A consistent point.
struct CertifiedPoint {
  double t;
  // x and x', n x 2; more columns if equations were replaced, see SystemJacobian::jet_order().
  const double* jet;
  // Rounding error bounds of the jet, as many values. Null: a few units of roundoff of its values.
  const double* noise = nullptr;
};

// The first `count` values of the jet moved by a few of its rounding errors, of random size and sign; side: 1 or -1.
std::vector<double> moved_by_rounding(const CertifiedPoint& point, std::size_t count, double side);

// Entries that rounding errors of the point change by more than a fraction count as zeros: an entry that vanishes only
// at consistent points has no other value there. rank_tol: as in RankScale. False if they cannot be evaluated.
bool certify_structure(const Structure& structure, TaylorEvaluator& evaluator, const CertifiedPoint& point,
                       double rank_tol, Certificate& certificate);

class SystemJacobian;

// Large blocks of a structure that have been ordered, and the last decisions on them. Used by one judge at a time.
class OrderedBlocks;

// Certification at many points: large blocks are ordered once, and a decision is reused while entries are the same.
class StructureJudge {
 public:
  // jacobian: evaluates the entries. Both have to outlive this object. ordered: left by another judge of this
  // structure, or null.
  StructureJudge(const Structure& structure, SystemJacobian& jacobian,
                 std::shared_ptr<OrderedBlocks> ordered = nullptr);
  const std::shared_ptr<OrderedBlocks>& ordered() const { return ordered_; }
  // Large blocks are ordered again at the next decision.
  void forget_order();
  bool certify(TaylorEvaluator& evaluator, const CertifiedPoint& point, double rank_tol, Certificate& certificate);

 private:
  const Structure& structure_;
  SystemJacobian& jacobian_;
  std::shared_ptr<OrderedBlocks> ordered_;
};

}  // namespace sfdae::core
