// Elements, slices and fields of values.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <utility>

#include "modelica/arithmetic.h"
#include "modelica/lexer.h"

namespace sfdae::cli {

using syntax::Form;

namespace {

// One subscript: positions from 0, or an index that is known only at run time.
struct Subscript {
  std::vector<size_t> positions;
  bool is_scalar = false;
  Expression varying;
  bool is_safe = false;  // an enumeration with as many literals as the array has elements
};

size_t position_of(Elaboration& e, const Expression& index, int n, Location at) {
  const std::optional<double> value = constant_value(e, index);
  if (!value) e.fail(at, "a subscript that varies within a slice; use constants and parameters");
  if (!(*value >= 1.0 && *value <= n))
    e.fail(at,
           "a subscript is out of range: " + std::to_string(static_cast<long long>(std::clamp(*value, -9e15, 9e15))) +
               " of 1 to " + std::to_string(n));
  return static_cast<size_t>(*value) - 1;
}

Subscript evaluate_subscript(Elaboration& e, const Environment& in, const syntax::Expression& x, int n) {
  Subscript result;
  if (x.form == Form::all) {
    for (int k = 0; k < n; ++k) result.positions.push_back(static_cast<size_t>(k));
    return result;
  }
  const Value value = evaluate(e, in, x);
  if (!value.has_scalars() || value.kind == Kind::real || value.dims.size() > 1)
    e.fail(x.at, "a subscript is " + shown_type(value) + ", expected an Integer");
  for (const Expression& scalar : value.scalars) {
    if (scalar == nullptr) e.fail(x.at, "a subscript is used before it has been assigned");
    // false and true count from 1
    const Expression index =
        value.kind == Kind::boolean ? e.pool.make(Operation::add, {scalar, e.pool.number(1.0)}, x.at) : scalar;
    if (value.is_scalar() && !constant_value(e, index)) {
      result.varying = index;
      result.is_safe = value.definition != nullptr && value.definition->literals.size() == static_cast<size_t>(n);
    } else {
      result.positions.push_back(position_of(e, index, n, x.at));
    }
  }
  result.is_scalar = value.is_scalar();
  return result;
}

Value select_positions(const Value& array, const std::vector<Subscript>& subscripts) {
  Value result = empty_like(array, {});
  std::vector<size_t> offsets{0};
  for (size_t d = 0; d < array.dims.size(); ++d) {
    std::vector<size_t> next;
    next.reserve(offsets.size() * subscripts[d].positions.size());
    for (const size_t offset : offsets)
      for (const size_t position : subscripts[d].positions)
        next.push_back(offset * static_cast<size_t>(array.dims[d]) + position);
    offsets = std::move(next);
    if (!subscripts[d].is_scalar) result.dims.push_back(static_cast<int>(subscripts[d].positions.size()));
  }
  for (const size_t offset : offsets) {
    if (array.kind == Kind::string) result.texts.push_back(array.texts[offset]);
    else if (array.kind == Kind::record) result.records.push_back(array.records[offset]);
    else result.scalars.push_back(array.scalars[offset]);
  }
  return result;
}

void assert_range(Elaboration& e, const Environment& in, const Expression& index, int n, Location at) {
  const auto make = [&](Operation operation, double limit) {
    return operate(e, operation, {index, e.pool.number(limit, at)}, {at, in.in_function});
  };
  Assertion assertion;
  assertion.condition =
      e.pool.make(Operation::and_, {make(Operation::greater_equal, 1.0), make(Operation::less_equal, n)}, at);
  assertion.message = "a subscript is out of range 1 to " + std::to_string(n);
  assertion.at = at;
  add_assertion(e, in, std::move(assertion));
}

// values[index - 1], selected by bisection.
Value choose_by_index(Elaboration& e, const Environment& in, const Expression& index, std::vector<Value>& values,
                      Location at) {
  std::vector<size_t> ends;  // by value: the largest index that selects it
  for (size_t k = 1; k <= values.size(); ++k) ends.push_back(k);
  while (values.size() > 1) {
    size_t count = 0;
    for (size_t k = 0; k < values.size(); k += 2) {
      if (k + 1 < values.size()) {
        const Expression limit = e.pool.number(static_cast<double>(ends[k]), at);
        const Expression is_first = operate(e, Operation::less_equal, {index, limit}, {at, in.in_function});
        values[count] = choose(e, is_first, values[k], values[k + 1], at);
        ends[count++] = ends[k + 1];
      } else {
        ends[count] = ends[k];
        values[count++] = std::move(values[k]);
      }
    }
    values.resize(count);
    ends.resize(count);
  }
  return std::move(values[0]);
}

Value select_varying(Elaboration& e, const Environment& in, const Value& array, std::vector<Subscript> subscripts,
                     Location at) {
  for (size_t d = 0; d < subscripts.size(); ++d) {
    if (subscripts[d].varying == nullptr) continue;
    const Expression index = std::exchange(subscripts[d].varying, nullptr);
    const int n = array.dims[d];
    if (n == 0) e.fail(at, "an element of an array without elements");
    if (!subscripts[d].is_safe) assert_range(e, in, index, n, at);
    std::vector<Value> values;
    for (size_t k = 0; k < static_cast<size_t>(n); ++k) {
      subscripts[d].positions = {k};
      values.push_back(select_varying(e, in, array, subscripts, at));
    }
    return choose_by_index(e, in, index, values, at);
  }
  e.charge(1, at);
  return select_positions(array, subscripts);
}

}  // namespace

Value select(Elaboration& e, const Environment& in, const Value& array, const syntax::Expression& x) {
  const size_t given = x.operands.size() - 1;
  if (given > array.dims.size())
    e.fail(x.at, std::to_string(given) + " subscripts of " + shown_type(array) + ", which has " +
                     std::to_string(array.dims.size()) + " dimensions");
  if (array.kind == Kind::function) e.fail(x.at, "a subscript of a function");
  std::vector<Subscript> subscripts;
  bool has_varying = false;
  Environment inside = in;
  inside.indexed = &array;
  size_t count = 1;
  for (size_t d = 0; d < array.dims.size(); ++d) {
    inside.indexed_dimension = static_cast<int>(d);
    static const syntax::Expression all = [] {
      syntax::Expression result;
      result.form = Form::all;
      return result;
    }();
    const syntax::Expression& subscript = d < given ? *x.operands[d + 1] : all;
    subscripts.push_back(evaluate_subscript(e, inside, subscript, array.dims[d]));
    has_varying = has_varying || subscripts.back().varying != nullptr;
    count *= std::max<size_t>(1, subscripts.back().positions.size());
    if (count > static_cast<size_t>(Limits::kMaxElements)) e.fail(x.at, "a slice of too many elements");
  }
  e.charge(static_cast<long>(count), x.at);
  return has_varying ? select_varying(e, in, array, std::move(subscripts), x.at)
                     : select_positions(array, subscripts);
}

Value member_of(const Elaboration& e, const Value& record, const std::string& name, Location at) {
  if (record.kind != Kind::record)
    e.fail(at, "'." + plain(name) + "' of " + shown_type(record) + ", which is no record");
  Value result;
  for (size_t k = 0; k < record.records.size(); ++k) {
    const Value* field = record.records[k].find(name);
    if (field == nullptr) e.fail(at, shown_type(record) + " has no field '" + plain(name) + "'");
    if (k == 0) {
      result = empty_like(*field, record.dims);
      result.dims.insert(result.dims.end(), field->dims.begin(), field->dims.end());
    }
    append_elements(result, *field);
  }
  return result;
}

void check_dims(const Elaboration& e, const std::vector<int>& dims, Location at) {
  double count = 1.0;
  for (const int n : dims) count *= n;
  if (count > static_cast<double>(Limits::kMaxElements))
    e.fail(at, "an array of more than " + std::to_string(Limits::kMaxElements) + " elements; make it smaller");
}

std::vector<int> evaluate_dims(Elaboration& e, const Environment& in,
                               const std::vector<const syntax::Expression*>& dimensions) {
  std::vector<int> result;
  for (const syntax::Expression* x : dimensions) {
    if (x->form == Form::all) {
      result.push_back(-1);
      continue;
    }
    const bool is_enumeration =
        x->form == Form::name && e.definitions.find(x->text, syntax::DefinitionKind::enumeration);
    const int n = is_enumeration ? static_cast<int>(e.definitions.find(x->text)->literals.size())
                                 : evaluate_integer(e, in, *x, "the size of an array");
    if (n < 0) e.fail(x->at, "the size of an array is negative: " + std::to_string(n));
    result.push_back(n);
    if (n > 0) check_dims(e, {n}, x->at);
  }
  if (std::count(result.begin(), result.end(), -1) == 0 && !dimensions.empty())
    check_dims(e, result, dimensions[0]->at);
  return result;
}

}  // namespace sfdae::cli
