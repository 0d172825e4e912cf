// Multibody systems through everything that an integration can do.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "pendulum.h"

namespace sfdae::test {
namespace {

using std::numbers::pi;

class Integration : public testing::TestWithParam<int> {
 protected:
  Pendulum pendulum;
  const std::vector<double> start = Pendulum::state(0.9, 1.2);
  MultibodyRun run(double tol) { return MultibodyRun(pendulum.problem(), options_of(GetParam(), tol)); }
};
INSTANTIATE_TEST_SUITE_P(Methods, Integration, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

TEST_P(Integration, ErrorsOfTheEnergyFollowTheTolerance) {
  double before = 1e300;
  for (const double tol : {1e-3, 1e-5, 1e-7, 1e-9}) {
    MultibodyRun r = run(tol);
    ASSERT_EQ(r.start(0.0, 20.0, start), SFDAE_OK);
    ASSERT_EQ(r.advance(20.0), SFDAE_OK) << r.message();
    const double drift = std::fabs(Pendulum::energy(r.x.data()) - Pendulum::energy(start.data()));
    EXPECT_LE(drift, 100.0 * tol);
    EXPECT_LE(drift, 0.5 * before + 1e-13);
    before = drift;
  }
}

TEST_P(Integration, GoesBackToWhereItCameFrom) {
  MultibodyRun there = run(1e-8);
  ASSERT_EQ(there.start(0.0, 4.0, start), SFDAE_OK);
  ASSERT_EQ(there.advance(4.0), SFDAE_OK);
  MultibodyRun back = run(1e-8);
  ASSERT_EQ(back.start(4.0, 0.0, there.x), SFDAE_OK) << back.message();
  ASSERT_EQ(back.advance(0.0), SFDAE_OK) << back.message();
  for (std::size_t i = 0; i < start.size(); ++i) EXPECT_NEAR(back.x[i], start[i], 1e-6);
}

TEST_P(Integration, OutputsOfAnyDensityAreConsistentAndTheSame) {
  MultibodyRun sparse = run(1e-7), dense = run(1e-7);
  ASSERT_EQ(sparse.start(0.0, 3.0, start), SFDAE_OK);
  ASSERT_EQ(dense.start(0.0, 3.0, start), SFDAE_OK);
  for (int i = 1; i <= 300; ++i) {
    ASSERT_EQ(dense.advance(0.01 * i), SFDAE_OK) << dense.message();
    const std::vector<double>&x = dense.x, &xdot = dense.xdot;
    EXPECT_LE(std::fabs(x[0] * x[0] + x[1] * x[1] - 1.0), 1e-14);
    EXPECT_LE(std::fabs(x[0] * x[2] + x[1] * x[3]), 1e-14);
    EXPECT_NEAR(x[4], x[2] * x[2] + x[3] * x[3] - x[1], 1e-12);
    EXPECT_EQ(xdot[0], x[2]);
    EXPECT_NEAR(xdot[2], -x[4] * x[0], 1e-12);
    // lambda' = 2 v v' - v_2 = -3 v_2. Ends of Radau steps have the slope of a polynomial, its error being that of the
    // iteration over the step size 0.01; points within have the exact one.
    const bool is_end = dense.statistics().t_internal == dense.t;
    EXPECT_NEAR(xdot[4], -3.0 * x[3], GetParam() == SFDAE_METHOD_BDF ? 1e-3 : is_end ? 1e-6 : 1e-7);
  }
  ASSERT_EQ(sparse.advance(3.0), SFDAE_OK);
  for (std::size_t i = 0; i < start.size(); ++i) EXPECT_NEAR(sparse.x[i], dense.x[i], 1e-5);
}

// x_1 = 0: the bob passes below or above.
int passing(double, const double* x, const double*, double* g, void*) {
  g[0] = x[0];
  return 0;
}

TEST_P(Integration, FindsEvents) {
  MultibodyRun r = run(1e-9);
  // A small swing about the lowest point from phi_0 at rest: it passes after a quarter of the period 4 K(sin
  // phi_0/2), K = pi / (2 agm(1, cos(phi_0 / 2))).
  const double phi = 0.5;
  double a = 1.0, b = std::cos(0.5 * phi);
  for (int i = 0; i < 8; ++i) {
    const double mean = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = mean;
  }
  const double quarter = 0.5 * pi / a;
  ASSERT_EQ(sfdae_set_events(r.solver.get(), 1, passing, nullptr, nullptr), SFDAE_OK);
  ASSERT_EQ(r.start(0.0, 10.0, Pendulum::state(phi, 0.0)), SFDAE_OK);
  for (int k = 0; k < 3; ++k) {
    ASSERT_EQ(r.advance(10.0), SFDAE_EVENT) << r.message();
    EXPECT_NEAR(r.t, (2 * k + 1) * quarter, 1e-7);
    EXPECT_NEAR(r.x[0], 0.0, 1e-9);
  }
}

// What an event function is called with first, at the start.
struct FirstCall {
  std::vector<double> x, xdot;
  static int look(double, const double* x, const double* xdot, double* g, void* user) {
    auto& self = *static_cast<FirstCall*>(user);
    if (self.x.empty()) {
      self.x.assign(x, x + 5);
      self.xdot.assign(xdot, xdot + 5);
    }
    g[0] = 1.0;
    return 0;
  }
};

TEST_P(Integration, EventsSeeForcesAndSlopesAtTheStart) {
  FirstCall first;
  MultibodyRun r = run(1e-6);
  ASSERT_EQ(sfdae_set_events(r.solver.get(), 1, FirstCall::look, nullptr, &first), SFDAE_OK);
  // Consistent to the last bit the second time.
  const std::pair<std::vector<double>, int> starts[] = {{{0.8, -0.7, 1.0, 0.1, 0.0}, SFDAE_VALUES_CHANGED},
                                                        {{0.0, -1.0, 0.5, 0.0, 0.0}, SFDAE_OK}};
  for (const auto& [from, status] : starts) {
    first.x.clear();
    ASSERT_EQ(r.start(0.0, 1.0, from), status) << r.message();
    const std::vector<double> x = r.x, xdot = r.xdot;
    ASSERT_EQ(r.advance(0.1), SFDAE_OK) << r.message();
    EXPECT_EQ(first.x, x);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(first.xdot[i], xdot[i]);
  }
}

TEST_P(Integration, ContinuesFromACheckpointAsIfNothingHadHappened) {
  for (const int coordinates : {SFDAE_COORDINATES_ORTHOGONAL, SFDAE_COORDINATES_PERMUTATION}) {
    sfdae_multibody_problem problem = pendulum.problem();
    problem.coordinates = coordinates;
    for (const double t : {0.0, 0.01, 1.0, 3.7}) {
      MultibodyRun whole(problem, options_of(GetParam(), 1e-6)), second(problem, options_of(GetParam(), 1e-6));
      ASSERT_EQ(whole.start(0.0, 8.0, Pendulum::state(0.3, 2.3)), SFDAE_OK);
      if (t > 0.0) {
        ASSERT_EQ(whole.advance(t), SFDAE_OK);
      }
      size_t length = 0;
      ASSERT_EQ(sfdae_get_checkpoint_length(whole.solver.get(), &length), SFDAE_OK);
      std::vector<double> saved(length);
      ASSERT_EQ(sfdae_save_checkpoint(whole.solver.get(), saved.data(), length), SFDAE_OK);
      ASSERT_EQ(sfdae_restore_checkpoint(second.solver.get(), saved.data(), length), SFDAE_OK) << second.message();
      for (const double tout : {t + 0.5, 8.0}) {
        ASSERT_EQ(whole.advance(tout), SFDAE_OK);
        ASSERT_EQ(second.advance(tout), SFDAE_OK) << second.message();
        EXPECT_EQ(whole.x, second.x) << "saved at " << t << ", at " << tout;
        EXPECT_EQ(whole.xdot, second.xdot);
      }
      EXPECT_EQ(whole.report().partitions, second.report().partitions);
      EXPECT_EQ(whole.statistics().steps, second.statistics().steps);
    }
  }
}

TEST_P(Integration, ComponentsAsCoordinatesGiveTheSameSolution) {
  sfdae_multibody_problem problem = pendulum.problem();
  problem.coordinates = SFDAE_COORDINATES_PERMUTATION;
  MultibodyRun components(problem, options_of(GetParam(), 1e-8)), orthogonal = run(1e-8);
  const std::vector<double> over = Pendulum::state(0.3, 2.3);
  ASSERT_EQ(components.start(0.0, 6.0, over), SFDAE_OK) << components.message();
  ASSERT_EQ(orthogonal.start(0.0, 6.0, over), SFDAE_OK);
  ASSERT_EQ(components.advance(6.0), SFDAE_OK) << components.message();
  ASSERT_EQ(orthogonal.advance(6.0), SFDAE_OK);
  for (std::size_t i = 0; i < over.size(); ++i) EXPECT_NEAR(components.x[i], orthogonal.x[i], 1e-6);
  EXPECT_GE(components.report().partitions, 3);
}

TEST_P(Integration, StepsAndReportsTell) {
  MultibodyRun r = run(1e-6);
  ASSERT_EQ(r.start(0.0, 2.0, start), SFDAE_OK);
  EXPECT_EQ(r.report().partitions, 1);
  int steps = 0;
  while ((r.status = sfdae_step(r.solver.get(), 2.0, &r.t, r.x.data(), r.xdot.data())) == SFDAE_STEP_TAKEN) ++steps;
  ASSERT_EQ(r.status, SFDAE_OK) << r.message();
  EXPECT_GE(steps, 3);
  const sfdae_multibody_report report = r.report();
  EXPECT_GE(report.t, 2.0);
  EXPECT_EQ(report.holonomic, 1);
  EXPECT_EQ(report.nonholonomic, 0);
  EXPECT_EQ(report.redundant, 0);
  EXPECT_EQ(report.position_freedom, 1);
  EXPECT_GE(report.condition, 1.0 - 1e-12);
  EXPECT_LE(report.position_residual, 1e-14);
  EXPECT_LE(report.velocity_residual, 1e-14);
  std::string text(10000, ' ');
  ASSERT_GE(sfdae_report(r.solver.get(), text.data(), text.size(), nullptr), 0);
  EXPECT_NE(text.find("Multibody system: 1 holonomic and 0 nonholonomic constraints"), std::string::npos) << text;
}

}  // namespace
}  // namespace sfdae::test
