// Recording of equations.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/recorder.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <utility>

#include "expression/kernel.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Returns whether dividing by the value equals multiplying by its inverse.
bool has_exact_inverse(double value) {
  int exponent = 0;
  return std::fabs(std::frexp(value, &exponent)) == 0.5 && exponent > -1000 && exponent < 1000;
}

// Reserves memory for one more entry, so that adding it cannot fail.
template <class Entry>
void make_room(std::vector<Entry>& entries) {
  if (entries.size() == entries.capacity()) entries.reserve(2 * entries.size() + 16);
}

// Seed: the golden ratio; multiplier: one of those of MurmurHash3's finalizer, which spread bits well.
std::size_t hash_of(const Node& node) {
  std::uint64_t hash = 0x9e3779b97f4a7c15u;
  for (int part : {static_cast<int>(node.operation), node.a, node.b, node.c})
    hash = (hash ^ static_cast<std::uint32_t>(part)) * 0xff51afd7ed558ccdu;
  return static_cast<std::size_t>(hash ^ (hash >> 32));
}

bool is_equal(const Node& one, const Node& other) {
  return one.operation == other.operation && one.a == other.a && one.b == other.b && one.c == other.c;
}

}  // namespace

std::optional<double> Recorder::number(int i) const {
  if (!is(i, Operation::constant)) return std::nullopt;
  return parts_.constants[index(node(i).a)];
}

// Place of the node in the table, or the free place for it.
std::size_t Recorder::place_of(const Node& node) const {
  const std::size_t mask = known_.size() - 1;
  std::size_t place = hash_of(node) & mask;
  while (known_[place] >= 0 && !is_equal(parts_.nodes[index(known_[place])], node)) place = (place + 1) & mask;
  return place;
}

void Recorder::make_room_for_places() {
  constexpr std::size_t least = 64;
  if (2 * (parts_.nodes.size() + 1) <= known_.size()) return;
  std::vector<int> larger(std::max(least, 2 * known_.size()), -1);
  known_.swap(larger);
  for (int i = 0; i < num_nodes(); ++i) known_[place_of(node(i))] = i;
}

// If memory runs out, nothing is added, and recording can continue.
int Recorder::intern(const Node& node) {
  make_room(dependence_);
  make_room(parts_.nodes);
  make_room_for_places();
  int& known = known_[place_of(node)];
  if (known < 0) {
    known = num_nodes();
    dependence_.push_back(dependence_of(node, {node, parts_.calls}, dependence_.data()));
    parts_.nodes.push_back(node);
  }
  return known;
}

int Recorder::constant(double value) {
  if (value == 0.0) value = 0.0;  // -0 is 0
  make_room(parts_.constants);
  const auto [place, is_new] =
      constants_.try_emplace(std::bit_cast<std::uint64_t>(value), static_cast<int>(parts_.constants.size()));
  if (is_new) parts_.constants.push_back(value);
  return intern({Operation::constant, place->second});
}

int Recorder::parameter(const std::string& name, double value) {
  for (std::size_t i = 0; i < parts_.parameters.size(); ++i)
    if (parts_.parameters[i].name == name) return intern({Operation::parameter, static_cast<int>(i)});
  parts_.parameters.push_back({name, value});
  return intern({Operation::parameter, static_cast<int>(parts_.parameters.size()) - 1});
}

int Recorder::apply(Operation operation, int a, int b, int c) {
  const int operands[] = {a, b, c};
  double values[3] = {};
  bool all_numbers = true;
  for (int k = 0; k < num_operands(operation); ++k) {
    assert(operands[k] >= 0 && operands[k] < num_nodes());
    if (const auto value = number(operands[k])) values[k] = *value;
    else all_numbers = false;
  }
  // Undefined results stay in the graph, so that evaluation can report them.
  if (all_numbers)
    if (const auto value = evaluate(operation, values[0], values[1], values[2])) return constant(*value);
  switch (operation) {
    case Operation::negate: return negate(a);
    case Operation::add: return add(a, b);
    case Operation::subtract: return subtract(a, b);
    case Operation::multiply: return multiply(a, b);
    case Operation::divide: return divide(a, b);
    case Operation::power: return power(a, b);
    case Operation::choose: return choose(a, b, c);
    default: return intern({operation, a, b, c});
  }
}

int Recorder::negate(int a) {
  if (is(a, Operation::negate)) return node(a).a;
  if (is(a, Operation::subtract)) return subtract(node(a).b, node(a).a);
  if (is(a, Operation::multiply)) {
    const auto [operation, x, y, unused] = node(a);
    if (const auto factor = number(x)) return multiply(constant(-*factor), y);
    if (const auto factor = number(y)) return multiply(constant(-*factor), x);
  }
  return intern({Operation::negate, a});
}

int Recorder::add(int a, int b) {
  if (is(a, 0.0)) return b;
  if (is(b, 0.0)) return a;
  if (is(b, Operation::negate)) return subtract(a, node(b).a);
  if (is(a, Operation::negate)) return subtract(b, node(a).a);
  if (a > b) std::swap(a, b);
  return intern({Operation::add, a, b});
}

