// Hybrid systems of two modes whose calls run out of memory: what courses of calls have in common.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "failing_allocations.h"
#include "sfdae/hybrid.h"

namespace sfdae::test {

// Two solvers and the system of which they are modes; courses derived from it make them and have int call(int k), k =
// 0, ..., count - 1.
struct HybridCourse {
  sfdae_solver* solvers[2] = {nullptr, nullptr};
  sfdae_hybrid* hybrid = nullptr;
  double t = 0.0;
  std::vector<double> checkpoint;

  HybridCourse() = default;
  HybridCourse(const HybridCourse&) = delete;
  HybridCourse& operator=(const HybridCourse&) = delete;
  ~HybridCourse() {
    EXPECT_EQ(sfdae_destroy_hybrid(&hybrid), SFDAE_OK);
    for (sfdae_solver*& solver : solvers) EXPECT_EQ(sfdae_destroy(&solver), SFDAE_OK);
  }

  // Modes with these equations, whose `user` is the number of the mode, an int.
  void create(int n, sfdae_equations_function equations, int method) {
    static const int numbers[] = {0, 1};
    sfdae_options options;
    sfdae_options_init(&options, sizeof options);
    options.method = method;
    options.rtol = options.atol = 1e-5;
    sfdae_nonlinear_problem problem;
    sfdae_nonlinear_problem_init(&problem, sizeof problem);
    problem.num_equations = problem.num_unknowns = n;
    problem.equations = equations;
    EXPECT_EQ(sfdae_create_hybrid(&hybrid), SFDAE_OK);
    for (int k = 0; k < 2; ++k) {
      problem.user = const_cast<int*>(&numbers[k]);
      EXPECT_EQ(sfdae_create_nonlinear(&solvers[k], &problem, &options), SFDAE_OK);
      EXPECT_EQ(sfdae_add_mode(hybrid, solvers[k], nullptr, nullptr), SFDAE_OK);
    }
  }

  // The test's own memory does not count.
  int save() {
    std::size_t length = 0;
    const int status = sfdae_get_hybrid_checkpoint_length(hybrid, &length);
    const bool was_armed = allocations.armed;
    allocations.armed = false;
    checkpoint.resize(length);
    allocations.armed = was_armed;
    return status < 0 ? status : sfdae_save_hybrid_checkpoint(hybrid, checkpoint.data(), length);
  }
  int restore() { return sfdae_restore_hybrid_checkpoint(hybrid, checkpoint.data(), checkpoint.size()); }
};

// After a call that ran out of memory: whether what was under way goes on, which the test's results have to show
// then, or has ended.
template <class Course>
bool goes_on(Course& run, int k) {
  const int status = run.call(k);
  EXPECT_TRUE(status >= 0 || status == SFDAE_NOT_STARTED) << sfdae_get_hybrid_message(run.hybrid);
  return status >= 0;
}

// A test has course(), a new one; look(course) after the call that ran out of memory, repair(course, k) before that
// one is made again, and compare(course) at the end.
//
// Runs with the allocation number `first` of a call failing. False if it has fewer.
template <class Test>
bool survives(const Test& test, int failing, long first, bool all_later) {
  SCOPED_TRACE("call " + std::to_string(failing) + ", allocation " + std::to_string(first) +
               (all_later ? " and later" : ""));
  const long blocks = allocations.blocks;
  bool happened = false;
  {
    auto run = test.course();
    for (int k = 0; k < run.count; ++k) {
      if (k == failing) {
        allocations.seen = allocations.failed = 0;
        allocations.first = first;
        allocations.all_later = all_later;
        const int status = armed([&] { return run.call(k); });
        allocations.first = 0;
        happened = allocations.failed > 0;
        test.look(run);
        if (status >= 0) continue;
        EXPECT_EQ(status, SFDAE_OUT_OF_MEMORY) << sfdae_get_hybrid_message(run.hybrid);
        test.repair(run, k);
      }
      EXPECT_GE(run.call(k), SFDAE_OK) << k << ": " << sfdae_get_hybrid_message(run.hybrid);
    }
    test.compare(run);
  }
  if (!testing::Test::HasFailure()) {
    EXPECT_EQ(allocations.blocks, blocks) << "not given back";
  }
  return happened;
}

// Lets the allocations of `count` calls fail one by one, beyond the first 40 of each some of them.
template <class Test>
void let_allocations_fail(const Test& test, int count, long stride) {
  long faults = 0;
  for (int k = 0; k < count && !testing::Test::HasFailure(); ++k)
    for (long first = 1;; first += first < 40 ? 1 : stride) {
      const bool once = survives(test, k, first, false), always = survives(test, k, first, true);
      faults += (once ? 1 : 0) + (always ? 1 : 0);
      if (testing::Test::HasFailure() || (!once && !always)) break;
    }
  std::printf("%ld faults\n", faults);
  EXPECT_GT(faults, 300);
}

}  // namespace sfdae::test
