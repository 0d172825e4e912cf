// SPDX-License-Identifier: BSD-3-Clause
#include "model/operations.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sfdae::cli {

int num_operands(Operation operation) {
  switch (operation) {
    case Operation::number:
    case Operation::time:
    case Operation::variable:
    case Operation::derivative:
    case Operation::previous:
    case Operation::sample:  // start and interval are stored elsewhere
    case Operation::initial:
    case Operation::terminal: return 0;
    case Operation::choose: return 3;
    default: return operation < Operation::add ? 1 : 2;
  }
}

bool is_relation(Operation operation) {
  return operation >= Operation::less && operation <= Operation::greater_equal;
}

bool is_rounding(Operation operation) {
  return (operation >= Operation::floor && operation <= Operation::integer) ||
         (operation >= Operation::div && operation <= Operation::rem);
}

namespace {

double truth(bool value) { return value ? 1.0 : 0.0; }

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

// `and` is false if one operand is false, `or` is true if one is true, even if the other is NaN.
double logic(Operation operation, double a, double b) {
  const double deciding = truth(operation == Operation::or_);
  const auto decides = [&](double x) { return !std::isnan(x) && truth(x != 0.0) == deciding; };
  if (decides(a) || decides(b)) return deciding;
  return std::isnan(a) || std::isnan(b) ? undefined : 1.0 - deciding;
}

double relation(Operation operation, double a, double b) {
  switch (operation) {
    case Operation::less: return truth(a < b);
    case Operation::less_equal: return truth(a <= b);
    case Operation::greater: return truth(a > b);
    case Operation::greater_equal: return truth(a >= b);
    case Operation::equal: return truth(a == b);
    default: return truth(a != b);
  }
}

double of_two(Operation operation, double a, double b) {
  if (operation == Operation::and_ || operation == Operation::or_) return logic(operation, a, b);
  if (std::isnan(a) || std::isnan(b)) return undefined;
  switch (operation) {
    case Operation::add: return a + b;
    case Operation::subtract: return a - b;
    case Operation::multiply: return a * b;
    case Operation::divide: return a / b;
    case Operation::power: return std::pow(a, b);
    case Operation::atan2: return std::atan2(a, b);
    case Operation::min: return std::min(a, b);
    case Operation::max: return std::max(a, b);
    case Operation::div: return std::trunc(a / b);
    case Operation::mod: return a - std::floor(a / b) * b;
    case Operation::rem: return a - std::trunc(a / b) * b;
    default: return relation(operation, a, b);
  }
}

}  // namespace

double applied(Operation operation, double a, double b, double c) {
  switch (operation) {
    case Operation::negate: return -a;
    case Operation::abs: return std::fabs(a);
    case Operation::sign: return std::isnan(a) ? a : truth(a > 0.0) - truth(a < 0.0);
    case Operation::sqrt: return std::sqrt(a);
    case Operation::exp: return std::exp(a);
    case Operation::log: return std::log(a);
    case Operation::log10: return std::log10(a);
    case Operation::sin: return std::sin(a);
    case Operation::cos: return std::cos(a);
    case Operation::tan: return std::tan(a);
    case Operation::asin: return std::asin(a);
    case Operation::acos: return std::acos(a);
    case Operation::atan: return std::atan(a);
    case Operation::sinh: return std::sinh(a);
    case Operation::cosh: return std::cosh(a);
    case Operation::tanh: return std::tanh(a);
    case Operation::floor:
    case Operation::integer: return std::floor(a);
    case Operation::ceil: return std::ceil(a);
    case Operation::not_: return std::isnan(a) ? a : truth(a == 0.0);
    case Operation::no_event: return a;
    case Operation::choose: return std::isnan(a) ? a : a != 0.0 ? b : c;
    default: return of_two(operation, a, b);
  }
}

}  // namespace sfdae::cli
