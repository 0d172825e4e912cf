// SPDX-License-Identifier: BSD-3-Clause
// Chemical reaction of Akzo Nobel [TS]: five concentrations and one equilibrium, mu = 0. x2 >= 0.
#ifndef SFDAE_TESTS_AKZO_H
#define SFDAE_TESTS_AKZO_H

#include "scalar.h"
#include "test_problem.h"

namespace sfdae_test {

struct Akzo {
  static constexpr double k1 = 18.7, k2 = 0.58, k3 = 0.09, k4 = 0.42, K = 34.4, klA = 3.3, Ks = 115.83, pCO2 = 0.9,
                          H = 737.0;
};

template <class V>
void akzo_residual(const V&, const V* x, const V* xdot, V* F) {
  using std::sqrt;
  using A = Akzo;
  const V root = sqrt(x[1]);
  const V r1 = A::k1 * square(square(x[0])) * root, r2 = A::k2 * x[2] * x[3], r3 = A::k2 / A::K * x[0] * x[4];
  const V r4 = A::k3 * x[0] * square(x[3]), r5 = A::k4 * square(x[5]) * root;
  const V inflow = A::klA * (A::pCO2 / A::H - x[1]);
  F[0] = xdot[0] - (-2.0 * r1 + r2 - r3 - r4);
  F[1] = xdot[1] - (-0.5 * r1 - r4 - 0.5 * r5 + inflow);
  F[2] = xdot[2] - (r1 - r2 + r3);
  F[3] = xdot[3] - (-r2 + r3 - 2.0 * r4);
  F[4] = xdot[4] - (r2 - r3 + r5);
  F[5] = A::Ks * x[0] * x[3] - x[5];
}

inline TestProblem akzo() {
  TestProblem p{.name = "akzo", .m = 6, .n = 6, .values = {0, 5, 1, 0, 0}, .t0 = 0.0, .tf = 180.0};
  p.x0 = {0.444, 0.00123, 0.0, 0.007, 0.0, Akzo::Ks * 0.444 * 0.007};
  // The residuals at x' = 0 are -x' of the first five; the last follows from the equilibrium.
  const std::vector<double> zero(6, 0.0);
  p.xdot0.assign(6, 0.0);
  akzo_residual(0.0, p.x0.data(), zero.data(), p.xdot0.data());
  for (double& slope : p.xdot0) slope = -slope;
  p.xdot0[5] = Akzo::Ks * (p.xdot0[0] * p.x0[3] + p.x0[0] * p.xdot0[3]);
  p.references = {
      {180.0,
       {1.15079492066170218616774756e-01, 1.20383147156771509267113113e-03, 1.61156288740797420964298114e-01,
        3.65615642124928301713487255e-04, 1.70801088526440407137817164e-02, 4.87353131030745512934131615e-03}}};
  p.counted = first_components(6);
  return p;
}

}  // namespace sfdae_test

#endif
