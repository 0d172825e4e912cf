// Arrays and records assembled from scalar names such as a.b[1].c: exports with scalar variables still use whole
// arrays.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "modelica/elaboration.h"

namespace sfdae::cli {

class NameTree {
 public:
  // name: without quotes; key: the argument of lookup.
  void add(const std::string& name, const std::string& key);
  bool empty() const { return root_.members.empty(); }

  // The array or record whose parts were added, or a part of a variable that was added. lookup: value of a key.
  using Lookup = std::function<ValuePointer(const std::string& key)>;
  std::optional<Value> find(Elaboration& e, const std::string& name, Location at, const Lookup& lookup) const;

 private:
  struct Part {
    std::string key;                            // empty: not a declared name itself
    std::map<std::string, Part> members;        // .name
    std::map<std::vector<int>, Part> elements;  // [1,2]
  };
  struct Step {
    std::string member;  // empty: subscripts
    std::vector<int> subscripts;
  };
  static std::vector<Step> steps(const std::string& name);
  static Value assemble(Elaboration& e, const Part& part, Location at, const Lookup& lookup);
  static Value assemble_array(Elaboration& e, const Part& part, Location at, const Lookup& lookup);
  static std::optional<Value> descend(Elaboration& e, Value value, const std::vector<Step>& rest, size_t first,
                                      Location at);

  Part root_;
};

}  // namespace sfdae::cli
