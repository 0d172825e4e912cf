// Determinants of the blocks of the system Jacobian: where one vanishes along a solution, the structure misleads
// there, and the characteristic values are other ones.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "linalg/listed_factors.h"
#include "linalg/sparse_lu.h"
#include "structure/structure.h"
#include "structure/system_jacobian.h"

namespace sfdae::core {

// All entries of the system Jacobian are numbers, which do not depend on the point: what has been decided about its
// blocks holds until parameters change.
bool has_constant_blocks(const Structure& structure, const TaylorEvaluator& evaluator);

class BlockDeterminants {
 public:
  // All live longer. jacobian: where entries are evaluated.
  BlockDeterminants(const Structure& structure, SystemJacobian& jacobian, TaylorEvaluator& evaluator);

  // Blocks some entry of which depends on t, x or x'; others keep their determinants.
  int count() const { return static_cast<int>(blocks_.size()); }
  // The number of a block of these in the structure.
  int number(int k) const { return blocks_[index(k)].number; }

  // Its number of unknowns.
  int size(int k) const { return size(blocks_[index(k)]); }

  struct Value {
    int sign = 0;  // 0: singular to working precision
    double log2 = 0.0;
  };
  // Of the jets wanted.
  int jet_order() const { return jacobian_.jet_order(); }
  // At t and x, x', ... (one column each) of a jet of that order, at least; count() values. False: the equations
  // cannot be evaluated there.
  bool measure(double t, const double* jet, std::vector<Value>& values);

 private:
  struct Block {
    int number;
    std::vector<int> entries;  // of the system Jacobian, by columns of the block
    std::vector<int> places;   // of small blocks: of these in a full matrix
    // Of others; factors where the list does not serve, ordered when they are needed first.
    SparsePattern pattern;
    std::unique_ptr<ListedFactors> list;
    std::unique_ptr<SparseLu<double>> lu;
  };
  int size(const Block& block) const { return static_cast<int>(structure_.blocks.equations(block.number).size()); }
  void add(int number, BlockEntries& of_blocks);
  Value value(Block& block);
  static bool find_determinant(Block& block, const std::vector<double>& values, Determinant<double>& determinant);

  const Structure& structure_;
  TaylorEvaluator& evaluator_;
  SystemJacobian& jacobian_;
  std::vector<Block> blocks_;
  std::vector<double> values_;
};

}  // namespace sfdae::core
