// SPDX-License-Identifier: BSD-3-Clause
//
// Tests of many kinks and small jumps of inputs that are differentiated: each may be below the tolerances, but they add
// up. Exact solutions piece by piece. SFDAE_TEST_SCALE scales the number of random problems.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "family_run.h"
#include "random_family.h"
#include "solver_options.h"

namespace many_kinks {
namespace {

using sfdae::ConstExpressions;
using sfdae::Expression;
using sfdae::Expressions;
using sfdae_test::RandomNumbers;
using Vector = std::vector<double>;

// y = unit floor(steps t) / steps, w = y', z' = gain w: z = gain y from the start on.
sfdae::NonlinearProblem staircase(int steps, double gain, double unit, double turn) {
  sfdae::NonlinearProblem problem(3, 3);
  problem.equations = [=](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    const Expression charge = xdot[0] / gain - x[2], current = x[2] - xdot[1];
    F[0] = std::cos(turn) * charge + std::sin(turn) * current;
    F[1] = x[1] - unit * floor(steps * t) / steps;
    F[2] = std::cos(turn) * current - std::sin(turn) * charge;
  };
  return problem;
}

TEST(ManyKinks, StaircasesAddUp) {
  RandomNumbers random(36200);
  for (int trial = 0; trial < sfdae_test::scaled_count(100, 10); ++trial) {
    const int method = random.integer(0, 1), steps = static_cast<int>(std::pow(10.0, random.uniform(0.5, 3.0)));
    const double tolerance = std::pow(10.0, -random.integer(2, 6)), gain = std::pow(10.0, random.uniform(-1.0, 3.0)),
                 unit = std::pow(10.0, random.uniform(-3.0, 3.0)), turn = random.uniform(0.0, 1.5);
    SCOPED_TRACE("trial " + std::to_string(trial) + ", steps " + std::to_string(steps) + ", gain " +
                 std::to_string(gain) + ", method " + std::to_string(method) + ", tolerance " +
                 std::to_string(tolerance));
    sfdae::Options options = sfdae_test::solver_options(tolerance, method);
    options.atol = tolerance * unit;
    sfdae::Solver solver(staircase(steps, gain, unit, turn), options);
    sfdae::Point point{0.0, Vector(3), {}};
    const double end = 1.0 + 0.5 / steps;
    solver.start(point, end);
    ASSERT_EQ(solver.advance(end, point), SFDAE_OK) << solver.message();
    EXPECT_NEAR(point.x[0], gain * unit, 10.0 * tolerance * unit * (1.0 + gain));
    EXPECT_NEAR(point.x[1], unit, 10.0 * tolerance * unit);
  }
}

// A mass on a spring hangs on a slide whose position f is a broken line: s' = w, w' = drive + k (y - s), y' = v,
// v' = -k (y - s), s = f(t), strangeness index 2. The speed of the slide jumps, the mass does not notice.
struct Slide {
  double start, stiffness;
  Vector times, slopes;  // of f: slopes[k] from times[k] on; f(start) = 0

