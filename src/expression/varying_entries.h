// Operations of a tape that derivatives which are not constant require. Most equations are sums of terms with constant
// factors, whose derivatives need not be evaluated at each point.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "expression/tape.h"

namespace sfdae::core {

class VaryingEntries {
 public:
  VaryingEntries() = default;
  // is_wanted: flags of the targets of the tape to evaluate; the others are evaluated together with the constant ones.
  explicit VaryingEntries(std::vector<char> is_wanted) : is_wanted_(std::move(is_wanted)) {}

  // Slots become offsets, `stride` numbers for each.
  void set(const Tape& tape, int stride);
  int stride() const { return stride_; }

  // The needed ones of the tape's instructions of_state.
  const InstructionList& instructions() const { return instructions_; }
  // Equations with such derivatives, the edges that lead to these, and their numbers among the targets of the tape.
  struct Row {
    std::size_t first_edge, last_edge, first_target, last_target;
  };
  const std::vector<Row>& rows() const { return rows_; }
  Tape::EdgesOfEquation edges_of(const Row& row) const {
    return {edges_.data() + row.first_edge, edges_.data() + row.last_edge, factors_.data()};
  }
  std::size_t target(std::size_t k) const { return targets_[k].number; }
  // Its adjoint in the equation.
  int adjoint(std::size_t k) const { return targets_[k].adjoint; }

  // The parameters with which the other derivatives have been evaluated, as TaylorEvaluator counts them; -1: none.
  long version = -1;

 private:
  void choose_edges(const Tape& tape, int equation, std::vector<char>& is_needed);
  void choose_instructions(const Tape& tape, std::vector<char>& is_needed);

  int stride_ = 0;
  std::vector<char> is_wanted_;  // none: all
  InstructionList instructions_;
  std::vector<Row> rows_;
  std::vector<Edge> edges_;
  std::vector<int> factors_;  // the first one for edges that have none
  struct Target {
    std::size_t number;
    int adjoint;
  };
  std::vector<Target> targets_;
};

}  // namespace sfdae::core
