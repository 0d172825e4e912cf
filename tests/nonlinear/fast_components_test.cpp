// SPDX-License-Identifier: BSD-3-Clause
// Events of algebraic components that vary many times within a step, which is as long as the differential ones allow.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "nonlinear_run.h"

namespace {

using namespace sfdae_test;

constexpr double pi = 3.14159265358979323846;

// tau x1' = -x1, x2 = sin(w t) - x1, with x2 = 0 as the event: almost two in each period.
NonlinearEquations equations(double tau, double w) {
  return equations_of(2, 2, [=](const auto& t, const auto* x, const auto* xdot, auto* F) {
    F[0] = tau * xdot[0] + x[0];
    F[1] = x[1] + x[0] - sin(w * t);
  });
}

// In their order, by bisection on a fine grid; x1(0) = 0.5.
std::vector<double> exact_events(double tau, double w, double end) {
  const auto g = [=](double t) { return std::sin(w * t) - 0.5 * std::exp(-t / tau); };
  std::vector<double> result;
  const double step = 0.01 * 2.0 * pi / w;
  for (double a = 0.0; a < end; a += step) {
    double low = a, high = std::fmin(a + step, end);
    if (!(g(low) * g(high) < 0.0)) continue;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      (g(low) * g(middle) <= 0.0 ? high : low) = middle;
    }
    result.push_back(low);
  }
  return result;
}

// x2 itself, or a function of it that is not defined where polynomials of long steps go.
int crossing(double, const double* x, const double*, double* g, void*) {
  g[0] = x[1];
  return 0;
}
int crossing_by_root(double, const double* x, const double*, double* g, void*) {
  g[0] = x[1] + 1.6 < 0.0 ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(x[1] + 1.6) - std::sqrt(1.6);
  return 0;
}

std::vector<double> found_events(int method, double tau, double w, double end, sfdae_event_function g = crossing) {
  sfdae_options options = options_with(1e-8, method);
  NonlinearRun run(equations(tau, w), options);
  EXPECT_EQ(run.created, SFDAE_OK);
  EXPECT_EQ(sfdae_set_events(run.solver(), 1, g, nullptr, nullptr), SFDAE_OK);
  std::vector<double> result;
  int status = run.start(0.0, end, {0.5, -0.5});
  while (status >= 0) {
    status = run.advance(end);
    if (status != SFDAE_EVENT) break;
    result.push_back(run.t);
  }
  EXPECT_EQ(status, SFDAE_OK) << status_text(run, status);
  return result;
}

}  // namespace

// A step of either method covers up to a hundred of them. One in fifty at most is missed, by a step whose polynomial
// agrees with the solution where it is looked at; none is invented.
TEST(FastComponents, CrossZeroManyTimesWithinSteps) {
  const double end = 100.0;
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (const double tau : {1.0, 10.0, 1000.0})
      for (const double w : {2.0 * pi, 1.3, 9.0}) {
        const std::vector<double> exact = exact_events(tau, w, end), found = found_events(method, tau, w, end);
        EXPECT_GE(found.size(), exact.size() - exact.size() / 50) << "method " << method << ", " << tau << ", " << w;
        for (const double t : found) {
          double nearest = end;
          for (const double event : exact) nearest = std::fmin(nearest, std::fabs(event - t));
          EXPECT_LE(nearest, 1e-6) << "method " << method << ", " << tau << ", " << w << ", t = " << t;
        }
      }
}

TEST(FastComponents, CrossZeroWhereFunctionsAreNotDefinedBesideTheSolution) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (const double tau : {1.0, 10.0, 1000.0})
      for (const double w : {2.0 * pi, 9.0}) {
        const std::size_t count = exact_events(tau, w, 100.0).size();
        const std::size_t found = found_events(method, tau, w, 100.0, crossing_by_root).size();
        EXPECT_GE(found, count - count / 50) << "method " << method << ", " << tau << ", " << w;
        EXPECT_LE(found, count) << "method " << method << ", " << tau << ", " << w;
      }
}

namespace {

struct Calls {
  bool with_noise;
  int count = 0, events = 0;
};

// x2, and what is nothing but rounding errors on the solution.
int crossing_with_noise(double t, const double* x, const double*, double* g, void* user) {
  Calls& calls = *static_cast<Calls*>(user);
  ++calls.count;
  g[0] = x[1];
  if (calls.with_noise) g[1] = x[1] + x[0] - std::sin(2.0 * pi * t);
  return 0;
}

Calls calls_of(int method, double tau, bool with_noise) {
  Calls calls{with_noise};
  const double end = 20.0;
  sfdae_options options = options_with(1e-8, method);
  NonlinearRun run(equations(tau, 2.0 * pi), options);
  EXPECT_EQ(sfdae_set_events(run.solver(), with_noise ? 2 : 1, crossing_with_noise, nullptr, &calls), SFDAE_OK);
  int status = run.start(0.0, end, {0.5, -0.5});
  while (status >= 0 && (status = run.advance(end)) == SFDAE_EVENT) ++calls.events;
  EXPECT_EQ(status, SFDAE_OK) << status_text(run, status);
  return calls;
}

}  // namespace

// No polynomial follows rounding errors: if they counted, all steps would be searched at as many points as there can
// be.
TEST(FastComponents, AreNotSoughtAmongRoundingErrors) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (const double tau : {1.0, 1000.0}) {
      const Calls alone = calls_of(method, tau, false), with_noise = calls_of(method, tau, true);
      EXPECT_EQ(with_noise.events, alone.events);
      EXPECT_LT(with_noise.count, 6 * alone.count) << "method " << method << ", " << tau;
    }
}
