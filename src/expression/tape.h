// The graph of recorded equations, laid out for evaluation: what does not contribute to an equation is left out,
// every value has a slot, and the gradients are lists of edges to be followed backward.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "expression/record.h"

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

// Slots of the result, the operands and the derivatives that are needed. None: -1, in the lists of a tape 0, which is the
// slot of a leaf.
struct Instruction {
  Code code;
  int v = -1, a = -1, b = -1, c = -1;
  int p = -1, q = -1;
  const FunctionCall* call = nullptr;  // of a function; b is then the slot after a
};

enum class EdgeCode : std::uint8_t {
  pass,              // adjoint(to) += adjoint(from)
  negate,            // -=
  multiply,          // += adjoint(from) factor
  multiply_negated,  // -=
  scale,             // as multiply, the factor is constant in time
  pass_if_positive,  // += if factor > 0
  pass_otherwise
};

// The instruction that computes an operation (which is no leaf): without regard to what kind of operands it has.
Code code_of(Operation operation);

// How a derivative is handed from a value to one of its operands. Adjoints are numbered within each equation, that of the residual is
// the first.
struct Edge {
  EdgeCode code;
  bool is_first;     // = instead of +=
  bool from_number;  // adjoint(from) is constant in time
  int from, to;
  int factor;  // slot, 0 if there is none
};

// The slots p and q of the instructions of all nodes, or -1.
struct SlopeSlots {
  std::vector<int> p, q;
};

struct Tape {
  // slopes: filled in where they are wanted.
  explicit Tape(const Record& record, SlopeSlots* slopes = nullptr);

  struct Number {
    int slot, index;  // of a constant or a parameter
  };
  struct Leaf {
    int slot, unknown;
    bool derivative;
  };

  int num_slots = 0;
  int time = -1;  // slot, -1: not used
  std::vector<Number> constants, parameters;
  std::vector<Leaf> leaves;
  // To be done after a change of parameters; of the time; of x or x'. Operands come first, and those of x or x' that are of one
  // kind follow each other (in_runs in tape.cpp).
  std::vector<Instruction> of_parameters, of_time, of_state;
  std::vector<int> residuals;  // slots
  bool has_choices = false;    // among the values that depend on x or x'

  // Equation i: its edges and the leaves that they lead to are those from first[i] to first[i + 1].
  std::vector<Edge> edges;
  std::vector<std::size_t> first_edge;
  int num_adjoints = 1;       // of the equation that has most of them
  std::vector<Leaf> targets;  // slot: the number of the adjoint
  std::vector<std::size_t> first_target;

  std::vector<int> slot_of;  // by node; -1: none
};

}  // namespace sfdae::core
