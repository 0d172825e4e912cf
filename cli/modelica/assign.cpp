// SPDX-License-Identifier: BSD-3-Clause
#include "modelica/assign.h"

#include <utility>

#include "modelica/arithmetic.h"
#include "modelica/lexer.h"

namespace sfdae::cli {

using syntax::Form;

namespace {

// Replaces the scalars and strings of a value by their positions, so that selecting from it yields positions.
class Places {
 public:
  explicit Places(Elaboration& e) : e_(e) {}

  Value of(const Value& value) {
    Value result = empty_like(value, value.dims);
    for (size_t k = 0; k < value.scalars.size(); ++k) result.scalars.push_back(e_.pool.number(count_++));
    for (size_t k = 0; k < value.texts.size(); ++k) result.texts.push_back({std::to_string(num_texts_++)});
    for (const RecordValue& record : value.records) {
      result.records.emplace_back();
      for (const auto& [name, field] : record.fields) result.records.back().fields.emplace_back(name, of(field));
    }
    return result;
  }

 private:
  Elaboration& e_;
  double count_ = 0.0;
  size_t num_texts_ = 0;
};

void append_texts(Value& value, std::vector<Text*>& result) {
  for (Text& text : value.texts) result.push_back(&text);
  for (RecordValue& record : value.records)
    for (auto& [name, field] : record.fields) append_texts(field, result);
}

// The part that `left` selects from the value of its name.
Value part_of(Elaboration& e, const Environment& in, const Value& whole, const syntax::Expression& left) {
  if (left.form == Form::member) return member_of(e, part_of(e, in, whole, *left.operands[0]), left.text, left.at);
  if (left.form == Form::subscripted) return select(e, in, part_of(e, in, whole, *left.operands[0]), left);
  return whole;
}

// The position of an element 'a'[1, i] with constant subscripts.
std::optional<size_t> single_position(Elaboration& e, const Environment& in, const Value& whole,
                                      const syntax::Expression& left) {
  const bool is_element = left.form == Form::subscripted && left.operands[0]->form == Form::name &&
                          left.operands.size() == whole.dims.size() + 1 && whole.has_scalars();
  if (!is_element) return std::nullopt;
  Environment inside = in;
  inside.indexed = &whole;
  size_t result = 0;
  for (size_t k = 1; k < left.operands.size(); ++k) {
    if (left.operands[k]->form == Form::all) return std::nullopt;
    inside.indexed_dimension = static_cast<int>(k) - 1;
    const Value index = evaluate(e, inside, *left.operands[k]);
    if (!index.is_scalar() || index.kind != Kind::integer) return std::nullopt;
    const std::optional<double> value = constant_value(e, index.scalars[0]);
    const int n = whole.dims[k - 1];
    if (!value || !(*value >= 1.0 && *value <= n)) return std::nullopt;
    result = result * static_cast<size_t>(n) + static_cast<size_t>(*value) - 1;
  }
  return result;
}

// A subscript that varies: one scalar subscript of the last part, 'a'[i] or 'a'[1, i].
struct Varying {
  const syntax::Expression* subscripted = nullptr;
  size_t operand = 0;
  Expression index;
};

// Subscripts of any form may vary; `end` in them refers to the array that they belong to.
Varying find_varying(Elaboration& e, const Environment& in, const Value& whole, const syntax::Expression& left) {
  if (left.form != Form::subscripted && left.form != Form::member) return {};
  const Varying of_base = find_varying(e, in, whole, *left.operands[0]);
  if (of_base.subscripted != nullptr || left.form == Form::member) return of_base;
  std::optional<Value> array;
  Environment inside = in;
  for (size_t k = 1; k < left.operands.size(); ++k) {
    const syntax::Expression& x = *left.operands[k];
    if (x.form == Form::all || x.form == Form::number || x.form == Form::end || x.form == Form::range) continue;
    if (left.operands[0]->form == Form::name) inside.indexed = &whole;
    else inside.indexed = array ? &*array : &array.emplace(part_of(e, in, whole, *left.operands[0]));
    inside.indexed_dimension = static_cast<int>(k) - 1;
    const Value index = evaluate(e, inside, x);
    if (index.is_scalar() && index.has_scalars() && index.scalars[0] && !constant_value(e, index.scalars[0]))
      return {&left, k, index.scalars[0]};
  }
  return {};
}

void store(Elaboration& e, Value& whole, const Value& places, const Value& value, const Expression& active,
           Location at) {
  std::vector<Expression*> to = scalars_of(whole);
  std::vector<Expression> at_places, from;
  append_scalars(places, at_places);
  append_scalars(value, from);
  for (size_t k = 0; k < at_places.size(); ++k) {
    if (!is_number(at_places[k]))
      e.fail(at, "an assignment to elements whose subscripts vary; assign to single elements");
    Expression& target = *to[static_cast<size_t>(at_places[k]->value)];
    if (from[k] == nullptr) continue;
    target = target == nullptr ? from[k] : e.pool.make(Operation::choose, {active, from[k], target}, at);
  }
  std::vector<Text*> texts, from_texts, place_texts;
  append_texts(whole, texts);
  append_texts(const_cast<Value&>(value), from_texts);
  append_texts(const_cast<Value&>(places), place_texts);
  for (size_t k = 0; k < place_texts.size(); ++k) {
    *texts[std::stoul(place_texts[k]->text)] = *from_texts[k];
    if (!is_number(active)) texts[std::stoul(place_texts[k]->text)]->is_exact = false;
  }
}

}  // namespace

const syntax::Expression& name_of(const Elaboration& e, const syntax::Expression& left) {
  const syntax::Expression* result = &left;
  while (result->form == Form::member || result->form == Form::subscripted) result = result->operands[0].get();
  if (result->form != Form::name) e.fail(left.at, "an assignment to something that is no variable");
  return *result;
}

namespace {

struct Assignment {
  Value& whole;
  const syntax::Expression& left;
  const Value& value;
  const Expression& active;
};

// Each element that may be selected gets the new value or keeps its own, depending on the subscript.
void assign_varying(Elaboration& e, const Environment& in, const Assignment& a, const Varying& varying) {
  const syntax::Expression& left = a.left;
  if (varying.subscripted != &left || left.operands[0]->form != Form::name ||
      left.operands.size() != a.whole.dims.size() + 1)
    e.fail(left.at, "an assignment to a part of an array whose subscript varies; assign to single elements");
  const int n = a.whole.dims[varying.operand - 1];
  Environment inside = in;
  inside.indexed = &a.whole;
  for (int k = 1; k <= n; ++k) {
    const Expression is_k = operate(e, Operation::equal, {varying.index, e.pool.number(k)}, {left.at, true});
    syntax::Expression element;
    element.form = Form::subscripted;
    element.at = left.at;
    for (size_t i = 0; i < left.operands.size(); ++i) {
      auto operand = std::make_unique<syntax::Expression>();
      operand->at = left.at;
      operand->is_integer = true;
      if (i == 0) operand->form = Form::name, operand->text = left.operands[0]->text;
      inside.indexed_dimension = static_cast<int>(i) - 1;
      if (i > 0)
        operand->number = i == varying.operand ? k : evaluate_integer(e, inside, *left.operands[i], "a subscript");
      element.operands.push_back(std::move(operand));
    }
    assign_part(e, in, a.whole, element, a.value, e.pool.make(Operation::and_, {a.active, is_k}, left.at));
  }
}

}  // namespace

void assign_part(Elaboration& e, const Environment& in, Value& whole, const syntax::Expression& left,
                 const Value& value, const Expression& active) {
  const syntax::Expression& name = name_of(e, left);
  if (const std::optional<size_t> position = single_position(e, in, whole, left)) {
    const std::string what = "'" + plain(name.text) + "'";
    if (!value.is_scalar()) e.fail(left.at, what + ": " + shown_type(value) + " is assigned to an element");
    const Expression scalar = convert(e, value, whole.kind, whole.definition, what, left.at).scalars[0];
    Expression& target = whole.scalars[*position];
    if (scalar != nullptr)
      target = target == nullptr ? scalar : e.pool.make(Operation::choose, {active, scalar, target}, left.at);
    return;
  }
  const Varying varying = find_varying(e, in, whole, left);
  if (varying.subscripted != nullptr) return assign_varying(e, in, {whole, left, value, active}, varying);
  e.charge(static_cast<long>(whole.size()), left.at);
  const Value places = part_of(e, in, Places(e).of(whole), left);
  if (places.dims != value.dims)
    e.fail(left.at, "'" + plain(name.text) + "': " + shown_type(value) + " is assigned to " + shown_type(places) +
                        "; make the sizes agree");
  const Value converted = convert(e, value, places.kind, places.definition, "'" + plain(name.text) + "'", left.at);
  store(e, whole, places, converted, active, left.at);
}

}  // namespace sfdae::cli
