// Truncated power series a_0 + a_1 s + ... + a_K s^K, K <= highest_order.
//
// [GW08] A. Griewank, A. Walther: Evaluating Derivatives, 2nd ed. SIAM, 2008. Section 13.2.
//
// Results never overlap arguments. K is an int, or a Fixed one for loops that the compiler unrolls. Values that
// do not exist become NaN without an operation that raises a floating-point exception, and pass as such: comparisons
// are those that accept NaN quietly.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>

namespace sfdae::core::series {

// Highest order of values: max_derivative_order + 1, as x' of a jet has one order less than x.
constexpr int highest_order = 62;

// An order that the compiler knows.
template <int value>
struct Fixed {
  constexpr operator int() const { return value; }
};

using Numbers = const double*;
using Result = double* __restrict;

inline bool is_positive(double value) { return std::isgreater(value, 0.0); }
inline bool is_negative(double value) { return std::isless(value, 0.0); }

template <class Order>
inline void poison(Result v, int from, Order K) {
  for (int k = from; k <= K; ++k) v[k] = std::numeric_limits<double>::quiet_NaN();
}

template <class Order>
inline void copy(Numbers a, Result v, Order K) {
  for (int k = 0; k <= K; ++k) v[k] = a[k];
}

template <class Order>
inline void negate(Numbers a, Result v, Order K) {
  for (int k = 0; k <= K; ++k) v[k] = -a[k];
}

template <class Order>
inline void add(Numbers a, Numbers b, Result v, Order K) {
  for (int k = 0; k <= K; ++k) v[k] = a[k] + b[k];
}

template <class Order>
inline void subtract(Numbers a, Numbers b, Result v, Order K) {
  for (int k = 0; k <= K; ++k) v[k] = a[k] - b[k];
}

template <class Order>
inline void scale(Numbers a, double c, Result v, Order K) {
  for (int k = 0; k <= K; ++k) v[k] = c * a[k];
}

// v = a b
template <class Order>
inline void multiply(Numbers a, Numbers b, Result v, Order K) {
  for (int k = 0; k <= K; ++k) {
    double sum = a[0] * b[k];
    for (int j = 1; j <= k; ++j) sum += a[j] * b[k - j];
    v[k] = sum;
  }
}

// v = a^2 + c
template <class Order>
inline void square_plus(Numbers a, double c, Result v, Order K) {
  multiply(a, a, v, K);
  v[0] += c;
}

// b v = a
template <class Order>
inline void divide(Numbers a, Numbers b, Result v, Order K) {
  if (b[0] == 0.0) return poison(v, 0, K);
  for (int k = 0; k <= K; ++k) {
    double sum = a[k];
    for (int j = 1; j <= k; ++j) sum -= b[j] * v[k - j];
    v[k] = sum / b[0];
  }
}

template <class Order>
inline void divide_by_number(Numbers a, double c, Result v, Order K) {
  if (c == 0.0) return poison(v, 0, K);
  for (int k = 0; k <= K; ++k) v[k] = a[k] / c;
}

// v = c / b
template <class Order>
inline void reciprocal(double c, Numbers b, Result v, Order K) {
  if (b[0] == 0.0) return poison(v, 0, K);
  v[0] = c / b[0];
  for (int k = 1; k <= K; ++k) {
    double sum = 0.0;
    for (int j = 1; j <= k; ++j) sum -= b[j] * v[k - j];
    v[k] = sum / b[0];
  }
}

// v' = p a', v[0] given; p is the derivative of v by a.
template <class Order>
inline void integrate(Numbers a, Numbers p, Result v, Order K) {
  for (int k = 1; k <= K; ++k) {
    double sum = 0.0;
    for (int j = 1; j <= k; ++j) sum += j * a[j] * p[k - j];
    v[k] = sum / k;
  }
}

// v^2 = a
template <class Order>
inline void sqrt(Numbers a, Result v, Order K) {
  if (is_negative(a[0])) return poison(v, 0, K);
  v[0] = std::sqrt(a[0]);
  if (v[0] == 0.0) return poison(v, 1, K);
  for (int k = 1; k <= K; ++k) {
    double sum = a[k];
    for (int j = 1; j < k; ++j) sum -= v[j] * v[k - j];
    v[k] = sum / (2.0 * v[0]);
  }
}

// v' = v a'. Overflow is tested beforehand, as it would raise a floating-point exception.
template <class Order>
inline void exp(Numbers a, Result v, Order K) {
  constexpr double largest_argument = 709.782712893383973096;  // log of the largest number
  if (std::isgreater(a[0], largest_argument)) return poison(v, 0, K);
  v[0] = std::exp(a[0]);
  for (int k = 1; k <= K; ++k) {
    double sum = 0.0;
    for (int j = 1; j <= k; ++j) sum += j * a[j] * v[k - j];
    v[k] = sum / k;
  }
}

// p = 1 / a
template <class Order>
inline void log(Numbers a, Result v, Result p, Order K) {
  if (!is_positive(a[0])) {
    poison(p, 0, K);
    return poison(v, 0, K);
  }
  v[0] = std::log(a[0]);
  reciprocal(1.0, a, p, K);
  integrate(a, p, v, K);
}

// p = 1 / (a log 10)
template <class Order>
inline void log10(Numbers a, Result v, Result p, Order K) {
  constexpr double log_10 = 2.302585092994045684018;
  log(a, v, p, K);
  if (is_positive(a[0])) v[0] = std::log10(a[0]);
  for (int k = 0; k <= K; ++k) p[k] /= log_10;
  for (int k = 1; k <= K; ++k) v[k] /= log_10;
}

// The largest integer up to a: constant between its jumps.
template <class Order>
inline void floor(Numbers a, Result v, Order K) {
  v[0] = std::floor(a[0]);
  for (int k = 1; k <= K; ++k) v[k] = 0.0;
}

// v = a - q b, q = floor(a / b): in [0, b) for b > 0, in (b, 0] for b < 0. fmod is exact, a - b floor(a / b) is not.
template <class Order>
inline void modulo(Numbers a, Numbers b, Result v, Result q, Order K) {
  if (!std::isfinite(a[0]) || !std::isfinite(b[0]) || b[0] == 0.0) {
    poison(q, 0, K);
    return poison(v, 0, K);
  }
  double remainder = std::fmod(a[0], b[0]);
  if (remainder != 0.0 && std::signbit(remainder) != std::signbit(b[0])) {
    remainder += b[0];
    // The sum is rounded to b where b is much larger.
    if (remainder == b[0]) remainder = std::nextafter(b[0], 0.0);
  }
  v[0] = remainder == 0.0 ? 0.0 : remainder;
  q[0] = std::nearbyint((a[0] - remainder) / b[0]);
  for (int k = 1; k <= K; ++k) {
    q[k] = 0.0;
    v[k] = a[k] - q[0] * b[k];
  }
}

// s' = c a', c' = -s a'
template <class Order>
inline void sin_cos(Numbers a, Result s, Result c, Order K) {
  if (!std::isfinite(a[0])) {
    poison(s, 0, K);
    return poison(c, 0, K);
  }
  s[0] = std::sin(a[0]);
  c[0] = std::cos(a[0]);
  for (int k = 1; k <= K; ++k) {
    double sum_s = 0.0, sum_c = 0.0;
    for (int j = 1; j <= k; ++j) {
      sum_s += j * a[j] * c[k - j];
      sum_c -= j * a[j] * s[k - j];
    }
    s[k] = sum_s / k;
    c[k] = sum_c / k;
  }
}

// s' = c a', c' = s a'
template <class Order>
inline void sinh_cosh(Numbers a, Result s, Result c, Order K) {
  constexpr double largest_argument = 710.4758600739439;  // cosh of it is the largest number
  if (std::isgreater(std::fabs(a[0]), largest_argument)) {
    poison(s, 0, K);
    return poison(c, 0, K);
  }
  s[0] = std::sinh(a[0]);
  c[0] = std::cosh(a[0]);
  for (int k = 1; k <= K; ++k) {
    double sum_s = 0.0, sum_c = 0.0;
    for (int j = 1; j <= k; ++j) {
      sum_s += j * a[j] * c[k - j];
      sum_c += j * a[j] * s[k - j];
    }
    s[k] = sum_s / k;
    c[k] = sum_c / k;
  }
}

// v' = p a', p = 1 + sign v^2; v = tan a (sign 1) or tanh a (sign -1)
template <class Order>
inline void tangent(Numbers a, double sign, Result v, Result p, Order K) {
  if (!std::isfinite(a[0])) {
    poison(p, 0, K);
    return poison(v, 0, K);
  }
  v[0] = sign > 0.0 ? std::tan(a[0]) : std::tanh(a[0]);
  p[0] = 1.0 + sign * v[0] * v[0];
  for (int k = 1; k <= K; ++k) {
    double sum = 0.0;
    for (int j = 1; j <= k; ++j) sum += j * a[j] * p[k - j];
    v[k] = sum / k;
    double square = v[0] * v[k];
    for (int j = 1; j <= k; ++j) square += v[j] * v[k - j];
    p[k] = sign * square;
  }
}

// p = sign / sqrt(1 - a^2); v = asin a (sign 1) or acos a (sign -1)
template <class Order>
inline void arc(Numbers a, double sign, Result v, Result p, Order K) {
  if (std::isgreater(std::fabs(a[0]), 1.0)) {
    poison(p, 0, K);
    return poison(v, 0, K);
  }
  v[0] = sign > 0.0 ? std::asin(a[0]) : std::acos(a[0]);
  double square[highest_order + 1] = {}, root[highest_order + 1] = {};
  for (int k = 0; k <= K; ++k) {
    double sum = 0.0;
    for (int j = 0; j <= k; ++j) sum -= a[j] * a[k - j];
    square[k] = sum;
  }
  square[0] = (1.0 - a[0]) * (1.0 + a[0]);
  sqrt(square, root, K);
  reciprocal(sign, root, p, K);
  integrate(a, p, v, K);
}

// p = 1 / (1 + a^2); v = atan a
template <class Order>
inline void atan(Numbers a, Result v, Result p, Order K) {
  v[0] = std::atan(a[0]);
  double square[highest_order + 1] = {};
  square_plus(a, 1.0, square, K);
  reciprocal(1.0, square, p, K);
  integrate(a, p, v, K);
}

// v = angle of the point (x, y); p and q: derivatives by y and x
template <class Order>
inline void atan2(Numbers y, Numbers x, Result v, Result p, Result q, Order K) {
  v[0] = std::atan2(y[0], x[0]);
  double square[highest_order + 1] = {};
  for (int k = 0; k <= K; ++k) {
    double sum = 0.0;
    for (int j = 0; j <= k; ++j) sum += x[j] * x[k - j] + y[j] * y[k - j];
    square[k] = sum;
  }
  divide(x, square, p, K);
  divide(y, square, q, K);
  for (int k = 0; k <= K; ++k) q[k] = -q[k];
  for (int k = 1; k <= K; ++k) {
    double sum = 0.0;
    for (int j = 1; j <= k; ++j) sum += j * (y[j] * p[k - j] + x[j] * q[k - j]);
    v[k] = sum / k;
  }
}

// v = factor a^exponent at a_0 = 0, where its smoothness depends on the exponent.
template <class Order>
inline void power_at_zero(Numbers a, double exponent, double factor, Result v, Order K) {
  if (factor == 0.0) exponent = 0.0;
  if (is_negative(exponent)) return poison(v, 0, K);
  const bool is_integer = exponent == std::floor(exponent);
  for (int k = 0; k <= K; ++k) v[k] = 0.0;
  if (!is_integer) {
    // All derivatives below the exponent vanish; those above do not exist.
    for (int k = 0; k <= K; ++k)
      if (std::isgreater(k, exponent)) return poison(v, k, K);
    return;
  }
  if (std::isgreater(exponent, K)) return;
  v[0] = factor;
  for (int i = 0; i < static_cast<int>(exponent); ++i) {
    double product[highest_order + 1] = {};
    multiply(v, a, product, K);
    copy(product, v, K);
  }
}

// a v' = exponent v a'
template <class Order>
inline void power(Numbers a, double exponent, Result v, Order K) {
  if (a[0] == 0.0) return power_at_zero(a, exponent, 1.0, v, K);
  if (is_negative(a[0]) && exponent != std::floor(exponent)) return poison(v, 0, K);
  v[0] = std::pow(a[0], exponent);
  for (int k = 1; k <= K; ++k) {
    double sum = 0.0;
    for (int j = 1; j <= k; ++j) sum += (exponent * j - (k - j)) * a[j] * v[k - j];
    v[k] = sum / (k * a[0]);
  }
}

// p = exponent a^(exponent - 1), the derivative of v = a^exponent
template <class Order>
inline void power_slope(Numbers a, double exponent, Numbers v, Result p, Order K) {
  if (a[0] == 0.0) return power_at_zero(a, exponent - 1.0, exponent, p, K);
  divide(v, a, p, K);
  for (int k = 0; k <= K; ++k) p[k] *= exponent;
}

}  // namespace sfdae::core::series
