// SPDX-License-Identifier: BSD-3-Clause
//
// Motion along surfaces that both sides lead to: known solutions, where it begins and ends, and what is refused.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <sfdae/hybrid.hpp>
#include <string>
#include <vector>

namespace {

using sfdae::Expression;
using SlidingEquations = std::function<void(const Expression& t, sfdae::ConstExpressions x,
                                            sfdae::ConstExpressions xdot, sfdae::Expressions F)>;
using Values = std::vector<double>;

sfdae::Options options_at(double tolerance, int method) {
  sfdae::Options options;
  options.rtol = options.atol = tolerance;
  options.method = method;
  return options;
}

sfdae::Solver solver_of(int n, const SlidingEquations& equations, const sfdae::Options& options = {}) {
  sfdae::NonlinearProblem problem(n, n);
  problem.equations = [equations](const auto& t, auto x, auto xdot, auto F) { equations(t, x, xdot, F); };
  return sfdae::Solver(problem, options);
}

// Two modes, 0 below and 1 above, and 2 along the surface.
struct System {
  System(int n, const std::function<SlidingEquations(int above)>& equations, const sfdae::SurfaceFunction& surface,
         const sfdae::Options& options = {})
      : below(solver_of(n, equations(0), options)), above(solver_of(n, equations(1), options)) {
    hybrid.add_mode(below, "below");
    hybrid.add_mode(above, "above");
    EXPECT_EQ(hybrid.add_switch(0, 1, surface, "along"), 2);
  }
  Values at(double t) {
    hybrid.advance(t, point);
    return point.x;
  }
  void start(int mode, const Values& x, double toward, double t = 0.0) {
    point = {t, x, {}};
    hybrid.start(mode, point, toward);
  }
  std::string modes() const {
    std::string text;
    for (long k = 0; k < hybrid.num_passages(); ++k) text += std::to_string(hybrid.passage(k).to);
    return text;
  }
  sfdae::Solver below, above;
  sfdae::Hybrid hybrid;
  sfdae::Point point;
};

const auto both_methods = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU};

// x' = x > y ? -2 : 2, y' = y > x ? -3 : 1.5
SlidingEquations corner(int above) {
  return [above](const auto&, auto, auto xdot, auto F) {
    F[0] = xdot[0] - (above ? -2 : 2);
    F[1] = xdot[1] - (above ? 1.5 : -3);
  };
}
Expression difference(const Expression&, sfdae::ConstExpressions x) { return x[0] - x[1]; }

TEST(Sliding, MeetsTheSurfaceAndStays) {
  for (const int method : both_methods)
    for (const int side : {0, 1}) {
      System system(2, corner, difference, options_at(1e-9, method));
      // From below: the surface is met at 1/10 at x = y = 1.2.
      system.start(side, side == 1 ? Values{1.5, 1} : Values{1, 1.5}, 1);
      const Values x = system.at(1);
      const double expected = side == 1 ? 217.0 / 238.0 : 1.2 - 0.9 * 6.0 / 17.0;
      EXPECT_NEAR(x[0], expected, 1e-8);
      EXPECT_NEAR(x[1], expected, 1e-8);
      EXPECT_EQ(system.modes(), "2");
      EXPECT_NEAR(system.point.xdot[0], -6.0 / 17.0, 1e-8);
    }
}

TEST(Sliding, StopsAtTheTransition) {
  System system(2, corner, difference, options_at(1e-9, SFDAE_METHOD_BDF));
  system.start(1, {1.5, 1}, 1);
  EXPECT_EQ(system.hybrid.advance_to_transition(1, system.point), SFDAE_EVENT);
  EXPECT_NEAR(system.point.t, 1.0 / 7.0, 1e-8);
  EXPECT_EQ(system.hybrid.current_mode(), 2);
  EXPECT_EQ(system.hybrid.passage(0).from, 1);
  EXPECT_EQ(system.hybrid.passage(0).transition, 1);
  EXPECT_LT(system.hybrid.passage(0).largest_change, 1e-8);
  EXPECT_NEAR(system.hybrid.last_jump().before[0], 17.0 / 14.0, 1e-8);
  EXPECT_NE(system.hybrid.report().find("mode 2 (along)"), std::string::npos);
  EXPECT_EQ(system.hybrid.mode(2).visits, 1);
}

