// SPDX-License-Identifier: BSD-3-Clause
#include "modelica/symbols.h"

#include <algorithm>
#include <utility>

#include "modelica/arithmetic.h"
#include "modelica/lexer.h"
#include "modelica/symbol.h"

namespace sfdae::cli {

using syntax::Declaration;
using syntax::Prefix;

class Symbols::PackageScope : public Scope {
 public:
  explicit PackageScope(Symbols& symbols) : symbols_(symbols) {}
  ValuePointer find(const std::string& name, Location at) override {
    const Symbol* one = symbols_.symbol(name);
    return one != nullptr && one->is_global ? symbols_.find(name, at) : nullptr;
  }

 private:
  Symbols& symbols_;
};

Symbols::Symbols(Elaboration& e) : e_(e), package_(std::make_unique<PackageScope>(*this)) {
  const auto add = [&](const Declaration& declaration, bool is_global) {
    const auto [place, is_new] = by_name_.emplace(declaration.name, nullptr);
    if (!is_new && place->second->is_global == is_global)
      e.fail(declaration.at, "'" + plain(declaration.name) + "' is declared twice; remove or rename one");
    symbols_.push_back(std::make_unique<Symbol>());
    Symbol& one = *symbols_.back();
    one.declaration = &declaration;
    one.is_global = is_global;
    place->second = &one;
    if (!is_global) tree_.add(plain(declaration.name), declaration.name);
  };
  for (const Declaration& one : e.tree.constants) add(one, true);
  for (const Declaration& one : e.tree.model.elements) add(one, false);
}

Symbols::~Symbols() = default;

Scope& Symbols::package() { return *package_; }

Symbols::Symbol* Symbols::symbol(const std::string& name) {
  const auto found = by_name_.find(name);
  return found != by_name_.end() ? found->second : nullptr;
}

const Declaration* Symbols::declaration(const std::string& name) const {
  const auto found = by_name_.find(name);
  return found != by_name_.end() ? found->second->declaration : nullptr;
}

void Symbols::declare_all() {
  for (const auto& one : symbols_)
    if (!one->is_global) declare(*one);
  for (const auto& one : symbols_)
    if (!one->is_global) give_attributes(*one);
}

void Symbols::bind_all() {
  for (const auto& one : symbols_)
    if (!one->is_global) bind(*one);
}

ValuePointer Symbols::find(const std::string& name, Location at) {
  Symbol* one = symbol(name);
  if (one == nullptr) {
    if (name[0] != '\'') return nullptr;
    std::optional<Value> parts =
        tree_.find(e_, plain(name), at, [&](const std::string& key) { return find(key, at); });
    return parts ? std::make_shared<const Value>(std::move(*parts)) : nullptr;
  }
  if (one->declaring == Stage::running)
    e_.fail(at, "the type of '" + plain(name) + "' depends on itself; end the circle");
  declare(*one);
  if (one->is_constant() || one->has_texts) {
    if (one->binding_stage == Stage::running)
      e_.fail(at, "the value of the constant '" + plain(name) + "' depends on itself; end the circle");
    bind(*one);
  }
  return one->value;
}

int Symbols::add_variable(Variable variable) {
  const int index = static_cast<int>(e_.model.variables.size());
  if (!variable_names_.emplace(variable.name, index).second)
    e_.fail(variable.at, "'" + variable.name + "' is declared twice; remove or rename one");
  if (index >= Limits::kMaxVariables)
    e_.fail(variable.at,
            "more than " + std::to_string(Limits::kMaxVariables) + " scalar variables; make arrays smaller");
  e_.model.variables.push_back(std::move(variable));
  symbol_of_variable_.push_back(nullptr);
  parameter_stages_.push_back(Stage::none);
  return index;
}

Expression Symbols::variable_node(int index, Location at) {
  const bool varies = e_.model.variables[static_cast<size_t>(index)].variability >= Variability::discrete;
  return e_.pool.variable(Operation::variable, index, varies, at);
}

Expression Symbols::derivative_of_variable(int index, Location at) {
  const Variable& variable = e_.model.variables[static_cast<size_t>(index)];
  if (variable.variability != Variability::continuous) return e_.pool.number(0.0, at);
  return e_.pool.variable(Operation::derivative, index, true, at);
}

Expression Symbols::second_derivative(int index, Location at) {
  auto found = derivative_variables_.find(index);
  if (found == derivative_variables_.end()) {
    Variable velocity;
    const Variable& of = e_.model.variables[static_cast<size_t>(index)];
    velocity.name = "der(" + of.name + ")";
    velocity.description = "derivative of " + of.name;
    if (!of.unit.empty())
      velocity.unit = of.unit == "1" ? "1/s" : of.unit + (of.unit.find('/') == of.unit.npos ? "/s" : ".s-1");
    velocity.at = at;
    const int added = add_variable(std::move(velocity));
    e_.model.equations.push_back({e_.pool.variable(Operation::variable, added, true, at),
                                  e_.pool.variable(Operation::derivative, index, true, at), at});
    found = derivative_variables_.emplace(index, added).first;
  }
  return e_.pool.variable(Operation::derivative, found->second, true, at);
}

std::optional<double> Symbols::value_of(const Expression& x, Location at) {
  if (x->operation == Operation::number) return x->value;
  if (e_.pool.varies(x)) return std::nullopt;
  if (const auto found = values_.find(x.get()); found != values_.end()) return found->second;
  std::optional<double> result;
  if (x->operation == Operation::variable) {
    Symbol* one = symbol_of_variable_[static_cast<size_t>(x->index)];
    if (one != nullptr) give_attributes(*one);
    if (!e_.model.variables[static_cast<size_t>(x->index)].is_fixed) return std::nullopt;
    result = value_of_parameter(x->index, at);
    e_.model.variables[static_cast<size_t>(x->index)].is_structural = true;
  } else {
    std::vector<double> operands;
    for (const Expression& operand : x->operands) {
      const std::optional<double> value = value_of(operand, at);
      if (!value) return std::nullopt;
      operands.push_back(*value);
    }
    result = sfdae::cli::apply(x->operation, operands);
  }
  values_.emplace(x.get(), result);
  return result;
}

double Symbols::value_of_parameter(int index, Location at) {
  const auto k = static_cast<size_t>(index);
  const std::string name = e_.model.variables[k].name;
  Symbol* one = symbol_of_variable_[k];
  if (parameter_stages_[k] == Stage::running || (one != nullptr && one->binding_stage == Stage::running))
    e_.fail(e_.model.variables[k].at, "the value of '" + name + "' depends on itself; end the circle");
  if (one != nullptr) bind(*one);
  const Variable& variable = e_.model.variables[k];
  const Expression formula = variable.binding != nullptr ? variable.binding : variable.start;
  if (formula == nullptr) e_.fail(variable.at, "'" + name + "' has no value; give it a binding (= value)");
  parameter_stages_[k] = Stage::running;
  const std::optional<double> value = value_of(formula, at);
  parameter_stages_[k] = Stage::done;
  if (!value)
    e_.fail(variable.at, "the value of '" + name +
                             "' is needed to read the model but not known; it depends on "
                             "something that is computed from initial equations or varies");
  return *value;
}

namespace {

// Searches cycles of parameters in depth-first order.
class ParameterCircles {
 public:
  ParameterCircles(const Elaboration& e) : e_(e), states_(e.model.variables.size(), 0) {}

