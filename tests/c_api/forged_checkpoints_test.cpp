// SPDX-License-Identifier: BSD-3-Clause
// Checkpoints with wrong numbers in every place and a checksum that fits: refused by name with nothing changed, or
// taken where any number will do, and then nothing is read or written elsewhere (by sanitizers) and steps end.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "../nonlinear/random_system.h"
#include "family_run.h"
#include "linalg/archive.h"
#include "sensitivity_problems.h"
#include "sfdae/hybrid.hpp"
#include "sfdae/sfdae.hpp"
#include "solver_options.h"
#include "weierstrass_modes.h"
#include "weierstrass_solvers.h"

namespace {

using sfdae::Expression;
using sfdae::Point;
using Doubles = std::vector<double>;

constexpr std::size_t place_of_checksum = 2;
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

void mend_checksum(Doubles& checkpoint, std::size_t first) {
  sfdae::core::WordHash hash;
  const std::size_t after = first + place_of_checksum + 1;
  hash.add(checkpoint.data() + after, checkpoint.size() - after);
  checkpoint[after - 1] = static_cast<double>(hash.value() >> 12);
}

// In place of a number: others, and, where it is three small ones in one, others in place of each.
Doubles wrong_numbers(double number) {
  Doubles wrong{-number, -1.0, 0.0, 0.5, 1.0, 3.0, 70000.0, 1e300, std::numeric_limits<double>::infinity(), nothing};
  constexpr double radix = 65536.0;
  if (!(number >= 0.0 && number < radix * radix * radix) || number != std::floor(number)) return wrong;
  for (double unit : {1.0, radix, radix * radix}) {
    const double own = std::fmod(std::floor(number / unit), radix);
    for (double other : {0.0, own - 1.0, own + 1.0, own + 2.0, 40.0, radix - 1.0})
      if (other >= 0.0 && other < radix) wrong.push_back(number + (other - own) * unit);
  }
  return wrong;
}

// save, restore, go_on: what is done with a checkpoint; these may throw sfdae::Error.
struct Target {
  std::function<Doubles()> save;
  std::function<void(const Doubles&)> restore;
  std::function<void()> go_on;
};

struct Attack {
  long refused = 0, taken = 0;
  // `first`: where a checkpoint with a checksum begins; words before it are attacked, too.
  void run(const Target& target, std::size_t first = 0) {
    const Doubles good = target.save();
    const int most = sfdae_test::scaled_count(600, 40);
    const std::size_t step = good.size() / std::size_t(most) + 1;
    bool is_good = true;
    for (std::size_t k = 0; k < good.size(); k += step) {
      if (k == first + place_of_checksum) continue;
      for (double wrong : wrong_numbers(good[k])) {
        if (wrong == good[k]) continue;
        if (!is_good) target.restore(good);
        is_good = try_one(target, good, first, k, wrong);
      }
    }
    target.restore(good);
    target.go_on();
  }

 private:
  // Whether everything is as it was.
  bool try_one(const Target& target, const Doubles& good, std::size_t first, std::size_t k, double wrong) {
    Doubles forged = good;
    forged[k] = wrong;
    mend_checksum(forged, first);
    try {
      target.restore(forged);
    } catch (const sfdae::Error& error) {
      ++refused;
      EXPECT_NE(error.status(), SFDAE_INTERNAL) << k << ": " << error.what();
      EXPECT_EQ(target.save(), good) << "number " << k << " = " << wrong;
      return true;
    }
    ++taken;
    try {
      target.go_on();
    } catch (const sfdae::Error& error) {
      EXPECT_NE(error.status(), SFDAE_INTERNAL) << k << ": " << error.what();
    }
    return false;
  }
};

sfdae::Options few_steps(double tolerance, int method) {
  sfdae::Options options = sfdae_test::solver_options(tolerance, method);
  options.max_steps = 12;
  return options;
}

// From x at t = 0 to t = `to`, then forged there.
void attack(sfdae::Solver& solver, Doubles x, double to) {
  Point point{0.0, std::move(x), {}};
  solver.start(point, 100.0 * to);
  while (point.t < to) try {
      solver.advance(to, point);
    } catch (const sfdae::Error& error) {
      ASSERT_EQ(error.status(), SFDAE_MAX_STEPS) << error.what();
    }
  const Target target{[&] { return solver.save_checkpoint(); },
                      [&](const Doubles& checkpoint) { solver.restore_checkpoint(checkpoint); },
                      [&] {
                        Point end = point;
                        try {
                          solver.advance(1.3 * to, end);
                        } catch (const sfdae::Error& error) {
                          if (error.status() != SFDAE_MAX_STEPS) throw;
                        }
                      }};
  Attack attack;
  attack.run(target);
  EXPECT_GT(attack.refused, 50);
}

class ForgedCheckpoints : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    if (std::getenv("SFDAE_TEST_FPE_TRAPS") != nullptr) GTEST_SKIP() << "numbers overflow that are taken";
  }
};
INSTANTIATE_TEST_SUITE_P(Methods, ForgedCheckpoints,
                         ::testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU, SFDAE_METHOD_AUTOMATIC));

