// Functions that construct and rearrange arrays.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <utility>

#include "modelica/arithmetic.h"
#include "modelica/built_in.h"

namespace sfdae::cli {

namespace {

using Function = Value (*)(Elaboration&, const Environment&, const Call&);

const Value& numbers(const Elaboration& e, const Call& call, size_t k, size_t dimensions) {
  const Value& value = call.arguments[k].value;
  if (!value.has_scalars() || value.dims.size() != dimensions)
    e.fail(call.arguments[k].at, "an argument of '" + call.name + "' is " + shown_type(value) + ", expected " +
                                     std::to_string(dimensions) + " dimensions");
  return value;
}

Value integer(Elaboration& e, double value, Location at) {
  return scalar_value(Kind::integer, e.pool.number(value, at));
}

Value size(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 1, 2);
  const std::vector<int>& dims = call.arguments[0].value.dims;
  if (call.arguments.size() == 2) {
    const int d = integer_argument(e, call, 1);
    if (d < 1 || d > static_cast<int>(dims.size()))
      e.fail(call.at, "size of dimension " + std::to_string(d) + " of " + shown_type(call.arguments[0].value));
    return integer(e, dims[static_cast<size_t>(d) - 1], call.at);
  }
  Value result;
  result.kind = Kind::integer;
  result.dims = {static_cast<int>(dims.size())};
  for (const int n : dims) result.scalars.push_back(e.pool.number(n, call.at));
  return result;
}

Value ndims(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 1, 1);
  return integer(e, static_cast<double>(call.arguments[0].value.dims.size()), call.at);
}

Value filled(Elaboration& e, const Call& call, const Value& with, size_t first) {
  check_count(e, call, first, 100);
  Value result = empty_like(with, {});
  for (size_t k = first; k < call.arguments.size(); ++k) {
    result.dims.push_back(integer_argument(e, call, k));
    if (result.dims.back() < 0) e.fail(call.arguments[k].at, "a negative size");
    check_dims(e, {result.dims.back()}, call.at);
  }
  if (!with.is_scalar()) e.fail(call.at, "'" + call.name + "' with " + shown_type(with) + "; fill with a scalar");
  check_dims(e, result.dims, call.at);
  e.charge(static_cast<long>(product(result.dims)), call.at);
  for (size_t k = 0; k < product(result.dims); ++k) append_elements(result, with);
  return result;
}

Value fill(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 2, 100);
  return filled(e, call, call.arguments[0].value, 1);
}
Value zeros(Elaboration& e, const Environment&, const Call& call) {
  return filled(e, call, integer(e, 0.0, call.at), 0);
}
Value ones(Elaboration& e, const Environment&, const Call& call) {
  return filled(e, call, integer(e, 1.0, call.at), 0);
}

Value square(Elaboration& e, const Call& call, const std::vector<Expression>& diagonal, Kind kind) {
  Value result;
  result.kind = kind;
  const size_t n = diagonal.size();
  result.dims = {static_cast<int>(n), static_cast<int>(n)};
  check_dims(e, result.dims, call.at);
  e.charge(static_cast<long>(n * n), call.at);
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < n; ++j) result.scalars.push_back(i == j ? diagonal[i] : e.pool.number(0.0, call.at));
  return result;
}

Value identity(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 1, 1);
  const int n = integer_argument(e, call, 0);
  if (n < 0) e.fail(call.at, "a negative size");
  check_dims(e, {n, n}, call.at);
  return square(e, call, std::vector<Expression>(static_cast<size_t>(n), e.pool.number(1.0, call.at)), Kind::integer);
}

Value diagonal(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 1, 1);
  const Value& v = numbers(e, call, 0, 1);
  return square(e, call, v.scalars, v.kind);
}

