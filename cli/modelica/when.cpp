// When clauses.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <utility>

#include "modelica/arithmetic.h"
#include "modelica/equations.h"
#include "modelica/executor.h"
#include "modelica/lexer.h"

namespace sfdae::cli {

using syntax::Form;
using syntax::Statement;
using Actions = std::vector<Action>;

namespace {

class WhenBody {
 public:
  explicit WhenBody(Elaboration& e) : e_(e) {}

  Actions expand(const Environment& in, const std::vector<Statement>& body) {
    Actions result;
    std::vector<Assertion> assertions;
    Environment inside = in;
    inside.assertions = &assertions;
    for (const Statement& one : body) {
      e_.charge(1, one.at);
      statement(inside, one, result);
    }
    append_assertions(assertions, result);
    return result;
  }

 private:
  void statement(const Environment& in, const Statement& one, Actions& actions) {
    switch (one.action) {
      case syntax::StatementForm::equation: return equation(in, one, actions);
      case syntax::StatementForm::call: return call(in, one, actions);
      case syntax::StatementForm::if_: return choice(in, one, 0, actions);
      case syntax::StatementForm::for_: return loop(in, one, actions);
      case syntax::StatementForm::when:
        e_.fail(one.at, "a when clause within another; use one with a condition of both");
      default: e_.fail(one.at, "a statement in a when-equation");
    }
  }

  void append_assignment(const Value& left, const Value& right, Location at, std::vector<Equation>& equations) {
    if (left.kind == Kind::integer && right.kind == Kind::real)
      e_.fail(at, "an Integer gets a Real in a when clause; use integer(...)");
    append_equalities(e_, left, right, at, equations);
  }

  void equation(const Environment& in, const Statement& one, Actions& actions) {
    std::vector<Equation> equations;
    if (one.left->form != Form::tuple) {
      append_assignment(evaluate(e_, in, *one.left), evaluate(e_, in, *one.right), one.at, equations);
    } else {
      const std::vector<Value> results = evaluate_outputs(e_, in, *one.right);
      if (one.left->operands.size() > results.size())
        e_.fail(one.at, "more variables in parentheses than the function has outputs");
      for (size_t k = 0; k < one.left->operands.size(); ++k)
        if (one.left->operands[k])
          append_assignment(evaluate(e_, in, *one.left->operands[k]), results[k], one.at, equations);
    }
    for (Equation& each : equations) {
      if (each.left->operation != Operation::variable && each.right->operation == Operation::variable)
        std::swap(each.left, each.right);
      Action action;
      action.kind = Action::Kind::assign;
      action.variable = assigned_variable(e_, each.left, one.at);
      action.value = each.right;
      action.at = one.at;
      actions.push_back(std::move(action));
    }
  }

  void call(const Environment& in, const Statement& one, Actions& actions) {
    const std::string& name = one.left->text;
    if (name == "assert") {
      add_assertion(e_, in, evaluate_assertion(e_, in, *one.left));
    } else if (name == "reinit") {
      append_reinit(e_, in, *one.left, actions);
    } else if (name == "terminate") {
      actions.push_back(evaluate_terminate(e_, in, *one.left));
    } else {
      evaluate_outputs(e_, in, *one.left);
    }
  }

  void loop(const Environment& in, const Statement& one, Actions& actions) {
    const Value range = evaluate_range(e_, in, *one.branches[0].condition);
    for (size_t k = 0; k < range.size(); ++k) {
      IteratorScope scope(*in.scope, one.iterator, element(range, k));
      Environment inside = in;
      inside.scope = &scope;
      for (const Statement& each : one.branches[0].body) {
        e_.charge(1, each.at);
        statement(inside, each, actions);
      }
    }
  }

  void block(const Environment& in, const std::vector<Statement>& body, Actions& actions) {
    for (const Statement& each : body) statement(in, each, actions);
  }

  // The assignments of the branches from the first on, chosen by their conditions.
  void choice(const Environment& in, const Statement& one, size_t first, Actions& actions) {
    for (size_t k = first; k < one.branches.size(); ++k) {
      const syntax::Branch& branch = one.branches[k];
      if (branch.condition == nullptr) return block(in, branch.body, actions);
      const Expression condition = evaluate_condition(e_, in, *branch.condition, "the condition of an if-equation");
      if (is_number(condition, 0.0)) continue;
      if (is_number(condition)) return block(in, branch.body, actions);
      Guard guard{in.guard, condition, false};
      Environment inside = in;
      inside.guard = &guard;
      Actions yes, no;
      block(inside, branch.body, yes);
      guard.is_negated = true;
      choice(inside, one, k + 1, no);
      return merge(condition, yes, no, actions);
    }
  }

