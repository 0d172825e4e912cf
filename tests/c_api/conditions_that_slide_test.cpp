// SPDX-License-Identifier: BSD-3-Clause
//
// Tests of conditions on unknowns whose branches both lead back to the zero: relays, friction at rest.
// SFDAE_TEST_SCALE scales the number of random problems.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <algorithm>
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

namespace conditions_that_slide {
namespace {

using sfdae::ConstExpressions;
using sfdae::Expression;
using sfdae::Expressions;
using sfdae_test::RandomNumbers;
using Vector = std::vector<double>;

sfdae::Options with(int method, double tolerance, int structure = SFDAE_STRUCTURE_AUTOMATIC) {
  sfdae::Options options = sfdae_test::solver_options(tolerance, method);
  options.structure = structure;
  return options;
}

std::vector<sfdae::Options> all_options(double tolerance) {
  std::vector<sfdae::Options> all;
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (int structure : {SFDAE_STRUCTURE_OFF, SFDAE_STRUCTURE_AUTOMATIC})
      all.push_back(with(method, tolerance, structure));
  return all;
}

std::string text_of(const sfdae::Options& options) {
  return "method " + std::to_string(options.method) + ", structure " + std::to_string(options.structure) +
         ", tolerance " + std::to_string(options.rtol);
}

// The sign of a number, as it may be written.
constexpr int laws = 5;
Expression law(int number, const Expression& v) {
  switch (number) {
    case 0: return sign(v);
    case 1: return choose(v > 0.0, 1.0, -1.0);
    case 2: return 1.0 - 2.0 * (v < 0.0);
    case 3: return choose(v < 0.0, -1.0, choose(v > 0.0, 1.0, 0.0));
    default: return choose(v > 0.0, 2.0, 0.0) - 1.0;
  }
}

// The second unknown is the output of the relay.
TEST(ConditionsThatSlide, OfRelaysHoldTheSurface) {
  for (int number = 0; number < laws; ++number)
    for (double tolerance : {1e-4, 1e-7})
      for (const sfdae::Options& options : all_options(tolerance)) {
        sfdae::NonlinearProblem problem(2, 2);
        problem.equations = [=](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
          F[0] = xdot[0] + x[1] - 0.5 * sin(t);
          F[1] = x[1] - law(number, x[0]);
        };
        sfdae::Solver solver(problem, options);
        sfdae::Point point{0.0, {1.0, 1.0}, {}};
        solver.start(point, 5.0);
        ASSERT_EQ(solver.advance(5.0, point), SFDAE_OK) << text_of(options);
        EXPECT_NEAR(point.x[0], 0.0, tolerance) << text_of(options);
        EXPECT_NEAR(point.x[1], 0.5 * std::sin(5.0), 100.0 * tolerance) << text_of(options) << ", law " << number;
        EXPECT_LT(solver.statistics().steps, 2000) << text_of(options);
      }
}

// v' = pull sin t - mu sign v, from rest, until the block comes to rest again.
struct Block {
  double pull = 2.0, mu = 1.0;
  double breaks_loose() const { return std::asin(mu / pull); }
  double speed(double t) const {
    const double t1 = breaks_loose();
    return pull * (std::cos(t1) - std::cos(t)) - mu * (t - t1);
  }
};

sfdae::NonlinearProblem block_at_rest() {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] - x[1];
    F[1] = xdot[1] + parameter(t, "mu", 1.0) * sign(x[1]) - 2.0 * sin(t);
  };
  return problem;
}

TEST(ConditionsThatSlide, OfFrictionLetGoAgain) {
  const Block block;
  for (const sfdae::Options& options : all_options(1e-7)) {
    sfdae::Solver solver(block_at_rest(), options);
    sfdae::Sensitivities wanted;
    wanted.parameters = {"mu"};
    solver.set_sensitivities(wanted);
    sfdae::Point point{0.0, {0.0, 0.0}, {}};
    solver.start(point, 2.0);
    solver.advance(0.5, point);
    EXPECT_NEAR(point.x[1], 0.0, 1e-7) << text_of(options);
    EXPECT_NEAR(solver.sensitivities(0.5).S(1, 0), 0.0, 1e-5) << text_of(options);
    solver.advance(2.0, point);
    EXPECT_NEAR(point.x[1], block.speed(2.0), 1e-5) << text_of(options);
    EXPECT_NEAR(solver.sensitivities(2.0).S(1, 0), -(2.0 - block.breaks_loose()), 1e-3) << text_of(options);
  }
}

