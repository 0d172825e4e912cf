// Arguments of exponentials in recorded equations.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/steep_arguments.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "expression/execution.h"
#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

// How accurately arguments are known where an iteration ends, before its own factors. (Chosen: of 60 mains rectifiers
// 35 ended early with Radau at 1e-3 with 0.1, 6 with 0.02, none with 0.01.)
constexpr double certain_part = 0.01;
// Of an unknown: what rounding errors leave of it.
constexpr double least_relative = 1e-12;

// Derivatives are too large by a factor of 7 then. (Chosen.)
constexpr double small_fall = 2.0;
// Exponentials of less count nowhere: 4e-44.
constexpr double least_argument = -100.0;

bool is_exponential(Code code) { return code == Code::exp || code == Code::sinh_cosh; }

bool is_arithmetic(Code code) {
  return InstructionList::is_binary(code) || code == Code::negate || code == Code::divide ||
         code == Code::divide_by_number || code == Code::copy;
}

// Of arithmetic ones.
bool has_second_operand(Code code) { return code != Code::negate && code != Code::copy; }

enum class Origin : char { of_no_state, followed, not_followed };

// Of each slot.
std::vector<Origin> origins_of(const Tape& tape, const std::vector<Instruction>& of_state) {
  std::vector<Origin> origin(index(tape.num_slots), Origin::of_no_state);
  for (const Tape::Leaf& leaf : tape.leaves)
    origin[index(leaf.slot)] = leaf.derivative ? Origin::not_followed : Origin::followed;
  for (const Instruction& instruction : of_state) {
    const bool is_followed =
        is_arithmetic(instruction.code) && origin[index(instruction.a)] != Origin::not_followed &&
        !(has_second_operand(instruction.code) && origin[index(instruction.b)] == Origin::not_followed);
    origin[index(instruction.v)] = is_followed ? Origin::followed : Origin::not_followed;
    if (has_two_results(instruction)) origin[index(instruction.p)] = Origin::not_followed;
  }
  return origin;
}

}  // namespace

SteepArguments::SteepArguments(const std::vector<const TaylorEvaluator*>& evaluators) {
  for (const TaylorEvaluator* const evaluator : evaluators) {
    if (evaluator->has_source() || !evaluator->tape().of_state.has_other(is_exponential)) continue;
    Part part(*evaluator);
    if (!part.arguments.empty()) parts_.push_back(std::move(part));
  }
}

SteepArguments::Part::Part(const TaylorEvaluator& evaluator) : values(evaluator) {
  const Tape& tape = evaluator.tape();
  const std::vector<Instruction> of_state = tape.of_state.all();
  const std::vector<Origin> origin = origins_of(tape, of_state);
  std::vector<char> is_needed(index(tape.num_slots), 0);
  for (const Instruction& instruction : of_state) {
    const std::size_t a = index(instruction.a);
    if (!is_exponential(instruction.code) || origin[a] != Origin::followed || is_needed[a] != 0) continue;
    arguments.push_back(instruction.a);
    is_needed[a] = 1;
  }
  std::vector<char> is_hyperbolic(index(tape.num_slots), 0);
  for (const Instruction& instruction : of_state)
    if (instruction.code == Code::sinh_cosh) is_hyperbolic[index(instruction.a)] = 1;
  for (const int argument : arguments) is_of_both_signs.push_back(is_hyperbolic[index(argument)]);
  for (auto instruction = of_state.rbegin(); instruction != of_state.rend(); ++instruction) {
    if (is_needed[index(instruction->v)] == 0) continue;
    instructions.push_back(*instruction);
    is_needed[index(instruction->a)] = 1;
    if (has_second_operand(instruction->code)) is_needed[index(instruction->b)] = 1;
  }
  std::reverse(instructions.begin(), instructions.end());
  for (const Instruction& instruction : instructions) list.push_back(instruction);
  list.finish();
  for (const Tape::Leaf& leaf : tape.leaves)
    if (is_needed[index(leaf.slot)] != 0) leaves.push_back(leaf);
  change.assign(index(tape.num_slots), 0.0);
  of_arguments.assign(arguments.size(), 0.0);
}

