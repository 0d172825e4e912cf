// Start values by the minimal extension: what does not stay by itself, forces that nobody knows, moves nothing else.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "random.h"
#include "sensitivity_problems.h"
#include "sfdae/sfdae.hpp"

namespace {

using sfdae_test::Random;
using Vector = std::vector<double>;

// Rods that turn as one, and no forces.
Vector turning_chain(int links, double speed) {
  Vector x;
  for (int i = 1; i <= links; ++i) x.insert(x.end(), {0.8 * i, -0.6 * i, speed * 0.6 * i, speed * 0.8 * i, 0.0});
  return x;
}

struct Start {
  int status;
  Vector x;
};

Start start(const sfdae::NonlinearProblem& problem, Vector x, int structure, double tolerance) {
  sfdae::Options options;
  options.structure = structure;
  options.rtol = tolerance;
  options.atol = {tolerance};
  sfdae::Solver solver(problem, options);
  sfdae::Point point{0.0, std::move(x), {}};
  const int status = solver.start(point, 1.0);
  return {status, point.x};
}

// Of the tolerances: changes that the search does not mind.
constexpr double negligible = 1e-6;

// Forces are not.
bool is_state(std::size_t j) { return j % 5 != 4; }

TEST(ExtensionStartValues, StayWhereTheyAreConsistent) {
  for (int links : {3, 6, 16, 30})
    for (double speed : {0.0, 1.0, -3.0})
      for (double tolerance : {1e-10, 1e-6, 1e-3}) {
        SCOPED_TRACE(testing::Message() << links << " links, speed " << speed << ", tolerance " << tolerance);
        const Vector given = turning_chain(links, speed);
        const Start found = start(sfdae_test::chain_of_rods(links), given, SFDAE_STRUCTURE_REQUIRED, tolerance);
        EXPECT_EQ(found.status, SFDAE_OK);
        EXPECT_GT(std::fabs(found.x[4]), 1.0);
        for (std::size_t j = 0; j < given.size(); ++j)
          if (is_state(j)) {
            EXPECT_NEAR(found.x[j], given[j], (1e-15 + negligible * tolerance) * links * (1.0 + std::fabs(speed)))
                << j;
          }
      }
}

TEST(ExtensionStartValues, AreNearestAsThoseOfTheArray) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    Random random(seed);
    const int links = 2 + static_cast<int>(seed % 4);
    const double distance = seed % 3 == 0 ? 0.05 : seed % 3 == 1 ? 1e-3 : 1e-5;
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", distance " << distance);
    Vector given = turning_chain(links, 1.0);
    for (std::size_t j = 0; j < given.size(); ++j)
      given[j] = is_state(j) ? given[j] + distance * random.real(-1.0, 1.0) : random.real(-100.0, 100.0);
    const auto problem = sfdae_test::chain_of_rods(links);
    const Start array = start(problem, given, SFDAE_STRUCTURE_OFF, 1e-8);
    const Start found = start(problem, given, SFDAE_STRUCTURE_REQUIRED, 1e-8);
    EXPECT_EQ(found.status, array.status);
    for (std::size_t j = 0; j < given.size(); ++j)
      EXPECT_NEAR(found.x[j], array.x[j], 1e-6 * distance * (is_state(j) ? 1.0 : 1e3)) << j;
  }
}

