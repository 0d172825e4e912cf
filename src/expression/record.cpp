// Properties of recorded equations that follow from their form.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/record.h"

#include <algorithm>
#include <utility>

#include "linalg/index.h"

namespace sfdae::core {

StoredDependence dependence_of(const Node& node, const Operands& operands, const StoredDependence* dependence) {
  switch (node.operation) {
    case Operation::constant: return 0;
    case Operation::parameter: return on_parameters;
    case Operation::time: return on_time;
    case Operation::unknown: return on_unknowns;
    case Operation::derivative: return on_derivatives;
    default: break;
  }
  Dependence result = 0;
  for (int k = 0; k < operands.size(); ++k) result |= dependence[operands[k]];
  return static_cast<StoredDependence>(result);
}

Dependence dependence_of_partial(const Record& record, int node, int k) {
  const Node v = record.node(node);
  switch (v.operation) {
    case Operation::negate:
    case Operation::add:
    case Operation::subtract: return 0;
    case Operation::multiply: return record.dependence(k == 0 ? v.b : v.a);
    case Operation::modulo: return k == 0 ? 0 : record.dependence(node);
    case Operation::divide: return k == 0 ? record.dependence(v.b) : record.dependence(node);
    case Operation::choose: return record.dependence(v.a);
    default: return record.dependence(node);
  }
}

namespace {

// A value jumps, or has a kink, where x or x' pass certain values.
bool jumps_with_state(const Record& record, const Node& node) {
  switch (node.operation) {
    case Operation::choose:
    case Operation::floor: return record.is_active(node.a);
    case Operation::modulo: return record.is_active(node.a) || record.is_active(node.b);
    default: return false;
  }
}

}  // namespace

Nodes::Nodes(const std::vector<Node>& nodes) {
  operations_.reserve(nodes.size());
  int largest = -1;
  for (const Node& node : nodes) largest = std::max({largest, node.a, node.b});
  for (unsigned rest = static_cast<unsigned>(largest + 1) >> low_bits; rest > 0; rest >>= byte_bits) ++high_bytes_;
  low_.reserve(2 * nodes.size());
  high_.reserve(2 * nodes.size() * high_bytes_);
  for (const Node& node : nodes) {
    if (node.operation == Operation::choose) thirds_.push_back({static_cast<int>(operations_.size()), node.c});
    operations_.push_back(node.operation);
    for (int operand : {node.a, node.b}) add_operand(operand);
  }
}

void Nodes::add_operand(int operand) {
  const unsigned value = static_cast<unsigned>(operand + 1);
  low_.push_back(static_cast<std::uint16_t>(value & 0xffff));
  for (std::size_t byte = 0; byte < high_bytes_; ++byte)
    high_.push_back(static_cast<std::uint8_t>((value >> (low_bits + byte_bits * byte)) & 0xff));
}

Node Nodes::with_third_operand(Node node, int i) const {
  const auto third = std::lower_bound(thirds_.begin(), thirds_.end(), i,
                                      [](const Third& candidate, int wanted) { return candidate.node < wanted; });
  node.c = third->c;
  return node;
}

Record::Record(Parts parts) : parts_(std::move(parts)), nodes_(parts_.nodes) {
  dependence_.reserve(parts_.nodes.size());
  for (const Node& node : parts_.nodes)
    dependence_.push_back(dependence_of(node, {node, parts_.calls}, dependence_.data()));
  std::vector<Node>().swap(parts_.nodes);
  BackwardWalk backward(*this);
  for (int i = 0; i < m(); ++i) {
    for (const Adjoint& adjoint : backward.walk(i)) {
      const Node carrier = node(adjoint.node);
      // A choice between numbers has no derivative, and jumps.
      jumps_ = jumps_ || jumps_with_state(*this, carrier);
      if (!is_leaf(carrier.operation)) continue;
      entries_.emplace_back(carrier.a, carrier.operation == Operation::derivative, adjoint.dependence);
    }
    first_entry_.push_back(static_cast<std::uint32_t>(entries_.size()));
  }
  entries_.shrink_to_fit();
  first_entry_.shrink_to_fit();
}

std::string Record::name(int equation) const {
  if (parts_.formulas.empty()) return parts_.equation_names.in_words(equation);
  return parts_.formulas[index(equation)];
}

bool Record::is_linear() const {
  if (jumps_) return false;
  return std::none_of(entries_.begin(), entries_.end(),
                      [](const Entry& entry) { return (entry.dependence & on_state) != 0; });
}

bool Record::is_constant(bool derivative) const {
  return std::none_of(entries_.begin(), entries_.end(), [derivative](const Entry& entry) {
    return entry.derivative == derivative && !entry.is_constant();
  });
}

BackwardWalk::BackwardWalk(const Record& record)
    : record_(record), visited_(index(record.num_nodes()), -1), dependence_(index(record.num_nodes())) {}

const std::vector<Adjoint>& BackwardWalk::walk(int equation) {
  adjoints_.clear();
  const auto visit = [&](int node) {
    if (!record_.is_active(node) || visited_[index(node)] == equation) return;
    visited_[index(node)] = equation;
    dependence_[index(node)] = 0;
    adjoints_.push_back({node, 0});
    stack_.push_back(node);
  };
  visit(record_.residual(equation));
  while (!stack_.empty()) {
    const int node = stack_.back();
    stack_.pop_back();
    const Operands operands = record_.operands(node);
    for (int k = 0; k < operands.size(); ++k)
      if (is_differentiated(record_.node(node).operation, k)) visit(operands[k]);
  }
  // Operands come before the node, so this order is one in which every adjoint is complete when it is reached.
  std::sort(adjoints_.begin(), adjoints_.end(), [](const Adjoint& v, const Adjoint& w) { return v.node > w.node; });
  for (Adjoint& adjoint : adjoints_) {
    adjoint.dependence = dependence_[index(adjoint.node)];
    const Operands operands = record_.operands(adjoint.node);
    for (int k = 0; k < operands.size(); ++k)
      if (is_differentiated(record_.node(adjoint.node).operation, k))
        dependence_[index(operands[k])] |= adjoint.dependence | dependence_of_partial(record_, adjoint.node, k);
  }
  return adjoints_;
}

}  // namespace sfdae::core
