// SPDX-License-Identifier: BSD-3-Clause
#include "modelica/value.h"

#include "modelica/lexer.h"

namespace sfdae::cli {

size_t product(const std::vector<int>& dims) {
  size_t result = 1;
  for (const int n : dims) result *= static_cast<size_t>(n);
  return result;
}

size_t Value::size() const {
  if (kind == Kind::string) return texts.size();
  if (kind == Kind::record) return records.size();
  if (kind == Kind::function) return 1;
  return scalars.size();
}

const Value* RecordValue::find(const std::string& name) const {
  for (const auto& [field, value] : fields)
    if (field == name || plain(field) == plain(name)) return &value;
  return nullptr;
}

Value scalar_value(Kind kind, Expression e) {
  Value result;
  result.kind = kind;
  result.scalars.push_back(std::move(e));
  return result;
}

Value text_value(std::string text, bool is_exact) {
  Value result;
  result.kind = Kind::string;
  result.texts.push_back({std::move(text), is_exact});
  return result;
}

Value empty_like(const Value& value, std::vector<int> dims) {
  Value result;
  result.kind = value.kind;
  result.definition = value.definition;
  result.dims = std::move(dims);
  return result;
}

Value element(const Value& array, size_t k) {
  Value result = empty_like(array, {});
  if (array.kind == Kind::string) result.texts.push_back(array.texts[k]);
  else if (array.kind == Kind::record) result.records.push_back(array.records[k]);
  else if (array.kind != Kind::function) result.scalars.push_back(array.scalars[k]);
  return result;
}

void append_elements(Value& to, const Value& from) {
  to.scalars.insert(to.scalars.end(), from.scalars.begin(), from.scalars.end());
  to.texts.insert(to.texts.end(), from.texts.begin(), from.texts.end());
  to.records.insert(to.records.end(), from.records.begin(), from.records.end());
}

void append_scalars(const Value& value, std::vector<Expression>& result) {
  result.insert(result.end(), value.scalars.begin(), value.scalars.end());
  for (const RecordValue& record : value.records)
    for (const auto& [name, field] : record.fields) append_scalars(field, result);
}

namespace {

void append_pointers(Value& value, std::vector<Expression*>& result) {
  for (Expression& e : value.scalars) result.push_back(&e);
  for (RecordValue& record : value.records)
    for (auto& [name, field] : record.fields) append_pointers(field, result);
}

}  // namespace

std::vector<Expression*> scalars_of(Value& value) {
  std::vector<Expression*> result;
  append_pointers(value, result);
  return result;
}

std::string shown_kind(Kind kind) {
  switch (kind) {
    case Kind::real: return "Real";
    case Kind::integer: return "Integer";
    case Kind::boolean: return "Boolean";
    case Kind::enumeration: return "an enumeration";
    case Kind::string: return "String";
    case Kind::record: return "a record";
    case Kind::function: return "a function";
  }
  return "";
}

std::string shown_dims(const std::vector<int>& dims) {
  std::string result;
  for (const int n : dims) result += (result.empty() ? "" : ",") + std::to_string(n);
  return "[" + result + "]";
}

std::string shown_type(const Value& value) {
  std::string result = shown_kind(value.kind);
  if (value.definition != nullptr) result = "'" + plain(value.definition->name) + "'";
  return value.is_scalar() ? result : result + shown_dims(value.dims);
}

}  // namespace sfdae::cli
