// Conditions on x or x' of recorded equations, and the branches that choices take.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/held_conditions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "expression/false_position.h"
#include "expression/node_copies.h"
#include "expression/recorder.h"
#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

// Larger than any value of a condition, so that it decides the sign of a sum. The sum does not overflow.
constexpr double held = 1e300;

// Flags of nodes that vary with x or x', and not from one number to another alone, as conditions of conditions do.
std::vector<char> varying_nodes(const Record& record) {
  std::vector<char> varies(index(record.num_nodes()), 0);
  for (int i = 0; i < record.num_nodes(); ++i) {
    const Operation operation = record.node(i).operation;
    const Operands operands = record.operands(i);
    bool any = operation == Operation::unknown || operation == Operation::derivative;
    for (int k = 0; k < operands.size(); ++k)
      any = any || (is_differentiated(operation, k) && varies[index(operands[k])] != 0);
    varies[index(i)] = any ? 1 : 0;
  }
  return varies;
}

std::string unused_name(const Record& record, std::size_t number) {
  std::string name = "branch " + std::to_string(number);
  const auto is_used = [&](const Parameter& parameter) { return parameter.name == name; };
  while (std::any_of(record.parameters().begin(), record.parameters().end(), is_used)) name += "'";
  return name;
}

// The first operand of a node that switches, its dependence, and the values it switches at.
struct Switching {
  SwitchingNode at;
  Dependence dependence = 0;
  bool is_timed() const { return dependence == (on_time | on_parameters); }
  // Choices can be held.
  bool is_stepped() const { return (dependence & on_state) != 0 && at.operation != Operation::choose; }
};
std::optional<Switching> switching_at(const Record& record, int i) {
  const Node node = record.node(i);
  switch (node.operation) {
    case Operation::choose:
    case Operation::floor: return Switching{{node.operation, node.a}, record.dependence(node.a)};
    case Operation::modulo:
      return Switching{{Operation::floor, node.a}, record.dependence(node.a) | record.dependence(node.b)};
    case Operation::function: break;
    default: return std::nullopt;
  }
  const FunctionCall& call = record.call(i);
  if (call.function->breakpoints().empty()) return std::nullopt;
  return Switching{{node.operation, call.arguments[0], call.function.get()}, record.dependence(call.arguments[0])};
}

// Parameters in the conditions of choices, if these vary with x.
class Branches {
 public:
  Branches(const Record& record, const std::vector<int>& layers)
      : record_(record),
        layers_(layers),
        varies_(varying_nodes(record)),
        is_live_(live_nodes(record)),
        recorder_(record.n()) {}

  std::shared_ptr<const Record> record() {
    const std::vector<int> copies = copy_with_choices(record_, recorder_, [this](const CopiedChoice& copied) {
      const int g = with_branch(copied.choice, copied.condition);
      return recorder_.apply(Operation::choose, g, copied.if_met, copied.otherwise);
    });
    std::vector<int> residuals;
    for (int i = 0; i < record_.m(); ++i) residuals.push_back(copies[index(record_.residual(i))]);
    std::vector<SwitchingNode> timed = switches(copies, &Switching::is_timed);
    std::vector<SwitchingNode> stepped = switches(copies, &Switching::is_stepped);
    recorder_.set_switches(std::move(conditions_), std::move(timed), std::move(stepped));
    return recorder_.finish(std::move(residuals), record_.equation_names());
  }

 private:
  // Switching nodes of the copy with that property.
  std::vector<SwitchingNode> switches(const std::vector<int>& copies, bool (Switching::*has_property)() const) {
    std::vector<SwitchingNode> found;
    for (int i = 0; i < record_.num_nodes(); ++i) {
      if (!is_live_[index(i)]) continue;
      const std::optional<Switching> switching = switching_at(record_, i);
      if (!switching || !((*switching).*has_property)()) continue;
      const Node node = record_.node(i);
      const int first = copies[index(switching->at.node)];
      const int place = node.operation == Operation::modulo
                            ? recorder_.apply(Operation::divide, first, copies[index(node.b)])
                            : first;
      found.push_back({switching->at.operation, place, switching->at.table});
    }
    return found;
  }

