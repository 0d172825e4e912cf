// SPDX-License-Identifier: BSD-3-Clause
#include "expression/node_copies.h"

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Records node i of the record, whose operands are recorded as `copies` says; leaf: what parameters and derivatives
// become.
template <class Leaf>
int copy_node(const Record& record, int i, const std::vector<int>& copies, Recorder& recorder, Leaf leaf) {
  const Node node = record.node(i);
  switch (node.operation) {
    case Operation::constant: return recorder.constant(record.constant(node.a));
    case Operation::time: return recorder.time();
    case Operation::unknown: return recorder.unknown(node.a);
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
  return recorder.apply(node.operation, copy_of(node.a), copy_of(node.b), copy_of(node.c));
}

template <class Leaf>
std::vector<int> copy_all(const Record& record, Recorder& recorder, Leaf leaf) {
  std::vector<int> copies;
  for (int i = 0; i < record.num_nodes(); ++i) copies.push_back(copy_node(record, i, copies, recorder, leaf));
  return copies;
}

}  // namespace

std::vector<int> copy_nodes(const Record& record, Recorder& recorder) {
  for (const Parameter& parameter : record.parameters()) recorder.parameter(parameter.name, parameter.value);
  return copy_all(record, recorder, [&](const Node& node) {
    if (node.operation == Operation::derivative) return recorder.derivative(node.a);
    const Parameter& parameter = record.parameters()[index(node.a)];
    return recorder.parameter(parameter.name, parameter.value);
  });
}

std::vector<int> copy_values(const TaylorEvaluator& evaluator, Derivatives derivatives, Recorder& recorder) {
  return copy_with([&](int parameter) { return recorder.constant(evaluator.parameter(parameter)); },
                   evaluator.record(), derivatives, recorder);
}

std::vector<int> copy_with(const std::function<int(int parameter)>& node_of, const Record& record,
                           Derivatives derivatives, Recorder& recorder) {
  return copy_all(record, recorder, [&](const Node& node) {
    if (node.operation == Operation::parameter) return node_of(node.a);
    return derivatives == Derivatives::zero ? recorder.constant(0.0) : recorder.derivative(node.a);
  });
}

}  // namespace sfdae::core
