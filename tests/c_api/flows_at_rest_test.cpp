// SPDX-License-Identifier: BSD-3-Clause
//
// Tests of equations that are singular where a flow is zero, which comes to rest, turns or starts there.
// SFDAE_TEST_SCALE scales the number of random problems.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "family_run.h"
#include "motion_in_pieces.h"
#include "random_family.h"
#include "solver_options.h"

namespace flows_at_rest {
namespace {

using sfdae::ConstExpressions;
using sfdae::Expression;
using sfdae::Expressions;
using sfdae_test::RandomNumbers;
using Vector = std::vector<double>;
using Inflow = std::function<Expression(const Expression& t)>;

constexpr int laws = 4;
Expression resistance(int law, const Expression& q) {
  switch (law) {
    case 0: return q * abs(q);
    case 1: return q * q * q;
    case 2: return sign(q) * q * q;
    default: return choose(q > 0.0, q * q, -q * q);
  }
}
double exponent(int law) { return law == 1 ? 3.0 : 2.0; }

sfdae::Options with(int method, double tolerance) { return sfdae_test::solver_options(tolerance, method); }

// Two tanks with levels x_0 and x_1, and a pipe: x_0' = inflow - q, x_1' = q, k resistance(q) = x_0 - x_1.
sfdae::NonlinearProblem tanks(int law, double k, const Inflow& inflow = {}) {
  sfdae::NonlinearProblem problem(3, 3);
  problem.equations = [=](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] + x[2];
    if (inflow) F[0] = F[0] - inflow(t);
    F[1] = xdot[1] - x[2];
    F[2] = k * resistance(law, x[2]) - (x[0] - x[1]);
  };
  return problem;
}

// The difference of levels d falls by d' = -2 (d / k)^(1 / p) from d_0 until it is zero.
struct Fall {
  double d0, k, p;
  double rate() const { return 2.0 * (1.0 - 1.0 / p) / std::pow(k, 1.0 / p); }
  double rests_at() const { return std::pow(d0, 1.0 - 1.0 / p) / rate(); }
  double at(double t) const {
    const double power = std::pow(d0, 1.0 - 1.0 / p) - rate() * t;
    return power > 0.0 ? std::pow(power, p / (p - 1.0)) : 0.0;
  }
};

// None is wrong, and at most 5 % end by name, near rest.
TEST(FlowsAtRest, ComeToRest) {
  const int count = sfdae_test::scaled_count(100, 16);
  std::vector<std::string> named;
  for (int seed = 0; seed < count; ++seed) {
    SCOPED_TRACE("tanks " + std::to_string(seed));
    RandomNumbers random(9300 + static_cast<std::uint64_t>(seed));
    const int law = random.integer(0, laws - 1);
    const double tolerance = std::pow(10.0, -random.uniform(4.0, 7.0)), low = random.uniform(-1.0, 1.0);
    const Fall fall{random.uniform(0.2, 2.0), random.uniform(0.3, 3.0), exponent(law)};
    const int method = random.integer(0, 1) == 0 ? SFDAE_METHOD_BDF : SFDAE_METHOD_RADAU;
    sfdae::Options options = with(method, tolerance);
    options.max_steps = 5000;
    sfdae::Solver solver(tanks(law, fall.k), options);
    sfdae::Point point{0.0, {low + fall.d0, low, 0.0}, {}};
    const double end = 3.0 * fall.rests_at();
    solver.start(point, end);
    for (double part : {0.7, 0.97, 1.5, 3.0}) {
      const double t = part * fall.rests_at(), mean = low + 0.5 * fall.d0;
      try {
        solver.advance(t, point);
      } catch (const sfdae::Error& error) {
        named.push_back("tanks " + std::to_string(seed) + ": " + error.what());
        break;
      }
      EXPECT_NEAR(point.x[0], mean + 0.5 * fall.at(t), 100.0 * tolerance) << "law " << law << ", t " << t;
      EXPECT_NEAR(point.x[1], mean - 0.5 * fall.at(t), 100.0 * tolerance) << "law " << law << ", t " << t;
    }
    EXPECT_NEAR(point.x[2], 0.0, 10.0 * std::sqrt(tolerance));
  }
  EXPECT_LE(named.size(), static_cast<std::size_t>(count / 20 + 1)) << named.front();
}

// A pump begins to work at t = 1, at once or slowly; in the end half of what it gives flows through the pipe. (If the
// pump begins slowly, and q^3 or the tolerances are so flat, the change of the index is noticed late, and named.)
TEST(FlowsAtRest, StartFromRest) {
  const Inflow at_once = [](const Expression& t) { return choose(t > 1.0, 0.1, 0.0); };
  const Inflow slowly = [](const Expression& t) { return 0.1 * min(max(t - 1.0, 0.0), 1.0); };
  for (int law = 0; law < laws; ++law)
    for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
      for (double tolerance : {1e-4, 1e-7})
        for (bool is_slow : {false, true}) {
          if (is_slow && (exponent(law) > 2.0 || tolerance > 1e-6)) continue;
          sfdae::Solver solver(tanks(law, 1.0, is_slow ? slowly : at_once), with(method, tolerance));
          sfdae::Point point{0.0, {0.2, 0.2, 0.0}, {}};
          solver.start(point, 6.0);
          solver.advance(6.0, point);
          const double given = is_slow ? 0.45 : 0.5, difference = std::pow(0.05, exponent(law));
          EXPECT_NEAR(point.x[0] + point.x[1], 0.4 + given, 100.0 * tolerance) << "law " << law;
          EXPECT_NEAR(point.x[0] - point.x[1], difference, 100.0 * tolerance) << "law " << law;
          EXPECT_NEAR(point.x[2], 0.05, 1e-2) << "law " << law;
        }
}

// The flow turns where the difference of levels changes its sign: with d' = cos t - 2 q and k so large that q is small.
TEST(FlowsAtRest, TurnAgainAndAgain) {
  for (int law = 0; law < laws; ++law)
    for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      const auto levels = [&](double tolerance) {
        sfdae::Solver solver(tanks(law, 5.0, [](const Expression& t) { return cos(t); }), with(method, tolerance));
        sfdae::Point point{0.0, {0.1, 0.1, 0.0}, {}};
        solver.start(point, 12.0);
        solver.advance(12.0, point);
        EXPECT_NEAR(point.x[0] + point.x[1], 0.2 + std::sin(12.0), 100.0 * tolerance) << "law " << law;
        return point.x;
      };
      const auto slopes = [&](double t, const Vector& d) {
        return Vector{std::cos(t) - 2.0 * std::copysign(std::pow(std::fabs(d[0]) / 5.0, 1.0 / exponent(law)), d[0])};
      };
      const double d = sfdae_test::runge_kutta(slopes, {0.0}, 12.0, 120000)[0];
      for (double tolerance : {1e-4, 1e-6}) {
        const Vector x = levels(tolerance);
        EXPECT_NEAR(x[0] - x[1], d, 100.0 * tolerance) << "law " << law << ", method " << method;
      }
    }
}

