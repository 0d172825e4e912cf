// SPDX-License-Identifier: BSD-3-Clause
//
// Sensitivities along surfaces: parameters that the modes have in several ways, transitions of other kinds,
// checkpoints, and what is refused.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "sliding_system.h"

namespace {

using sfdae::Expression;
using sfdae::Matrix;
using sfdae_test::derivative;
using sfdae_test::Equations;
using sfdae_test::Values;
using System = sfdae_test::SlidingSystem;

class SlidingCases : public testing::TestWithParam<int> {
 protected:
  sfdae::Options options(double tolerance = 1e-10) const { return sfdae_test::solver_options(tolerance, GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(Methods, SlidingCases, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

Expression first(const Expression&, sfdae::ConstExpressions x) { return x[0]; }

// What a call says that fails.
std::string failure_of(const std::function<void()>& call, int status) {
  try {
    call();
  } catch (const sfdae::Error& error) {
    EXPECT_EQ(error.status(), status) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no failure";
  return "";
}

// ---- Parameters --------------------------------------------------------------------------------------------------

// x' = above ? -rate : rate, with a rate of 1 below and 2 above; both move.
TEST_P(SlidingCases, MoveAParameterThatHasTwoValues) {
  const auto fields = [](int above) -> Equations {
    return [above](const Expression& t, auto, auto xdot, auto F) {
      const Expression rate = sfdae::parameter(t, "rate", 1);
      F[0] = xdot[0] - (above ? -rate : rate);
      F[1] = xdot[1] - (above ? 3 : 1);
    };
  };
  for (const bool by_adjoint : {false, true}) {
    System system(2, fields, first, options(), by_adjoint);
    system.solvers[1]->set_parameter("rate", 2);
    system.point = {0, {1, 0}, {}};
    system.ask({"rate"});
    system.start(1, 2);
    const auto values = [](double t, const Values& p) {
      const double met = 1 / (2 + p[0]), s = (1 + p[0]) / (3 + 2 * p[0]);
      return Values{0, 3 * met + (t - met) * (1 + 2 * s)};
    };
    system.compare(2, {0}, values, 1e-8);
    EXPECT_EQ(system.modes(), "2");
  }
}

// m x' = f, k y' = c, z' = -q z with m, k and q of the same value but other names in the modes: fields are combined.
TEST_P(SlidingCases, KnowParametersOfEqualValue) {
  const auto fields = [](int above) -> Equations {
    return [above](const Expression& t, auto x, auto xdot, auto F) {
      F[0] = sfdae::parameter(t, above ? "m2" : "m1", 2) * (1 + x[1] * x[1]) * xdot[0] + (above ? 3 : -1);
      F[1] = sfdae::parameter(t, above ? "k2" : "k1", 0.5) * xdot[1] - (above ? 1 : -2);
      F[2] = xdot[2] + sfdae::parameter(t, above ? "q2" : "q1", 0.7) * x[2];
    };
  };
  // Along the surface y does not matter for s.
  const auto part = [](const Values& p) { return 1 / p[0] / (1 / p[0] + 3 / p[1]); };
  const auto values = [&](double t, const Values& p) {
    const double s = part(p), y = (1 - s) * -2 / p[2] + s / p[3], q = (1 - s) * p[4] + s * p[5];
    return Values{0, y * t, std::exp(-q * t)};
  };
  const Values p{2, 2, 0.5, 0.5, 0.7, 0.7};
  int index = -1;
  for (const bool asks : {false, true}) {
    for (const bool by_adjoint : {false, true}) {
      System system(3, fields, first, options(), by_adjoint);
      system.point = {0, {0, 0, 1}, {}};
      if (asks) system.ask({"m1", "m2", "k1", "k2", "q1", "q2"});
      system.start(2, 1);
      if (asks) EXPECT_EQ(system.hybrid.mode(2).strangeness_index, index);
      else index = system.hybrid.mode(2).strangeness_index;
      if (asks) system.compare(1, p, values, 1e-8);
    }
  }
}

TEST_P(SlidingCases, RefuseParametersThatNothingCanBeCombinedWith) {
  const auto fields = [](int above) -> Equations {
    return [above](const Expression& t, auto x, auto xdot, auto F) {
      F[0] = sfdae::parameter(t, above ? "m2" : "m1", 2) * (xdot[0] + xdot[1]) + sfdae::parameter(t, "f", 1) * x[2];
      F[1] = xdot[1] + x[1];
      F[2] = sfdae::parameter(t, above ? "k2" : "k1", 2) * (x[2] - (above ? 1 : -1)) + x[1] - x[0];
      if (above) F[2] = F[2] + x[1] - x[1];
    };
  };
  System system(3, fields, first, options());
  system.point = {0, {0, 0.25, 0}, {}};
  system.ask({"m1"});
  std::string said = failure_of([&] { system.start(2, 1); }, SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_NE(said.find("mode 2 (along): "), std::string::npos) << said;
  EXPECT_NE(said.find("Give them one name"), std::string::npos) << said;
  // In its third equation x and y have the same factors whatever k is.
  system.ask({"f", "k1"});
  system.start(2, 1);
  system.hybrid.advance(0.5, system.point);
  EXPECT_NEAR(system.point.x[0], 0, 1e-9);
  EXPECT_NEAR(system.hybrid.sensitivities(0.5).S(1, 0), 0, 1e-12);
}

// Without x', what the modes have in common is a factor with another name.
TEST_P(SlidingCases, RefuseFactorsThatAreEqualByNumbers) {
  const auto relay = [](int above) -> Equations {
    return [above](const Expression& t, auto x, auto xdot, auto F) {
      F[0] = xdot[0] - x[1];
      F[1] = sfdae::parameter(t, above ? "k2" : "k1", 2) * (x[1] + (above ? 1 : -1));
    };
  };
  System system(2, relay, first, options());
  system.point = {0, {1, -1}, {}};
  system.ask({"k2"});
  EXPECT_NE(failure_of([&] { system.start(1, 3); }, SFDAE_ILLEGAL_ARGUMENT).find("Give them one name"),
            std::string::npos);
  system.ask({""}, {0});
  system.start(1, 3);
  system.compare(
      2, {1},
      [](double, const Values&) {
        return Values{0, 0};
      },
      1e-8);
}

// A level that is a parameter of both modes and of the surface.
TEST_P(SlidingCases, FollowParametersOfModesInTheSurface) {
  const auto toward = [](int above) -> Equations {
    return [above](const Expression& t, auto x, auto xdot, auto F) {
      const Expression rate = sfdae::parameter(t, "rate", 1), level = sfdae::parameter(t, "level", 0);
      F[0] = xdot[0] - (above ? -rate : rate * (2 + sin(t)));
      F[1] = x[1] - level;
    };
  };
  const auto surface = [](const Expression& t, auto x) {
    return x[0] - sfdae::parameter(t, "level", 7) * cos(0.5 * t);
  };
  System system(2, toward, surface, options(1e-9));
  for (auto& solver : system.solvers) solver->set_parameter("level", 0.25);
  system.point = {0, {1, 0.25}, {}};
  system.ask({"level", "rate"});
  system.start(1, 9);
  const auto values = [](double t, const Values& p) { return Values{p[0] * std::cos(0.5 * t), p[0]}; };
  system.compare(2, {0.25, 1}, values, 1e-7);
  EXPECT_EQ(system.modes(), "2");
  // As it slides with the old value, and before that.
  for (auto& solver : system.solvers) solver->set_parameter("level", 0.3);
  failure_of([&] { system.hybrid.advance(3, system.point); }, SFDAE_NOT_STARTED);
  failure_of([&] { system.hybrid.sensitivities(2); }, SFDAE_NOT_STARTED);
  system.point = {0, {1, 0.3}, {}};
  system.start(1, 9);
  // Of a mode that is not under way.
  system.solvers[0]->set_parameter("rate", 1.5);
  system.hybrid.advance(1.5, system.point);
  EXPECT_EQ(system.modes(), "2");
  EXPECT_NEAR(system.hybrid.sensitivities(1.5).S(0, 0), std::cos(0.75), 1e-7);
}

TEST_P(SlidingCases, AreAskedForAndTakenAway) {
  const auto fields = [](int above) -> Equations {
    return [above](const Expression& t, auto, auto xdot, auto F) {
      F[0] = xdot[0] + (above ? 1 : -1) * sfdae::parameter(t, "rate", 1);
    };
  };
  std::vector<sfdae::Solver> solvers;
  for (int above : {0, 1}) {
    sfdae::NonlinearProblem problem(1, 1);
    problem.equations = fields(above);
    solvers.emplace_back(problem, options());
  }
  sfdae::Hybrid hybrid;
  for (sfdae::Solver& solver : solvers) hybrid.add_mode(solver);
  sfdae::Sensitivities wanted;
  wanted.parameters = {"rate"};
  hybrid.set_sensitivities(wanted);
  // A switch that comes later; then a parameter that it alone has; then none.
  EXPECT_EQ(hybrid.add_switch(
                0, 1, [](const Expression& t, auto x) { return x[0] - sfdae::parameter(t, "level", 0.5); }, "along"),
            2);
  sfdae::Point point{0, {1}, {}};
  hybrid.start(1, point, 2);
  hybrid.advance(1, point);
  EXPECT_NEAR(hybrid.sensitivities(1).S(0, 0), 0, 1e-9);
  EXPECT_NEAR(hybrid.passage_sensitivities()[0], -0.5, 1e-9);
  wanted.parameters = {"level", "rate"};
  hybrid.set_sensitivities(wanted);
  point = {0, {1}, {}};
  hybrid.start(1, point, 2);
  hybrid.advance(1, point);
  EXPECT_NEAR(hybrid.sensitivities(1).S(0, 0), 1, 1e-9);
  EXPECT_NEAR(hybrid.passage_sensitivities()[0], -1, 1e-9);
  hybrid.set_sensitivities({});
  point = {0, {1}, {}};
  hybrid.start(1, point, 2);
  hybrid.advance(1, point);
  EXPECT_NEAR(point.x[0], 0.5, 1e-9);
  failure_of([&] { hybrid.sensitivities(1); }, SFDAE_NOT_STARTED);
  wanted.parameters = {"height"};
  EXPECT_NE(failure_of([&] { hybrid.set_sensitivities(wanted); }, SFDAE_ILLEGAL_ARGUMENT).find("any mode or surface"),
            std::string::npos);
}

// A surface whose derivative by the parameter is not finite: x = sqrt(level) at level = 0.
TEST_P(SlidingCases, NameSurfacesWithoutDerivatives) {
  const auto fields = [](int above) -> Equations {
    return [above](const Expression&, auto, auto xdot, auto F) { F[0] = xdot[0] + (above ? 1 : -1); };
  };
  const auto surface = [](const Expression& t, auto x) { return x[0] - sqrt(sfdae::parameter(t, "level", 0)); };
  System system(1, fields, surface, options());
  system.point = {0, {1}, {}};
  system.ask({"level"});
  system.start(1, 2);
  const std::string said = failure_of([&] { system.hybrid.advance(2, system.point); }, SFDAE_NOT_FINITE);
  EXPECT_NE(said.find("level"), std::string::npos) << said;
}

// v' = -sign(v - A sin t) mu, along the surface until t = 2 pi / 3, then above it. What is changed in the mode below,
// which is not under way, makes the equations of the sliding mode anew: gradients go back through those that it had.
TEST_P(SlidingCases, GoBackThroughEquationsThatWereReplaced) {
  const auto fields = [](int above) -> Equations {
    return [above](const Expression& t, auto, auto xdot, auto F) {
      const Expression mu = sfdae::parameter(t, "mu", 0.5);
      F[0] = xdot[0] + (above ? mu : -mu);
    };
  };
  const auto slip = [](const Expression& t, auto x) { return x[0] - sfdae::parameter(t, "A", 1) * sin(t); };
  System system(1, fields, slip, options(), true);
  system.point = {1.95, {std::sin(1.95)}, {}};
  system.ask({"A", "mu"});
  system.start(2, 4);
  system.hybrid.advance(2.5, system.point);
  EXPECT_EQ(system.modes(), "1");
  system.solvers[0]->set_parameter("mu", 0.6);
  system.hybrid.advance(3, system.point);
  const double left = std::acos(-0.5);
  EXPECT_NEAR(system.gradients(2)(0, 0), std::sin(2.0), 1e-8);
  const Matrix S = system.gradients(3);
  EXPECT_NEAR(S(0, 0), std::sin(left), 1e-7);
  EXPECT_NEAR(S(0, 1), -(3 - left), 1e-7);
}

// ---- Forces ------------------------------------------------------------------------------------------------------

// A block with an unknown normal force N, pushed by rise t: v' = rise t - mu N sign(v), N = 9.81. It stops, rests,
// and goes on.
TEST_P(SlidingCases, AreThoseOfABlockOnAFloor) {
  constexpr double g = 9.81;
  const auto block = [](int above) -> Equations {
    return [above](const Expression& t, auto x, auto xdot, auto F) {
      const Expression mu = sfdae::parameter(t, "mu", 0.3), rise = sfdae::parameter(t, "rise", 1);
      F[0] = xdot[0] - x[1];
      F[1] = xdot[1] - rise * t + (above ? mu : -mu) * x[2];
      F[2] = x[2] - g;
    };
  };
  for (const bool by_adjoint : {false, true}) {
    System system(
        3, block, [](const auto&, auto x) { return x[1]; }, options(), by_adjoint);
    system.point = {0, {0, 1, g}, {}};
    system.ask({"mu", "rise", ""}, {-1, -1, 1});
    system.start(1, 5);
    const auto stops = [](const Values& p) {
      const double a = p[0] * g / p[1];
      return a - std::sqrt(a * a - 2 * p[2] / p[1]);
    };
    const auto goes = [](const Values& p) { return p[0] * g / p[1]; };
    const auto values = [&](double t, const Values& p) {
      const double until = std::min(t, stops(p)), since = std::max(t - goes(p), 0.0);
      const double x = p[2] * until - p[0] * g * until * until / 2 + p[1] * until * until * until / 6;
      const double v = t < stops(p) ? p[2] - p[0] * g * t + p[1] * t * t / 2 : p[1] * since * since / 2;
      return Values{x + p[1] * since * since * since / 6, v, g};
    };
    const Values p{0.3, 1, 1};
    system.compare(0.2, p, values, 1e-8);
    system.compare(1, p, values, 1e-8);
    system.compare_time(p, stops, 1e-8);
    EXPECT_EQ(system.hybrid.current_mode(), 2);
    system.compare(4, p, values, 1e-7);
    system.compare_time(p, goes, 1e-6);
    EXPECT_EQ(system.modes(), "21");
  }
}

// A multibody form of it: pressed to a wall with the force 2, from 1.2 to rest after 1.2 / friction.
TEST_P(SlidingCases, AreThoseOfMultibodySystems) {
  std::vector<sfdae::Solver> solvers;
  for (int above : {0, 1}) {
    sfdae::MultibodyProblem problem(2, 1);
    problem.equations = [above](const auto& t, auto q, auto, sfdae::MultibodyFormulas formulas) {
      const Expression friction = sfdae::parameter(t, "friction", 0.6);
      formulas.M(0, 0) = 1;
      formulas.M(1, 1) = 1;
      formulas.f[0] = above ? -friction : friction;
      formulas.f[1] = -2;
      formulas.g[0] = q[1];
    };
    solvers.emplace_back(problem, options(1e-9));
  }
  sfdae::Hybrid hybrid;
  for (sfdae::Solver& solver : solvers) hybrid.add_mode(solver);
  const int rests = hybrid.add_switch(0, 1, [](const auto&, auto x) { return x[2]; });
  sfdae::Sensitivities wanted;
  wanted.parameters = {"friction"};
  hybrid.set_sensitivities(wanted);
  sfdae::Point point{0, {0, 0, 1.2, 0, 2}, {}};
  hybrid.start(1, point, 4);
  hybrid.advance(4, point);
  EXPECT_EQ(hybrid.current_mode(), rests);
  EXPECT_NEAR(hybrid.sensitivities(4).S(0, 0), -0.72 / 0.36, 1e-7);
  EXPECT_NEAR(hybrid.passage_sensitivities()[0], -1.2 / 0.36, 1e-7);
}

// ---- Transitions of other kinds ----------------------------------------------------------------------------------

// x' = above ? -2 : 2, y' = above ? rate : -3 slides along x = y until y = 1 or a time; then both rest. From there a
// jump of the user's leads back along the surface.
struct Corner : System {
  explicit Corner(const sfdae::Options& options, bool wants_gradients = false)
      : System(
            2,
            [](int above) -> Equations {
              return [above](const Expression& t, auto, auto xdot, auto F) {
                F[0] = xdot[0] - (above ? -2 : 2);
                F[1] = xdot[1] - (above ? sfdae::parameter(t, "rate", 1.5) : -3 + 0 * t);
              };
            },
            [](const Expression&, auto x) { return x[0] - x[1]; }, options, wants_gradients) {
    sfdae::NonlinearProblem problem(2, 2);
    problem.equations = [](const auto&, auto, auto xdot, auto F) { F[0] = xdot[0], F[1] = xdot[1]; };
    solvers.push_back(std::make_unique<sfdae::Solver>(problem, options));
    EXPECT_EQ(hybrid.add_mode(*solvers.back(), "rest"), 3);
    point = {0, {1.5, 1}, {}};
  }
  static double met(const Values& p) { return 0.5 / (2 + p[0]); }
  static double slope(const Values& p) {
    const double s = 5 / (7 + p[0]);
    return 2 - 4 * s;
  }
  static double on_surface(double t, const Values& p) { return 1.5 - 2 * met(p) + (t - met(p)) * slope(p); }
};

TEST_P(SlidingCases, EndByTransitionsOfModes) {
  for (const bool by_adjoint : {false, true}) {
    Corner system(options(), by_adjoint);
    sfdae::Transition low;
    low.from = 1, low.to = 3;
    low.function = [](double, auto x, auto) { return 1 - x[0]; };
    system.hybrid.add_transition(low);
    system.ask({"rate"});
    system.start(1, 2);
    const Values p{1.5};
    system.compare(
        2, p,
        [](double, const Values&) {
          return Values{1, 1};
        },
        1e-8);
    EXPECT_EQ(system.modes(), "23");
    const auto reached = [](const Values& q) {
      return Corner::met(q) + (1 - 1.5 + 2 * Corner::met(q)) / Corner::slope(q);
    };
    system.compare_time(p, reached, 1e-8);

    Corner other(options(), by_adjoint);
    sfdae::Transition timed;
    timed.from = 0, timed.to = 3, timed.kind = SFDAE_TRANSITION_TIME, timed.time = 0.4;
    other.hybrid.add_transition(timed);
    other.ask({"rate"});
    other.start(1, 2);
    const auto values = [](double, const Values& q) {
      return Values{Corner::on_surface(0.4, q), Corner::on_surface(0.4, q)};
    };
    other.compare(2, p, values, 1e-8);
    if (by_adjoint) continue;
    EXPECT_EQ(other.hybrid.passage_sensitivities()[0], 0);
  }
}

TEST_P(SlidingCases, BeginByJumpsOfTheUser) {
  for (const bool jumps : {false, true}) {
    for (const bool by_adjoint : {false, true}) {
      Corner system(options(), by_adjoint);
      sfdae::Transition timed, back;
      timed.from = 0, timed.to = 3, timed.kind = SFDAE_TRANSITION_TIME, timed.time = 0.4;
      back.from = 3, back.to = 2, back.kind = SFDAE_TRANSITION_TIME, back.time = 0.6;
      if (jumps) back.jump = [](double, auto x) { x[0] = x[0] * x[0], x[1] = x[1] * x[1]; };
      system.hybrid.add_transition(timed);
      system.hybrid.add_transition(back);
      system.ask({"rate", ""}, {-1, 0});
      system.start(1, 2);
      const auto values = [jumps](double t, const Values& q) {
        // By x_0 at the start the surface is met later, after which y is as much higher.
        const double met = (q[1] - 1) / (2 + q[0]);
        const double left = q[1] - 2 * met + (0.4 - met) * Corner::slope(q);
        const double x = (jumps ? left * left : left) + (t - 0.6) * Corner::slope(q);
        return Values{x, x};
      };
      system.compare(1, {1.5, 1.5}, values, 1e-8);
      EXPECT_EQ(system.modes(), "232");
    }
  }
}

// Another surface, x_1 = 0, is crossed along x_0 = 0: between modes 0 and 1 before, 2 and 3 after it.
TEST_P(SlidingCases, GoOnAcrossAnotherSurface) {
  std::vector<sfdae::Solver> solvers;
  for (int k = 0; k < 4; ++k) {
    sfdae::NonlinearProblem problem(3, 3);
    problem.equations = [k](const Expression& t, auto, auto xdot, auto F) {
      const Expression rate = sfdae::parameter(t, "rate", 1);
      F[0] = xdot[0] - (k % 2 == 0 ? 1 : -1);
      F[1] = xdot[1] + rate;
      F[2] = xdot[2] - 1.0 * k;
    };
    solvers.emplace_back(problem, options());
  }
  sfdae::Hybrid hybrid;
  for (sfdae::Solver& solver : solvers) hybrid.add_mode(solver);
  const auto one = [](const Expression& t, auto x) { return x[0] - sfdae::parameter(t, "level", 0); };
  const auto other = [](const auto&, auto x) { return -x[1]; };
  hybrid.add_switch(0, 1, one, "01");
  hybrid.add_switch(2, 3, one, "23");
  hybrid.add_switch(0, 2, other, "02");
  hybrid.add_switch(1, 3, other, "13");
  sfdae::Sensitivities wanted;
  wanted.parameters = {"rate", "level"};
  hybrid.set_sensitivities(wanted);
  sfdae::Point point{0, {0.5, 1, 0}, {}};
  hybrid.start(1, point, 3);
  hybrid.advance(2, point);
  EXPECT_EQ(hybrid.current_mode(), 5);
  // In mode 1 until 1/2 - level, half of it until 1 / rate, then between 2 and 3.
  const auto values = [](double t, const Values& p) {
    const double met = 0.5 - p[1], crossed = 1 / p[0];
    return Values{p[1], 1 - p[0] * t, met + 0.5 * (crossed - met) + 2.5 * (t - crossed)};
  };
  const Matrix S = hybrid.sensitivities(2).S;
  for (int j = 0; j < 2; ++j) {
    const Values exact = derivative(values, 2, {1, 0}, static_cast<std::size_t>(j));
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(S(i, j), exact[static_cast<std::size_t>(i)], 1e-8) << i << ", " << j;
  }
}

// ---- Options and checkpoints -------------------------------------------------------------------------------------

TEST_P(SlidingCases, AreTestedForTheirErrorsAndWeighted) {
  sfdae::Options how = options();
  how.initial_weights = {1, 3};
  Corner system(how);
  system.point.x = {1, 1};
  sfdae::Sensitivities wanted;
  wanted.parameters = {"rate", ""};
  wanted.directions = Matrix(2, 2);
  wanted.directions(0, 1) = 1;
  wanted.error_test = true;
  system.hybrid.set_sensitivities(wanted);
  system.start(2, 2);
  // Least (dx - 1)^2 + (dy / 3)^2 with dx = dy, whatever s does.
  const double moved = system.hybrid.sensitivities(0).S(0, 1);
  EXPECT_NEAR(moved, 0.9, 1e-12);
  const auto values = [&](double t, const Values& p) {
    const double x = 1 + moved * p[1] + t * Corner::slope(p);
    return Values{x, x};
  };
  system.compare(1, {1.5, 0}, values, 1e-8);
}

TEST_P(SlidingCases, GoOnFromCheckpoints) {
  const auto on_base = [](int above) -> Equations {
    return [above](const Expression& t, auto, auto xdot, auto F) {
      const Expression mu = sfdae::parameter(t, "mu", 0.5);
      F[0] = xdot[0] + (above ? mu : -mu);
    };
  };
  const auto slip = [](const Expression& t, auto x) { return x[0] - sfdae::parameter(t, "A", 1) * sin(t); };
  System system(1, on_base, slip, options(1e-8));
  system.point = {0, {0}, {}};
  system.ask({"mu", "A"});
  system.start(0, 6);
  system.hybrid.advance(2, system.point);
  EXPECT_EQ(system.hybrid.current_mode(), 2);
  const Values checkpoint = system.hybrid.save_checkpoint();
  const auto end_of = [](System& each) {
    each.hybrid.advance(4, each.point);
    const Matrix S = each.hybrid.sensitivities(4).S;
    const Values dt = each.hybrid.passage_sensitivities();
    return Values{each.point.x[0], S(0, 0), S(0, 1), dt[0], dt[1]};
  };
  const Values end = end_of(system);
  system.hybrid.restore_checkpoint(checkpoint);
  EXPECT_EQ(system.hybrid.current_mode(), 2);
  EXPECT_EQ(end_of(system), end);
  // In a system of its own, which has not slid yet; with other sensitivities it is refused.
  System other(1, on_base, slip, options(1e-8));
  other.point = {0, {0}, {}};
  failure_of([&] { other.hybrid.restore_checkpoint(checkpoint); }, SFDAE_ILLEGAL_ARGUMENT);
  for (const auto& names : {std::vector<std::string>{"A", "mu"}, {"mu"}, {"A", "A"}, {"mu", ""}}) {
    other.ask(names);
    failure_of([&] { other.hybrid.restore_checkpoint(checkpoint); }, SFDAE_ILLEGAL_ARGUMENT);
  }
  other.ask({"mu", "A"});
  other.hybrid.restore_checkpoint(checkpoint);
  EXPECT_EQ(end_of(other), end);
  const Matrix outside = other.hybrid.sensitivities(4).S;
  EXPECT_EQ(outside.rows(), 1);
}

}  // namespace
