// A number that tells recorded equations apart.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/fingerprint.h"

#include <cstdint>
#include <string>

namespace sfdae::core {

namespace {

void add_text(const std::string& text, WordHash& hash) {
  hash.add(text.size());
  for (const char letter : text) hash.add(static_cast<unsigned char>(letter));
}

void add_call(const FunctionCall& call, WordHash& hash) {
  add_text(call.function->name(), hash);
  call.function->add_data(hash);
  hash.add_all(call.arguments);
  hash.add_all(call.by);
}

}  // namespace

void add_equations(const Record& record, WordHash& hash) {
  const int sizes[] = {record.m(), record.n(), record.num_nodes()};
  hash.add_all(sizes);
  for (int i = 0; i < record.num_nodes(); ++i) {
    const Node node = record.node(i);
    hash.add(static_cast<std::uint64_t>(node.operation));
    if (node.operation == Operation::function) {
      add_call(record.call(i), hash);
    } else if (node.operation == Operation::constant) {
      const double value = record.constant(node.a);
      hash.add(&value, 1);
    } else {
      const int operands[] = {node.a, node.b, node.c};
      hash.add_all(operands);
    }
  }
  for (const Parameter& parameter : record.parameters()) add_text(parameter.name, hash);
  for (int equation = 0; equation < record.m(); ++equation)
    hash.add(static_cast<std::uint64_t>(record.residual(equation)));
}

}  // namespace sfdae::core
