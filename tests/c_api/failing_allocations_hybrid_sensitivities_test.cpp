// SPDX-License-Identifier: BSD-3-Clause
//
// Memory that is missing where sensitivities are carried over transitions of hybrid systems: every call whose
// allocations fail, once or from then on, leaves what it has, parameters too, and goes on when it is made again.
#include <gtest/gtest.h>

#include <cmath>

#include "failing_allocations_hybrid.h"

namespace sfdae::test {
namespace {

constexpr double C = 2.0, level = 0.5;

// Two capacitors, the first one discharged by a resistor, apart or joined: x = (voltages, current between them).
int capacitors(sfdae_record* record, sfdae_expression, const sfdae_expression* x, const sfdae_expression* xdot,
               sfdae_expression* F, void* user) {
  const bool joined = *static_cast<const int*>(user) != 0;
  const sfdae_expression capacity = sfdae_parameter(record, "C", C);
  F[0] = sfdae_add(sfdae_multiply(capacity, xdot[0]), sfdae_add(x[0], x[2]));
  F[1] = sfdae_subtract(xdot[1], x[2]);
  F[2] = joined ? sfdae_subtract(x[0], x[1]) : x[2];
  return 0;
}

// They are joined at x_0 = level, and apart again, with twice the voltage x_0, at t = 2, from where x_0 soon reaches
// the level.
int discharged(double, const double* x, const double*, double* g, void*) {
  *g = level - x[0];
  return 0;
}
int double_voltage(double, int, int, const double*, double* after, void*) {
  after[0] *= 2.0;
  after[2] = 0.0;
  return 0;
}

struct SensitivityCourse : HybridCourse {
  double x[3] = {1, 0, 0}, S[6] = {}, dt[2] = {};

  explicit SensitivityCourse(int method) {
    create(3, capacitors, method);
    for (int k = 0; k < 2; ++k) {
      sfdae_transition transition;
      sfdae_transition_init(&transition, sizeof transition);
      transition.from = k;
      transition.to = 1 - k;
      transition.kind = k == 0 ? SFDAE_TRANSITION_ZERO : SFDAE_TRANSITION_TIME;
      transition.function = k == 0 ? discharged : nullptr;
      transition.time = 2.0;
      transition.jump = k == 0 ? nullptr : double_voltage;
      EXPECT_EQ(sfdae_add_transition(hybrid, &transition, nullptr), SFDAE_OK);
    }
  }

  static constexpr int count = 9, start = 1, first_advance = 2, second_advance = 5;
  int call(int k) {
    static const char* const names[] = {"C", nullptr};
    static const double directions[] = {0, 0, 0, 1, 0, 0};
    switch (k) {
      case 0: return sfdae_set_hybrid_sensitivities(hybrid, 2, names, directions, nullptr);
      case start: return sfdae_start_hybrid(hybrid, 0, 0, 4, x, nullptr);
      case first_advance: return sfdae_advance_hybrid(hybrid, 1.6, &t, x, nullptr);
      case 3: return sfdae_get_passage_sensitivities(hybrid, dt);
      case 4: return sfdae_get_hybrid_sensitivities(hybrid, t, S, nullptr);
      case second_advance: return sfdae_advance_hybrid(hybrid, 2.5, &t, x, nullptr);
      case 6: return save();
      case 7: return restore();
      default: return sfdae_get_hybrid_sensitivities(hybrid, t, S, nullptr);
    }
  }
};

struct WithSensitivities {
  int method;
  const SensitivityCourse& expected;