  void run() {
    for (size_t k = 0; k < states_.size(); ++k) visit(static_cast<int>(k));
  }

 private:
  // The parameters in a formula, each once, visiting shared parts once.
  static std::vector<int> parameters_in(const Expression& root, const std::vector<Variable>& variables) {
    std::vector<int> result;
    std::unordered_map<const Node*, bool> seen;
    std::vector<const Node*> open{root.get()};
    while (!open.empty()) {
      const Node* node = open.back();
      open.pop_back();
      if (!seen.emplace(node, true).second) continue;
      if (node->operation == Operation::variable && variables[static_cast<size_t>(node->index)].binding != nullptr)
        result.push_back(node->index);
      for (const Expression& operand : node->operands) open.push_back(operand.get());
    }
    return result;
  }

  void visit(int first) {
    std::vector<std::pair<int, std::vector<int>>> path;
    const auto enter = [&](int k) {
      if (states_[static_cast<size_t>(k)] == 2) return;
      if (states_[static_cast<size_t>(k)] == 1) fail(path, k);
      states_[static_cast<size_t>(k)] = 1;
      const Expression& binding = e_.model.variables[static_cast<size_t>(k)].binding;
      path.emplace_back(k, binding ? parameters_in(binding, e_.model.variables) : std::vector<int>{});
    };
    enter(first);
    while (!path.empty()) {
      if (path.back().second.empty()) {
        states_[static_cast<size_t>(path.back().first)] = 2;
        path.pop_back();
      } else {
        const int next = path.back().second.back();
        path.back().second.pop_back();
        enter(next);
      }
    }
  }

  [[noreturn]] void fail(const std::vector<std::pair<int, std::vector<int>>>& path, int again) const {
    std::string names;
    bool inside = false;
    for (const auto& [k, rest] : path) {
      inside = inside || k == again;
      if (inside) names += "'" + e_.model.variables[static_cast<size_t>(k)].name + "' -> ";
    }
    const Variable& variable = e_.model.variables[static_cast<size_t>(again)];
    e_.fail(variable.at,
            "parameters are defined by each other: " + names + "'" + variable.name + "'; end the circle");
  }

  const Elaboration& e_;
  std::vector<int> states_;  // 0: not seen, 1: on the path, 2: done
};

}  // namespace

void Symbols::check_parameters() { ParameterCircles(e_).run(); }

}  // namespace sfdae::cli
