// Recorded equations: values and gradients of Taylor coefficients for two multibody systems.
// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "recorded.h"

namespace {

using namespace sfdae::core;
using namespace sfdae_test;

// x' = v, v' = -lambda x - (0, g), x^2 + y^2 = 1
std::shared_ptr<const Record> pendulum() {
  Recording recording(5);
  const auto& x = recording.x;
  const auto& xdot = recording.xdot;
  return recording.finish({xdot[0] - x[2], xdot[1] - x[3], xdot[2] + x[4] * x[0], xdot[3] + x[4] * x[1] + 9.81,
                           x[0] * x[0] + x[1] * x[1] - 1.0});
}

// Andrews' squeezing mechanism, index 3, n = 27: q' = v, v' = w, 0 = M(q) w - f(q, v) + G(q)^T lambda, 0 = g(q).
// Test Set for IVP Solvers, problem "andrews".
struct Andrews {
  static constexpr double m1 = .04325, m2 = .00365, m3 = .02373, m4 = .00706, m5 = .07050, m6 = .00706, m7 = .05498;
  static constexpr double i1 = 2.194e-6, i2 = 4.410e-7, i3 = 5.255e-6, i4 = 5.667e-7, i5 = 1.169e-5, i6 = 5.667e-7,
                          i7 = 1.912e-5;
  static constexpr double xa = -.06934, ya = -.00227, xb = -.03635, yb = .03273, xc = .014, yc = .072, c0 = 4530;
  static constexpr double d = .028, da = .0115, e = .02, ea = .01421, rr = .007, ra = .00092, l0 = .07785, ss = .035;
  static constexpr double sa = .01874, sb = .01043, sc = .018, sd = .02, ta = .02308, tb = .00916, u = .04,
                          ua = .01228;
  static constexpr double ub = .00449, zf = .02, zt = .04, fa = .01421, mom = .033, ee = e - ea, zz = zf - fa;

  explicit Andrews(Recording& recording)
      : q(recording.x.begin(), recording.x.begin() + 7),
        v(recording.x.begin() + 7, recording.x.begin() + 14),
        w(recording.x.begin() + 14, recording.x.begin() + 21),
        lambda(recording.x.begin() + 21, recording.x.end()) {}

  std::vector<Term> mass_times_w() const {
    const Term cos_Th = cos(q[1]), sin_Ph = sin(q[3]), sin_Om = sin(q[5]);
    const Term M11 = m1 * ra * ra + m2 * (rr * rr - 2 * da * rr * cos_Th + da * da) + i1 + i2;
    const Term M21 = m2 * (da * da - da * rr * cos_Th) + i2;
    const Term M54 = m4 * (ee * ee + zt * ee * sin_Ph) + i4;
    const Term M55 = m4 * (zt * zt + 2 * zt * ee * sin_Ph + ee * ee) + m5 * (ta * ta + tb * tb) + i4 + i5;
    const Term M76 = m6 * (zz * zz - u * zz * sin_Om) + i6;
    const Term M77 = m6 * (zz * zz - 2 * u * zz * sin_Om + u * u) + m7 * (ua * ua + ub * ub) + i6 + i7;
    return {M11 * w[0] + M21 * w[1],
            M21 * w[0] + (m2 * da * da + i2) * w[1],
            (m3 * (sa * sa + sb * sb) + i3) * w[2],
            (m4 * ee * ee + i4) * w[3] + M54 * w[4],
            M54 * w[3] + M55 * w[4],
            (m6 * zz * zz + i6) * w[5] + M76 * w[6],
            M76 * w[5] + M77 * w[6]};
  }

  std::vector<Term> forces() const {
    const Term sin_ga = sin(q[2]), cos_ga = cos(q[2]);
    const Term x = sd * cos_ga + sc * sin_ga + xb - xc, y = sd * sin_ga - sc * cos_ga + yb - yc;
    const Term L = sqrt(x * x + y * y), F = -c0 * (L - l0) / L, Fx = F * x, Fy = F * y;
    return {mom - m2 * da * rr * v[1] * (v[1] + 2 * v[0]) * sin(q[1]),
            m2 * da * rr * v[0] * v[0] * sin(q[1]),
            Fx * (sc * cos_ga - sd * sin_ga) + Fy * (sd * cos_ga + sc * sin_ga),
            m4 * zt * ee * v[4] * v[4] * cos(q[3]),
            -m4 * zt * ee * v[3] * (v[3] + 2 * v[4]) * cos(q[3]),
            -m6 * u * zz * v[6] * v[6] * cos(q[5]),
            m6 * u * zz * v[5] * (v[5] + 2 * v[6]) * cos(q[5])};
  }