// A mass with friction 1/2 on a base of velocity sin t: v' = -sign(v - sin t) / 2.
SlidingEquations on_base(int above) {
  return [above](const auto&, auto, auto xdot, auto F) { F[0] = xdot[0] + (above ? 0.5 : -0.5); };
}
Expression slip(const Expression& t, sfdae::ConstExpressions x) { return x[0] - sin(t); }

// The zero of a function near t.
double zero_of(const std::function<double(double)>& f, double t) {
  for (int k = 0; k < 50; ++k) t -= f(t) * 2e-6 / (f(t + 1e-6) - f(t - 1e-6));
  return t;
}

TEST(Sliding, LeavesWhereAModeLeadsAway) {
  const double pi = std::acos(-1.0);
  const double sticks = zero_of([](double t) { return 0.5 * t - std::sin(t); }, 1.9);
  const double loose = 2.0 * pi / 3.0;
  const auto slides = [&](double t) { return std::sin(loose) - 0.5 * (t - loose); };
  const double sticks_again = zero_of([&](double t) { return slides(t) - std::sin(t); }, 5.0);
  const double loose_again = 5.0 * pi / 3.0;
  for (const int method : both_methods) {
    System system(1, on_base, slip, options_at(1e-9, method));
    system.start(0, {0}, 6);
    EXPECT_NEAR(system.at(1)[0], 0.5, 1e-8);
    EXPECT_NEAR(system.at(2)[0], std::sin(2.0), 1e-8);
    EXPECT_EQ(system.hybrid.current_mode(), 2);
    EXPECT_NEAR(system.at(3)[0], slides(3), 1e-8);
    EXPECT_EQ(system.hybrid.current_mode(), 1);
    system.at(6);
    ASSERT_GE(system.hybrid.num_passages(), 3);
    EXPECT_NEAR(system.hybrid.passage(0).t, sticks, 1e-8);
    EXPECT_NEAR(system.hybrid.passage(1).t, loose, 1e-7);
    EXPECT_NEAR(system.hybrid.passage(2).t, sticks_again, 1e-7);
    if (sticks_again < loose_again) {
      EXPECT_EQ(system.modes(), "2120");
      EXPECT_NEAR(system.hybrid.passage(3).t, loose_again, 1e-7);
      EXPECT_NEAR(system.point.x[0], std::sin(loose_again) + 0.5 * (6 - loose_again), 1e-8);
    } else {
      EXPECT_EQ(system.modes(), "210");
    }
  }
}

// Fields that lead through the surface, 1 and 2 + x[1]: no sliding.
TEST(Sliding, IsNotEnteredWhereTheOtherModeLeadsOn) {
  const auto through = [](int above) -> SlidingEquations {
    return [above](const auto&, auto x, auto xdot, auto F) {
      F[0] = xdot[0] - (above ? 2 + x[1] : 1 - 0 * x[1]);
      F[1] = xdot[1] - 1;
    };
  };
  System system(
      2, through, [](const auto&, auto x) { return x[0] - 1; }, options_at(1e-9, SFDAE_METHOD_RADAU));
  system.start(0, {0, 0}, 3);
  EXPECT_NEAR(system.at(2)[0], 1 + 2 + 1.5, 1e-8);
  EXPECT_EQ(system.modes(), "1");
  // Backward the other way.
  const Values end = system.point.x;
  system.start(1, end, 0, 2);
  EXPECT_NEAR(system.at(0)[0], 0, 1e-8);
  EXPECT_EQ(system.modes(), "0");
}

