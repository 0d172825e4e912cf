// Algorithm sections of models.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>

#include "modelica/arithmetic.h"
#include "modelica/assign.h"
#include "modelica/equations.h"
#include "modelica/executor.h"
#include "modelica/lexer.h"
#include "modelica/symbols.h"

namespace sfdae::cli {

using syntax::Form;
using syntax::Statement;

namespace {

// The scalar variables that an algorithm assigns; keys are their numbers in the model.
class ModelStore : public Store {
 public:
  ModelStore(Elaboration& e, Scope& declared, bool is_initial)
      : e_(e), declared_(declared), is_initial_(is_initial) {}

  // Call for every assignment before execution: the variables have start values or left limits until they are assigned.
  // in_when: number of the enclosing when statement, from 1; 0: none.
  void announce(const syntax::Expression& left, int in_when) {
    const syntax::Expression& name = name_of(e_, left);
    const ValuePointer value = declared_.find(name.text, name.at);
    if (value == nullptr) e_.fail(name.at, "unknown name '" + plain(name.text) + "'; declare it");
    std::vector<Expression> scalars;
    append_scalars(*value, scalars);
    for (const Expression& scalar : scalars) {
      const int key = is_free_parameter(scalar) ? scalar->index : assigned_variable(e_, scalar, left.at);
      own_.insert(key);
      if (in_when > 0) {
        const int first = in_whens_.emplace(key, in_when).first->second;
        if (first != in_when) in_several_.insert(key);
      } else if (&name == &left) {
        whole_.insert(key);
      }
    }
  }

  ValuePointer find(const std::string& name, Location at) override {
    ValuePointer declared = declared_.find(name, at);
    if (declared == nullptr) return nullptr;
    std::vector<Expression> scalars;
    append_scalars(*declared, scalars);
    const bool is_own =
        std::any_of(scalars.begin(), scalars.end(), [&](const Expression& x) { return is_own_variable(x); });
    if (!is_own) return declared;
    e_.charge(static_cast<long>(scalars.size()), at);
    auto result = std::make_shared<Value>(*declared);
    for (Expression* x : scalars_of(*result))
      if (is_own_variable(*x)) *x = current((*x)->index);
    return result;
  }

  Scope& declared() override { return declared_; }

  void assign(const Environment& in, const syntax::Expression& left, const Value& value,
              const Expression& active) override {
    const syntax::Expression& name = name_of(e_, left);
    const ValuePointer declared = declared_.find(name.text, name.at);
    const ValuePointer before = find(name.text, name.at);
    if (declared == nullptr || before == nullptr)
      e_.fail(name.at, "unknown name '" + plain(name.text) + "'; declare it");
    Value after = *before;
    if (&name == &left) {
      if (value.dims != after.dims)
        e_.fail(left.at, "'" + plain(name.text) + "' is " + shown_type(after) + " but gets " + shown_type(value));
      after = convert(e_, value, after.kind, after.definition, "'" + plain(name.text) + "'", left.at);
      if (!is_number(active)) after = choose(e_, active, after, *before, left.at);
    } else {
      assign_part(e_, in, after, left, value, active);
    }
    std::vector<Expression> places, old, fresh;
    append_scalars(*declared, places);
    append_scalars(*before, old);
    append_scalars(after, fresh);
    for (size_t k = 0; k < places.size(); ++k) {
      if (fresh[k] == nullptr)
        e_.fail(left.at, "'" + plain(name.text) + "' gets a value that the function has not assigned");
      if (fresh[k] != old[k] || &name == &left) set(places[k]->index, fresh[k], left.at);
    }
  }

  std::shared_ptr<Value> initial_value(int key) override {
    std::shared_ptr<Value>& result = initial_[key];
    if (result != nullptr) return result;
    const Variable& variable = e_.model.variables[static_cast<size_t>(key)];
    Expression x;
    if (variable.variability == Variability::discrete || in_whens_.count(key) > 0) {
      x = e_.pool.variable(Operation::previous, key, true, variable.at);
    } else {
      x = variable.start ? variable.start : e_.pool.number(0.0, variable.at);
    }
    return result = std::make_shared<Value>(scalar_value(Kind::real, std::move(x)));
  }

