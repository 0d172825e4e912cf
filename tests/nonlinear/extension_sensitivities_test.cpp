// SPDX-License-Identifier: BSD-3-Clause
// Sensitivities along the minimal extension: exact ones, those by the whole array, differences of solutions, known
// ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "family_run.h"
#include "sensitivity_problems.h"
#include "sfdae/sfdae.hpp"
#include "solver_options.h"
#include "sparse_system.h"
#include "transformed_system.h"

namespace {

using sfdae::Expression;
using sfdae::Matrix;
using sfdae::Point;
using sfdae_test::chain_of_rods;
using sfdae_test::diffusion;
using sfdae_test::largest_error;
using sfdae_test::scaled_count;
using sfdae_test::SparseSystem;

sfdae::Options options_of(double tolerance, int method, int structure) {
  sfdae::Options options = sfdae_test::solver_options(tolerance, method);
  options.structure = structure;
  return options;
}

sfdae::Sensitivities by(std::vector<std::string> parameters) {
  sfdae::Sensitivities wanted;
  wanted.parameters = std::move(parameters);
  return wanted;
}

bool is_extended(const sfdae::Solver& solver) { return solver.report().find("in the factors") != std::string::npos; }

class ExtensionSensitivities : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, ExtensionSensitivities, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

// ---- Random systems --------------------------------------------------------------------------------------------

// Some sparse systems side by side, each with its own unknowns: y_i = x_i + p/5 sin(x_i + 0.3 i) solves them in the
// time (1 + q) t.
class TransformedSparseSystem {
 public:
  TransformedSparseSystem(unsigned seed, int count, SparseSystem::Mixing mixing) {
    for (int k = 0; k < count; ++k) systems_.emplace_back(seed + unsigned(k), mixing);
    for (const SparseSystem& system : systems_) n_ += system.n(), mu_ = std::max(mu_, system.values().mu);
  }
  static constexpr double p = 0.7, q = 0.2;

  int n() const { return n_; }
  int mu() const { return mu_; }
  sfdae::NonlinearProblem problem() const {
    sfdae::NonlinearProblem problem(n_, n_);
    problem.equations = [this](const Expression& t, auto x, auto xdot, auto F) {
      const Expression own_p = sfdae::parameter(t, "p", p), rate = 1.0 + sfdae::parameter(t, "q", q);
      std::vector<Expression> y, ydot, residual(std::size_t(n_), t);
      for (int i = 0; i < n_; ++i) {
        const Expression angle = x[i] + 0.3 * i;
        y.push_back(x[i] + 0.2 * own_p * sin(angle));
        ydot.push_back((1.0 + 0.2 * own_p * cos(angle)) * xdot[i] / rate);
      }
      std::size_t first = 0;
      for (const SparseSystem& system : systems_) {
        system.residual(rate * t, y.data() + first, ydot.data() + first, residual.data() + first);
        first += std::size_t(system.n());
      }
      for (int i = 0; i < n_; ++i) F[i] = residual[std::size_t(i)];
    };
    return problem;
  }
  // x and its derivatives by p and q.
  void exact(double t, std::vector<double>& x, Matrix& S) const {
    constexpr double h = 1e-4;
    const double own = (1.0 + q) * t;
    const std::vector<double> y = transformed(own), after = transformed(own + h), before = transformed(own - h),
                              far_after = transformed(own + 2.0 * h), far_before = transformed(own - 2.0 * h);
    x = y;
    S = Matrix(n_, 2);
    for (int i = 0; i < n_; ++i) {
      const std::size_t k = std::size_t(i);
      for (int iteration = 0; iteration < 50; ++iteration)
        x[k] = y[k] - 0.2 * p * std::sin(x[k] + 0.3 * i);  // contracts by 0.14
      const double slope = (8.0 * (after[k] - before[k]) - (far_after[k] - far_before[k])) / (12.0 * h);
      const double of_x = 1.0 + 0.2 * p * std::cos(x[k] + 0.3 * i);
      S(i, 0) = -0.2 * std::sin(x[k] + 0.3 * i) / of_x;
      S(i, 1) = t * slope / of_x;
    }
  }

