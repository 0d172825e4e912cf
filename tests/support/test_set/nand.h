// SPDX-License-Identifier: BSD-3-Clause
// NAND gate of three MOS transistors [TS]: 14 node potentials, C(x) x' = f(t, x) with C nonsingular but dependent on
// x, mu = 0, a = 0. Two input pulses have corners at t = 5, 10, ..., 75.
#ifndef SFDAE_TESTS_NAND_H
#define SFDAE_TESTS_NAND_H

#include "scalar.h"
#include "test_problem.h"

namespace sfdae_test {

struct Nand {
  static constexpr double RGS = 4.0, RGD = 4.0, RBS = 10.0, RBD = 10.0, CGS = 0.6e-4, CGD = 0.6e-4, CBD = 2.4e-5,
                          C9 = 0.5e-4, D = 0.02, IS = 1e-14, VTH = 25.85, VDD = 5.0, VBB = -2.5;

  // B of negative drain voltages differs for the enhancement type: the published program has it so.
  struct Transistor {
    double VT0, CG, PHI, B, B_reverse;
  };
  static constexpr Transistor depletion{-2.43, 0.2, 1.28, 5.35e-4, 5.35e-4};
  static constexpr Transistor enhancement{0.2, 0.035, 1.01, 1.748e-3, 1.748e-4};

  // Voltages of a transistor: gate and bulk against source (forward) and drain (reverse).
  template <class V>
  struct Voltages {
    V DS, GS, BS, GD, BD;
  };

  // Drain current (Shichman and Hodges). With source and drain exchanged for DS < 0, s = |DS| and the excess u of the
  // gate over the threshold, it is B s (2 u - s) below saturation s < u, B u^2 above, 0 for u < 0.
  template <class V>
  static V drain_current(const Transistor& z, const Voltages<V>& at) {
    using std::sqrt, std::min, std::max, std::abs;
    const V gate = choose(at.DS, at.GS, at.GD), bulk = choose(at.DS, at.BS, at.BD), s = abs(at.DS);
    const V threshold = z.VT0 + z.CG * (sqrt(z.PHI - bulk) - std::sqrt(z.PHI));
    const V u = max(gate - threshold, V(0.0)), linear = min(u, s);
    return choose(at.DS, V(-z.B), V(z.B_reverse)) * linear * (2.0 * u - linear) * (1.0 + D * s);
  }

