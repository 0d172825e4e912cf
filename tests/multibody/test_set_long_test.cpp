// SPDX-License-Identifier: BSD-3-Clause
// Mechanical systems of the literature as multibody systems: digits, constraints, partitions.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include "multibody/models.h"
#include "multibody/multibody_run.h"
#include "multibody/residuals.h"

namespace {

using namespace sfdae_test;

constexpr std::array<double, 3> tolerances = {1e-4, 1e-6, 1e-8};
constexpr std::array<int, 2> methods = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU};

// Correct digits at rtol = atol = 1e-4, 1e-6, 1e-8 of the best of IDA, DASSL, DASKR on forms of lower index made by
// hand, and of RADAU5 and RADAU. Without any: what the tolerance lets expect.
struct PeerDigits {
  std::array<double, 3> bdf, radau;
};
const std::map<std::string, PeerDigits> peers = {{"pendulum", {{2.3, 4.0, 5.8}, {3.1, 4.7, 6.3}}},
                                                 {"car_axis", {{1.7, 2.7, 4.6}, {2.1, 4.3, 6.0}}},
                                                 {"andrews", {{3.5, 4.5, 6.7}, {5.1, 6.3, 8.9}}},
                                                 {"fekete", {{3.4, 4.8, 6.3}, {3.7, 5.9, 7.1}}},
                                                 {"rigid_slider_crank", {{2.0, 4.0, 6.0}, {2.0, 4.0, 6.0}}},
                                                 {"slider_crank", {{2.0, 4.0, 5.0}, {2.0, 4.0, 5.0}}}};

// Digits at the end of an integration scatter: one less is allowed, two where the tolerance is loose.
TEST(DigitsOfMultibodySystems, AreThoseOfOtherSolvers) {
  for_each_multibody_model([](const TestProblem& p, const auto& system) {
    for (const int method : methods)
      for (std::size_t i = 0; i < tolerances.size(); ++i) {
        SCOPED_TRACE(testing::Message() << p.name << ", method " << method << ", tolerance " << tolerances[i]);
        MultibodyRun run(system, MultibodyForm::recorded, multibody_options(tolerances[i], method));
        const int status = run.integrate(p.t0, p.tf, p.x0);
        ASSERT_EQ(status, SFDAE_OK) << run.text(status);
        EXPECT_EQ(run.values(), p.values);
        const PeerDigits& known = peers.at(p.name);
        const double theirs = method == SFDAE_METHOD_BDF ? known.bdf[i] : known.radau[i];
        const double ours = correct_digits(p, p.references.back(), run.x.data());
        EXPECT_GE(ours, theirs - (i == 0 ? 2.0 : 1.0));
        const std::string key = p.name + "_" + std::to_string(method) + "_" + std::to_string(i);
        testing::Test::RecordProperty(key + "_digits", std::to_string(ours));
        testing::Test::RecordProperty(key + "_partitions", std::to_string(run.report().partitions));
      }
  });
}

TEST(ConstraintsOfMultibodySystems, HoldToRoundingAtEveryOutput) {
  for_each_multibody_model([](const TestProblem& p, const auto& system) {
    for (const int method : methods) {
      SCOPED_TRACE(testing::Message() << p.name << ", method " << method);
      MultibodyRun run(system, MultibodyForm::recorded, multibody_options(1e-5, method));
      ASSERT_EQ(run.start(p.t0, p.tf, p.x0), SFDAE_OK) << run.text(-1);
      for (int k = 0; k <= 40; ++k) {
        if (k > 0) {
          const int status = run.advance(p.t0 + (p.tf - p.t0) * k / 40.0);
          ASSERT_EQ(status, SFDAE_OK) << run.text(status);
        }
        const ConstraintResiduals residuals(system, run.t, run.x.data());
        EXPECT_LE(residuals.position, 1e-12) << run.t;
        EXPECT_LE(residuals.velocity, 1e-12) << run.t;
      }
      const sfdae_multibody_report report = run.report();
      EXPECT_EQ(report.holonomic, system.sizes.holonomic);
      EXPECT_EQ(report.redundant, 0);
      EXPECT_EQ(2 * report.degrees_of_freedom, p.values.d);
      EXPECT_GE(report.partitions, 1);
      EXPECT_GE(report.condition, 1.0 - 1e-12);
      EXPECT_LE(report.position_residual, 1e-11 * std::max(1.0, largest_entry(run.x)));
      EXPECT_LE(report.velocity_residual, 1e-11 * std::max(1.0, largest_entry(run.x)));
    }
  });
}