// What goes on from there does so bit by bit as without the checkpoint, in a solver that has not met the surface.
TEST(ConditionsThatSlide, AreInCheckpoints) {
  for (const sfdae::Options& options : all_options(1e-6)) {
    sfdae::Solver first(block_at_rest(), options), second(block_at_rest(), options);
    sfdae::Point point{0.0, {0.0, 0.0}, {}};
    first.start(point, 2.0);
    first.advance(0.3, point);
    const Vector checkpoint = first.save_checkpoint();
    second.restore_checkpoint(checkpoint);
    sfdae::Point other = point;
    first.advance(2.0, point);
    second.advance(2.0, other);
    EXPECT_EQ(point.x, other.x) << text_of(options);
    // A new start begins with the conditions as they are.
    sfdae::Point again{0.0, {0.0, 1.0}, {}};
    second.start(again, 0.5);
    second.advance(0.5, again);
    EXPECT_NEAR(again.x[1], 1.0 + 2.0 * (1.0 - std::cos(0.5)) - 0.5, 1e-5) << text_of(options);
  }
}

TEST(ConditionsThatSlide, AreInReports) {
  sfdae::Solver solver(block_at_rest(), with(SFDAE_METHOD_BDF, 1e-6));
  sfdae::Point point{0.0, {0.0, 0.0}, {}};
  solver.start(point, 2.0);
  EXPECT_EQ(solver.report().find("lead back"), std::string::npos);
  solver.advance(0.3, point);
  EXPECT_NE(solver.report().find("lead back to their zeros: 1,"), std::string::npos) << solver.report();
  EXPECT_NE(solver.report().find("equation 1"), std::string::npos) << solver.report();
}

TEST(ConditionsThatSlide, LeaveTheParametersTheyHave) {
  sfdae::Solver solver(block_at_rest(), with(SFDAE_METHOD_RADAU, 1e-7));
  solver.set_parameter("mu", 0.5);
  sfdae::Point point{0.0, {0.0, 0.0}, {}};
  solver.start(point, 1.5);
  solver.advance(1.5, point);
  EXPECT_NEAR(point.x[1], (Block{2.0, 0.5}).speed(1.5), 1e-5);
}

// x' = 1 while a law of x and of the clock y = t is not met, and -1 while it is, from x = -1/2 to t = 2.
struct Combination {
  const char* text;
  std::function<Expression(const Expression& x, const Expression& y)> law;
  double end;  // x there
};

std::vector<Combination> combinations() {
  using E = const Expression&;
  return {
      // x passes 0, comes back at t = 3/2 and stays.
      {"x > 0 and y > 1", [](E x, E y) { return (x > 0.0) && (y > 1.0); }, 0.0},
      {"y > 1 and x > 0", [](E x, E y) { return (y > 1.0) && (x > 0.0); }, 0.0},
      // x stays at 0 from t = 1/2 to t = 1, and goes down, or up.
      {"x > 0 or y > 1", [](E x, E y) { return (x > 0.0) || (y > 1.0); }, -1.0},
      {"x > 0 and y < 1", [](E x, E y) { return (x > 0.0) && (y < 1.0); }, 1.0},
      {"not (x < 0 or y > 1)", [](E x, E y) { return !((x < 0.0) || (y > 1.0)); }, 1.0},
      // x stays at -1/5 until t = 1, and at 0 from t = 6/5.
      {"x > 0 if y > 1 else x > -1/5", [](E x, E y) { return choose(y > 1.0, x > 0.0, x > -0.2) > 0.5; }, 0.0},
  };
}

TEST(ConditionsThatSlide, CombineWithOthers) {
  for (const Combination& each : combinations())
    for (const sfdae::Options& options : all_options(1e-6)) {
      sfdae::NonlinearProblem problem(2, 2);
      problem.equations = [&each](const Expression&, ConstExpressions x, ConstExpressions xdot, Expressions F) {
        F[0] = xdot[0] - choose(each.law(x[0], x[1]), -1.0, 1.0);
        F[1] = xdot[1] - 1.0;
      };
      sfdae::Solver solver(problem, options);
      sfdae::Point point{0.0, {-0.5, 0.0}, {}};
      solver.start(point, 2.0);
      solver.advance(2.0, point);
      EXPECT_NEAR(point.x[0], each.end, 2e-5) << each.text << ", " << text_of(options);
    }
}

