// SPDX-License-Identifier: BSD-3-Clause
//
// Tests of parameters that change between two calls, as a controller changes them: the integration goes on as at a jump
// of data. Exact solutions piece by piece. SFDAE_TEST_SCALE scales the number of random problems.

#include <sfdae/sfdae.hpp>
#include <sfdae/solution.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "family_run.h"
#include "random_family.h"
#include "solver_options.h"

namespace changed_parameters {
namespace {

using sfdae::ConstExpressions;
using sfdae::Expression;
using sfdae::Expressions;
using sfdae_test::RandomNumbers;
using Vector = std::vector<double>;

// A divider of two capacitors, one with a parallel resistor, and a source u: i = u' - v' = rate v + v', charge' = i. An
// independent part: z' = gain (u - z), w = z^3. Unknowns: source, v, i, charge, z, w.
sfdae::NonlinearProblem divider() {
  sfdae::NonlinearProblem problem(6, 6);
  problem.equations = [](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    const Expression u = sfdae::parameter(t, "u", 0.0), rate = sfdae::parameter(t, "rate", 1.0),
                     gain = sfdae::parameter(t, "gain", 1.0);
    F[0] = x[2] - (xdot[0] - xdot[1]);
    F[1] = x[2] - xdot[1] - rate * x[1];
    F[2] = x[0] - u;
    F[3] = xdot[3] - x[2];
    F[4] = xdot[4] - gain * (u - x[4]);
    F[5] = x[5] - x[4] * x[4] * x[4];
  };
  return problem;
}

struct Exact {
  double u = 0.0, rate = 1.0, gain = 1.0, v = 0.0, z = 0.0;
  void set_source(double next) {
    v += 0.5 * (next - u);
    u = next;
  }
  void move(double h) {
    v *= std::exp(-0.5 * rate * h);
    z = u + (z - u) * std::exp(-gain * h);
  }
  Vector x() const { return {u, v, 0.5 * rate * v, u - v, z, z * z * z}; }
};

void expect_near(const Vector& x, const Vector& exact, double tolerance, double t) {
  for (std::size_t i = 0; i < x.size(); ++i)
    EXPECT_NEAR(x[i], exact[i], 100.0 * tolerance * (1.0 + std::fabs(exact[i]))) << "x[" << i << "] at t = " << t;
}

TEST(ChangedParameters, AreJumpsOfData) {
  RandomNumbers random(38200);
  for (int trial = 0; trial < sfdae_test::scaled_count(100, 10); ++trial) {
    const int method = random.integer(0, 2);
    const double tolerance = std::pow(10.0, -random.integer(3, 8));
    const double direction = random.integer(0, 3) == 0 ? -1.0 : 1.0;
    SCOPED_TRACE("trial " + std::to_string(trial) + ", method " + std::to_string(method) + ", tolerance " +
                 std::to_string(tolerance) + ", direction " + std::to_string(direction));
    sfdae::Solver solver(divider(), sfdae_test::solver_options(tolerance, method));
    sfdae::Solution solution;
    Exact exact;
    sfdae::Point point{0.0, exact.x(), {}};
    solver.record(solution);
    solver.start(point, direction * 10.0);
    std::vector<double> times;
    std::vector<Vector> outputs;
    for (int call = 0; call < 12; ++call) {
      if (random.integer(0, 2) > 0) {
        const double u = random.uniform(-2.0, 2.0);
        solver.set_parameter("u", u);
        exact.set_source(u);
        if (random.integer(0, 1) == 0) solver.set_parameter("rate", exact.rate = random.uniform(0.2, 3.0));
        if (random.integer(0, 1) == 0)
          solver.set_parameter("gain", exact.gain = random.uniform(0.2, 5.0) * direction);
      }
      const double h = direction * random.uniform(0.01, 0.8), t = point.t + h;
      ASSERT_EQ(solver.advance(t, point), SFDAE_OK) << solver.message();
      exact.move(h);
      expect_near(point.x, exact.x(), tolerance, t);
      times.push_back(t);
      outputs.push_back(exact.x());
    }
    // The recorded solution is that of all pieces.
    for (std::size_t k = 0; k < times.size(); ++k)
      expect_near(solution(times[k] - direction * 1e-9).x, outputs[k], std::max(tolerance, 1e-8), times[k]);
    EXPECT_GT(solver.statistics().steps, 12);
  }
}

TEST(ChangedParameters, DoNotLoseWhatHasBeenCounted) {
  sfdae::NonlinearProblem problem(1, 1);
  problem.equations = [](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] - choose(x[0] > sfdae::parameter(t, "level", 0.5), 2.0, 1.0);
  };
  sfdae::Solver solver(problem, sfdae_test::solver_options(1e-6, SFDAE_METHOD_BDF));
  sfdae::Point point{0.0, {0.0}, {}};
  solver.start(point, 2.0);
  solver.advance(0.6, point);
  const long steps = solver.statistics().steps;
  solver.set_parameter("level", 1.0);
  EXPECT_EQ(solver.statistics().steps, steps);
  EXPECT_EQ(solver.switches().size(), 1u);
  EXPECT_NEAR(point.x[0], 0.7, 1e-5);
  solver.advance(1.0, point);  // x' = 1 up to x = 1
  EXPECT_NEAR(point.x[0], 1.2, 1e-5);
  EXPECT_EQ(solver.switches().size(), 2u);
  EXPECT_GT(solver.statistics().steps, steps);
}

// While x moves along a surface: a block at rest breaks loose when it is pulled harder.
TEST(ChangedParameters, ApplyWhileBlocksAreAtRest) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    sfdae::NonlinearProblem problem(1, 1);
    problem.equations = [](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
      F[0] = xdot[0] + choose(x[0] > 0.0, 1.0, -1.0) - sfdae::parameter(t, "pull", 0.5);
    };
    sfdae::Solver solver(problem, sfdae_test::solver_options(1e-6, method));
    sfdae::Point point{0.0, {0.25}, {}};
    solver.start(point, 3.0);
    solver.advance(1.0, point);  // at rest from t = 0.5 on
    EXPECT_NEAR(point.x[0], 0.0, 1e-5);
    const long steps = solver.statistics().steps;
    solver.set_parameter("pull", 1.5);
    EXPECT_EQ(solver.statistics().steps, steps);
    solver.advance(2.0, point);
    EXPECT_NEAR(point.x[0], 0.5, 1e-4);
    solver.set_parameter("pull", 0.0);
    solver.advance(3.0, point);
    EXPECT_NEAR(point.x[0], 0.0, 1e-4);
  }
}

