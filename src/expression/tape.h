// The graph of recorded equations, laid out for evaluation: unused nodes are left out, every value has a slot, and the
// gradients are lists of edges for a backward sweep, which equations of one form share.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "expression/record.h"
#include "linalg/index.h"

namespace sfdae::core {

enum class Code : std::uint8_t {
  negate,
  add,
  subtract,
  multiply,
  scale,             // p = -1; v = a b, b constant in time
  divide,            // p = 1 / b, q = a / b^2
  divide_by_number,  // p = 1 / b, b constant in time
  power,             // p = b a^(b-1)
  sqrt,              // p = 1 / (2 v)
  exp,
  log,        // p = 1 / a
  log10,      // p = 1 / (a log 10)
  sin_cos,    // v = sin a, p = cos a
  sinh_cosh,  // v = sinh a, p = cosh a
  tan,
  tanh,
  asin,
  acos,
  atan,   // p: derivative by a
  atan2,  // p, q: derivatives by a, b
  floor,
  modulo,  // q = floor(a / b): minus the derivative by b
  copy,
  function,  // of a, a + 1, ...; p, p + 1, ...: derivatives by these
  choose     // v = b if a > 0, else c
};

// Slots of the result, the operands and the derivatives that are needed. None: -1; in the lists of a tape 0, the slot
// of a leaf.
struct Instruction {
  Code code;
  int v = -1, a = -1, b = -1, c = -1;
  int p = -1, q = -1;
  const FunctionCall* call = nullptr;  // of a function; b is then the slot after a
};

// Slots of derivatives are read as values where sine and cosine share an instruction.
inline bool has_two_results(const Instruction& instruction) {
  return (instruction.code == Code::sin_cos || instruction.code == Code::sinh_cosh) && instruction.p > 0;
}

enum class EdgeCode : std::uint8_t {
  pass,              // adjoint(to) += adjoint(from)
  negate,            // -=
  multiply,          // += adjoint(from) factor
  multiply_negated,  // -=
  scale,             // as multiply, the factor is constant in time
  pass_if_positive,  // += if factor > 0
  pass_otherwise
};

// The general instruction for an operation (not a leaf), regardless of the kind of its operands.
Code code_of(Operation operation);

// Instructions in their order. Most are binary instructions of four kinds, stored as slots of operands, with the kind
// once for each run, and the slot of the result once if results are adjacent; all others are stored completely.
class InstructionList {
 public:
  struct Operands {
    int a, b;
  };
  // A run of binary instructions of that code, or of any others if the code is none of these.
  struct Run {
    Code code;
    // Result of the first binary instruction; the others are `step()` apart. -1: they are listed.
    int result;
    std::size_t count;
  };
  static bool is_binary(Code code) {
    return code == Code::add || code == Code::subtract || code == Code::multiply || code == Code::scale;
  }

  void push_back(const Instruction& instruction);
  // Call after the last instruction.
  void finish();
  std::vector<Instruction> all() const;
  // The results of binary ones, in their order; before finish().
  const std::vector<int>& results() const { return results_; }
  // Each slot becomes number[slot]; before finish().
  void renumber(const std::vector<int>& number);
  // Slots as offsets, `stride` numbers for each.
  InstructionList in_offsets(int stride) const;

  bool empty() const { return runs_.empty(); }
  const std::vector<Run>& runs() const { return runs_; }
  const Operands* operands() const { return operands_.data(); }
  const int* listed_results() const { return results_.data(); }
  int step() const { return step_; }
  const Instruction* others() const { return others_.data(); }
  // Returns whether the list has an instruction of such a code, which is not a binary one.
  template <class Test>
  bool has_other(Test is_wanted) const {
    return std::any_of(others_.begin(), others_.end(),
                       [&](const Instruction& other) { return is_wanted(other.code); });
  }

 private:
  std::vector<Run> runs_;
  std::vector<Operands> operands_;
  std::vector<int> results_;
  int step_ = 1;
  std::vector<Instruction> others_;
};

// Step of the backward sweep from a value to one of its operands. Adjoints are numbered within each equation, that of
// the residual is the first.
struct Edge {
  EdgeCode code;
  bool is_first;     // = instead of +=
  bool from_number;  // adjoint(from) is constant in time
  int from, to;
  int factor;  // which one of those of the equation; without a meaning where there is none
};

inline bool has_factor(EdgeCode code) { return code != EdgeCode::pass && code != EdgeCode::negate; }

// Slots of the values of all nodes, and of p and q of their instructions, or -1.
struct NodeSlots {
  std::vector<int> v, p, q;
};
NodeSlots slots_of_nodes(const Record& record);

// Nodes that equations depend on.
std::vector<bool> live_nodes(const Record& record);

struct Tape {
  Tape() = default;
  explicit Tape(const Record& record);

  struct Number {
    int slot, index;  // of a constant or a parameter
  };
  // x_j or x_j'
  struct Variable {
    Variable(int j, bool is_derivative) : unknown(j & 0x3fffffff), derivative(is_derivative) {}
    int unknown : 31;
    bool derivative : 1;
  };
  struct Leaf : Variable {
    Leaf(int slot_, int j, bool is_derivative) : Variable(j, is_derivative), slot(slot_) {}
    int slot;
  };

  int num_slots = 0;
  int time = -1;  // slot, -1: not used
  std::vector<Number> constants, parameters;
  std::vector<Leaf> leaves;
  // Instructions to execute after a change of parameters, of the time, of x or x'. Operands come first, and those of x
  // or x' of one kind are adjacent (InRuns in tape.cpp).
  InstructionList of_parameters, of_time, of_state;
  std::vector<int> residuals;  // slots
  bool has_choices = false;    // among the values that depend on x or x'

  // Equations of one form share their edges and the adjoints of their targets, and have factors of their own
  // (docs/design/structural_analysis.md).
  struct EdgesOfEquation {
    const Edge *first, *last;
    const int* factors;  // slots
  };
  EdgesOfEquation edges_of(std::size_t equation) const { return edges_of(equation, edges, factors); }
  // Edges of an equation within copies of edges and factors.
  EdgesOfEquation edges_of(std::size_t equation, const std::vector<Edge>& all_edges,
                           const std::vector<int>& all_factors) const {
    const std::size_t form = index(form_of[equation]);
    return {all_edges.data() + first_edge[form], all_edges.data() + first_edge[form + 1],
            all_factors.data() + first_factor[equation]};
  }
  // In the order of the targets of the equation.
  const int* adjoints_of_targets(std::size_t equation) const {
    return target_adjoints.data() + first_target_adjoint[index(form_of[equation])];
  }
  std::vector<Edge> edges;              // of all forms
  std::vector<std::size_t> first_edge;  // of each form, and their number
  std::vector<int> target_adjoints;     // of all forms
  std::vector<std::size_t> first_target_adjoint;
  std::vector<int> form_of;  // equations
  std::vector<int> factors;  // of all equations, and one more
  std::vector<std::uint32_t> first_factor;
  int num_adjoints = 1;  // of the equation that has most of them

  // The variables that the edges of equation i lead to are those from first_target[i] to first_target[i + 1].
  std::vector<Variable> targets;
  std::vector<std::uint32_t> first_target;
};

}  // namespace sfdae::core