int Recorder::subtract(int a, int b) {
  if (a == b) return constant(0.0);
  if (is(b, 0.0)) return a;
  if (is(a, 0.0)) return negate(b);
  if (is(b, Operation::negate)) return add(a, node(b).a);
  return intern({Operation::subtract, a, b});
}

// a - b for a condition. A choice minus one of its branches is exactly 0 in that branch: max(s, min(s, c)) does not
// depend on rounding errors where it is s.
int Recorder::compared(int a, int b) {
  const auto may_be = [this](int choice, int other) {
    return is(choice, Operation::choose) && (node(choice).b == other || node(choice).c == other);
  };
  if (may_be(a, b)) {
    const Node choice = node(a);
    return apply(Operation::choose, choice.a, compared(choice.b, b), compared(choice.c, b));
  }
  if (may_be(b, a)) {
    const Node choice = node(b);
    return apply(Operation::choose, choice.a, compared(a, choice.b), compared(a, choice.c));
  }
  return apply(Operation::subtract, a, b);
}

int Recorder::multiply(int a, int b) {
  if (is(a, 0.0) || is(b, 0.0)) return constant(0.0);
  if (is(a, 1.0)) return b;
  if (is(b, 1.0)) return a;
  if (is(a, -1.0)) return negate(b);
  if (is(b, -1.0)) return negate(a);
  if (is(a, Operation::negate) && number(b)) return multiply(node(a).a, constant(-*number(b)));
  if (is(b, Operation::negate) && number(a)) return multiply(node(b).a, constant(-*number(a)));
  // Signs go outward, so that a b and (-a) b share the product.
  if (is(a, Operation::negate)) return apply(Operation::negate, apply(Operation::multiply, node(a).a, b));
  if (is(b, Operation::negate)) return apply(Operation::negate, apply(Operation::multiply, a, node(b).a));
  if (a > b) std::swap(a, b);
  return intern({Operation::multiply, a, b});
}

int Recorder::divide(int a, int b) {
  const auto divisor = number(b);
  if (divisor && *divisor != 0.0) {
    if (is(a, 0.0)) return a;
    if (*divisor == 1.0) return a;
    if (has_exact_inverse(*divisor)) return multiply(a, constant(1.0 / *divisor));
  }
  if (is(a, Operation::negate)) return apply(Operation::negate, apply(Operation::divide, node(a).a, b));
  return intern({Operation::divide, a, b});
}

int Recorder::power(int a, int b) {
  // Products are exact where powers by logarithms are not, and are smooth at 0
  // (docs/design/derivative_array.md).
  constexpr double highest_product = 64.0;
  if (const auto exponent = number(b)) {
    if (*exponent == 0.5) return apply(Operation::sqrt, a);
    if (*exponent == std::floor(*exponent) && std::fabs(*exponent) <= highest_product)
      return integer_power(a, static_cast<int>(*exponent));
  }
  if (!varies_in_time(dependence_[index(b)])) return intern({Operation::power, a, b});
  return apply(Operation::exp, apply(Operation::multiply, b, apply(Operation::log_of_base, a)));
}

int Recorder::integer_power(int a, int exponent) {
  if (exponent == 0) return constant(1.0);
  if (exponent < 0) return apply(Operation::divide, constant(1.0), integer_power(a, -exponent));
  if (exponent == 1) return a;
  const int half = integer_power(a, exponent / 2);
  const int square = apply(Operation::multiply, half, half);
  return exponent % 2 == 0 ? square : apply(Operation::multiply, square, a);
}

int Recorder::call(const FunctionCall& call) {
  const auto known = std::find(parts_.calls.begin(), parts_.calls.end(), call);
  const auto place = known - parts_.calls.begin();
  if (known == parts_.calls.end()) parts_.calls.push_back(call);
  return intern({Operation::function, static_cast<int>(place)});
}

int Recorder::choose(int c, int a, int b) {
  if (a == b) return a;
  if (const auto condition = number(c)) return *condition > 0.0 ? a : b;
  if (is(c, Operation::choose)) {  // between true and false, as comparisons are
    const auto first = number(node(c).b), second = number(node(c).c);
    if (first && second && (*first > 0.0) != (*second > 0.0))
      return *first > 0.0 ? choose(node(c).a, a, b) : choose(node(c).a, b, a);
  }
  return intern({Operation::choose, c, a, b});
}

std::shared_ptr<const Record> Recorder::finish(std::vector<int> residuals, EquationNames names) {
  parts_.equation_names = std::move(names);
  parts_.residuals = std::move(residuals);
  const int n = parts_.num_unknowns;
  auto record = std::make_shared<const Record>(std::move(parts_));
  *this = Recorder(n);
  return record;
}

std::shared_ptr<const Record> Recorder::excerpt(int num_unknowns, std::vector<int> residuals,
                                                std::vector<std::string> names) const {
  Record::Parts parts = parts_;
  parts.num_unknowns = num_unknowns;
  parts.residuals = std::move(residuals);
  parts.formulas = std::move(names);
  return std::make_shared<const Record>(std::move(parts));
}

}  // namespace sfdae::core