// Pendula given beside their circle, with speeds along their rods: both constraints are bent on the way to the
// nearest point.
TEST(ExtensionStartValues, AreNearestFromAfar) {
  sfdae::NonlinearProblem pendulum(5, 5);
  pendulum.equations = [](const sfdae::Expression&, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = xdot[2] + x[0] * x[4];
    F[3] = xdot[3] + x[1] * x[4] + 1.0;
    F[4] = x[0] * x[0] + x[1] * x[1] - 1.0;
  };
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const double angle = random.real(-3.0, 3.0), tolerance = seed % 2 == 0 ? 1e-4 : 1e-9;
    Vector given{std::cos(angle), std::sin(angle), random.real(-1.0, 1.0), random.real(-1.0, 1.0), 0.0};
    for (std::size_t j = 0; j < 2; ++j) given[j] += random.real(-0.2, 0.2);
    const Start found = start(pendulum, given, SFDAE_STRUCTURE_REQUIRED, tolerance);
    ASSERT_EQ(found.status, SFDAE_VALUES_CHANGED);
    const Vector& x = found.x;
    // Half the gradient of the sum of squares, along both directions that the constraints leave.
    double gradient[4], scale = 0.0;
    for (std::size_t j = 0; j < 4; ++j) {
      const double size = 1.0 + std::fabs(given[j]);
      gradient[j] = (x[j] - given[j]) / (size * size);
      scale = std::fmax(scale, std::fabs(gradient[j]));
    }
    const double turn = x[0] * x[3] - x[1] * x[2];
    EXPECT_LE(std::fabs(x[0] * gradient[3] - x[1] * gradient[2]), 0.2 * tolerance + 1e-12);
    EXPECT_LE(std::fabs(x[0] * gradient[1] - x[1] * gradient[0] - turn * (x[0] * gradient[2] + x[1] * gradient[3])),
              0.2 * tolerance + 1e-12);
    EXPECT_GT(scale, 1e-4);
  }
}

// A heavy pendulum of a millimetre in SI units: the force for each length is 1e10, and its guess 0.
TEST(ExtensionStartValues, AreMovedByNoLargeForce) {
  const double length = 1e-3, mass = 1e3;
  sfdae::NonlinearProblem pendulum(5, 5);
  pendulum.equations = [=](const sfdae::Expression&, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = mass * xdot[2] + x[0] * x[4];
    F[3] = mass * xdot[3] + x[1] * x[4] + mass * 9.81;
    F[4] = x[0] * x[0] + x[1] * x[1] - length * length;
  };
  for (double off : {0.0, 1e-7, 1e-5}) {
    SCOPED_TRACE(off);
    const double angle = -0.7, speed = 0.05;
    const double c = std::cos(angle), s = std::sin(angle);
    const Vector given{(length + off) * c, (length + off) * s, -speed * s, speed * c, 0.0};
    const Vector nearest{length * c, length * s, given[2], given[3]};
    const Start found = start(pendulum, given, SFDAE_STRUCTURE_REQUIRED, 1e-9);
    EXPECT_EQ(found.status, off > 0.0 ? SFDAE_VALUES_CHANGED : SFDAE_OK);
    EXPECT_NEAR(found.x[4], mass * (speed * speed - 9.81 * length * s) / (length * length), 1e-2 * found.x[4]);
    for (std::size_t j = 0; j < 4; ++j) EXPECT_NEAR(found.x[j], nearest[j], 1e-10) << j;
  }
}

// A long rod and a stiff elongation, given with nine digits: what these leave open is the rod's.
TEST(ExtensionStartValues, MoveByLastDigits) {
  sfdae::NonlinearProblem rod(5, 5);
  const double sum = 0.450016932999, length = 0.45, elongation = 1.69327969e-5;
  rod.equations = [=](const sfdae::Expression&, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = xdot[2] + x[0] + x[4];
    F[3] = xdot[3] + 1e8 * x[1] + x[4];
    F[4] = x[0] + x[1] - sum;
  };
  const double off = sum - length - elongation;
  ASSERT_GT(std::fabs(off), 1e-10);
  for (int structure : {SFDAE_STRUCTURE_OFF, SFDAE_STRUCTURE_REQUIRED})
    for (double tolerance : {1e-8, 1e-6, 1e-4}) {
      SCOPED_TRACE(testing::Message() << "structure " << structure << ", tolerance " << tolerance);
      const Start found = start(rod, {length, elongation, 0.1, -0.1, 0.0}, structure, tolerance);
      EXPECT_EQ(found.status, SFDAE_OK);
      EXPECT_NEAR(found.x[0], length + off, 1e-5 * std::fabs(off));
      EXPECT_NEAR(found.x[1], elongation, 1e-5 * std::fabs(off));
    }
  // More than digits: the nearest point by the tolerances.
  const double far = 1e-5, weight = (1.0 + length) * (1.0 + length);
  const Start found = start(rod, {length + far, elongation, 0.1, -0.1, 0.0}, SFDAE_STRUCTURE_REQUIRED, 1e-4);
  EXPECT_EQ(found.status, SFDAE_OK);
  EXPECT_NEAR(found.x[1] - elongation, (off - far) / (1.0 + weight), 1e-3 * far);
}

}  // namespace
