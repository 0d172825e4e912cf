// Determinants of the blocks of the system Jacobian.
// SPDX-License-Identifier: BSD-3-Clause
#include "structure/block_determinants.h"

#include <algorithm>
#include <span>
#include <utility>

#include "linalg/index.h"
#include "linalg/small_determinant.h"

namespace sfdae::core {

namespace {

// Flags of the targets of a tape: the derivative is the same everywhere.
std::vector<char> constant_targets(const Tape& tape, const Record& record) {
  std::vector<char> is_constant(tape.targets.size(), 0), of_adjoint(index(tape.num_adjoints), 1);
  for (int i = 0; i < record.m(); ++i) {
    of_adjoint[0] = 1;
    const Tape::EdgesOfEquation edges = tape.edges_of(index(i));
    for (const Edge& edge : std::span(edges.first, edges.last)) {
      const bool is_factor_constant =
          edge.code == EdgeCode::pass || edge.code == EdgeCode::negate || edge.code == EdgeCode::scale;
      const bool is_same = is_factor_constant && of_adjoint[index(edge.from)] != 0;
      char& to = of_adjoint[index(edge.to)];
      to = is_same && (edge.is_first || to != 0) ? 1 : 0;
    }
    const int* adjoint = tape.adjoints_of_targets(index(i));
    for (std::size_t e = tape.first_target[index(i)]; e < tape.first_target[index(i + 1)]; ++e)
      is_constant[e] = of_adjoint[index(*adjoint++)];
  }
  return is_constant;
}

// Flags of the equations: some entry of the system Jacobian varies. Replaced equations count as varying.
std::vector<char> varying_equations(const Structure& structure, const TaylorEvaluator& evaluator) {
  const Tape& tape = evaluator.tape();
  const std::vector<char> is_constant = constant_targets(tape, evaluator.record());
  std::vector<char> varies(index(structure.signature.size()), 0);
  for (int i = 0; i < structure.signature.size(); ++i) {
    varies[index(i)] = structure.equations.is_replaced(i);
    if (varies[index(i)] != 0) continue;
    for (std::size_t e = tape.first_target[index(i)]; e < tape.first_target[index(i + 1)]; ++e) {
      const Tape::Variable& leaf = tape.targets[e];
      if (is_constant[e] == 0 && structure.offsets.is_leading(i, {leaf.unknown, leaf.derivative ? 1 : 0}))
        varies[index(i)] = 1;
    }
  }
  return varies;
}

}  // namespace

bool has_constant_blocks(const Structure& structure, const TaylorEvaluator& evaluator) {
  if (evaluator.has_source()) return false;
  const std::vector<char> varies = varying_equations(structure, evaluator);
  return std::none_of(varies.begin(), varies.end(), [](char flag) { return flag != 0; });
}

BlockDeterminants::BlockDeterminants(const Structure& structure, SystemJacobian& jacobian, TaylorEvaluator& evaluator)
    : structure_(structure), evaluator_(evaluator), jacobian_(jacobian) {
  const std::vector<char> varies = varying_equations(structure, evaluator);
  BlockEntries of_blocks(structure, jacobian_);
  for (int block = 0; block < structure.blocks.count(); ++block) {
    const auto equations = structure.blocks.equations(block);
    if (std::any_of(equations.begin(), equations.end(), [&](int i) { return varies[index(i)] != 0; }))
      add(block, of_blocks);
  }
  if (!blocks_.empty()) jacobian_.expect_many_points();
}

void BlockDeterminants::add(int number, BlockEntries& of_blocks) {
  Block block;
  block.number = number;
  std::vector<std::vector<std::pair<int, int>>> columns(structure_.blocks.equations(number).size());
  of_blocks.for_each(number, [&](int row, int column, int e) { columns[index(column)].emplace_back(row, e); });
  const SparsePattern pattern = pattern_of(columns, block.entries);
  if (pattern.size > largest_small_determinant) {
    block.list = std::make_unique<ListedFactors<double>>();
    block.pattern = pattern;
  } else {
    for (std::size_t column = 0; column < columns.size(); ++column)
      for (const auto& [row, e] : columns[column])
        block.places.push_back(row + static_cast<int>(column) * pattern.size);
  }
  blocks_.push_back(std::move(block));
}

bool BlockDeterminants::find_determinant(Block& block, const std::vector<double>& values,
                                         Determinant<double>& determinant) {
  if (block.list->factor(block.pattern, values.data())) {
    determinant = block.list->determinant();
    return true;
  }
  if (!block.lu) {
    auto lu = std::make_unique<SparseLu<double>>();
    lu->analyze(block.pattern);
    block.lu = std::move(lu);
  }
  if (!block.lu->factor(values.data())) return false;
  determinant = block.lu->determinant();
  return true;
}

BlockDeterminants::Value BlockDeterminants::value(Block& block) {
  const std::vector<double>& entries = jacobian_.values();
  Determinant<double> determinant;
  if (block.list) {
    values_.clear();
    for (int entry : block.entries) values_.push_back(entries[index(entry)]);
    if (!find_determinant(block, values_, determinant)) return {};
  } else {
    const int equations = size(block);
    values_.assign(index(equations) * index(equations), 0.0);
    for (std::size_t k = 0; k < block.entries.size(); ++k)
      values_[index(block.places[k])] = entries[index(block.entries[k])];
    if (!small_determinant(values_.data(), equations, determinant)) return {};
  }
  return {determinant.direction > 0.0 ? 1 : -1, determinant.log2};
}

bool BlockDeterminants::measure(double t, const double* jet, std::vector<Value>& values) {
  values.clear();
  if (blocks_.empty()) return true;
  if (!jacobian_.evaluate(evaluator_, t, jet)) return false;
  for (Block& block : blocks_) values.push_back(value(block));
  return true;
}

}  // namespace sfdae::core
