// Calls of functions of the package, expanded to formulas by executing their algorithms on formulas.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <vector>

#include "modelica/elaboration.h"
#include "modelica/record.h"

namespace sfdae::cli {

// Results of calls by their arguments, and the functions that are being expanded.
struct FunctionMemory {
  struct Result {
    std::vector<Value> outputs;
    std::vector<Assertion> assertions;
  };
  std::map<std::vector<const void*>, Result> results;
  std::vector<const syntax::Definition*> active;
};

// All outputs. If scalar inputs get arrays, the function is called for every element.
std::vector<Value> call_function(Elaboration& e, const Environment& in, const syntax::Definition& function,
                                 const std::vector<Argument>& arguments, Location at);

}  // namespace sfdae::cli