  // Current and capacity of a junction; the voltage is clipped in the branch that is not taken.
  template <class V>
  static V junction_current(const V& voltage) {
    using std::min, std::exp;
    return -IS * (exp(min(voltage, V(0.0)) / VTH) - 1.0);
  }
  template <class V>
  static V capacity(const V& voltage) {
    using std::min, std::max, std::sqrt;
    constexpr double PB = 0.87;
    const V forward = max(voltage, V(0.0)), reverse = min(voltage, V(0.0));
    return CBD * (1.0 / sqrt(1.0 - reverse / PB) + forward / (2.0 * PB));
  }
};

// Inputs and their slopes.
template <class V>
struct NandInputs {
  V V1, V1_slope, V2, V2_slope;
};

// In the segment 5 k <= t <= 5 (k + 1): V1 rises from 5 to 10 and falls from 15 to 20, period 20; V2 rises from 15 to
// 20 and falls from 35 to 40, period 40. Voltages up to 5, slopes 1, 0, -1.
template <class V>
NandInputs<V> nand_inputs(const V& t, int segment) {
  const V since = t - 5.0 * segment;
  const auto pulse = [&](int phase, int rise, int fall) -> std::pair<V, V> {
    if (phase == rise) return {since, V(1.0)};
    if (phase == fall) return {5.0 - since, V(-1.0)};
    return {V(phase > rise && phase < fall ? 5.0 : 0.0), V(0.0)};
  };
  const auto first = pulse(segment % 4, 1, 3), second = pulse(segment % 8, 3, 7);
  return {first.first, first.second, second.first, second.second};
}

template <class V>
void nand_residual(const NandInputs<V>& in, const V* x, const V* xdot, V* F) {
  using N = Nand;
  constexpr double gS = 1.0 / N::RGS, gD = 1.0 / N::RGD, gBS = 1.0 / N::RBS, gBD = 1.0 / N::RBD;
  const auto y = [x](int i) -> const V& { return x[i - 1]; };
  const auto yd = [xdot](int i) -> const V& { return xdot[i - 1]; };
  using Pins = N::Voltages<V>;
  const V i1 =
      N::drain_current(N::depletion, Pins{y(2) - y(1), y(5) - y(1), y(3) - y(5), y(5) - y(2), y(4) - N::VDD});
  const V i2 =
      N::drain_current(N::enhancement, Pins{y(7) - y(6), in.V1 - y(6), y(8) - y(10), in.V1 - y(7), y(9) - y(5)});
  const V i3 =
      N::drain_current(N::enhancement, Pins{y(12) - y(11), in.V2 - y(11), y(13), in.V2 - y(12), y(14) - y(10)});
  const V i35 = N::junction_current(V(y(3) - y(5))), i4 = N::junction_current(V(y(4) - N::VDD));
  const V i95 = N::junction_current(V(y(9) - y(5))), i810 = N::junction_current(V(y(8) - y(10)));
  const V i1410 = N::junction_current(V(y(14) - y(10))), i13 = N::junction_current(y(13));
  // Currents into the capacitors at the junctions.
  const V q35 = N::capacity(V(y(3) - y(5))) * (yd(3) - yd(5)), q95 = N::capacity(V(y(9) - y(5))) * (yd(9) - yd(5));
  const V q810 = N::capacity(V(y(8) - y(10))) * (yd(8) - yd(10));
  const V q1410 = N::capacity(V(y(14) - y(10))) * (yd(14) - yd(10));
  F[0] = N::CGS * (yd(1) - yd(5)) + (y(1) - y(5)) * gS + i1;
  F[1] = N::CGD * (yd(2) - yd(5)) + (y(2) - N::VDD) * gD - i1;
  F[2] = q35 + (y(3) - N::VBB) * gBS - i35;
  F[3] = N::capacity(V(y(4) - N::VDD)) * yd(4) + (y(4) - N::VBB) * gBD - i4;
  F[4] = N::CGS * (yd(5) - yd(1)) + N::CGD * (yd(5) - yd(2)) - q35 - q95 + N::C9 * yd(5) + (y(5) - y(1)) * gS + i35 +
         (y(5) - y(7)) * gD + i95;
  F[5] = N::CGS * (yd(6) - in.V1_slope) + (y(6) - y(10)) * gS + i2;
  F[6] = N::CGD * (yd(7) - in.V1_slope) + (y(7) - y(5)) * gD - i2;
  F[7] = q810 + (y(8) - N::VBB) * gBS - i810;
  F[8] = q95 + (y(9) - N::VBB) * gBD - i95;
  F[9] = -q810 - q1410 + N::C9 * yd(10) + (y(10) - y(6)) * gS + i810 + (y(10) - y(12)) * gD + i1410;
  F[10] = N::CGS * (yd(11) - in.V2_slope) + y(11) * gS + i3;
  F[11] = N::CGD * (yd(12) - in.V2_slope) + (y(12) - y(10)) * gD - i3;
  F[12] = N::capacity(y(13)) * yd(13) + (y(13) - N::VBB) * gBS - i13;
  F[13] = q1410 + (y(14) - N::VBB) * gBD - i1410;
}

inline TestProblem nand() {
  TestProblem p{.name = "nand", .m = 14, .n = 14, .values = {0, 14, 0, 0, 0}, .t0 = 0.0, .tf = 80.0};
  p.x0 = {5.0, 5.0, -2.5, -2.5, 5.0, 3.62385, 5.0, -2.5, -2.5, 3.62385, 0.0, 3.62385, -2.5, -2.5};
  p.xdot0.assign(14, 0.0);
  p.references = {{80.0,
                   {0.4971088699385777e+1, 0.4999752103929311e+1, -0.2499998781491227e+1, -0.2499999999999975e+1,
                    0.4970837023296724e+1, -0.2091214032073855e+0, 0.4970593243278363e+1, -0.2500077409198803e+1,
                    -0.2499998781491227e+1, -0.2090289583878100e+0, -0.2399999999966269e-3, -0.2091214032073855e+0,
                    -0.2499999999999991e+1, -0.2500077409198803e+1}}};
  p.counted = {4};
  for (int k = 1; k < 16; ++k) p.restarts.push_back(5.0 * k);
  return p;
}

}  // namespace sfdae_test

#endif
