// SPDX-License-Identifier: BSD-3-Clause
// Sensitivities along the minimal extension: exact ones, those by the whole array, differences of solutions, known ones.
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
using sfdae_test::driven_by_a_table;
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

// Some sparse systems side by side, each with its own unknowns: y_i = x_i + p/5 sin(x_i + 0.3 i) solves them in the time (1 + q) t.
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

}  // namespace
