// The nodes of a record recorded once more.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "expression/record.h"
#include "expression/recorder.h"
#include "expression/taylor_evaluator.h"

namespace sfdae::core {

// Of each node of the record, the number that it has in the recorder; parameters keep their numbers if none are there
// yet.
std::vector<int> copy_nodes(const Record& record, Recorder& recorder);
// With what the caller makes of each choice in its place, given the copies of its operands; and 0 in place of the
// parameters of conditions.
struct CopiedChoice {
  int choice;  // in the record
  int condition, if_met, otherwise;
};
std::vector<int> copy_with_choices(const Record& record, Recorder& recorder,
                                   const std::function<int(const CopiedChoice&)>& copy_of);
// With the numbers that parameters have now in their place, and 0 in that of x' unless it is wanted.
enum class Derivatives { kept, zero };
std::vector<int> copy_values(const TaylorEvaluator& evaluator, Derivatives derivatives, Recorder& recorder);
// With nodes of the caller's in place of parameters, which he is asked for by their numbers.
std::vector<int> copy_with(const std::function<int(int parameter)>& node_of, const Record& record,
                           Derivatives derivatives, Recorder& recorder);

// With nodes of the caller's in place of time, parameters, unknowns and derivatives.
std::vector<int> copy_with_leaves(const Record& record, Recorder& recorder,
                                  const std::function<int(const Node& leaf)>& node_of);

}  // namespace sfdae::core
