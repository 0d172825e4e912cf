// The structural analysis of a DAE [P01], and what numbers say of it.
//
// Where the system Jacobian is regular at a consistent point, the offsets tell what is to be differentiated, and how
// many initial values are free. Where it is singular, numbers cancel that structure cannot see, and offsets mean
// nothing.
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

// Of equations as many as unknowns that have a transversal.
struct Structure {
  // rows: of the equations that the terms make.
  Structure(const Signature& rows, const Transversal& assignment, EquationTerms terms)
      : equations(std::move(terms)),
        signature(rows),
        transversal(assignment),
        offsets(canonical_offsets(rows, assignment)),
        blocks(rows, assignment, offsets) {}
  // Of the equations as they are recorded.
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
  // All are regular, and clearly so.
  bool is_given() const { return first(BlockVerdict::singular) < 0 && first(BlockVerdict::unclear) < 0; }
  double smallest_kept() const { return core::smallest_kept(blocks); }
};

// A consistent point.
struct CertifiedPoint {
  double t;
  // x and x', n x 2; more of it where equations were replaced, see SystemJacobian::jet_order().
  const double* jet;
  // Of the jet, as many values: how far it may be off by rounding. Null: by a few roundings of its numbers.
  const double* noise = nullptr;
};

// The first `count` values of the jet moved by a few of its rounding errors, of random size and sign; side: 1 or -1.
std::vector<double> moved_by_rounding(const CertifiedPoint& point, std::size_t count, double side);

// Entries that rounding errors of the point change by more than a part of them are taken for zeros: an entry that
// vanishes at consistent points only has no other value there. rank_tol: as in RankScale. False: the equations cannot
// be evaluated there.
bool certify_structure(const Structure& structure, TaylorEvaluator& evaluator, const CertifiedPoint& point,
                       double rank_tol, Certificate& certificate);

class SystemJacobian;

// Large blocks of a structure that have been ordered, and the last decisions on them. One judge at a time has it.
class OrderedBlocks;

// The same for many points: large blocks are ordered once, and where their entries are the same, so is the decision.
class StructureJudge {
 public:
  // jacobian: where entries are evaluated. Both live longer. ordered: what another judge of this structure has left,
  // or null.
  StructureJudge(const Structure& structure, SystemJacobian& jacobian,
                 std::shared_ptr<OrderedBlocks> ordered = nullptr);
  const std::shared_ptr<OrderedBlocks>& ordered() const { return ordered_; }
  // They are ordered again when they are judged the next time.
  void forget_order();
  bool certify(TaylorEvaluator& evaluator, const CertifiedPoint& point, double rank_tol, Certificate& certificate);

 private:
  const Structure& structure_;
  SystemJacobian& jacobian_;
  std::shared_ptr<OrderedBlocks> ordered_;
};

}  // namespace sfdae::core