 private:
  std::vector<double> transformed(double t) const {
    std::vector<double> y;
    for (const SparseSystem& system : systems_)
      for (double value : system.exact(t)) y.push_back(value);
    return y;
  }
  std::vector<SparseSystem> systems_;
  int n_ = 0, mu_ = 0;
};

// Whether x is solved by the extension without sensitivities: numbers do not always confirm the structure.
bool starts_alone(const TransformedSparseSystem& system, int structure) {
  sfdae::Solver solver(system.problem(), options_of(1e-9, SFDAE_METHOD_BDF, structure));
  Point point;
  Matrix unused;
  system.exact(0.0, point.x, unused);
  try {
    solver.start(point, 2.0);
    return is_extended(solver);
  } catch (const sfdae::Error&) {
    return false;
  }
}

struct Errors {
  double of_S = 0.0, of_slopes = 0.0;
};

// Of S at the start and three later times, of S' beside differences of S.
Errors errors_of(const TransformedSparseSystem& system, sfdae::Solver& solver) {
  Point point;
  sfdae::Sensitivities wanted = by({"p", "q"});
  system.exact(0.0, point.x, wanted.directions);
  solver.set_sensitivities(wanted);
  solver.start(point, 2.0);
  Errors errors;
  const auto note = [&](double t) {
    constexpr double h = 1e-4;
    std::vector<double> x;
    Matrix exact, before, after;
    system.exact(t, x, exact);
    system.exact(t - h, x, before);
    system.exact(t + h, x, after);
    const sfdae::SensitivityValues found = solver.sensitivities(t);
    Matrix slopes(exact.rows(), exact.columns());
    for (int j = 0; j < exact.columns(); ++j)
      for (int i = 0; i < exact.rows(); ++i) slopes(i, j) = (after(i, j) - before(i, j)) / (2.0 * h);
    errors.of_S = std::max(errors.of_S, largest_error(found.S, exact));
    errors.of_slopes = std::max(errors.of_slopes, largest_error(found.Sdot, slopes));
  };
  note(0.0);
  for (double t : {0.7, 1.3, 2.0}) {
    solver.advance(t, point);
    note(t);
  }
  return errors;
}

TEST_P(ExtensionSensitivities, AreExactForAnyIndex) {
  const int count = scaled_count(200);
  int solved[4] = {0, 0, 0, 0};
  double largest = 0.0;
  for (unsigned seed = 1; seed <= unsigned(count); ++seed) {
    const TransformedSparseSystem system(100 * seed, 1 + int(seed % 3), SparseSystem::Mixing::none);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", mu = " + std::to_string(system.mu()));
    sfdae::Solver solver(system.problem(), options_of(1e-9, GetParam(), SFDAE_STRUCTURE_REQUIRED));
    try {
      const Errors errors = errors_of(system, solver);
      EXPECT_LE(errors.of_S, 1e-6);
      EXPECT_LE(errors.of_slopes, 1e-4);
      largest = std::max(largest, errors.of_S);
      ++solved[system.mu()];
    } catch (const sfdae::Error& error) {
      EXPECT_FALSE(starts_alone(system, SFDAE_STRUCTURE_REQUIRED)) << error.what();
    }
  }
  RecordProperty("largest_error", std::to_string(largest));
  if (count < 40) return;
  for (int of_index : solved) EXPECT_GE(of_index, 1);
}

// With many unknowns, without being asked to; and by the whole array.
TEST_P(ExtensionSensitivities, AreThoseOfTheWholeArray) {
  int extended = 0;
  for (unsigned seed : {1u, 2u, 3u, 4u}) {
    const TransformedSparseSystem system(1000 * seed, 12, SparseSystem::Mixing::none);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", n = " + std::to_string(system.n()));
    for (int structure : {SFDAE_STRUCTURE_AUTOMATIC, SFDAE_STRUCTURE_OFF}) {
      sfdae::Solver solver(system.problem(), options_of(1e-9, GetParam(), structure));
      const Errors errors = errors_of(system, solver);
      EXPECT_LE(errors.of_S, 1e-6);
      EXPECT_LE(errors.of_slopes, 1e-4);
      EXPECT_EQ(is_extended(solver), starts_alone(system, structure));
      if (is_extended(solver)) ++extended;
    }
  }
  EXPECT_GE(extended, 2);
}

