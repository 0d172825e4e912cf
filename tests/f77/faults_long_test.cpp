// User functions that fail at any one of their calls: DGELDA overcomes it or says so, and its arrays remain a state
// to go on from.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "dgelda_family_run.h"
#include "family_run.h"

namespace {

using namespace sfdae_test;
using Functions = DgeldaFamily<std::int32_t>;
using Arguments = Dgelda<std::int32_t>;

constexpr double tol = 1e-5;
constexpr int nan_instead = 99;

struct Setting {
  int method, mu, u;
  bool constant, every_step;
};

std::string setting_name(const testing::TestParamInfo<Setting>& tested) {
  const Setting& s = tested.param;
  return std::string(s.method == 1 ? "Bdf" : "Radau") + "Mu" + std::to_string(s.mu) + "U" + std::to_string(s.u) +
         (s.constant ? "Constant" : "") + (s.every_step ? "EveryStep" : "");
}

std::vector<Setting> all_settings() {
  std::vector<Setting> all;
  for (int method : {1, 2})
    for (int mu : {0, 2})
      for (int u : {0, 1})
        for (bool constant : {false, true})
          for (bool every_step : {false, true}) all.push_back({method, mu, u, constant, every_step});
  return all;
}

// With SFDAE_TEST_SCALE below 1 not every call, but some spread evenly.
long stride() { return 100 / scaled_count(100); }

class Faults : public testing::TestWithParam<Setting> {
 protected:
  std::shared_ptr<const LinearFamily> family() const {
    return kron(6, GetParam().mu, GetParam().constant ? 0.0 : 0.5, GetParam().u);
  }
  Arguments arguments(Functions& functions) const {
    Arguments call = functions.arguments(GetParam().method);
    call.set_tolerance(tol);
    call.info(3) = GetParam().every_step ? 1 : 0;
    call.info(5) = GetParam().constant ? 1 : 0;
    return call;
  }
  static int integrate(Arguments& call) {
    int ierr = call.call(1.0);
    while (ierr == 1 && call.steps() < 10000) ierr = call.call(1.0);
    return ierr;
  }
  // Number of calls of the user's functions when nothing fails.
  long calls() const {
    Functions functions(family());
    Arguments call = arguments(functions);
    EXPECT_EQ(integrate(call), 3);
    return functions.problem.calls();
  }
  // The call of that number, or all from there on, return the code.
  static void break_call(Functions& functions, long number, bool and_all_later, int code) {
    const auto is_broken = [=](const Call& call) {
      return call.number == number || (and_all_later && call.number > number);
    };
    if (code != nan_instead)
      functions.problem.hooks.status = [=](const Call& call) { return is_broken(call) ? code : 0; };
    else
      functions.problem.hooks.tamper = [=](const Call& call, std::span<double> values) {
        if (is_broken(call)) values[0] = std::numeric_limits<double>::quiet_NaN();
      };
  }
  void expect_reached(const Functions& functions, const Arguments& call, int ierr) const {
    EXPECT_EQ(ierr, 3);
    EXPECT_EQ(call.t, 1.0);
    // What is free is another solution.
    if (GetParam().u == 0) {
      EXPECT_LE(weighted_error(functions.problem.family(), tol, 1.0, call.x.data()), 10.0);
    }
    EXPECT_TRUE(call.guards_intact());
  }
  // After the repair: afresh where nothing had been reached, otherwise on.
  void expect_recovery(Functions& functions, Arguments& call) const {
    EXPECT_EQ(call.info(1), -1);
    for (int i = 1; i <= call.n; ++i) EXPECT_TRUE(std::isfinite(call.x(i)));
    functions.problem.hooks = {};
    call.info(1) = call.steps() == 0 ? 0 : 1;
    expect_reached(functions, call, integrate(call));
  }
};
INSTANTIATE_TEST_SUITE_P(Dgelda, Faults, testing::ValuesIn(all_settings()), setting_name);

TEST_P(Faults, ASingleFailureIsOvercome) {
  const long last = calls();
  for (int code : {-1, nan_instead})
    for (long number = 1; number <= last; number += stride()) {
      SCOPED_TRACE("call " + std::to_string(number) + " of " + std::to_string(last) + ": " + std::to_string(code));
      Functions functions(family());
      break_call(functions, number, false, code);
      Arguments call = arguments(functions);
      const int ierr = integrate(call);
      // At the start there is no step that could be smaller.
      if (ierr == -22 && call.steps() == 0) expect_recovery(functions, call);
      else expect_reached(functions, call, ierr);
    }
}

TEST_P(Faults, AFailureThatStaysIsReportedAndCanBeRepaired) {
  const long last = calls();
  for (int code : {-1, nan_instead})
    for (long number = 1; number <= last; number += stride()) {
      SCOPED_TRACE("from call " + std::to_string(number) + " of " + std::to_string(last) + ": " +
                   std::to_string(code));
      Functions functions(family());
      break_call(functions, number, true, code);
      Arguments call = arguments(functions);
      const int ierr = integrate(call);
      if (call.steps() > 0) EXPECT_EQ(ierr, -10);
      else EXPECT_TRUE(ierr == -10 || ierr == -22) << ierr;
      expect_recovery(functions, call);
    }
}

TEST_P(Faults, AMissingOrderIsReportedAtOnce) {
  const long last = calls();
  for (long number = 1; number <= last; number += stride()) {
    SCOPED_TRACE("call " + std::to_string(number) + " of " + std::to_string(last));
    Functions functions(family());
    break_call(functions, number, false, -2);
    Arguments call = arguments(functions);
    EXPECT_EQ(integrate(call), -21);
    EXPECT_EQ(functions.problem.calls(), number);
    if (call.ierr == -21) expect_recovery(functions, call);
  }
}

}  // namespace
