// Switches of recorded equations that an integration has passed.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/passed_switch.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <utility>

#include "expression/point_function.h"
#include "expression/source_code.h"
#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

// Replaces the names of unknowns by those in messages.
std::string with_names(std::string formula) {
  for (const auto& [name, better] : {std::pair("zdot[", "xdot["), std::pair("z[", "x[")}) {
    const std::size_t length = std::string(name).size();
    for (std::size_t at = formula.find(name); at != std::string::npos; at = formula.find(name, at + length))
      if (at == 0 || std::isalnum(static_cast<unsigned char>(formula[at - 1])) == 0)
        formula.replace(at, length, better);
  }
  return formula;
}

bool contains_functions(const Record& record, int node) {
  std::vector<char> is_part(index(node + 1), 0);
  is_part[index(node)] = 1;
  for (int i = node; i >= 0; --i) {
    if (is_part[index(i)] == 0) continue;
    if (record.node(i).operation == Operation::function) return true;
    const Operands operands = record.operands(i);
    for (int k = 0; k < operands.size(); ++k) is_part[index(operands[k])] = 1;
  }
  return false;
}

}  // namespace

double branch_at(const SwitchingNode& at, double value) {
  if (at.operation == Operation::choose) return is_met(value) ? 1.0 : 0.0;
  if (at.operation != Operation::function) return std::floor(value);
  const std::vector<double>& knots = at.table->breakpoints();
  return static_cast<double>(std::upper_bound(knots.begin(), knots.end(), value) - knots.begin());
}

std::string text_of(const PassedSwitch& passed) {
  if (passed.is_condition && passed.record->node(passed.node).operation == Operation::function)
    return passed.record->call(passed.node).function->name();
  if (contains_functions(*passed.record, passed.node)) return "a table or function";
  HelpersUsed helpers;
  std::string text = statements_of(*passed.record, {{"g", passed.node}}, Language::C, helpers).text;
  // Terms that are used twice have statements of their own, before it.
  if (const std::size_t assignment = text.rfind("g = "); assignment != std::string::npos) text.erase(assignment, 4);
  while (!text.empty() && (std::isspace(static_cast<unsigned char>(text.back())) != 0 || text.back() == ';'))
    text.pop_back();
  text = with_names(text.substr(std::min(text.find_first_not_of(' '), text.size())));
  return passed.is_condition ? text + " > 0" : text;
}

TimedSwitches::TimedSwitches(const std::vector<const TaylorEvaluator*>& evaluators) {
  for (const TaylorEvaluator* const evaluator : evaluators) {
    const Record& record = evaluator->record();
    const std::vector<bool> is_live = live_nodes(record);
    std::vector<SwitchingNode> switches;
    std::vector<int> arguments;
    for (int i = 0; i < record.num_nodes(); ++i) {
      const Node node = record.node(i);
      const bool is_call = node.operation == Operation::function;
      const bool has_knots = is_call && !record.call(i).function->breakpoints().empty();
      const bool switches_here = node.operation == Operation::choose || node.operation == Operation::floor ||
                                 node.operation == Operation::modulo || has_knots;
      if (!is_live[index(i)] || !switches_here) continue;
      const int first = is_call ? record.call(i).arguments[0] : node.a;
      const int second = node.operation == Operation::modulo ? node.b : first;
      const Dependence dependence = record.dependence(first) | record.dependence(second);
      if ((dependence & on_time) == 0 || (dependence & on_state) != 0) continue;
      const PointFunction* const table = is_call ? record.call(i).function.get() : nullptr;
      const int at = node.operation == Operation::choose ? first : i;
      switches.push_back({node.operation, at, table});
      arguments.insert(arguments.end(), {first, second});
    }
    if (switches.empty()) continue;
    parts_.push_back({evaluator->shared_record(), std::move(switches), ConditionFunctions(*evaluator, arguments)});
  }
}

std::vector<PassedSwitch> TimedSwitches::passed(double from, double to) {
  const QuietArithmetic quiet;
  std::vector<PassedSwitch> found;
  for (Part& part : parts_) {
    const std::vector<double> nothing(index(part.record->n()), 0.0);
    std::vector<double> before(part.arguments.count()), after(before);
    part.arguments.evaluate(from, nothing.data(), nothing.data(), before.data());
    part.arguments.evaluate(to, nothing.data(), nothing.data(), after.data());
    for (std::size_t k = 0; k < part.switches.size(); ++k) {
      const SwitchingNode& at = part.switches[k];
      const auto branch = [&](const std::vector<double>& values) {
        const double first = values[2 * k];
        return branch_at(at, at.operation == Operation::modulo ? first / values[2 * k + 1] : first);
      };
      const double branch_before = branch(before), branch_after = branch(after);
      if (std::isnan(branch_before) || std::isnan(branch_after) || branch_before == branch_after) continue;
      const bool is_condition = at.operation == Operation::choose;
      found.push_back({0.5 * (from + to), part.record, at.node, is_condition, branch_before, branch_after});
    }
  }
  return found;
}

}  // namespace sfdae::core
