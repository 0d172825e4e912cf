// SPDX-License-Identifier: BSD-3-Clause

// Complex problems as real ones of twice the size, for C++17 and later. Not included by sfdae.hpp.
//
// Complex unknown j is the real unknowns 2 j (real part) and 2 j + 1 (imaginary part), and equations likewise: vectors
// have the memory layout of arrays of std::complex<double>, and entry a of a matrix is the block [re a, -im a; im a, re
// a]. Characteristic values d, a, u, v are those of the real problem, twice those of the complex one.
#ifndef SFDAE_COMPLEX_HPP
#define SFDAE_COMPLEX_HPP

#include <sfdae/expression.hpp>
#include <sfdae/problem.hpp>

#include <complex>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace sfdae {

/// A complex number, or a part of a formula that is being recorded. F need not be analytic: conj, real, imag and norm
/// are allowed.
class ComplexExpression {
 public:
  ComplexExpression(double real = 0.0) noexcept : real_(real) {}
  ComplexExpression(const std::complex<double>& number) noexcept : real_(number.real()), imag_(number.imag()) {}
  ComplexExpression(const Expression& real, const Expression& imag = 0.0) noexcept : real_(real), imag_(imag) {}

  const Expression& real() const noexcept { return real_; }
  const Expression& imag() const noexcept { return imag_; }

  ComplexExpression& operator+=(const ComplexExpression& b) noexcept { return *this = *this + b; }
  ComplexExpression& operator-=(const ComplexExpression& b) noexcept { return *this = *this - b; }
  ComplexExpression& operator*=(const ComplexExpression& b) noexcept { return *this = *this * b; }
  ComplexExpression& operator/=(const ComplexExpression& b) noexcept { return *this = *this / b; }

  friend ComplexExpression operator+(const ComplexExpression& a, const ComplexExpression& b) noexcept {
    return {a.real_ + b.real_, a.imag_ + b.imag_};
  }
  friend ComplexExpression operator-(const ComplexExpression& a, const ComplexExpression& b) noexcept {
    return {a.real_ - b.real_, a.imag_ - b.imag_};
  }
  friend ComplexExpression operator*(const ComplexExpression& a, const ComplexExpression& b) noexcept {
    return {a.real_ * b.real_ - a.imag_ * b.imag_, a.real_ * b.imag_ + a.imag_ * b.real_};
  }
  friend ComplexExpression operator/(const ComplexExpression& a, const ComplexExpression& b) noexcept {
    const Expression square = b.real_ * b.real_ + b.imag_ * b.imag_;
    return {(a.real_ * b.real_ + a.imag_ * b.imag_) / square, (a.imag_ * b.real_ - a.real_ * b.imag_) / square};
  }
  friend ComplexExpression operator-(const ComplexExpression& a) noexcept { return {-a.real_, -a.imag_}; }
  friend ComplexExpression operator+(const ComplexExpression& a) noexcept { return a; }

 private:
  Expression real_, imag_;
};

inline Expression real(const ComplexExpression& a) noexcept { return a.real(); }
inline Expression imag(const ComplexExpression& a) noexcept { return a.imag(); }
inline ComplexExpression conj(const ComplexExpression& a) noexcept { return {a.real(), -a.imag()}; }
/// The square of the absolute value, as std::norm.
inline Expression norm(const ComplexExpression& a) noexcept { return a.real() * a.real() + a.imag() * a.imag(); }
/// The absolute value, which has no derivatives at 0.
inline Expression abs(const ComplexExpression& a) noexcept { return sqrt(norm(a)); }
/// The angle, in (-pi, pi].
inline Expression arg(const ComplexExpression& a) noexcept { return atan2(a.imag(), a.real()); }
inline ComplexExpression polar(const Expression& radius, const Expression& angle) noexcept {
  return {radius * cos(angle), radius * sin(angle)};
}
inline ComplexExpression exp(const ComplexExpression& a) noexcept { return polar(exp(a.real()), a.imag()); }
/// The principal value.
inline ComplexExpression log(const ComplexExpression& a) noexcept { return {0.5 * log(norm(a)), arg(a)}; }
inline ComplexExpression sin(const ComplexExpression& a) noexcept {
  return {sin(a.real()) * cosh(a.imag()), cos(a.real()) * sinh(a.imag())};
}
inline ComplexExpression cos(const ComplexExpression& a) noexcept {
  return {cos(a.real()) * cosh(a.imag()), -(sin(a.real()) * sinh(a.imag()))};
}

