// The nodes of a record recorded once more.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "expression/record.h"
#include "expression/recorder.h"
#include "expression/taylor_evaluator.h"

namespace sfdae::core {

// Copies the nodes of the record. Returns the recorder's number of each; parameters keep their numbers if the recorder
// has none yet.
std::vector<int> copy_nodes(const Record& record, Recorder& recorder);
// Copies with each choice replaced by copy_of, given the copies of its operands, and with 0 in place of the parameters
// of conditions.
struct CopiedChoice {
  int choice;  // in the record
  int condition, if_met, otherwise;
};
std::vector<int> copy_with_choices(const Record& record, Recorder& recorder,
                                   const std::function<int(const CopiedChoice&)>& copy_of);
// Copies with parameters replaced by their present values, and x' by 0 unless it is kept.
enum class Derivatives { kept, zero };
std::vector<int> copy_values(const TaylorEvaluator& evaluator, Derivatives derivatives, Recorder& recorder);
// Copies with parameters replaced by the caller's nodes, by their numbers.
std::vector<int> copy_with(const std::function<int(int parameter)>& node_of, const Record& record,
                           Derivatives derivatives, Recorder& recorder);

// Copies with time, parameters, unknowns and derivatives replaced by the caller's nodes.
std::vector<int> copy_with_leaves(const Record& record, Recorder& recorder,
                                  const std::function<int(const Node& leaf)>& node_of);

}  // namespace sfdae::core
