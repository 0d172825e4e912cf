// SPDX-License-Identifier: BSD-3-Clause
//
// Sensitivities along surfaces that both sides lead to, over where the motion begins and ends there, against formulas
// whose parameters are moved.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "sliding_system.h"

namespace {

using sfdae::Expression;
using sfdae::Matrix;
using sfdae_test::derivative;
using sfdae_test::Equations;
using sfdae_test::Values;
using System = sfdae_test::SlidingSystem;

class SlidingSensitivities : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, SlidingSensitivities,
                         testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU, SFDAE_METHOD_AUTOMATIC));

// ---- Fields that are constant ------------------------------------------------------------------------------------

// x' = x > y + level ? -a : b,  y' = y + level > x ? -d : c,  as 217/238 with a = 2, b = 2, c = 3/2, d = 3.
Equations corner(int above) {
  return [above](const Expression& t, auto, auto xdot, auto F) {
    F[0] = xdot[0] - (above ? -sfdae::parameter(t, "a", 2) : sfdae::parameter(t, "b", 2));
    F[1] = xdot[1] - (above ? sfdae::parameter(t, "c", 1.5) : -sfdae::parameter(t, "d", 3));
  };
}
Expression difference(const Expression& t, sfdae::ConstExpressions x) {
  return x[0] - x[1] - sfdae::parameter(t, "level", 0);
}
// p: a, b, c, d, level, x_0 at the start.
double corner_met(const Values& p) { return (p[5] - 1 - p[4]) / (p[0] + p[2]); }
Values corner_values(double t, const Values& p) {
  const double met = corner_met(p), below = p[1] + p[3], above = -p[0] - p[2];
  const double s = below / (below - above), x = p[5] - p[0] * met + (t - met) * (s * -p[0] + (1 - s) * p[1]);
  return {x, x - p[4]};
}

TEST_P(SlidingSensitivities, AreThoseOfConstantFields) {
  for (const bool by_adjoint : {false, true}) {
    System system(2, corner, difference, sfdae_test::solver_options(1e-10, GetParam()), by_adjoint);
    system.point = {0, {1.5, 1}, {}};
    system.ask({"a", "b", "c", "d", "level", ""}, {-1, -1, -1, -1, -1, 0});
    system.start(1, 1);
    const Values p{2, 2, 1.5, 3, 0, 1.5};
    EXPECT_EQ(system.hybrid.advance_to_transition(1, system.point), SFDAE_EVENT);
    system.compare(system.point.t, p, corner_values, 1e-8);
    system.compare_time(p, corner_met, 1e-8);
    system.compare(0.6, p, corner_values, 1e-8);
    system.compare(1, p, corner_values, 1e-8);
    EXPECT_EQ(system.modes(), "2");
    if (by_adjoint) continue;
    EXPECT_NE(system.hybrid.report().find("6 sensitivities are carried over"), std::string::npos);
    // S' is that of x' along the surface.
    const Matrix slopes = system.hybrid.sensitivities(1).Sdot;
    const auto slope = [](double, const Values& q) {
      const double below = q[1] + q[3], above = -q[0] - q[2], s = below / (below - above);
      return Values{s * -q[0] + (1 - s) * q[1]};
    };
    for (int j = 0; j < 6; ++j)
      EXPECT_NEAR(slopes(0, j), derivative(slope, 0, p, static_cast<std::size_t>(j))[0], 1e-8) << j;
  }
}

// A start along the surface has directions for x alone; what they violate is put right.
TEST_P(SlidingSensitivities, BeginOnTheSurface) {
  for (const int how : {SFDAE_INITIAL_NEAREST, SFDAE_INITIAL_ACCEPT}) {
    sfdae::Options options = sfdae_test::solver_options(1e-10, GetParam());
    options.initial_values = how;
    for (const bool by_adjoint : {false, true}) {
      System system(2, corner, difference, options, by_adjoint);
      system.point = {0, {1, 1}, {}};
      system.ask({"a", "b", "c", "d", ""}, {-1, -1, -1, -1, 0});
      system.start(2, 1);
      // x_0 and y move together by half of the direction.
      const Matrix S = by_adjoint ? system.gradients(0) : system.hybrid.sensitivities(0).S;
      EXPECT_NEAR(S(0, 4), 0.5, 1e-9);
      EXPECT_NEAR(S(1, 4), 0.5, 1e-9);
      const auto values = [](double t, const Values& p) {
        const double below = p[1] + p[3], above = -p[0] - p[2], s = below / (below - above);
        const double x = 1 + 0.5 * (p[4] - 1) + t * (s * -p[0] + (1 - s) * p[1]);
        return Values{x, x};
      };
      system.compare(0.7, {2, 2, 1.5, 3, 1}, values, 1e-8);
    }
  }
}