  bool act(const Environment& in, const syntax::Expression& call) override {
    if (!in_when_) return false;
    if (call.text == "reinit") append_reinit(e_, in, call, actions_);
    else actions_.push_back(evaluate_terminate(e_, in, call));
    return true;
  }

  void when(const Environment& in, const Statement& statement) override {
    if (in_when_) e_.fail(statement.at, "a when clause within another; use one with a condition of both");
    if (in.guard != nullptr)
      e_.fail(statement.at,
              "a when clause in an if or after a return whose condition varies; make it part of its condition");
    When result;
    result.at = statement.at;
    const State before = state_;
    std::set<int> assigned;
    for (const syntax::Branch& branch : statement.branches) {
      WhenBranch one;
      one.conditions = evaluate_when_conditions(e_, in, *branch.condition);
      run_branch(in, branch, before, one, assigned);
      result.branches.push_back(std::move(one));
      state_ = before;
    }
    for (const auto& [key, clause] : clauses_) assigned.erase(key);
    for (const int key : assigned) {
      if (before.count(key) > 0)
        e_.fail(statement.at,
                "'" + e_.model.variables[static_cast<size_t>(key)].name +
                    "' is assigned in a when clause and before it in the same algorithm; assign it in one place");
      by_when_.insert(key);
      state_[key] = std::make_shared<Value>(
          scalar_value(Kind::real, e_.pool.variable(Operation::variable, key, true, statement.at)));
    }
    const bool acts = std::any_of(result.branches.begin(), result.branches.end(),
                                  [](const WhenBranch& one) { return !one.actions.empty(); });
    if (acts) e_.model.whens.push_back(std::move(result));
    for (auto& [key, clause] : clauses_) {
      clause.branches.insert(clause.branches.begin(), std::make_move_iterator(clause.fresh.begin()),
                             std::make_move_iterator(clause.fresh.end()));
      clause.fresh.clear();
      clause.at = statement.at;
    }
  }

  void finish(Location at, std::vector<Equation>& equations) {
    for (auto& [key, clause] : clauses_) {
      by_when_.insert(key);
      e_.model.whens.push_back({std::move(clause.branches), clause.at});
    }
    for (const int key : whole_)
      if (by_when_.count(key) == 0) state_.emplace(key, nullptr);
    for (const auto& [key, value] : state_) {
      const Expression variable = e_.symbols->variable_node(key, at);
      const Expression result = value != nullptr ? value->scalars[0] : initial_value(key)->scalars[0];
      if (by_when_.count(key) > 0) {
        if (result != variable)
          e_.fail(at,
                  "'" + e_.model.variables[static_cast<size_t>(key)].name +
                      "' is assigned in a when clause and after it in the same algorithm; assign it in one place");
        continue;
      }
      equations.push_back({variable, result, at});
    }
  }

 private:
  bool is_free_parameter(const Expression& x) const {
    if (!is_initial_ || x->operation != Operation::variable) return false;
    const Variable& variable = e_.model.variables[static_cast<size_t>(x->index)];
    return variable.variability == Variability::parameter && !variable.is_fixed;
  }

  bool is_own_variable(const Expression& x) const {
    return x != nullptr && x->operation == Operation::variable && own_.count(x->index) > 0;
  }

  // Branches that assign a variable in several when statements of the algorithm. The last statement overrides the
  // others.
  struct Clause {
    std::vector<WhenBranch> branches;  // those of the last statement first
    std::vector<WhenBranch> fresh;     // of the statement being expanded
    Location at;
  };