// Between the change and the next call nothing is known within the last step; steps go where they are asked to go.
TEST(ChangedParameters, AreNamedBeforeTheNextCall) {
  sfdae::Solver solver(divider(), sfdae_test::solver_options(1e-6, SFDAE_METHOD_BDF));
  sfdae::Point point{0.0, Vector(6), {}};
  solver.start(point, 2.0);
  solver.advance(0.5, point);
  solver.set_parameter("u", 1.0);
  sfdae::Point within{0.4, Vector(6), {}};
  try {
    solver.interpolate(within);
    ADD_FAILURE() << "no error";
  } catch (const sfdae::Error& error) {
    EXPECT_EQ(error.status(), SFDAE_NOT_STARTED);
    EXPECT_NE(std::string(error.what()).find("sfdae_advance"), std::string::npos) << error.what();
  }
  sfdae::Solution solution;
  solver.record(solution);
  solver.advance(1.0, point);
  EXPECT_NEAR(solution(0.75).x[0], 1.0, 1e-5);
}

// A change that the equations do not allow fails, and the point stays: the next value goes on from there.
TEST(ChangedParameters, MayBeTakenBack) {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] + x[1];
    F[1] = x[1] * x[1] - sfdae::parameter(t, "square", 1.0);
  };
  sfdae::Solver solver(problem, sfdae_test::solver_options(1e-7, SFDAE_METHOD_RADAU));
  sfdae::Point point{0.0, {1.0, 1.0}, {}};
  solver.start(point, 2.0);
  solver.advance(0.5, point);
  solver.set_parameter("square", -1.0);
  EXPECT_THROW(solver.advance(1.0, point), sfdae::Error);
  solver.set_parameter("square", 4.0);
  ASSERT_EQ(solver.advance(1.0, point), SFDAE_OK) << solver.message();
  EXPECT_NEAR(point.x[0], -0.5, 1e-5);
  EXPECT_NEAR(point.x[1], 2.0, 1e-5);
}

TEST(ChangedParameters, NeedAStartWithSensitivities) {
  sfdae::Solver solver(divider(), sfdae_test::solver_options(1e-6, SFDAE_METHOD_BDF));
  sfdae::Point point{0.0, Vector(6), {}};
  sfdae::Sensitivities wanted;
  wanted.parameters = {"gain"};
  solver.set_sensitivities(wanted);
  solver.start(point, 2.0);
  solver.advance(0.5, point);
  solver.set_parameter("gain", 2.0);
  try {
    solver.advance(1.0, point);
    ADD_FAILURE() << "no error";
  } catch (const sfdae::Error& error) {
    EXPECT_EQ(error.status(), SFDAE_NOT_STARTED);
  }
}

}  // namespace
}  // namespace changed_parameters
