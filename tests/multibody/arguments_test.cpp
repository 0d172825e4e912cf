// What users may get wrong with multibody systems: a status, a reason, and outputs as they were.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <climits>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "pendulum.h"

namespace sfdae::test {
namespace {

class Arguments : public testing::Test {
 protected:
  Pendulum pendulum;
  sfdae_multibody_problem problem = pendulum.problem();
  sfdae_options options = options_of(SFDAE_METHOD_BDF, 1e-6);

  void refuse(int expected, const char* reason) {
    int nothing = 0;
    auto* solver = reinterpret_cast<sfdae_solver*>(&nothing);
    EXPECT_EQ(sfdae_create_multibody(&solver, &problem, &options), expected);
    EXPECT_EQ(solver, nullptr);
    char text[512] = "";
    EXPECT_EQ(sfdae_check_multibody(&problem, &options, text, sizeof text), expected);
    EXPECT_NE(std::strstr(text, reason), nullptr) << text;
    char tiny[] = "abcdef";
    EXPECT_EQ(sfdae_check_multibody(&problem, &options, tiny, 3), expected);
    EXPECT_EQ(tiny[2], '\0');
    EXPECT_EQ(tiny[3], 'd');
    EXPECT_EQ(sfdae_check_multibody(&problem, &options, nullptr, 0), expected);
    problem = pendulum.problem();
  }
};

TEST_F(Arguments, GoodOnesPass) {
  char text[64] = "?";
  EXPECT_EQ(sfdae_check_multibody(&problem, &options, text, sizeof text), SFDAE_OK);
  EXPECT_STREQ(text, "");
  EXPECT_EQ(sfdae_check_multibody(&problem, nullptr, nullptr, 0), SFDAE_OK);
}

TEST_F(Arguments, ProblemsThatLackSomethingAreRefused) {
  problem.size = 0;
  refuse(SFDAE_ILLEGAL_ARGUMENT, "size");
  for (const int count : {-1, INT_MIN, INT_MAX, 5001}) {
    for (int sfdae_multibody_problem::*member :
         {&sfdae_multibody_problem::num_positions, &sfdae_multibody_problem::num_velocities,
          &sfdae_multibody_problem::num_constraints, &sfdae_multibody_problem::num_nonholonomic}) {
      problem.*member = count;
      refuse(SFDAE_ILLEGAL_ARGUMENT, "num_");
    }
  }
  problem.num_positions = 0;
  refuse(SFDAE_EMPTY_PROBLEM, "num_positions");
  problem.num_positions = problem.num_velocities = 2000;
  problem.num_constraints = 2000;
  refuse(SFDAE_ILLEGAL_ARGUMENT, "unknowns");
  problem.forces = nullptr;
  refuse(SFDAE_ILLEGAL_ARGUMENT, "forces");
  problem.constraints = nullptr;
  refuse(SFDAE_ILLEGAL_ARGUMENT, "constraints");
  problem.constraint_jacobian = nullptr;
  refuse(SFDAE_ILLEGAL_ARGUMENT, "constraint_jacobian");
  problem.num_nonholonomic = 1;
  refuse(SFDAE_ILLEGAL_ARGUMENT, "nonholonomic_matrix");
  problem.num_velocities = 1;
  refuse(SFDAE_ILLEGAL_ARGUMENT, "kinematics");
  problem.coordinates = 2;
  refuse(SFDAE_ILLEGAL_ARGUMENT, "coordinates");
  options.rtol = -1.0;
  refuse(SFDAE_ILLEGAL_ARGUMENT, "rtol");
}

TEST_F(Arguments, InitWritesNoMoreThanItsCallerHas) {
  union {
    sfdae_multibody_problem problem;
    unsigned char bytes[sizeof(sfdae_multibody_problem) + 32];
  } p;
  for (size_t size = 0; size <= sizeof p; ++size) {
    std::memset(&p, 0x5a, sizeof p);
    const int status = sfdae_multibody_problem_init(&p.problem, size);
    EXPECT_EQ(status, size >= sizeof(size_t) ? SFDAE_OK : SFDAE_ILLEGAL_ARGUMENT);
    for (size_t i = status == SFDAE_OK ? size : 0; i < sizeof p; ++i) ASSERT_EQ(p.bytes[i], 0x5a);
  }
  EXPECT_EQ(sfdae_multibody_problem_init(nullptr, sizeof p.problem), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(sfdae_multibody_report_init(nullptr, sizeof(sfdae_multibody_report)), SFDAE_ILLEGAL_ARGUMENT);
}

TEST_F(Arguments, CallsOutOfTurnLeaveOutputsAlone) {
  MultibodyRun run(problem, options);
  sfdae_multibody_report report;
  sfdae_multibody_report_init(&report, sizeof report);
  report.partitions = 77;
  EXPECT_EQ(sfdae_get_multibody_report(run.solver.get(), &report), SFDAE_NOT_STARTED);
  EXPECT_EQ(report.partitions, 77);
  EXPECT_EQ(sfdae_get_multibody_report(run.solver.get(), nullptr), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(sfdae_get_multibody_report(nullptr, &report), SFDAE_ILLEGAL_ARGUMENT);
  report.size = 0;
  EXPECT_EQ(sfdae_get_multibody_report(run.solver.get(), &report), SFDAE_ILLEGAL_ARGUMENT);
  double t = 3.0;
  EXPECT_EQ(sfdae_advance(run.solver.get(), 1.0, &t, run.x.data(), nullptr), SFDAE_NOT_STARTED);
  EXPECT_EQ(t, 3.0);
  std::vector<double> x = Pendulum::state(0.1, 0.2);
  x[1] = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> before = x;
  EXPECT_EQ(sfdae_start(run.solver.get(), 0.0, 1.0, x.data(), nullptr), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(std::memcmp(x.data(), before.data(), x.size() * sizeof(double)), 0);
}

TEST_F(Arguments, ReportsOfOtherProblemsAreRefused) {
  sfdae_linear_problem linear;
  sfdae_linear_problem_init(&linear, sizeof linear);
  linear.num_equations = linear.num_unknowns = 1;
  linear.E = linear.A = [](double, int, double*, void*) { return 0; };
  sfdae_solver* solver = nullptr;
  ASSERT_EQ(sfdae_create_linear(&solver, &linear, nullptr), SFDAE_OK);
  sfdae_multibody_report report;
  sfdae_multibody_report_init(&report, sizeof report);
  EXPECT_EQ(sfdae_get_multibody_report(solver, &report), SFDAE_ILLEGAL_ARGUMENT);
  sfdae_destroy(&solver);
}

TEST_F(Arguments, IndexAboveTheMaximumIsSaid) {
  options.max_index = 1;
  MultibodyRun run(problem, options);
  EXPECT_EQ(run.start(0.0, 1.0, Pendulum::state(0.1, 0.2)), SFDAE_INDEX_TOO_HIGH) << run.message();
}

// A callback that fails beyond some height, for a while or for ever.
struct CallbackError {
  int status = 1;
  double beyond = 0.5;
  bool as_nan = false;
  static int forces(double t, const double*, const double*, double* f, void* user) {
    const auto& self = *static_cast<const CallbackError*>(user);
    f[1] = -1.0;
    if (t <= self.beyond) return 0;
    if (self.as_nan) f[1] = std::numeric_limits<double>::quiet_NaN();
    return self.as_nan ? 0 : self.status;
  }
  static int constraints(double, const double* q, double* g, void*) {
    g[0] = 0.5 * (q[0] * q[0] + q[1] * q[1] - 1.0);
    return 0;
  }
  static int jacobian(double, const double* q, double* g_q, void*) {
    g_q[0] = q[0];
    g_q[1] = q[1];
    return 0;
  }
};

TEST_F(Arguments, ErrorsOfCallbacksEndWithTheirName) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    const std::pair<CallbackError, int> cases[] = {{{-1, 0.5, false}, SFDAE_CALLBACK_STOPPED},
                                                   {{1, 0.5, false}, SFDAE_CALLBACK_FAILED},
                                                   {{0, 0.5, true}, SFDAE_NOT_FINITE}};
    for (const auto& [error, expected] : cases) {
      CallbackError user = error;
      sfdae_multibody_problem failing = multibody_problem_of(2, 1);
      failing.forces = CallbackError::forces;
      failing.constraints = CallbackError::constraints;
      failing.constraint_jacobian = CallbackError::jacobian;
      failing.user = &user;
      MultibodyRun run(failing, options_of(method, 1e-6));
      ASSERT_EQ(run.start(0.0, 1.0, Pendulum::state(0.5, 0.2)), SFDAE_OK) << run.message();
      EXPECT_EQ(run.advance(1.0), expected) << run.message();
      EXPECT_LE(run.t, 0.5);
      for (const double value : run.x) EXPECT_TRUE(std::isfinite(value));
      user.beyond = 2.0;
      EXPECT_EQ(run.advance(1.0), SFDAE_OK) << run.message();
    }
  }
}

}  // namespace
}  // namespace sfdae::test