// What repels forward attracts backward.
TEST(Sliding, WorksInBothDirections) {
  const auto away = [](int above) -> SlidingEquations {
    return [above](const auto&, auto, auto xdot, auto F) {
      F[0] = xdot[0] - (above ? 1 : -1);
      F[1] = xdot[1] - (above ? 3 : 1);
    };
  };
  const auto surface = [](const auto&, auto x) { return x[0]; };
  System system(2, away, surface, options_at(1e-9, SFDAE_METHOD_BDF));
  system.start(1, {0.5, 0}, -2);
  const Values x = system.at(-2);
  EXPECT_NEAR(x[0], 0, 1e-8);
  EXPECT_NEAR(x[1], -1.5 - 2 * 1.5, 1e-8);
  EXPECT_EQ(system.modes(), "2");
  try {
    system.start(2, {0, 0}, 2);
    FAIL() << "a surface that repels";
  } catch (const sfdae::Error& error) {
    EXPECT_EQ(error.status(), SFDAE_NO_CONSISTENT_VALUES);
    EXPECT_NE(std::string(error.what()).find("mode 2 (along): the modes do not lead to the surface"),
              std::string::npos)
        << error.what();
  }
  system.start(2, {0, 1}, -2);
  EXPECT_NEAR(system.at(-1)[1], -1, 1e-8);
}

// x'' = u with u = -(x + 3 v) / |...|: u is an unknown; it slides along x + v = 0, exp(-t), and is -1 ... 1 there.
TEST(Sliding, FindsTheEquivalentControl) {
  const auto relay = [](int above) -> SlidingEquations {
    return [above](const auto&, auto x, auto xdot, auto F) {
      F[0] = xdot[0] - x[1];
      F[1] = xdot[1] - x[2];
      F[2] = x[2] - (above ? -1 : 1);
    };
  };
  for (const int method : both_methods) {
    System system(
        3, relay, [](const auto&, auto x) { return x[0] + x[1]; }, options_at(1e-9, method));
    system.start(1, {0.5, 0, -1}, 5);
    // v = -t, x = 1/2 - t^2 / 2: x + v = 0 at sqrt(2) - 1.
    const double met = std::sqrt(2.0) - 1.0;
    const Values x = system.at(3);
    EXPECT_EQ(system.modes(), "2");
    EXPECT_NEAR(system.hybrid.passage(0).t, met, 1e-8);
    EXPECT_NEAR(x[0], met * std::exp(-(3 - met)), 1e-8);
    EXPECT_NEAR(x[2], met * std::exp(-(3 - met)), 1e-7);
  }
}

// A point on the unit circle with a friction of 1/2 and a torque of (t - 2) / 2 from t = 2 on, by position and
// multiplier: it turns from angle 1, stops at 2 after turning by 1, rests until 3.
SlidingEquations on_circle(int above) {
  return [above](const auto& t, auto x, auto xdot, auto F) {
    const Expression moment = (above ? -0.5 : 0.5) + 0.5 * max(t - 2, 0.0);
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = xdot[2] + 2 * x[0] * x[4] + moment * x[1];
    F[3] = xdot[3] + 2 * x[1] * x[4] - moment * x[0];
    F[4] = x[0] * x[0] + x[1] * x[1] - 1;
  };
}

void rest_on_a_circle(int structure) {
  const auto turning = [](const auto&, auto x) { return x[0] * x[3] - x[1] * x[2]; };
  for (const int method : both_methods) {
    sfdae::Options options = options_at(1e-9, method);
    options.structure = structure;
    System system(5, on_circle, turning, options);
    const double c = std::cos(1.0), s = std::sin(1.0);
    system.start(1, {c, s, -s, c, 0.5}, 5);
    system.at(2.5);
    EXPECT_NEAR(std::atan2(system.point.x[1], system.point.x[0]), 2.0, 1e-7);
    EXPECT_EQ(system.hybrid.current_mode(), 2);
    EXPECT_NEAR(system.point.x[4], 0.0, 1e-7);
    system.at(4);
    EXPECT_EQ(system.modes(), "21");
    EXPECT_NEAR(system.hybrid.passage(1).t, 3.0, 1e-6);
    EXPECT_NEAR(std::atan2(system.point.x[1], system.point.x[0]), 2.0 + 1.0 / 12.0, 1e-7);
  }
}

