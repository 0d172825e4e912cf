// Expressions of the model as formulas: parameters become numbers, relations that make events become switches.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <map>
#include <tuple>
#include <unordered_map>

#include "simulation/parameters.h"
#include "simulation/system.h"

namespace sfdae::cli {

// What relations of continuous quantities are.
enum class Context {
  events,    // switches
  stepwise,  // switches, and so is sign: a value is needed that changes at events only
  literal,   // as they stand, since within noEvent; but what jumps to other integers is a switch
  instant    // as they stand, in what is evaluated at events only
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
