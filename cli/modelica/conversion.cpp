// Conversions of values to other types and shapes.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <utility>

#include "modelica/arithmetic.h"
#include "modelica/lexer.h"

namespace sfdae::cli {

namespace {

// The common kind of both; fails if there is none.
Kind common_kind(const Elaboration& e, const Value& a, const Value& b, Location at) {
  if (a.kind == b.kind && (a.kind != Kind::enumeration || a.definition == b.definition)) return a.kind;
  if (a.is_numeric() && b.is_numeric()) return Kind::real;
  if (a.size() == 0) return b.kind;
  if (b.size() == 0) return a.kind;
  e.fail(at, shown_type(a) + " and " + shown_type(b) + " where the same type is needed");
}

RecordValue choose_fields(Elaboration& e, const Expression& condition, const RecordValue& first,
                          const RecordValue& second, Location at) {
  RecordValue result;
  for (const auto& [name, value] : first.fields) {
    const Value* other = second.find(name);
    if (other == nullptr) e.fail(at, "the records of two branches differ in the field '" + plain(name) + "'");
    result.fields.emplace_back(name, choose(e, condition, value, *other, at));
  }
  return result;
}

RecordValue convert_fields(Elaboration& e, const RecordValue& from, const syntax::Definition& definition,
                           const std::string& what, Location at) {
  RecordValue result;
  for (const syntax::Declaration& field : definition.elements) {
    const Value* value = from.find(field.name);
    if (value == nullptr) e.fail(at, what + " has no field '" + plain(field.name) + "', which its record type has");
    const ResolvedType type = resolve_type(e, field.type, field.type_at);
    if (value->dims.size() != field.dimensions.size() + type.dimensions.size())
      e.fail(at, what + ": the field '" + plain(field.name) + "' is " + shown_type(*value) +
                     ", its record type has " + std::to_string(field.dimensions.size() + type.dimensions.size()) +
                     " dimensions");
    result.fields.emplace_back(field.name,
                               convert(e, *value, type.kind, type.definition, what + "." + plain(field.name), at));
  }
  return result;
}

}  // namespace

Value choose(Elaboration& e, const Expression& condition, const Value& first, const Value& second, Location at) {
  const Kind kind = common_kind(e, first, second, at);
  if (first.dims != second.dims)
    e.fail(at, "two branches have the sizes " + shown_type(first) + " and " + shown_type(second) +
                   "; make them the same, or the condition a constant");
  Value result = empty_like(first, first.dims);
  result.kind = kind;
  e.charge(static_cast<long>(first.size()), at);
  for (size_t k = 0; k < first.scalars.size(); ++k) {
    const Expression &a = first.scalars[k], &b = second.scalars[k];
    const bool is_choice = a != nullptr && b != nullptr && a != b;
    result.scalars.push_back(is_choice      ? e.pool.make(Operation::choose, {condition, a, b}, at)
                             : a != nullptr ? a
                                            : b);
  }
  for (size_t k = 0; k < first.texts.size(); ++k) {
    const bool same = first.texts[k].text == second.texts[k].text;
    result.texts.push_back(same ? first.texts[k] : Text{first.texts[k].text + "|" + second.texts[k].text, false});
  }
  for (size_t k = 0; k < first.records.size(); ++k)
    result.records.push_back(choose_fields(e, condition, first.records[k], second.records[k], at));
  return result;
}

Value convert(Elaboration& e, const Value& value, Kind kind, const syntax::Definition* definition,
              const std::string& what, Location at) {
  const bool is_empty = value.size() == 0;
  const bool fits = value.kind == kind || (kind == Kind::real && value.kind == Kind::integer) || is_empty;
  const bool same_enumeration = kind != Kind::enumeration || is_empty || value.definition == definition;
  if (!fits || !same_enumeration) {
    Value wanted;
    wanted.kind = kind;
    wanted.definition = definition;
    e.fail(at, what + " is " + shown_type(wanted) + " but gets " + shown_type(value) + "; make the types agree");
  }
  Value result = value;
  result.kind = kind;
  if (kind == Kind::record && definition != nullptr && value.definition != definition) {
    for (RecordValue& record : result.records) record = convert_fields(e, record, *definition, what, at);
  }
  if (kind == Kind::enumeration || kind == Kind::record) result.definition = definition;
  return result;
}

Value array_of(Elaboration& e, const std::vector<Value>& elements, Location at) {
  Value result;
  if (elements.empty()) {
    result.dims = {0};
    return result;
  }
  result = empty_like(elements[0], {static_cast<int>(elements.size())});
  result.dims.insert(result.dims.end(), elements[0].dims.begin(), elements[0].dims.end());
  check_dims(e, result.dims, at);
  e.charge(static_cast<long>(product(result.dims)), at);
  for (const Value& one : elements) {
    if (one.dims != elements[0].dims)
      e.fail(at, "an array of elements of the sizes " + shown_type(elements[0]) + " and " + shown_type(one) +
                     "; make them the same");
    if (one.kind == Kind::function) e.fail(at, "functions in an array are not supported");
    result.kind = common_kind(e, result, one, at);
    append_elements(result, one);
  }
  return result;
}

}  // namespace sfdae::cli
