// SPDX-License-Identifier: BSD-3-Clause
//
// Sensitivities where equations switch, at times that depend on the parameters: differences of solutions say what they
// are.
#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace {

namespace switching {

using sfdae::ConstExpressions;
using sfdae::Expression;
using sfdae::Expressions;
using Vector = std::vector<double>;

constexpr double end = 2.0, p_now = 0.7;

struct Case {
  std::string name;
  int n;
  std::function<void(const Expression& t, const Expression& p, ConstExpressions x, ConstExpressions xdot,
                     Expressions F)>
      equations;
  bool has_kinks_alone = false;
};

std::vector<Case> all_cases() {
  const auto positive = [](const Expression& g) { return choose(g, 1.0, 0.0); };
  return {
      {"a step of t", 1, [=](auto t, auto p, auto, auto xdot, auto F) { F[0] = xdot[0] - positive(t - p); }},
      {"a step of x", 2,
       [=](auto, auto p, auto x, auto xdot, auto F) {
         F[0] = xdot[0] - positive(x[1] - 1.0) * p;
         F[1] = xdot[1] - p;
       }},
      {"a step of x in its own equation", 2,
       [=](auto, auto p, auto x, auto xdot, auto F) {
         F[0] = xdot[0] - choose(x[0] - p, 0.2, 1.0);
         F[1] = xdot[1] - p * sign(x[0] - 0.3);
       }},
      {"a periodic pulse", 1,
       [=](auto t, auto p, auto, auto xdot, auto F) { F[0] = xdot[0] - (1.0 + p) * positive(modulo(t, p) - 0.3); }},
      {"a staircase", 1, [](auto t, auto p, auto, auto xdot, auto F) { F[0] = xdot[0] - floor(1.9 * t / p); }},
      {"a table of a stretched time", 1,
       [](auto t, auto p, auto, auto xdot, auto F) {
         F[0] = xdot[0] - sfdae::table(t / p, 1, {0.0, 1.0, 2.0, 4.0}, {1.0, 3.0, -1.0, -1.0});
       },
       true},
      {"two conditions", 2,
       [=](auto t, auto p, auto x, auto xdot, auto F) {
         F[0] = xdot[0] + x[0] - positive(x[1] - 0.5 * p) + positive(x[1] - 1.1);
         F[1] = xdot[1] - 1.0 + 0.1 * sin(t) * p;
       }},
      {"a divider that t switches", 4,
       [=](auto t, auto p, auto x, auto xdot, auto F) {
         F[0] = x[0] - (xdot[2] - xdot[1]);
         F[1] = (xdot[2] - xdot[1]) - xdot[1] - x[1] * p;
         F[2] = x[2] - positive(t - p);
         F[3] = xdot[3] - 1.0;
       }},
      {"a divider that x switches", 4,
       [=](auto, auto p, auto x, auto xdot, auto F) {
         F[0] = x[0] - (xdot[2] - xdot[1]);
         F[1] = (xdot[2] - xdot[1]) - xdot[1] - x[1] * p;
         F[2] = x[2] - positive(x[3] - p);
         F[3] = xdot[3] - 1.0;
       }},
      {"a ramp that is differentiated", 4,
       [](auto, auto p, auto x, auto xdot, auto F) {
         F[0] = xdot[0] - x[1] * x[1];
         F[1] = x[2] - max(x[3] - p, 0.0);
         F[2] = xdot[2] - x[1];
         F[3] = xdot[3] - 1.0;
       }},
      {"a kink of t", 1, [](auto t, auto p, auto, auto xdot, auto F) { F[0] = xdot[0] - abs(sin(6.0 * t - p)); },
       true},
      {"a kink of x", 2,
       [](auto, auto p, auto x, auto xdot, auto F) {
         F[0] = xdot[0] - max(x[1] - p, 0.0);
         F[1] = xdot[1] - 1.0;
       },
       true}};
}

sfdae::NonlinearProblem problem_of(const Case& given) {
  sfdae::NonlinearProblem problem(given.n, given.n);
  problem.equations = [&given](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    given.equations(t, parameter(t, "p", p_now), x, xdot, F);
  };
  return problem;
}

Vector solution(const Case& given, sfdae::Options options, double p) {
  options.rtol = options.atol = 1e-10;
  sfdae::Solver solver(problem_of(given), options);
  solver.set_parameter("p", p);
  sfdae::Point point{0.0, Vector(static_cast<std::size_t>(given.n), 0.0), {}};
  solver.start(point, end);
  EXPECT_EQ(solver.advance(end, point), SFDAE_OK);
  return point.x;
}

Vector differences(const Case& given, const sfdae::Options& options) {
  constexpr double step = 1e-5;
  const Vector before = solution(given, options, p_now - step), after = solution(given, options, p_now + step);
  Vector result;
  for (std::size_t i = 0; i < after.size(); ++i) result.push_back((after[i] - before[i]) / (2.0 * step));
  return result;
}

template <class Test>
void for_all(Test test) {
  for (const Case& given : all_cases())
    for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
      for (int structure : {SFDAE_STRUCTURE_OFF, SFDAE_STRUCTURE_AUTOMATIC}) {
        sfdae::Options options;
        options.method = method;
        options.structure = structure;
        options.rtol = options.atol = 1e-7;
        SCOPED_TRACE(given.name + ", method " + std::to_string(method) + ", structure " + std::to_string(structure));
        test(given, options);
      }
}

TEST(SensitivitiesAtSwitches, AreThoseOfTheSolution) {
  for_all([](const Case& given, const sfdae::Options& options) {
    const Vector expected = differences(given, options);
    sfdae::Solver solver(problem_of(given), options);
    sfdae::Sensitivities wanted;
    wanted.parameters = {"p"};
    solver.set_sensitivities(wanted);
    sfdae::Point point{0.0, Vector(static_cast<std::size_t>(given.n), 0.0), {}};
    solver.start(point, end);
    ASSERT_EQ(solver.advance(end, point), SFDAE_OK);
    const sfdae::SensitivityValues found = solver.sensitivities(end);
    for (int i = 0; i < given.n; ++i) EXPECT_NEAR(found.S(i, 0), expected[static_cast<std::size_t>(i)], 1e-3) << i;
  });
}

// The adjoint goes over kinks, and ends by name where x' jumps.
TEST(SensitivitiesAtSwitches, OfTheAdjointAreThoseOfKinksAlone) {
  for_all([](const Case& given, const sfdae::Options& options) {
    sfdae::Solver solver(problem_of(given), options);
    sfdae::Sensitivities wanted;
    wanted.parameters = {"p"};
    wanted.adjoint = true;
    solver.set_sensitivities(wanted);
    sfdae::Point point{0.0, Vector(static_cast<std::size_t>(given.n), 0.0), {}};
    solver.start(point, end);
    try {
      ASSERT_EQ(solver.advance(end, point), SFDAE_OK);
      EXPECT_TRUE(given.has_kinks_alone);
      const Vector expected = differences(given, options);
      sfdae::Matrix weights(given.n, 1);
      weights(0, 0) = 1.0;
      EXPECT_NEAR(solver.gradient({end}, weights)(0, 0), expected[0], 1e-3);
    } catch (const sfdae::Error& error) {
      EXPECT_FALSE(given.has_kinks_alone) << error.what();
      EXPECT_NE(std::string(error.what()).find("cannot be carried over the jump"), std::string::npos) << error.what();
    }
  });
}

// A jump that has gone at the end of a step is a jump.
TEST(SensitivitiesAtSwitches, OfTheAdjointEndAtPulsesBetweenTheEndsOfSteps) {
  const Case given{"a pulse", 2, [](auto, auto p, auto x, auto xdot, auto F) {
                     F[0] = xdot[0] - choose(x[1] - 0.9, 100.0, 0.0) * choose(0.9 + 0.01 * p - x[1], 1.0, 0.0);
                     F[1] = xdot[1] - 1.0;
                   }};
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    sfdae::Options options;
    options.method = method;
    sfdae::Solver solver(problem_of(given), options);
    sfdae::Sensitivities wanted;
    wanted.parameters = {"p"};
    wanted.adjoint = true;
    solver.set_sensitivities(wanted);
    sfdae::Point point{0.0, Vector(2, 0.0), {}};
    solver.start(point, end);
    EXPECT_THROW(solver.advance(end, point), sfdae::Error) << method;
  }
}

// Two conditions switch at the same time, which moves by another amount for each. Asked again, the run ends as before.
TEST(SensitivitiesAtSwitches, ThatDoNotExistAreNamedAgainAndAgain) {
  const Case given{"two times", 2, [](auto, auto p, auto x, auto xdot, auto F) {
                     F[0] = xdot[0] - choose(x[1] - p, 1.0, 0.0) - choose(x[1] - (2.0 * p_now - p), 1.0, 0.0);
                     F[1] = xdot[1] - 1.0;
                   }};
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    sfdae::Options options;
    options.method = method;
    sfdae::Solver solver(problem_of(given), options);
    sfdae::Sensitivities wanted;
    wanted.parameters = {"p"};
    solver.set_sensitivities(wanted);
    sfdae::Point point{0.0, Vector(2, 0.0), {}};
    solver.start(point, end);
    for (int time = 0; time < 3; ++time) {
      try {
        solver.advance(end, point);
        ADD_FAILURE() << "no error";
      } catch (const sfdae::Error& error) {
        EXPECT_EQ(error.status(), SFDAE_SINGULAR) << error.what();
      }
    }
  }
}

}  // namespace switching

}  // namespace