// ---- Where it is left --------------------------------------------------------------------------------------------

// A mass with friction mu on a base of velocity A sin(w t): v' = -sign(v - A sin w t) mu.
Equations on_base(int above) {
  return [above](const Expression& t, auto, auto xdot, auto F) {
    const Expression mu = sfdae::parameter(t, "mu", 0.5);
    F[0] = xdot[0] + (above ? mu : -mu);
  };
}
Expression slip(const Expression& t, sfdae::ConstExpressions x) {
  return x[0] - sfdae::parameter(t, "A", 1) * sin(sfdae::parameter(t, "w", 1) * t);
}
double zero_of(const std::function<double(double)>& f, double t) {
  for (int k = 0; k < 60; ++k) t -= f(t) * 2e-6 / (f(t + 1e-6) - f(t - 1e-6));
  return t;
}
// p: mu, A, w.
double sticks(const Values& p) {
  return zero_of([&](double t) { return p[0] * t - p[1] * std::sin(p[2] * t); }, 1.9);
}
double is_loose(const Values& p) { return std::acos(-p[0] / (p[1] * p[2])) / p[2]; }
double after(const Values& p, double t) { return p[1] * std::sin(p[2] * is_loose(p)) - p[0] * (t - is_loose(p)); }
double sticks_again(const Values& p) {
  return zero_of([&](double t) { return after(p, t) - p[1] * std::sin(p[2] * t); }, 5.0);
}
Values on_base_values(double t, const Values& p) {
  if (t < sticks(p)) return {p[0] * t};
  if (t < is_loose(p)) return {p[1] * std::sin(p[2] * t)};
  return {after(p, t)};
}

TEST_P(SlidingSensitivities, GoOnWhereAModeLeadsAway) {
  for (const bool by_adjoint : {false, true}) {
    System system(1, on_base, slip, sfdae_test::solver_options(1e-10, GetParam()), by_adjoint);
    system.point = {0, {0}, {}};
    system.ask({"mu", "A", "w"});
    system.start(0, 6);
    const Values p{0.5, 1, 1};
    system.compare(1, p, on_base_values, 1e-8);
    system.compare(2, p, on_base_values, 1e-8);
    system.compare_time(p, sticks, 1e-7);
    EXPECT_EQ(system.hybrid.current_mode(), 2);
    system.compare(3, p, on_base_values, 1e-7);
    system.compare_time(p, is_loose, 1e-6);
    EXPECT_EQ(system.hybrid.current_mode(), 1);
    system.compare(4, p, on_base_values, 1e-7);
    EXPECT_EQ(system.modes(), "21");
    while (system.hybrid.num_passages() < 3) system.hybrid.advance_to_transition(6, system.point);
    system.compare_time(p, sticks_again, 1e-6);
  }
}

// ---- Fields that lead through ------------------------------------------------------------------------------------

// x' = 1, then 2 + k y, y' = 1, at x = level: crossed at t = level, with S that jumps.
TEST_P(SlidingSensitivities, CrossTheSurface) {
  const auto through = [](int above) -> Equations {
    return [above](const Expression& t, auto x, auto xdot, auto F) {
      F[0] = xdot[0] - (above ? 2 + sfdae::parameter(t, "k", 0.7) * x[1] : 1 + 0 * x[1]);
      F[1] = xdot[1] - 1;
    };
  };
  const auto surface = [](const Expression& t, auto x) { return x[0] - sfdae::parameter(t, "level", 1); };
  for (const bool by_adjoint : {false, true}) {
    System system(2, through, surface, sfdae_test::solver_options(1e-10, GetParam()), by_adjoint);
    system.point = {0, {0, 0}, {}};
    system.ask({"k", "level"});
    system.start(0, 3);
    const auto values = [](double t, const Values& p) {
      return Values{p[1] + 2 * (t - p[1]) + 0.5 * p[0] * (t * t - p[1] * p[1])};
    };
    system.compare(2, {0.7, 1}, values, 1e-8);
    system.compare_time(
        {0.7, 1}, [](const Values& p) { return p[1]; }, 1e-8);
    EXPECT_EQ(system.modes(), "1");
  }
}

