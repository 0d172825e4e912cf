// Problems with parameters, and the instances of an ensemble of them solved one by one.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "sfdae/sfdae.hpp"

namespace sfdae::test {

inline constexpr int thread_counts[] = {1, 2, 3, 5};

using AnyProblem = std::variant<NonlinearProblem, MultibodyProblem>;

// A pendulum of length L; x = (q, v, lambda).
inline MultibodyProblem multibody_pendulum() {
  MultibodyProblem problem(2, 1);
  problem.equations = [](const auto& t, auto q, auto, auto to) {
    const Expression m = parameter(t, "m", 1.0), g = parameter(t, "g", 9.81), L = parameter(t, "L", 1.0);
    to.M(0, 0) = to.M(1, 1) = m;
    to.f[1] = -m * g;
    to.g[0] = q[0] * q[0] + q[1] * q[1] - L * L;
  };
  return problem;
}

// The same, as a nonlinear problem of strangeness index 2.
inline NonlinearProblem raw_pendulum() {
  NonlinearProblem problem(5, 5);
  problem.equations = [](const auto& t, auto x, auto xdot, auto F) {
    const Expression m = parameter(t, "m", 1.0), g = parameter(t, "g", 9.81), L = parameter(t, "L", 1.0);
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = m * xdot[2] + 2.0 * x[0] * x[4];
    F[3] = m * xdot[3] + 2.0 * x[1] * x[4] + m * g;
    F[4] = x[0] * x[0] + x[1] * x[1] - L * L;
  };
  return problem;
}

// x1' + w t x2' = -x1 + cos t, 0 = x1 + w t x2 + a sin t, x3' = x1 + x2 - x3: mu = 1, as the second row
// differentiated has the first one's x1' + w t x2'. It leaves 0 = w x2 - x1 + (1 + a) cos t; d = 1.
inline NonlinearProblem time_varying() {
  NonlinearProblem problem(3, 3);
  problem.linear_equations = [](const auto& t, auto E, auto A, auto f) {
    const Expression w = parameter(t, "w", 1.0), a = parameter(t, "a", 1.0);
    E(0, 0) = 1.0, E(0, 1) = w * t, E(2, 2) = 1.0;
    A(0, 0) = -1.0, A(1, 0) = 1.0, A(1, 1) = w * t, A(2, 0) = A(2, 1) = 1.0, A(2, 2) = -1.0;
    f[0] = cos(t), f[1] = a * sin(t);
  };
  return problem;
}

// x1' = -x1 + x2, p x2' = -x2 - q x2^3 + cos t: an ODE, but for p = 0, where x2 is algebraic.
inline NonlinearProblem fading_capacity() {
  NonlinearProblem problem(2, 2);
  problem.equations = [](const auto& t, auto x, auto xdot, auto F) {
    const Expression p = parameter(t, "p", 1.0), q = parameter(t, "q", 1.0);
    F[0] = xdot[0] + x[0] - x[1];
    F[1] = p * xdot[1] + x[1] + q * x[1] * x[1] * x[1] - cos(t);
  };
  return problem;
}

// The same without the cubic term, as a linear problem with constant E and A.
inline NonlinearProblem linear_capacity() {
  NonlinearProblem problem(2, 2);
  problem.linear_equations = [](const auto& t, auto E, auto A, auto f) {
    const Expression p = parameter(t, "p", 1.0), q = parameter(t, "q", 1.0);
    E(0, 0) = 1.0, E(1, 1) = p;
    A(0, 0) = -1.0, A(0, 1) = 1.0, A(1, 1) = -q;
    f[1] = cos(t);
  };
  return problem;
}

inline Solver solver_of(const AnyProblem& problem, const Options& options) {
  return std::visit([&](const auto& of_kind) { return Solver(of_kind, options); }, problem);
}

// What one instance leads to.
struct Outcome {
  int status = SFDAE_OK;
  std::string message;
  std::vector<double> x, xdot;  // of the outputs that were reached
};

// Instance i by a solver of its own.
inline Outcome solved_alone(const AnyProblem& problem, const Options& options, const Ensemble& ensemble, int i) {
  Outcome outcome;
  Solver solver = solver_of(problem, options);
  const auto note = [&](int status) {
    if (status == SFDAE_OK || outcome.status != SFDAE_OK) return;
    outcome.status = status;
    outcome.message = solver.message();
  };
  try {
    for (std::size_t k = 0; k < ensemble.parameter_names.size(); ++k)
      solver.set_parameter(ensemble.parameter_names[k], ensemble.parameters(static_cast<int>(k), i));
    Point point{ensemble.t0, {}, {}};
    for (int j = 0; j < ensemble.x0.rows(); ++j) point.x.push_back(ensemble.x0(j, i));
    note(solver.start(point, ensemble.times.back()));
    for (const double tout : ensemble.times) {
      note(solver.advance(tout, point));
      outcome.x.insert(outcome.x.end(), point.x.begin(), point.x.end());
      outcome.xdot.insert(outcome.xdot.end(), point.xdot.begin(), point.xdot.end());
    }
  } catch (const Error& error) {
    outcome.status = error.status();
    outcome.message = error.what();
  }
  return outcome;
}

// The same of an ensemble.
inline Outcome outcome_of(const EnsembleSolution& solution, int i) {
  const std::size_t k = static_cast<std::size_t>(i);
  Outcome outcome{solution.statuses[k], solution.messages[k], {}, {}};
  for (int j = 0; j < solution.num_outputs[k]; ++j) {
    for (const double value : solution.x(i, j)) outcome.x.push_back(value);
    for (const double value : solution.xdot(i, j)) outcome.xdot.push_back(value);
  }
  return outcome;
}

// Instances whose parameters and start values are zeros at first, with outputs on the way.
inline Ensemble ensemble_of(std::vector<std::string> names, int unknowns, int instances) {
  Ensemble ensemble;
  ensemble.parameters = Matrix(static_cast<int>(names.size()), instances);
  ensemble.parameter_names = std::move(names);
  ensemble.x0 = Matrix(unknowns, instances);
  ensemble.times = {0.0, 0.3, 0.31, 1.0, 1.5};
  ensemble.wants_xdot = true;
  return ensemble;
}

// As many as a has.
inline bool begins_with(const std::vector<double>& b, const std::vector<double>& a) {
  return a.empty() || (a.size() <= b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

inline bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && begins_with(b, a);
}

// To the last bit, and word by word.
inline void expect_same(const Outcome& is, const Outcome& should_be, int instance) {
  EXPECT_EQ(is.status, should_be.status) << "instance " << instance << ": " << is.message;
  EXPECT_EQ(is.message, should_be.message) << "instance " << instance;
  EXPECT_TRUE(same_bits(is.x, should_be.x)) << "instance " << instance;
  EXPECT_TRUE(same_bits(is.xdot, should_be.xdot)) << "instance " << instance;
}

}  // namespace sfdae::test
