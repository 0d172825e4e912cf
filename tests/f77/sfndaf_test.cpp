// SPDX-License-Identifier: BSD-3-Clause
// SFNDAF: the same solutions as SFNDAE, for INTEGERs of both widths, and the same refusals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "sfndae_problems.h"
#include "sfndaf_run.h"

using namespace sfdae_test;

namespace {

class SfndafMethods : public testing::TestWithParam<int> {
 protected:
  template <class Run>
  Run run_of(const KnownNonlinear& problem) const {
    Run run(problem.equations, GetParam(), 5, problem.max_index);
    run.set_x(problem.start);
    return run;
  }

  template <class I>
  void expect_as_sfndae(const KnownNonlinear& problem) const {
    auto by_order = run_of<SfndaeRun<I>>(problem);
    auto by_array = run_of<SfndafRun<I>>(problem);
    for (int k = 0; k <= 4; ++k) {
      const double tout = 0.4 * k;
      ASSERT_EQ(by_array.call(tout), k == 0 ? 4 : 3) << k;
      ASSERT_EQ(by_order.call(tout), k == 0 ? 4 : 3) << k;
      EXPECT_EQ(by_array.characteristics(), problem.characteristics);
      EXPECT_EQ(by_array.iwarn, by_order.iwarn);
      // F_x' of all these problems is constant, so that its derivatives are zero in the array, too.
      EXPECT_EQ(by_array.values(), by_order.values()) << k;
      EXPECT_EQ(by_array.slopes(), by_order.slopes()) << k;
    }
    EXPECT_EQ(by_array.iwork(11), by_order.iwork(11));
    EXPECT_EQ(by_array.iwork(12), by_order.iwork(12));
    EXPECT_EQ(by_array.user.highest_order, by_order.user.highest_order);
    EXPECT_TRUE(by_array.user.arguments_are_right);
    EXPECT_TRUE(by_array.guards_intact());
    if (problem.characteristics[0] > 0) {
      EXPECT_LT(by_array.user.calls, by_order.user.calls);
    }
  }
};

std::vector<KnownNonlinear> known_problems() {
  return {pendulum_problem(), path_control(), nonlinear_ode(), free_nonlinear_component(), redundant_equation()};
}

}  // namespace

INSTANTIATE_TEST_SUITE_P(Methods, SfndafMethods, testing::Values(1, 2),
                         [](const auto& method) { return method.param == 1 ? "Bdf" : "Radau"; });

TEST_P(SfndafMethods, AllDigitsAreThoseOfSfndae) {
  for (const KnownNonlinear& problem : known_problems()) {
    SCOPED_TRACE(testing::PrintToString(problem.characteristics));
    expect_as_sfndae<std::int32_t>(problem);
    expect_as_sfndae<std::int64_t>(problem);
  }
}

TEST_P(SfndafMethods, InterruptedCallsGiveTheSameBits) {
  const KnownNonlinear problem = pendulum_problem();
  auto whole = run_of<SfndafRun<>>(problem), interrupted = run_of<SfndafRun<>>(problem);
  interrupted.info(14) = 1;
  interrupted.iwork(20) = 1;
  ASSERT_EQ(whole.call(0.5), 3);
  int interruptions = 0;
  while (interrupted.call(0.5) == -1) {
    interrupted.info(1) = 1;
    ++interruptions;
  }
  ASSERT_EQ(interrupted.ierr, 3);
  EXPECT_GT(interruptions, 3);
  EXPECT_EQ(interrupted.values(), whole.values());
}

// The arrays of SFNDAE hold another state.
TEST_P(SfndafMethods, AStateOfSfndaeIsRefused) {
  auto by_order = run_of<SfndaeRun<>>(pendulum_problem());
  ASSERT_EQ(by_order.call(0.1), 3);
  auto by_array = run_of<SfndafRun<>>(pendulum_problem());
  by_array.iwork = by_order.iwork;
  by_array.rwork = by_order.rwork;
  by_array.info(1) = 1;
  EXPECT_EQ(by_array.call(0.2), -101);
  EXPECT_EQ(by_array.user.calls, 0);
}