  void merge(const Expression& condition, const Actions& yes, const Actions& no, Actions& actions) {
    std::map<int, std::pair<const Action*, const Action*>> assigned;
    for (const Action& one : yes) {
      if (one.kind == Action::Kind::assign) assigned[one.variable].first = &one;
      else actions.push_back(one);  // already guarded
    }
    for (const Action& one : no) {
      if (one.kind == Action::Kind::assign) assigned[one.variable].second = &one;
      else actions.push_back(one);
    }
    for (const auto& [variable, both] : assigned) {
      const Expression was = e_.pool.variable(Operation::previous, variable, true, {});
      Action action = both.first != nullptr ? *both.first : *both.second;
      action.value = e_.pool.make(
          Operation::choose,
          {condition, both.first ? both.first->value : was, both.second ? both.second->value : was}, action.at);
      actions.push_back(std::move(action));
    }
  }

  Elaboration& e_;
};

}  // namespace

int assigned_variable(const Elaboration& e, const Expression& x, Location at) {
  if (x->operation != Operation::variable)
    e.fail(at, "the left side is no variable; in when clauses write variable = value");
  const Variable& variable = e.model.variables[static_cast<size_t>(x->index)];
  if (variable.variability < Variability::discrete)
    e.fail(at, "'" + variable.name + "' is a parameter or constant and cannot be assigned");
  return x->index;
}

void append_assertions(const std::vector<Assertion>& assertions, Actions& actions) {
  for (const Assertion& one : assertions) {
    Action action;
    action.kind = Action::Kind::assertion;
    action.value = one.condition;
    action.message = one.message;
    action.is_error = one.is_error;
    action.at = one.at;
    actions.push_back(std::move(action));
  }
}

std::vector<Expression> evaluate_when_conditions(Elaboration& e, const Environment& in, const syntax::Expression& x) {
  const Value value = evaluate(e, in, x);
  if (value.kind != Kind::boolean || value.dims.size() > 1)
    e.fail(x.at,
           "the condition of a when clause is " + shown_type(value) + ", expected a Boolean or a vector of them");
  for (const Expression& one : value.scalars)
    if (one == nullptr) e.fail(x.at, "the condition of a when clause has not been assigned");
  return value.scalars;
}

When expand_when(Elaboration& e, const Environment& in, const Statement& statement) {
  When result;
  result.at = statement.at;
  for (const syntax::Branch& branch : statement.branches) {
    WhenBranch one;
    one.conditions = evaluate_when_conditions(e, in, *branch.condition);
    Environment inside = in;
    inside.guard = nullptr;
    one.actions = WhenBody(e).expand(inside, branch.body);
    result.branches.push_back(std::move(one));
  }
  return result;
}

void append_reinit(Elaboration& e, const Environment& in, const syntax::Expression& call, Actions& actions) {
  if (call.operands.size() != 2) e.fail(call.at, "'reinit' takes a variable and a value");
  Environment declared = in;
  declared.scope = &in.scope->declared();
  const Value variable = evaluate(e, declared, *call.operands[0]), value = evaluate(e, in, *call.operands[1]);
  if (!variable.is_numeric() || !value.is_numeric() || variable.dims != value.dims)
    e.fail(call.at, "'reinit' of " + shown_type(variable) + " with " + shown_type(value));
  for (size_t k = 0; k < variable.scalars.size(); ++k) {
    Action action;
    action.kind = Action::Kind::reinit;
    action.variable = assigned_variable(e, variable.scalars[k], call.at);
    if (value.scalars[k] == nullptr) e.fail(call.at, "'reinit' with a value that has not been assigned");
    action.value = value.scalars[k];
    if (in.guard != nullptr) action.guard = guard_condition(e, in.guard, call.at);
    action.at = call.at;
    actions.push_back(std::move(action));
  }
}

Action evaluate_terminate(Elaboration& e, const Environment& in, const syntax::Expression& call) {
  if (call.operands.size() != 1) e.fail(call.at, "'terminate' takes a message");
  const Value text = evaluate(e, in, *call.operands[0]);
  if (text.kind != Kind::string || !text.is_scalar())
    e.fail(call.at, "the message of 'terminate' is " + shown_type(text));
  Action result;
  result.kind = Action::Kind::terminate;
  if (in.guard != nullptr) result.guard = guard_condition(e, in.guard, call.at);
  result.message = text.texts[0].text;
  result.at = call.at;
  return result;
}

}  // namespace sfdae::cli
