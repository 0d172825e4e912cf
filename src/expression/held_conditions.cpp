// Conditions on x or x' of recorded equations, and the branches that choices take.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/held_conditions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "expression/node_copies.h"
#include "expression/recorder.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// More than any value of a condition: the sum with it has its sign. The sum does not overflow.
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

// Parameters in the conditions of choices, if these vary with x.
class Branches {
 public:
  explicit Branches(const Record& record)
      : record_(record), varies_(varying_nodes(record)), is_live_(live_nodes(record)), recorder_(record.n()) {}

  std::shared_ptr<const Record> record() {
    const std::vector<int> copies = copy_with_conditions(
        record_, recorder_, [this](int choice, int condition) { return with_branch(choice, condition); });
    std::vector<int> residuals;
    for (int i = 0; i < record_.m(); ++i) residuals.push_back(copies[index(record_.residual(i))]);
    return recorder_.finish(std::move(residuals), record_.equation_names(), std::move(conditions_));
  }

 private:
  int with_branch(int choice, int g) {
    const int condition = record_.node(choice).a;
    if (varies_[index(condition)] == 0 || !is_live_[index(choice)]) return g;
    const auto [place, is_new] = sums_.try_emplace(condition, -1);
    if (!is_new) return place->second;
    const int number = recorder_.num_parameters();
    const int parameter = recorder_.parameter(unused_name(record_, conditions_.size() + 1), 0.0);
    conditions_.push_back({g, number});
    place->second = recorder_.apply(Operation::add, g, parameter);
    return place->second;
  }

  const Record& record_;
  std::vector<char> varies_;
  std::vector<bool> is_live_;
  Recorder recorder_;
  std::map<int, int> sums_;  // by the node of the condition
  std::vector<Condition> conditions_;
};

bool has_conditions(const Record& record) {
  const std::vector<char> varies = varying_nodes(record);
  for (int i = 0; i < record.num_nodes(); ++i) {
    const Node node = record.node(i);
    if (node.operation == Operation::choose && varies[index(node.a)] != 0) return true;
  }
  return false;
}

std::shared_ptr<const Record> functions_of(const Record& record) {
  Recorder recorder(record.n());
  const std::vector<int> copies = copy_nodes(record, recorder);
  std::vector<int> functions;
  for (const Condition& condition : record.conditions()) functions.push_back(copies[index(condition.node)]);
  return recorder.finish(std::move(functions));
}

}  // namespace

std::shared_ptr<const Record> with_conditions(std::shared_ptr<const Record> record) {
  return has_conditions(*record) ? Branches(*record).record() : record;
}

HeldConditions::HeldConditions(TaylorEvaluator& evaluator, std::function<void()> changed)
    : evaluator_(evaluator), changed_(std::move(changed)), conditions_(evaluator.record().conditions()) {
  if (conditions_.empty()) return;
  const Record& record = evaluator.record();
  functions_.emplace(functions_of(record));
  jet_.resize(2 * index(record.n()));
  for (std::size_t k = 0; k < count(); ++k) {
    alone_.push_back({static_cast<int>(k)});
    const Dependence dependence = record.dependence(conditions_[k].node);
    depend_on_derivatives_ = depend_on_derivatives_ || (dependence & on_derivatives) != 0;
  }
}

void HeldConditions::load(const double* x, const double* xdot) {
  const std::size_t n = jet_.size() / 2;
  std::copy_n(x, n, jet_.begin());
  if (depend_on_derivatives_) std::copy_n(xdot, n, jet_.begin() + static_cast<std::ptrdiff_t>(n));
  if (version_ == evaluator_.changes_of_parameters()) return;
  for (int i = 0; i < functions_->num_parameters(); ++i) functions_->set_parameter(i, evaluator_.parameter(i));
  version_ = evaluator_.changes_of_parameters();
}

void HeldConditions::evaluate(double t, const double* x, const double* xdot, double* g) {
  load(x, xdot);
  if (functions_->values(t, jet_.data(), 0, g)) return;
  for (std::size_t k = 0; k < count(); ++k)
    if (!functions_->values_of(alone_[k], t, jet_.data(), 0, g)) g[k] = std::numeric_limits<double>::quiet_NaN();
}

std::vector<double> HeldConditions::resolution(double t, const double* x, const double* xdot, const double* changes) {
  const std::size_t n = jet_.size() / 2;
  load(x, xdot);
  std::vector<double> g(count()), gradients(count() * n), result(count(), std::numeric_limits<double>::infinity());
  if (!functions_->gradients(t, jet_.data(), {0, -1, 0}, g.data(), nullptr, gradients.data())) return result;
  std::fill(result.begin(), result.end(), 0.0);
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t k = 0; k < count(); ++k) result[k] += std::fabs(gradients[j * count() + k]) * changes[j];
  return result;
}

void HeldConditions::hold(const double* g) {
  for (std::size_t k = 0; k < count(); ++k)
    evaluator_.set_parameter(conditions_[k].parameter, g[k] > 0.0 ? held : -held);
  changed_();
}

void HeldConditions::release() {
  for (const Condition& condition : conditions_) evaluator_.set_parameter(condition.parameter, 0.0);
  changed_();
}

std::string HeldConditions::equation_with(std::size_t condition) const {
  const Record& record = evaluator_.record();
  std::vector<char> contains(index(record.num_nodes()), 0);
  contains[index(conditions_[condition].node)] = 1;
  for (int i = 0; i < record.num_nodes(); ++i) {
    const Operands operands = record.operands(i);
    for (int k = 0; k < operands.size(); ++k)
      if (contains[index(operands[k])] != 0) contains[index(i)] = 1;
  }
  for (int equation = 0; equation < record.m(); ++equation)
    if (contains[index(record.residual(equation))] != 0) return record.name(equation);
  return "the equations";
}

}  // namespace sfdae::core
