// Algorithm sections of models.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
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
  ModelStore(Elaboration& e, Scope& declared) : e_(e), declared_(declared) {}

  // Before anything is executed: these are start values or left limits until they are assigned.
  void announce(const syntax::Expression& left, bool in_when) {
    const syntax::Expression& name = name_of(e_, left);
    const ValuePointer value = declared_.find(name.text, name.at);
    if (value == nullptr) e_.fail(name.at, "unknown name '" + plain(name.text) + "'; declare it");
    std::vector<Expression> scalars;
    append_scalars(*value, scalars);
    for (const Expression& scalar : scalars) {
      const int key = assigned_variable(e_, scalar, left.at);
      own_.insert(key);
      if (in_when) in_whens_.insert(key);
      else if (&name == &left) whole_.insert(key);
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
    for (const int key : assigned) {
      if (before.count(key) > 0)
        e_.fail(statement.at,
                "'" + e_.model.variables[static_cast<size_t>(key)].name +
                    "' is assigned in a when clause and before it in the same algorithm; assign it in one place");
      by_when_.insert(key);
      state_[key] = std::make_shared<Value>(
          scalar_value(Kind::real, e_.pool.variable(Operation::variable, key, true, statement.at)));
    }
    e_.model.whens.push_back(std::move(result));
  }

  void finish(Location at, std::vector<Equation>& equations) {
    for (const int key : whole_)
      if (by_when_.count(key) == 0) state_.emplace(key, nullptr);
    for (const auto& [key, value] : state_) {
      const Expression variable = e_.pool.variable(Operation::variable, key, true, at);
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
  bool is_own_variable(const Expression& x) const {
    return x != nullptr && x->operation == Operation::variable && own_.count(x->index) > 0;
  }

  Expression current(int key) {
    const auto found = state_.find(key);
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
      one.actions.push_back(std::move(action));
      assigned.insert(key);
    }
    for (Action& action : actions_) one.actions.push_back(std::move(action));
    actions_.clear();
    append_assertions(assertions, one.actions);
  }

  Elaboration& e_;
  Scope& declared_;
  std::set<int> own_, whole_, in_whens_, by_when_;
  std::unordered_map<int, std::shared_ptr<Value>> initial_;
  std::vector<Action> actions_;
  bool in_when_ = false;
};

void announce_all(ModelStore& store, const std::vector<Statement>& body, bool in_when) {
  for (const Statement& one : body) {
    if (one.action == syntax::StatementForm::assignment) {
      if (one.left->form != Form::tuple) {
        store.announce(*one.left, in_when);
      } else {
        for (const syntax::ExpressionPointer& part : one.left->operands)
          if (part != nullptr) store.announce(*part, in_when);
      }
    }
    for (const syntax::Branch& branch : one.branches)
      announce_all(store, branch.body, in_when || one.action == syntax::StatementForm::when);
  }
}

}  // namespace

void expand_algorithm(Elaboration& e, const Environment& in, const std::vector<Statement>& body,
                      std::vector<Equation>& equations) {
  if (body.empty()) return;
  ModelStore store(e, *in.scope);
  announce_all(store, body, false);
  Environment inside = in;
  inside.scope = &store;
  Executor(e, store, inside).run(body);
  store.finish(body.front().at, equations);
}

}  // namespace sfdae::cli
