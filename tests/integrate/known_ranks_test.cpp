// SPDX-License-Identifier: BSD-3-Clause
// Known ranks hold, in steps and at outputs, until a change is certain.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "sfdae/sfdae.h"

namespace {

constexpr double ln10 = 2.302585092994046, half_pi = 1.5707963267948966;

// x1' = -x1, e(t) x2' = -x2 + cos t - e(t) sin t: x2 = cos t with e = 10^(-4 - depth sin^2(pi t / 2)).
struct Layer {
  double depth;
  double e(double t, int order) const {
    const double value = std::pow(10.0, -4.0 - depth * std::pow(std::sin(half_pi * t), 2));
    const double slope = -ln10 * depth * half_pi * std::sin(2.0 * half_pi * t);
    return order == 0 ? value : value * slope;
  }
  static const Layer& of(void* user) { return *static_cast<Layer*>(user); }
};

int write_E(double t, int order, double* E, void* user) {
  if (order > 1) return SFDAE_ORDER_NOT_AVAILABLE;
  E[0] = order == 0 ? 1.0 : 0.0;
  E[3] = Layer::of(user).e(t, order);
  return 0;
}
int write_A(double, int order, double* A, void*) {
  if (order == 0) A[0] = A[3] = -1.0;
  return 0;
}
int write_f(double t, int order, double* f, void* user) {
  const Layer& layer = Layer::of(user);
  const double e = layer.e(t, 0);
  if (order > 1) return SFDAE_ORDER_NOT_AVAILABLE;
  f[1] = order == 0 ? std::cos(t) - e * std::sin(t) : -std::sin(t) - e * std::cos(t) - layer.e(t, 1) * std::sin(t);
  return 0;
}

int solve(Layer layer, int method, int outputs, std::string& message) {
  sfdae_linear_problem problem;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 2;
  problem.E = write_E;
  problem.A = write_A;
  problem.f = write_f;
  problem.constant_A = 1;
  problem.user = &layer;
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.method = method;
  sfdae_solver* solver = nullptr;
  EXPECT_EQ(sfdae_create_linear(&solver, &problem, &options), SFDAE_OK);
  double t = 0.0, x[] = {1.0, 1.0};
  int status = sfdae_start(solver, 0.0, 2.0, x, nullptr);
  for (int i = 1; i <= outputs && status == SFDAE_OK; ++i) {
    status = sfdae_advance(solver, 2.0 * i / outputs, &t, x, nullptr);
    if (status != SFDAE_OK) break;
    EXPECT_NEAR(x[0], std::exp(-t), 2e-5);
    EXPECT_NEAR(x[1], std::cos(t), 2e-5);
  }
  message = sfdae_message(solver);
  sfdae_destroy(&solver);
  return status;
}

}  // namespace

// e falls to between 1e-8 and 3e-15 and rises again: a rank that is decided there alone is unclear in the end.
TEST(KnownRanks, HoldWhereAFreshDecisionIsUnclear) {
  for (const double depth : {4.0, 8.0, 10.0, 10.5})
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
      for (const int outputs : {1, 10, 100}) {
        std::string message;
        EXPECT_EQ(solve({depth}, method, outputs, message), SFDAE_OK)
            << depth << ", method " << method << ", " << outputs << " outputs: " << message;
      }
}

// e falls to 1e-24: the equation becomes algebraic.
TEST(KnownRanks, EndWhereAChangeIsCertain) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (const int outputs : {1, 100}) {
      std::string message;
      EXPECT_EQ(solve({20.0}, method, outputs, message), SFDAE_CHARACTERISTICS_CHANGED) << message;
    }
}
