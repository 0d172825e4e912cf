// Recorded equations F(t, x, x') = 0: an immutable graph, and properties that follow from its form.
//
// Folder expression: recorded equations: their graph, values and gradients in power series, patterns.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "expression/equation_names.h"
#include "expression/operation.h"
#include "expression/point_function.h"
#include "linalg/index.h"

namespace sfdae::core {

// Quantities that a value depends on.
using Dependence = unsigned;
using StoredDependence = std::uint8_t;
constexpr Dependence on_parameters = 1, on_time = 2, on_unknowns = 4, on_derivatives = 8;
constexpr Dependence on_state = on_unknowns | on_derivatives;
constexpr bool varies_in_time(Dependence dependence) { return (dependence & (on_time | on_state)) != 0; }

// Operands come before the node.
struct Node {
  Operation operation;
  int a = -1, b = -1, c = -1;
};

// Operands of a node of a graph with these calls.
class Operands {
 public:
  Operands(const Node& node, const std::vector<FunctionCall>& calls)
      : node_(node), call_(node.operation == Operation::function ? &calls[index(node.a)] : nullptr) {}
  int size() const {
    return call_ != nullptr ? static_cast<int>(call_->arguments.size()) : num_operands(node_.operation);
  }
  int operator[](int k) const {
    if (call_ != nullptr) return call_->arguments[index(k)];
    return k == 0 ? node_.a : k == 1 ? node_.b : node_.c;
  }

 private:
  Node node_;
  const FunctionCall* call_;
};

// The nodes of a graph that is complete, stored compactly.
class Nodes {
 public:
  explicit Nodes(const std::vector<Node>& nodes);
  std::size_t size() const { return operations_.size(); }
  Node operator[](std::size_t i) const {
    const Node node{operations_[i], operand(2 * i), operand(2 * i + 1), -1};
    return node.operation == Operation::choose ? with_third_operand(node, static_cast<int>(i)) : node;
  }

 private:
  static constexpr unsigned low_bits = 16, byte_bits = 8;
  void add_operand(int operand);
  int operand(std::size_t k) const {
    unsigned value = low_[k];
    for (std::size_t byte = 0; byte < high_bytes_; ++byte)
      value |= static_cast<unsigned>(high_[k * high_bytes_ + byte]) << (low_bits + byte_bits * byte);
    return static_cast<int>(value) - 1;
  }
  struct Third {
    int node, c;
  };
  Node with_third_operand(Node node, int i) const;

  std::vector<Operation> operations_;
  // One more than operands, two of each node: 16 bits of them, and as many bytes more as the largest one has.
  std::vector<std::uint16_t> low_;
  std::vector<std::uint8_t> high_;
  std::size_t high_bytes_ = 0;
  std::vector<Third> thirds_;  // by nodes, which are choices
};

struct Parameter {
  std::string name;
  double value;  // at first
};

// A node on whose sign choices depend: the sign of its sum with a parameter, which only held_conditions.h sets.
struct Condition {
  int node, parameter;
  // Its sign changes within a layer that is thinner than errors of x between the points of a step
  // (regularized_conditions.h).
  bool is_of_layer = false;
};

// A node and the values at which equations switch: 0 for the condition of a choice, integers for floor, knots for a
// table.
struct SwitchingNode {
  Operation operation;
  int node;
  const PointFunction* table = nullptr;
};

// An entry of F_x or F_x' that is not identically zero.
struct Entry {
  Entry(int j, bool is_derivative, Dependence its_dependence)
      : unknown(j & 0x3ffffff), derivative(is_derivative), dependence(its_dependence & 0xf) {}
  int unknown : 27;     // j of x_j
  bool derivative : 1;  // x'_j instead
  Dependence dependence : 4;
  bool is_constant() const { return !varies_in_time(dependence); }
};

class Record {
 public:
  struct Parts {
    int num_unknowns = 0;
    std::vector<Node> nodes;
    std::vector<double> constants;
    std::vector<FunctionCall> calls;
    std::vector<Parameter> parameters;            // the user's, then those of conditions
    std::vector<Condition> conditions;            // that can be held
    std::vector<SwitchingNode> timed_switches;    // of t and the user's parameters alone
    std::vector<SwitchingNode> stepped_switches;  // of x or x', which cannot be held
    std::vector<int> residuals;                   // nodes, one for each equation
    EquationNames equation_names;
    std::vector<std::string> formulas;  // what messages call equations that are none, entries of M, say; else empty
  };

  explicit Record(Parts parts);

  int m() const { return static_cast<int>(parts_.residuals.size()); }
  int n() const { return parts_.num_unknowns; }
  int num_nodes() const { return static_cast<int>(nodes_.size()); }
  Node node(int i) const { return nodes_[index(i)]; }
  Operands operands(int i) const { return {node(i), parts_.calls}; }
  // The function of a node that calls one.
  const PointFunction& function(const Node& node) const { return *parts_.calls[index(node.a)].function; }
  const FunctionCall& call(int i) const { return parts_.calls[index(node(i).a)]; }
  Dependence dependence(int i) const { return dependence_[index(i)]; }
  bool is_active(int i) const { return (dependence(i) & on_state) != 0; }
  double constant(int i) const { return parts_.constants[index(i)]; }
  int residual(int equation) const { return parts_.residuals[index(equation)]; }
  // Name of an equation in messages.
  std::string name(int equation) const;
  const EquationNames& equation_names() const { return parts_.equation_names; }
  const std::vector<Parameter>& parameters() const { return parts_.parameters; }
  int num_user_parameters() const { return static_cast<int>(parts_.parameters.size() - parts_.conditions.size()); }
  const std::vector<Condition>& conditions() const { return parts_.conditions; }
  const std::vector<SwitchingNode>& timed_switches() const { return parts_.timed_switches; }
  const std::vector<SwitchingNode>& stepped_switches() const { return parts_.stepped_switches; }

  // Sparsity of F_x and F_x'.
  std::span<const Entry> entries(int equation) const {
    return {entries_.data() + first_entry_[index(equation)], entries_.data() + first_entry_[index(equation + 1)]};
  }

  // F is affine in (x, x') with coefficients that depend on t and parameters only. Judged by form: x1 x1 - x1 x1
  // counts as nonlinear.
  bool is_linear() const;
  // Linear, and F_x' (F_x) does not depend on t.
  bool is_constant_E() const { return is_linear() && is_constant(true); }
  bool is_constant_A() const { return is_linear() && is_constant(false); }

 private:
  bool is_constant(bool derivative) const;

  Parts parts_;  // but for the nodes
  Nodes nodes_;
  std::vector<StoredDependence> dependence_;
  std::vector<Entry> entries_;  // of all equations
  std::vector<std::uint32_t> first_entry_{0};
  bool jumps_ = false;  // a choice depends on x or x'
};

StoredDependence dependence_of(const Node& node, const Operands& operands, const StoredDependence* dependence);

// Dependence of the derivative of a node by its operand number k.
Dependence dependence_of_partial(const Record& record, int node, int k);

// The adjoint of a node is the derivative of one equation by it.
struct Adjoint {
  int node;
  Dependence dependence;
};

// Walks from equations to the unknowns.
class BackwardWalk {
 public:
  explicit BackwardWalk(const Record& record);
  // The nodes that carry the equation's dependence on x and x', last ones first.
  const std::vector<Adjoint>& walk(int equation);

 private:
  const Record& record_;
  std::vector<int> visited_;  // by which equation; -1: none
  std::vector<Dependence> dependence_;
  std::vector<int> stack_;
  std::vector<Adjoint> adjoints_;
};

}  // namespace sfdae::core
