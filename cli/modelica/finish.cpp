// Checks that need the whole model, and the direction of discrete equations.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <functional>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "modelica/equations.h"
#include "modelica/symbols.h"

namespace sfdae::cli {

namespace {

// Calls visit(formula, location) for all formulas of a model except bindings and attributes.
void visit_formulas(const FlatModel& model, const std::function<void(const Expression&, Location)>& visit) {
  const auto visit_equations = [&](const std::vector<Equation>& equations) {
    for (const Equation& one : equations) visit(one.left, one.at), visit(one.right, one.at);
  };
  visit_equations(model.equations);
  visit_equations(model.initial_equations);
  for (const Assertion& one : model.assertions) visit(one.condition, one.at);
  for (const When& when : model.whens)
    for (const WhenBranch& branch : when.branches) {
      for (const Expression& condition : branch.conditions) visit(condition, when.at);
      for (const Action& action : branch.actions) {
        if (action.value != nullptr) visit(action.value, action.at);
        if (action.guard != nullptr) visit(action.guard, action.at);
      }
    }
}

class Finish {
 public:
  explicit Finish(Elaboration& e) : e_(e), model_(e.model), by_when_(e.model.variables.size(), 0) {}

  void run() {
    mark_discrete();
    drop_repeated_assertions();
    for (const Variable& one : model_.variables)
      for (const Expression& formula : {one.binding, one.start, one.nominal, one.min, one.max})
        if (formula != nullptr) walk(formula, one.at);
    visit_formulas(model_, [&](const Expression& formula, Location at) { walk(formula, at); });
    check_derivatives();
    check_reinits();
    check_parameters();
    check_real_equalities();
    direct_discrete_equations();
    check_discrete_variables();
  }

 private:
  Variable& variable(int k) { return model_.variables[static_cast<size_t>(k)]; }

  // Functions and subscripts generate the same assertion at each occurrence.
  void drop_repeated_assertions() {
    std::unordered_set<const Node*> conditions;
    std::erase_if(model_.assertions, [&](const Assertion& one) {
      return !conditions.insert(one.condition.get()).second && one.is_error;
    });
  }

  // Variables assigned in when clauses are discrete, and each is assigned in only one clause.
  void mark_discrete() {
    for (size_t w = 0; w < model_.whens.size(); ++w)
      for (const WhenBranch& branch : model_.whens[w].branches)
        for (const Action& action : branch.actions) {
          if (action.kind != Action::Kind::assign) continue;
          int& owner = by_when_[static_cast<size_t>(action.variable)];
          const int self = static_cast<int>(w) + 1;
          if (owner != 0 && owner != self)
            e_.fail(action.at, "'" + variable(action.variable).name +
                                   "' is assigned in two when clauses; join them by elsewhen");
          owner = self;
          if (variable(action.variable).variability == Variability::continuous)
            variable(action.variable).variability = Variability::discrete;
        }
  }

  // Records derivatives and parameters, visiting each node once.
  void walk(const Expression& root, Location at) {
    std::vector<const Node*> open{root.get()};
    while (!open.empty()) {
      const Node* node = open.back();
      open.pop_back();
      if (!seen_.insert(node).second) continue;
      if (node->operation == Operation::derivative) derivatives_.emplace(node->index, at);
      if (node->operation == Operation::variable && variable(node->index).variability < Variability::discrete)
        parameters_.emplace(node->index, at);
      for (const Expression& operand : node->operands) open.push_back(operand.get());
    }
  }

  void check_derivatives() {
    for (const auto& [k, at] : derivatives_)
      if (variable(k).variability != Variability::continuous)
        e_.fail(at, "der of '" + variable(k).name +
                        "', which is discrete (a when clause assigns it); only continuous Reals have derivatives");
  }

  void check_reinits() {
    std::unordered_map<int, const When*> owners;
    for (const When& when : model_.whens)
      for (const WhenBranch& branch : when.branches)
        for (const Action& action : branch.actions) {
          if (action.kind != Action::Kind::reinit) continue;
          const std::string& name = variable(action.variable).name;
          if (derivatives_.count(action.variable) == 0)
            e_.fail(action.at,
                    "reinit of '" + name + "', which is not differentiated; only states can be reinitialized");
          const auto [owner, is_new] = owners.emplace(action.variable, &when);
          if (!is_new && owner->second != &when)
            e_.fail(action.at, "reinit of '" + name + "' in two when clauses; join them by elsewhen");
        }
  }

