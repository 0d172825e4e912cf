// SPDX-License-Identifier: BSD-3-Clause

// Expressions of recorded equations for C++17 and later: operators and functions on those of expression.h, which
// explains them. Included by sfdae.hpp.
//
// Formulas can be templates for both numbers and expressions:
//
//     template <class Number>
//     Number energy(const Number& x, const Number& v) {
//       using std::cos;
//       return 0.5 * v * v - cos(x);
//     }
#ifndef SFDAE_EXPRESSION_HPP
#define SFDAE_EXPRESSION_HPP

#include <sfdae/expression.h>

#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

namespace sfdae {

class Expression;

namespace detail {
template <class T>
constexpr bool is_expression = std::is_same_v<T, Expression>;
// An Expression where one of the operands is one and the other converts to one.
template <class A, class B>
using OfExpressions = std::enable_if_t<(is_expression<A> && std::is_convertible_v<B, Expression>) ||
                                           (is_expression<B> && std::is_convertible_v<A, Expression>),
                                       Expression>;
template <class T>
using OfExpression = std::enable_if_t<is_expression<T>, Expression>;
}  // namespace detail

/// A number, or a part of a formula that is being recorded.
class Expression {
 public:
  Expression(double number = 0.0) noexcept : c_(sfdae_number(number)) {}
  Expression(const sfdae_expression& expression) noexcept : c_(expression) {}

  /// Not convertible: an expression has no value to branch on.
  template <class T, class = std::enable_if_t<std::is_same_v<T, bool>>>
  explicit operator T() const noexcept {
    static_assert(!std::is_same_v<T, bool>,
                  "an sfdae::Expression has no value while equations are recorded: instead of if, ? and : use "
                  "sfdae::choose(condition, a, b); instead of std::min and std::max, min and max");
    return T();
  }

  /// The expression in C.
  const sfdae_expression& c() const noexcept { return c_; }

  Expression& operator+=(const Expression& b) noexcept { return *this = sfdae_add(c_, b.c_); }
  Expression& operator-=(const Expression& b) noexcept { return *this = sfdae_subtract(c_, b.c_); }
  Expression& operator*=(const Expression& b) noexcept { return *this = sfdae_multiply(c_, b.c_); }
  Expression& operator/=(const Expression& b) noexcept { return *this = sfdae_divide(c_, b.c_); }

 private:
  sfdae_expression c_;
};

inline Expression operator+(const Expression& a, const Expression& b) noexcept { return sfdae_add(a.c(), b.c()); }
inline Expression operator-(const Expression& a, const Expression& b) noexcept {
  return sfdae_subtract(a.c(), b.c());
}
inline Expression operator*(const Expression& a, const Expression& b) noexcept {
  return sfdae_multiply(a.c(), b.c());
}
inline Expression operator/(const Expression& a, const Expression& b) noexcept { return sfdae_divide(a.c(), b.c()); }
inline Expression operator-(const Expression& a) noexcept { return sfdae_negate(a.c()); }
inline Expression operator+(const Expression& a) noexcept { return a; }

inline Expression pow(const Expression& a, const Expression& b) noexcept { return sfdae_power(a.c(), b.c()); }
inline Expression sqrt(const Expression& a) noexcept { return sfdae_sqrt(a.c()); }
inline Expression exp(const Expression& a) noexcept { return sfdae_exp(a.c()); }
inline Expression log(const Expression& a) noexcept { return sfdae_log(a.c()); }
inline Expression log10(const Expression& a) noexcept { return sfdae_log10(a.c()); }
inline Expression sin(const Expression& a) noexcept { return sfdae_sin(a.c()); }
inline Expression cos(const Expression& a) noexcept { return sfdae_cos(a.c()); }
inline Expression tan(const Expression& a) noexcept { return sfdae_tan(a.c()); }
inline Expression asin(const Expression& a) noexcept { return sfdae_asin(a.c()); }
inline Expression acos(const Expression& a) noexcept { return sfdae_acos(a.c()); }
inline Expression atan(const Expression& a) noexcept { return sfdae_atan(a.c()); }
inline Expression atan2(const Expression& y, const Expression& x) noexcept { return sfdae_atan2(y.c(), x.c()); }
inline Expression sinh(const Expression& a) noexcept { return sfdae_sinh(a.c()); }
inline Expression cosh(const Expression& a) noexcept { return sfdae_cosh(a.c()); }
inline Expression tanh(const Expression& a) noexcept { return sfdae_tanh(a.c()); }
inline Expression abs(const Expression& a) noexcept { return sfdae_abs(a.c()); }
inline Expression sign(const Expression& a) noexcept { return sfdae_sign(a.c()); }
inline Expression floor(const Expression& a) noexcept { return sfdae_floor(a.c()); }
inline Expression modulo(const Expression& a, const Expression& b) noexcept { return sfdae_modulo(a.c(), b.c()); }
inline Expression min(const Expression& a, const Expression& b) noexcept { return sfdae_min(a.c(), b.c()); }
inline Expression max(const Expression& a, const Expression& b) noexcept { return sfdae_max(a.c(), b.c()); }

/// a if c > 0, else b; the operand not chosen need not be defined.
inline Expression choose(const Expression& c, const Expression& a, const Expression& b) noexcept {
  return sfdae_choose(c.c(), a.c(), b.c());
}
/// a if c > 0, else b, for formulas of numbers.
inline double choose(double c, double a, double b) noexcept { return c > 0.0 ? a : b; }

/// 1 if it holds, else 0; for choose. Both operands of && and || are recorded.
template <class A, class B>
detail::OfExpressions<A, B> operator<(const A& a, const B& b) noexcept {
  return sfdae_less(Expression(a).c(), Expression(b).c());
}
template <class A, class B>
detail::OfExpressions<A, B> operator<=(const A& a, const B& b) noexcept {
  return sfdae_less_equal(Expression(a).c(), Expression(b).c());
}
template <class A, class B>
detail::OfExpressions<A, B> operator>(const A& a, const B& b) noexcept {
  return sfdae_greater(Expression(a).c(), Expression(b).c());
}
template <class A, class B>
detail::OfExpressions<A, B> operator>=(const A& a, const B& b) noexcept {
  return sfdae_greater_equal(Expression(a).c(), Expression(b).c());
}
inline Expression operator&&(const Expression& a, const Expression& b) noexcept { return sfdae_and(a.c(), b.c()); }
inline Expression operator||(const Expression& a, const Expression& b) noexcept { return sfdae_or(a.c(), b.c()); }
inline Expression operator!(const Expression& a) noexcept { return sfdae_not(a.c()); }

/// The partial derivative of a formula with respect to t, an unknown, the derivative of an unknown or a parameter, see
/// sfdae_derivative.
inline Expression derivative(const Expression& a, const Expression& variable) noexcept {
  return sfdae_derivative(a.c(), variable.c());
}
/// The total time derivative of a formula in t and x, see sfdae_time_derivative.
inline Expression time_derivative(const Expression& a) noexcept { return sfdae_time_derivative(a.c()); }

/// The value at a of the spline of degree 1, 3, 5 or 7 through points (x, y), see sfdae_table.
inline Expression table(const Expression& a, int degree, const std::vector<double>& x, const std::vector<double>& y) {
  const bool fits = x.size() == y.size();
  const double nothing = 0.0;  // an empty vector may have no address
  return sfdae_table(a.c(), degree, fits ? static_cast<int>(x.size()) : 1, fits && !x.empty() ? x.data() : nullptr,
                     y.empty() ? &nothing : y.data());
}

/// A constant with a name, whose value can be changed later by Solver::set_parameter; see sfdae_parameter.
inline Expression parameter(sfdae_record* record, const std::string& name, double value) noexcept {
  return sfdae_parameter(record, name.c_str(), value);
}

/// A constant with a name in the recording that an expression belongs to, for example t; its value can be changed
/// later by Solver::set_parameter.
inline Expression parameter(const Expression& t, const std::string& name, double value) noexcept {
  return sfdae_parameter(t.c().record, name.c_str(), value);
}

}  // namespace sfdae

