// Enclosures of values that depend on t alone.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/time_enclosures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "expression/instruction_operands.h"
#include "expression/point_function.h"

namespace sfdae::core {

namespace {

const TimeSeries unknown_series{Interval::entire(), Interval::entire(), Interval::entire()};

TimeSeries constant(Interval value) { return {value, {}, {}}; }

// f(a), from enclosures of f, f' and f'' / 2 over the values of a.
TimeSeries composed(const TimeSeries& a, Interval f, Interval slope, Interval bend) {
  return {f, slope * a.slope, slope * a.bend + bend * square(a.slope)};
}

TimeSeries operator-(const TimeSeries& a) { return {-a.value, -a.slope, -a.bend}; }
TimeSeries operator+(const TimeSeries& a, const TimeSeries& b) {
  return {a.value + b.value, a.slope + b.slope, a.bend + b.bend};
}
TimeSeries operator*(const TimeSeries& a, const TimeSeries& b) {
  return {a.value * b.value, a.value * b.slope + a.slope * b.value,
          a.value * b.bend + a.slope * b.slope + a.bend * b.value};
}
TimeSeries squared(const TimeSeries& a) { return composed(a, square(a.value), 2.0 * a.value, Interval::of(1.0)); }
TimeSeries inverse(const TimeSeries& a) {
  const Interval v = reciprocal(a.value), v2 = square(v);
  return composed(a, v, -v2, v2 * v);
}

TimeSeries sine(const TimeSeries& a) {
  const Interval v = sin(a.value);
  return composed(a, v, cos(a.value), -0.5 * v);
}
TimeSeries cosine(const TimeSeries& a) {
  const Interval v = cos(a.value);
  return composed(a, v, -sin(a.value), -0.5 * v);
}
TimeSeries hyperbolic_sine(const TimeSeries& a) {
  const Interval v = monotone([](double x) { return std::sinh(x); }, a.value);
  return composed(a, v, cosh(a.value), 0.5 * v);
}
TimeSeries hyperbolic_cosine(const TimeSeries& a) {
  const Interval v = cosh(a.value);
  return composed(a, v, monotone([](double x) { return std::sinh(x); }, a.value), 0.5 * v);
}
TimeSeries logarithm(const TimeSeries& a) {
  const Interval r = reciprocal(Interval{std::max(a.value.low, 0.0), std::max(a.value.high, 0.0)});
  return composed(a, log(a.value), r, -0.5 * square(r));
}
TimeSeries root(const TimeSeries& a) {
  const Interval v = sqrt(a.value), slope = 0.5 * reciprocal(v);
  return composed(a, v, slope, -0.25 * slope * square(reciprocal(v)));
}
// sign 1: tan; -1: tanh.
TimeSeries tangent(const TimeSeries& a, double sign) {
  const Interval v = sign > 0.0 ? tan(a.value) : monotone([](double x) { return std::tanh(x); }, a.value);
  const Interval slope = Interval::of(1.0) + sign * square(v);
  return composed(a, v, slope, sign * v * slope);
}
TimeSeries arc_sine(const TimeSeries& a) {
  const Interval x = limited(a.value, -1.0, 1.0), slope = reciprocal(sqrt(Interval::of(1.0) - square(x)));
  return composed(a, monotone([](double y) { return std::asin(y); }, x), slope, 0.5 * x * slope * square(slope));
}
TimeSeries arc_tangent(const TimeSeries& a) {
  const Interval slope = reciprocal(Interval::of(1.0) + square(a.value));
  return composed(a, monotone([](double x) { return std::atan(x); }, a.value), slope, -a.value * square(slope));
}
// The result is unbounded if it may cross its cut.
TimeSeries arc_tangent(const TimeSeries& y, const TimeSeries& x) {
  if (!(x.value.low > 0.0))
    return {between(-std::numbers::pi, std::numbers::pi), Interval::entire(), Interval::entire()};
  const Interval r = reciprocal(square(x.value) + square(y.value));
  const Interval slope = x.value * y.slope - y.value * x.slope;
  return {monotone([](double z) { return std::atan(z); }, y.value / x.value), slope * r,
          (x.value * y.bend - y.value * x.bend) * r - slope * (x.value * x.slope + y.value * y.slope) * square(r)};
}

TimeSeries rounded_down(const TimeSeries& a) {
  const Interval v = between(std::floor(a.value.low), std::floor(a.value.high));
  return v.low == v.high ? constant(v) : TimeSeries{v, Interval::entire(), Interval::entire()};
}
TimeSeries remainder(const TimeSeries& a, const TimeSeries& b) {
  const TimeSeries quotient = rounded_down(a * inverse(b));
  if (quotient.slope.is_zero()) return a + -(quotient * b);
  return {hull({}, b.value), Interval::entire(), Interval::entire()};
}
TimeSeries choice(const TimeSeries& condition, const TimeSeries& b, const TimeSeries& c) {
  if (condition.value.low > 0.0) return b;
  if (condition.value.high <= 0.0) return c;
  return {hull(b.value, c.value), Interval::entire(), Interval::entire()};
}

// Between its breakpoints the function is a polynomial of degree `jumping_order()`. Encloses its derivative of an order
// on middle +- radius.
Interval values_of_piece(const PointFunction& table, int order, double middle, double radius) {
  // A derivative is a sum of products of at most so many roundings. (Measured: 3 in tests of splines of degree 5.)
  constexpr double roundings = 16.0 * std::numeric_limits<double>::epsilon();
  Interval sum;
  double power = 1.0;
  for (int k = order; k <= table.jumping_order(); ++k) {
    double derivative = 0.0;
    if (table.derivatives(k, &middle, &derivative) != 0) return Interval::entire();
    const double size = std::fabs(derivative * power), rounding = roundings * size;
    sum = k == order ? Interval{derivative - rounding, derivative + rounding}
                     : Interval{sum.low - size - rounding, sum.high + size + rounding};
    power *= radius / (k - order + 1);
  }
  return sum;
}

// Enclosures of the derivative of order `order` of a table, of its slope and of half its second derivative.
TimeSeries values_of_table(const PointFunction& table, int order, Interval x) {
  const std::vector<double>& all = table.breakpoints();
  TimeSeries result;
  double start = std::max(x.low, all.front());
  const double end = std::min(x.high, all.back());
  if (!(start <= end)) return unknown_series;
  const auto first = std::upper_bound(all.begin(), all.end(), start);
  bool has_kink = false;
  for (auto next = first;; ++next) {
    const double stop = next != all.end() ? std::min(*next, end) : end, middle = 0.5 * (start + stop);
    const auto values = [&](int k) { return values_of_piece(table, order + k, middle, 0.5 * (stop - start)); };
    const TimeSeries piece{values(0), values(1), 0.5 * values(2)};
    if (next == first) result = piece;
    else result = {hull(result.value, piece.value), hull(result.slope, piece.slope), hull(result.bend, piece.bend)};
    has_kink = has_kink || next != first;
    if (!(stop < end)) break;
    start = stop;
  }
  if (has_kink && order + 1 >= table.jumping_order()) result.bend = Interval::entire();
  if (has_kink && order >= table.jumping_order()) result.slope = Interval::entire();
  double unused = 0.0;
  const bool is_defined =
      table.derivatives(order, &x.low, &unused) == 0 && table.derivatives(order, &x.high, &unused) == 0;
  return is_defined ? result : unknown_series;
}

// Instructions that slots depend on.
std::vector<Instruction> instructions_for(const Tape& tape, const std::vector<int>& slots) {
  std::vector<Instruction> kept;
  std::vector<char> is_needed(index(tape.num_slots), 0);
  for (const int slot : slots) is_needed[index(slot)] = 1;
  const std::vector<Instruction> all = tape.of_time.all();
  for (auto instruction = all.rbegin(); instruction != all.rend(); ++instruction) {
    bool has_needed = false;
    for_results(*instruction, [&](int slot) { has_needed = has_needed || is_needed[index(slot)] != 0; });
    if (!has_needed) continue;
    for_operands(*instruction, [&](int slot) { is_needed[index(slot)] = 1; });
    kept.push_back(*instruction);
  }
  std::reverse(kept.begin(), kept.end());
  return kept;
}

}  // namespace

TimeEnclosures::TimeEnclosures(const Tape& tape, const std::vector<int>& slots)
    : instructions_(instructions_for(tape, slots)) {
  std::vector<char> is_used(index(tape.num_slots), 0), is_result(is_used);
  for (const int slot : slots) is_used[index(slot)] = 1;
  for (Instruction& instruction : instructions_) {
    for_operands(instruction, [&](int slot) { is_used[index(slot)] = 1; });
    for_results(instruction, [&](int slot) { is_used[index(slot)] = is_result[index(slot)] = 1; });
  }
  is_used[index(tape.time)] = is_result[index(tape.time)] = 1;
  std::vector<int> place(index(tape.num_slots), 0);
  int count = 0;
  for (int slot = 0; slot < tape.num_slots; ++slot) {
    if (is_used[index(slot)] == 0) continue;
    if (is_result[index(slot)] == 0) numbers_.push_back({count, slot});
    place[index(slot)] = count++;
  }
  series_.resize(index(count));
  at_middle_.resize(index(count));
  is_enclosed_.assign(index(count), 1);
  time_ = place[index(tape.time)];
  for (const int slot : slots) wanted_.push_back(place[index(slot)]);
  for (Instruction& instruction : instructions_) {
    const bool is_function = instruction.code == Code::function;
    char is_enclosed = is_function && instruction.call->function->breakpoints().empty() ? 0 : 1;
    for_operands(instruction, [&](int slot) {
      if (is_enclosed_[index(place[index(slot)])] == 0) is_enclosed = 0;
    });
    for_results(instruction, [&](int& slot) {
      slot = place[index(slot)];
      is_enclosed_[index(slot)] = is_enclosed;
    });
    const int arguments = instruction.b - instruction.a;
    for (int* slot : {&instruction.a, &instruction.b, &instruction.c})
      if (*slot >= 0 && *slot < tape.num_slots) *slot = place[index(*slot)];
    if (is_function) instruction.b = instruction.a + arguments;
  }
}

void TimeEnclosures::enclose(const double* numbers, Interval t) {
  for (std::vector<TimeSeries>* series : {&series_, &at_middle_})
    for (const Number& number : numbers_)
      (*series)[index(number.place)] = constant(Interval::of(numbers[number.slot]));
  has_middle_ = false;
  execute(t);
}

// True if the value of the operand leaves open which branch, or which whole number, holds.
bool TimeEnclosures::is_open(const Instruction& instruction) const {
  const Interval& a = series_[index(instruction.a)].value;
  if (instruction.code == Code::choose) return a.low <= 0.0 && a.high > 0.0;
  return instruction.code == Code::floor && std::floor(a.low) != std::floor(a.high);
}

// u(t) = u(middle) + u'(some time) (t - middle) [Moo66].
void TimeEnclosures::use_mean_value(int place, Interval t) {
  const double middle = t.low + 0.5 * (t.high - t.low);
  if (!has_middle_) {
    has_middle_ = true;
    series_.swap(at_middle_);
    execute(Interval::of(middle));
    series_.swap(at_middle_);
  }
  TimeSeries& u = series_[index(place)];
  const Interval by_slope = at_middle_[index(place)].value + u.slope * (t - Interval::of(middle));
  const Interval both{std::max(u.value.low, by_slope.low), std::min(u.value.high, by_slope.high)};
  if (both.low <= both.high) u.value = both;
}

void TimeEnclosures::execute(Interval t) {
  series_[index(time_)] = {t, Interval::of(1.0), {}};
  for (const Instruction& instruction : instructions_) {
    if (is_open(instruction) && t.low < t.high) use_mean_value(instruction.a, t);
    series_[index(instruction.v)] = value_of(instruction);
    if (!has_two_results(instruction)) continue;
    const TimeSeries& a = series_[index(instruction.a)];
    series_[index(instruction.p)] = instruction.code == Code::sin_cos ? cosine(a) : hyperbolic_cosine(a);
  }
}

TimeSeries TimeEnclosures::value_of(const Instruction& instruction) const {
  if (instruction.code == Code::function) return value_of_function(instruction);  // b is no place
  const TimeSeries& a = series_[index(instruction.a)];
  const TimeSeries& b = series_[index(std::max(instruction.b, 0))];
  switch (instruction.code) {
    case Code::negate: return -a;
    case Code::add: return a + b;
    case Code::subtract: return a + -b;
    case Code::multiply: return instruction.a == instruction.b ? squared(a) : a * b;
    case Code::scale: return {a.value * b.value, a.slope * b.value, a.bend * b.value};
    case Code::divide:
    case Code::divide_by_number: return a * inverse(b);
    case Code::power: return value_of_power(instruction);
    case Code::sqrt: return root(a);
    case Code::exp: {
      const Interval v = exp(a.value);
      return composed(a, v, v, 0.5 * v);
    }
    case Code::log: return logarithm(a);
    case Code::log10: return logarithm(a) * constant(Interval::of(1.0 / std::numbers::ln10));
    case Code::sin_cos: return sine(a);
    case Code::sinh_cosh: return hyperbolic_sine(a);
    case Code::tan: return tangent(a, 1.0);
    case Code::tanh: return tangent(a, -1.0);
    case Code::asin: return arc_sine(a);
    case Code::acos: return constant(Interval::of(0.5 * std::numbers::pi)) + -arc_sine(a);
    case Code::atan: return arc_tangent(a);
    case Code::atan2: return arc_tangent(a, b);
    case Code::floor: return rounded_down(a);
    case Code::modulo: return remainder(a, b);
    case Code::copy: return a;
    case Code::choose: return choice(a, b, series_[index(instruction.c)]);
    case Code::function: break;
  }
  return unknown_series;
}

TimeSeries TimeEnclosures::value_of_power(const Instruction& instruction) const {
  const TimeSeries& a = series_[index(instruction.a)];
  const double exponent = series_[index(instruction.b)].value.low;
  return composed(a, power(a.value, exponent), exponent * power(a.value, exponent - 1.0),
                  0.5 * exponent * (exponent - 1.0) * power(a.value, exponent - 2.0));
}

TimeSeries TimeEnclosures::value_of_function(const Instruction& instruction) const {
  const FunctionCall& call = *instruction.call;
  if (call.function->breakpoints().empty()) return unknown_series;
  const TimeSeries& a = series_[index(instruction.a)];
  const TimeSeries f = values_of_table(*call.function, static_cast<int>(call.by.size()), a.value);
  return composed(a, f.value, f.slope, f.bend);
}

}  // namespace sfdae::core