// Where equations are replaced, or numbers do not confirm the structure, the array serves, without being asked to.
TEST_P(ExtensionSensitivities, AreThoseOfTheArrayWhereStructureMisleads) {
  int misled = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const TransformedSparseSystem system(7000 + 100 * seed, 9, SparseSystem::Mixing::constant);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", n = " + std::to_string(system.n()));
    sfdae::Solver solver(system.problem(), options_of(1e-9, GetParam(), SFDAE_STRUCTURE_AUTOMATIC));
    EXPECT_LE(errors_of(system, solver).of_S, 1e-6);
    if (!is_extended(solver)) ++misled;
  }
  EXPECT_GE(misled, 1);
}

// ---- Known solutions -------------------------------------------------------------------------------------------

// A mass point on a rod of length L, index raw: positions, velocities, force.
sfdae::NonlinearProblem pendulum() {
  sfdae::NonlinearProblem problem(5, 5);
  problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
    const Expression g = sfdae::parameter(t, "g", 9.81), L = sfdae::parameter(t, "L", 1.0);
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = xdot[2] + x[0] * x[4];
    F[3] = xdot[3] + x[1] * x[4] + g;
    F[4] = x[0] * x[0] + x[1] * x[1] - L * L;
  };
  return problem;
}

// States take turns as it goes around; S fulfils the constraints of all levels, differentiated.
TEST_P(ExtensionSensitivities, FulfilHiddenConstraintsWhateverTheStates) {
  sfdae::Solver solver(pendulum(), options_of(1e-8, GetParam(), SFDAE_STRUCTURE_REQUIRED));
  solver.set_sensitivities(by({"g", "L"}));
  Point point{0.0, {0.0, -1.0, 8.0, 0.0, 0.0}, {}};
  solver.start(point, 5.0);
  const auto expect_constraints = [&](double t, const std::vector<double>& x) {
    const sfdae::SensitivityValues s = solver.sensitivities(t);
    for (int j = 0; j < 2; ++j) {
      const double size = 1.0 + std::fabs(s.S(0, j)) + std::fabs(s.S(2, j)) + std::fabs(s.S(4, j));
      const double of_force = j == 0 ? x[1] : -2.0 * x[4];  // of v^2 - lambda L^2 - g y = 0
      EXPECT_NEAR(x[0] * s.S(0, j) + x[1] * s.S(1, j), j == 1 ? 1.0 : 0.0, 1e-7 * size) << "t = " << t;
      EXPECT_NEAR(x[0] * s.S(2, j) + x[2] * s.S(0, j) + x[1] * s.S(3, j) + x[3] * s.S(1, j), 0.0, 1e-6 * size);
      EXPECT_NEAR(2.0 * (x[2] * s.S(2, j) + x[3] * s.S(3, j)) - s.S(4, j) - 9.81 * s.S(1, j),
                  j == 0 ? of_force : -of_force, 1e-5 * size);
      for (int i = 0; i < 2; ++i) EXPECT_NEAR(s.Sdot(i, j), s.S(2 + i, j), 1e-7 * size);
    }
  };
  expect_constraints(0.0, point.x);
  for (int k = 1; k <= 10; ++k) {
    solver.advance(0.5 * k, point);
    expect_constraints(point.t, point.x);
  }
  EXPECT_TRUE(is_extended(solver));
}

// ---- Starts ----------------------------------------------------------------------------------------------------

Matrix start_of(const sfdae::Options& options, const sfdae::Sensitivities& wanted) {
  sfdae::Solver solver(pendulum(), options);
  solver.set_sensitivities(wanted);
  Point point{0.0, {0.6, -0.8, 0.4, 0.3, 0.25 + 0.8 * 9.81}, {}};
  solver.start(point, 1.0);
  return solver.sensitivities(0.0).S;
}

