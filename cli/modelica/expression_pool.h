// Constructs expressions: equal ones share a node, constant ones are evaluated, neutral operations are omitted.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "model/expression.h"

namespace sfdae::cli {

// The value of an operation on numbers; none for time, sample, ...
std::optional<double> apply(Operation operation, const std::vector<double>& operands);

class ExpressionPool {
 public:
  explicit ExpressionPool(std::string file) : file_(std::move(file)) {}

  Expression number(double value, Location at = {});
  Expression truth(bool value, Location at = {}) { return number(value ? 1.0 : 0.0, at); }
  // time, initial, terminal
  Expression leaf(Operation operation, Location at);
  // variable, derivative, previous. varies: not a parameter.
  Expression variable(Operation operation, int index, bool varies, Location at);
  Expression make(Operation operation, std::vector<Expression> operands, Location at);
  // Summed in pairs, so that long sums are not deep.
  Expression sum(const std::vector<Expression>& terms, Location at);

  // Not determined by constants and parameters.
  bool varies(const Expression& e) const { return facts(e).varies; }
  // Contains an operation that generates events.
  bool has_events(const Expression& e) const { return facts(e).has_events; }

  // Limit on the expansion of a file: about 1 GB.
  static constexpr size_t kMaxNodes = 4'000'000;
  // Limit on the nesting of operations, because functions on expressions may recurse.
  static constexpr int kMaxDepth = 2000;

 private:
  struct Facts {
    int depth = 1;
    bool varies = false, has_events = false;
  };
  struct Hash {
    size_t operator()(const Expression& e) const;
  };
  struct Same {
    bool operator()(const Expression& a, const Expression& b) const;
  };

  const Facts& facts(const Expression& e) const { return nodes_.find(e)->second; }
  Expression keep(Node node, bool varies);
  Expression simplified(Operation operation, const std::vector<Expression>& operands, Location at);
  Expression simplified_arithmetic(Operation operation, const std::vector<Expression>& operands, Location at);
  Expression simplified_logic(Operation operation, const std::vector<Expression>& operands);

  std::string file_;
  std::unordered_map<Expression, Facts, Hash, Same> nodes_;
};

bool is_number(const Expression& e);
bool is_number(const Expression& e, double value);

}  // namespace sfdae::cli