// A steep kink, x' = g max(u - x, 0) - x: x follows u until u falls faster than x, and meets it again and again where
// it is so near that the tolerances decide on which side of the kink it is.
TEST(ConditionsThatSlide, AreNotKinks) {
  constexpr double g = 1e4, end = 0.05, pi = 3.14159265358979323846;
  for (const double frequency : {100.0, 400.0, 1000.0}) {
    const auto slope = [&](double t, double x) {
      return g * std::max(std::sin(2.0 * pi * frequency * t) - x, 0.0) - x;
    };
    double exact = 0.0;  // by Heun's method
    constexpr int steps = 500000;
    for (int i = 0; i < steps; ++i) {
      const double h = end / steps, t = i * h, first = slope(t, exact);
      exact += 0.5 * h * (first + slope(t + h, exact + h * first));
    }
    for (const double tolerance : {1e-3, 1e-5})
      for (const sfdae::Options& options : all_options(tolerance)) {
        sfdae::NonlinearProblem problem(1, 1);
        problem.equations = [=](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
          F[0] = xdot[0] - g * max(sin(2.0 * pi * frequency * t) - x[0], 0.0) + x[0];
        };
        sfdae::Solver solver(problem, options);
        sfdae::Point point{0.0, {0.0}, {}};
        solver.start(point, end);
        solver.advance(end, point);
        EXPECT_NEAR(point.x[0], exact, 20.0 * tolerance) << frequency << ", " << text_of(options);
      }
  }
}

// Two conditions have the same zero, and the same gradient, at the start alone.
TEST(ConditionsThatSlide, LeaveOthersThatAreZeroAtTheSameTime) {
  using Law = std::function<Expression(const Expression& t, ConstExpressions x)>;
  const Law later = [](const Expression& t, ConstExpressions x) { return choose(x[0] > t, 0.0, 1.0); };
  const Law curved = [](const Expression&, ConstExpressions x) { return choose(x[0] + x[1] * x[1] > 0.0, 1.0, 0.0); };
  for (const Law& law : {later, curved})
    for (const sfdae::Options& options : all_options(1e-6)) {
      sfdae::NonlinearProblem problem(3, 3);
      problem.equations = [&law](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
        F[0] = xdot[0] - 0.3 + choose(x[0] > 0.0, 1.0, -1.0);
        F[1] = xdot[1] - 1.0;
        F[2] = xdot[2] - law(t, x);
      };
      sfdae::Solver solver(problem, options);
      sfdae::Point point{0.0, {0.0, 0.0, 0.0}, {}};
      solver.start(point, 2.0);
      solver.advance(2.0, point);
      EXPECT_NEAR(point.x[0], 0.0, 1e-6) << text_of(options);
      EXPECT_NEAR(point.x[2], 2.0, 1e-3) << text_of(options);
    }
}

// There is no surface that x moves along where g depends on x'.
TEST(ConditionsThatSlide, AreNamedWhereTheyDependOnSlopes) {
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    sfdae::NonlinearProblem problem(1, 1);
    problem.equations = [](const Expression&, ConstExpressions x, ConstExpressions xdot, Expressions F) {
      F[0] = xdot[0] + choose(x[0] + 1e-3 * xdot[0] > 0.0, 1.0, -1.0);
    };
    sfdae::Solver solver(problem, with(method, 1e-6));
    sfdae::Point point{0.0, {-0.5}, {}};
    solver.start(point, 2.0);
    try {
      solver.advance(2.0, point);
      ADD_FAILURE() << "method " << method << ": x is " << point.x[0];
    } catch (const sfdae::Error& error) {
      EXPECT_TRUE(error.status() == SFDAE_ZENO || error.status() == SFDAE_NO_CONSISTENT_VALUES) << error.what();
    }
  }
}

// ---- Chains of blocks on moving belts, against pieces that are integrated one after the other ------------------

// m q_i'' = k (q_(i+1) - 2 q_i + q_(i-1)) + pull_i sin(omega_i t) - mu_i sign(q_i' - belt_i), ends are fixed.
struct Chain {
  int n;
  double m, k;
  Vector mu, belt, pull, omega, start;  // start: q, then q'
};

