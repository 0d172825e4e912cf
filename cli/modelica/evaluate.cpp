// Evaluation of expressions of the syntax tree.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "modelica/arithmetic.h"
#include "modelica/lexer.h"
#include "modelica/symbols.h"

namespace sfdae::cli {

using syntax::Form;

namespace {

class Depth {
 public:
  Depth(Elaboration& e, Location at) : e_(e) {
    if (++e.limits.depth > Limits::kMaxDepth) {
      --e.limits.depth;
      e.fail(at, "expressions and function calls within each other beyond " + std::to_string(Limits::kMaxDepth) +
                     " levels; introduce variables for parts of it");
    }
  }
  ~Depth() { --e_.limits.depth; }
  Depth(const Depth&) = delete;
  Depth& operator=(const Depth&) = delete;

 private:
  Elaboration& e_;
};

Value literal_value(Elaboration& e, const syntax::Definition& enumeration, size_t k, Location at) {
  Value result = scalar_value(Kind::enumeration, e.pool.number(static_cast<double>(k + 1), at));
  result.definition = &enumeration;
  return result;
}

std::optional<Value> find_literal(Elaboration& e, const std::string& type, const std::string& name, Location at) {
  const syntax::Definition* found = e.definitions.find(type, syntax::DefinitionKind::enumeration);
  if (found == nullptr) return std::nullopt;
  for (size_t k = 0; k < found->literals.size(); ++k)
    if (plain(found->literals[k].name) == plain(name)) return literal_value(e, *found, k, at);
  e.fail(at, "the enumeration '" + plain(type) + "' has no literal '" + plain(name) + "'");
}

// Names that are not variables: types as the array of their literals, functions, time.
std::optional<Value> find_definition(Elaboration& e, const Environment& in, const syntax::Expression& x) {
  if (x.text == "time" && !in.in_function) return scalar_value(Kind::real, e.pool.leaf(Operation::time, x.at));
  if (const syntax::Definition* found = e.definitions.find(x.text)) {
    Value result;
    result.definition = found;
    if (found->kind == syntax::DefinitionKind::enumeration) {
      result.kind = Kind::enumeration;
      result.dims = {static_cast<int>(found->literals.size())};
      for (size_t k = 0; k < found->literals.size(); ++k)
        result.scalars.push_back(e.pool.number(static_cast<double>(k + 1), x.at));
      return result;
    }
    result.kind = Kind::function;
    if (found->kind == syntax::DefinitionKind::function) return result;
  }
  const size_t dot = x.text.rfind('.');
  return dot == x.text.npos ? std::nullopt : find_literal(e, x.text.substr(0, dot), x.text.substr(dot + 1), x.at);
}

[[noreturn]] void fail_unknown(Elaboration& e, const Environment& in, const syntax::Expression& x) {
  const std::string other = x.text[0] == '\'' ? plain(x.text) : "'" + x.text;
  if (in.scope->find(other, x.at))
    e.fail(x.at, "unknown name " + (x.text[0] == '\'' ? x.text + "'" : x.text) + "; there is one " +
                     (x.text[0] == '\'' ? "without quotes" : "in quotes") + ", which differs from it");
  e.fail(x.at, "unknown name '" + plain(x.text) + "'; declare it" + (in.in_function ? " in the function" : ""));
}

// Looks up a name without copying its value.
ValuePointer find_name(Elaboration& e, const Environment& in, const syntax::Expression& x) {
  if (ValuePointer found = in.scope->find(x.text, x.at)) return found;
  if (std::optional<Value> found = find_definition(e, in, x)) return std::make_shared<const Value>(std::move(*found));
  fail_unknown(e, in, x);
}

// Splits a chain A.B.C of names; `front` becomes 'A.B.C without the last quote.
bool split_names(const syntax::Expression& x, std::string& front) {
  if (x.form == Form::name) return front = x.text, true;
  std::string before;
  if (x.form != Form::member || !split_names(*x.operands[0], before)) return false;
  front = "'" + plain(before) + "." + plain(x.text);
  return true;
}

Value evaluate_member(Elaboration& e, const Environment& in, const syntax::Expression& x) {
  std::string type;
  if (split_names(*x.operands[0], type)) {
    const syntax::Expression* first = x.operands[0].get();
    while (first->form == Form::member) first = first->operands[0].get();
    if (!in.scope->find(first->text, x.at))
      if (const std::optional<Value> literal = find_literal(e, type, x.text, x.at)) return *literal;
  }
  return member_of(e, evaluate(e, in, *x.operands[0]), x.text, x.at);
}

Value evaluate_subscripted(Elaboration& e, const Environment& in, const syntax::Expression& x) {
  const syntax::Expression& base = *x.operands[0];
  if (base.form == Form::name) return select(e, in, *find_name(e, in, base), x);
  return select(e, in, evaluate(e, in, base), x);
}

bool is_long_sum(const syntax::Expression& x) {
  return x.operands.size() > 32 && x.operators[0] <= syntax::Operator::subtract;
}

Value evaluate_chain(Elaboration& e, const Environment& in, const syntax::Expression& x) {
  const OperationPlace place{x.at, in.in_function};
  Value result = evaluate(e, in, *x.operands[0]);
  if (!is_long_sum(x)) {
    for (size_t k = 0; k < x.operators.size(); ++k)
      result = binary(e, x.operators[k], result, evaluate(e, in, *x.operands[k + 1]), place);
    return result;
  }
  std::vector<Expression> terms;
  if (result.is_scalar() && result.is_numeric()) terms.push_back(result.scalars[0]);
  for (size_t k = 0; k < x.operators.size(); ++k) {
    const Value term = evaluate(e, in, *x.operands[k + 1]);
    if (!term.is_scalar() || !term.is_numeric() || terms.size() != k + 1 || terms.back() == nullptr ||
        term.scalars[0] == nullptr) {
      // Arrays or strings: from here on, as in a short chain.
      if (!terms.empty()) result.scalars = {sum_of(e, terms, x.at)};
      terms.clear();
      result = binary(e, x.operators[k], result, term, place);
      continue;
    }
    if (term.kind == Kind::real) result.kind = Kind::real;
    const bool is_minus = x.operators[k] == syntax::Operator::subtract;
    terms.push_back(is_minus ? e.pool.make(Operation::negate, {term.scalars[0]}, x.at) : term.scalars[0]);
  }
  if (!terms.empty()) result.scalars = {sum_of(e, terms, x.at)};
  return result;
}

Value evaluate_choose(Elaboration& e, const Environment& in, const syntax::Expression& x) {
  std::deque<Guard> guards;  // a deque, so that addresses remain valid
  std::vector<std::pair<Expression, Value>> cases;
  Environment here = in;
  Value otherwise;
  for (size_t k = 0;; k += 2) {
    if (k + 1 == x.operands.size()) {
      otherwise = evaluate(e, here, *x.operands[k]);
      break;
    }
    const Expression condition = evaluate_condition(e, here, *x.operands[k], "the condition of an if-expression");
    if (is_number(condition, 0.0)) continue;
    if (is_number(condition)) {
      otherwise = evaluate(e, here, *x.operands[k + 1]);
      break;
    }
    guards.push_back({here.guard, condition, false});
    Environment inside = here;
    inside.guard = &guards.back();
    cases.emplace_back(condition, evaluate(e, inside, *x.operands[k + 1]));
    guards.push_back({here.guard, condition, true});
    here.guard = &guards.back();
  }
  for (; !cases.empty(); cases.pop_back()) {
    const auto& [condition, value] = cases.back();
    if (value.dims != otherwise.dims) {
      if (const std::optional<double> known = constant_value(e, condition)) {
        if (*known != 0.0) otherwise = value;
        continue;
      }
    }
    otherwise = choose(e, condition, value, otherwise, x.at);
  }
  return otherwise;
}

// [a, b; c, d]: rows of scalars, vectors as columns, or matrices side by side and stacked.
Value evaluate_matrix(Elaboration& e, const Environment& in, const syntax::Expression& x) {
  std::vector<Expression> scalars;
  Kind kind = Kind::integer;
  const syntax::Definition* definition = nullptr;
  int rows = 0, columns = -1;
  for (const syntax::ExpressionPointer& row : x.operands) {
    std::vector<Value> parts;
    int height = -1, width = 0;
    for (const syntax::ExpressionPointer& part : row->operands) {
      Value value = evaluate(e, in, *part);
      if (!value.has_scalars() || value.dims.size() > 2) e.fail(part->at, shown_type(value) + " in a matrix [ ]");
      value.dims.resize(2, 1);
      if (value.scalars.size() == 1) value.dims = {1, 1};
      if (height >= 0 && height != value.dims[0]) e.fail(part->at, "parts of a row of a matrix [ ] differ in height");
      height = value.dims[0];
      width += value.dims[1];
      if (value.kind != Kind::integer) kind = value.kind;
      definition = value.definition;
      parts.push_back(std::move(value));
    }
    if (columns >= 0 && columns != width) e.fail(row->at, "rows of a matrix [ ] differ in length");
    columns = width;
    rows += height;
    for (int i = 0; i < height; ++i)
      for (const Value& part : parts)
        scalars.insert(scalars.end(), part.scalars.begin() + i * part.dims[1],
                       part.scalars.begin() + (i + 1) * part.dims[1]);
    e.charge(static_cast<long>(scalars.size()), x.at);
  }
  Value result;
  result.kind = kind;
  result.definition = definition;
  result.dims = {rows, columns};
  result.scalars = std::move(scalars);
  return result;
}

Value evaluate_list(Elaboration& e, const Environment& in, const syntax::Expression& x) {
  std::vector<Value> elements;
  for (const syntax::ExpressionPointer& operand : x.operands) elements.push_back(evaluate(e, in, *operand));
  return array_of(e, elements, x.at);
}

Value evaluate_range_expression(Elaboration& e, const Environment& in, const syntax::Expression& x) {
  std::vector<double> numbers;
  Value result;
  result.kind = Kind::integer;
  for (const syntax::ExpressionPointer& operand : x.operands) {
    const Value value = evaluate(e, in, *operand);
    if (!value.is_scalar() || !value.has_scalars()) e.fail(operand->at, "a range of " + shown_type(value));
    const std::optional<double> number = constant_value(e, value.scalars[0]);
    if (!number) e.fail(operand->at, "a range whose limits vary; use constants and parameters");
    numbers.push_back(*number);
    if (value.kind != Kind::integer) result.kind = value.kind, result.definition = value.definition;
  }
  const double first = numbers[0], step = numbers.size() == 3 ? numbers[1] : 1.0, last = numbers.back();
  if (step == 0.0) e.fail(x.at, "a range with the step 0");
  const double count = std::max(0.0, std::floor((last - first) / step * (1.0 + 1e-15) + 1e-9) + 1.0);
  if (!(count <= static_cast<double>(Limits::kMaxElements)))
    e.fail(x.at, "a range of more than " + std::to_string(Limits::kMaxElements) + " elements; make it shorter");
  result.dims = {static_cast<int>(count)};
  e.charge(static_cast<long>(count), x.at);
  for (int k = 0; k < result.dims[0]; ++k) result.scalars.push_back(e.pool.number(first + k * step, x.at));
  return result;
}

Value evaluate_end(Elaboration& e, const Environment& in, const syntax::Expression& x) {
  if (in.indexed == nullptr || in.indexed_dimension >= static_cast<int>(in.indexed->dims.size()))
    e.fail(x.at, "'end' outside of subscripts");
  const int n = in.indexed->dims[static_cast<size_t>(in.indexed_dimension)];
  return scalar_value(Kind::integer, e.pool.number(n, x.at));
}

}  // namespace

Value evaluate(Elaboration& e, const Environment& in, const syntax::Expression& x) {
  const Depth depth(e, x.at);
  e.charge(1, x.at);
  switch (x.form) {
    case Form::number:
      if (!std::isfinite(x.number)) e.fail(x.at, "a number that is too large for double precision");
      return scalar_value(x.is_integer ? Kind::integer : Kind::real, e.pool.number(x.number, x.at));
    case Form::text: return text_value(x.text);
    case Form::truth: return scalar_value(Kind::boolean, e.pool.number(x.number, x.at));
    case Form::name: return *find_name(e, in, x);
    case Form::member: return evaluate_member(e, in, x);
    case Form::subscripted: return evaluate_subscripted(e, in, x);
    case Form::call:
    case Form::comprehension: {
      std::vector<Value> results = evaluate_call(e, in, x);
      if (results.empty()) e.fail(x.at, "'" + plain(x.text) + "' has no result; it cannot be part of an expression");
      return std::move(results[0]);
    }
    case Form::chain: return evaluate_chain(e, in, x);
    case Form::unary: return unary(e, x.operators[0], evaluate(e, in, *x.operands[0]), {x.at, in.in_function});
    case Form::choose: return evaluate_choose(e, in, x);
    case Form::list: return evaluate_list(e, in, x);
    case Form::matrix: return evaluate_matrix(e, in, x);
    case Form::range: return evaluate_range_expression(e, in, x);
    case Form::tuple: e.fail(x.at, "a list of results in parentheses where one value is needed");
    case Form::end: return evaluate_end(e, in, x);
    case Form::all: e.fail(x.at, "':' outside of subscripts");
  }
  e.fail(x.at, "an expression that is not understood");
}

std::vector<Value> evaluate_outputs(Elaboration& e, const Environment& in, const syntax::Expression& x) {
  if (x.form == Form::call) {
    const Depth depth(e, x.at);
    return evaluate_call(e, in, x);
  }
  return {evaluate(e, in, x)};
}

Value evaluate_range(Elaboration& e, const Environment& in, const syntax::Expression& x) {
  Value result = evaluate(e, in, x);
  if (result.dims.size() != 1) e.fail(x.at, "a loop over " + shown_type(result) + "; give a range or a vector");
  return result;
}

Expression evaluate_condition(Elaboration& e, const Environment& in, const syntax::Expression& x,
                              const std::string& what) {
  const Value result = evaluate(e, in, x);
  if (result.kind != Kind::boolean || !result.is_scalar())
    e.fail(x.at, what + " is " + shown_type(result) + ", expected a Boolean");
  if (result.scalars[0] == nullptr) e.fail(x.at, what + " is used before it has been assigned");
  return result.scalars[0];
}

std::optional<double> constant_value(Elaboration& e, const Expression& expression) {
  if (expression == nullptr) return std::nullopt;
  const std::optional<double> value = e.symbols->value_of(expression, expression->at);
  return value && std::isnan(*value) ? std::nullopt : value;  // undefined values may never be needed
}

int evaluate_integer(Elaboration& e, const Environment& in, const syntax::Expression& x, const std::string& what) {
  const Value result = evaluate(e, in, x);
  const bool fits = result.is_scalar() && result.has_scalars() && result.kind != Kind::real;
  if (!fits) e.fail(x.at, what + " is " + shown_type(result) + ", expected an Integer");
  const std::optional<double> value = constant_value(e, result.scalars[0]);
  if (!value) e.fail(x.at, what + " varies; use constants and parameters");
  if (!(std::fabs(*value) <= 2e9)) e.fail(x.at, what + " is too large");
  return static_cast<int>(*value);
}

Expression guard_condition(Elaboration& e, const Guard* guard, Location at) {
  Expression result = e.pool.truth(true, at);
  for (; guard != nullptr; guard = guard->outer) {
    Expression one = guard->condition;
    if (guard->is_negated) one = e.pool.make(Operation::not_, {one}, at);
    result = e.pool.make(Operation::and_, {one, result}, at);
  }
  return result;
}

void add_assertion(Elaboration& e, const Environment& in, Assertion assertion) {
  if (in.assertions == nullptr || is_number(assertion.condition, 1.0)) return;
  const Expression guard = guard_condition(e, in.guard, assertion.at);
  const Expression unguarded = e.pool.make(Operation::not_, {guard}, assertion.at);
  assertion.condition = e.pool.make(Operation::or_, {unguarded, assertion.condition}, assertion.at);
  if (!is_number(assertion.condition, 1.0)) in.assertions->push_back(std::move(assertion));
}

}  // namespace sfdae::cli