  int with_branch(int choice, int g) {
    const int condition = record_.node(choice).a;
    if (varies_[index(condition)] == 0 || !is_live_[index(choice)]) return g;
    const auto [place, is_new] = sums_.try_emplace(condition, -1);
    if (!is_new) return place->second;
    const int number = recorder_.num_parameters();
    const int parameter = recorder_.parameter(unused_name(record_, conditions_.size() + 1), 0.0);
    const bool is_of_layer = std::find(layers_.begin(), layers_.end(), condition) != layers_.end();
    conditions_.push_back({g, number, is_of_layer});
    place->second = recorder_.apply(Operation::add, g, parameter);
    return place->second;
  }

  const Record& record_;
  const std::vector<int>& layers_;
  std::vector<char> varies_;
  std::vector<bool> is_live_;
  Recorder recorder_;
  std::map<int, int> sums_;  // by the node of the condition
  std::vector<Condition> conditions_;
};

std::vector<int> nodes_of(const std::vector<Condition>& conditions) {
  std::vector<int> nodes;
  for (const Condition& condition : conditions) nodes.push_back(condition.node);
  return nodes;
}

std::vector<Condition> chosen(const std::vector<Condition>& conditions, const std::vector<std::size_t>& which) {
  std::vector<Condition> found;
  for (const std::size_t k : which) found.push_back(conditions[k]);
  return found;
}

std::vector<std::size_t> conditions_without_slopes(const Record& record) {
  std::vector<std::size_t> which;
  for (std::size_t k = 0; k < record.conditions().size(); ++k)
    if ((record.dependence(record.conditions()[k].node) & on_derivatives) == 0) which.push_back(k);
  return which;
}

std::vector<int> nodes_of(const std::vector<SwitchingNode>& switches) {
  std::vector<int> nodes;
  for (const SwitchingNode& each : switches) nodes.push_back(each.node);
  return nodes;
}

}  // namespace

bool contains_switches(const Record& record) {
  const std::vector<char> varies = varying_nodes(record);
  for (int i = 0; i < record.num_nodes(); ++i) {
    const Node node = record.node(i);
    if (node.operation == Operation::choose && varies[index(node.a)] != 0) return true;
    const std::optional<Switching> switching = switching_at(record, i);
    if (switching && (switching->is_timed() || switching->is_stepped())) return true;
  }
  return false;
}

std::shared_ptr<const Record> with_conditions(std::shared_ptr<const Record> record, const std::vector<int>& layers) {
  return contains_switches(*record) ? Branches(*record, layers).record() : record;
}

HeldConditions::HeldConditions(TaylorEvaluator& evaluator, std::function<void()> changed)
    : HeldConditions(evaluator, std::move(changed), {evaluator.record().m(), nullptr}) {}

HeldConditions::HeldConditions(TaylorEvaluator& evaluator, std::function<void()> changed, SuppliedResiduals supplied)
    : evaluator_(evaluator),
      changed_(std::move(changed)),
      supplied_(std::move(supplied)),
      conditions_(evaluator.record().conditions()),
      functions_(evaluator, nodes_of(conditions_)),
      timed_functions_(evaluator, nodes_of(evaluator.record().timed_switches())),
      stepped_functions_(evaluator, nodes_of(evaluator.record().stepped_switches())),
      searched_(conditions_without_slopes(evaluator.record())),
      search_(evaluator, chosen(conditions_, searched_)),
      g_searched_{std::vector<double>(count()), std::vector<double>(count())},
      jet_(2 * index(evaluator.record().n())),
      values_(index(supplied_.m)),
      other_(values_.size()),
      at_end_(values_.size()),
      here_(values_.size()),
      on_line_(conditions_.size()),
      stepped_branches_{std::vector<double>(stepped_functions_.count()),
                        std::vector<double>(stepped_functions_.count())} {}