sfdae::LinearProblem linear(const sfdae_test::Mode& mode, bool constant) {
  sfdae::LinearProblem problem(mode.n(), mode.n());
  const auto matrix = [](const sfdae_test::Square& from) {
    return [from](double, int order, sfdae::MatrixRef to) {
      if (order == 0)
        for (int i = 0; i < from.n(); ++i)
          for (int j = 0; j < from.n(); ++j) to(i, j) = from(i, j);
    };
  };
  problem.E = matrix(mode.E);
  problem.A = matrix(mode.A);
  problem.f = [mode](double t, int order, sfdae::VectorRef to) {
    const Doubles f = mode.f(t, order);
    for (int i = 0; i < mode.n(); ++i) to[i] = f[std::size_t(i)];
  };
  problem.constant_E = problem.constant_A = constant;
  return problem;
}

TEST_P(ForgedCheckpoints, OfLinearProblems) {
  sfdae_test::Random random(5);
  for (int mu : {0, 2})
    for (bool constant : {false, true}) {
      const sfdae_test::Mode mode(random, 2, mu + 1, mu);
      sfdae::Options options = few_steps(1e-5, GetParam());
      options.difference_derivatives = constant ? 0 : 1;
      sfdae::Solver solver(linear(mode, constant), options);
      attack(solver, Doubles(std::size_t(mode.n()), 0.0), 1.0);
    }
}

TEST_P(ForgedCheckpoints, OfNonlinearProblemsByTheDerivativeArray) {
  const std::vector<sfdae_test::RandomSystem::Shape> shapes{{1, 1}, {1, 0, {2}, 1, 1}, {1, 0, {3}}};
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const sfdae_test::RandomSystem system(shapes[k], static_cast<unsigned>(k));
    sfdae::NonlinearProblem problem(system.m(), system.n());
    problem.equations = [&](const Expression& t, auto x, auto xdot, auto F) {
      std::vector<Expression> values, slopes, residual(std::size_t(system.m()));
      for (int i = 0; i < system.n(); ++i) values.push_back(x[i]), slopes.push_back(xdot[i]);
      system.residual(t, values.data(), slopes.data(), residual.data());
      for (int i = 0; i < system.m(); ++i) F[i] = residual[std::size_t(i)];
    };
    sfdae::Options options = few_steps(1e-4, GetParam());
    options.structure = SFDAE_STRUCTURE_OFF;
    sfdae::Solver solver(problem, options);
    Doubles x, xdot;
    system.exact(0.0, x, xdot);
    attack(solver, x, 0.4);
  }
}

TEST_P(ForgedCheckpoints, OfRawEquationsOfIndexZero) {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [](const Expression&, auto x, auto xdot, auto F) {
    F[0] = (2.0 + sin(x[1])) * xdot[0] - x[1];
    F[1] = xdot[1] + x[0] * x[0] * x[0];
  };
  sfdae::Solver solver(problem, few_steps(1e-5, GetParam()));
  attack(solver, {1.0, 0.0}, 1.0);
}

TEST_P(ForgedCheckpoints, OfMinimalExtensions) {
  sfdae::Options options = few_steps(1e-4, GetParam());
  options.structure = SFDAE_STRUCTURE_REQUIRED;
  sfdae::Solver rods(sfdae_test::chain_of_rods(1), options), flow(sfdae_test::diffusion(3), options);
  attack(rods, {0.6, -0.8, 0.0, 0.0, 0.0}, 0.2);
  attack(flow, Doubles(6, 0.0), 0.5);
}

