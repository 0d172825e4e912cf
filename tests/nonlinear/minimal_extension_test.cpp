// SPDX-License-Identifier: BSD-3-Clause
// Systems by their minimal extension: what is known of them, whatever their size, or a failure with a name.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "checkpoint_of.h"
#include "family_run.h"
#include "nonlinear_examples.h"
#include "nonlinear_run.h"
#include "sparse_run.h"

namespace sfdae_test {

namespace {

sfdae_options required(int method = SFDAE_METHOD_BDF) { return options_of(SFDAE_STRUCTURE_REQUIRED, method); }

}  // namespace

TEST(Extension, FindsTheValuesOrNamesWhatItCannotConfirm) {
  const int count = scaled_count(3000);
  int confirmed = 0;
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    const SparseSystem system(static_cast<unsigned>(trial + 1),
                              trial % 2 == 1 ? SparseSystem::Mixing::any : SparseSystem::Mixing::none);
    NonlinearRun run(equations_of(system), required());
    const int status = run.analyze(0.2, 1.0, system.exact(0.2));
    if (status == SFDAE_OK) {
      EXPECT_EQ(run.values(), system.values());
      ++confirmed;
    } else {
      EXPECT_TRUE(status == SFDAE_RANK_UNCLEAR || status == SFDAE_NO_CONSISTENT_VALUES) << run.message();
      EXPECT_NE(run.message(), "");
    }
  }
  EXPECT_GT(confirmed, count / 4);
}

TEST(Extension, ItsIntegrationsAreAccurate) {
  const int count = scaled_count(600);
  int integrated = 0;
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    const SparseSystem system(static_cast<unsigned>(trial + 70001),
                              trial % 2 == 1 ? SparseSystem::Mixing::any : SparseSystem::Mixing::none);
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      NonlinearRun run(equations_of(system), required(method));
      if (!is_known(run.integrate(0.2, 1.5, system.exact(0.2)))) continue;
      ++integrated;
      EXPECT_LT(error_in_tolerances(run.x, system.exact(1.5)), 10.0) << method;
    }
  }
  EXPECT_GT(integrated, count / 2);
}

TEST(Extension, KeepsConstraintsAndEnergyOfAPendulum) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    NonlinearRun run({5, 5, pendulum_equations}, required(method));
    ASSERT_TRUE(is_known(run.integrate(0.0, 10.0, {0.6, -0.8, 0.0, 0.0, 0.0}))) << run.message();
    EXPECT_EQ(run.values(), (CharacteristicValues{2, 2, 3, 0, 0}));
    const std::vector<double>& x = run.x;
    EXPECT_NEAR(x[0] * x[0] + x[1] * x[1], 1.0, 1e-11);
    EXPECT_NEAR(x[0] * x[2] + x[1] * x[3], 0.0, 1e-12);
    EXPECT_NEAR(x[4], x[2] * x[2] + x[3] * x[3] - 9.81 * x[1], 1e-10);
    EXPECT_NEAR(0.5 * (x[2] * x[2] + x[3] * x[3]) + 9.81 * x[1], -9.81 * 0.8, 1e-3);
  }
}

// x and v of the first oscillators on circles, and z = 100 (x_0^2 + v_0^2 - 1) of the first one.
template <int count>
void circles(sfdae_record*, const Expression&, const Expression* x, const Expression* xdot, Expression* F) {
  for (int k = 0; k < 2 * count; k += 2) {
    F[k] = xdot[k] - x[k + 1];
    F[k + 1] = xdot[k + 1] + x[k];
  }
  F[2 * count] = x[2 * count] - 100.0 * (x[0] * x[0] + x[1] * x[1] - 1.0);
}

// Errors of unknowns that are no states count, where states are few and where they are not: z is zero and has 200
// times the errors of x and v, which might be as large as the tolerance by themselves.
TEST(Extension, TestsTheErrorsOfWhatFollowsFromStates) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    NonlinearRun few({3, 3, circles<1>}, required(method)), more({5, 5, circles<2>}, required(method));
    ASSERT_TRUE(is_known(few.integrate(0.0, 3.0, {1.0, 0.0, 0.0}))) << few.message();
    ASSERT_TRUE(is_known(more.integrate(0.0, 3.0, {1.0, 0.0, 1.0, 0.0, 0.0}))) << more.message();
    EXPECT_LT(std::fabs(few.x[2]), 1e-5) << method;
    EXPECT_LT(std::fabs(more.x[4]), 1e-5) << method;
  }
}

