// SPDX-License-Identifier: BSD-3-Clause
// A position that follows a path by a force, its equations mixed: in units of time that are too fast constraints
// vanish among rounding errors, and the force seems free.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "given_course.h"
#include "linalg/index.h"
#include "nonlinear_run.h"
#include "random.h"

namespace {

using namespace sfdae_test;
using sfdae::core::index;

// q' = v, m v' = -c v - k q + F, q or sin(q / 3) = path, and T F' = u - F, with terms that make the solution follow
// given courses: sums of these with random factors, in random units.
struct Servo {
  double rate, m, c, k, T;
  bool has_actuator, has_sine;
  std::vector<GivenCourse> courses;
  std::vector<double> mixing, of_x, of_F;
  int n() const { return has_actuator ? 4 : 3; }
  int mu() const { return has_actuator ? 3 : 2; }
  void residual(const Expression* x, const Expression* xdot, Expression* F) const {
    F[0] = xdot[0] - x[1];
    F[1] = m * xdot[1] - (x[2] - k * x[0] - c * x[1]);
    F[2] = has_sine ? sin(x[0] / 3.0) : x[0];
    if (has_actuator) F[3] = T * xdot[2] + x[2] - x[3];
  }
};

Servo random_servo(Random& random) {
  Servo servo;
  servo.rate = random.integer(0, 1) == 0 ? 1.0 : std::pow(10.0, random.real(-3.0, 3.0));
  const double M = std::pow(10.0, random.real(-3.0, 3.0)), rate = servo.rate;
  servo.m = M * std::pow(10.0, random.real(-1.0, 1.0));
  servo.c = M * rate * std::pow(10.0, random.real(-1.3, 0.3));
  servo.k = M * rate * rate * std::pow(10.0, random.real(-0.5, 1.0));
  servo.T = 0.3 / rate;
  servo.has_actuator = random.integer(0, 1) == 1;
  servo.has_sine = random.integer(0, 1) == 1;
  for (const double size : {1.0, rate, M * rate * rate, M * rate * rate})
    servo.courses.push_back({size * random.real(-0.5, 0.5), size * random.real(0.2, 0.7),
                             rate * random.real(0.4, 1.2), random.real(0.0, 6.0)});
  const int n = servo.n();
  servo.mixing = random.reals(n * n, -0.5, 0.5);
  for (int i = 0; i < n; ++i) servo.mixing[index(i + i * n)] += 1.0;
  const double most = random.integer(0, 1) == 0 ? 0.0 : random.real(0.0, 6.0);
  for (int i = 0; i < n; ++i) {
    servo.of_x.push_back(std::pow(10.0, random.real(-most, most)));
    servo.of_F.push_back(std::pow(10.0, random.real(-most, most)));
  }
  return servo;
}

NonlinearEquations equations_of_servo(const Servo& servo) {
  const int n = servo.n();
  return equations_of(n, n, [servo, n](const auto& t, const auto* x, const auto* xdot, auto* F) {
    std::vector<Expression> exact, slopes, of_x(index(n)), of_exact(index(n));
    for (const GivenCourse& course : servo.courses)
      exact.push_back(course.value(t)), slopes.push_back(course.slope(t));
    std::vector<Expression> of_user, slopes_of_user;
    for (int i = 0; i < n; ++i) {
      of_user.push_back(x[i] / servo.of_x[index(i)]);
      slopes_of_user.push_back(xdot[i] / servo.of_x[index(i)]);
    }
    servo.residual(of_user.data(), slopes_of_user.data(), of_x.data());
    servo.residual(exact.data(), slopes.data(), of_exact.data());
    for (int i = 0; i < n; ++i) {
      F[i] = 0.0;
      for (int j = 0; j < n; ++j)
        F[i] = F[i] + servo.mixing[index(i + j * n)] * (of_x[index(j)] - of_exact[index(j)]);
    }
  });
}

}  // namespace

TEST(LostConstraints, AreNotTakenForRedundantEquations) {
  // Of 60,000 seeds 197 were taken for problems with a free force: the first of these, and others.
  std::vector<unsigned> seeds = {495,  713,  1470, 1904, 1999, 2109, 2662, 2991,
                                 3197, 3679, 4155, 4734, 4831, 6020, 6142, 6265};
  for (unsigned seed = 0; seed < 200; ++seed) seeds.push_back(seed);
  int right = 0;
  for (const unsigned seed : seeds) {
    Random random(seed);
    const Servo servo = random_servo(random);
    sfdae_options options = options_with(1e-6, SFDAE_METHOD_RADAU);
    options.structure = SFDAE_STRUCTURE_OFF;
    NonlinearRun run(equations_of_servo(servo), options);
    std::vector<double> x;
    for (int i = 0; i < servo.n(); ++i) x.push_back(servo.of_x[index(i)] * servo.courses[index(i)].value(0.0));
    const int status = run.analyze(0.0, 1.0 / servo.rate, x);
    if (status == SFDAE_RANK_UNCLEAR) continue;
    EXPECT_EQ(status, SFDAE_OK) << "seed " << seed << ": " << run.message();
    EXPECT_EQ(run.values().mu, servo.mu()) << "seed " << seed;
    ++right;
  }
  EXPECT_GE(right, 180);
}
