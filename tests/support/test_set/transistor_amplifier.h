// SPDX-License-Identifier: BSD-3-Clause
// Transistor amplifier [TS]: eight node potentials, five capacitors, mu = 0.
#ifndef SFDAE_TESTS_TRANSISTOR_AMPLIFIER_H
#define SFDAE_TESTS_TRANSISTOR_AMPLIFIER_H

#include "scalar.h"
#include "test_problem.h"

namespace sfdae_test {

struct TransistorAmplifier {
  static constexpr double Ub = 6.0, UF = 0.026, alpha = 0.99, beta = 1e-6, R0 = 1000.0, R = 9000.0;
  static constexpr double pi = 3.14159265358979323846;
};

template <class V>
void transistor_amplifier_residual(const V& t, const V* x, const V* xdot, V* F) {
  using std::sin, std::exp;
  using T = TransistorAmplifier;
  constexpr double C1 = 1e-6, C2 = 2e-6, C3 = 3e-6, C4 = 4e-6, C5 = 5e-6;
  const V source = 0.1 * sin(200.0 * T::pi * t);
  const V g23 = T::beta * (exp((x[1] - x[2]) / T::UF) - 1.0), g56 = T::beta * (exp((x[4] - x[5]) / T::UF) - 1.0);
  const V charge12 = C1 * (xdot[1] - xdot[0]), charge45 = C3 * (xdot[4] - xdot[3]),
          charge78 = C5 * (xdot[7] - xdot[6]);
  F[0] = charge12 - (x[0] - source) / T::R0;
  F[1] = -charge12 - ((2.0 * x[1] - T::Ub) / T::R + (1.0 - T::alpha) * g23);
  F[2] = -C2 * xdot[2] - (x[2] / T::R - g23);
  F[3] = charge45 - ((x[3] - T::Ub) / T::R + T::alpha * g23);
  F[4] = -charge45 - ((2.0 * x[4] - T::Ub) / T::R + (1.0 - T::alpha) * g56);
  F[5] = -C4 * xdot[5] - (x[5] / T::R - g56);
  F[6] = charge78 - ((x[6] - T::Ub) / T::R + T::alpha * g56);
  F[7] = -charge78 - x[7] / T::R;
}

inline TestProblem transistor_amplifier() {
  TestProblem p{.name = "transistor_amplifier", .m = 8, .n = 8, .values = {0, 5, 3, 0, 0}, .t0 = 0.0, .tf = 0.2};
  p.x0 = {0.0, 3.0, 3.0, 6.0, 3.0, 3.0, 6.0, 0.0};
  p.xdot0 = {51.338775,    51.338775,   -3.0 / (2e-6 * 9000.0), -24.9757667, -24.9757667, -3.0 / (4e-6 * 9000.0),
             -10.00564453, -10.00564453};
  p.references = {{0.2,
                   {-5.56214501226227444453859468e-03, 3.00652247190304266733612482, 2.84995878860812850739273272,
                    2.92642253620624150899659220, 2.70461786501055459070327197, 2.76183777839314405447769609,
                    4.77092763161677215580135839, 1.23699586809154754969521996}}};
  p.counted = first_components(8);
  return p;
}

}  // namespace sfdae_test

#endif
