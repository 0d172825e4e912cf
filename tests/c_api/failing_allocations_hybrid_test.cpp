// SPDX-License-Identifier: BSD-3-Clause
//
// Memory that is missing in hybrid systems: every call whose allocations fail, once or from then on, leaves what it
// has, and goes on when it is made again.
#include <gtest/gtest.h>

#include <algorithm>

#include "failing_allocations_hybrid.h"

namespace sfdae::test {
namespace {

// A mass with friction on a base of velocity t (2 - t): it sticks and slips; beside it, the rate of the base by a
// constraint.
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

struct Course : HybridCourse {
  double x[3] = {0, 0, 2};

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

  static constexpr int count = 8;
  int call(int k) {
    switch (k) {
      case 0: return sfdae_add_mode(hybrid, solvers[0], "below", nullptr);
      case 1: return sfdae_add_mode(hybrid, solvers[1], "above", nullptr);
      case 2: return sfdae_add_switch(hybrid, 0, 1, slip, nullptr, "a name longer than short strings hold", nullptr);
      case 3: return sfdae_start_hybrid(hybrid, 0, 0, 4, x, nullptr);
      case 4: return sfdae_advance_hybrid(hybrid, 1.6, &t, x, nullptr);
      case 5: return save();
      case 6: return restore();
      default: return sfdae_advance_hybrid(hybrid, 3, &t, x, nullptr);
    }
  }
};

struct InHybridSystems {
  double expected[3] = {};

  Course course() const { return {}; }
  void look(const Course&) const {}
  void repair(Course& run, int k) const {
    if ((k != 4 && k != 7) || goes_on(run, k)) return;
    run.x[0] = run.x[1] = run.t = 0;
    EXPECT_EQ(run.call(3), SFDAE_OK);
  }
  void compare(const Course& run) const {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(run.x[i], expected[i], 1e-4);
  }
};

TEST(FailingAllocations, InHybridSystems) {
  // t / 2 until the base is as slow, and along with it while it turns by 1/2 a unit of time at most.
  InHybridSystems test;
  {
    Course run;
    for (int k = 0; k < Course::count; ++k) ASSERT_EQ(run.call(k), SFDAE_OK) << sfdae_get_hybrid_message(run.hybrid);
    std::copy(run.x, run.x + 3, test.expected);
    long passages = 0;
    sfdae_get_num_passages(run.hybrid, &passages);
    EXPECT_GE(passages, 1);
  }
  let_allocations_fail(test, Course::count, stride_of_faults(8));
}

}  // namespace
}  // namespace sfdae::test
