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
    : structure_(structure), evaluator_(evaluator), jacobian_(structure, evaluator.tape()) {
  const Tape& tape = evaluator.tape();
  const std::vector<char> is_constant = constant_targets(tape, evaluator.record());
  // Equations that were replaced count as ones that vary.
  const auto varies = [&](int i) {
    if (structure.equations.is_replaced(i)) return true;
    for (std::size_t e = tape.first_target[index(i)]; e < tape.first_target[index(i + 1)]; ++e) {
      const Tape::Leaf& leaf = tape.targets[e];
      if (is_constant[e] == 0 && structure.offsets.is_leading(i, {leaf.unknown, leaf.derivative ? 1 : 0}))
        return true;
    }
    return false;
  };
  for (int block = 0; block < structure.blocks.count(); ++block) {
    const auto equations = structure.blocks.equations(block);
    if (std::any_of(equations.begin(), equations.end(), varies)) add(block);
  }
}

void BlockDeterminants::add(int number) {
  const auto equations = structure_.blocks.equations(number), unknowns = structure_.blocks.unknowns(number);
  Block block;
  block.number = number;
  SparsePattern pattern;
  pattern.size = static_cast<int>(equations.size());
  std::vector<int> column_of(index(structure_.signature.size()), -1);
  for (std::size_t k = 0; k < unknowns.size(); ++k) column_of[index(unknowns[k])] = static_cast<int>(k);
  std::vector<std::vector<std::pair<int, int>>> columns(equations.size());
  for (std::size_t row = 0; row < equations.size(); ++row)
    for (int e = jacobian_.first()[index(equations[row])]; e < jacobian_.first()[index(equations[row] + 1)]; ++e)
      if (const int column = column_of[index(jacobian_.unknown()[index(e)])]; column >= 0)
        columns[index(column)].emplace_back(static_cast<int>(row), e);
  pattern.first.assign(1, 0);
  for (const auto& column : columns) {
    for (const auto& [row, entry] : column) {
      pattern.row.push_back(row);
      block.entries.push_back(entry);
    }
    pattern.first.push_back(static_cast<int>(pattern.row.size()));
  }
  if (pattern.size > 1) block.lu.analyze(pattern);
  blocks_.push_back(std::move(block));
}

BlockDeterminants::Value BlockDeterminants::value(Block& block) {
  values_.clear();
  for (int entry : block.entries) values_.push_back(jacobian_.values()[index(entry)]);
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
  if (!jacobian_.evaluate(evaluator_, jet.t, jet.x.data())) return false;
  for (Block& block : blocks_) values.push_back(value(block));
  return true;
}

}  // namespace sfdae::core