/// F(t, x, x') = 0 with m complex equations in n complex unknowns: records F at t, x, xdot (n values each), m values
/// to F.
using ComplexEquations =
    std::function<void(const Expression& t, const std::vector<ComplexExpression>& x,
                       const std::vector<ComplexExpression>& xdot, std::vector<ComplexExpression>& F)>;

/// The real problem, with 2 m equations and 2 n unknowns.
inline NonlinearProblem complex_problem(int m, int n, ComplexEquations equations) {
  NonlinearProblem problem(2 * m, 2 * n);
  problem.equations = [m, n, equations = std::move(equations)](const Expression& t, const auto& x, const auto& xdot,
                                                               const auto& F) {
    std::vector<ComplexExpression> complex_x, complex_xdot, complex_F(static_cast<std::size_t>(m));
    for (int j = 0; j < n; ++j) {
      complex_x.emplace_back(x[2 * j], x[2 * j + 1]);
      complex_xdot.emplace_back(xdot[2 * j], xdot[2 * j + 1]);
    }
    equations(t, complex_x, complex_xdot, complex_F);
    for (int i = 0; i < m; ++i) {
      const ComplexExpression& value = complex_F.at(static_cast<std::size_t>(i));
      F[2 * i] = value.real();
      F[2 * i + 1] = value.imag();
    }
  };
  return problem;
}

/// n complex numbers as 2 n real ones.
inline std::vector<double> real_form(const std::vector<std::complex<double>>& x) {
  std::vector<double> result;
  for (const std::complex<double>& value : x) {
    result.push_back(value.real());
    result.push_back(value.imag());
  }
  return result;
}

/// 2 n real numbers as n complex ones. x: of an even size.
inline std::vector<std::complex<double>> complex_form(const std::vector<double>& x) {
  if (x.size() % 2 != 0)
    throw Error(SFDAE_ILLEGAL_ARGUMENT,
                std::to_string(x.size()) + " real numbers are not pairs of real and imaginary parts");
  std::vector<std::complex<double>> result;
  for (std::size_t j = 0; j < x.size(); j += 2) result.emplace_back(x[j], x[j + 1]);
  return result;
}

/// An m x n complex matrix, by columns, written to the 2 m x 2 n real matrix of a linear problem, or to one of its
/// orders.
template <class RealMatrix>
void write_real_form(const std::vector<std::complex<double>>& matrix, RealMatrix&& to) {
  const int m = to.rows() / 2, n = to.columns() / 2;
  if (to.rows() % 2 != 0 || to.columns() % 2 != 0 ||
      matrix.size() != static_cast<std::size_t>(m) * static_cast<std::size_t>(n))
    throw Error(SFDAE_ILLEGAL_ARGUMENT, std::to_string(matrix.size()) +
                                            " complex entries do not fit a real matrix of " +
                                            std::to_string(to.rows()) + " x " + std::to_string(to.columns()));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < m; ++i) {
      const std::complex<double> a =
          matrix[static_cast<std::size_t>(i) + static_cast<std::size_t>(j) * static_cast<std::size_t>(m)];
      to(2 * i, 2 * j) = to(2 * i + 1, 2 * j + 1) = a.real();
      to(2 * i, 2 * j + 1) = -a.imag();
      to(2 * i + 1, 2 * j) = a.imag();
    }
}

}  // namespace sfdae

#endif
