// Function calls: resolution of the name and evaluation of the arguments.
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <utility>

#include "modelica/arithmetic.h"
#include "modelica/built_in.h"
#include "modelica/function.h"
#include "modelica/lexer.h"
#include "modelica/tables.h"

namespace sfdae::cli {

using syntax::Definition;
using syntax::DefinitionKind;
using syntax::Form;

namespace {

// der, pre, edge and change refer to variables, not to values that algorithms have assigned.
bool speaks_of_variables(const std::string& name) {
  return name == "der" || name == "pre" || name == "edge" || name == "change";
}

std::vector<Argument> evaluate_arguments(Elaboration& e, const Environment& in, const syntax::Expression& call) {
  std::vector<Argument> result;
  Environment inside = in;
  if (speaks_of_variables(call.text)) inside.scope = &in.scope->declared();
  if (call.text == "Clock" || call.text == "delay" || call.text == "spatialDistribution") return result;
  for (size_t k = 0; k < call.operands.size(); ++k) {
    if (call.operands[k] == nullptr) e.fail(call.at, "an argument is missing");
    result.push_back({call.names[k], evaluate(e, inside, *call.operands[k]), call.operands[k]->at});
  }
  return result;
}

// 'E'(i)
Value to_enumeration(Elaboration& e, const Definition& enumeration, const Call& call) {
  check_count(e, call, 1, 1);
  const Expression i = scalar_argument(e, call, 0, Kind::integer);
  Value result = scalar_value(Kind::enumeration, i);
  result.definition = &enumeration;
  return result;
}

// {f(i) for i in 1:3, j in 1:2}: the last iterator runs outermost.
Value comprehend(Elaboration& e, const Environment& in, const syntax::Expression& x, size_t iterator) {
  const Value range = evaluate_range(e, in, *x.operands[iterator + 1]);
  std::vector<Value> elements;
  for (size_t k = 0; k < range.size(); ++k) {
    e.charge(1, x.at);
    IteratorScope scope(*in.scope, x.names[iterator], element(range, k));
    Environment inside = in;
    inside.scope = &scope;
    elements.push_back(iterator == 0 ? evaluate(e, inside, *x.operands[0]) : comprehend(e, inside, x, iterator - 1));
  }
  return array_of(e, elements, x.at);
}

std::vector<Value> call_comprehension(Elaboration& e, const Environment& in, const syntax::Expression& x) {
  const Value array = comprehend(e, in, x, x.names.size() - 1);
  if (x.text.empty() || x.text == "array") return {array};
  if (x.text != "sum" && x.text != "product" && x.text != "min" && x.text != "max")
    e.fail(x.at, "'" + plain(x.text) + "' over an iterator; known are sum, product, min, max and { }");
  const Call call{x.text, {{"", array, x.at}}, x.at};
  if (std::optional<Value> result = call_array_function(e, in, call)) return {*result};
  return {*call_mathematics(e, in, call)};
}

std::vector<Value> call_definition(Elaboration& e, const Environment& in, const Definition& definition,
                                   const syntax::Expression& x) {
  const Call call{x.text, evaluate_arguments(e, in, x), x.at};
  switch (definition.kind) {
    case DefinitionKind::function: return call_function(e, in, definition, call.arguments, x.at);
    case DefinitionKind::record: return {construct_record(e, definition, call.arguments, x.at)};
    case DefinitionKind::enumeration: return {to_enumeration(e, definition, call)};
    case DefinitionKind::external_object: return {construct_external_object(e, definition, call.arguments, x.at)};
    case DefinitionKind::alias: break;
  }
  e.fail(x.at, "'" + plain(definition.name) + "' is a type, not a function");
}

}  // namespace

std::vector<Value> evaluate_call(Elaboration& e, const Environment& in, const syntax::Expression& x) {
  if (x.form == Form::comprehension) return call_comprehension(e, in, x);
  // Functions may be arguments of functions.
  if (in.in_function)
    if (const ValuePointer local = in.scope->find(x.text, x.at);
        local && local->kind == Kind::function && local->definition)
      return call_definition(e, in, *local->definition, x);
  if (const Definition* definition = e.definitions.find(x.text)) return call_definition(e, in, *definition, x);
  Call call{x.text, {}, x.at};
  if (x.text == "assert" || x.text == "reinit" || x.text == "terminate")
    e.fail(x.at, "'" + x.text + "' has no value; it stands alone");
  call.arguments = evaluate_arguments(e, in, x);
  if (std::optional<Value> result = call_event_operator(e, in, call)) return {std::move(*result)};
  if (std::optional<Value> result = call_mathematics(e, in, call)) return {std::move(*result)};
  if (std::optional<Value> result = call_array_function(e, in, call)) return {std::move(*result)};
  e.fail(x.at, "unknown function '" + plain(x.text) + "'; define it in the package");
}

}  // namespace sfdae::cli