  SensitivityCourse course() const { return SensitivityCourse(method); }
  void look(const SensitivityCourse& run) const {
    for (sfdae_solver* solver : run.solvers) {
      double value = 0.0;
      EXPECT_EQ(sfdae_get_parameter(solver, "C", &value), SFDAE_OK);
      EXPECT_EQ(value, C);
    }
  }
  void repair(SensitivityCourse& run, int k) const {
    if ((k != SensitivityCourse::first_advance && k != SensitivityCourse::second_advance) || goes_on(run, k)) return;
    run.x[0] = 1.0;
    run.x[1] = run.x[2] = run.t = 0.0;
    EXPECT_EQ(run.call(SensitivityCourse::start), SFDAE_OK);
  }
  void compare(const SensitivityCourse& run) const {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(run.x[i], expected.x[i], 1e-4);
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(run.S[i], expected.S[i], 1e-4);
    for (int j = 0; j < 2; ++j) EXPECT_NEAR(run.dt[j], expected.dt[j], 1e-4);
  }
};

// By the adjoint: of earlier visits there are checkpoints.
struct AdjointCourse : SensitivityCourse {
  double gradient[4] = {};

  explicit AdjointCourse(int method) : SensitivityCourse(method) {}
  static constexpr int count = 6;
  int call(int k) {
    static const char* const names[] = {"C", nullptr};
    static const double directions[] = {0, 0, 0, 1, 0, 0}, times[] = {1.6, 2.5};
    static const double weights[] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0};
    switch (k) {
      case 0: {
        sfdae_sensitivity_options how;
        sfdae_sensitivity_options_init(&how, sizeof how);
        how.adjoint = 1;
        how.max_kept_steps = 3;
        return sfdae_set_hybrid_sensitivities(hybrid, 2, names, directions, &how);
      }
      case start:
      case first_advance: return SensitivityCourse::call(k);
      case 3: return sfdae_advance_hybrid(hybrid, 2.5, &t, x, nullptr);
      default: return sfdae_get_hybrid_gradient(hybrid, 2, times, 2, weights, gradient);
    }
  }
};

struct WithAdjoint {
  int method;
  const AdjointCourse& expected;

  AdjointCourse course() const { return AdjointCourse(method); }
  void look(const AdjointCourse& run) const { WithSensitivities{method, expected}.look(run); }
  void repair(AdjointCourse& run, int k) const {
    if ((k != 2 && k != 3) || goes_on(run, k)) return;
    run.x[0] = 1.0;
    run.x[1] = run.x[2] = run.t = 0.0;
    EXPECT_EQ(run.call(SensitivityCourse::start), SFDAE_OK);
    if (k == 3) {
      EXPECT_EQ(run.call(SensitivityCourse::first_advance), SFDAE_OK);
    }
  }
  void compare(const AdjointCourse& run) const {
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(run.gradient[i], expected.gradient[i], 1e-4);
  }
};

class HybridMethods : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(FailingAllocations, HybridMethods, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

// x_0 = exp(-t / C) reaches the level at C log(1 / level) and, with start value v, C log(v / level).
TEST_P(HybridMethods, WithSensitivitiesOfHybridSystems) {
  SensitivityCourse expected(GetParam());
  for (int k = 0; k < SensitivityCourse::count; ++k)
    ASSERT_EQ(expected.call(k), SFDAE_OK) << k << ": " << sfdae_get_hybrid_message(expected.hybrid);
  EXPECT_NEAR(expected.dt[0], std::log(1.0 / level), 1e-3);
  EXPECT_NEAR(expected.dt[1], C, 1e-3);
  long passages = 0;
  sfdae_get_num_passages(expected.hybrid, &passages);
  EXPECT_EQ(passages, 3);
  let_allocations_fail(WithSensitivities{GetParam(), expected}, SensitivityCourse::count, stride_of_faults(24));
}

TEST_P(HybridMethods, WithTheAdjointOfHybridSystems) {
  AdjointCourse expected(GetParam());
  for (int k = 0; k < AdjointCourse::count; ++k)
    ASSERT_EQ(expected.call(k), SFDAE_OK) << k << ": " << sfdae_get_hybrid_message(expected.hybrid);
  long passages = 0;
  sfdae_get_num_passages(expected.hybrid, &passages);
  EXPECT_EQ(passages, 3);
  let_allocations_fail(WithAdjoint{GetParam(), expected}, AdjointCourse::count, stride_of_faults(60));
}

}  // namespace
}  // namespace sfdae::test