TEST(Sliding, RestsOnACircle) { rest_on_a_circle(SFDAE_STRUCTURE_AUTOMATIC); }
// Forces along the circle cancel in the multiplier, which is small where it comes to rest.
TEST(Sliding, RestsOnACircleByItsExtension) { rest_on_a_circle(SFDAE_STRUCTURE_REQUIRED); }

// A block pushed to a wall with the force 2: friction 0.3 |N| = 0.6; from 1.2 to rest in 2.
sfdae::MultibodyProblem block(double friction) {
  sfdae::MultibodyProblem problem(2, 1);
  problem.equations = [friction](const auto&, auto q, auto, sfdae::MultibodyFormulas formulas) {
    formulas.M(0, 0) = 1;
    formulas.M(1, 1) = 1;
    formulas.f[0] = friction;
    formulas.f[1] = -2;
    formulas.g[0] = q[1];
  };
  return problem;
}

TEST(Sliding, CombinesMultibodySystems) {
  sfdae::Solver below(block(0.6), options_at(1e-8, SFDAE_METHOD_BDF));
  sfdae::Solver above(block(-0.6), options_at(1e-8, SFDAE_METHOD_BDF));
  sfdae::Hybrid hybrid;
  hybrid.add_mode(below);
  hybrid.add_mode(above);
  const int rests = hybrid.add_switch(0, 1, [](const auto&, auto x) { return x[2]; });
  sfdae::Point point{0, {0, 0, 1.2, 0, 2}, {}};
  hybrid.start(1, point, 4);
  hybrid.advance(4, point);
  EXPECT_EQ(hybrid.current_mode(), rests);
  EXPECT_NEAR(hybrid.passage(0).t, 2, 1e-7);
  EXPECT_NEAR(point.x[0], 1.2, 1e-7);
  EXPECT_NEAR(std::fabs(point.x[4]), 2, 1e-7);
}

TEST(Sliding, NamesSurfacesThatCannotBeEvaluated) {
  System system(2, corner, [](const auto&, auto x) { return sqrt(x[0]); });
  try {
    system.start(1, {-1, 0}, 1);
    FAIL();
  } catch (const sfdae::Error& error) {
    EXPECT_NE(std::string(error.what()).find("the surface of a switch"), std::string::npos) << error.what();
  }
}

TEST(Sliding, GoesOnFromCheckpointsAndRecords) {
  System system(1, on_base, slip, options_at(1e-8, SFDAE_METHOD_BDF));
  sfdae::Solution solution;
  system.hybrid.record(solution);
  system.start(0, {0}, 6);
  system.at(2);
  const Values checkpoint = system.hybrid.save_checkpoint();
  const Values end = system.at(4);
  for (const double t : {0.5, 1.95, 2.05, 3.0})
    EXPECT_NEAR(solution(t).x[0],
                t < 1.895  ? 0.5 * t
                : t < 2.09 ? std::sin(t)
                           : std::sin(2.0943951) - 0.5 * (t - 2.0943951),
                1e-6);
  EXPECT_EQ(solution(2).x.size(), 1u);
  system.hybrid.restore_checkpoint(checkpoint);
  EXPECT_EQ(system.hybrid.current_mode(), 2);
  EXPECT_EQ(system.at(4), end);
  // In a system of its own, which has not slid yet.
  System other(1, on_base, slip, options_at(1e-8, SFDAE_METHOD_BDF));
  other.hybrid.restore_checkpoint(checkpoint);
  EXPECT_EQ(other.at(4), end);
}

