// Memory that is missing where sensitivities are computed.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <vector>

#include "calls_on_a_handle.h"
#include "sfdae/sfdae.h"

namespace sfdae::test {
namespace {

class SensitivityMethods : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(FailingAllocations, SensitivityMethods,
                         testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

// A pendulum that is driven by a table: integrations start anew at its kinks.
int pendulum_with_a_table(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                          const sfdae_expression* xdot, sfdae_expression* F, void*) {
  static const double times[] = {-1.0, 0.0, 0.4, 1.0, 2.0}, forces[] = {0.0, 0.5, 0.0, 1.0, 0.0};
  const sfdae_expression g = sfdae_parameter(record, "g", 2.0);
  for (int i = 0; i < 2; ++i) {
    F[i] = sfdae_subtract(xdot[i], x[i + 2]);
    F[i + 2] = sfdae_add(xdot[i + 2], sfdae_multiply(x[i], x[4]));
  }
  F[3] = sfdae_add(F[3], sfdae_multiply(g, sfdae_table(t, 1, 5, times, forces)));
  F[4] = sfdae_subtract(sfdae_add(sfdae_multiply(x[0], x[0]), sfdae_multiply(x[1], x[1])), sfdae_number(1.0));
  return 0;
}

int create_pendulum_with_a_table(sfdae_solver** solver, const sfdae_options& options) {
  return create_recorded(solver, options, 5, pendulum_with_a_table);
}

Call set_sensitivities() {
  return {"set_sensitivities", [](Session& s) {
            const char* const names[] = {"g", nullptr};
            const double directions[] = {0, 0, 0, 0, 0, 0, 1, 0, 0, 0};
            return armed([&] { return sfdae_set_sensitivities(s.solver, 2, names, directions, nullptr); });
          }};
}

Call sensitivities() {
  return {"get_sensitivities", [](Session& s) {
            std::vector<double> S(10, -7.0), Sdot(10, -7.0);
            const int status = armed([&] { return sfdae_get_sensitivities(s.solver, s.t, S.data(), Sdot.data()); });
            if (status < 0) {
              EXPECT_EQ(S, std::vector<double>(10, -7.0));
              return status;
            }
            s.result = S;
            s.result.insert(s.result.end(), Sdot.begin(), Sdot.end());
            return status;
          }};
}

TEST_P(SensitivityMethods, WithSensitivities) {
  const std::vector<double> x = {1.0, 0.0, 0.0, 0.0, 0.0};
  // Several tolerances: what has lost its linearization has other errors of iterations.
  run_with_faults({"sensitivities",
                   x,
                   {create_call(create_pendulum_with_a_table, options_of(GetParam(), 1e-3)), set_sensitivities(),
                    start("start", x), advance("advance", 0.3), sensitivities(), advance("across a kink", 0.7),
                    sensitivities(), advance("to the end", 1.0)},
                   1e-2});
}

Call keep_steps(long max_kept_steps = 0) {
  return {"keep steps", [max_kept_steps](Session& s) {
            const char* const names[] = {"g", nullptr};
            const double directions[] = {0, 0, 0, 0, 0, 0, 1, 0, 0, 0};
            sfdae_sensitivity_options options;
            sfdae_sensitivity_options_init(&options, sizeof options);
            options.adjoint = 1;
            options.max_kept_steps = max_kept_steps;
            return armed([&] { return sfdae_set_sensitivities(s.solver, 2, names, directions, &options); });
          }};
}

Call gradient() {
  return {"get_gradient", [](Session& s) {
            // One of them within a step.
            const double times[] = {0.3, 0.61, s.t}, weights[] = {1, 0, 0, 0, 0, 0, 0, 3, 0, 1, 0, 1, 0, 0, 2};
            std::vector<double> result(2, -7.0);
            const int status =
                armed([&] { return sfdae_get_gradient(s.solver, 3, times, 1, weights, result.data()); });
            if (status < 0) {
              EXPECT_EQ(result, std::vector<double>(2, -7.0));
              return status;
            }
            s.result = result;
            return status;
          }};
}

TEST_P(SensitivityMethods, WithGradients) {
  const std::vector<double> x = {1.0, 0.0, 0.0, 0.0, 0.0};
  run_with_faults({"gradients",
                   x,
                   {create_call(create_pendulum_with_a_table, options_of(GetParam(), 1e-3)), keep_steps(),
                    start("start", x), advance("advance", 0.3), advance("across a kink", 0.7), gradient()},
                   1e-2});
}

TEST_P(SensitivityMethods, WithGradientsOfStepsThatAreMadeAgain) {
  const std::vector<double> x = {1.0, 0.0, 0.0, 0.0, 0.0};
  run_with_faults({"gradients from checkpoints",
                   x,
                   {create_call(create_pendulum_with_a_table, options_of(GetParam(), 1e-3)), keep_steps(2),
                    start("start", x), advance("advance", 0.3), advance("across a kink", 0.7), gradient()},
                   1e-2});
}

}  // namespace
}  // namespace sfdae::test
