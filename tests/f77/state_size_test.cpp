// SPDX-License-Identifier: BSD-3-Clause
// What DGELDA keeps between calls fits into the work arrays of the documented lengths, whatever it consists of.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "dgelda_run.h"

using sfdae_test::DgeldaRun;
using sfdae_test::UserData;

namespace {

// x_i' = -(1 + i) c_i x_i + cos t with c_1 = 1e-6 or 1 (columns of different units are scaled); free: the last
// equation is 0 = 0. All n (n - 1) components are differential, so that histories and bases are the largest possible.
UserData full_dynamics(int n, bool in_other_units, bool has_free_component) {
  const int rows = has_free_component ? n - 1 : n;
  const auto at = [n](int i) { return static_cast<std::size_t>(i + i * n); };
  const double unit = in_other_units ? 1e6 : 1.0;
  UserData data{n, {}, {}, {}};
  data.E = [=](double, int order, double* E) {
    for (int i = 0; i < rows && order == 0; ++i) E[at(i)] = i == 0 ? unit : 1.0;
    return 0;
  };
  data.A = [=](double, int order, double* A) {
    for (int i = 0; i < rows && order == 0; ++i) A[at(i)] = -(1.0 + i) * (i == 0 ? unit : 1.0);
    return 0;
  };
  data.f = [=](double t, int order, double* f) {
    for (int i = 0; i < rows; ++i) f[i] = std::cos(t + order * 1.5707963267948966);
    return 0;
  };
  return data;
}

struct Case {
  int method;
  bool is_constant, in_other_units, has_free_component;
};

// More points than the history holds, each written to the arrays.
void expect_to_fit(DgeldaRun<>& run) {
  run.info[2] = 1;
  run.rtol[0] = run.atol[0] = 1e-4;
  ASSERT_EQ(run.call(0.0), 4);
  ASSERT_TRUE(run.guards_are_intact());
  for (int i = 0; i < 14; ++i) {
    const int ierr = run.call(run.t + 1.0);
    ASSERT_TRUE(ierr == 1 || ierr == 3) << ierr;
    ASSERT_TRUE(run.guards_are_intact());
  }
}

class StateSize : public testing::TestWithParam<Case> {};

}  // namespace

TEST_P(StateSize, FitsTheDocumentedMinimum) {
  const Case c = GetParam();
  for (int n = 1; n <= 12; ++n)
    for (int max_index = 0; max_index <= 5; ++max_index)
      for (int max_order = 1; max_order <= 5; ++max_order) {
        SCOPED_TRACE("n " + std::to_string(n) + ", MXINDX " + std::to_string(max_index) + ", MAXORD " +
                     std::to_string(max_order));
        DgeldaRun<> run(full_dynamics(n, c.in_other_units, c.has_free_component), c.method, max_order, max_index);
        run.info[4] = c.is_constant ? 1 : 0;
        expect_to_fit(run);
        if (HasFatalFailure()) return;
      }
}

// A change of the characteristic values that lies ahead is part of the state: (1 - t)^4 x' = 1 - x for t < 1, then 0
// = 1 - x.
TEST(StateSizeAtAChange, FitsTheDocumentedMinimum) {
  for (int method : {1, 2})
    for (int n = 1; n <= 3; ++n)
      for (int max_order : {1, 5}) {
        UserData data = full_dynamics(n, false, false);
        const auto E = data.E;
        data.E = [E](double t, int order, double* values) {
          E(t, order, values);
          if (order == 0) values[0] = t < 1.0 ? std::pow(1.0 - t, 4) : 0.0;
          return 0;
        };
        DgeldaRun<> run(data, method, max_order, 0);
        run.info[2] = 1;
        run.x.assign(static_cast<std::size_t>(n), 0.1);
        run.rtol[0] = run.atol[0] = 1e-3;
        while (run.call(2.0) == 1) ASSERT_TRUE(run.guards_are_intact());
        EXPECT_EQ(run.ierr, -26) << method << " " << n << " " << max_order << " " << run.t;
        EXPECT_TRUE(run.guards_are_intact());
      }
}

// Ranks that a certificate has decided are part of the state, too: x' = -x times [1 r; 1 -r].
TEST(StateSizeWithCertifiedRanks, FitsTheDocumentedMinimum) {
  const double r = 1e-14;
  for (int method : {1, 2})
    for (int max_index = 0; max_index <= 5; ++max_index)
      for (int max_order : {1, 5}) {
        SCOPED_TRACE("MXINDX " + std::to_string(max_index) + ", MAXORD " + std::to_string(max_order));
        UserData data = full_dynamics(2, false, false);
        data.E = [=](double, int order, double* E) {
          if (order > 0) return 0;
          const double values[] = {1.0, 1.0, r, -r};
          std::copy_n(values, 4, E);
          return 0;
        };
        data.A = [=](double, int order, double* A) {
          if (order > 0) return 0;
          const double values[] = {-1.0, -1.0, -r, r};
          std::copy_n(values, 4, A);
          return 0;
        };
        DgeldaRun<> run(data, method, max_order, max_index);
        expect_to_fit(run);
        if (HasFatalFailure()) return;
      }
}

INSTANTIATE_TEST_SUITE_P(Dgelda, StateSize, testing::ValuesIn([] {
                           std::vector<Case> cases;
                           for (int method : {1, 2})
                             for (bool is_constant : {false, true})
                               for (bool in_other_units : {false, true})
                                 for (bool has_free_component : {false, true})
                                   cases.push_back({method, is_constant, in_other_units, has_free_component});
                           return cases;
                         }()),
                         [](const auto& parameter) {
                           const Case& c = parameter.param;
                           return std::string(c.method == 1 ? "Bdf" : "Radau") + (c.is_constant ? "Constant" : "") +
                                  (c.in_other_units ? "Units" : "") + (c.has_free_component ? "Free" : "");
                         });