TEST(FlowsAtRest, AreInReportsAndCheckpoints) {
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    const Inflow pump = [](const Expression& t) { return choose(t > 1.0, 0.1, 0.0); };
    sfdae::Solver first(tanks(0, 1.0, pump), with(method, 1e-6)), second(tanks(0, 1.0, pump), with(method, 1e-6));
    sfdae::Point point{0.0, {0.2, 0.2, 0.0}, {}};
    first.start(point, 3.0);
    first.advance(0.5, point);
    EXPECT_EQ(first.report().find("flat"), std::string::npos);
    first.advance(1.5, point);
    EXPECT_NE(first.report().find("flat: 1, the first in equation 2 by x[2]"), std::string::npos) << first.report();
    second.restore_checkpoint(first.save_checkpoint());
    sfdae::Point other = point;
    first.advance(3.0, point);
    second.advance(3.0, other);
    EXPECT_EQ(point.x, other.x);
  }
}

// These end by name: z^2 = x has no solution for x < 0, and z^3 = x z has three for x > 0.
TEST(FlowsAtRest, LeaveOtherSingularPoints) {
  using Law = std::function<Expression(const Expression& x, const Expression& z)>;
  const Law fold = [](const Expression& x, const Expression& z) { return z * z - x; };
  const Law fork = [](const Expression& x, const Expression& z) { return z * z * z + x * z; };
  for (bool is_fold : {true, false})
    for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      sfdae::NonlinearProblem problem(2, 2);
      problem.equations = [law = is_fold ? fold : fork](const Expression&, ConstExpressions x, ConstExpressions xdot,
                                                        Expressions F) {
        F[0] = xdot[0] + 1.0;
        F[1] = law(x[0], x[1]);
      };
      sfdae::Solver solver(problem, with(method, 1e-6));
      sfdae::Point point{0.0, {1.0, is_fold ? 1.0 : 0.0}, {}};
      solver.start(point, 2.0);
      EXPECT_THROW(solver.advance(2.0, point), sfdae::Error) << "method " << method;
    }
}

}  // namespace
}  // namespace flows_at_rest
