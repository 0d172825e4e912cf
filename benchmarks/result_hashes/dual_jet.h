// SPDX-License-Identifier: BSD-3-Clause
// Taylor series with their derivative along one unknown: total derivatives of F, F_x and F_x' of residuals written as
// templates, for problems whose derivatives come from callbacks.
#pragma once

#include <vector>

#include "jet.h"
#include "problem.h"
#include "test_set/scalar.h"

namespace sfdae_bench {

struct DualJet {
  sfdae_test::Jet value, slope;
  DualJet(double number = 0.0) : value(number) {}
  DualJet(const sfdae_test::Jet& its_value, const sfdae_test::Jet& its_slope) : value(its_value), slope(its_slope) {}

  friend DualJet operator+(const DualJet& a, const DualJet& b) { return {a.value + b.value, a.slope + b.slope}; }
  friend DualJet operator-(const DualJet& a, const DualJet& b) { return {a.value - b.value, a.slope - b.slope}; }
  friend DualJet operator-(const DualJet& a) { return {-a.value, -a.slope}; }
  friend DualJet operator*(const DualJet& a, const DualJet& b) {
    return {a.value * b.value, a.slope * b.value + a.value * b.slope};
  }
  friend DualJet operator/(const DualJet& a, const DualJet& b) {
    const sfdae_test::Jet quotient = a.value / b.value;
    return {quotient, (a.slope - quotient * b.slope) / b.value};
  }
  friend DualJet sin(const DualJet& a) { return {sin(a.value), cos(a.value) * a.slope}; }
  friend DualJet cos(const DualJet& a) { return {cos(a.value), -(sin(a.value) * a.slope)}; }
  friend DualJet exp(const DualJet& a) { return {exp(a.value), exp(a.value) * a.slope}; }
  friend DualJet sqrt(const DualJet& a) { return {sqrt(a.value), a.slope / (2.0 * sqrt(a.value))}; }
};

// residual(t, x, xdot, F) for any scalar type.
template <class Residual>
TotalDerivative total_derivative(int m, int n, Residual residual) {
  return [m, n, residual](double t, int order, const double* derivatives, double* F, double* F_x, double* F_xdot) {
    using sfdae_test::Jet;
    const DualJet time(Jet::variable(t, order), Jet::zero(order));
    std::vector<DualJet> x(size(n)), xdot(size(n)), result(size(m));
    for (int i = 0; i < n; ++i) {
      Jet value = Jet::zero(order), slope = Jet::zero(order);
      for (int k = 0; k <= order; ++k) {
        value[k] = derivatives[i + k * n] / sfdae_test::factorial(k);
        slope[k] = derivatives[i + (k + 1) * n] / sfdae_test::factorial(k);
      }
      x[size(i)].value = value;
      xdot[size(i)].value = slope;
    }
    const double scale = sfdae_test::factorial(order);
    // Column j of the Jacobian with respect to `unknowns`, and F itself with every column.
    const auto column = [&](std::vector<DualJet>& unknowns, int j, double* jacobian) {
      unknowns[size(j)].slope = Jet(1.0);
      residual(time, x.data(), xdot.data(), result.data());
      unknowns[size(j)].slope = Jet(0.0);
      for (int i = 0; i < m; ++i) {
        F[i] = scale * result[size(i)].value[order];
        if (jacobian != nullptr) jacobian[i + j * m] = scale * result[size(i)].slope[order];
      }
    };
    for (int j = 0; j < (F_x != nullptr ? n : 1); ++j) column(x, j, F_x);
    for (int j = 0; j < n && F_xdot != nullptr; ++j) column(xdot, j, F_xdot);
    return 0;
  };
}

// The same problem by callbacks.
template <class Residual>
Problem differentiated(int m, int n, Residual residual) {
  return derivative_problem(m, n, total_derivative(m, n, residual));
}

}  // namespace sfdae_bench