// Callbacks and records, directions and components: the same system, up to the errors of the integration.
TEST(FormsOfMultibodySystems, LeadToTheSamePoint) {
  constexpr double tolerance = 1e-7;
  for_each_multibody_model([](const TestProblem& p, const auto& system) {
    if (p.name == "fekete") return;  // callbacks with series take long
    const double end = p.t0 + 0.3 * (p.tf - p.t0);
    for (const int method : methods) {
      SCOPED_TRACE(testing::Message() << p.name << ", method " << method);
      const sfdae_options options = multibody_options(tolerance, method);
      MultibodyRun recorded(system, MultibodyForm::recorded, options),
          called(system, MultibodyForm::callbacks, options),
          permuted(system, MultibodyForm::recorded, options, SFDAE_COORDINATES_PERMUTATION);
      for (auto* run : {&recorded, &called, &permuted}) {
        ASSERT_EQ(run->created, SFDAE_OK);
        const int status = run->integrate(p.t0, end, p.x0);
        ASSERT_EQ(status, SFDAE_OK) << run->text(status);
      }
      const double size = std::max(1.0, largest_entry(recorded.x));
      for (std::size_t i = 0; i < recorded.x.size(); ++i) {
        EXPECT_NEAR(called.x[i], recorded.x[i], 300.0 * tolerance * size) << i;
        EXPECT_NEAR(permuted.x[i], recorded.x[i], 300.0 * tolerance * size) << i;
      }
    }
  });
}

// The general path solves the same equations F(t, x, x') = 0, multipliers included. It starts with the multipliers
// found: from others it would change positions, too, to be nearer to them.
template <class System>
void expect_the_same_motion(const TestProblem& p, const System& system, MultibodyForm form) {
  constexpr double tolerance = 1e-7;
  const double end = p.t0 + 0.3 * (p.tf - p.t0);
  for (const int method : methods) {
    SCOPED_TRACE(testing::Message() << p.name << ", method " << method << ", form " << static_cast<int>(form));
    const sfdae_options options = multibody_options(tolerance, method);
    MultibodyRun special(system, MultibodyForm::recorded, options), general(system, form, options);
    ASSERT_EQ(special.start(p.t0, end, p.x0), SFDAE_OK) << special.text(-1);
    const std::vector<double> consistent = special.x;
    for (auto* run : {&special, &general}) {
      const int status = run->integrate(p.t0, end, consistent);
      ASSERT_EQ(status, SFDAE_OK) << run->text(status);
    }
    EXPECT_EQ(special.values(), general.values());
    const double size = std::max(1.0, largest_entry(general.x));
    for (std::size_t i = 0; i < general.x.size(); ++i)
      EXPECT_NEAR(special.x[i], general.x[i], 300.0 * tolerance * size) << i;
  }
}

TEST(MultibodySystems, MoveAsTheGeneralPathSays) {
  for_each_multibody_model([](const TestProblem& p, const auto& system) {
    if (p.name == "fekete" || p.name == "slider_crank") return;  // long, and of unclear ranks
    expect_the_same_motion(p, system, MultibodyForm::extended);
    if (p.name != "andrews") expect_the_same_motion(p, system, MultibodyForm::general);
  });
}

// Ranks are clear in faster units of time only.
TEST(MultibodySystems, MoveAsTheWholeArrayOfAndrewsSqueezerSays) {
  for_each_multibody_model([](const TestProblem& p, const auto& system) {
    if (p.name == "andrews") expect_the_same_motion(p, system, MultibodyForm::general);
  });
}

}  // namespace