Value linspace(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 3, 3);
  const Expression first = scalar_argument(e, call, 0, Kind::real), last = scalar_argument(e, call, 1, Kind::real);
  const int n = integer_argument(e, call, 2);
  if (n < 2) e.fail(call.at, "linspace of less than two points");
  check_dims(e, {n}, call.at);
  e.charge(n, call.at);
  Value result;
  result.dims = {n};
  const Expression width = e.pool.make(Operation::subtract, {last, first}, call.at);
  for (int k = 0; k < n; ++k) {  // first + (last - first) k / (n - 1)
    const Expression part = e.pool.make(Operation::multiply, {width, e.pool.number(k)}, call.at);
    const Expression scaled = e.pool.make(Operation::divide, {part, e.pool.number(n - 1)}, call.at);
    result.scalars.push_back(e.pool.make(Operation::add, {first, scaled}, call.at));
  }
  return result;
}

Value transpose(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 1, 1);
  const Value& a = numbers(e, call, 0, 2);
  Value result = empty_like(a, {a.dims[1], a.dims[0]});
  const auto m = static_cast<size_t>(a.dims[0]), n = static_cast<size_t>(a.dims[1]);
  for (size_t j = 0; j < n; ++j)
    for (size_t i = 0; i < m; ++i) result.scalars.push_back(a.scalars[i * n + j]);
  return result;
}

Value sum(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 1, 1);
  const Value& a = call.arguments[0].value;
  if (!a.is_numeric()) e.fail(call.at, "'sum' of " + shown_type(a));
  return scalar_value(a.kind, sum_of(e, a.scalars, call.at));
}

Value product_of(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 1, 1);
  const Value& a = call.arguments[0].value;
  if (!a.is_numeric()) e.fail(call.at, "'product' of " + shown_type(a));
  Expression result = e.pool.number(1.0, call.at);
  for (const Expression& x : a.scalars) result = operate(e, Operation::multiply, {result, x}, {call.at});
  return scalar_value(a.kind, result);
}

Value scalar(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 1, 1);
  if (call.arguments[0].value.size() != 1) e.fail(call.at, "'scalar' of " + shown_type(call.arguments[0].value));
  return element(call.arguments[0].value, 0);
}

Value vector(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 1, 1);
  Value result = call.arguments[0].value;
  result.dims = {static_cast<int>(result.size())};
  return result;
}

Value matrix(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 1, 1);
  Value result = call.arguments[0].value;
  if (result.dims.size() > 2) e.fail(call.at, "'matrix' of " + shown_type(result));
  result.dims.resize(2, 1);
  return result;
}

Value promote(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 2, 2);
  Value result = call.arguments[0].value;
  const int n = integer_argument(e, call, 1);
  if (n < static_cast<int>(result.dims.size()) || n > 100) e.fail(call.at, "'promote' to fewer dimensions");
  result.dims.resize(static_cast<size_t>(n), 1);
  return result;
}

Value outer_product(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 2, 2);
  Value a = numbers(e, call, 0, 1), b = numbers(e, call, 1, 1);
  a.dims.push_back(1);
  b.dims.insert(b.dims.begin(), 1);
  return multiply(e, a, b, {call.at});
}

Value symmetric(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 1, 1);
  const Value& a = numbers(e, call, 0, 2);
  if (a.dims[0] != a.dims[1]) e.fail(call.at, "'symmetric' of " + shown_type(a));
  Value result = a;
  const auto n = static_cast<size_t>(a.dims[0]);
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < i; ++j) result.scalars[i * n + j] = a.scalars[j * n + i];
  return result;
}

Value cross(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 2, 2);
  const Value &a = numbers(e, call, 0, 1), &b = numbers(e, call, 1, 1);
  if (a.dims[0] != 3 || b.dims[0] != 3) e.fail(call.at, "'cross' of vectors that do not have 3 elements");
  Value result;
  result.dims = {3};
  const OperationPlace place{call.at};
  for (size_t k = 0; k < 3; ++k) {
    const size_t i = (k + 1) % 3, j = (k + 2) % 3;
    result.scalars.push_back(operate(e, Operation::subtract,
                                     {operate(e, Operation::multiply, {a.scalars[i], b.scalars[j]}, place),
                                      operate(e, Operation::multiply, {a.scalars[j], b.scalars[i]}, place)},
                                     place));
  }
  return result;
}

