// Values of expressions while a model is expanded: arrays (row by row) and records of scalar formulas.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/expression.h"
#include "modelica/syntax_tree.h"

namespace sfdae::cli {

enum class Kind { real, integer, boolean, enumeration, string, record, function };

struct RecordValue;

// A string; not exact: parts of it are known only at run time, so it can only be shown.
struct Text {
  std::string text;
  bool is_exact = true;
};

struct Value {
  Kind kind = Kind::real;
  const syntax::Definition* definition = nullptr;  // for enumerations, functions and declared records
  std::vector<int> dims;                           // none: a scalar
  std::vector<Expression> scalars;                 // null: not assigned yet
  std::vector<Text> texts;
  std::vector<RecordValue> records;

  bool is_scalar() const { return dims.empty(); }
  bool is_numeric() const { return kind == Kind::real || kind == Kind::integer; }
  bool has_scalars() const { return kind <= Kind::enumeration; }
  // The number of elements if dims are right.
  size_t size() const;
};

struct Field;

struct RecordValue {
  std::vector<Field> fields;
  const Value* find(const std::string& name) const;
};

// Not a std::pair, whose instantiation would require a complete Value.
struct Field {
  Field(std::string n, Value v) : name(std::move(n)), value(std::move(v)) {}
  std::string name;
  Value value;
};

using ValuePointer = std::shared_ptr<const Value>;

Value scalar_value(Kind kind, Expression e);
Value text_value(std::string text, bool is_exact = true);
// One of the elements, a scalar.
Value element(const Value& array, size_t k);
// A value of the same kind, without elements.
Value empty_like(const Value& value, std::vector<int> dims);
void append_elements(Value& to, const Value& from);
size_t product(const std::vector<int>& dims);
// All formulas in a value, those of its records included, in order.
void append_scalars(const Value& value, std::vector<Expression>& result);
std::vector<Expression*> scalars_of(Value& value);

// "Real[3]", for messages.
std::string shown_type(const Value& value);
std::string shown_kind(Kind kind);
std::string shown_dims(const std::vector<int>& dims);

}  // namespace sfdae::cli