  double f(double t) const {
    double position = 0.0;
    for (std::size_t k = 0; k < times.size() && times[k] < t; ++k)
      position += slopes[k] * (std::min(t, k + 1 < times.size() ? times[k + 1] : t) - times[k]);
    return position;
  }
  double slope(double t) const {
    std::size_t k = 0;
    while (k + 1 < times.size() && times[k + 1] < t) ++k;
    return slopes[k];
  }
  // s, w, y, v: y - f is harmonic between kinks.
  Vector exact(double t) const {
    const double omega = std::sqrt(stiffness);
    double y = 0.0, v = 0.0;
    for (std::size_t k = 0; k < times.size() && times[k] < t; ++k) {
      const double end = std::min(t, k + 1 < times.size() ? times[k + 1] : t), h = end - times[k];
      const double from = y - f(times[k]), rate = v - slopes[k];
      y = f(end) + from * std::cos(omega * h) + rate / omega * std::sin(omega * h);
      v = slopes[k] - from * omega * std::sin(omega * h) + rate * std::cos(omega * h);
    }
    return {f(t), slope(t), y, v};
  }
};

Slide random_slide(RandomNumbers& random) {
  Slide slide{random.integer(0, 2) * random.uniform(0.0, 1000.0), random.uniform(0.5, 20.0), {}, {}};
  double t = slide.start;
  for (int k = random.integer(2, 40); k > 0; --k) {
    slide.times.push_back(t);
    slide.slopes.push_back(random.uniform(-1.0, 1.0));
    t += random.uniform(0.02, 0.3);
  }
  return slide;
}

sfdae::NonlinearProblem equations_of(const Slide& slide) {
  sfdae::NonlinearProblem problem(5, 5);
  problem.equations = [&slide](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    Expression f = slide.slopes[0] * (t - slide.start);
    for (std::size_t k = 1; k < slide.times.size(); ++k)
      f = f + (slide.slopes[k] - slide.slopes[k - 1]) * max(t - slide.times[k], 0.0);
    F[0] = xdot[0] - x[1];
    F[1] = xdot[1] - x[4] - slide.stiffness * (x[2] - x[0]);
    F[2] = xdot[2] - x[3];
    F[3] = xdot[3] + slide.stiffness * (x[2] - x[0]);
    F[4] = x[0] - f;
  };
  return problem;
}

TEST(ManyKinks, OfAPositionDriveLeaveWhatItDoesNotReach) {
  RandomNumbers random(36201);
  for (int trial = 0; trial < sfdae_test::scaled_count(100, 10); ++trial) {
    const Slide slide = random_slide(random);
    const int method = random.integer(0, 1);
    const double tolerance = std::pow(10.0, -random.integer(3, 8)), end = slide.times.back() + 0.1;
    SCOPED_TRACE("trial " + std::to_string(trial) + ", kinks " + std::to_string(slide.times.size() - 1) + ", start " +
                 std::to_string(slide.start) + ", method " + std::to_string(method) + ", tolerance " +
                 std::to_string(tolerance));
    sfdae::Solver solver(equations_of(slide), sfdae_test::solver_options(tolerance, method));
    sfdae::Point point{slide.start, {0.0, slide.slopes[0], 0.0, 0.0, 0.0}, {}};
    solver.start(point, end);
    for (int k = 1; k <= 10; ++k) {
      const double t = slide.start + (end - slide.start) * k / 10.0;
      ASSERT_EQ(solver.advance(t, point), SFDAE_OK) << solver.message();
      const Vector exact = slide.exact(t);
      for (std::size_t i = 0; i < exact.size(); ++i)
        ASSERT_NEAR(point.x[i], exact[i], 100.0 * tolerance) << "x[" << i << "] at t = " << t;
    }
  }
}

// A crane follows t times a triangle of 20 kinks, where a remainder and an absolute value switch at the same times. Its
// steps there are so short that slopes have to be known without differences of times.
Vector crane_at(double t, int method, double tolerance) {
  sfdae::NonlinearProblem problem(8, 8);
  problem.equations = [](const Expression& time, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    const Expression triangle = abs(modulo(10.0 * time, 2.0) - 1.0) / 10.0;  // s, p, q, w, u, v, drive, rope
    F[0] = xdot[0] - x[3];
    F[1] = xdot[1] - x[4];
    F[2] = xdot[2] - x[5];
    F[3] = 10.0 * xdot[3] - x[6] - (x[1] - x[0]) * x[7];
    F[4] = xdot[4] + (x[1] - x[0]) * x[7];
    F[5] = xdot[5] + x[2] * x[7] + 9.81;
    F[6] = (x[1] - x[0]) * (x[1] - x[0]) + x[2] * x[2] - 1.0;
    F[7] = x[0] - triangle * time;
  };
  sfdae::Solver solver(problem, sfdae_test::solver_options(tolerance, method));
  sfdae::Point point{0.0, {0.0, 0.0, -1.0, 0.1, 0.0, 0.0, 0.0, 0.0}, {}};
  solver.start(point, t);
  EXPECT_EQ(solver.advance(t, point), SFDAE_OK) << solver.message();
  return point.x;
}

TEST(ManyKinks, OfACraneAreThoseOfBothMethods) {
  constexpr double end = 1.98;
  const Vector exact = crane_at(end, SFDAE_METHOD_RADAU, 1e-10);
  for (const double tolerance : {1e-5, 1e-6, 1e-7, 3e-8, 1e-8})
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      const Vector x = crane_at(end, method, tolerance);
      for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(x[i], exact[i], 30.0 * tolerance) << "x[" << i << "]";
    }
}

}  // namespace
}  // namespace many_kinks
