// SPDX-License-Identifier: BSD-3-Clause
#include "laws.h"

#include <cmath>
#include <numbers>

namespace campaign {

namespace {

constexpr double thermal_voltage = 0.0259;  // of a diode at 300 K

// The formulas that need no data.
Formula plain_law(Law law, Formula u) {
  switch (law) {
    case Law::exponential: return exp(u) - 1.0;
    case Law::power_25: return power(u, 25);
    case Law::smooth_diode:
      return exp((u + sqrt(u * u + 1e-4)) / 2.0 / thermal_voltage) - std::exp(0.005 / thermal_voltage);
    case Law::hyperbolic_tangent: return tanh(u);
    case Law::arc_tangent: return 2.0 / std::numbers::pi * atan(u);
    case Law::root_quotient: return u / sqrt(1.0 + u * u);
    case Law::absolute_quotient: return u / (1.0 + abs(u));
    case Law::hyperbolic_sine: return sinh(u);
    default: return u + power(u, 3);
  }
}

}  // namespace

LawOfCase random_law(Law law, RandomNumbers& random) {
  LawOfCase result;
  result.law = law;
  constexpr std::array<Law, 4> hidden = {Law::root_quotient, Law::cubic, Law::arc_tangent, Law::hyperbolic_tangent};
  result.hidden = hidden[static_cast<std::size_t>(random.integer(0, 3))];
  const int degree = random.chance(0.5) ? 3 : 1, count = 2 * random.integer(4, 12);
  std::vector<double> u, y;
  for (int i = 0; i < count; ++i) {
    const double s = -1.0 + 2.0 * i / (count - 1);
    u.push_back(5.0 * s * (0.4 + 0.6 * s * s));
    y.push_back(std::tanh(u.back()) + 0.2 * u.back());
  }
  result.spline = make_spline(degree, u, y);
  return result;
}

Formula apply(const LawOfCase& law, Formula u) {
  if (law.law == Law::table) {
    Formulas& owner = *u.owner;
    const std::vector<double>& x = law.spline.x;
    return owner.add_table(maximum(minimum(u, owner.number(x.back())), owner.number(x.front())), law.spline);
  }
  if (law.law != Law::opaque) return plain_law(law.law, u);
  OpaqueFunction function{"law", std::make_shared<Formulas>(), -1};
  function.root = plain_law(law.hidden, function.formulas->unknown(0)).node;
  return u.owner->add_opaque(u, plain_law(law.hidden, u), function);
}

}  // namespace campaign