// Behind the array they have the states of an extension and the pivots of its matrices.
TEST_P(ForgedCheckpoints, OfSensitivities) {
  sfdae::Solver rods(sfdae_test::chain_of_rods(1), few_steps(1e-4, GetParam()));
  sfdae::Sensitivities wanted;
  wanted.parameters = {"p"};
  rods.set_sensitivities(wanted);
  attack(rods, {0.6, -0.8, 0.0, 0.0, 0.0}, 0.2);
}

// The two halves of a capacitor between two nodes: one of its equations depends on others.
TEST_P(ForgedCheckpoints, OfReplacedEquations) {
  sfdae::NonlinearProblem problem(3, 3);
  problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - xdot[1] + x[0] - sin(t);
    F[1] = xdot[1] - xdot[0] + x[1] * x[1] * x[1] + x[1];
    F[2] = xdot[2] + x[2] - x[0] * x[1];
  };
  sfdae::Options options = few_steps(1e-4, GetParam());
  options.structure = SFDAE_STRUCTURE_REQUIRED;
  sfdae::Solver solver(problem, options);
  attack(solver, {0.1, -0.1, 0.0}, 0.5);
}

TEST_P(ForgedCheckpoints, OfMechanicalSystems) {
  sfdae::Solver solver(sfdae_test::pendulum_with_friction(), few_steps(1e-5, GetParam()));
  attack(solver, {0.7, 0.0, 0.0, 0.0, 0.0}, 0.3);
}

TEST_P(ForgedCheckpoints, WithEvents) {
  sfdae::Solver solver(sfdae_test::van_der_pol(), few_steps(1e-4, GetParam()));
  solver.set_events(2, [](double t, sfdae::ConstVectorRef x, sfdae::ConstVectorRef, sfdae::VectorRef g) {
    g[0] = x[0] - 1.0;
    g[1] = t - 100.0;
  });
  attack(solver, {2.0, 0.0, 0.0}, 0.2);
}

TEST_P(ForgedCheckpoints, OfHybridSystems) {
  sfdae::NonlinearProblem fall(2, 2);
  fall.equations = [](const Expression& t, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - x[1];
    F[1] = xdot[1] + sfdae::parameter(t, "g", 9.81);
  };
  sfdae::Solver solver(fall, few_steps(1e-5, GetParam()));
  sfdae::Hybrid hybrid;
  hybrid.add_mode(solver);
  sfdae::Transition bounce;
  bounce.from = bounce.to = 0;
  bounce.kind = SFDAE_TRANSITION_ZERO;
  bounce.direction = -1;
  bounce.function = [](double, sfdae::ConstVectorRef x, sfdae::ConstVectorRef) { return x[0]; };
  bounce.jump = [](double, sfdae::VectorRef after) { after[1] = -0.8 * after[1]; };
  hybrid.add_transition(bounce);
  sfdae::Sensitivities wanted;
  wanted.parameters = {"g"};
  for (bool with_sensitivities : {false, true}) {
    if (with_sensitivities) hybrid.set_sensitivities(wanted);
    Point point{0.0, {1.0, 0.3}, {}};
    hybrid.start(0, point, 10.0);
    for (int k = 0; k < 100 && point.t < 0.9; ++k) try {
        hybrid.advance(0.9, point);
      } catch (const sfdae::Error& error) {
        ASSERT_EQ(error.status(), SFDAE_MAX_STEPS) << error.what();
      }
    const Target target{[&] { return hybrid.save_checkpoint(); },
                        [&](const Doubles& checkpoint) { hybrid.restore_checkpoint(checkpoint); },
                        [&] {
                          Point end = point;
                          try {
                            hybrid.advance(1.4, end);
                          } catch (const sfdae::Error& error) {
                            if (error.status() != SFDAE_MAX_STEPS) throw;
                          }
                        }};
    const std::size_t own = hybrid.save_checkpoint().size() - solver.save_checkpoint().size();
    Attack attack;
    attack.run(target, own);
    EXPECT_GT(attack.refused, 50);
  }
}

}  // namespace