// x' = -sign(x - level) rate: level is a parameter of the surface and of both modes.
TEST(Sliding, FollowsParameters) {
  const auto toward = [](int above) -> SlidingEquations {
    return [above](const auto&, auto x, auto xdot, auto F) {
      const Expression rate = sfdae::parameter(x[0], "rate", 1), level = sfdae::parameter(x[0], "level", 0);
      F[0] = xdot[0] - (above ? -rate : rate);
      F[1] = x[1] - level;
    };
  };
  const auto surface = [](const auto&, auto x) { return x[0] - sfdae::parameter(x[0], "level", 7); };
  System system(2, toward, surface, options_at(1e-8, SFDAE_METHOD_BDF));
  system.start(1, {1, 0}, 9);
  EXPECT_NEAR(system.at(3)[0], 0, 1e-7);
  for (sfdae::Solver* solver : {&system.below, &system.above}) solver->set_parameter("level", 0.25);
  EXPECT_THROW(system.at(4), sfdae::Error);
  system.start(1, {1, 0.25}, 9, 3);
  EXPECT_NEAR(system.at(6)[0], 0.25, 1e-7);
  EXPECT_NEAR(system.hybrid.passage(0).t, 3.75, 1e-7);
  EXPECT_EQ(system.hybrid.mode(2).visits, 1);
}

// Two surfaces, x0 = 0, which attracts, and x1 = 0: modes 0 and 1 below and above x0 = 0 where x1 > 0, 2 and 3 where
// x1 < 0.
struct TwoSurfaces {
  explicit TwoSurfaces(double rate_beyond) {
    for (int k = 0; k < 4; ++k)
      solvers.push_back(solver_of(
          3,
          [k, rate_beyond](const auto&, auto, auto xdot, auto F) {
            F[0] = xdot[0] - (k % 2 == 0 ? 1 : -1);
            F[1] = xdot[1] - (k < 2 ? -1 : rate_beyond);
            F[2] = xdot[2] - 1.0 * k;
          },
          options_at(1e-9, SFDAE_METHOD_RADAU)));
    for (sfdae::Solver& solver : solvers) hybrid.add_mode(solver);
    const auto first = [](const auto&, auto x) { return x[0]; };
    const auto second = [](const auto&, auto x) { return -x[1]; };
    EXPECT_EQ(hybrid.add_switch(0, 1, first, "01"), 4);
    hybrid.add_switch(2, 3, first, "23");
    hybrid.add_switch(0, 2, second, "02");
    hybrid.add_switch(1, 3, second, "13");
    hybrid.start(1, point, 3);
  }
  std::vector<sfdae::Solver> solvers;
  sfdae::Hybrid hybrid;
  sfdae::Point point{0, {0.5, 1, 0}, {}};
};

TEST(Sliding, GoesOnAcrossAnotherSurface) {
  TwoSurfaces system(-1);
  EXPECT_EQ(system.hybrid.advance(2, system.point), SFDAE_OK);
  EXPECT_EQ(system.hybrid.current_mode(), 5);
  EXPECT_NEAR(system.point.x[0], 0, 1e-8);
  EXPECT_NEAR(system.point.x[1], -1, 1e-8);
  // In mode 1 until 1/2, half of it until 1, then between 2 and 3.
  EXPECT_NEAR(system.point.x[2], 0.5 + 0.25 + 2.5, 1e-7);
}

TEST(Sliding, NamesMotionAlongTwoSurfaces) {
  TwoSurfaces system(1);
  try {
    system.hybrid.advance(2, system.point);
    FAIL();
  } catch (const sfdae::Error& error) {
    EXPECT_EQ(error.status(), SFDAE_ZENO) << error.what();
    EXPECT_NEAR(system.hybrid.accumulation(), 1, 1e-6);
  }
}

