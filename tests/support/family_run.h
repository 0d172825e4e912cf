// Solves a family through the C API and compares every step and output with the exact solution.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "family_problem.h"
#include "linear_family.h"
#include "sfdae/sfdae.h"

namespace sfdae_test {

struct FamilyRun {
  int status = SFDAE_OK;  // of the call that ended the run
  std::string message;
  double t = 0.0;  // reached
  std::vector<double> x, xdot;
  double step_error = 0.0;           // max |e_i| / (rtol |x_i| + atol) over all steps
  double output_error = 0.0;         // and over all outputs
  double initial_slope_error = 0.0;  // max |x'(t0) - exact|
  double slope_error = 0.0;          // max |x' - exact| / (1 + |exact|) over all outputs
  sfdae_statistics statistics{};
  sfdae_characteristics characteristics{};
  sfdae_change change{};  // if status is SFDAE_CHARACTERISTICS_CHANGED
  long attempts() const { return statistics.steps + statistics.error_failures + statistics.other_failures; }
};

// Default options with rtol = atol = tol.
sfdae_options options_with_tolerance(double tol);

// From the exact initial values at t0 (or x0, if not empty) to t1 with `outputs` equidistant outputs.
FamilyRun run_family(FamilyProblem& problem, double t0, double t1, sfdae_options options, int outputs = 10,
                     std::vector<double> x0 = {});

// How much of a count the present run of the tests should do: the environment variable SFDAE_TEST_SCALE (0, 1].
int scaled_count(int count, int least = 1);

}  // namespace sfdae_test