// Every state there is takes its turn: the pendulum goes around.
TEST(Extension, ChoosesOtherStatesOnItsWay) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    NonlinearRun run({5, 5, pendulum_equations}, required(method));
    ASSERT_TRUE(is_known(run.integrate(0.0, 5.0, {0.0, -1.0, 8.0, 0.0, 0.0}))) << run.message();
    const std::vector<double>& x = run.x;
    EXPECT_NEAR(x[0] * x[0] + x[1] * x[1], 1.0, 1e-12);
    EXPECT_NEAR(0.5 * (x[2] * x[2] + x[3] * x[3]) + 9.81 * x[1], 32.0 - 9.81, 2e-3);
  }
}

TEST(Extension, GoesOnFromCheckpointsInEveryBit) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    NonlinearRun first({5, 5, pendulum_equations}, required(method)),
        second({5, 5, pendulum_equations}, required(method));
    ASSERT_GE(first.integrate(0.0, 0.5, {0.6, -0.8, 0.0, 0.0, 0.0}), 0);
    const std::vector<double> checkpoint = checkpoint_of(first.solver());
    ASSERT_EQ(sfdae_restore_checkpoint(second.solver(), checkpoint.data(), checkpoint.size()), SFDAE_OK)
        << second.message();
    second.x.resize(5);
    ASSERT_GE(first.advance(3.0), 0);
    ASSERT_GE(second.advance(3.0), 0) << second.message();
    EXPECT_EQ(std::memcmp(first.x.data(), second.x.data(), 5 * sizeof(double)), 0);
  }
}

TEST(Extension, StartsAsAsked) {
  const std::vector<double> off = {0.62, -0.8, 0.1, 0.0, 0.0};
  sfdae_options options = required();
  int fixed[] = {1, 0, 1, 0, 0};
  options.initial_values = SFDAE_INITIAL_FIXED;
  options.fixed = fixed;
  NonlinearRun held({5, 5, pendulum_equations}, options);
  ASSERT_TRUE(is_known(held.start(0.0, 1.0, off))) << held.message();
  EXPECT_EQ(held.x[0], 0.62);
  EXPECT_EQ(held.x[2], 0.1);
  EXPECT_NEAR(held.x[1], -std::sqrt(1.0 - 0.62 * 0.62), 1e-13);
  EXPECT_NEAR(held.x[3], -0.62 * 0.1 / held.x[1], 1e-13);
  int impossible[] = {1, 1, 0, 0, 0};
  options.fixed = impossible;
  NonlinearRun too_many({5, 5, pendulum_equations}, options);
  const int status = too_many.start(0.0, 1.0, off);
  EXPECT_TRUE(status == SFDAE_FIXED_VALUES || status == SFDAE_NO_CONSISTENT_VALUES) << status;
  sfdae_options accept = required();
  accept.initial_values = SFDAE_INITIAL_ACCEPT;
  NonlinearRun accepted({5, 5, pendulum_equations}, accept);
  EXPECT_EQ(accepted.start(0.0, 1.0, off), SFDAE_INCONSISTENT_VALUES);
  // The nearest point of the circle, where changes of velocities and forces do not count.
  sfdae_options weighted = required();
  double weights[] = {1.0, 1.0, 1e6, 1e6, 1e6};
  weighted.initial_weights = weights;
  NonlinearRun nearest({5, 5, pendulum_equations}, weighted);
  ASSERT_TRUE(is_known(nearest.start(0.0, 1.0, off))) << nearest.message();
  const double length = std::hypot(0.62, 0.8);
  EXPECT_NEAR(nearest.x[0], 0.62 / length, 1e-6);
  EXPECT_NEAR(nearest.x[1], -0.8 / length, 1e-6);
}

// A capacitor across a source: the current is C x0', whatever the unit of C.
TEST(Extension, FindsTheIndexInAnyUnit) {
  for (const double C : {1.0, 1e-6, 1e-9, 1e-12, 1e-18, 1e-30}) {
    NonlinearRun run(sfdae_test::equations_of(2, 2,
                                              [C](const auto& t, const auto* x, const auto* xdot, auto* F) {
                                                using std::sin;
                                                F[0] = x[0] - sin(t);
                                                F[1] = C * xdot[0] - x[1] + 0.0 * (x[1] * x[1]);
                                              }),
                     required());
    ASSERT_EQ(run.analyze(0.0, 1.0, {0.0, 0.0}), SFDAE_OK) << run.message();
    EXPECT_EQ(run.values(), (CharacteristicValues{1, 0, 2, 0, 0})) << C;
  }
}

