// SPDX-License-Identifier: BSD-3-Clause
//
// Random piecewise linear systems with a surface, as mixed up differential-algebraic equations of strangeness index
// 1, against Runge and Kutta's method of order 4 with small steps for the differential equations that they hide, with
// Filippov's field along the surface.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <sfdae/hybrid.hpp>
#include <string>
#include <vector>

#include "family_run.h"
#include "random_sliding.h"

namespace {

using namespace sfdae_test::sliding;

sfdae::Solver solver_of(const Sample& sample, int side, const sfdae::Options& options) {
  sfdae::NonlinearProblem problem(n, n);
  problem.equations = [&sample, side](const auto&, auto y, auto ydot, auto F) {
    const auto k = static_cast<std::size_t>(side);
    std::vector<sfdae::Expression> x(n, 0.0), xdot(n, 0.0), G(n, 0.0);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        x[i] = x[i] + sample.columns[i][j] * y[static_cast<int>(j)];
        xdot[i] = xdot[i] + sample.columns[i][j] * ydot[static_cast<int>(j)];
      }
    const auto of = [&](const Vector& a) { return a[0] * x[0] + a[1] * x[1] + a[2] * x[2]; };
    for (std::size_t i = 0; i < 3; ++i) G[i] = xdot[i] - of(sample.A[i]) - sample.b[i] - sample.k[i] * x[3];
    G[3] = x[3] - of(sample.p[k]) - sample.r[k];
    G[4] = x[4] - of(sample.q);
    G[5] = xdot[4] - x[5];
    for (std::size_t i = 0; i < n; ++i) {
      sfdae::Expression sum = 0.0;
      for (std::size_t j = 0; j < n; ++j) sum = sum + sample.rows[i][j] * G[j];
      F[static_cast<int>(i)] = sum;
    }
  };
  return sfdae::Solver(problem, options);
}

struct Outcome {
  double error = 0.0, disturbed = 0.0;  // in tolerances: the latter of the solution disturbed by one again and again
  std::string failure;
};

double distance(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  double most = 0.0;
  for (std::size_t j = 0; j < n; ++j)
    most = std::max(most, std::fabs(a[j] - b[j]) / (tolerance * (1.0 + std::fabs(b[j]))));
  return most;
}

Outcome run(const Sample& sample, int method, double tolerance, Reference& reference) {
  constexpr int outputs = 10;
  std::mt19937 random(5);
  sfdae::Options options;
  options.rtol = options.atol = tolerance;
  options.method = method;
  sfdae::Solver below = solver_of(sample, 0, options), above = solver_of(sample, 1, options);
  sfdae::Hybrid hybrid;
  hybrid.add_mode(below);
  hybrid.add_mode(above);
  const auto surface = [&sample](const auto&, auto y) {
    sfdae::Expression g = sample.h;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < n; ++j) g = g + sample.c[i] * sample.columns[i][j] * y[static_cast<int>(j)];
    return g;
  };
  Outcome outcome;
  Reference disturbed = reference;
  sfdae::Point point{0.0, mixed(sample, reference.values()), {}};
  try {
    hybrid.add_switch(0, 1, surface);
    hybrid.start(reference.mode(), point, sample.time);
    for (int k = 1; k <= outputs; ++k) {
      const double t = sample.time * k / outputs;
      hybrid.advance(t, point);
      disturbed.disturb(tolerance, random);
      if (!reference.advance(t) || !disturbed.advance(t)) break;
      if (reference.has_changed_near(t) || disturbed.has_changed_near(t)) continue;
      const std::vector<double> y = mixed(sample, reference.values());
      outcome.error = std::max(outcome.error, distance(point.x, y, tolerance));
      outcome.disturbed = std::max(outcome.disturbed, distance(mixed(sample, disturbed.values()), y, tolerance));
    }
  } catch (const sfdae::Error& error) {
    outcome.failure = error.what();
  }
  return outcome;
}

TEST(RandomSliding, AgreesWithFilippovsSolutions) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    std::mt19937 random(77);
    const int count = sfdae_test::scaled_count(200);
    int sliding = 0, crossing = 0, failed = 0, wrong = 0, above_ten = 0;
    double largest = 0.0;
    for (int k = 0; k < count; ++k) {
      const Sample sample = random_sample(random);
      Reference reference(sample);
      const Outcome outcome = run(sample, method, 1e-6, reference);
      if (!outcome.failure.empty()) {
        ++failed;
        std::printf("%d: %s\n", k, outcome.failure.c_str());
        continue;
      }
      if (reference.visits_to_surface() > 0) ++sliding;
      else if (!reference.changes().empty()) ++crossing;
      largest = std::max(largest, outcome.error / std::max(1.0, outcome.disturbed));
      if (outcome.error > 10.0) ++above_ten;
      if (outcome.error > 10.0 * std::max(1.0, outcome.disturbed)) {
        ++wrong;
        std::printf("%d: %.3g tolerances, disturbed %.3g, %zu changes\n", k, outcome.error, outcome.disturbed,
                    reference.changes().size());
      }
    }
    std::printf(
        "%s: %d slide, %d cross, %d failed, %d above 10 tolerances; largest error against that of a disturbance "
        "%.3g\n",
        method == SFDAE_METHOD_BDF ? "BDF" : "Radau", sliding, crossing, failed, above_ten, largest);
    EXPECT_EQ(failed, 0);
    EXPECT_EQ(wrong, 0);
    EXPECT_GE(sliding, count / 4);
    EXPECT_GE(crossing, count / 20);
  }
}

}  // namespace