// Formulas may use std::sin. These functions, like those of namespace sfdae, are for expressions only.
namespace std {

template <class T>
sfdae::detail::OfExpression<T> sqrt(const T& a) noexcept {
  return sfdae::sqrt(a);
}
template <class T>
sfdae::detail::OfExpression<T> exp(const T& a) noexcept {
  return sfdae::exp(a);
}
template <class T>
sfdae::detail::OfExpression<T> log(const T& a) noexcept {
  return sfdae::log(a);
}
template <class T>
sfdae::detail::OfExpression<T> log10(const T& a) noexcept {
  return sfdae::log10(a);
}
template <class T>
sfdae::detail::OfExpression<T> sin(const T& a) noexcept {
  return sfdae::sin(a);
}
template <class T>
sfdae::detail::OfExpression<T> cos(const T& a) noexcept {
  return sfdae::cos(a);
}
template <class T>
sfdae::detail::OfExpression<T> tan(const T& a) noexcept {
  return sfdae::tan(a);
}
template <class T>
sfdae::detail::OfExpression<T> asin(const T& a) noexcept {
  return sfdae::asin(a);
}
template <class T>
sfdae::detail::OfExpression<T> acos(const T& a) noexcept {
  return sfdae::acos(a);
}
template <class T>
sfdae::detail::OfExpression<T> atan(const T& a) noexcept {
  return sfdae::atan(a);
}
template <class T>
sfdae::detail::OfExpression<T> sinh(const T& a) noexcept {
  return sfdae::sinh(a);
}
template <class T>
sfdae::detail::OfExpression<T> cosh(const T& a) noexcept {
  return sfdae::cosh(a);
}
template <class T>
sfdae::detail::OfExpression<T> tanh(const T& a) noexcept {
  return sfdae::tanh(a);
}
template <class T>
sfdae::detail::OfExpression<T> abs(const T& a) noexcept {
  return sfdae::abs(a);
}
template <class T>
sfdae::detail::OfExpression<T> fabs(const T& a) noexcept {
  return sfdae::abs(a);
}
template <class T>
sfdae::detail::OfExpression<T> floor(const T& a) noexcept {
  return sfdae::floor(a);
}
template <class A, class B>
sfdae::detail::OfExpressions<A, B> pow(const A& a, const B& b) noexcept {
  return sfdae::pow(a, b);
}
template <class A, class B>
sfdae::detail::OfExpressions<A, B> atan2(const A& y, const B& x) noexcept {
  return sfdae::atan2(y, x);
}

}  // namespace std

#endif
