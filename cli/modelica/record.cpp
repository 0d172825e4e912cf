// SPDX-License-Identifier: BSD-3-Clause
#include "modelica/record.h"

#include <array>
#include <utility>

#include "modelica/arithmetic.h"
#include "modelica/lexer.h"
#include "modelica/symbols.h"

namespace sfdae::cli {

namespace {

Kind kind_of(Type type) {
  switch (type) {
    case Type::integer: return Kind::integer;
    case Type::boolean: return Kind::boolean;
    case Type::enumeration: return Kind::enumeration;
    default: return Kind::real;
  }
}

const std::string& exact_text(const Elaboration& e, const Value& value, const std::string& name, Location at) {
  if (value.kind != Kind::string)
    e.fail(at, "the attribute '" + name + "' is " + shown_type(value) + ", expected a String");
  return value.texts[0].text;
}

double attribute_number(Elaboration& e, const Value& value, Kind kind, const std::string& name, Location at) {
  if (value.kind != kind)
    e.fail(at, "the attribute '" + name + "' is " + shown_type(value) + ", expected " + shown_kind(kind));
  const std::optional<double> number = constant_value(e, value.scalars[0]);
  if (!number) e.fail(at, "the attribute '" + name + "' is not constant; give it a constant or parameter");
  return *number;
}

}  // namespace

void set_attribute(Elaboration& e, Variable& variable, const std::string& name, const Value& value, Location at) {
  if (name == "unit") {
    variable.unit = exact_text(e, value, name, at);
  } else if (name == "displayUnit") {
    variable.display_unit = exact_text(e, value, name, at);
  } else if (name == "fixed") {
    variable.is_fixed = attribute_number(e, value, Kind::boolean, name, at) != 0.0;
  } else if (name == "stateSelect") {
    if (value.kind != Kind::enumeration || value.definition != &e.definitions.state_select())
      e.fail(at, "the attribute 'stateSelect' is " + shown_type(value) + ", expected a StateSelect");
    const double number = attribute_number(e, value, Kind::enumeration, name, at);
    variable.state_select = static_cast<StateSelect>(static_cast<int>(number) - 1);
  } else if (name == "start" || name == "nominal" || name == "min" || name == "max") {
    const Kind kind = name == "nominal" ? Kind::real : kind_of(variable.type);
    const bool fits = value.kind == kind || (kind == Kind::real && value.kind == Kind::integer);
    if (!fits)
      e.fail(at, "the attribute '" + name + "' of '" + variable.name + "' is " + shown_type(value) + ", expected " +
                     shown_kind(kind));
    const Expression& formula = value.scalars[0];
    if (formula == nullptr || e.pool.varies(formula))
      e.fail(at, "the attribute '" + name + "' of '" + variable.name +
                     "' depends on time or a variable; use constants and parameters");
    (name == "start"     ? variable.start
     : name == "nominal" ? variable.nominal
     : name == "min"     ? variable.min
                         : variable.max) = formula;
  } else {
    e.fail(at, "unknown attribute '" + plain(name) +
                   "'; known are start, fixed, nominal, min, max, unit, displayUnit, quantity, stateSelect");
  }
}

Value value_of_global(Elaboration& e, const syntax::Declaration& declaration, Scope& package) {
  const ResolvedType type = resolve_type(e, declaration.type, declaration.type_at);
  Environment in;
  in.scope = &package;
  if (declaration.binding == nullptr) {
    if (type.kind == Kind::record && declaration.dimensions.empty())
      return construct_record(e, *type.definition, {}, declaration.at);
    e.fail(declaration.at,
           "the constant '" + plain(declaration.name) + "' has no value; give it a binding (= value)");
  }
  const Value value = evaluate(e, in, *declaration.binding);
  if (value.dims.size() != declaration.dimensions.size() + type.dimensions.size())
    e.fail(declaration.binding->at, "the constant '" + plain(declaration.name) + "' gets " + shown_type(value) +
                                        ", a value with another number of dimensions");
  return convert(e, value, type.kind, type.definition, "'" + plain(declaration.name) + "'", declaration.binding->at);
}

Value construct_record(Elaboration& e, const syntax::Definition& definition, std::vector<Argument> arguments,
                       Location at) {
  Value result;
  result.kind = Kind::record;
  result.definition = &definition;
  result.records.emplace_back();
  const std::string name = plain(definition.name);
  if (arguments.size() > definition.elements.size())
    e.fail(at, "the record '" + name + "' has " + std::to_string(definition.elements.size()) + " fields, not " +
                   std::to_string(arguments.size()));
  for (size_t k = 0; k < definition.elements.size(); ++k) {
    const syntax::Declaration& field = definition.elements[k];
    const ResolvedType type = resolve_type(e, field.type, field.type_at);
    const Argument* argument = k < arguments.size() && arguments[k].name.empty() ? &arguments[k] : nullptr;
    for (const Argument& one : arguments)
      if (!one.name.empty() && plain(one.name) == plain(field.name)) argument = &one;
    const std::string what = "the field '" + plain(field.name) + "' of '" + name + "'";
    Value value;
    if (argument != nullptr) {
      value = argument->value;
    } else if (field.binding != nullptr) {
      Environment in;
      in.scope = &e.symbols->package();
      value = evaluate(e, in, *field.binding);
    } else {
      e.fail(at, what + " has no value; give it one");
    }
    if (value.dims.size() != field.dimensions.size() + type.dimensions.size())
      e.fail(at, what + " gets " + shown_type(value) + ", a value with another number of dimensions");
    result.records[0].fields.emplace_back(field.name, convert(e, value, type.kind, type.definition, what, at));
  }
  for (const Argument& one : arguments)
    if (!one.name.empty() && result.records[0].find(one.name) == nullptr)
      e.fail(one.at, "the record '" + name + "' has no field '" + plain(one.name) + "'");
  return result;
}

}  // namespace sfdae::cli