  std::vector<Term> constraints() const {
    const Term be = q[0], ga = q[2], de = q[4], ep = q[6], beTh = q[0] + q[1], Phde = q[3] + q[4], Omep = q[5] + q[6];
    const Term x = rr * cos(be) - d * cos(beTh), y = rr * sin(be) - d * sin(beTh);
    return {x - ss * sin(ga) - xb,
            y + ss * cos(ga) - yb,
            x - e * sin(Phde) - zt * cos(de) - xa,
            y + e * cos(Phde) - zt * sin(de) - ya,
            x - zf * cos(Omep) - u * sin(ep) - xa,
            y - zf * sin(Omep) + u * cos(ep) - ya};
  }

  // G^T lambda
  std::vector<Term> constraint_forces() const {
    const Term be = q[0], ga = q[2], de = q[4], ep = q[6], beTh = q[0] + q[1], Phde = q[3] + q[4], Omep = q[5] + q[6];
    const Term lx = lambda[0] + lambda[2] + lambda[4], ly = lambda[1] + lambda[3] + lambda[5];
    const Term Th = d * sin(beTh) * lx - d * cos(beTh) * ly;
    const Term Ph = -e * cos(Phde) * lambda[2] - e * sin(Phde) * lambda[3];
    const Term Om = zf * sin(Omep) * lambda[4] - zf * cos(Omep) * lambda[5];
    return {Th - rr * sin(be) * lx + rr * cos(be) * ly,
            Th,
            -ss * cos(ga) * lambda[0] - ss * sin(ga) * lambda[1],
            Ph,
            Ph + zt * sin(de) * lambda[2] - zt * cos(de) * lambda[3],
            Om,
            Om - u * cos(ep) * lambda[4] - u * sin(ep) * lambda[5]};
  }

  std::vector<Term> q, v, w, lambda;
};

std::shared_ptr<const Record> andrews() {
  Recording recording(27);
  const Andrews mechanism(recording);
  const auto mass = mechanism.mass_times_w(), f = mechanism.forces(), reaction = mechanism.constraint_forces();
  std::vector<Term> F;
  for (std::size_t i = 0; i < 7; ++i) F.push_back(recording.xdot[i] - mechanism.v[i]);
  for (std::size_t i = 0; i < 7; ++i) F.push_back(recording.xdot[i + 7] - mechanism.w[i]);
  for (std::size_t i = 0; i < 7; ++i) F.push_back(mass[i] - f[i] + reaction[i]);
  for (const Term& g : mechanism.constraints()) F.push_back(g);
  return recording.finish(F);
}

struct Case {
  Case(std::shared_ptr<const Record> equations, int highest)
      : record(std::move(equations)), evaluator(record), order(highest) {
    const auto m = static_cast<std::size_t>(record->m()), n = static_cast<std::size_t>(record->n());
    const auto columns = static_cast<std::size_t>(order) + 2;
    for (std::size_t i = 0; i < n * columns; ++i) jet.push_back(0.1 + std::sin(static_cast<double>(i)));
    F.resize(m * columns);
    F_xdot.resize(m * n * columns);
    F_x.resize(m * n * columns);
  }
  std::shared_ptr<const Record> record;
  TaylorEvaluator evaluator;
  int order;
  std::vector<double> jet, F, F_xdot, F_x;
};

Case make_case(const benchmark::State& state) {
  return {state.range(0) == 0 ? pendulum() : andrews(), static_cast<int>(state.range(1))};
}

// Arguments: 0 pendulum, 1 Andrews' squeezer; order.
void values(benchmark::State& state) {
  Case c = make_case(state);
  for (auto _ : state)
    if (!c.evaluator.values(0.0, c.jet.data(), c.order, c.F.data())) std::abort();
}
BENCHMARK(values)->ArgsProduct({{0, 1}, {0, 1, 2, 3, 5, 8}});

void gradients(benchmark::State& state) {
  Case c = make_case(state);
  const SeriesOrders orders{c.order, c.order, c.order};
  for (auto _ : state)
    if (!c.evaluator.gradients(0.0, c.jet.data(), orders, c.F.data(), c.F_xdot.data(), c.F_x.data())) std::abort();
}
BENCHMARK(gradients)->ArgsProduct({{0, 1}, {0, 1, 2, 3, 5, 8}});

}  // namespace

BENCHMARK_MAIN();