// What ends the modes ends sliding between them: a condition at v = 0.3, a time.
TEST(Sliding, EndsByTransitionsOfItsModes) {
  sfdae::Solver rest = solver_of(2, [](const auto&, auto, auto xdot, auto F) { F[0] = xdot[0], F[1] = xdot[1]; });
  System system(2, corner, difference, options_at(1e-9, SFDAE_METHOD_BDF));
  const int resting = system.hybrid.add_mode(rest, "rest");
  sfdae::Transition low;
  low.from = 1, low.to = resting;
  low.function = [](double, auto x, auto) { return 1 - x[0]; };
  system.hybrid.add_transition(low);
  system.start(1, {1.5, 1}, 2);
  const Values x = system.at(2);
  EXPECT_NEAR(x[0], 1, 1e-7);
  EXPECT_NEAR(x[1], 1, 1e-7);
  EXPECT_EQ(system.modes(), "23");
  EXPECT_EQ(system.hybrid.passage(1).from, 2);
  sfdae::Transition timed;
  timed.from = 0, timed.to = resting, timed.kind = SFDAE_TRANSITION_TIME, timed.time = 0.25;
  system.hybrid.add_transition(timed);
  system.start(1, {1.5, 1}, 2);
  EXPECT_NEAR(system.at(2)[0], 17.0 / 14.0 - (0.25 - 1.0 / 7.0) * 6.0 / 17.0, 1e-8);
  EXPECT_EQ(system.hybrid.passage(1).t, 0.25);
}

// Transitions of the user's to the sliding mode: at a time at which the system is on the surface.
TEST(Sliding, BeginsByTransitionsWhereTheSurfaceAttracts) {
  for (const bool attracts : {true, false}) {
    const auto fields = [attracts](int above) -> SlidingEquations {
      return [above, attracts](const auto&, auto, auto xdot, auto F) {
        F[0] = xdot[0] - ((above != 0) == attracts ? -1 : 1);
        F[1] = xdot[1] - 2.0 * above;
      };
    };
    const auto surface = [](const auto&, auto x) { return x[0]; };
    sfdae::Solver rest = solver_of(2, [](const auto&, auto, auto xdot, auto F) { F[0] = xdot[0], F[1] = xdot[1]; });
    System system(2, fields, surface);
    const int resting = system.hybrid.add_mode(rest, "rest");
    sfdae::Transition go;
    go.from = resting, go.to = 2, go.kind = SFDAE_TRANSITION_TIME, go.time = 1;
    system.hybrid.add_transition(go);
    system.start(resting, {0, 0}, 3);
    if (attracts) {
      EXPECT_NEAR(system.at(3)[1], 2, 1e-5);
      EXPECT_EQ(system.modes(), "2");
    } else {
      try {
        system.at(3);
        FAIL();
      } catch (const sfdae::Error& error) {
        EXPECT_EQ(error.status(), SFDAE_NO_CONSISTENT_VALUES) << error.what();
        EXPECT_EQ(system.point.t, 1);
      }
    }
  }
}

// Two conditions that always hold: transitions at one time, which have no times between them.
TEST(Sliding, NamesModesThatAreLeftAtOnce) {
  sfdae::Solver first = solver_of(1, on_base(0)), second = solver_of(1, on_base(1));
  sfdae::Hybrid hybrid;
  hybrid.add_mode(first);
  hybrid.add_mode(second);
  for (int from : {0, 1}) {
    sfdae::Transition always;
    always.from = from, always.to = 1 - from;
    always.function = [](double, auto, auto) { return 1.0; };
    hybrid.add_transition(always);
  }
  sfdae::Point point{0.5, {1}, {}};
  try {
    hybrid.start(0, point, 1);
    FAIL();
  } catch (const sfdae::Error& error) {
    EXPECT_EQ(error.status(), SFDAE_ZENO);
    EXPECT_EQ(hybrid.accumulation(), 0.5) << error.what();
  }
}

