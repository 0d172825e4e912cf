// SPDX-License-Identifier: BSD-3-Clause

// Expressions of recorded equations for C++17 and later: operators and functions on those of expression.h, which
// has the meaning of everything here. Included by sfdae.hpp.
//
// Formulas can be templates that serve numbers and expressions alike:
//
//     template <class Number>
//     Number energy(const Number& x, const Number& v) {
//       using std::cos;
//       return 0.5 * v * v - cos(x);
//     }
#ifndef SFDAE_EXPRESSION_HPP
#define SFDAE_EXPRESSION_HPP

#include <sfdae/expression.h>

#include <string>

namespace sfdae {

/// A number, or a part of a formula that is being recorded.
class Expression {
 public:
  Expression(double number = 0.0) noexcept : c_(sfdae_number(number)) {}
  Expression(const sfdae_expression& expression) noexcept : c_(expression) {}

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
inline Expression min(const Expression& a, const Expression& b) noexcept { return sfdae_min(a.c(), b.c()); }
inline Expression max(const Expression& a, const Expression& b) noexcept { return sfdae_max(a.c(), b.c()); }

/// a if c > 0, else b; the other one need not be defined.
inline Expression choose(const Expression& c, const Expression& a, const Expression& b) noexcept {
  return sfdae_choose(c.c(), a.c(), b.c());
}
/// a if c > 0, else b, for formulas that serve numbers as well.
inline double choose(double c, double a, double b) noexcept { return c > 0.0 ? a : b; }

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

#endif