TEST_P(SfndafMethods, IllegalArgumentsHaveTheCodesOfSfndae) {
  using Spoil = std::function<void(SfndaeRun<>&)>;
  const std::vector<std::pair<int, Spoil>> cases = {{-101, [](auto& run) { run.info(5) = 1; }},
                                                    {-101, [](auto& run) { run.info(12) = 2; }},
                                                    {-102, [](auto& run) { run.n = 0; }},
                                                    {-133, [](auto& run) { run.m = 5001; }},
                                                    {-103, [](auto& run) { run.info(9) = 1, run.iwork(3) = 6; }},
                                                    {-104, [](auto& run) { run.info(10) = 1, run.iwork(4) = -1; }},
                                                    {-105, [](auto& run) { run.lrw -= 1; }},
                                                    {-106, [](auto& run) { run.liw = 19; }},
                                                    {-107, [](auto& run) { run.rtol(1) = -1.0; }},
                                                    {-108, [](auto& run) { run.atol(1) = -1.0; }},
                                                    {-109, [](auto& run) { run.rtol(1) = run.atol(1) = 0.0; }},
                                                    {-132, [](auto& run) { run.method = 3; }}};
  for (const auto& [code, spoil] : cases) {
    auto by_array = run_of<SfndafRun<>>(pendulum_problem());
    auto by_order = run_of<SfndaeRun<>>(pendulum_problem());
    const std::vector<double> start = pendulum_problem().start;
    spoil(by_array);
    spoil(by_order);
    EXPECT_EQ(by_array.call(1.0), code);
    EXPECT_EQ(by_order.call(1.0), code);
    EXPECT_EQ(by_array.info(1), -1);
    EXPECT_EQ(by_array.t, 0.0);
    EXPECT_TRUE(std::equal(start.begin(), start.end(), by_array.x.data()));
    EXPECT_EQ(by_array.user.calls, 0) << code;
    EXPECT_TRUE(by_array.guards_intact());
  }
}

TEST_P(SfndafMethods, FailuresOfTheSubroutineHaveTheCodesOfSfndae) {
  for (const int ierr : {-1, -2, -7}) {
    auto run = run_of<SfndafRun<>>(pendulum_problem());
    run.user.ierr = [=](double, int) { return ierr; };
    EXPECT_EQ(run.call(1.0), ierr == -2 ? -21 : -10);
    EXPECT_EQ(run.t, 0.0);
  }
  auto run = run_of<SfndafRun<>>(pendulum_problem());
  run.user.ierr = [](double t, int) { return t > 0.3 ? -1 : 0; };
  EXPECT_EQ(run.call(1.0), -10);
  EXPECT_GT(run.t, 0.2);
  EXPECT_LE(run.t, 0.3);
  run.user.returns_nan = true;
  run.info(1) = 0;
  run.user.ierr = [](double, int) { return 0; };
  EXPECT_EQ(run.call(1.0), -10);
}

namespace {

// x' + x = 0 by a subroutine for INTEGERs of another width than the entry's.
void other_width(const double*, const std::int64_t* mu, const std::int64_t* n, const std::int64_t* m, double* jet,
                 const std::int64_t*, double* F, double* jacobian, const std::int64_t* ldfj, std::int64_t*, double*,
                 std::int64_t*) {
  if (*n != 1 || *m != 1 || *mu < 0 || *mu > 20) {
    F[0] = -1e10;
    return;
  }
  for (std::int64_t k = 0; k <= *mu; ++k) {
    F[k] = jet[k + 1] + jet[k];
    jacobian[k + *ldfj * k] = 1.0;
    jacobian[k + *ldfj * (k + 1)] = 1.0;
  }
}

}  // namespace

TEST(Sfndaf, SubroutinesOfAnotherWidthAreNoticed) {
#if defined(__clang__)
#if __has_feature(undefined_behavior_sanitizer)
  GTEST_SKIP() << "a subroutine is called with other INTEGERs than it has, on purpose";
#endif
#endif
  const auto narr = reinterpret_cast<sfdae::f77::ArrayRoutine<std::int32_t>>(other_width);
  // INTEGERs of 32 bits that look like those of 64 bits.
  std::int64_t n = 1, m = 1, method = 1, liw = 20, lrw = 149, iwarn = 0, ierr = 0;
  std::int64_t cval[5] = {}, iwork[20] = {}, info[20] = {}, ipar = 0;
  double t = 0.0, tout = 1.0, x = 1.0, xprime = 0.0, rwork[149] = {}, rtol = 1e-6, atol = 1e-6, rpar = 0.0;
  const auto narrow = [](std::int64_t& value) { return reinterpret_cast<std::int32_t*>(&value); };
  sfndaf_(narr, narrow(n), narrow(m), &t, &tout, &x, &xprime, narrow(cval[0]), narrow(ipar), &rpar, narrow(iwork[0]),
          narrow(liw), rwork, narrow(lrw), &rtol, &atol, narrow(method), narrow(info[0]), narrow(iwarn),
          narrow(ierr));
  EXPECT_EQ(ierr, -140);
  EXPECT_EQ(info[0], -1);
  EXPECT_EQ(x, 1.0);
  sfndaf_64_(other_width, &n, &m, &t, &tout, &x, &xprime, cval, &ipar, &rpar, iwork, &liw, rwork, &lrw, &rtol, &atol,
             &method, (info[0] = 0, info), &iwarn, &ierr);
  EXPECT_EQ(ierr, 3);
  EXPECT_NEAR(x, std::exp(-1.0), 10 * (rtol + atol));
  info[0] = 0;
  t = 0.0, x = 1.0;
  sfndaf_64__(other_width, &n, &m, &t, &tout, &x, &xprime, cval, &ipar, &rpar, iwork, &liw, rwork, &lrw, &rtol, &atol,
              &method, info, &iwarn, &ierr);
  EXPECT_EQ(ierr, 3);
}
