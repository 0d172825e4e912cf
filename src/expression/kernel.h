// One instruction of a tape on power series.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <optional>

#include "expression/series.h"
#include "expression/tape.h"

namespace sfdae::core {

// Slots of the instruction are offsets from `slots`. with_slopes: p and q are needed for gradients; else they are
// computed where the value needs them.
template <bool with_slopes, class Order>
inline void execute(const Instruction& instruction, double* slots, Order K) {
  const double* const a = slots + instruction.a;
  const double* const b = slots + instruction.b;
  double* const v = slots + instruction.v;
  double* const p = slots + instruction.p;
  double* const q = slots + instruction.q;
  switch (instruction.code) {
    case Code::negate: return series::negate(a, v, K);
    case Code::add: return series::add(a, b, v, K);
    case Code::subtract: return series::subtract(a, b, v, K);
    case Code::multiply: return series::multiply(a, b, v, K);
    case Code::scale: return series::scale(a, b[0], v, K);
    case Code::divide:
      series::divide(a, b, v, K);
      if constexpr (with_slopes) {
        series::reciprocal(1.0, b, p, K);
        series::multiply(v, p, q, K);
      }
      return;
    case Code::divide_by_number:
      series::divide_by_number(a, b[0], v, K);
      if constexpr (with_slopes) p[0] = b[0] == 0.0 ? v[0] : 1.0 / b[0];
      return;
    case Code::power:
      series::power(a, b[0], v, K);
      if constexpr (with_slopes) series::power_slope(a, b[0], v, p, K);
      return;
    case Code::sqrt:
      series::sqrt(a, v, K);
      if constexpr (with_slopes) series::reciprocal(0.5, v, p, K);
      return;
    case Code::exp: return series::exp(a, v, K);
    case Code::log: return series::log(a, v, p, K);
    case Code::log10: return series::log10(a, v, p, K);
    case Code::sin_cos: return series::sin_cos(a, v, p, K);
    case Code::sinh_cosh: return series::sinh_cosh(a, v, p, K);
    case Code::tan: return series::tangent(a, 1.0, v, p, K);
    case Code::tanh: return series::tangent(a, -1.0, v, p, K);
    case Code::asin: return series::arc(a, 1.0, v, p, K);
    case Code::acos: return series::arc(a, -1.0, v, p, K);
    case Code::atan: return series::atan(a, v, p, K);
    case Code::atan2: return series::atan2(a, b, v, p, q, K);
    case Code::floor: return series::floor(a, v, K);
    case Code::modulo: return series::modulo(a, b, v, q, K);
    case Code::copy: return series::copy(a, v, K);
    case Code::function: return evaluate(*instruction.call, {a, b - a, v, with_slopes ? p : nullptr}, K);
    case Code::choose:
      if (std::isnan(a[0])) return series::poison(v, 0, K);
      return series::copy(series::is_positive(a[0]) ? b : slots + instruction.c, v, K);
  }
}

// Value of an operation on numbers; none where it is not defined or not finite.
std::optional<double> evaluate(Operation operation, double a, double b = 0.0, double c = 0.0);

}  // namespace sfdae::core