Chain random_chain(RandomNumbers& random) {
  Chain chain{
      random.integer(1, 3), std::pow(10.0, random.uniform(-1.0, 1.0)), random.uniform(0.5, 20.0), {}, {}, {}, {}, {}};
  const bool from_rest = (random.integer(0, 1) == 1);
  for (int i = 0; i < chain.n; ++i) {
    chain.mu.push_back(random.uniform(0.1, 2.0));
    chain.belt.push_back((random.integer(0, 1) == 1) ? 0.0 : random.uniform(-0.7, 0.7));
    chain.pull.push_back(random.uniform(-2.0, 2.0));
    chain.omega.push_back(random.uniform(0.5, 4.0));
  }
  for (int i = 0; i < chain.n; ++i) chain.start.push_back(from_rest ? 0.0 : random.uniform(-1.0, 1.0));
  for (int i = 0; i < chain.n; ++i)
    chain.start.push_back(from_rest ? chain.belt[static_cast<std::size_t>(i)] : random.uniform(-1.0, 1.0));
  return chain;
}

// A block comes to rest on its belt, and breaks loose again.
class Blocks {
 public:
  explicit Blocks(const Chain& chain) : chain_(chain), modes_(parts()) {
    Vector x = chain.start;
    for (std::size_t i = 0; i < parts(); ++i) {
      const double slip = x[parts() + i] - chain_.belt[i];
      if (slip != 0.0) modes_[i] = slip > 0.0 ? 1 : -1;
      else change(i, 0.0, x);
    }
  }
  std::size_t parts() const { return static_cast<std::size_t>(chain_.n); }
  Vector slopes(double t, const Vector& x) const {
    Vector result(2 * parts());
    for (std::size_t i = 0; i < parts(); ++i) {
      result[i] = x[parts() + i];
      result[parts() + i] = modes_[i] == 0 ? 0.0 : (force(i, t, x) - chain_.mu[i] * modes_[i]) / chain_.m;
    }
    return result;
  }
  bool is_over(std::size_t i, double t, const Vector& x) const {
    if (modes_[i] == 0) return std::fabs(force(i, t, x)) > chain_.mu[i];
    return modes_[i] * (x[parts() + i] - chain_.belt[i]) < 0.0;
  }
  void change(std::size_t i, double t, Vector& x) {
    if (modes_[i] != 0) x[parts() + i] = chain_.belt[i];
    const double pulled = force(i, t, x);
    modes_[i] = std::fabs(pulled) <= chain_.mu[i] ? 0 : pulled > 0.0 ? 1 : -1;
  }

 private:
  double force(std::size_t i, double t, const Vector& x) const {
    const double left = i > 0 ? x[i - 1] : 0.0, right = i + 1 < parts() ? x[i + 1] : 0.0;
    return chain_.k * (right - 2.0 * x[i] + left) + chain_.pull[i] * std::sin(chain_.omega[i] * t);
  }

  const Chain& chain_;
  std::vector<int> modes_;  // 0: at rest on the belt, else the sign of the slip
};

enum Form { first_order, with_outputs, with_accelerations, forms };

Expression pulled(const Chain& chain, int i, const Expression& t, const std::function<Expression(int)>& q) {
  const auto k = static_cast<std::size_t>(i);
  Expression sum = chain.pull[k] * sin(chain.omega[k] * t) - 2.0 * chain.k * q(i);
  if (i > 0) sum = sum + chain.k * q(i - 1);
  if (i + 1 < chain.n) sum = sum + chain.k * q(i + 1);
  return sum;
}

sfdae::NonlinearProblem problem_of(const Chain& chain, Form form, int number) {
  const int n = chain.n, size = form == first_order ? 2 * n : 3 * n;
  sfdae::NonlinearProblem problem(size, size);
  problem.equations = [=](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    for (int i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const Expression resistance = chain.mu[k] * law(number, x[n + i] - chain.belt[k]);
      const Expression force = pulled(chain, i, t, [&](int j) { return Expression(x[j]); });
      F[i] = xdot[i] - x[n + i];
      if (form == first_order) F[n + i] = chain.m * xdot[n + i] - force + resistance;
      if (form == with_outputs) F[n + i] = chain.m * xdot[n + i] - force + x[2 * n + i];
      if (form == with_outputs) F[2 * n + i] = x[2 * n + i] - resistance;
      if (form == with_accelerations) F[n + i] = xdot[n + i] - x[2 * n + i];
      if (form == with_accelerations) F[2 * n + i] = chain.m * x[2 * n + i] - force + resistance;
    }
  };
  return problem;
}

sfdae::MultibodyProblem mechanical(const Chain& chain, int number) {
  const int n = chain.n;
  sfdae::MultibodyProblem problem(n, 0);
  problem.equations = [=](const auto& t, auto q, auto v, auto to) {
    for (int i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      to.M(i, i) = chain.m;
      to.f[i] = pulled(chain, i, t, [&](int j) { return Expression(q[j]); }) -
                chain.mu[k] * law(number, v[i] - chain.belt[k]);
    }
  };
  return problem;
}

