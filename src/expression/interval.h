// Intervals: all values of an expression over an interval of its arguments, rounding errors included. Results are
// rounded outward by one unit in the last place. Results of elementary functions are rounded by two units, as libraries
// compute them to less than one. Sums that are exact stay exact. Results that underflow count as 0.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace sfdae::core {

struct Interval {
  double low = 0.0, high = 0.0;

  static Interval entire() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return {-infinity, infinity};
  }
  static Interval of(double number) { return {number, number}; }
  bool is_zero() const { return low == 0.0 && high == 0.0; }
  bool contains(double x) const { return low <= x && x <= high; }
  // The largest absolute value.
  double magnitude() const { return std::max(std::fabs(low), std::fabs(high)); }
};

// Moves x by a unit in the last place or a little more; infinite numbers and 0 stay unchanged.
inline double below(double x) {
  const double less = x - std::fabs(x) * std::numeric_limits<double>::epsilon();
  return std::isnan(less) ? x : less;
}
inline double above(double x) { return -below(-x); }
inline Interval outward(Interval a) { return {below(a.low), above(a.high)}; }

// [Knu98] D. E. Knuth: The Art of Computer Programming, vol. 2. Addison-Wesley, 1998. Section 4.2.2, theorem B.
inline bool is_exact_sum(double a, double b, double sum) {
  const double part = sum - a;
  return (a - (sum - part)) + (b - part) == 0.0;
}
inline double sum_below(double a, double b) {
  const double sum = a + b;
  return is_exact_sum(a, b, sum) ? sum : below(sum);
}
inline double sum_above(double a, double b) { return -sum_below(-a, -b); }

// The entire line if one of them is not a number.
inline Interval between(double a, double b) {
  if (a <= b) return {a, b};
  return b < a ? Interval{b, a} : Interval::entire();
}
inline Interval hull(Interval a, Interval b) { return {std::min(a.low, b.low), std::max(a.high, b.high)}; }
inline Interval limited(Interval a, double low, double high) {
  return between(std::clamp(a.low, low, high), std::clamp(a.high, low, high));
}

inline Interval operator-(Interval a) { return {-a.high, -a.low}; }
inline Interval operator+(Interval a, Interval b) {
  return between(sum_below(a.low, b.low), sum_above(a.high, b.high));
}
inline Interval operator-(Interval a, Interval b) { return a + -b; }

inline Interval operator*(Interval a, Interval b) {
  if (a.is_zero() || b.is_zero()) return {};
  const auto product = [](double x, double y) { return x == 0.0 || y == 0.0 ? 0.0 : x * y; };
  const double p = product(a.low, b.low), q = product(a.low, b.high), r = product(a.high, b.low),
               s = product(a.high, b.high);
  return outward({std::min(std::min(p, q), std::min(r, s)), std::max(std::max(p, q), std::max(r, s))});
}
inline Interval operator*(double factor, Interval a) { return Interval::of(factor) * a; }

inline Interval square(Interval a) {
  const double p = a.low * a.low, q = a.high * a.high;
  return a.contains(0.0) ? Interval{0.0, above(std::max(p, q))} : outward(between(p, q));
}

inline Interval reciprocal(Interval a) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (a.is_zero() || (a.low < 0.0 && a.high > 0.0)) return Interval::entire();
  return outward({a.high == 0.0 ? -infinity : 1.0 / a.high, a.low == 0.0 ? infinity : 1.0 / a.low});
}
inline Interval operator/(Interval a, Interval b) { return a * reciprocal(b); }

// The values of a monotone function that a library computes.
template <class Function>
Interval monotone(Function function, Interval a) {
  return outward(outward(between(function(a.low), function(a.high))));
}

inline Interval exp(Interval a) {
  return monotone([](double x) { return std::exp(x); }, a);
}
// Negative numbers count as 0, as for sqrt and for powers that are not whole.
inline Interval log(Interval a) {
  return monotone([](double x) { return std::log(std::max(x, 0.0)); }, a);
}
inline Interval sqrt(Interval a) {
  return monotone([](double x) { return std::sqrt(std::max(x, 0.0)); }, a);
}

inline Interval power(Interval a, double exponent) {
  if (exponent == 0.0) return Interval::of(1.0);
  if (exponent != std::floor(exponent))
    return monotone([exponent](double x) { return std::pow(std::max(x, 0.0), exponent); }, a);
  if (exponent < 0.0) return reciprocal(power(a, -exponent));
  const double p = std::pow(a.low, exponent), q = std::pow(a.high, exponent);
  const bool is_even = std::fmod(exponent, 2.0) == 0.0;
  return outward(outward(is_even && a.contains(0.0) ? Interval{0.0, std::max(p, q)} : between(p, q)));
}

// True if first + k period is in the interval for some integer k, or outside of it by a few rounding errors.
inline bool contains_any(Interval a, double first, double period) {
  const double few = 4.0 * std::numeric_limits<double>::epsilon() * (1.0 + a.magnitude() / period);
  return first + std::ceil((a.low - first) / period - few) * period <= a.high + few * period;
}

inline Interval sin(Interval a) {
  constexpr double period = 2.0 * std::numbers::pi;
  if (!(a.high - a.low < period)) return {-1.0, 1.0};
  Interval result = outward(outward(between(std::sin(a.low), std::sin(a.high))));
  if (contains_any(a, 0.25 * period, period)) result.high = 1.0;
  if (contains_any(a, -0.25 * period, period)) result.low = -1.0;
  return limited(result, -1.0, 1.0);
}
inline Interval cos(Interval a) {
  constexpr double period = 2.0 * std::numbers::pi;
  if (!(a.high - a.low < period)) return {-1.0, 1.0};
  Interval result = outward(outward(between(std::cos(a.low), std::cos(a.high))));
  if (contains_any(a, 0.0, period)) result.high = 1.0;
  if (contains_any(a, 0.5 * period, period)) result.low = -1.0;
  return limited(result, -1.0, 1.0);
}
inline Interval tan(Interval a) {
  constexpr double period = std::numbers::pi;
  if (!(a.high - a.low < period) || contains_any(a, 0.5 * period, period)) return Interval::entire();
  return monotone([](double x) { return std::tan(x); }, a);
}
inline Interval cosh(Interval a) {
  const Interval ends = outward(outward(between(std::cosh(a.low), std::cosh(a.high))));
  return a.contains(0.0) ? Interval{1.0, ends.high} : ends;
}

}  // namespace sfdae::core
