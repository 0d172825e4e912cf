// Determinants of the blocks of the system Jacobian.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/block_determinants.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Flags of the targets of a tape: the derivative is the same everywhere.
std::vector<char> constant_targets(const Tape& tape, const Record& record) {
  std::vector<char> is_constant(tape.targets.size(), 0), of_slot(index(tape.num_slots), 1);
  for (int i = 0; i < record.m(); ++i) {
    of_slot[index(tape.residuals[index(i)])] = 1;
    for (std::size_t e = tape.first_edge[index(i)]; e < tape.first_edge[index(i + 1)]; ++e) {
      const Edge& edge = tape.edges[e];
      const bool is_factor_constant =
          edge.code == EdgeCode::pass || edge.code == EdgeCode::negate || edge.code == EdgeCode::scale;
      const bool is_same = is_factor_constant && of_slot[index(edge.from)] != 0;
      char& to = of_slot[index(edge.to)];
      to = is_same && (edge.is_first || to != 0) ? 1 : 0;
    }
    for (std::size_t e = tape.first_target[index(i)]; e < tape.first_target[index(i + 1)]; ++e)
      is_constant[e] = of_slot[index(tape.targets[e].slot)];
  }
  return is_constant;
}

}  // namespace

BlockDeterminants::BlockDeterminants(const Structure& structure, TaylorEvaluator& evaluator)
    : structure_(structure),
      evaluator_(evaluator),
      limits_(index(structure.signature.size()), -1),
      gradients_(evaluator.tape().targets.size()) {
  const Tape& tape = evaluator.tape();
  const std::vector<char> is_constant = constant_targets(tape, evaluator.record());
  const auto varies = [&](int i) {
    for (std::size_t e = tape.first_target[index(i)]; e < tape.first_target[index(i + 1)]; ++e)
      if (is_constant[e] == 0 && is_leading(i, e)) return true;
    return false;
  };
  block_of_.resize(limits_.size());
  for (int block = 0; block < structure.blocks.count(); ++block)
    for (int j : structure.blocks.unknowns(block)) block_of_[index(j)] = block;
  for (int block = 0; block < structure.blocks.count(); ++block) {
    const auto equations = structure.blocks.equations(block);
    block_at_hand_ = block;
    if (std::any_of(equations.begin(), equations.end(), varies)) add(block);
  }
}

// Entries of the block at hand.
bool BlockDeterminants::is_leading(int equation, std::size_t target) const {
  const Tape::Leaf& leaf = evaluator_.tape().targets[target];
  return block_of_[index(leaf.unknown)] == block_at_hand_ &&
         structure_.offsets.is_leading(equation, {leaf.unknown, leaf.derivative ? 1 : 0});
}

void BlockDeterminants::add(int number) {
  const Tape& tape = evaluator_.tape();
  const auto equations = structure_.blocks.equations(number), unknowns = structure_.blocks.unknowns(number);
  Block block;
  block.number = number;
  SparsePattern pattern;
  pattern.size = static_cast<int>(equations.size());
  std::vector<int> column_of(limits_.size(), -1);
  for (std::size_t k = 0; k < unknowns.size(); ++k) column_of[index(unknowns[k])] = static_cast<int>(k);
  std::vector<std::vector<std::pair<int, std::size_t>>> columns(equations.size());
  for (std::size_t row = 0; row < equations.size(); ++row) {
    const int i = equations[row];
    limits_[index(i)] = 0;
    for (std::size_t e = tape.first_target[index(i)]; e < tape.first_target[index(i + 1)]; ++e)
      if (is_leading(i, e))
        columns[index(column_of[index(tape.targets[e].unknown)])].emplace_back(static_cast<int>(row), e);
  }
  pattern.first.assign(1, 0);
  for (const auto& column : columns) {
    for (const auto& [row, target] : column) {
      pattern.row.push_back(row);
      block.targets.push_back(target);
    }
    pattern.first.push_back(static_cast<int>(pattern.row.size()));
  }
  if (pattern.size > 1) block.lu.analyze(pattern);
  blocks_.push_back(std::move(block));
}

BlockDeterminants::Value BlockDeterminants::value(Block& block) {
  values_.clear();
  for (std::size_t target : block.targets) values_.push_back(gradients_[target]);
  Determinant<double> determinant;
  if (values_.size() == 1) {
    if (values_[0] == 0.0) return {};
    determinant.multiply(values_[0]);
  } else {
    if (!block.lu.factor(values_.data())) return {};
    determinant = block.lu.determinant();
  }
  return {determinant.direction > 0.0 ? 1 : -1, determinant.log2};
}

bool BlockDeterminants::measure(const Jet& jet, std::vector<Value>& values) {
  values.clear();
  if (blocks_.empty()) return true;
  if (!evaluator_.entries(jet.t, jet.x.data(), 0, limits_, gradients_.data())) return false;
  for (Block& block : blocks_) values.push_back(value(block));
  return true;
}

}  // namespace sfdae::core
