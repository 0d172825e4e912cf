// SPDX-License-Identifier: BSD-3-Clause
// Problems without differential equations whose constraints have several solutions: inverse kinematics and dynamics
// of arms, roots of polynomials. Nothing but their own course limits steps.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "given_course.h"
#include "linalg/index.h"
#include "nonlinear_run.h"
#include "random.h"

namespace {

using namespace sfdae_test;
using sfdae::core::index;

// Problems whose first unknowns follow given courses.
struct Tracking {
  std::vector<GivenCourse> courses;
  int n;
  double rate;
  NonlinearEquations equations;
};

// The hand of an arm of two links, 1 and l long, follows that of an arm with given angles; the elbow stays 0.2 rad
// and more away from being straight, and 0.34 rad from being folded. with_torques: the torques at the joints are
// unknowns, too: strangeness index 2.
Tracking arm(Random& random, bool with_torques) {
  const double rate = std::pow(10.0, random.real(-2.0, 2.0)), side = random.integer(0, 1) == 0 ? 1.0 : -1.0;
  const auto course = [&](double mean, double amplitude) {
    return GivenCourse{mean, amplitude, rate * random.real(0.4, 1.2), random.real(0.0, 6.0)};
  };
  const GivenCourse shoulder = course(random.real(-1.0, 1.0), random.real(0.2, 1.5));
  const GivenCourse elbow = course(side * random.real(0.8, 2.2), random.real(0.1, 0.6));
  const double l = random.real(0.5, 1.5);
  const int n = with_torques ? 6 : 2;
  return {
      {shoulder, elbow}, n, rate, equations_of(n, n, [=](const auto& t, const auto* x, const auto* xdot, auto* F) {
        const Expression p = shoulder.value(t), q = elbow.value(t);
        F[0] = cos(x[0]) + l * cos(x[0] + x[1]) - (cos(p) + l * cos(p + q));
        F[1] = sin(x[0]) + l * sin(x[0] + x[1]) - (sin(p) + l * sin(p + q));
        if (!with_torques) return;
        F[2] = xdot[0] / rate - x[2];
        F[3] = xdot[1] / rate - x[3];
        F[4] = (2.0 + cos(x[1])) * xdot[2] / rate - x[4];
        F[5] = xdot[3] / rate + sin(x[0]) - x[5];
      })};
}

// x + 2 x^2 is given, x > 0.
Tracking root(Random& random) {
  const double rate = std::pow(10.0, random.real(-2.0, 2.0));
  const GivenCourse course{random.real(0.3, 0.8), random.real(0.05, 0.25), rate * random.real(0.4, 1.2),
                           random.real(0.0, 6.0)};
  return {{course}, 1, rate, equations_of(1, 1, [=](const auto& t, const auto* x, const auto*, auto* F) {
            const Expression q = course.value(t);
            F[0] = x[0] + 2.0 * x[0] * x[0] - (q + 2.0 * q * q);
          })};
}

void expect_followed(const std::function<Tracking(Random&)>& model, int structure) {
  for (unsigned seed = 0; seed < 60; ++seed)
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      Random random(seed);
      const Tracking tracking = model(random);
      const std::string what = "seed " + std::to_string(seed) + ", method " + std::to_string(method);
      sfdae_options options = options_with(std::pow(10.0, random.real(-8.0, -4.0)), method);
      options.structure = structure;
      NonlinearRun run(tracking.equations, options);
      const double t0 = random.real(-5.0, 5.0) / tracking.rate, end = t0 + random.real(0.5, 20.0) / tracking.rate;
      const int outputs = random.integer(1, 4);
      std::vector<double> guess(index(tracking.n), 0.0);
      for (std::size_t i = 0; i < tracking.courses.size(); ++i) guess[i] = tracking.courses[i].value(t0);
      ASSERT_GE(run.start(t0, end, guess), SFDAE_OK) << what << ": " << run.message();
      ASSERT_EQ(run.values().d, 0) << what;
      for (int k = 1; k <= outputs; ++k) {
        ASSERT_EQ(run.advance(t0 + (end - t0) * k / outputs), SFDAE_OK) << what << ": " << run.message();
        for (std::size_t i = 0; i < tracking.courses.size(); ++i)
          ASSERT_NEAR(run.x[i], tracking.courses[i].value(run.t), 10.0 * options.rtol * (1.0 + std::fabs(run.x[i])))
              << what;
      }
    }
}

}  // namespace

// Newton's method from a guess far away finds the other elbow, or whole turns of the joints.
TEST(AlgebraicCourses, OfArmsKeepTheirElbow) {
  for (const int structure : {SFDAE_STRUCTURE_OFF, SFDAE_STRUCTURE_AUTOMATIC})
    expect_followed([](Random& random) { return arm(random, false); }, structure);
}

TEST(AlgebraicCourses, OfArmsWithTorquesKeepTheirElbow) {
  for (const int structure : {SFDAE_STRUCTURE_OFF, SFDAE_STRUCTURE_AUTOMATIC})
    expect_followed([](Random& random) { return arm(random, true); }, structure);
}

TEST(AlgebraicCourses, OfRootsKeepTheirSign) { expect_followed(root, SFDAE_STRUCTURE_OFF); }

// Where the only solution jumps, it is followed after some refusals.
TEST(AlgebraicCourses, JumpWhereTheEquationsDo) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    NonlinearRun run(equations_of(1, 1,
                                  [](const auto& t, const auto* x, const auto*, auto* F) {
                                    F[0] = x[0] + x[0] * x[0] * x[0] - 5.0 * (1.0 + tanh(1e12 * (t - 0.3)));
                                  }),
                     options_with(1e-6, method));
    ASSERT_EQ(run.integrate(0.0, 1.0, {0.0}), SFDAE_OK) << run.message();
    EXPECT_NEAR(run.x[0], 2.0, 1e-5);
    EXPECT_LE(run.statistics().steps + run.statistics().error_failures, 200) << method;
  }
}
