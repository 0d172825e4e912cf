// Derivatives of recorded equations by their parameters.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/parameter_gradient.h"

#include <string>
#include <utility>

#include "expression/recorder.h"
#include "expression/symbolic_gradient.h"
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

std::shared_ptr<const Record> parameter_gradient(const Record& record, const std::vector<int>& parameters) {
  Recorder recorder(record.n());
  for (const Parameter& parameter : record.parameters()) recorder.parameter(parameter.name, parameter.value);
  std::vector<int> copies, leaves;
  for (int i = 0; i < record.num_nodes(); ++i) copies.push_back(copy_node(record, i, copies, recorder));
  for (int j : parameters) {
    const Parameter& parameter = record.parameters()[index(j)];
    leaves.push_back(recorder.parameter(parameter.name, parameter.value));
  }
  const std::size_t m = index(record.m());
  std::vector<int> formulas(m * leaves.size());
  std::vector<std::string> names(formulas.size());
  for (int i = 0; i < record.m(); ++i) {
    const std::vector<int> gradient = symbolic_gradient(recorder, copies[index(record.residual(i))], leaves);
    for (std::size_t j = 0; j < leaves.size(); ++j) {
      formulas[index(i) + j * m] = gradient[j];
      names[index(i) + j * m] = "the derivative of " + record.name(i) + " by parameter \"" +
                                record.parameters()[index(parameters[j])].name + "\"";
    }
  }
  return recorder.excerpt(record.n(), std::move(formulas), std::move(names));
}

}  // namespace sfdae::core
