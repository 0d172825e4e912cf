// SPDX-License-Identifier: BSD-3-Clause
// Nonlinear problems with known solutions for SFNDAE.
#ifndef SFDAE_TESTS_SFNDAE_PROBLEMS_H
#define SFDAE_TESTS_SFNDAE_PROBLEMS_H

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "sfndae_run.h"
#include "test_set/pendulum.h"

namespace sfdae_test {

// A problem, where it starts, (mu, d, a, u, v), and its solution.
struct KnownNonlinear {
  std::shared_ptr<NonlinearEquations> equations;
  std::vector<double> start;
  std::vector<int> characteristics;
  std::function<std::vector<double>(double t)> solution;
  int max_index = 3;
};

// x1' = -x1^2, x2' = x1: x = (1 / (1 + t), log(1 + t)).
inline KnownNonlinear nonlinear_ode() {
  return {std::make_shared<NonlinearEquations>(2,
                                               [](const Term&, const Term* x, const Term* xdot) -> std::vector<Term> {
                                                 return {xdot[0] + x[0] * x[0], xdot[1] - x[0]};
                                               }),
          {1.0, 0.0},
          {0, 2, 0, 0, 0},
          [](double t) -> std::vector<double> {
            return {1.0 / (1.0 + t), std::log1p(t)};
          }};
}

// Two discs coupled by a spring, a pendulum on the first: which torque on the second makes the first one turn by sin t?
//
//     x1' = x3, x2' = x4, x3' = x2 - x1 - sin x1, x4' = x1 - x2 + x5, 0 = x1 - sin t
//
// Four differentiations lead to x5 (mu = 4), nothing is free (d = 0): with p = sin t
// x2 = p'' + p + sin p = sin p, x4 = x2', x5 = x2'' + x2 - p.
inline KnownNonlinear path_control() {
  return {std::make_shared<NonlinearEquations>(
              5,
              [](const Term& t, const Term* x, const Term* xdot) -> std::vector<Term> {
                return {xdot[0] - x[2], xdot[1] - x[3], xdot[2] - (x[1] - x[0] - sin(x[0])),
                        xdot[3] - (x[0] - x[1] + x[4]), x[0] - sin(t)};
              }),
          {0.1, 0.1, 0.9, 0.9, 0.1},
          {4, 0, 5, 0, 0},
          [](double t) -> std::vector<double> {
            const double p = std::sin(t), q = std::cos(t), s = std::sin(p), c = std::cos(p);
            return {p, s, q, c * q, (-s * q * q - c * p) + s - p};
          },
          4};
}

// x1' = x2 - 1 - x1^2 with x2 free: held constant, x2 = 1 and x1 = 1 / (1 + t).
inline KnownNonlinear free_nonlinear_component() {
  return {std::make_shared<NonlinearEquations>(2,
                                               [](const Term&, const Term* x, const Term* xdot) -> std::vector<Term> {
                                                 return {xdot[0] + x[0] * x[0] - x[1] + 1.0};
                                               }),
          {1.0, 1.0},
          {0, 1, 0, 1, 0},
          [](double t) -> std::vector<double> {
            return {1.0 / (1.0 + t), 1.0};
          }};
}

// x1' = -x1^2, x2 = x1^2, and again: 3 (x2 - x1^2) = contradiction.
inline KnownNonlinear redundant_equation(double contradiction = 0.0) {
  return {std::make_shared<NonlinearEquations>(
              2,
              [contradiction](const Term&, const Term* x, const Term* xdot) -> std::vector<Term> {
                const Term gap = x[1] - x[0] * x[0];
                return {xdot[0] + x[0] * x[0], gap, 3.0 * gap - contradiction};
              }),
          {1.0, 1.0},
          {0, 1, 1, 0, 1},
          [](double t) -> std::vector<double> {
            return {1.0 / (1.0 + t), 1.0 / ((1.0 + t) * (1.0 + t))};
          }};
}

inline KnownNonlinear pendulum_problem() {
  const TestProblem p = pendulum();
  return {std::make_shared<NonlinearEquations>(p.n,
                                               [](const Term& t, const Term* x, const Term* xdot) {
                                                 std::vector<Term> F(5);
                                                 pendulum_residual(t, x, xdot, F.data());
                                                 return F;
                                               }),
          p.x0,
          {2, 2, 3, 0, 0},
          {}};
}

}  // namespace sfdae_test

#endif
