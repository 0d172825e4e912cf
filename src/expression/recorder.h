// Recording of equations: equal nodes are shared, constants are folded, trivial algebra is simplified.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "expression/record.h"
#include "linalg/index.h"

namespace sfdae::core {

class Recorder {
 public:
  explicit Recorder(int num_unknowns) { parts_.num_unknowns = num_unknowns; }

  int num_nodes() const { return static_cast<int>(parts_.nodes.size()); }

  // Each returns a node; operands are nodes.
  int constant(double value);  // finite
  // One node for every name; the first value counts.
  int parameter(const std::string& name, double value);
  int time() { return intern({Operation::time}); }
  int unknown(int j) { return intern({Operation::unknown, j}); }
  int derivative(int j) { return intern({Operation::derivative, j}); }
  // Any operation but a leaf; a^b with any b.
  int apply(Operation operation, int a, int b = -1, int c = -1);

  int min(int a, int b) { return apply(Operation::choose, compared(b, a), a, b); }
  int max(int a, int b) { return apply(Operation::choose, compared(a, b), a, b); }
  // The derivative at 0 is 1.
  int abs(int a) { return apply(Operation::choose, apply(Operation::negate, a), apply(Operation::negate, a), a); }

  // 1 if it holds, else 0.
  int greater(int a, int b) { return when(compared(a, b), 1.0, 0.0); }
  int greater_equal(int a, int b) { return when(compared(b, a), 0.0, 1.0); }
  // Logic: a truth value > 0 is true.
  int conjunction(int a, int b) { return apply(Operation::choose, a, when(b, 1.0, 0.0), constant(0.0)); }
  int disjunction(int a, int b) { return apply(Operation::choose, a, constant(1.0), when(b, 1.0, 0.0)); }
  int negation(int a) { return when(a, 0.0, 1.0); }
  int sign(int a) {
    const int otherwise = when(apply(Operation::negate, a), -1.0, 0.0);
    return apply(Operation::choose, a, constant(1.0), otherwise);
  }

  // A partial derivative of a function, or its value; arguments are nodes.
  int call(const FunctionCall& call);

  int num_parameters() const { return static_cast<int>(parts_.parameters.size()); }
  const Node& node(int i) const { return parts_.nodes[index(i)]; }
  Operands operands(int i) const { return {node(i), parts_.calls}; }
  const FunctionCall& called(int i) const { return parts_.calls[index(node(i).a)]; }
  // The value of a constant.
  std::optional<double> number(int i) const;

  // The equations; the recorder is empty afterwards.
  std::shared_ptr<const Record> finish(std::vector<int> residuals, EquationNames names = {});
  // Sets the switches of the next record: conditions that can be held, with the last parameters, and all others.
  void set_switches(std::vector<Condition> conditions, std::vector<SwitchingNode> timed,
                    std::vector<SwitchingNode> stepped) {
    parts_.conditions = std::move(conditions);
    parts_.timed_switches = std::move(timed);
    parts_.stepped_switches = std::move(stepped);
  }
  // Equations with the first num_unknowns unknowns, and their names in messages; recording can go on.
  std::shared_ptr<const Record> excerpt(int num_unknowns, std::vector<int> residuals,
                                        std::vector<std::string> names) const;

 private:
  bool is(int i, double value) const { return number(i) == value; }
  bool is(int i, Operation operation) const { return node(i).operation == operation; }
  // The node, new or known.
  int intern(const Node& node);
  std::size_t place_of(const Node& node) const;
  void make_room_for_places();
  int negate(int a);
  int add(int a, int b);
  int subtract(int a, int b);
  int compared(int a, int b);
  int multiply(int a, int b);
  int divide(int a, int b);
  int power(int a, int b);
  int integer_power(int a, int exponent);
  int choose(int c, int a, int b);
  // One of two numbers.
  int when(int c, double a, double b) { return apply(Operation::choose, c, constant(a), constant(b)); }

  Record::Parts parts_;
  std::vector<StoredDependence> dependence_;
  // Hash table of nodes with open addressing, at most half full, its size a power of two. -1: free.
  std::vector<int> known_;
  std::unordered_map<std::uint64_t, int> constants_;  // index by the bits of the value
};

}  // namespace sfdae::core