Value skew(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 1, 1);
  const Value& a = numbers(e, call, 0, 1);
  if (a.dims[0] != 3) e.fail(call.at, "'skew' of a vector that does not have 3 elements");
  const auto minus = [&](size_t k) { return operate(e, Operation::negate, {a.scalars[k]}, {call.at}); };
  const Expression zero = e.pool.number(0.0, call.at);
  Value result;
  result.dims = {3, 3};
  result.scalars = {zero, minus(2), a.scalars[1], a.scalars[2], zero, minus(0), minus(1), a.scalars[0], zero};
  return result;
}

// cat(1, A, B, ...): concatenation along a dimension.
Value cat(Elaboration& e, const Environment&, const Call& call) {
  check_count(e, call, 2, 10000);
  const int d = integer_argument(e, call, 0);
  std::vector<const Value*> parts;
  for (size_t k = 1; k < call.arguments.size(); ++k) parts.push_back(&call.arguments[k].value);
  std::vector<int> dims = parts[0]->dims;
  if (d < 1 || d > static_cast<int>(dims.size()))
    e.fail(call.at, "'cat' along dimension " + std::to_string(d) + " of " + shown_type(*parts[0]));
  const auto along = static_cast<size_t>(d) - 1;
  dims[along] = 0;
  Value result = empty_like(*parts[0], {});
  for (const Value* part : parts) {
    std::vector<int> other = part->dims;
    if (other.size() == dims.size()) dims[along] += other[along], other[along] = dims[along];
    if (other != dims || part->kind == Kind::function) e.fail(call.at, "parts of 'cat' differ in size");
    if (part->is_numeric() && result.is_numeric() && part->kind == Kind::real) result.kind = Kind::real;
    else if (part->kind != result.kind && !(part->is_numeric() && result.is_numeric()))
      e.fail(call.at, "parts of 'cat' differ in type");
  }
  check_dims(e, dims, call.at);
  result.dims = dims;
  const size_t outer = product({dims.begin(), dims.begin() + d - 1});
  const size_t inner = product({dims.begin() + d, dims.end()});
  e.charge(static_cast<long>(product(dims)), call.at);
  for (size_t i = 0; i < outer; ++i)
    for (const Value* part : parts) {
      const size_t n = static_cast<size_t>(part->dims[along]) * inner;
      for (size_t k = 0; k < n; ++k) append_elements(result, element(*part, i * n + k));
    }
  return result;
}

// array(a, b, c) is {a, b, c}.
Value array(Elaboration& e, const Environment&, const Call& call) {
  std::vector<Value> elements;
  for (const Argument& one : call.arguments) elements.push_back(one.value);
  return array_of(e, elements, call.at);
}

const std::map<std::string, Function>& functions() {
  static const std::map<std::string, Function> result = {
      {"size", size},           {"ndims", ndims},       {"fill", fill},          {"zeros", zeros},
      {"ones", ones},           {"identity", identity}, {"diagonal", diagonal},  {"linspace", linspace},
      {"transpose", transpose}, {"sum", sum},           {"product", product_of}, {"scalar", scalar},
      {"vector", vector},       {"matrix", matrix},     {"promote", promote},    {"outerProduct", outer_product},
      {"symmetric", symmetric}, {"cross", cross},       {"skew", skew},          {"cat", cat},
      {"array", array},         {"constsize", size}};
  return result;
}

}  // namespace

std::optional<Value> call_array_function(Elaboration& e, const Environment& in, const Call& call) {
  const auto found = functions().find(call.name);
  if (found == functions().end()) return std::nullopt;
  return found->second(e, in, call);
}

}  // namespace sfdae::cli
