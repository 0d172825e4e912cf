// SPDX-License-Identifier: BSD-3-Clause
#include "expression/node_copies.h"

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Records node i of the record, whose operands are recorded as `copies` says.
int copy_node(const Record& record, int i, const std::vector<int>& copies, Recorder& recorder) {
  const Node& node = record.node(i);
  switch (node.operation) {
    case Operation::constant: return recorder.constant(record.constant(node.a));
    case Operation::parameter: {
      const Parameter& parameter = record.parameters()[index(node.a)];
      return recorder.parameter(parameter.name, parameter.value);
    }
    case Operation::time: return recorder.time();
    case Operation::unknown: return recorder.unknown(node.a);
    case Operation::derivative: return recorder.derivative(node.a);
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

}  // namespace

std::vector<int> copy_nodes(const Record& record, Recorder& recorder) {
  for (const Parameter& parameter : record.parameters()) recorder.parameter(parameter.name, parameter.value);
  std::vector<int> copies;
  for (int i = 0; i < record.num_nodes(); ++i) copies.push_back(copy_node(record, i, copies, recorder));
  return copies;
}

}  // namespace sfdae::core
