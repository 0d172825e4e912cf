// Integrations whose exact solution is known.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "linear_problem.h"

namespace campaign {

struct ExactSolution {
  std::function<std::vector<double>(double t)> x;
  std::vector<double> sizes;  // of the unknowns: errors are measured by them
  // How much errors may grow, measured by the sizes; empty: not at all.
  std::function<double()> amplification;
  // The share of an early error that is left at the end, at most 1: 1 where nothing is damped; empty: none.
  std::function<double()> persistence;
};

struct IntegrationSettings {
  double tolerance = 1e-6;  // rtol, and atol relative to the sizes
  int method = SFDAE_METHOD_BDF;
  bool differences = false;  // difference_derivatives
};

struct IntegrationOutcome {
  Answer answer;       // of the last call
  double error = 0.0;  // largest error of a component at the start, at 40 % and at the end, relative to the sizes
  long steps = 0;
};

// Starts at the exact solution and integrates over the interval of the problem.
IntegrationOutcome integrate(const LinearProblem& problem, const ExactSolution& exact,
                             const IntegrationSettings& settings);

// Tolerances bound errors of steps, which add up and which the problem amplifies: 30 tolerances are allowed, times
// the amplification; where errors are not damped, one for every step.
bool error_fits(const ExactSolution& exact, double tolerance, const IntegrationOutcome& outcome);

}  // namespace campaign