// What cannot be combined, and a word that names it.
TEST(Sliding, RefusesWhatCannotBeCombined) {
  struct Case {
    SlidingEquations below, above;
    sfdae::SurfaceFunction surface;
    std::string word;
  };
  const SlidingEquations plain = [](const auto&, auto, auto xdot, auto F) { F[0] = xdot[0] - 1, F[1] = xdot[1]; };
  const SlidingEquations back = [](const auto&, auto, auto xdot, auto F) { F[0] = xdot[0] + 1, F[1] = xdot[1]; };
  const SlidingEquations scaled = [](const auto&, auto, auto xdot, auto F) {
    F[0] = 2 * xdot[0] + 1, F[1] = xdot[1];
  };
  const SlidingEquations turned = [](const auto&, auto, auto xdot, auto F) { F[0] = 1 - xdot[0], F[1] = xdot[1]; };
  const SlidingEquations held = [](const auto&, auto x, auto xdot, auto F) { F[0] = x[0] - 1, F[1] = xdot[1]; };
  const SlidingEquations free = [](const auto&, auto x, auto xdot, auto F) { F[0] = x[1], F[1] = xdot[1]; };
  const SlidingEquations mirrored = [](const auto&, auto x, auto xdot, auto F) { F[0] = 1 - x[0], F[1] = xdot[1]; };
  const sfdae::SurfaceFunction surface = [](const auto&, auto x) { return x[0]; };
  const std::vector<Case> cases = {
      {plain, plain, surface, "same equations"},
      {plain, scaled, surface, "factors of x'[0]"},
      {plain, turned, surface, "factors of x'[0]"},
      {plain, held, surface, "in one of the modes only"},
      {held, free, surface, "no unknown has the same factor"},
      {held, mirrored, surface, "no unknown has the same factor"},
      {plain, back, [](const auto& t, auto) { return t - 1; }, "SFDAE_TRANSITION_TIME"},
  };
  for (const Case& each : cases) {
    sfdae::Solver below = solver_of(2, each.below), above = solver_of(2, each.above);
    sfdae::Hybrid hybrid;
    hybrid.add_mode(below);
    hybrid.add_mode(above);
    try {
      hybrid.add_switch(0, 1, each.surface);
      ADD_FAILURE() << each.word;
    } catch (const sfdae::Error& error) {
      EXPECT_EQ(error.status(), SFDAE_ILLEGAL_ARGUMENT);
      EXPECT_NE(std::string(error.what()).find(each.word), std::string::npos) << error.what();
    }
    // Nothing has been added, and the modes can be used.
    sfdae::Point point{0, {1, 0}, {}};
    EXPECT_EQ(hybrid.start(0, point, 1), SFDAE_OK);
    EXPECT_THROW(hybrid.mode(2), sfdae::Error);
  }
}

TEST(Sliding, RefusesFunctionsAndModesThatDoNotExist) {
  sfdae::NonlinearProblem callbacks(1, 1);
  callbacks.total_derivative = [](double, int, auto jet, auto results) {
    results.F[0] = jet(0, 1);
    return 0;
  };
  sfdae::Solver below = solver_of(1, on_base(0)), above = solver_of(1, on_base(1)), other(callbacks);
  sfdae::Hybrid hybrid;
  EXPECT_THROW(hybrid.add_switch(0, 1, slip), sfdae::Error);
  for (sfdae::Solver* solver : {&below, &above, &other}) hybrid.add_mode(*solver);
  const auto refused = [&](int first, int second, const std::string& name = "") {
    try {
      hybrid.add_switch(first, second, slip, name);
      return std::string("nothing");
    } catch (const sfdae::Error& error) {
      return std::string(error.what());
    }
  };
  EXPECT_NE(refused(0, 3).find("above = 3"), std::string::npos);
  EXPECT_NE(refused(-1, 1).find("below = -1"), std::string::npos);
  EXPECT_NE(refused(1, 1).find("two modes"), std::string::npos);
  EXPECT_NE(refused(0, 2).find("needs recorded ones"), std::string::npos);
  EXPECT_EQ(refused(0, 1, "sticks"), "nothing");
  EXPECT_NE(refused(1, 0, "sticks").find("already"), std::string::npos);
  EXPECT_NE(refused(0, 3).find("sliding mode"), std::string::npos);
  EXPECT_EQ(sfdae_add_switch(hybrid.get(), 0, 1, nullptr, nullptr, nullptr, nullptr), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(sfdae_add_switch(nullptr, 0, 1, nullptr, nullptr, nullptr, nullptr), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_THROW(hybrid.add_switch(0, 1, [](const auto&, auto) -> Expression { throw std::length_error("stop"); }),
               std::length_error);
}

}  // namespace