void HeldConditions::hold(const double* g) {
  if (!can_be_held()) return;
  are_held_ = true;
  for (std::size_t k = 0; k < count(); ++k)
    evaluator_.set_parameter(conditions_[k].parameter, is_met(g[k]) ? held : -held);
  changed_();
}

bool HeldConditions::find_simple_switches(const PointsOfCurve& points, const double* g_start, const double* g_end) {
  g_searched_.start.clear();
  g_searched_.end.clear();
  for (const std::size_t k : searched_) {
    g_searched_.start.push_back(g_start[k]);
    g_searched_.end.push_back(g_end[k]);
  }
  return search_.find_simple(points, g_searched_.start.data(), g_searched_.end.data());
}

void HeldConditions::release() {
  if (!are_held_) return;
  are_held_ = false;
  for (const Condition& condition : conditions_) evaluator_.set_parameter(condition.parameter, 0.0);
  changed_();
}

// At values that are not numbers there is no switch.
std::optional<std::size_t> HeldConditions::stepped_switch(const Point& from, const Point& to) {
  const std::vector<SwitchingNode>& all = evaluator_.record().stepped_switches();
  if (all.empty()) return std::nullopt;
  stepped_functions_.evaluate(from.t, from.x, from.xdot, stepped_branches_.before.data());
  stepped_functions_.evaluate(to.t, to.x, to.xdot, stepped_branches_.after.data());
  for (std::size_t k = 0; k < all.size(); ++k) {
    const double before = stepped_branches_.before[k], after = stepped_branches_.after[k];
    if (std::isfinite(before) && std::isfinite(after) && branch_at(all[k], before) != branch_at(all[k], after))
      return k;
  }
  return std::nullopt;
}

std::vector<PassedSwitch> HeldConditions::passed(const Values& before, const Values& after) const {
  const QuietArithmetic quiet;
  std::vector<PassedSwitch> found;
  for (std::size_t k = 0; k < count(); ++k) {
    const double g = before.g[k], g_after = after.g[k];
    if (conditions_[k].is_of_layer || is_met(g) == is_met(g_after)) continue;
    const double part = g == g_after ? 1.0 : std::clamp(g / (g - g_after), 0.0, 1.0);
    const double t = std::isfinite(part) ? before.t + part * (after.t - before.t) : after.t;
    found.push_back({t, evaluator_.shared_record(), conditions_[k].node, true, is_met(g) ? 1.0 : 0.0,
                     is_met(g_after) ? 1.0 : 0.0});
  }
  std::sort(found.begin(), found.end(),
            [&](const PassedSwitch& a, const PassedSwitch& b) { return (a.t - b.t) * (after.t - before.t) < 0.0; });
  return found;
}

std::string HeldConditions::equation_with(std::size_t condition) const {
  if (supplied_.evaluate) return "the callbacks (condition " + std::to_string(condition) + ")";
  // Looks for the condition's parameter, as the recorder may rewrite the sum with it.
  const Record& record = evaluator_.record();
  int leaf = 0;
  while (record.node(leaf).operation != Operation::parameter ||
         record.node(leaf).a != conditions_[condition].parameter)
    ++leaf;
  return equation_with_node(leaf);
}

std::string HeldConditions::equation_with_stepped(std::size_t which) const {
  return equation_with_node(evaluator_.record().stepped_switches()[which].node);
}

std::string HeldConditions::equation_with_node(int node) const {
  const Record& record = evaluator_.record();
  std::vector<char> contains(index(record.num_nodes()), 0);
  contains[index(node)] = 1;
  for (int i = 0; i < record.num_nodes(); ++i) {
    const Operands operands = record.operands(i);
    for (int k = 0; k < operands.size(); ++k)
      if (contains[index(operands[k])] != 0) contains[index(i)] = 1;
  }
  for (int equation = 0; equation < record.m(); ++equation)
    if (contains[index(record.residual(equation))] != 0) return record.name(equation);
  return "the equations";
}

