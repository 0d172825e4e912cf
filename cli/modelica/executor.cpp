// SPDX-License-Identifier: BSD-3-Clause
#include "modelica/executor.h"

#include <algorithm>
#include <utility>

#include "modelica/arithmetic.h"
#include "modelica/function.h"
#include "modelica/lexer.h"

namespace sfdae::cli {

using syntax::Branch;
using syntax::Form;
using syntax::Statement;
using syntax::StatementForm;

Executor::Executor(Elaboration& e, Store& store, const Environment& in) : e_(e), store_(store), in_(in) {
  in_.scope = &store;
  flow_ = {e.pool.truth(false), e.pool.truth(false)};
}

void Executor::run(const std::vector<Statement>& body) { block(in_, body); }

Expression Executor::active() {
  return e_.pool.make(Operation::not_, {e_.pool.make(Operation::or_, {flow_.returned, flow_.broken}, {})}, {});
}

void Executor::block(const Environment& in, const std::vector<Statement>& body) {
  for (const Statement& one : body) {
    const Expression running = active();
    if (is_number(running, 0.0)) return;
    e_.charge(1, one.at);
    if (is_number(running)) {
      statement(in, one);
    } else {
      const Guard guard{in.guard, running, false};
      Environment inside = in;
      inside.guard = &guard;
      statement(inside, one);
    }
  }
}

void Executor::statement(const Environment& in, const Statement& one) {
  switch (one.action) {
    case StatementForm::assignment: return assignment(in, one);
    case StatementForm::if_: return if_statement(in, one, 0);
    case StatementForm::for_: return for_loop(in, one);
    case StatementForm::while_: return while_loop(in, one);
    case StatementForm::call: return call(in, one);
    case StatementForm::when: return store_.when(in, one);
    case StatementForm::break_: flow_.broken = e_.pool.truth(true); return;
    // Where a break has been met on the way, by its condition, the return is not executed.
    case StatementForm::return_:
      flow_.returned = e_.pool.make(Operation::or_, {flow_.returned, active()}, one.at);
      return;
    case StatementForm::equation: break;
  }
  e_.fail(one.at, "an equation in an algorithm; write ':='");
}

void Executor::assignment(const Environment& in, const Statement& one) {
  if (one.left->form != Form::tuple) {
    store_.assign(in, *one.left, evaluate(e_, in, *one.right), active());
    return;
  }
  const std::vector<Value> results = evaluate_outputs(e_, in, *one.right);
  if (one.left->operands.size() > results.size())
    e_.fail(one.at, "more variables on the left than the function has outputs");
  for (size_t k = 0; k < one.left->operands.size(); ++k)
    if (one.left->operands[k] != nullptr) store_.assign(in, *one.left->operands[k], results[k], active());
}

// In recursive calls, parameters must decide conditions; otherwise the recursion would not end.
bool Executor::is_decided_by_parameters(const Expression& condition) const {
  const auto& active = e_.functions->active;
  return !e_.pool.varies(condition) && active.size() > 1 &&
         std::count(active.begin(), active.end(), active.back()) > 1;
}

void Executor::if_statement(const Environment& in, const Statement& one, size_t first) {
  for (size_t k = first; k < one.branches.size(); ++k) {
    const Branch& branch = one.branches[k];
    if (branch.condition == nullptr) return block(in, branch.body);
    Expression condition = evaluate_condition(e_, in, *branch.condition, "the condition of an if-statement");
    if (is_decided_by_parameters(condition)) {
      if (const std::optional<double> known = constant_value(e_, condition)) condition = e_.pool.number(*known);
    }
    if (is_number(condition, 0.0)) continue;
    if (is_number(condition)) return block(in, branch.body);
    return both(in, condition, one, k);
  }
}

// Executes branch k and the branches after it, and chooses between the results by the condition.
void Executor::both(const Environment& in, const Expression& condition, const Statement& one, size_t k) {
  const Store::State before = store_.state();
  const Flow flow = flow_;
  Guard guard{in.guard, condition, false};
  Environment inside = in;
  inside.guard = &guard;
  block(inside, one.branches[k].body);
  const Store::State first = std::exchange(store_.state(), before);
  const Flow first_flow = std::exchange(flow_, flow);
  guard.is_negated = true;
  if_statement(inside, one, k + 1);
  if (store_.state() != first) store_.state() = merged(condition, first, store_.state(), one.at);
  const auto choice = [&](const Expression& a, const Expression& b) {
    if (a == b) return a;
    const Expression yes = e_.pool.make(Operation::and_, {condition, a}, one.at);
    const Expression no = e_.pool.make(Operation::not_, {condition}, one.at);
    return e_.pool.make(Operation::or_, {yes, e_.pool.make(Operation::and_, {no, b}, one.at)}, one.at);
  };
  flow_ = {choice(first_flow.returned, flow_.returned), choice(first_flow.broken, flow_.broken)};
}

Store::State Executor::merged(const Expression& condition, const Store::State& first, const Store::State& second,
                              Location at) {
  Store::State result = second;
  const auto value_in = [&](const Store::State& state, int key) {
    const auto found = state.find(key);
    return found != state.end() ? found->second : store_.initial_value(key);
  };
  for (const auto& [key, value] : first) result.emplace(key, nullptr);
  for (auto& [key, value] : result) {
    e_.charge(1, at);
    const std::shared_ptr<Value> a = value_in(first, key), b = value_in(second, key);
    if (a == b || b == nullptr) value = a;
    else if (a == nullptr) value = b;
    else value = std::make_shared<Value>(choose(e_, condition, *a, *b, at));
  }
  return result;
}

void Executor::for_loop(const Environment& in, const Statement& one) {
  const Branch& body = one.branches[0];
  const Value range = evaluate_range(e_, in, *body.condition);
  const Expression outside = flow_.broken;
  for (size_t k = 0; k < range.size(); ++k) {
    e_.charge(1, one.at);
    if (is_number(active(), 0.0)) break;
    IteratorScope scope(*in.scope, one.iterator, element(range, k));
    Environment inside = in;
    inside.scope = &scope;
    block(inside, body.body);
  }
  flow_.broken = outside;
}

// Asserts that the loop has ended after the last round that is expanded.
void Executor::assert_ended(const Environment& in, Location at) {
  Assertion assertion;
  assertion.condition = e_.pool.make(Operation::or_, {flow_.returned, flow_.broken}, at);
  assertion.message = "a while loop takes more than " + std::to_string(Limits::kMaxRounds) +
                      " rounds, to which it has been expanded; replace it by a formula";
  assertion.at = at;
  add_assertion(e_, in, std::move(assertion));
}

void Executor::while_loop(const Environment& in, const Statement& one) {
  int num_open_rounds = 0;
  const Branch& body = one.branches[0];
  const Expression outside = flow_.broken;
  for (;;) {
    e_.charge(1, one.at);
    const Expression running = active();
    if (is_number(running, 0.0)) break;
    const Expression condition = evaluate_condition(e_, in, *body.condition, "the condition of a while loop");
    const std::optional<double> known = constant_value(e_, condition);
    if (!known) {
      // Equivalent to: if not condition then break.
      if (++num_open_rounds > Limits::kMaxRounds) {
        assert_ended(in, one.at);
        break;
      }
      const Expression ended = e_.pool.make(Operation::not_, {condition}, one.at);
      flow_.broken = e_.pool.make(Operation::or_, {flow_.broken, ended}, one.at);
      block(in, body.body);
      continue;
    }
    if (*known == 0.0) break;
    block(in, body.body);
  }
  flow_.broken = outside;
}

void Executor::call(const Environment& in, const Statement& one) {
  const std::string& name = one.left->text;
  if (name == "assert") {
    add_assertion(e_, in, evaluate_assertion(e_, in, *one.left));
  } else if (name == "reinit" || name == "terminate") {
    if (!store_.act(in, *one.left)) e_.fail(one.at, "'" + name + "' outside of a when clause");
  } else {
    evaluate_outputs(e_, in, *one.left);
  }
}

Assertion evaluate_assertion(Elaboration& e, const Environment& in, const syntax::Expression& call) {
  Assertion result;
  result.at = call.at;
  std::vector<const syntax::Expression*> arguments(3, nullptr);
  const std::vector<std::string> names = {"condition", "message", "level"};
  if (call.operands.size() < 2 || call.operands.size() > 3)
    e.fail(call.at, "'assert' takes a condition, a message and a level");
  for (size_t k = 0; k < call.operands.size(); ++k) {
    size_t place = k;
    if (!call.names[k].empty())
      place = static_cast<size_t>(std::find(names.begin(), names.end(), call.names[k]) - names.begin());
    if (place >= 3) e.fail(call.operands[k]->at, "'assert' has no argument '" + plain(call.names[k]) + "'");
    arguments[place] = call.operands[k].get();
  }
  if (arguments[0] == nullptr || arguments[1] == nullptr) e.fail(call.at, "'assert' needs a condition and a message");
  result.condition = evaluate_condition(e, in, *arguments[0], "the condition of an assertion");
  const Value message = evaluate(e, in, *arguments[1]);
  if (message.kind != Kind::string || !message.is_scalar())
    e.fail(arguments[1]->at, "the message of an assertion is " + shown_type(message) + ", expected a String");
  result.message = message.texts[0].text;
  if (arguments[2] == nullptr) return result;
  const Value level = evaluate(e, in, *arguments[2]);
  const bool fits = level.kind == Kind::enumeration && level.definition == &e.definitions.assertion_level();
  const std::optional<double> number = fits && level.is_scalar() ? constant_value(e, level.scalars[0]) : std::nullopt;
  if (!number)
    e.fail(arguments[2]->at, "the level of an assertion is neither AssertionLevel.error nor AssertionLevel.warning");
  result.is_error = *number == 2.0;
  return result;
}

}  // namespace sfdae::cli