  void check_parameters() {
    for (const auto& [k, at] : parameters_) {
      const Variable& one = variable(k);
      if (one.binding != nullptr || !one.is_fixed) continue;
      if (one.start == nullptr)
        e_.fail(one.at, "the " + std::string(one.variability == Variability::constant ? "constant" : "parameter") +
                            " '" + one.name + "' has no value; give it a binding (= value)");
      e_.warn(one.at, "the parameter '" + one.name + "' has no binding; its start value is used");
    }
    e_.symbols->check_parameters();
  }

  // Depends on a quantity that changes between events; relations and similar operations do not.
  bool varies_continuously(const Expression& x) {
    const auto found = continuous_.find(x.get());
    if (found != continuous_.end()) return found->second;
    bool result = false;
    switch (x->operation) {
      case Operation::time:
      case Operation::derivative:
      case Operation::no_event: result = true; break;
      case Operation::variable: result = variable(x->index).variability == Variability::continuous; break;
      case Operation::less:
      case Operation::less_equal:
      case Operation::greater:
      case Operation::greater_equal:
      case Operation::floor:
      case Operation::ceil:
      case Operation::integer:
      case Operation::div: break;
      default:
        result = std::any_of(x->operands.begin(), x->operands.end(),
                             [&](const Expression& operand) { return varies_continuously(operand); });
    }
    continuous_.emplace(x.get(), result);
    return result;
  }

  void check_real_equalities() {
    for (size_t k = 0; k < e_.real_equalities.size(); ++k) {
      const Expression& x = e_.real_equalities[k];
      if (seen_.count(x.get()) == 0) continue;  // not part of the model
      for (const Expression& operand : x->operands)
        if (varies_continuously(operand))
          e_.fail(e_.real_equality_locations[k],
                  "'==' or '<>' between Reals that vary continuously; compare with <= and >=");
    }
  }

  // The value is Real because of its operands; numbers fit any type.
  bool is_real(const Expression& x) {
    const auto found = real_.find(x.get());
    if (found != real_.end()) return found->second;
    bool result = false;
    switch (x->operation) {
      case Operation::time:
      case Operation::derivative: result = true; break;
      case Operation::variable:
      case Operation::previous: result = variable(x->index).type == Type::real; break;
      case Operation::choose: result = is_real(x->operands[1]) || is_real(x->operands[2]); break;
      case Operation::negate:
      case Operation::abs:
      case Operation::no_event:
      case Operation::add:
      case Operation::subtract:
      case Operation::multiply:
      case Operation::min:
      case Operation::max:
      case Operation::div:
      case Operation::mod:
      case Operation::rem:
        result = std::any_of(x->operands.begin(), x->operands.end(),
                             [&](const Expression& operand) { return is_real(operand); });
        break;
      case Operation::number:
      case Operation::sign:
      case Operation::integer:
      case Operation::not_:
      case Operation::less:
      case Operation::less_equal:
      case Operation::greater:
      case Operation::greater_equal:
      case Operation::equal:
      case Operation::not_equal:
      case Operation::and_:
      case Operation::or_:
      case Operation::sample:
      case Operation::initial:
      case Operation::terminal: break;
      default: result = true;
    }
    real_.emplace(x.get(), result);
    return result;
  }

  // The discrete variable that an equation can determine by this side: v, not v, -v.
  int candidate(const Expression& side) {
    const bool is_inverse = side->operation == Operation::not_ || side->operation == Operation::negate;
    const Expression& x = is_inverse ? side->operands[0] : side;
    if (x->operation != Operation::variable) return -1;
    const bool fits = variable(x->index).variability == Variability::discrete &&
                      by_when_[static_cast<size_t>(x->index)] == 0 && !variable(x->index).is_input;
    return fits ? x->index : -1;
  }

  struct DiscreteEquation {
    size_t number;                  // among the model's equations
    std::array<int, 2> candidates;  // by side; -1: none
    bool is_directed = false;
  };

