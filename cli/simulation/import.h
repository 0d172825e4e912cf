// Imports expressions of the model as formulas: parameters become numbers, relations that generate events become
// switches.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <map>
#include <tuple>
#include <unordered_map>

#include "simulation/parameters.h"
#include "simulation/system.h"

namespace sfdae::cli {

// Treatment of relations between continuous quantities.
enum class Context {
  events,    // switches
  stepwise,  // switches, and so is sign: the value needed may change only at events
  literal,   // literal, inside noEvent; but operations that jump between integers are switches
  instant    // literal, in formulas that are evaluated only at events
};

class Import {
 public:
  Import(System& system, const Parameters& parameters) : system_(system), parameters_(parameters) {}

  // Throws ModelError.
  Formula operator()(const Expression& expression, Context context = Context::events);

 private:
  Formula imported(const Node& node, Context context);
  Formula variable(const Node& node);
  Formula derivative(const Node& node);
  Formula relation(const Node& node, Formula a, Formula b, Context context);
  Formula sign(const Node& node, Formula a, Context context);
  Formula jump(const Node& node, Switch::Kind kind, Formula argument, Context context);
  Formula rounding(const Node& node, Formula a, Formula b, Context context);
  Formula sample(const Node& node, Formula start, Formula interval);
  Formula frozen(const Node& node, Switch it, Operation operation);
  double size_of(const Node& node) const;

  System& system_;
  const Parameters& parameters_;
  std::array<std::unordered_map<const Node*, Formula>, 4> known_;
  std::map<std::tuple<Switch::Kind, Operation, Formula, Formula>, int> known_switches_;
};

}  // namespace sfdae::cli
