// SPDX-License-Identifier: BSD-3-Clause
#include "modelica/equations.h"

#include <algorithm>
#include <deque>
#include <unordered_map>
#include <utility>

#include "modelica/arithmetic.h"
#include "modelica/executor.h"
#include "modelica/lexer.h"

namespace sfdae::cli {

using syntax::Form;
using syntax::Statement;
using syntax::StatementForm;
using Equations = std::vector<Equation>;

namespace {

struct Case {
  Expression condition;  // none: else
  Equations equations;
};

void append_fields(Elaboration& e, const RecordValue& left, const RecordValue& right, Location at,
                   Equations& equations) {
  if (left.fields.size() != right.fields.size()) e.fail(at, "an equation between records with different fields");
  for (const auto& [name, value] : left.fields) {
    const Value* other = right.find(name);
    if (other == nullptr) e.fail(at, "an equation between records: one has no field '" + plain(name) + "'");
    append_equalities(e, value, *other, at, equations);
  }
}

void append_equation(Elaboration& e, const Environment& in, const Statement& one, Equations& equations) {
  const bool is_left = one.left->form == Form::tuple;
  if (!is_left && one.right->form != Form::tuple) {
    const Value left = evaluate(e, in, *one.left);
    return append_equalities(e, left, evaluate(e, in, *one.right), one.at, equations);
  }
  const syntax::Expression& tuple = is_left ? *one.left : *one.right;
  const std::vector<Value> results = evaluate_outputs(e, in, is_left ? *one.right : *one.left);
  if (tuple.operands.size() > results.size())
    e.fail(one.at, "more variables in parentheses than the function has outputs");
  for (size_t k = 0; k < tuple.operands.size(); ++k)
    if (tuple.operands[k]) append_equalities(e, evaluate(e, in, *tuple.operands[k]), results[k], one.at, equations);
}

// Removes the first equation with this left side from the equations of a case and returns its right side.
bool take_equal_left(Equations& from, const Expression& left, Expression& right) {
  for (Equation& one : from) {
    if (one.left == nullptr) continue;
    if (one.left != left && one.right == left && left->operation == Operation::variable)
      std::swap(one.left, one.right);
    if (one.left != left) continue;
    right = one.right;
    one.left = nullptr;
    return true;
  }
  return false;
}

// Combines the equations of all cases: those with a left side common to all cases, then the others in their order.
void append_choices(Elaboration& e, std::vector<Case>& cases, Location at, Equations& equations) {
  const auto chosen = [&](const std::vector<Expression>& values) {
    Expression result = values.back();
    for (size_t k = values.size() - 1; k-- > 0;)
      result = e.pool.make(Operation::choose, {cases[k].condition, values[k], result}, at);
    return result;
  };
  std::unordered_map<const Node*, int> lefts;  // number of cases with this left side
  for (const Case& one : cases) {
    std::unordered_map<const Node*, bool> here;
    for (const Equation& equation : one.equations)
      for (const Expression& side : {equation.left, equation.right})
        if (here.emplace(side.get(), true).second) ++lefts[side.get()];
  }
  for (size_t i = 0; i < cases[0].equations.size(); ++i) {
    const Equation first = cases[0].equations[i];
    if (lefts[first.left.get()] != static_cast<int>(cases.size())) continue;
    std::vector<Expression> rights{first.right};
    for (size_t k = 1; k < cases.size(); ++k) {
      e.charge(static_cast<long>(cases[k].equations.size()) / 64 + 1, at);
      Expression right;
      if (take_equal_left(cases[k].equations, first.left, right)) rights.push_back(right);
    }
    if (rights.size() != cases.size()) e.fail(first.at, "an if-equation whose branches determine one variable twice");
    equations.push_back({first.left, chosen(rights), first.at});
    cases[0].equations[i].left = nullptr;
  }
  for (Case& one : cases)
    std::erase_if(one.equations, [](const Equation& equation) { return equation.left == nullptr; });
  for (size_t i = 0; i < cases[0].equations.size(); ++i) {
    std::vector<Expression> residuals;
    for (const Case& one : cases)
      residuals.push_back(e.pool.make(Operation::subtract, {one.equations[i].left, one.equations[i].right}, at));
    equations.push_back({chosen(residuals), e.pool.number(0.0, at), cases[0].equations[i].at});
  }
}

bool has_when(const std::vector<Statement>& body) {
  return std::any_of(body.begin(), body.end(), [](const Statement& one) {
    return one.action == StatementForm::when || std::any_of(one.branches.begin(), one.branches.end(),
                                                            [](const syntax::Branch& b) { return has_when(b.body); });
  });
}

void append_if(Elaboration& e, const Environment& in, const Statement& one, Equations& equations) {
  std::deque<Guard> guards;
  std::vector<Case> cases;
  Environment here = in;
  bool is_complete = false;
  for (const syntax::Branch& branch : one.branches) {
    Expression condition;
    if (branch.condition != nullptr) {
      condition = evaluate_condition(e, here, *branch.condition, "the condition of an if-equation");
      if (const std::optional<double> known = constant_value(e, condition)) {
        if (*known == 0.0) continue;
        condition = nullptr;
      }
    }
    if (condition == nullptr && cases.empty()) return expand_equations(e, here, branch.body, equations);
    if (has_when(branch.body))
      e.fail(one.at,
             "a when clause in an if-equation whose condition varies; make the condition part of the when clause");
    Environment inside = here;
    if (condition != nullptr) {
      guards.push_back({here.guard, condition, false});
      inside.guard = &guards.back();
      guards.push_back({here.guard, condition, true});
      here.guard = &guards.back();
    }
    cases.push_back({condition, {}});
    expand_equations(e, inside, branch.body, cases.back().equations);
    if ((is_complete = condition == nullptr)) break;
  }
  if (cases.empty()) return;
  if (!is_complete) cases.push_back({});
  for (const Case& one_case : cases)
    if (one_case.equations.size() != cases[0].equations.size())
      e.fail(one.at, "an if-equation whose condition varies has branches of " +
                         std::to_string(cases[0].equations.size()) + " and " +
                         std::to_string(one_case.equations.size()) +
                         " equations; make them equal (a missing else has none)");
  append_choices(e, cases, one.at, equations);
}

void append_for(Elaboration& e, const Environment& in, const Statement& one, Equations& equations) {
  const Value range = evaluate_range(e, in, *one.branches[0].condition);
  for (size_t k = 0; k < range.size(); ++k) {
    e.charge(1, one.at);
    IteratorScope scope(*in.scope, one.iterator, element(range, k));
    Environment inside = in;
    inside.scope = &scope;
    expand_equations(e, inside, one.branches[0].body, equations);
  }
}

void append_call(Elaboration& e, const Environment& in, const Statement& one) {
  const std::string& name = one.left->text;
  if (name == "assert") {
    add_assertion(e, in, evaluate_assertion(e, in, *one.left));
  } else if (name == "reinit" || name == "terminate") {
    e.fail(one.at, "'" + name + "' outside of a when clause; put it into one");
  } else if (name == "prioritize") {
    e.warn(one.at, "'prioritize' is ignored");
  } else {
    evaluate_outputs(e, in, *one.left);
  }
}

}  // namespace

void append_equalities(Elaboration& e, const Value& left, const Value& right, Location at, Equations& equations) {
  const bool same_kind = left.kind == right.kind || (left.is_numeric() && right.is_numeric());
  const bool same_type = same_kind && (left.kind != Kind::enumeration || left.definition == right.definition);
  if ((!same_type && left.size() + right.size() > 0) || left.dims != right.dims || left.kind == Kind::function)
    e.fail(at, "an equation between " + shown_type(left) + " and " + shown_type(right) +
                   "; make the types and sizes agree");
  e.charge(static_cast<long>(left.size()), at);
  for (size_t k = 0; k < left.scalars.size(); ++k) {
    const Expression &a = left.scalars[k], &b = right.scalars[k];
    if (a == nullptr || b == nullptr) e.fail(at, "an equation with a value that the function has not assigned");
    if (is_number(a) && is_number(b)) {
      if (a->value != b->value) e.fail(at, "an equation without variables that is not true");
      continue;
    }
    equations.push_back({a, b, at});
  }
  for (size_t k = 0; k < left.texts.size(); ++k)
    if (left.texts[k].text != right.texts[k].text || !left.texts[k].is_exact || !right.texts[k].is_exact)
      e.fail(at, "an equation between strings; only String parameters are supported");
  for (size_t k = 0; k < left.records.size(); ++k) append_fields(e, left.records[k], right.records[k], at, equations);
}

void expand_equations(Elaboration& e, const Environment& in, const std::vector<Statement>& body,
                      Equations& equations) {
  for (const Statement& one : body) {
    e.charge(1, one.at);
    switch (one.action) {
      case StatementForm::equation: append_equation(e, in, one, equations); break;
      case StatementForm::if_: append_if(e, in, one, equations); break;
      case StatementForm::for_: append_for(e, in, one, equations); break;
      case StatementForm::when:
        if (&equations == &e.model.initial_equations) e.fail(one.at, "'when' in an initial section; remove it");
        e.model.whens.push_back(expand_when(e, in, one));
        break;
      case StatementForm::call: append_call(e, in, one); break;
      default: e.fail(one.at, "a statement in an equation section");
    }
  }
}

}  // namespace sfdae::cli