// The nearest ones to directions that do not fulfil the constraints: as by the whole array.
TEST(ExtensionSensitivityStarts, AreThoseOfTheArray) {
  for (int kind = 0; kind < 4; ++kind) {
    SCOPED_TRACE(kind);
    sfdae::Options options = options_of(1e-8, SFDAE_METHOD_BDF, SFDAE_STRUCTURE_REQUIRED);
    if (kind == 1) options.initial_weights = {1.0, 3.0, 2.0, 0.5, 1.0};
    if (kind == 2) options.initial_values = SFDAE_INITIAL_FIXED, options.fixed = {1, 0, 0, 0, 0};
    sfdae::Sensitivities wanted = by({"g", "L", ""});
    wanted.directions = Matrix(5, 3);
    for (int i = 0; i < 5 && kind != 3; ++i)
      for (int j = 0; j < 3; ++j) wanted.directions(i, j) = std::cos(1.0 + i + 2.0 * j);
    const Matrix found = start_of(options, wanted);
    options.structure = SFDAE_STRUCTURE_OFF;
    EXPECT_LE(largest_error(found, start_of(options, wanted)), 1e-9);
  }
}

TEST(ExtensionSensitivityStarts, NameWhatCannotFollow) {
  sfdae::Options options = options_of(1e-8, SFDAE_METHOD_BDF, SFDAE_STRUCTURE_REQUIRED);
  options.initial_values = SFDAE_INITIAL_FIXED;
  options.fixed = {1, 1, 0, 0, 0};
  for (int structure : {SFDAE_STRUCTURE_REQUIRED, SFDAE_STRUCTURE_OFF}) {
    options.structure = structure;
    try {
      start_of(options, by({"L"}));
      FAIL();
    } catch (const sfdae::Error& error) {
      EXPECT_EQ(error.status(), SFDAE_FIXED_VALUES) << error.what();
    }
  }
}

// ---- Large problems --------------------------------------------------------------------------------------------

std::vector<double> end_with(const sfdae::NonlinearProblem& problem, std::vector<double> x,
                             const std::string& parameter, double value) {
  sfdae::Solver solver(problem, sfdae_test::solver_options(1e-11, SFDAE_METHOD_RADAU));
  solver.set_parameter(parameter, value);
  Point point{0.0, std::move(x), {}};
  solver.start(point, 1.0);
  solver.advance(1.0, point);
  return point.x;
}

// Of algebraic unknowns and differential ones, n = 160, with and without the error test; and of the adjoint, which
// the array serves.
TEST_P(ExtensionSensitivities, AgreeWithDifferencesAndTheAdjoint) {
  constexpr int cells = 80;
  const sfdae::NonlinearProblem problem = diffusion(cells);
  const std::vector<double> x(2 * cells, 0.0);
  Matrix weights(2 * cells, 1);
  for (int i = 0; i < weights.rows(); ++i) weights(i, 0) = std::cos(1.0 + i);
  std::vector<double> differences[2], gradient(2, 0.0);
  const std::pair<std::string, double> parameters[] = {{"p", 0.7}, {"q", 50.0}};
  for (int j = 0; j < 2; ++j) {
    const auto& [name, value] = parameters[j];
    const std::vector<double> after = end_with(problem, x, name, value * (1.0 + 1e-4)),
                              before = end_with(problem, x, name, value * (1.0 - 1e-4));
    for (std::size_t i = 0; i < x.size(); ++i) differences[j].push_back((after[i] - before[i]) / (2e-4 * value));
    for (int i = 0; i < weights.rows(); ++i)
      gradient[std::size_t(j)] += weights(i, 0) * differences[j][std::size_t(i)];
  }
  for (bool error_test : {false, true}) {
    sfdae::Solver solver(problem, sfdae_test::solver_options(1e-8, GetParam()));
    sfdae::Sensitivities wanted = by({"p", "q"});
    wanted.error_test = error_test;
    solver.set_sensitivities(wanted);
    Point point{0.0, x, {}};
    solver.start(point, 1.0);
    solver.advance(1.0, point);
    EXPECT_TRUE(is_extended(solver));
    const Matrix S = solver.sensitivities(1.0).S;
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < S.rows(); ++i) EXPECT_NEAR(S(i, j), differences[j][std::size_t(i)], 1e-6) << i << " " << j;
  }
  sfdae::Solver solver(problem, sfdae_test::solver_options(1e-8, GetParam()));
  sfdae::Sensitivities wanted = by({"p", "q"});
  wanted.adjoint = true;
  solver.set_sensitivities(wanted);
  Point point{0.0, x, {}};
  solver.start(point, 1.0);
  solver.advance(1.0, point);
  EXPECT_FALSE(is_extended(solver));
  const Matrix found = solver.gradient({1.0}, weights);
  for (int j = 0; j < 2; ++j) EXPECT_NEAR(found(j, 0), gradient[std::size_t(j)], 1e-5);
}

