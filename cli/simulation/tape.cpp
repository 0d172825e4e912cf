// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/tape.h"

#include <algorithm>
#include <cmath>

#include "model/chain_rule.h"

namespace sfdae::cli {

Values::Values(const System& system)
    : variable(system.model.variables.size() + system.at_events.when_conditions.size(), 0.0),
      previous(variable.size(), 0.0),
      derivative(system.model.variables.size(), 0.0),
      switches(system.switches.size(), 0.0),
      samples(system.samples.size(), 0.0) {}

bool are_same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

bool are_same(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) { return are_same(x, y); });
}

int Tape::compiled(Formula formula) {
  register_of_.resize(at(formulas_.size()), -1);
  std::vector<Formula> stack{formula};
  while (!stack.empty()) {
    const Formula f = stack.back();
    bool is_ready = true;
    if (register_of_[at(f)] < 0)
      for (Formula operand : formulas_[f].operands)
        if (operand >= 0 && register_of_[at(operand)] < 0) {
          stack.push_back(operand);
          is_ready = false;
        }
    if (!is_ready) continue;
    stack.pop_back();
    if (register_of_[at(f)] < 0) compile(f);
  }
  return register_of_[at(formula)];
}

void Tape::compile(Formula formula) {
  const FormulaNode& node = formulas_[formula];
  const auto place = [&](std::size_t k) { return node.operands[k] < 0 ? -1 : register_of_[at(node.operands[k])]; };
  const bool is_frozen = node.index >= 0 && (is_relation(node.operation) || node.operation == Operation::floor ||
                                             node.operation == Operation::div);
  instructions_.push_back({node.operation, node.index, place(0), place(1), place(2), node.value, is_frozen, false});
  register_of_[at(formula)] = static_cast<int>(instructions_.size()) - 1;
  registers_.push_back(0.0);
}

int Tape::add(Formula formula) {
  outputs_.push_back(compiled(formula));
  return size() - 1;
}

void Tape::add_assignment(int variable, Formula value) {
  const int place = compiled(value);
  instructions_.push_back({Operation::variable, variable, place, -1, -1, 0.0, false, true});
  registers_.push_back(0.0);
}

double Tape::read(const Instruction& instruction, const Values& values) {
  if (instruction.is_frozen) return values.switches[at(instruction.index)];
  switch (instruction.operation) {
    case Operation::number: return instruction.value;
    case Operation::time: return values.t;
    case Operation::variable: return values.variable[at(instruction.index)];
    case Operation::derivative: return values.derivative[at(instruction.index)];
    case Operation::previous: return values.previous[at(instruction.index)];
    case Operation::sample: return values.samples[at(instruction.index)];
    case Operation::initial: return values.is_initial ? 1.0 : 0.0;
    default: return values.is_terminal ? 1.0 : 0.0;
  }
}

namespace {

// Numbers as terms for the chain rule.
struct NumberAlgebra {
  using Term = double;
  static double number(double value) { return value; }
  static double make(Operation operation, double u, double v = 0.0) { return applied(operation, u, v, 0.0); }
  static double choose(Operation relation, double u, double v, double a, double b) {
    return applied(relation, u, v, 0.0) != 0.0 ? a : b;
  }
  static bool is_zero(double u) { return u == 0.0; }
};

}  // namespace

void Tape::differentiate(const std::vector<double>& direction) {
  NumberAlgebra numbers;
  ChainRule<NumberAlgebra> rule(numbers);
  tangents_.assign(instructions_.size(), 0.0);
  for (std::size_t k = 0; k < instructions_.size(); ++k) {
    const Instruction& instruction = instructions_[k];
    if (instruction.is_assignment) continue;
    if (instruction.a < 0) {
      const bool moves = instruction.operation == Operation::variable && at(instruction.index) < direction.size();
      if (moves) tangents_[k] = direction[at(instruction.index)];
      continue;
    }
    const auto operand = [&](int place) {
      return ChainRule<NumberAlgebra>::Operand{registers_[at(place)], tangents_[at(place)]};
    };
    if (instruction.operation == Operation::choose)
      tangents_[k] = tangents_[at(registers_[at(instruction.a)] != 0.0 ? instruction.b : instruction.c)];
    else if (instruction.b < 0)
      tangents_[k] = rule.of_one(instruction.operation, operand(instruction.a), registers_[k]);
    else
      tangents_[k] =
          rule.of_two(instruction.operation, operand(instruction.a), operand(instruction.b), registers_[k]);
  }
}

void Tape::execute(const Values& values, Values* assigned) {
  for (std::size_t k = 0; k < instructions_.size(); ++k) {
    const Instruction& instruction = instructions_[k];
    if (instruction.is_assignment) {
      assigned->variable[at(instruction.index)] = registers_[at(instruction.a)];
      continue;
    }
    if (instruction.a < 0) {
      registers_[k] = read(instruction, values);
      continue;
    }
    const auto operand = [&](int place) { return place < 0 ? 0.0 : registers_[at(place)]; };
    registers_[k] =
        applied(instruction.operation, registers_[at(instruction.a)], operand(instruction.b), operand(instruction.c));
  }
}

}  // namespace sfdae::cli
