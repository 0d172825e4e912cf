// SPDX-License-Identifier: BSD-3-Clause
// Taylor coefficients from Cauchy's formula: an oracle that knows nothing of power series arithmetic.
#ifndef SFDAE_TESTS_CONTOUR_H
#define SFDAE_TESTS_CONTOUR_H

#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <vector>

#include "expression/record.h"

namespace sfdae_test {

using Complex = std::complex<double>;

// The residuals at complex s = t - t0. jet: n x columns as for TaylorEvaluator; branches are those at s = 0.
class ComplexEvaluation {
 public:
  ComplexEvaluation(const sfdae::core::Record& record, double t0, const std::vector<double>& jet, int columns)
      : record_(record), t0_(t0), jet_(jet), columns_(columns) {
    center_ = nodes(0.0);
  }

  std::vector<Complex> residuals(Complex s) const {
    const std::vector<Complex> values = nodes(s);
    std::vector<Complex> result;
    for (int i = 0; i < record_.m(); ++i) result.push_back(values[index(record_.residual(i))]);
    return result;
  }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  Complex unknown(int j, Complex s, bool derivative) const {
    Complex sum = 0.0, power = 1.0;
    for (int k = derivative ? 1 : 0; k < columns_; ++k, power *= s)
      sum += power * jet_[index(j + k * record_.n())] * (derivative ? k : 1.0);
    return sum;
  }

  std::vector<Complex> nodes(Complex s) const {
    std::vector<Complex> values;
    for (int i = 0; i < record_.num_nodes(); ++i) {
      const sfdae::core::Node& node = record_.node(i);
      const sfdae::core::Operands operands = record_.operands(i);
      const auto operand = [&](int k) { return values[index(operands[k])]; };
      values.push_back(value(node, operand, s));
    }
    return values;
  }

  template <class Operand>
  Complex value(const sfdae::core::Node& node, Operand operand, Complex s) const {
    using sfdae::core::Operation;
    switch (node.operation) {
      case Operation::constant: return record_.constant(node.a);
      case Operation::parameter: return record_.parameters()[index(node.a)].value;
      case Operation::time: return t0_ + s;
      case Operation::unknown: return unknown(node.a, s, false);
      case Operation::derivative: return unknown(node.a, s, true);
      case Operation::negate: return -operand(0);
      case Operation::add: return operand(0) + operand(1);
      case Operation::subtract: return operand(0) - operand(1);
      case Operation::multiply: return operand(0) * operand(1);
      case Operation::divide: return operand(0) / operand(1);
      case Operation::power: return std::pow(operand(0), operand(1).real());
      case Operation::log_of_base:
      case Operation::log: return std::log(operand(0));
      case Operation::log10: return std::log10(operand(0));
      case Operation::sqrt: return std::sqrt(operand(0));
      case Operation::exp: return std::exp(operand(0));
      case Operation::sin: return std::sin(operand(0));
      case Operation::cos: return std::cos(operand(0));
      case Operation::tan: return std::tan(operand(0));
      case Operation::asin: return std::asin(operand(0));
      case Operation::acos: return std::acos(operand(0));
      case Operation::atan: return std::atan(operand(0));
      case Operation::atan2: return std::atan(operand(0) / operand(1));  // right half-plane
      case Operation::sinh: return std::sinh(operand(0));
      case Operation::cosh: return std::cosh(operand(0));
      case Operation::tanh: return std::tanh(operand(0));
      case Operation::floor: return std::floor(center(node.a, operand(0)).real());
      case Operation::modulo: {
        const double a = center(node.a, operand(0)).real(), b = center(node.b, operand(1)).real();
        return operand(0) - std::floor(a / b) * operand(1);
      }
      case Operation::choose:
      case Operation::function: break;
    }
    return center(node.a, operand(0)).real() > 0.0 ? operand(1) : operand(2);
  }

  // The value of a node at s = 0.
  Complex center(int node, Complex value) const { return center_.empty() ? value : center_[index(node)]; }

  const sfdae::core::Record& record_;
  double t0_;
  const std::vector<double>& jet_;
  int columns_;
  std::vector<Complex> center_;
};

// Coefficients of order 0 ... order, m x (order + 1). The error is about unit_roundoff max |F| / radius^order, where
// the maximum is over the circle, within which F has to be analytic.
inline std::vector<double> contour_coefficients(const ComplexEvaluation& evaluation, int order, double radius) {
  constexpr int points = 64;
  std::vector<double> result;
  for (int p = 0; p < points; ++p) {
    const double angle = 2.0 * std::numbers::pi * p / points;
    const std::vector<Complex> F = evaluation.residuals(std::polar(radius, angle));
    result.resize(F.size() * static_cast<std::size_t>(order + 1));
    for (int k = 0; k <= order; ++k) {
      const Complex weight = std::polar(std::pow(radius, -k) / points, -k * angle);
      double* const column = result.data() + static_cast<std::size_t>(k) * F.size();
      for (std::size_t i = 0; i < F.size(); ++i) column[i] += (F[i] * weight).real();
    }
  }
  return result;
}

}  // namespace sfdae_test

#endif
