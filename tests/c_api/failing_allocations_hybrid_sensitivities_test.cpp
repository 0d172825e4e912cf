// SPDX-License-Identifier: BSD-3-Clause
//
// Memory that is missing where sensitivities are carried over transitions of hybrid systems: every call whose allocations fail,
// once or from then on, leaves what it has, parameters too, and goes on when it is made again.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "failing_allocations.h"
#include "sfdae/hybrid.h"

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

// They are joined at x_0 = level, and apart again, with twice the voltage x_0, at t = 2, from where x_0 soon reaches the level.
int discharged(double, const double* x, const double*, double* g, void*) {
  *g = level - x[0];
  return 0;
}
int double_voltage(double, int, int, const double*, double* after, void*) {
  after[0] *= 2.0;
  after[2] = 0.0;
  return 0;
}

struct Course {
  sfdae_solver* solvers[2] = {nullptr, nullptr};
  sfdae_hybrid* hybrid = nullptr;
  double t = 0.0, x[3] = {1, 0, 0}, S[6] = {}, dt[2] = {};
  std::vector<double> checkpoint;

  explicit Course(int method) {
    static const int sides[] = {0, 1};
    sfdae_options options;
    sfdae_options_init(&options, sizeof options);
    options.method = method;
    options.rtol = options.atol = 1e-5;
    sfdae_nonlinear_problem problem;
    sfdae_nonlinear_problem_init(&problem, sizeof problem);
    problem.num_equations = problem.num_unknowns = 3;
    problem.equations = capacitors;
    EXPECT_EQ(sfdae_create_hybrid(&hybrid), SFDAE_OK);
    for (int k = 0; k < 2; ++k) {
      problem.user = const_cast<int*>(&sides[k]);
      EXPECT_EQ(sfdae_create_nonlinear(&solvers[k], &problem, &options), SFDAE_OK);
      EXPECT_EQ(sfdae_add_mode(hybrid, solvers[k], nullptr, nullptr), SFDAE_OK);
    }
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
  Course(const Course&) = delete;
  Course& operator=(const Course&) = delete;
  ~Course() {
    EXPECT_EQ(sfdae_destroy_hybrid(&hybrid), SFDAE_OK);
    for (sfdae_solver*& solver : solvers) EXPECT_EQ(sfdae_destroy(&solver), SFDAE_OK);
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
      case 6: {
        std::size_t length = 0;
        const int status = sfdae_get_hybrid_checkpoint_length(hybrid, &length);
        const bool was_armed = allocations.armed;
        allocations.armed = false;
        checkpoint.resize(length);
        allocations.armed = was_armed;
        return status < 0 ? status : sfdae_save_hybrid_checkpoint(hybrid, checkpoint.data(), length);
      }
      case 7: return sfdae_restore_hybrid_checkpoint(hybrid, checkpoint.data(), checkpoint.size());
      default: return sfdae_get_hybrid_sensitivities(hybrid, t, S, nullptr);
    }
  }
};

// Runs with the allocation number `first` of a call failing. False if it has fewer.
bool survives(int method, int failing, long first, bool all_later, const Course& expected) {
  SCOPED_TRACE("call " + std::to_string(failing) + ", allocation " + std::to_string(first) +
               (all_later ? " and later" : ""));
  const long blocks = allocations.blocks;
  bool happened = false;
  {
    Course run(method);
    for (int k = 0; k < Course::count; ++k) {
      if (k == failing) {
        allocations.seen = allocations.failed = 0;
        allocations.first = first;
        allocations.all_later = all_later;
        const int status = armed([&] { return run.call(k); });
        allocations.first = 0;
        happened = allocations.failed > 0;
        for (sfdae_solver* solver : run.solvers) {
          double value = 0.0;
          EXPECT_EQ(sfdae_get_parameter(solver, "C", &value), SFDAE_OK);
          EXPECT_EQ(value, C);
        }
        if (status >= 0) continue;
        EXPECT_EQ(status, SFDAE_OUT_OF_MEMORY) << sfdae_get_hybrid_message(run.hybrid);
        // What was under way may have ended.
        if (k == Course::first_advance || k == Course::second_advance) {
          run.x[0] = 1.0;
          run.x[1] = run.x[2] = run.t = 0.0;
          EXPECT_EQ(run.call(Course::start), SFDAE_OK);
        }
      }
      EXPECT_GE(run.call(k), SFDAE_OK) << k << ": " << sfdae_get_hybrid_message(run.hybrid);
    }
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(run.x[i], expected.x[i], 1e-4);
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(run.S[i], expected.S[i], 1e-4);
    for (int j = 0; j < 2; ++j) EXPECT_NEAR(run.dt[j], expected.dt[j], 1e-4);
  }
  if (!testing::Test::HasFailure()) {
    EXPECT_EQ(allocations.blocks, blocks) << "not given back";
  }
  return happened;
}

class Methods : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(FailingAllocations, Methods, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

// x_0 = exp(-t / C) reaches the level at C log(1 / level) and, with start value v, C log(v / level).
TEST_P(Methods, WithSensitivitiesOfHybridSystems) {
  Course expected(GetParam());
  for (int k = 0; k < Course::count; ++k)
    ASSERT_EQ(expected.call(k), SFDAE_OK) << k << ": " << sfdae_get_hybrid_message(expected.hybrid);
  EXPECT_NEAR(expected.dt[0], std::log(1.0 / level), 1e-3);
  EXPECT_NEAR(expected.dt[1], C, 1e-3);
  long passages = 0;
  sfdae_get_num_passages(expected.hybrid, &passages);
  EXPECT_EQ(passages, 3);
  const long stride = stride_of_faults(24);
  long faults = 0;
  for (int k = 0; k < Course::count && !HasFailure(); ++k)
    for (long first = 1;; first += first < 40 ? 1 : stride) {
      const bool once = survives(GetParam(), k, first, false, expected),
                 always = survives(GetParam(), k, first, true, expected);
      faults += (once ? 1 : 0) + (always ? 1 : 0);
      if (HasFailure() || (!once && !always)) break;
    }
  std::printf("%ld faults\n", faults);
  EXPECT_GT(faults, 300);
}

}  // namespace
}  // namespace sfdae::test