// Currents of 1e-6 A beside voltages of 1 V, capacitors that are not grounded: rounding errors of the sums are large
// in units of tight tolerances.
TEST(Extension, StartsAtTightTolerances) {
  for (const double tolerance : {1e-6, 1e-8, 1e-10, 1e-12}) {
    sfdae_options options = options_with(tolerance, SFDAE_METHOD_BDF);
    options.structure = SFDAE_STRUCTURE_REQUIRED;
    NonlinearRun run(sfdae_test::equations_of(5, 5,
                                              [](const auto& t, const auto* x, const auto* xdot, auto* F) {
                                                using std::exp, std::sin;
                                                const auto diode = 1e-6 * (exp((x[1] - x[2]) / 0.026) - 1.0);
                                                F[0] = x[3] - (x[1] - 3.0) / 9000.0 - diode;
                                                F[1] = x[3] + (x[0] - 0.1 * sin(200.0 * t)) / 1000.0;
                                                F[2] = 1e-6 * (xdot[0] - xdot[1]) - x[3];
                                                F[3] = 2e-6 * xdot[2] + x[2] / 1000.0 - diode;
                                                F[4] = x[4] - x[2] / 1000.0;
                                              }),
                     options);
    ASSERT_TRUE(is_known(run.start(0.0, 1.0, {0.0, 3.0, 2.9, 0.0, 0.0}))) << tolerance << ": " << run.message();
    EXPECT_NEAR(run.x[3], -run.x[0] / 1000.0, 1e-15);
  }
}

TEST(Extension, IsNotForProblemsWithoutStructure) {
  sfdae_options options = required();
  sfdae_linear_problem linear;
  sfdae_linear_problem_init(&linear, sizeof linear);
  linear.num_equations = linear.num_unknowns = 1;
  const auto one = [](double, int order, double* matrix, void*) {
    matrix[0] = order == 0 ? 1.0 : 0.0;
    return 0;
  };
  linear.E = linear.A = linear.f = one;
  sfdae_solver* solver = nullptr;
  EXPECT_EQ(sfdae_create_linear(&solver, &linear, &options), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(solver, nullptr);
  options.structure = SFDAE_STRUCTURE_AUTOMATIC;
  ASSERT_EQ(sfdae_create_linear(&solver, &linear, &options), SFDAE_OK);
  options.structure = SFDAE_STRUCTURE_REQUIRED;
  EXPECT_EQ(sfdae_set_options(solver, &options), SFDAE_ILLEGAL_ARGUMENT);
  sfdae_destroy(&solver);
  // Two equations for x0, none for x1.
  NonlinearRun missing(
      {2, 2,
       [](sfdae_record*, const Expression&, const Expression* x, const Expression* xdot, Expression* F) {
         F[0] = xdot[0] + x[0] * x[0];
         F[1] = x[0] * x[0] - 1.0;
       }},
      options);
  EXPECT_EQ(missing.analyze(0.0, 1.0, {1.0, 0.0}), SFDAE_RANK_UNCLEAR);
}

// The factor of x_1' + x_2' varies: no combination with constant factors can be found, and no guess is better.
TEST(Extension, AdvisesAgainstStructureWhereItMisleadsEverywhere) {
  const auto equations = equations_of(2, 2, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    using std::sin, std::cos;
    F[0] = xdot[0] + xdot[1] - x[0];
    F[1] = (xdot[0] + xdot[1]) * (1.0 + 0.5 * sin(x[0])) + x[1] - cos(t);
  });
  NonlinearRun run(equations, required());
  EXPECT_EQ(run.start(0.0, 1.0, {0.3, 0.2}), SFDAE_NO_CONSISTENT_VALUES);
  EXPECT_NE(run.message().find("set structure = SFDAE_STRUCTURE_OFF"), std::string::npos) << run.message();
  NonlinearRun whole(equations, options_of(SFDAE_STRUCTURE_OFF));
  EXPECT_GE(whole.start(0.0, 1.0, {0.3, 0.2}), 0) << whole.message();
}

}  // namespace sfdae_test
