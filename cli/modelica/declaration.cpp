// Scalar variables of declarations, their attributes and bindings; parts of Symbols.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <utility>

#include "modelica/arithmetic.h"
#include "modelica/lexer.h"
#include "modelica/record.h"
#include "modelica/symbol.h"

namespace sfdae::cli {

using syntax::Declaration;
using syntax::Modification;
using syntax::Prefix;

namespace {

constexpr int kMaxRecordDepth = 50;  // records within records

Type type_of(Kind kind) {
  switch (kind) {
    case Kind::integer: return Type::integer;
    case Kind::boolean: return Type::boolean;
    case Kind::enumeration: return Type::enumeration;
    default: return Type::real;
  }
}

// The subscripts of the element at a position, for example [1,2].
std::string subscripts_at(const std::vector<int>& dims, size_t position) {
  std::string result;
  for (size_t d = dims.size(); d-- > 0;) {
    const auto n = static_cast<size_t>(dims[d]);
    result = std::to_string(position % n + 1) + (result.empty() ? "" : ",") + result;
    position /= n;
  }
  return dims.empty() ? "" : "[" + result + "]";
}

std::vector<int> joined(std::vector<int> a, const std::vector<int>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

bool is_ignored_attribute(const std::string& name) {
  constexpr std::array<std::string_view, 5> names = {"quantity", "unbounded", "uncertain", "distribution", "final"};
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

void Symbols::declare(Symbol& one) {
  if (one.is_global || one.declaring == Stage::done) return;
  one.declaring = Stage::running;
  Instance instance;
  instance.name = plain(one.declaration->name);
  if (one.declaration->name[0] == '\'' && by_name_.count(instance.name) > 0)
    instance.name = "'" + instance.name + "'";
  instance.declaration = one.declaration;
  one.value = std::make_shared<Value>(instantiate(one, instance));
  one.declaring = Stage::done;
}

Value Symbols::instantiate(Symbol& one, const Instance& instance) {
  const Declaration& declaration = *instance.declaration;
  if (instance.depth > kMaxRecordDepth)
    e_.fail(declaration.at,
            "records within records beyond " + std::to_string(kMaxRecordDepth) + " levels; end the circle");
  const ResolvedType type = resolve_type(e_, declaration.type, declaration.type_at);
  std::vector<const syntax::Expression*> dimensions;
  for (const syntax::ExpressionPointer& dimension : declaration.dimensions) dimensions.push_back(dimension.get());
  dimensions.insert(dimensions.end(), type.dimensions.begin(), type.dimensions.end());
  Environment in;
  in.scope = instance.is_field ? &package() : this;
  std::vector<int> dims = evaluate_dims(e_, in, dimensions);
  const syntax::Expression* binding = instance.has_binding ? nullptr : declaration.binding.get();
  bool is_of_package = instance.is_field;
  for (const Modification* modification : instance.modifications)
    if (modification->value != nullptr) binding = modification->value.get(), is_of_package = false;
  if (std::count(dims.begin(), dims.end(), -1) > 0) {  // [:]: as many as the binding has
    if (binding == nullptr)
      e_.fail(declaration.at, "'" + plain(declaration.name) + "' has the size : but no binding");
    in.scope = is_of_package ? &package() : this;
    const Value value = evaluate(e_, in, *binding);
    if (value.dims.size() != dims.size()) e_.fail(binding->at, "the binding has another number of dimensions");
    dims = value.dims;
  }
  Instance inner = instance;
  inner.has_binding = instance.has_binding || binding != nullptr;
  Value result;
  if (type.kind == Kind::record) {
    result = instantiate_records(one, inner, type, dims);
  } else if (type.kind == Kind::string) {
    if (one.declaration->prefix != Prefix::parameter && one.declaration->prefix != Prefix::constant)
      e_.fail(declaration.at,
              "the String variable '" + plain(declaration.name) + "'; only String parameters are supported");
    one.has_texts = true;
    result.kind = Kind::string;
    result.dims = dims;
    result.texts.assign(product(dims), Text{"", false});
  } else if (type.kind == Kind::function) {
    if (type.definition->kind != syntax::DefinitionKind::external_object)
      e_.fail(declaration.type_at, "a variable whose type is the function '" + plain(type.definition->name) + "'");
    result.kind = Kind::function;
    result.definition = type.definition;
    one.has_texts = true;  // assigned by the binding
  } else {
    result = instantiate_scalars(one, inner, type, dims);
  }
  if (binding != nullptr)
    one.bindings.push_back(
        {result, binding, is_of_package, instance.outer_dims, instance.outer_position, declaration.at});
  return result;
}

Value Symbols::instantiate_scalars(Symbol& one, const Instance& instance, const ResolvedType& type,
                                   const std::vector<int>& dims) {
  const Declaration& declaration = *instance.declaration;
  Prefix prefix = one.declaration->prefix;
  if (prefix == Prefix::none) prefix = declaration.prefix;
  Variable variable;
  variable.type = type_of(type.kind);
  variable.variability = prefix == Prefix::constant                                  ? Variability::constant
                         : prefix == Prefix::parameter                               ? Variability::parameter
                         : prefix == Prefix::discrete || variable.type != Type::real ? Variability::discrete
                                                                                     : Variability::continuous;
  const bool varies = variable.variability >= Variability::discrete;
  variable.is_input = one.declaration->direction == syntax::Direction::input;
  variable.is_output = one.declaration->direction == syntax::Direction::output;
  variable.is_fixed = !varies;
  variable.description = declaration.comment.empty() ? one.declaration->comment : declaration.comment;
  variable.at = one.declaration->at;
  if (type.kind == Kind::enumeration)
    for (const syntax::Literal& literal : type.definition->literals) variable.literals.push_back(plain(literal.name));
  Value result;
  result.kind = type.kind;
  result.definition = type.definition;
  result.dims = dims;
  Leaf leaf;
  leaf.first = static_cast<int>(e_.model.variables.size());
  e_.charge(static_cast<long>(product(dims)), declaration.at);
  for (size_t k = 0; k < product(dims); ++k) {
    variable.name = instance.name + subscripts_at(dims, k);
    const int index = add_variable(variable);
    symbol_of_variable_[static_cast<size_t>(index)] = &one;
    result.scalars.push_back(e_.pool.variable(Operation::variable, index, varies, declaration.at));
  }
  leaf.dims = dims;
  leaf.outer_dims = instance.outer_dims;
  leaf.outer_position = instance.outer_position;
  for (const std::vector<Modification>* modifications : type.modifications)
    leaf.modifications.emplace_back(modifications, true);
  leaf.modifications.emplace_back(&declaration.modifications, instance.is_field);
  for (const Modification* outer : instance.modifications) leaf.modifications.emplace_back(&outer->nested, false);
  one.leaves.push_back(std::move(leaf));
  return result;
}

Value Symbols::instantiate_records(Symbol& one, const Instance& instance, const ResolvedType& type,
                                   const std::vector<int>& dims) {
  Value result;
  result.kind = Kind::record;
  result.definition = type.definition;
  result.dims = dims;
  for (size_t k = 0; k < product(dims); ++k) {
    e_.charge(1, one.declaration->at);
    RecordValue record;
    for (const Declaration& field : type.definition->elements) {
      Instance inner;
      inner.name = instance.name + subscripts_at(dims, k) + "." + plain(field.name);
      inner.declaration = &field;
      inner.is_field = true;
      inner.has_binding = instance.has_binding;
      inner.outer_dims = joined(instance.outer_dims, dims);
      inner.outer_position = instance.outer_position * product(dims) + k;
      inner.depth = instance.depth + 1;
      const auto collect = [&](const std::vector<Modification>& modifications) {
        for (const Modification& modification : modifications)
          if (plain(modification.name) == plain(field.name)) inner.modifications.push_back(&modification);
      };
      if (!instance.is_field) collect(instance.declaration->modifications);
      for (const Modification* outer : instance.modifications) collect(outer->nested);
      record.fields.emplace_back(field.name, instantiate(one, inner));
    }
    result.records.push_back(std::move(record));
  }
  return result;
}

void Symbols::give_attributes(Symbol& one) {
  if (one.is_global || one.attributes != Stage::none) return;
  declare(one);
  one.attributes = Stage::running;
  for (const Leaf& leaf : one.leaves)
    for (const auto& [modifications, is_of_package] : leaf.modifications)
      for (const Modification& modification : *modifications) {
        Environment in;
        in.scope = is_of_package ? &package() : this;
        apply(leaf, modification, in);
      }
  one.attributes = Stage::done;
}

void Symbols::apply(const Leaf& leaf, const Modification& modification, const Environment& in) {
  const std::string& name = modification.name;
  if (is_ignored_attribute(name)) return;
  if (modification.value == nullptr || !modification.nested.empty())
    e_.fail(modification.at, "the attribute '" + plain(name) + "' needs a value (" + plain(name) + " = ...)");
  const Value value = evaluate(e_, in, *modification.value);
  const size_t count = product(leaf.dims);
  size_t offset = 0;
  if (value.dims == joined(leaf.outer_dims, leaf.dims)) offset = leaf.outer_position * count;
  else if (!value.is_scalar() && value.dims != leaf.dims)
    e_.fail(modification.value->at, "the attribute '" + plain(name) + "' has the size " + shown_dims(value.dims) +
                                        ", its variable " + shown_dims(leaf.dims));
  for (size_t k = 0; k < count; ++k) {
    Variable& variable = e_.model.variables[static_cast<size_t>(leaf.first) + k];
    const Value scalar = element(value, value.is_scalar() ? 0 : offset + k);
    set_attribute(e_, variable, name, scalar, modification.value->at);
  }
}

void Symbols::bind(Symbol& one) {
  if (one.binding_stage != Stage::none) return;
  declare(one);
  one.binding_stage = Stage::running;
  if (one.is_global) {
    one.value = std::make_shared<Value>(value_of_global(e_, *one.declaration, package()));
  } else {
    for (const Binding& binding : one.bindings) bind(one, binding);
  }
  if (one.is_constant()) settle_constants(one);
  one.binding_stage = Stage::done;
}

void Symbols::bind(Symbol& one, const Binding& binding) {
  Environment in;
  in.scope = binding.is_of_package ? &package() : this;
  in.assertions = &e_.model.assertions;
  Value value = evaluate(e_, in, *binding.expression);
  Value target = binding.target;
  if (value.dims != target.dims && !binding.outer_dims.empty()) {
    const size_t count = product(target.dims);
    const bool is_whole = value.dims == joined(binding.outer_dims, target.dims);
    if (is_whole || value.is_scalar()) {
      Value part = empty_like(value, target.dims);
      for (size_t k = 0; k < count; ++k)
        append_elements(part, element(value, is_whole ? binding.outer_position * count + k : 0));
      value = std::move(part);
    }
  }
  const std::string what = "'" + plain(one.declaration->name) + "'";
  if (value.dims != target.dims)
    e_.fail(binding.expression->at,
            what + " has the size " + shown_type(target) + " but its binding " + shown_type(value));
  value = convert(e_, value, target.kind, target.definition, what, binding.expression->at);
  if (target.kind == Kind::function) {
    if (one.value->kind == Kind::function) *one.value = std::move(value);
    return;
  }
  assign(one, target, value, binding.at);
  if (target.kind == Kind::string && one.value->kind == Kind::string) *one.value = target;
}

void Symbols::assign(Symbol& one, Value& target, const Value& value, Location at) {
  for (size_t k = 0; k < target.scalars.size(); ++k) assign_scalar(one, target.scalars[k], value.scalars[k], at);
  target.texts = value.texts;
  for (size_t k = 0; k < target.records.size(); ++k)
    for (size_t i = 0; i < target.records[k].fields.size(); ++i) {
      const Value* field = value.records[k].find(target.records[k].fields[i].name);
      Value& to = target.records[k].fields[i].value;
      if (field == nullptr || field->dims != to.dims)
        e_.fail(at, "the field '" + plain(target.records[k].fields[i].name) + "' of the binding has another size");
      assign(one, to, *field, at);
    }
}

void Symbols::assign_scalar(Symbol& one, Expression& target, const Expression& value, Location at) {
  if (value == nullptr) e_.fail(at, "the binding of '" + plain(one.declaration->name) + "' has not been assigned");
  Variable& variable = e_.model.variables[static_cast<size_t>(target->index)];
  if (variable.variability >= Variability::discrete) {
    variable.is_input = false;  // the binding supplies it
    e_.model.equations.push_back({target, value, at});
  } else if (e_.pool.varies(value)) {
    e_.fail(at,
            "the value of '" + variable.name + "' depends on time or a variable; parameters and constants may not");
  } else {
    variable.binding = value;
  }
}

void Symbols::settle_constants(Symbol& one) {
  if (one.value == nullptr) return;
  for (Expression* scalar : scalars_of(*one.value)) {
    if (*scalar == nullptr || is_number(*scalar)) continue;
    const Location at = one.declaration->at;
    if ((*scalar)->operation == Operation::variable && !one.is_global) {
      const Variable& variable = e_.model.variables[static_cast<size_t>((*scalar)->index)];
      const Expression& formula = variable.binding ? variable.binding : variable.start;
      if (formula == nullptr) continue;  // an error is reported if it is used
      *scalar = formula;
    }
    const std::optional<double> value = value_of(*scalar, at);
    if (!value) e_.fail(at, "the value of the constant '" + plain(one.declaration->name) + "' is not constant");
    *scalar = e_.pool.number(*value, at);
  }
}

}  // namespace sfdae::cli
