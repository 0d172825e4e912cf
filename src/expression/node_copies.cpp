// SPDX-License-Identifier: BSD-3-Clause
#include "expression/node_copies.h"

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Records node i of the record with the copies of its operands. leaf: makes the copies of leaves except constants;
// choice: those of choices.
template <class Leaf, class Choice>
int copy_node(const Record& record, int i, const std::vector<int>& copies, Recorder& recorder, Leaf leaf,
              Choice choice) {
  const Node node = record.node(i);
  switch (node.operation) {
    case Operation::constant: return recorder.constant(record.constant(node.a));
    case Operation::time:
    case Operation::unknown:
    case Operation::parameter:
    case Operation::derivative: return leaf(node);
    case Operation::function: {
      FunctionCall call = record.call(i);
      for (int& argument : call.arguments) argument = copies[index(argument)];
      return recorder.call(call);
    }
    default: break;
  }
  const auto copy_of = [&](int operand) { return operand >= 0 ? copies[index(operand)] : -1; };
  const CopiedChoice copied{i, copy_of(node.a), copy_of(node.b), copy_of(node.c)};
  if (node.operation == Operation::choose) return choice(copied);
  return recorder.apply(node.operation, copied.condition, copied.if_met, copied.otherwise);
}

template <class Leaf, class Choice>
std::vector<int> copy_all(const Record& record, Recorder& recorder, Leaf leaf, Choice choice) {
  std::vector<int> copies;
  for (int i = 0; i < record.num_nodes(); ++i) copies.push_back(copy_node(record, i, copies, recorder, leaf, choice));
  return copies;
}

// Returns a function that copies choices unchanged.
auto choices_in(Recorder& recorder) {
  return [&recorder](const CopiedChoice& copied) {
    return recorder.apply(Operation::choose, copied.condition, copied.if_met, copied.otherwise);
  };
}

// Returns the unchanged copy of a leaf that is not a parameter.
int copy_of_leaf(const Node& leaf, Recorder& recorder) {
  if (leaf.operation == Operation::time) return recorder.time();
  if (leaf.operation == Operation::unknown) return recorder.unknown(leaf.a);
  return recorder.derivative(leaf.a);
}

}  // namespace

std::vector<int> copy_nodes(const Record& record, Recorder& recorder) {
  for (const Parameter& parameter : record.parameters()) recorder.parameter(parameter.name, parameter.value);
  return copy_with_leaves(record, recorder, [&](const Node& leaf) {
    if (leaf.operation != Operation::parameter) return copy_of_leaf(leaf, recorder);
    const Parameter& parameter = record.parameters()[index(leaf.a)];
    return recorder.parameter(parameter.name, parameter.value);
  });
}

std::vector<int> copy_with_choices(const Record& record, Recorder& recorder,
                                   const std::function<int(const CopiedChoice&)>& copy_of) {
  const int users = record.num_user_parameters();
  const auto parameter = [&](int number) {
    const Parameter& given = record.parameters()[index(number)];
    return recorder.parameter(given.name, given.value);
  };
  for (int i = 0; i < users; ++i) parameter(i);
  const auto leaf = [&](const Node& node) {
    if (node.operation != Operation::parameter) return copy_of_leaf(node, recorder);
    return node.a < users ? parameter(node.a) : recorder.constant(0.0);
  };
  return copy_all(record, recorder, leaf, copy_of);
}

std::vector<int> copy_values(const TaylorEvaluator& evaluator, Derivatives derivatives, Recorder& recorder) {
  return copy_with([&](int parameter) { return recorder.constant(evaluator.parameter(parameter)); },
                   evaluator.record(), derivatives, recorder);
}

std::vector<int> copy_with(const std::function<int(int parameter)>& node_of, const Record& record,
                           Derivatives derivatives, Recorder& recorder) {
  return copy_with_leaves(record, recorder, [&](const Node& leaf) {
    if (leaf.operation == Operation::parameter) return node_of(leaf.a);
    const bool is_zero = leaf.operation == Operation::derivative && derivatives == Derivatives::zero;
    return is_zero ? recorder.constant(0.0) : copy_of_leaf(leaf, recorder);
  });
}

std::vector<int> copy_with_leaves(const Record& record, Recorder& recorder,
                                  const std::function<int(const Node& leaf)>& node_of) {
  return copy_all(record, recorder, node_of, choices_in(recorder));
}

}  // namespace sfdae::core