double HeldConditions::value_on_line(std::size_t k, const Point& from, const Point& to, double part) {
  const std::size_t n = jet_.size() / 2;
  for (std::size_t i = 0; i < n; ++i) {
    jet_[i] = from.x[i] + part * (to.x[i] - from.x[i]);
    jet_[n + i] = from.xdot[i] + part * (to.xdot[i] - from.xdot[i]);
  }
  functions_.evaluate(from.t + part * (to.t - from.t), jet_.data(), jet_.data() + n, on_line_.data());
  return on_line_[k];
}

// Residuals with the branches of these values of g.
bool HeldConditions::residuals(double t, const double* jet, const double* g, std::vector<double>& F) {
  const auto branch = [&](std::size_t k) { return g == nullptr ? 0.0 : is_met(g[k]) ? held : -held; };
  if (supplied_.evaluate) {
    std::vector<double> held_until_now(count());
    for (std::size_t k = 0; k < count(); ++k) {
      held_until_now[k] = evaluator_.parameter(conditions_[k].parameter);
      evaluator_.set_parameter(conditions_[k].parameter, branch(k));
    }
    const bool is_found = supplied_.evaluate(t, jet, F.data());
    for (std::size_t k = 0; k < count(); ++k) evaluator_.set_parameter(conditions_[k].parameter, held_until_now[k]);
    return is_found;
  }
  if (!beside_) beside_.emplace(evaluator_);
  for (int i = 0; i < evaluator_.record().num_user_parameters(); ++i)
    beside_->set_parameter(i, evaluator_.parameter(i));
  for (std::size_t k = 0; k < count(); ++k) beside_->set_parameter(conditions_[k].parameter, branch(k));
  return beside_->values(t, jet, 0, F.data());
}

HeldConditions::Passing HeldConditions::passing(std::size_t k, const double* g, const Point& from, const Point& to) {
  constexpr double near = 1e-12;  // of the line
  constexpr double none = 1e-6;   // fraction of the change by a branch at an end of the line: no change at the zero
  std::vector<double> one(g, g + count()), other = one;
  other[k] = is_met(one[k]) ? -1.0 : 1.0;  // g may be 0
  const auto change = [&](double part, std::vector<double>& result) {
    value_on_line(k, from, to, part);
    const double t = from.t + part * (to.t - from.t);
    if (!residuals(t, jet_.data(), one.data(), values_) || !residuals(t, jet_.data(), other.data(), other_))
      return false;
    for (std::size_t i = 0; i < values_.size(); ++i) result[i] = std::fabs(values_[i] - other_[i]);
    return true;
  };
  const auto value = [&](double part) { return value_on_line(k, from, to, part); };
  const double zero = zero_between(value, {0.0, 1.0, value(0.0), value(1.0)}, near);
  std::vector<double> at_zero(values_.size()), at_start(at_zero), at_end(at_zero);
  const bool has_start = change(0.0, at_start), has_end = change(1.0, at_end);
  // A branch that ends at the zero says nothing about it.
  if (!change(zero, at_zero) || !(has_start || has_end)) return Passing::jump;
  bool matters = false;
  for (std::size_t i = 0; i < at_zero.size(); ++i) {
    const double beside = std::max(at_start[i], at_end[i]);
    if (at_zero[i] > none * beside) return Passing::jump;
    matters = matters || beside > 0.0;
  }
  return matters ? Passing::kink : Passing::nothing;
}

