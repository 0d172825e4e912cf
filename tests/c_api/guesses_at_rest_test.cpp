// SPDX-License-Identifier: BSD-3-Clause
//
// Tests of guesses at which equations have other ranks than on the solution: flows between tanks that are guessed as 0.
// SFDAE_TEST_SCALE scales the number of random problems.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "family_run.h"
#include "motion_in_pieces.h"
#include "random_family.h"
#include "solver_options.h"

namespace guesses_at_rest {
namespace {

using sfdae::ConstExpressions;
using sfdae::Expression;
using sfdae::Expressions;
using sfdae_test::RandomNumbers;
using Vector = std::vector<double>;

// Resistances of a pipe with flow q, and the flows that pressures lead to.
constexpr int laws = 5;
Expression resistance(int law, const Expression& q) {
  switch (law) {
    case 0: return q * abs(q);
    case 1: return q * q * q;
    case 2: return q * pow(abs(q), 0.75);
    case 3: return sign(q) * q * q;
    default: return choose(q > 0.0, q * q, -q * q);
  }
}
double flow(int law, double pressure) {
  const double exponent = law == 1 ? 3.0 : law == 2 ? 1.75 : 2.0;
  return std::copysign(std::pow(std::fabs(pressure), 1.0 / exponent), pressure);
}

// Tanks in a row, with levels that fall from one to the next, and a pipe between neighbours: area h_i' = q_(i-1) - q_i,
// k_i resistance(q_i) = h_i - h_(i+1). Unknowns: levels, then flows.
struct Tanks {
  int law;
  double area;
  Vector levels, k;

  std::size_t pipes() const { return k.size(); }
  double end() const { return 0.1 * area; }
  Vector slopes(const Vector& h) const {
    Vector result(h.size());
    for (std::size_t i = 0; i < pipes(); ++i) {
      const double q = flow(law, (h[i] - h[i + 1]) / k[i]) / area;
      result[i] -= q;
      result[i + 1] += q;
    }
    return result;
  }
  Vector levels_at_end() const {
    return sfdae_test::runge_kutta([this](double, const Vector& h) { return slopes(h); }, levels, end(), 200);
  }
  sfdae::NonlinearProblem problem() const {
    const int n = static_cast<int>(levels.size() + pipes());
    sfdae::NonlinearProblem problem(n, n);
    problem.equations = [tanks = *this](const Expression&, ConstExpressions x, ConstExpressions xdot, Expressions F) {
      const int count = static_cast<int>(tanks.levels.size());
      for (int i = 0; i < count; ++i) {
        F[i] = tanks.area * xdot[i];
        if (i > 0) F[i] = F[i] - x[count + i - 1];
        if (i + 1 < count) F[i] = F[i] + x[count + i];
      }
      for (int i = 0; i + 1 < count; ++i)
        F[count + i] = tanks.k[static_cast<std::size_t>(i)] * resistance(tanks.law, x[count + i]) - (x[i] - x[i + 1]);
    };
    return problem;
  }
};

Tanks random_tanks(RandomNumbers& random) {
  Tanks tanks{random.integer(0, laws - 1), std::pow(10.0, random.integer(0, 3)), {}, {}};
  const int count = random.integer(2, 4);
  for (int i = 0; i < count; ++i) tanks.levels.push_back(count - i + random.uniform(-0.3, 0.3));
  for (int i = 0; i + 1 < count; ++i) tanks.k.push_back(random.uniform(0.5, 2.0));
  return tanks;
}

// Levels stay as they are given, whatever flow is guessed; none is wrong, and at most 2 % end by name.
TEST(GuessesAtRest, LeaveWhatIsDifferentiated) {
  const int count = sfdae_test::scaled_count(200, 20);
  const Vector guesses = {0.0, 0.0, 1e-12, 1e-4, 0.01, 0.13, 1.0, -1.0, 30.0};
  std::vector<std::string> named;
  for (int seed = 0; seed < count; ++seed) {
    SCOPED_TRACE("tanks " + std::to_string(seed));
    RandomNumbers random(8800 + static_cast<std::uint64_t>(seed));
    const Tanks tanks = random_tanks(random);
    sfdae::Options options =
        sfdae_test::solver_options(1e-6, random.integer(0, 1) == 0 ? SFDAE_METHOD_BDF : SFDAE_METHOD_RADAU);
    options.structure = random.integer(0, 1) == 0 ? SFDAE_STRUCTURE_OFF : SFDAE_STRUCTURE_AUTOMATIC;
    sfdae::Solver solver(tanks.problem(), options);
    const std::size_t levels = tanks.levels.size();
    sfdae::Point point{0.0, tanks.levels, {}};
    const double guess = guesses[static_cast<std::size_t>(random.integer(0, static_cast<int>(guesses.size()) - 1))];
    point.x.resize(levels + tanks.pipes(), guess);
    try {
      solver.start(point, tanks.end());
      for (std::size_t i = 0; i < levels; ++i) EXPECT_NEAR(point.x[i], tanks.levels[i], 1e-6) << "guess " << guess;
      for (std::size_t i = 0; i < tanks.pipes(); ++i)
        EXPECT_NEAR(point.x[levels + i], flow(tanks.law, (tanks.levels[i] - tanks.levels[i + 1]) / tanks.k[i]), 1e-4);
      solver.advance(tanks.end(), point);
    } catch (const sfdae::Error& error) {
      named.push_back("tanks " + std::to_string(seed) + ": " + error.what());
      continue;
    }
    const Vector exact = tanks.levels_at_end();
    for (std::size_t i = 0; i < levels; ++i) EXPECT_NEAR(point.x[i], exact[i], 1e-4) << "guess " << guess;
  }
  EXPECT_LE(named.size(), static_cast<std::size_t>(count / 50)) << named.front();
}

// Levels that a constraint of levels alone binds cannot stay: they are moved, with a warning.
TEST(GuessesAtRest, MoveWhatConstraintsBind) {
  sfdae::NonlinearProblem problem(3, 3);
  problem.equations = [](const Expression&, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] + x[2];
    F[1] = xdot[1] - x[2] + 0.1 * x[1];
    F[2] = x[0] - x[1];
  };
  sfdae::Solver solver(problem);
  sfdae::Point point{0.0, {1.0, 0.0, 0.0}, {}};
  EXPECT_EQ(solver.start(point, 1.0), SFDAE_VALUES_CHANGED);
  EXPECT_NEAR(point.x[0], point.x[1], 1e-9);
}

}  // namespace
}  // namespace guesses_at_rest