  // Every discrete equation can determine at most two variables. Equations with one candidate are directed first and
  // remove it from the others; cycles may be directed either way.
  void direct_discrete_equations() {
    std::vector<DiscreteEquation> equations;
    std::unordered_map<int, std::vector<size_t>> of_variable;
    for (size_t k = 0; k < model_.equations.size(); ++k) {
      const Equation& one = model_.equations[k];
      const bool is_discrete = (!is_real(one.left) && !is_real(one.right)) ||
                               (!varies_continuously(one.left) && !varies_continuously(one.right));
      const std::array<int, 2> candidates = {candidate(one.left), candidate(one.right)};
      if (!is_discrete || (is_number(one.left, 0.0) && candidates[1] < 0)) continue;
      if (is_real(one.left) && candidates[0] < 0 && candidates[1] < 0) continue;  // between parameters
      for (const int candidate : candidates)
        if (candidate >= 0) of_variable[candidate].push_back(equations.size());
      equations.push_back({k, candidates});
    }
    std::vector<size_t> open;
    const auto direct = [&](size_t first) {
      open.push_back(first);
      while (!open.empty()) {
        DiscreteEquation& one = equations[open.back()];
        open.pop_back();
        if (!one.is_directed) direct_one(one, equations, of_variable, open);
      }
    };
    for (size_t i = 0; i < equations.size(); ++i)
      if ((equations[i].candidates[0] < 0) != (equations[i].candidates[1] < 0) ||
          equations[i].candidates[0] == equations[i].candidates[1])
        direct(i);
    for (size_t i = 0; i < equations.size(); ++i) direct(i);
  }

  void direct_one(DiscreteEquation& one, std::vector<DiscreteEquation>& equations,
                  const std::unordered_map<int, std::vector<size_t>>& of_variable, std::vector<size_t>& open) {
    Equation& equation = model_.equations[one.number];
    one.is_directed = true;
    const int chosen = one.candidates[0] >= 0 ? one.candidates[0] : one.candidates[1];
    if (chosen < 0)
      e_.fail(equation.at,
              "an equation between discrete values determines no variable that another equation does not; write "
              "variable = value");
    if (one.candidates[0] < 0) std::swap(equation.left, equation.right);
    if (equation.left->operation != Operation::variable) {
      equation.right = e_.pool.make(equation.left->operation, {equation.right}, equation.at);
      equation.left = equation.left->operands[0];
    }
    determined_.insert(chosen);
    for (const size_t other : of_variable.at(chosen)) {
      if (equations[other].is_directed) continue;
      for (int& candidate : equations[other].candidates)
        if (candidate == chosen) candidate = -1;
      open.push_back(other);
    }
  }

  // If there are as many equations as unknowns and one is missing for the discrete variables, there is one too many for
  // the others: a Real formula in place of an Integer. Other mismatches are reported when the model is solved.
  void check_discrete_variables() {
    size_t num_unknowns = 0, num_by_when = 0;
    int missing = -1;
    for (size_t k = 0; k < model_.variables.size(); ++k) {
      const Variable& one = model_.variables[k];
      if (one.variability < Variability::discrete || one.is_input) continue;
      ++num_unknowns;
      if (by_when_[k] != 0) ++num_by_when;
      else if (one.variability == Variability::discrete && determined_.count(static_cast<int>(k)) == 0)
        missing = static_cast<int>(k);
    }
    if (missing < 0 || model_.equations.size() + num_by_when != num_unknowns) return;
    e_.fail(variable(missing).at,
            "'" + variable(missing).name +
                "' is discrete, but no discrete equation or when clause determines it; "
                "a formula that varies continuously does not (use integer(...) or a when clause)");
  }

  Elaboration& e_;
  FlatModel& model_;
  std::vector<int> by_when_;  // by variable: the when clause that assigns it, from 1; 0: none
  std::unordered_set<const Node*> seen_;
  std::unordered_map<int, Location> derivatives_, parameters_;
  std::unordered_set<int> determined_;  // discrete variables that have an equation
  std::unordered_map<const Node*, bool> continuous_, real_;
};

}  // namespace

void finish_model(Elaboration& e) { Finish(e).run(); }

}  // namespace sfdae::cli