// Finds the change of residuals from the branches at the point to those of g. With `changes`, only branches of clear
// signs are exchanged.
bool HeldConditions::changes_of_branches(const Point& at, const double* g, const double* changes,
                                         std::vector<double>& result) {
  const std::size_t n = jet_.size() / 2;
  std::copy_n(at.x, n, jet_.begin());
  std::copy_n(at.xdot, n, jet_.begin() + static_cast<std::ptrdiff_t>(n));
  functions_.evaluate(at.t, at.x, at.xdot, on_line_.data());
  if (changes != nullptr) {
    const std::vector<double> unclear = functions_.resolution(at.t, at.x, at.xdot, changes);
    for (std::size_t k = 0; k < count(); ++k)
      if (std::fabs(on_line_[k]) <= unclear[k]) on_line_[k] = g[k];
  }
  if (!residuals(at.t, jet_.data(), on_line_.data(), values_) || !residuals(at.t, jet_.data(), g, other_))
    return false;
  for (std::size_t i = 0; i < values_.size(); ++i) result[i] = std::fabs(values_[i] - other_[i]);
  return true;
}

// Returns whether `to`, a point with known changes of residuals, does not show the effect of branches here.
bool HeldConditions::leaves_no_trace(const Point& at, const double* g, const double* changes) {
  constexpr double shown = 2.0;  // multiple of the change at the second point
  if (!changes_of_branches(at, g, changes, here_)) return true;
  for (std::size_t i = 0; i < here_.size(); ++i)
    if (here_[i] > shown * at_end_[i]) return true;
  return false;
}

std::optional<std::size_t> HeldConditions::first_hidden(const double* g, const std::vector<Point>& between,
                                                        const Point& to, const double* changes) {
  if (!changes_of_branches(to, g, nullptr, at_end_)) std::fill(at_end_.begin(), at_end_.end(), 0.0);
  for (std::size_t k = 0; k < between.size(); ++k)
    if (leaves_no_trace(between[k], g, nullptr) && leaves_no_trace(between[k], g, changes)) return k;
  return std::nullopt;
}

std::vector<std::size_t> HeldConditions::timed_switches(double from, double to) {
  constexpr double apart = 100.0;  // of the time between: how far back a function is looked at
  constexpr double part = 0.5;     // fraction of its change since then: a function without a jump changes by less
  const std::vector<SwitchingNode>& all = evaluator_.record().timed_switches();
  std::vector<std::size_t> found;
  if (all.empty()) return found;
  const std::vector<double> nothing(jet_.size() / 2, 0.0);
  std::vector<double> earlier(all.size()), before(all.size()), after(all.size());
  const auto evaluate = [&](double t, std::vector<double>& values) {
    timed_functions_.evaluate(t, nothing.data(), nothing.data(), values.data());
  };
  evaluate(from - apart * (to - from), earlier);
  evaluate(from, before);
  evaluate(to, after);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const bool is_known = std::isfinite(before[k]) && std::isfinite(after[k]);
    if (std::isnan(before[k]) && std::isnan(after[k])) continue;
    if (is_known && branch_at(all[k], before[k]) == branch_at(all[k], after[k])) continue;
    const bool jumps =
        is_known && std::isgreater(std::fabs(after[k] - before[k]), part * std::fabs(before[k] - earlier[k]));
    if (!jumps) found.push_back(k);
  }
  return found;
}

// With x' = 0, so that residuals have a size.
bool HeldConditions::jumps_between(double from, double to, double earlier, const double* x) {
  constexpr double none = 1e-6;  // of the size of a residual; the time between is some roundings
  const std::size_t n = jet_.size() / 2;
  std::copy_n(x, n, jet_.begin());
  std::fill(jet_.begin() + static_cast<std::ptrdiff_t>(n), jet_.end(), 0.0);
  std::vector<double> size(values_.size(), 0.0);
  if (residuals(earlier, jet_.data(), nullptr, values_)) size = values_;
  if (!residuals(from, jet_.data(), nullptr, values_) || !residuals(to, jet_.data(), nullptr, other_)) return true;
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const double largest = std::max({std::fabs(size[i]), std::fabs(values_[i]), std::fabs(other_[i])});
    if (std::fabs(values_[i] - other_[i]) > none * largest) return true;
  }
  return false;
}

}  // namespace sfdae::core