  // True at the event at which a condition becomes true.
  Expression rising(const Expression& condition) {
    if (condition->operation == Operation::sample || condition->operation == Operation::initial) return condition;
    int index = condition->operation == Operation::variable ? condition->index : -1;
    if (index < 0) {
      Variable variable;
      variable.name = "when condition " + std::to_string(e_.model.variables.size());
      variable.type = Type::boolean;
      variable.variability = Variability::discrete;
      variable.at = condition->at;
      index = e_.symbols->add_variable(std::move(variable));
      e_.model.equations.push_back({e_.symbols->variable_node(index, condition->at), condition, condition->at});
    }
    const Expression was = e_.pool.variable(Operation::previous, index, true, condition->at);
    return e_.pool.make(
        Operation::and_,
        {e_.symbols->variable_node(index, condition->at), e_.pool.make(Operation::not_, {was}, condition->at)},
        condition->at);
  }

  // The value of such a variable after the when statements expanded so far.
  Expression between(int key, const Clause& clause) {
    Expression result = initial_value(key)->scalars[0];
    for (size_t k = clause.branches.size(); k-- > 0;)
      for (const Expression& condition : clause.branches[k].conditions)
        result = e_.pool.make(Operation::choose, {rising(condition), clause.branches[k].actions[0].value, result},
                              clause.at);
    return result;
  }

  Expression current(int key) {
    const auto found = state_.find(key);
    if (found == state_.end())
      if (const auto clause = clauses_.find(key); clause != clauses_.end()) return between(key, clause->second);
    return (found != state_.end() ? found->second : initial_value(key))->scalars[0];
  }

  void set(int key, const Expression& x, Location at) {
    e_.charge(1, at);
    state_[key] = std::make_shared<Value>(scalar_value(Kind::real, x));
  }

  void run_branch(const Environment& in, const syntax::Branch& branch, const State& before, WhenBranch& one,
                  std::set<int>& assigned) {
    std::vector<Assertion> assertions;
    Environment inside = in;
    inside.assertions = &assertions;
    in_when_ = true;
    Executor(e_, *this, inside).run(branch.body);
    in_when_ = false;
    for (const auto& [key, value] : state_) {
      const auto old = before.find(key);
      if (value == nullptr || (old != before.end() && old->second == value)) continue;
      Action action;
      action.kind = Action::Kind::assign;
      action.variable = key;
      action.value = value->scalars[0];
      action.at = branch.condition->at;
      assigned.insert(key);
      if (in_several_.count(key) > 0) clauses_[key].fresh.push_back({one.conditions, {std::move(action)}});
      else one.actions.push_back(std::move(action));
    }
    for (Action& action : actions_) one.actions.push_back(std::move(action));
    actions_.clear();
    append_assertions(assertions, one.actions);
  }

  Elaboration& e_;
  Scope& declared_;
  std::set<int> own_, whole_, by_when_, in_several_;
  std::unordered_map<int, int> in_whens_;  // by variable: the first when statement that assigns it
  std::map<int, Clause> clauses_;
  std::unordered_map<int, std::shared_ptr<Value>> initial_;
  std::vector<Action> actions_;
  bool in_when_ = false, is_initial_;
};

void announce_all(ModelStore& store, const std::vector<Statement>& body, int in_when, int& num_whens) {
  for (const Statement& one : body) {
    const int inside = one.action == syntax::StatementForm::when && in_when == 0 ? ++num_whens : in_when;
    if (one.action == syntax::StatementForm::assignment) {
      if (one.left->form != Form::tuple) {
        store.announce(*one.left, in_when);
      } else {
        for (const syntax::ExpressionPointer& part : one.left->operands)
          if (part != nullptr) store.announce(*part, in_when);
      }
    }
    for (const syntax::Branch& branch : one.branches) announce_all(store, branch.body, inside, num_whens);
  }
}

}  // namespace

void expand_algorithm(Elaboration& e, const Environment& in, const std::vector<Statement>& body,
                      std::vector<Equation>& equations) {
  if (body.empty()) return;
  ModelStore store(e, *in.scope, &equations == &e.model.initial_equations);
  int num_whens = 0;
  announce_all(store, body, 0, num_whens);
  Environment inside = in;
  inside.scope = &store;
  Executor(e, store, inside).run(body);
  store.finish(body.front().at, equations);
}

}  // namespace sfdae::cli
