// SPDX-License-Identifier: BSD-3-Clause
#include "expression/node_copies.h"

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Records node i of the record, whose operands are recorded as `copies` says; leaf: what those but constants become;
// condition: what the condition of choice i becomes, given its copy.
template <class Leaf, class Condition>
int copy_node(const Record& record, int i, const std::vector<int>& copies, Recorder& recorder, Leaf leaf,
              Condition condition) {
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
  const int a = node.operation == Operation::choose ? condition(i, copy_of(node.a)) : copy_of(node.a);
  return recorder.apply(node.operation, a, copy_of(node.b), copy_of(node.c));
}

int as_it_is(int /*choice*/, int condition) { return condition; }

template <class Leaf, class Condition>
std::vector<int> copy_all(const Record& record, Recorder& recorder, Leaf leaf, Condition condition) {
  std::vector<int> copies;
  for (int i = 0; i < record.num_nodes(); ++i)
    copies.push_back(copy_node(record, i, copies, recorder, leaf, condition));
  return copies;
}

}  // namespace

std::vector<int> copy_nodes(const Record& record, Recorder& recorder) {
  return copy_with_conditions(record, recorder, as_it_is);
}

std::vector<int> copy_with_conditions(const Record& record, Recorder& recorder,
                                      const std::function<int(int choice, int condition)>& condition) {
  for (const Parameter& parameter : record.parameters()) recorder.parameter(parameter.name, parameter.value);
  const auto leaf = [&](const Node& node) {
    if (node.operation == Operation::time) return recorder.time();
    if (node.operation == Operation::unknown) return recorder.unknown(node.a);
    if (node.operation == Operation::derivative) return recorder.derivative(node.a);
    const Parameter& parameter = record.parameters()[index(node.a)];
    return recorder.parameter(parameter.name, parameter.value);
  };
  return copy_all(record, recorder, leaf, condition);
}

std::vector<int> copy_values(const TaylorEvaluator& evaluator, Derivatives derivatives, Recorder& recorder) {
  return copy_with([&](int parameter) { return recorder.constant(evaluator.parameter(parameter)); },
                   evaluator.record(), derivatives, recorder);
}

std::vector<int> copy_with(const std::function<int(int parameter)>& node_of, const Record& record,
                           Derivatives derivatives, Recorder& recorder) {
  return copy_with_leaves(record, recorder, [&](const Node& leaf) {
    if (leaf.operation == Operation::time) return recorder.time();
    if (leaf.operation == Operation::unknown) return recorder.unknown(leaf.a);
    if (leaf.operation == Operation::parameter) return node_of(leaf.a);
    return derivatives == Derivatives::zero ? recorder.constant(0.0) : recorder.derivative(leaf.a);
  });
}

std::vector<int> copy_with_leaves(const Record& record, Recorder& recorder,
                                  const std::function<int(const Node& leaf)>& node_of) {
  return copy_all(record, recorder, node_of, as_it_is);
}

}  // namespace sfdae::core
