// SPDX-License-Identifier: BSD-3-Clause
//
// Memory that is missing in hybrid systems: every call whose allocations fail, once or from then on, leaves what it has, and
// goes on when it is made again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "failing_allocations.h"
#include "sfdae/hybrid.h"

namespace sfdae::test {
namespace {

// A mass with friction on a base of velocity t (2 - t): it sticks and slips; beside it, the rate of the base by a constraint.
int on_base(sfdae_record*, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
            sfdae_expression* F, void* user) {
  const int above = *static_cast<const int*>(user);
  F[0] = sfdae_subtract(xdot[0], sfdae_number(above != 0 ? -0.5 : 0.5));
  F[1] = sfdae_subtract(x[1], sfdae_multiply(t, sfdae_subtract(sfdae_number(2), t)));
  F[2] = sfdae_subtract(xdot[1], x[2]);
  return 0;
}

int slip(sfdae_record*, sfdae_expression, const sfdae_expression* x, const sfdae_expression*, sfdae_expression* g,
         void*) {
  g[0] = sfdae_subtract(x[0], x[1]);
  return 0;
}

struct Course {
  sfdae_solver* solvers[2] = {nullptr, nullptr};
  sfdae_hybrid* hybrid = nullptr;
  double t = 0.0, x[3] = {0, 0, 2};
  std::vector<double> checkpoint;

  Course() {
    static const int sides[] = {0, 1};
    sfdae_nonlinear_problem problem;
    sfdae_nonlinear_problem_init(&problem, sizeof problem);
    problem.num_equations = problem.num_unknowns = 3;
    problem.equations = on_base;
    for (int k = 0; k < 2; ++k) {
      problem.user = const_cast<int*>(&sides[k]);
      EXPECT_EQ(sfdae_create_nonlinear(&solvers[k], &problem, nullptr), SFDAE_OK);
    }
    EXPECT_EQ(sfdae_create_hybrid(&hybrid), SFDAE_OK);
  }
  Course(const Course&) = delete;
  Course& operator=(const Course&) = delete;
  ~Course() {
    EXPECT_EQ(sfdae_destroy_hybrid(&hybrid), SFDAE_OK);
    for (sfdae_solver*& solver : solvers) EXPECT_EQ(sfdae_destroy(&solver), SFDAE_OK);
  }

  static constexpr int count = 8;
  int call(int k) {
    switch (k) {
      case 0: return sfdae_add_mode(hybrid, solvers[0], "below", nullptr);
      case 1: return sfdae_add_mode(hybrid, solvers[1], "above", nullptr);
      case 2: return sfdae_add_switch(hybrid, 0, 1, slip, nullptr, "a name longer than short strings hold", nullptr);
      case 3: return sfdae_start_hybrid(hybrid, 0, 0, 4, x, nullptr);
      case 4: return sfdae_advance_hybrid(hybrid, 1.6, &t, x, nullptr);
      case 5: {
        std::size_t length = 0;
        const int status = sfdae_get_hybrid_checkpoint_length(hybrid, &length);
        const bool was_armed = allocations.armed;
        allocations.armed = false;
        checkpoint.resize(length);
        allocations.armed = was_armed;
        return status < 0 ? status : sfdae_save_hybrid_checkpoint(hybrid, checkpoint.data(), length);
      }
      case 6: return sfdae_restore_hybrid_checkpoint(hybrid, checkpoint.data(), checkpoint.size());
      default: return sfdae_advance_hybrid(hybrid, 3, &t, x, nullptr);
    }
  }
};

// Runs with the allocation number `first` of a call failing. False if it has fewer.
bool survives(int failing, long first, bool all_later, const double* expected) {
  SCOPED_TRACE("call " + std::to_string(failing) + ", allocation " + std::to_string(first) +
               (all_later ? " and later" : ""));
  const long blocks = allocations.blocks;
  bool happened = false;
  {
    Course run;
    for (int k = 0; k < Course::count; ++k) {
      if (k == failing) {
        allocations.seen = allocations.failed = 0;
        allocations.first = first;
        allocations.all_later = all_later;
        const int status = armed([&] { return run.call(k); });
        allocations.first = 0;
        happened = allocations.failed > 0;
        if (status >= 0) continue;
        EXPECT_EQ(status, SFDAE_OUT_OF_MEMORY) << sfdae_get_hybrid_message(run.hybrid);
        // What was under way may have ended.
        if (k == 4 || k == 7) {
          run.x[0] = run.x[1] = run.t = 0;
          EXPECT_EQ(run.call(3), SFDAE_OK);
        }
      }
      EXPECT_GE(run.call(k), SFDAE_OK) << k << ": " << sfdae_get_hybrid_message(run.hybrid);
    }
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(run.x[i], expected[i], 1e-4);
  }
  if (!testing::Test::HasFailure()) {
    EXPECT_EQ(allocations.blocks, blocks) << "not given back";
  }
  return happened;
}

TEST(FailingAllocations, InHybridSystems) {
  // t / 2 until the base is as slow, and along with it while it turns by 1/2 a unit of time at most.
  double expected[3] = {};
  {
    Course run;
    for (int k = 0; k < Course::count; ++k) ASSERT_EQ(run.call(k), SFDAE_OK) << sfdae_get_hybrid_message(run.hybrid);
    std::copy(run.x, run.x + 3, expected);
    long passages = 0;
    sfdae_get_num_passages(run.hybrid, &passages);
    EXPECT_GE(passages, 1);
  }
  const long stride = stride_of_faults(8);
  long faults = 0;
  for (int k = 0; k < Course::count && !HasFailure(); ++k)
    for (long first = 1;; first += first < 40 ? 1 : stride) {
      const bool once = survives(k, first, false, expected), always = survives(k, first, true, expected);
      faults += (once ? 1 : 0) + (always ? 1 : 0);
      if (HasFailure() || (!once && !always)) break;
    }
  std::printf("%ld faults\n", faults);
  EXPECT_GT(faults, 300);
}

}  // namespace
}  // namespace sfdae::test
