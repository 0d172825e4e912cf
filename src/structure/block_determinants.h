// Determinants of the blocks of the system Jacobian. If one vanishes along a solution, the structural analysis fails
// there, and the characteristic values differ.
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

// True if all entries of the system Jacobian are numbers that do not depend on the point: decisions on its blocks then
// hold until parameters change.
bool has_constant_blocks(const Structure& structure, const TaylorEvaluator& evaluator);

class BlockDeterminants {
 public:
  // All have to outlive this object. jacobian: evaluates the entries.
  BlockDeterminants(const Structure& structure, SystemJacobian& jacobian, TaylorEvaluator& evaluator);

  // Number of blocks with an entry that depends on t, x or x'; other blocks have constant determinants.
  int count() const { return static_cast<int>(blocks_.size()); }
  // The number in the structure of block k of these.
  int number(int k) const { return blocks_[index(k)].number; }

  // Number of unknowns of block k.
  int size(int k) const { return size(blocks_[index(k)]); }

  struct Value {
    int sign = 0;  // 0: singular to working precision
    double log2 = 0.0;
  };
  // Order of the jets required.
  int jet_order() const { return jacobian_.jet_order(); }
  // Measures at t and x, x', ... (one column each) of a jet of that order, at least; count() values. False if the
  // equations cannot be evaluated there.
  bool measure(double t, const double* jet, std::vector<Value>& values);

 private:
  struct Block {
    int number;
    std::vector<int> entries;  // of the system Jacobian, by columns of the block
    std::vector<int> places;   // of small blocks: of these in a full matrix
    // Other blocks: pattern, list, and factors if the list fails, ordered when first needed.
    SparsePattern pattern;
    std::unique_ptr<ListedFactors<double>> list;
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