// ---- Constraints -------------------------------------------------------------------------------------------------

// x'' = u = -U sign(x + k v), u an unknown: along x + k v = 0 x is x_1 exp(-(t - t_1) / k), and u follows.
TEST_P(SlidingSensitivities, AreThoseOfTheEquivalentControl) {
  const auto relay = [](int above) -> Equations {
    return [above](const Expression& t, auto x, auto xdot, auto F) {
      const Expression U = sfdae::parameter(t, "U", 1);
      F[0] = xdot[0] - x[1];
      F[1] = xdot[1] - x[2];
      F[2] = x[2] - (above ? -U : U);
    };
  };
  const auto surface = [](const Expression& t, auto x) { return x[0] + sfdae::parameter(t, "k", 1) * x[1]; };
  const auto met = [](const Values& p) { return -p[0] + std::sqrt(p[0] * p[0] + 2 * p[2] / p[1]); };
  const auto values = [&](double t, const Values& p) {
    const double x = p[0] * p[1] * met(p) * std::exp(-(t - met(p)) / p[0]);
    return Values{x, -x / p[0], x / (p[0] * p[0])};
  };
  for (const bool by_adjoint : {false, true}) {
    System system(3, relay, surface, sfdae_test::solver_options(1e-10, GetParam()), by_adjoint);
    system.point = {0, {0.5, 0, -1}, {}};
    system.ask({"k", "U", ""}, {-1, -1, 0});
    system.start(1, 5);
    const Values p{1, 1, 0.5};
    system.compare(0.8, p, values, 1e-7);
    system.compare_time(p, met, 1e-8);
    system.compare(3, p, values, 1e-7);
    EXPECT_EQ(system.modes(), "2");
    EXPECT_EQ(system.hybrid.mode(2).strangeness_index, 1);
  }
}

// A point on the unit circle with friction and a torque of (t - 2) rise from t = 2 on, by position and multiplier: it
// turns from angle 1 by 1 / (2 friction), rests, and turns again from 2 + friction / rise on.
Equations on_circle(int above) {
  return [above](const Expression& t, auto x, auto xdot, auto F) {
    const Expression friction = sfdae::parameter(t, "friction", 0.5), rise = sfdae::parameter(t, "rise", 0.5);
    const Expression moment = (above ? -friction : friction) + rise * max(t - 2.5, 0.0);
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = xdot[2] + 2 * x[0] * x[4] + moment * x[1];
    F[3] = xdot[3] + 2 * x[1] * x[4] - moment * x[0];
    F[4] = x[0] * x[0] + x[1] * x[1] - 1;
  };
}

TEST_P(SlidingSensitivities, AreThoseOfRestOnACircle) {
  const auto turning = [](const auto&, auto x) { return x[0] * x[3] - x[1] * x[2]; };
  for (const bool by_adjoint : {false, true}) {
    System system(5, on_circle, turning, sfdae_test::solver_options(1e-9, GetParam()), by_adjoint);
    const double c = std::cos(1.0), s = std::sin(1.0);
    system.point = {0, {c, s, -s, c, 0.5}, {}};
    system.ask({"friction", "rise"});
    system.start(1, 5);
    const Values p{0.5, 0.5};
    const auto again = [](const Values& q) { return 2.5 + q[0] / q[1]; };
    const auto values = [&](double t, const Values& q) {
      const double stops = 1 / q[0], since = t - again(q);
      double angle = 1 + (t < stops ? t - 0.5 * q[0] * t * t : 0.5 / q[0]), rate = t < stops ? 1 - q[0] * t : 0;
      if (since > 0) angle += q[1] * since * since * since / 6, rate = 0.5 * q[1] * since * since;
      return Values{std::cos(angle), std::sin(angle), -rate * std::sin(angle), rate * std::cos(angle),
                    0.5 * rate * rate};
    };
    system.compare(1, p, values, 1e-6);
    system.compare(2.4, p, values, 1e-6);
    system.compare_time(
        p, [](const Values& q) { return 1 / q[0]; }, 1e-7);
    EXPECT_EQ(system.hybrid.current_mode(), 2);
    system.compare(4.5, p, values, 1e-6);
    EXPECT_EQ(system.modes(), "21");
    system.compare_time(p, again, 1e-5);
    EXPECT_EQ(system.hybrid.mode(1).strangeness_index, 2);
    EXPECT_GE(system.hybrid.mode(2).strangeness_index, 2);
  }
}

}  // namespace