// Solvers go from S to x alone and back, and to the adjoint, which need other systems.
TEST_P(ExtensionSensitivities, ComeAndGo) {
  const TransformedSparseSystem system(1000, 12, SparseSystem::Mixing::none);
  sfdae::Solver solver(system.problem(), options_of(1e-9, GetParam(), SFDAE_STRUCTURE_AUTOMATIC));
  for (int k = 0; k < 2; ++k) {
    EXPECT_LE(errors_of(system, solver).of_S, 1e-6);
    EXPECT_TRUE(is_extended(solver));
    sfdae::Sensitivities adjoint = by({"p", "q"});
    adjoint.adjoint = true;
    solver.set_sensitivities(adjoint);
    Point point;
    Matrix unused;
    system.exact(0.0, point.x, unused);
    solver.start(point, 0.5);
    EXPECT_FALSE(is_extended(solver));
  }
}

// Chains are of index 2, and their states change. x' and S' of forces need derivatives above those of the extension.
void expect_those_of_the_array(int links, int method) {
  std::vector<double> x(std::size_t(5 * links), 0.0);
  for (int i = 0; i < links; ++i) x[std::size_t(5 * i)] = i + 1;
  Matrix found[2][2];
  std::vector<double> slopes[2];
  for (int structure : {SFDAE_STRUCTURE_AUTOMATIC, SFDAE_STRUCTURE_OFF}) {
    sfdae::Solver solver(chain_of_rods(links), options_of(1e-10, method, structure));
    solver.set_parameter("q", 1.2);
    solver.set_sensitivities(by({"p", "q"}));
    Point point{0.0, x, {}};
    solver.start(point, 1.0);
    solver.advance(0.7, point);
    EXPECT_EQ(is_extended(solver), structure == SFDAE_STRUCTURE_AUTOMATIC);
    slopes[structure == SFDAE_STRUCTURE_OFF] = point.xdot;
    found[structure == SFDAE_STRUCTURE_OFF][0] = solver.sensitivities(0.7).S;
    found[structure == SFDAE_STRUCTURE_OFF][1] = solver.sensitivities(0.7).Sdot;
  }
  for (std::size_t i = 0; i < slopes[0].size(); ++i) EXPECT_NEAR(slopes[0][i], slopes[1][i], 1e-5) << i;
  EXPECT_LE(largest_error(found[0][0], found[1][0]), 1e-6);
  EXPECT_LE(largest_error(found[0][1], found[1][1]), 1e-5);
}

// Few states, each stage linearized, and many.
TEST_P(ExtensionSensitivities, OfChainsAreThoseOfTheArray) {
  for (int links : {8, 16}) {
    SCOPED_TRACE(links);
    expect_those_of_the_array(links, GetParam());
  }
}

// Each of them is eliminated down to its states: no matrix of x is factored once more for S.
TEST(StagesOfFewStates, LeaveTheMatricesOfXAlone) {
  for (int links : {8, 16}) {
    SCOPED_TRACE(links);
    std::vector<double> x(std::size_t(5 * links), 0.0);
    for (int i = 0; i < links; ++i) x[std::size_t(5 * i)] = i + 1;
    long factorizations[2];
    for (const bool with_S : {false, true}) {
      sfdae::Solver solver(chain_of_rods(links), options_of(1e-6, SFDAE_METHOD_RADAU, SFDAE_STRUCTURE_AUTOMATIC));
      if (with_S) solver.set_sensitivities(by({"p", "q"}));
      Point point{0.0, x, {}};
      solver.start(point, 1.0);
      solver.advance(1.0, point);
      EXPECT_TRUE(is_extended(solver));
      factorizations[with_S] = solver.statistics().factorizations;
    }
    EXPECT_EQ(factorizations[0], factorizations[1]);
  }
}

}  // namespace