void SteepArguments::sharpen(double t, const double* x, double* inverse_weights) {
  const QuietArithmetic quiet;
  for (Part& part : parts_) {
    propagate(part, evaluate(part, t, x), inverse_weights);
    if (!hand_back(part)) continue;
    for (const Tape::Leaf& leaf : part.leaves) {
      const double needed = part.change[index(leaf.slot)] / certain_part;
      double& inverse = inverse_weights[leaf.unknown];
      const double most = 1.0 / (least_relative * std::fabs(x[leaf.unknown]));
      if (needed > 1.0 && inverse < most) inverse = std::fmin(inverse * needed, most);
    }
  }
}

bool SteepArguments::have_fallen(const Place& from, const Place& to) {
  const QuietArithmetic quiet;
  for (Part& part : parts_) {
    const auto height = [&part](const double* value, std::size_t k) {
      const double argument = value[part.arguments[k]];
      return part.is_of_both_signs[k] != 0 ? std::fabs(argument) : argument;
    };
    const double* value = evaluate(part, from.t, from.x);
    for (std::size_t k = 0; k < part.arguments.size(); ++k) part.of_arguments[k] = height(value, k);
    value = evaluate(part, to.t, to.x);
    for (std::size_t k = 0; k < part.arguments.size(); ++k)
      if (part.of_arguments[k] > least_argument && part.of_arguments[k] - height(value, k) > small_fall) return true;
  }
  return false;
}

// By slots.
const double* SteepArguments::evaluate(Part& part, double t, const double* x) {
  double* const slots = part.values.at(t);
  for (const Tape::Leaf& leaf : part.leaves) slots[leaf.slot] = x[leaf.unknown];
  execute_values(part.list, slots);
  return slots;
}

// By how much values change with x by its tolerances, to first order.
void SteepArguments::propagate(Part& part, const double* value, const double* inverse_weights) {
  double* const change = part.change.data();
  clear(part);
  for (const Tape::Leaf& leaf : part.leaves) change[leaf.slot] = 1.0 / inverse_weights[leaf.unknown];
  for (const Instruction& instruction : part.instructions) {
    const int a = instruction.a, b = instruction.b;
    double& v = change[instruction.v];
    switch (instruction.code) {
      case Code::add:
      case Code::subtract: v = change[a] + change[b]; break;
      case Code::multiply:
      case Code::scale: v = std::fabs(value[a]) * change[b] + std::fabs(value[b]) * change[a]; break;
      case Code::divide:
      case Code::divide_by_number:
        v = (change[a] + std::fabs(value[instruction.v]) * change[b]) / std::fabs(value[b]);
        break;
      default: v = change[a];  // negate, copy
    }
  }
}

// From the arguments to what they are made of: the largest of their changes. False: all of them are known well enough.
bool SteepArguments::hand_back(Part& part) {
  double* const change = part.change.data();
  double largest = 0.0;
  for (std::size_t k = 0; k < part.arguments.size(); ++k) {
    // At a pole nothing is known.
    part.of_arguments[k] = std::isfinite(change[part.arguments[k]]) ? change[part.arguments[k]] : 0.0;
    largest = std::fmax(largest, part.of_arguments[k]);
  }
  if (!(largest > certain_part)) return false;
  clear(part);
  for (std::size_t k = 0; k < part.arguments.size(); ++k) change[part.arguments[k]] = part.of_arguments[k];
  for (auto instruction = part.instructions.rbegin(); instruction != part.instructions.rend(); ++instruction) {
    const double own = change[instruction->v];
    change[instruction->a] = std::fmax(change[instruction->a], own);
    if (has_second_operand(instruction->code)) change[instruction->b] = std::fmax(change[instruction->b], own);
  }
  return true;
}

void SteepArguments::clear(Part& part) {
  double* const change = part.change.data();
  for (const Tape::Leaf& leaf : part.leaves) change[leaf.slot] = 0.0;
  for (const Instruction& instruction : part.instructions) {
    change[instruction.v] = change[instruction.a] = 0.0;
    if (has_second_operand(instruction.code)) change[instruction.b] = 0.0;
  }
}

}  // namespace sfdae::core
