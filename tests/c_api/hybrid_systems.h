// SPDX-License-Identifier: BSD-3-Clause
// Hybrid systems whose sensitivities are looked at.
#ifndef SFDAE_TESTS_HYBRID_SYSTEMS_H
#define SFDAE_TESTS_HYBRID_SYSTEMS_H

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "linalg/random.h"
#include "sfdae/hybrid.hpp"

namespace sfdae_test {

inline sfdae::Sensitivities by(std::vector<std::string> parameters, const sfdae::Matrix& directions = {}) {
  sfdae::Sensitivities wanted;
  wanted.parameters = std::move(parameters);
  wanted.directions = directions;
  return wanted;
}

// Unit vectors at these unknowns, in the columns from `first` on.
inline sfdae::Matrix unit_directions(int n, int count, int first, const std::vector<int>& unknowns) {
  sfdae::Matrix directions(n, count);
  for (std::size_t k = 0; k < unknowns.size(); ++k) directions(unknowns[k], first + static_cast<int>(k)) = 1.0;
  return directions;
}

// Solvers and the system that they are modes of, destroyed first.
struct System {
  std::vector<std::unique_ptr<sfdae::Solver>> solvers;
  sfdae::Hybrid hybrid;
  void add(const sfdae::NonlinearProblem& problem, const sfdae::Options& options) {
    solvers.push_back(std::make_unique<sfdae::Solver>(problem, options));
    hybrid.add_mode(*solvers.back());
  }
  void set_parameter(const std::string& name, double value) {
    for (auto& solver : solvers) {
      try {
        solver->set_parameter(name, value);
      } catch (const sfdae::Error&) {
        // Not a parameter of that mode.
      }
    }
  }
};

// x' = v, v' = -g, v jumps to -e v at x = 0; e is an unknown that does not change, as functions know no parameters.
inline System ball(const sfdae::Options& options) {
  sfdae::NonlinearProblem problem(3, 3);
  problem.equations = [](const sfdae::Expression& t, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - x[1];
    F[1] = xdot[1] + sfdae::parameter(t, "g", 9.81);
    F[2] = xdot[2];
  };
  System system;
  system.add(problem, options);
  sfdae::Transition bounce;
  bounce.kind = SFDAE_TRANSITION_ZERO;
  bounce.direction = -1;
  bounce.function = [](double, auto x, auto) { return x[0]; };
  bounce.jump = [](double, auto x) {
    x[0] = 0.0;
    x[1] = -x[2] * x[1];
  };
  system.hybrid.add_transition(bounce);
  return system;
}

// A mass point flies until a rope of length L is tight: a pendulum of index 3 from there on, mu = 2. L is an unknown.
inline System rope(const sfdae::Options& options) {
  const auto motion = [](bool is_tight) {
    sfdae::NonlinearProblem problem(6, 6);
    problem.equations = [is_tight](const sfdae::Expression& t, auto x, auto xdot, auto F) {
      for (int i = 0; i < 2; ++i) {
        F[i] = xdot[i] - x[i + 2];
        F[i + 2] = xdot[i + 2] + x[i] * x[4];
      }
      F[3] = F[3] + sfdae::parameter(t, "g", 9.81);
      if (is_tight) F[4] = x[0] * x[0] + x[1] * x[1] - x[5] * x[5];
      else F[4] = x[4] + 0.0 * t;
      F[5] = xdot[5];
    };
    return problem;
  };
  System system;
  for (bool is_tight : {false, true}) system.add(motion(is_tight), options);
  sfdae::Transition tight;
  tight.to = 1;
  tight.kind = SFDAE_TRANSITION_ZERO;
  tight.direction = 1;
  tight.function = [](double, auto x, auto) { return x[0] * x[0] + x[1] * x[1] - x[5] * x[5]; };
  system.hybrid.add_transition(tight);
  return system;
}

// Two modes of three differential equations and a constraint, of strangeness index 0 and 1, that follow one another
// at zeros of a function of t and x; values jump by impulses one way, by a function the other way.
struct RandomModes {
  explicit RandomModes(unsigned seed) : random(seed) {
    for (double& c : coefficients) c = sfdae::core::symmetric_random(random);
  }
  std::minstd_rand random;
  std::array<double, 64> coefficients;

  sfdae::NonlinearProblem problem(int mode) const {
    sfdae::NonlinearProblem problem(4, 4);
    problem.equations = [c = coefficients, mode](const sfdae::Expression& t, auto x, auto xdot, auto F) {
      const sfdae::Expression p = sfdae::parameter(t, "p", 0.7);
      const double* const a = c.data() + 20 * mode;
      for (int i = 0; i < 3; ++i) {
        F[i] = xdot[i] + (0.5 + 0.3 * i) * x[i] + p * a[i] * sin(x[(i + 1) % 3] + a[3 + i] * t) - a[6 + i] * x[3];
        if (i == 0 && mode == 1) F[i] = F[i] - x[3];
      }
      // The unknown of mode 1 is the force that a constraint needs.
      if (mode == 0) F[3] = x[3] - p * cos(x[0] + 2.0 * t);
      else F[3] = x[0] - 0.5 * p * sin(t) + 0.1 * a[9] * x[1];
    };
    return problem;
  }
  System system(const sfdae::Options& options) const {
    System result;
    for (int mode : {0, 1}) result.add(problem(mode), options);
    const double phase = 2.0 * coefficients[50], weight = 0.3 * coefficients[51], bend = 0.2 * coefficients[52];
    for (int mode : {0, 1}) {
      sfdae::Transition transition;
      transition.from = mode;
      transition.to = 1 - mode;
      transition.kind = SFDAE_TRANSITION_ZERO;
      transition.direction = mode == 0 ? 1 : -1;
      transition.function = [=](double t, auto x, auto) {
        return std::sin(3.0 * t + phase) + weight * std::tanh(x[1]);
      };
      if (mode == 1)
        transition.jump = [=](double t, auto x) {
          x[0] = x[0] + bend * x[2] * x[2];
          x[1] = 0.8 * x[1] + bend * std::sin(t);
        };
      result.hybrid.add_transition(transition);
    }
    return result;
  }
};

}  // namespace sfdae_test

#endif
