// SPDX-License-Identifier: BSD-3-Clause
// Tolerances near what rounding errors allow.
#include <gtest/gtest.h>

#include "multibody/models.h"
#include "multibody/multibody_run.h"

namespace {

using namespace sfdae_test;

// Andrews' squeezer has velocities of 1e3 and 1; the reference is good to 15 digits.
void expect_digits(double tolerance, int method, double digits) {
  for_each_multibody_model([=](const TestProblem& p, const auto& system) {
    if (p.name != "andrews") return;
    SCOPED_TRACE(testing::Message() << "tolerance " << tolerance << ", method " << method);
    MultibodyRun run(system, MultibodyForm::recorded, multibody_options(tolerance, method));
    const int status = run.integrate(p.t0, p.tf, p.x0);
    ASSERT_EQ(status, SFDAE_OK) << run.text(status);
    EXPECT_GE(correct_digits(p, p.references.back(), run.x.data()), digits);
  });
}

TEST(TightTolerances, AreReachedByBothMethods) {
  for (const double tolerance : {1e-9, 1e-10}) expect_digits(tolerance, SFDAE_METHOD_BDF, 7.0);
  for (const double tolerance : {1e-10, 1e-12}) expect_digits(tolerance, SFDAE_METHOD_RADAU, 9.0);
}

// The rounding errors of small velocities are those of the large ones that constraints couple them with: an iteration
// that compares each component with itself does not converge.
TEST(TightTolerances, AreReachedWhereComponentsDifferInSize) { expect_digits(1e-11, SFDAE_METHOD_BDF, 9.0); }

}  // namespace
