// Records without formulas.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/opaque_record.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace sfdae::core {

namespace {

class OpaqueFunction final : public PointFunction {
 public:
  OpaqueFunction(std::string name, int num_arguments) : PointFunction(std::move(name), num_arguments) {}
  int derivatives(int, const double*, double*) const override { return cannot_evaluate; }

 private:
  static constexpr int cannot_evaluate = 1;  // as functions of users return it
};

void add_leaves(Operation operation, const ColumnPattern& pattern, Record::Parts& parts,
                std::vector<std::vector<int>>& arguments) {
  for (int j = 0; j < pattern.columns(); ++j) {
    const int first = pattern.start[index(j)], last = pattern.start[index(j + 1)];
    if (first == last) continue;
    const int leaf = static_cast<int>(parts.nodes.size());
    parts.nodes.push_back({operation, j});
    for (int e = first; e < last; ++e) arguments[index(pattern.row[index(e)])].push_back(leaf);
  }
}

Record::Parts opaque_parts(int num_equations, const JacobianPatterns& patterns,
                           const std::vector<std::string>& names) {
  Record::Parts parts;
  parts.num_unknowns = patterns.F_x.columns();
  parts.nodes.push_back({Operation::time, 0});
  std::vector<std::vector<int>> arguments(index(num_equations), std::vector<int>{0});
  add_leaves(Operation::unknown, patterns.F_x, parts, arguments);
  add_leaves(Operation::derivative, patterns.F_xdot, parts, arguments);
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    std::vector<int>& own = arguments[i];
    const int call = static_cast<int>(parts.calls.size());
    auto function = std::make_shared<const OpaqueFunction>(names[i], static_cast<int>(own.size()));
    parts.calls.push_back({std::move(function), std::move(own), {}});
    parts.residuals.push_back(static_cast<int>(parts.nodes.size()));
    parts.nodes.push_back({Operation::function, call});
  }
  return parts;
}

}  // namespace

Record opaque_record(int num_equations, const JacobianPatterns& patterns, const EquationNames& names) {
  Record::Parts parts = opaque_parts(num_equations, patterns, std::vector<std::string>(index(num_equations), "F"));
  parts.equation_names = names;
  return Record(std::move(parts));
}

Record opaque_conditions(int count, const JacobianPatterns& patterns, const std::vector<std::string>& names) {
  Record::Parts parts = opaque_parts(count, patterns, names);
  for (int k = 0; k < count; ++k) {
    parts.parameters.push_back({names[index(k)], 0.0});
    parts.conditions.push_back({parts.residuals[index(k)], k});
  }
  return Record(std::move(parts));
}

}  // namespace sfdae::core
