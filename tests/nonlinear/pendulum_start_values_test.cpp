// Pendula in any units of length, mass and time, with forces of which nothing is known: positions and velocities that
// are consistent stay, others end nearby, and no search goes on for ever.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <vector>

#include "family_run.h"
#include "random.h"
#include "sfdae/sfdae.hpp"

namespace {

using sfdae_test::Random;

struct Case {
  double length, mass, gravity, angle, speed;
  double off;    // of the length: positions given are that much too far away
  double force;  // given
  double tolerance;
};

std::ostream& operator<<(std::ostream& out, const Case& c) {
  return out << c.length << " long, mass " << c.mass << ", gravity " << c.gravity << ", angle " << c.angle
             << ", speed " << c.speed << ", off by " << c.off << ", force " << c.force << ", tolerance "
             << c.tolerance;
}

Case random_case(unsigned seed) {
  Random random(seed);
  Case c{};
  c.length = std::pow(10.0, random.real(-4.0, 4.0));
  c.mass = std::pow(10.0, random.real(-3.0, 3.0));
  c.gravity = std::pow(10.0, random.real(0.0, 2.0));
  c.angle = random.real(-3.1, 3.1);
  c.speed = random.real(-3.0, 3.0) * std::sqrt(c.length * c.gravity);
  c.off = seed % 3 == 0 ? 0.0 : std::pow(10.0, random.real(-7.2, -0.8));
  c.force = seed % 2 == 0 ? 0.0 : random.real(-1.0, 1.0) * std::pow(10.0, random.real(-4.0, 4.0));
  c.tolerance = seed % 5 < 3 ? 1e-6 : 1e-9;
  return c;
}

// How far the start has moved position and velocity from the nearest consistent ones, relative; or the status that
// says why there is none.
struct Outcome {
  int status;
  double distance;
};

Outcome outcome(const Case& c, int structure) {
  sfdae::NonlinearProblem pendulum(5, 5);
  pendulum.equations = [c](const sfdae::Expression&, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = c.mass * xdot[2] + x[0] * x[4];
    F[3] = c.mass * xdot[3] + x[1] * x[4] + c.mass * c.gravity;
    F[4] = x[0] * x[0] + x[1] * x[1] - c.length * c.length;
  };
  sfdae::Options options;
  options.structure = structure;
  options.rtol = options.atol = c.tolerance;
  sfdae::Solver solver(pendulum, options);
  const double cosine = std::cos(c.angle), sine = std::sin(c.angle), length = c.length * (1.0 + c.off);
  sfdae::Point point{12.5, {length * cosine, length * sine, -c.speed * sine, c.speed * cosine, c.force}, {}};
  try {
    const int status = solver.start(point, 13.0);
    const std::vector<double>& x = point.x;
    const double moved = std::hypot(x[0] - c.length * cosine, x[1] - c.length * sine) / c.length;
    const double turned =
        std::hypot(x[2] + c.speed * sine, x[3] - c.speed * cosine) / (std::fabs(c.speed) + c.length);
    return {status, std::max(moved, turned)};
  } catch (const sfdae::Error& error) {
    return {error.status(), 0.0};
  }
}

// Norms of digits may prefer another direction; the other side of the support is 2 lengths away.
double most_moved(const Case& c) { return c.off + 1e-9; }

TEST(PendulumStartValues, StayNearInAnyUnits) {
  const int trials = sfdae_test::scaled_count(600);
  int refused = 0;
  for (int structure : {SFDAE_STRUCTURE_OFF, SFDAE_STRUCTURE_REQUIRED})
    for (int trial = 0; trial < trials; ++trial) {
      const Case c = random_case(static_cast<unsigned>(trial));
      const Outcome found = outcome(c, structure);
      if (found.status == SFDAE_RANK_UNCLEAR) ++refused;
      else EXPECT_GE(found.status, SFDAE_OK) << "trial " << trial << ": " << c;
      EXPECT_LE(found.distance, most_moved(c)) << "trial " << trial << ", structure " << structure << ": " << c;
    }
  EXPECT_LE(refused, 1 + trials / 50);
}

// Steps halved residuals again and again, each time in other units.
TEST(PendulumStartValues, AreFoundInTheEnd) {
  for (const Case& c : {Case{0.0066452948414492492, 0.016138619871164522, 1.0892596500853882, 1.6217221520940095,
                             0.24808186588501091, 0.041891416135515482, 121.3945591504099, 1e-6},
                        Case{0.00014540546406416436, 4.4157702040832048, 17.427116908492188, -1.542429604147358,
                             0.061307197657926936, 0.0079909974897174451, 95.787564753089015, 1e-9}}) {
    const Outcome found = outcome(c, SFDAE_STRUCTURE_OFF);
    EXPECT_GE(found.status, SFDAE_OK) << c;
    EXPECT_LE(found.distance, most_moved(c)) << c;
  }
}

}  // namespace