// Returns what ended the run; empty: it is right.
template <class Problem>
std::string motion_error(const Problem& problem, int size, const Chain& chain, const sfdae::Options& options) {
  constexpr double end = 6.0;
  Blocks blocks(chain);
  const Vector exact = sfdae_test::move_in_pieces(blocks, chain.start, end);
  sfdae::Solver solver(problem, options);
  sfdae::Point point{0.0, chain.start, {}};
  point.x.resize(static_cast<std::size_t>(size), 0.0);
  try {
    solver.start(point, end);
    solver.advance(end, point);
  } catch (const sfdae::Error& error) {
    return error.what();
  }
  for (std::size_t i = 0; i < exact.size(); ++i)
    EXPECT_NEAR(point.x[i], exact[i], 100.0 * options.rtol * (1.0 + std::fabs(exact[i])))
        << text_of(options) << ", component " << i;
  return "";
}

// A pendulum with friction in its joint comes to rest; outputs at 25 times, many of them while it sticks.
std::vector<Vector> pendulum_outputs(double x0, const sfdae::Options& options) {
  sfdae::NonlinearProblem problem(5, 5);
  problem.equations = [](const Expression&, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    const Expression friction = sign(x[0] * x[3] - x[1] * x[2]);
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = xdot[2] - 2.0 * x[0] * x[4] - friction * x[1];
    F[3] = xdot[3] - 2.0 * x[1] * x[4] + 9.81 + friction * x[0];
    F[4] = x[0] * x[0] + x[1] * x[1] - 1.0;
  };
  sfdae::Solver solver(problem, options);
  sfdae::Point point{0.0, {x0, -std::sqrt(1.0 - x0 * x0), 0.0, 0.0, 0.0}, {}};
  solver.start(point, 5.0);
  std::vector<Vector> outputs;
  for (int k = 1; k <= 25; ++k) {
    if (solver.advance(0.2 * k, point) != SFDAE_OK) ADD_FAILURE() << solver.message();
    outputs.push_back(point.x);
  }
  return outputs;
}

TEST(ConditionsThatSlide, HaveOutputsWithinSteps) {
  RandomNumbers random(7790);
  for (int trial = 0; trial < sfdae_test::scaled_count(12, 3); ++trial) {
    const double x0 = trial > 0 ? random.uniform(-0.5, 0.5) : 0.05;
    const std::vector<Vector> exact = pendulum_outputs(x0, with(SFDAE_METHOD_BDF, 1e-7));
    for (const double tolerance : {1e-3, 1e-4, 1e-5}) {
      SCOPED_TRACE("x0 " + std::to_string(x0) + ", tolerance " + std::to_string(tolerance));
      const std::vector<Vector> outputs = pendulum_outputs(x0, with(SFDAE_METHOD_RADAU, tolerance));
      for (std::size_t k = 0; k < exact.size(); ++k)
        for (std::size_t i = 0; i < 4; ++i)
          EXPECT_NEAR(outputs[k][i], exact[k][i], 100.0 * tolerance) << k << " " << i;
    }
  }
}

// None is wrong, and at most 1 % end by name.
TEST(ConditionsThatSlide, OfRandomChainsOfBlocks) {
  const int count = sfdae_test::scaled_count(200, 12);
  std::vector<std::string> named;
  for (int seed = 0; seed < count; ++seed) {
    SCOPED_TRACE("chain " + std::to_string(seed));
    RandomNumbers random(7700 + static_cast<std::uint64_t>(seed));
    const Chain chain = random_chain(random);
    const int number = random.integer(0, laws - 1), form = random.integer(0, forms);
    const sfdae::Options options = with((random.integer(0, 1) == 1) ? SFDAE_METHOD_BDF : SFDAE_METHOD_RADAU,
                                        std::pow(10.0, -random.integer(4, 7)));
    const std::string error = form == forms ? motion_error(mechanical(chain, number), 2 * chain.n, chain, options)
                                            : motion_error(problem_of(chain, static_cast<Form>(form), number),
                                                           (form == first_order ? 2 : 3) * chain.n, chain, options);
    if (!error.empty()) named.push_back("chain " + std::to_string(seed) + ": " + error);
  }
  EXPECT_LE(named.size(), static_cast<std::size_t>(count / 100)) << named.front();
}

}  // namespace
}  // namespace conditions_that_slide
