// SPDX-License-Identifier: BSD-3-Clause
// Every operation of recorded equations, as a function of two terms.
#ifndef SFDAE_TESTS_OPERATORS_H
#define SFDAE_TESTS_OPERATORS_H

#include <functional>
#include <string>
#include <vector>

#include "recorded.h"

namespace sfdae_test {

struct Operator {
  std::string name;
  std::function<Term(const Term&, const Term&, const Recording&)> apply;
};

inline const std::vector<Operator>& operators() {
  static const std::vector<Operator> all = {
      {"negate", [](auto a, auto, const auto&) { return -a; }},
      {"add", [](auto a, auto b, const auto&) { return a + b; }},
      {"subtract", [](auto a, auto b, const auto&) { return a - b; }},
      {"multiply", [](auto a, auto b, const auto&) { return a * b; }},
      {"multiply_by_number", [](auto a, auto, const auto&) { return -3.5 * a; }},
      {"multiply_by_t", [](auto a, auto, const auto& r) { return a * r.t; }},
      {"divide", [](auto a, auto b, const auto&) { return a / b; }},
      {"divide_by_number", [](auto a, auto, const auto&) { return a / 3.0; }},
      {"divide_by_t", [](auto a, auto, const auto& r) { return a / (2.0 + r.t); }},
      {"reciprocal", [](auto a, auto, const auto&) { return 1.0 / a; }},
      {"square", [](auto a, auto, const auto&) { return pow(a, 2.0); }},
      {"seventh_power", [](auto a, auto, const auto&) { return pow(a, 7.0); }},
      {"inverse_square", [](auto a, auto, const auto&) { return pow(a, -2.0); }},
      {"real_power", [](auto a, auto, const auto&) { return pow(a, 2.3); }},
      {"negative_power", [](auto a, auto, const auto&) { return pow(a, -1.7); }},
      {"high_power_of_negative", [](auto a, auto, const auto&) { return pow(-a, 101.0) * 1e10; }},
      {"variable_power", [](auto a, auto b, const auto&) { return pow(a, b); }},
      {"power_of_number", [](auto a, auto, const auto&) { return pow(Term(2.5), a); }},
      {"sqrt", [](auto a, auto, const auto&) { return sqrt(a); }},
      {"exp", [](auto a, auto, const auto&) { return exp(a); }},
      {"log", [](auto a, auto, const auto&) { return log(a); }},
      {"log10", [](auto a, auto, const auto&) { return log10(a); }},
      {"floor", [](auto a, auto b, const auto&) { return floor(7.0 * a + b) * a; }},
      {"modulo", [](auto a, auto b, const auto&) { return modulo(a, 0.3 * b) * a; }},
      {"modulo_of_negative", [](auto a, auto b, const auto&) { return modulo(-5.0 * a, b) + modulo(a, -0.2 * b); }},
      {"modulo_of_t", [](auto a, auto, const auto& r) { return modulo(r.t, Term(0.7)) * a; }},
      {"sin", [](auto a, auto, const auto&) { return sin(a); }},
      {"cos", [](auto a, auto, const auto&) { return cos(a); }},
      {"sin_and_cos", [](auto a, auto b, const auto&) { return sin(a) * cos(a) * b; }},
      {"cos_and_sin", [](auto a, auto b, const auto&) { return cos(a) * b - sin(a); }},
      {"tan", [](auto a, auto, const auto&) { return tan(a); }},
      {"asin", [](auto a, auto, const auto&) { return asin(a); }},
      {"acos", [](auto a, auto, const auto&) { return acos(a); }},
      {"atan", [](auto a, auto, const auto&) { return atan(a); }},
      {"atan2", [](auto a, auto b, const auto&) { return atan2(a, b); }},
      {"sinh", [](auto a, auto, const auto&) { return sinh(a); }},
      {"cosh", [](auto a, auto, const auto&) { return cosh(a); }},
      {"tanh", [](auto a, auto, const auto&) { return tanh(a); }},
      {"cosh_and_sinh", [](auto a, auto b, const auto&) { return cosh(a) * b + sinh(a); }},
      {"abs", [](auto a, auto b, const auto&) { return abs(a - 2.0 * b) * b; }},
      {"min", [](auto a, auto b, const auto&) { return min(a, b) * a; }},
      {"max", [](auto a, auto b, const auto&) { return max(a, b) * a; }},
      {"choose", [](auto a, auto b, const auto&) { return choose(a - 0.5, a * a, log(-b)); }},
      {"functions_of_t", [](auto a, auto, const auto& r) { return sin(r.t) * a + sqrt(2.0 + cos(r.t)); }},
  };
  return all;
}

}  // namespace sfdae_test

#endif
