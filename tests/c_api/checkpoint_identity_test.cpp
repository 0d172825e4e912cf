// SPDX-License-Identifier: BSD-3-Clause
//
// A checkpoint is accepted by the problem that it was made with and by no other one, even if sizes and characteristic
// values agree: recorded equations, data of tables, values of parameters, the method and the options of the analysis
// count.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <sfdae/hybrid.hpp>
#include <sfdae/sfdae.hpp>
#include <string>
#include <utility>
#include <vector>

namespace {

using Equations = std::function<void(const sfdae::Expression&, sfdae::ConstExpressions, sfdae::ConstExpressions,
                                     sfdae::Expressions)>;

sfdae::NonlinearProblem problem_of(int n, Equations equations) {
  sfdae::NonlinearProblem problem(n, n);
  problem.equations = std::move(equations);
  return problem;
}

// x' = -c x and y = x^2: mu = 0, d = 1, a = 1, whatever c is.
sfdae::NonlinearProblem decay(double c) {
  return problem_of(2, [c](const auto&, auto x, auto xdot, auto F) {
    F[0] = xdot[0] + c * x[0];
    F[1] = x[1] - x[0] * x[0];
  });
}

sfdae::NonlinearProblem decay_with_parameter(double c) {
  return problem_of(2, [c](const sfdae::Expression& t, auto x, auto xdot, auto F) {
    F[0] = xdot[0] + sfdae::parameter(t, "rate", c) * x[0];
    F[1] = x[1] - x[0] * x[0];
  });
}

std::vector<double> checkpoint_of(sfdae::Solver& solver, const std::vector<double>& x) {
  sfdae::Point point{0, x, {}};
  solver.start(point, 2);
  solver.advance(1, point);
  return solver.save_checkpoint();
}

// Of a solver or a hybrid system.
template <class Restored>
std::string refusal(Restored& restored, const std::vector<double>& checkpoint) {
  try {
    restored.restore_checkpoint(checkpoint);
  } catch (const sfdae::Error& error) {
    EXPECT_EQ(error.status(), SFDAE_ILLEGAL_ARGUMENT);
    return error.what();
  }
  return "accepted";
}

void expect_part(const std::string& part, const std::string& text) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

TEST(CheckpointIdentity, OtherRecordedEquationsAreRefused) {
  sfdae::Solver first(decay(1));
  const std::vector<double> checkpoint = checkpoint_of(first, {1, 1});
  const Equations others[] = {[](const auto&, auto x, auto xdot, auto F) {
                                F[0] = xdot[0] + 2 * x[0];  // another number
                                F[1] = x[1] - x[0] * x[0];
                              },
                              [](const auto&, auto x, auto xdot, auto F) {
                                F[0] = xdot[0] - x[0];  // another operation
                                F[1] = x[1] - x[0] * x[0];
                              },
                              [](const auto&, auto x, auto xdot, auto F) {
                                F[0] = xdot[0] + x[1];  // another operand
                                F[1] = x[1] - x[0] * x[0];
                              },
                              [](const auto&, auto x, auto xdot, auto F) {
                                F[1] = xdot[0] + x[0];  // another order of the equations
                                F[0] = x[1] - x[0] * x[0];
                              },
                              [](const auto& t, auto x, auto xdot, auto F) {
                                F[0] = xdot[0] + x[0] + 1e-3 * sin(t);  // one term more
                                F[1] = x[1] - x[0] * x[0];
                              }};
  for (const Equations& equations : others) {
    sfdae::Solver other(problem_of(2, equations));
    expect_part("other equations", refusal(other, checkpoint));
  }
  sfdae::Solver same(decay(1));
  EXPECT_EQ(refusal(same, checkpoint), "accepted");
}

TEST(CheckpointIdentity, ARefusalLeavesTheIntegrationAsItWas) {
  sfdae::Solver first(decay(1)), other(decay(2)), twin(decay(2));
  const std::vector<double> checkpoint = checkpoint_of(first, {1, 1});
  checkpoint_of(other, {1, 1});
  checkpoint_of(twin, {1, 1});
  expect_part("other equations", refusal(other, checkpoint));
  sfdae::Point point, wanted;
  other.advance(2, point);
  twin.advance(2, wanted);
  EXPECT_EQ(point.x, wanted.x);
}

TEST(CheckpointIdentity, NamesAParameterWithBothValues) {
  sfdae::Solver first(decay_with_parameter(1)), other(decay_with_parameter(2));
  const std::vector<double> checkpoint = checkpoint_of(first, {1, 1});
  const std::string text = refusal(other, checkpoint);
  expect_part("rate = 1", text);
  expect_part("is 2 now", text);
  // As the message says: the value as it was before, and another one after restoring.
  other.set_parameter("rate", 1);
  EXPECT_EQ(refusal(other, checkpoint), "accepted");
  sfdae::Point point, wanted;
  other.advance(2, point);
  first.advance(2, wanted);
  EXPECT_EQ(point.x, wanted.x);
}

TEST(CheckpointIdentity, NamesOptionsWithBothValues) {
  const std::pair<const char*, std::function<void(sfdae::Options&)>> changes[] = {
      {"method = SFDAE_METHOD_BDF, but this solver has SFDAE_METHOD_RADAU",
       [](sfdae::Options& o) { o.method = SFDAE_METHOD_RADAU; }},
      {"structure = SFDAE_STRUCTURE_AUTOMATIC, but this solver has SFDAE_STRUCTURE_OFF",
       [](sfdae::Options& o) { o.structure = SFDAE_STRUCTURE_OFF; }},
      {"max_index = 5, but this solver has 3", [](sfdae::Options& o) { o.max_index = 3; }},
      {"rank_tol = 0, but this solver has 1e-09", [](sfdae::Options& o) { o.rank_tol = 1e-9; }},
      {"time_scale = 0, but this solver has 2", [](sfdae::Options& o) { o.time_scale = 2; }},
      {"reduction = SFDAE_REDUCTION_STAGED, but this solver has SFDAE_REDUCTION_SVD",
       [](sfdae::Options& o) { o.reduction = SFDAE_REDUCTION_SVD; }},
      {"leading_term = SFDAE_LEADING_AUTOMATIC, but this solver has SFDAE_LEADING_IDENTITY",
       [](sfdae::Options& o) { o.leading_term = SFDAE_LEADING_IDENTITY; }}};
  sfdae::Options options;
  options.method = SFDAE_METHOD_BDF;
  options.structure = SFDAE_STRUCTURE_AUTOMATIC;
  sfdae::Solver first(decay(1), options);
  const std::vector<double> checkpoint = checkpoint_of(first, {1, 1});
  for (const auto& [part, change] : changes) {
    sfdae::Options changed = options;
    change(changed);
    sfdae::Solver other(decay(1), changed);
    expect_part(part, refusal(other, checkpoint));
  }
  // Tolerances and limits may differ.
  sfdae::Options looser = options;
  looser.rtol = looser.atol = 1e-3;
  looser.max_steps = 17;
  sfdae::Solver other(decay(1), looser);
  EXPECT_EQ(refusal(other, checkpoint), "accepted");
}

TEST(CheckpointIdentity, DataOfTablesCount) {
  const auto driven = [](double last) {
    return problem_of(1, [last](const sfdae::Expression& t, auto x, auto xdot, auto F) {
      F[0] = xdot[0] + x[0] - sfdae::table(t, 3, {0, 1, 2, 3}, {0, 1, 0, last});
    });
  };
  sfdae::Solver first(driven(1)), other(driven(1.5)), same(driven(1));
  const std::vector<double> checkpoint = checkpoint_of(first, {1});
  expect_part("other equations", refusal(other, checkpoint));
  EXPECT_EQ(refusal(same, checkpoint), "accepted");
}

// A mass on a circle, recorded as a multibody system: numbers in M, f and g alike.
sfdae::MultibodyProblem pendulum(double mass, double gravity, double length) {
  sfdae::MultibodyProblem problem(2, 1);
  problem.equations = [=](const auto&, auto q, auto, auto to) {
    for (int i = 0; i < 2; ++i) to.M(i, i) = mass;
    to.f[1] = -gravity * mass;
    to.g[0] = q[0] * q[0] + q[1] * q[1] - length * length;
  };
  return problem;
}

TEST(CheckpointIdentity, NumbersOfMultibodySystemsCount) {
  sfdae::Solver first(pendulum(1, 10, 1));
  const std::vector<double> checkpoint = checkpoint_of(first, {0.6, -0.8, 0, 0, 0});
  for (const sfdae::MultibodyProblem& problem : {pendulum(2, 10, 1), pendulum(1, 9, 1), pendulum(1, 10, 1.25)}) {
    sfdae::Solver other(problem);
    expect_part("other equations", refusal(other, checkpoint));
  }
  sfdae::Solver same(pendulum(1, 10, 1));
  EXPECT_EQ(refusal(same, checkpoint), "accepted");
}

// x_k' = sum of random terms; each problem is accepted by its twin and by nobody else.
TEST(CheckpointIdentity, RandomProblemsAreToldApart) {
  constexpr int count = 24, n = 3;
  const auto random_problem = [](unsigned seed) {
    return problem_of(n, [seed](const sfdae::Expression& t, auto x, auto xdot, auto F) {
      std::minstd_rand random(seed);
      for (int i = 0; i < n; ++i) {
        F[i] = xdot[i] + x[i];
        for (int k = 0; k < 3; ++k) {
          const sfdae::Expression& a = x[static_cast<int>(random() % n)];
          const double number = 1.0 + static_cast<double>(random() % 3);
          switch (random() % 4) {
            case 0: F[i] += 0.1 * sin(number * a); break;
            case 1: F[i] -= 0.1 * cos(number * t); break;
            case 2: F[i] += 0.1 * a * exp(-a * a * number); break;
            default: F[i] += number / (2 + a * a); break;
          }
        }
      }
    });
  };
  std::vector<std::vector<double>> checkpoints;
  for (unsigned seed = 1; seed <= count; ++seed) {
    sfdae::Solver solver(random_problem(seed));
    checkpoints.push_back(checkpoint_of(solver, {1, 0, 0.5}));
  }
  for (unsigned seed = 1; seed <= count; ++seed) {
    for (unsigned k = 1; k <= count; ++k) {
      sfdae::Solver solver(random_problem(seed));
      EXPECT_EQ(refusal(solver, checkpoints[k - 1]) == "accepted", k == seed) << seed << ' ' << k;
    }
  }
}

// Two modes with x' = -x and x' = c x, which change at x = level.
struct TwoModes {
  TwoModes(double c, int kind) : down(decay(1)), up(decay(-c)) {
    hybrid.add_mode(down, "down");
    hybrid.add_mode(up, "up");
    sfdae::Transition transition;
    transition.kind = kind;
    transition.to = 1;
    transition.function = [](double, auto x, auto) { return 0.5 - x[0]; };
    hybrid.add_transition(transition);
  }
  sfdae::Solver down, up;
  sfdae::Hybrid hybrid;
};

TEST(CheckpointIdentity, HybridSystemsCompareAllModesAndTransitions) {
  TwoModes first(1, SFDAE_TRANSITION_CONDITION), same(1, SFDAE_TRANSITION_CONDITION);
  sfdae::Point point{0, {1, 1}, {}};
  first.hybrid.start(0, point, 2);
  first.hybrid.advance(0.25, point);  // in the first mode, which is the same in all
  const std::vector<double> checkpoint = first.hybrid.save_checkpoint();
  EXPECT_EQ(refusal(same.hybrid, checkpoint), "accepted");
  TwoModes other_mode(2, SFDAE_TRANSITION_CONDITION), other_kind(1, SFDAE_TRANSITION_ZERO);
  const std::string text = refusal(other_mode.hybrid, checkpoint);
  expect_part("mode 1 (up)", text);
  expect_part("other equations", text);
  expect_part("other transitions", refusal(other_kind.hybrid, checkpoint));
}

// A method set while a mode is running counts from the next start on: the checkpoint is that of the method in use.
TEST(CheckpointIdentity, HybridSystemsGoOnWithTheMethodOfTheRunningMode) {
  TwoModes first(1, SFDAE_TRANSITION_CONDITION), same(1, SFDAE_TRANSITION_CONDITION);
  sfdae::Point point{0, {1, 1}, {}}, restored;
  first.hybrid.start(0, point, 2);
  first.hybrid.advance(0.25, point);
  sfdae::Options radau;
  radau.method = SFDAE_METHOD_RADAU;
  first.down.set_options(radau);
  EXPECT_EQ(refusal(same.hybrid, first.hybrid.save_checkpoint()), "accepted");
  first.hybrid.advance(0.5, point);
  same.hybrid.advance(0.5, restored);
  EXPECT_EQ(point.x, restored.x);
  // Another method in a mode to come is refused.
  TwoModes other(1, SFDAE_TRANSITION_CONDITION);
  other.up.set_options(radau);
  expect_part("mode 1 (up): the checkpoint was made with method",
              refusal(other.hybrid, first.hybrid.save_checkpoint()));
}

TEST(CheckpointIdentity, HybridSystemsCompareWhichFunctionsTransitionsHave) {
  const auto system = [](bool has_guard, bool has_jump) {
    auto modes = std::make_unique<TwoModes>(1, SFDAE_TRANSITION_CONDITION);
    sfdae::Transition transition;
    transition.kind = SFDAE_TRANSITION_TIME;
    transition.time = 1;
    transition.to = 1;
    if (has_guard) transition.guard = [](double, auto, auto) { return -1.0; };
    if (has_jump) transition.jump = [](double, auto x) { x[0] *= 2; };
    modes->hybrid.add_transition(transition);
    return modes;
  };
  for (const bool has_guard : {false, true}) {
    for (const bool has_jump : {false, true}) {
      const auto first = system(has_guard, has_jump);
      sfdae::Point point{0, {1, 1}, {}};
      first->hybrid.start(0, point, 2);
      first->hybrid.advance(0.25, point);
      const std::vector<double> checkpoint = first->hybrid.save_checkpoint();
      EXPECT_EQ(refusal(system(has_guard, has_jump)->hybrid, checkpoint), "accepted");
      expect_part("other transitions", refusal(system(!has_guard, has_jump)->hybrid, checkpoint));
      expect_part("other transitions", refusal(system(has_guard, !has_jump)->hybrid, checkpoint));
    }
  }
}

// Both modes lead toward x = level, where sliding begins.
struct Sliding {
  Sliding(double level, double value_of_parameter) : rising(constant(-1)), falling(constant(1)) {
    hybrid.add_mode(rising, "rising");
    hybrid.add_mode(falling, "falling");
    hybrid.add_switch(
        0, 1,
        [=](const sfdae::Expression& t, auto x) {
          return x[0] - level - sfdae::parameter(t, "c", value_of_parameter);
        },
        "along");
  }
  static sfdae::NonlinearProblem constant(double c) {
    return problem_of(1, [c](const auto&, auto, auto xdot, auto F) { F[0] = xdot[0] + c; });
  }
  sfdae::Solver rising, falling;
  sfdae::Hybrid hybrid;
};

TEST(CheckpointIdentity, HybridSystemsCompareSurfaces) {
  for (const double t : {0.25, 1.5}) {  // before the surface x = 1, and along it
    Sliding first(0.5, 0.5), same(0.5, 0.5), other_level(0.75, 0.5), other_value(0.5, 0.75);
    sfdae::Point point{0, {0}, {}};
    first.hybrid.start(0, point, 2);
    first.hybrid.advance(t, point);
    const std::vector<double> checkpoint = first.hybrid.save_checkpoint();
    EXPECT_EQ(refusal(same.hybrid, checkpoint), "accepted");
    expect_part("another surface of mode 2 (along)", refusal(other_level.hybrid, checkpoint));
    expect_part("another surface of mode 2 (along)", refusal(other_value.hybrid, checkpoint));
  }
}

}  // namespace
