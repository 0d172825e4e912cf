// SPDX-License-Identifier: BSD-3-Clause
//
// Memory that is missing where sensitivities go along a surface: every call whose allocations fail, once or from then
// on, goes on when it is made again.
#include <gtest/gtest.h>

#include "failing_allocations_hybrid.h"

namespace sfdae::test {
namespace {

constexpr double rate = 2.0, height = 0.5;

// x' = -rate or rate above and below x = height; y' = -x or y.
int toward(sfdae_record* record, sfdae_expression, const sfdae_expression* x, const sfdae_expression* xdot,
           sfdae_expression* F, void* user) {
  const bool above = *static_cast<const int*>(user) != 0;
  const sfdae_expression k = sfdae_parameter(record, "rate", rate);
  F[0] = above ? sfdae_add(xdot[0], k) : sfdae_subtract(xdot[0], k);
  F[1] = above ? sfdae_add(xdot[1], x[0]) : sfdae_subtract(xdot[1], x[1]);
  return 0;
}
int surface(sfdae_record* record, sfdae_expression, const sfdae_expression* x, const sfdae_expression*,
            sfdae_expression* g, void*) {
  g[0] = sfdae_subtract(x[0], sfdae_parameter(record, "height", height));
  return 0;
}

struct SlidingCourse : HybridCourse {
  double x[2] = {1, 1}, S[6] = {}, dt[3] = {};

  explicit SlidingCourse(int method) {
    create(2, toward, method);
    EXPECT_EQ(sfdae_add_switch(hybrid, 0, 1, surface, nullptr, "along", nullptr), SFDAE_OK);
  }

  static constexpr int count = 8, start = 1, first_advance = 2, second_advance = 4;
  int call(int k) {
    static const char* const names[] = {"rate", "height", nullptr};
    static const double directions[] = {0, 0, 0, 0, 0, 1};
    switch (k) {
      case 0: return sfdae_set_hybrid_sensitivities(hybrid, 3, names, directions, nullptr);
      case start: return sfdae_start_hybrid(hybrid, 1, 0, 4, x, nullptr);
      case first_advance: return sfdae_advance_hybrid(hybrid, 0.5, &t, x, nullptr);
      case 3: return sfdae_get_passage_sensitivities(hybrid, dt);
      case second_advance: return sfdae_advance_hybrid(hybrid, 1, &t, x, nullptr);
      case 5: return save();
      case 6: return restore();
      default: return sfdae_get_hybrid_sensitivities(hybrid, t, S, nullptr);
    }
  }
};

struct AlongASurface {
  int method;
  const SlidingCourse& expected;

  SlidingCourse course() const { return SlidingCourse(method); }
  void look(const SlidingCourse&) const {}
  // What was under way may have ended.
  void repair(SlidingCourse& run, int k) const {
    if (k != SlidingCourse::first_advance && k != SlidingCourse::second_advance) return;
    run.x[0] = run.x[1] = 1.0;
    run.t = 0.0;
    EXPECT_EQ(run.call(SlidingCourse::start), SFDAE_OK);
  }
  void compare(const SlidingCourse& run) const {
    for (int i = 0; i < 2; ++i) EXPECT_NEAR(run.x[i], expected.x[i], 1e-4);
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(run.S[i], expected.S[i], 1e-4);
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(run.dt[j], expected.dt[j], 1e-4);
  }
};

class SlidingMethods : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(FailingAllocations, SlidingMethods, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

// The surface is met after (1 - height) / rate, and x = height from there on.
TEST_P(SlidingMethods, WithSensitivitiesAlongASurface) {
  SlidingCourse expected(GetParam());
  for (int k = 0; k < SlidingCourse::count; ++k)
    ASSERT_EQ(expected.call(k), SFDAE_OK) << k << ": " << sfdae_get_hybrid_message(expected.hybrid);
  EXPECT_NEAR(expected.dt[0], -(1.0 - height) / (rate * rate), 1e-4);
  EXPECT_NEAR(expected.dt[1], -1.0 / rate, 1e-4);
  EXPECT_NEAR(expected.S[2], 1.0, 1e-4);
  let_allocations_fail(AlongASurface{GetParam(), expected}, SlidingCourse::count, stride_of_faults(24));
}

}  // namespace
}  // namespace sfdae::test
