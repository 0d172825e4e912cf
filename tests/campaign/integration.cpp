// SPDX-License-Identifier: BSD-3-Clause
#include "integration.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "extent.h"

namespace campaign {

namespace {

// Tolerances that errors of steps may add up to. Of 2,000 circuits and 3,000 problems with derivatives those with a
// larger error than 1, 3, 10, 20, 30, 50 were 632, 135, 25, 13, 13, 8: what is beyond 30 is something else.
constexpr double allowed = 30.0;

double largest_error(const std::vector<double>& x, const ExactSolution& exact, double t) {
  const std::vector<double> reference = exact.x(t);
  double largest = 0.0;
  for (std::size_t j = 0; j < x.size(); ++j) {
    const double error = std::abs(x[j] - reference[j]) / exact.sizes[j];
    largest = std::isfinite(error) ? std::max(largest, error) : error;
  }
  return largest;
}

}  // namespace

IntegrationOutcome integrate(const LinearProblem& problem, const ExactSolution& exact,
                             const IntegrationSettings& settings) {
  std::vector<double> atol = exact.sizes;
  for (double& value : atol) value *= settings.tolerance;
  sfdae_options options = default_options();
  options.rtol = settings.tolerance;
  options.atol_vector = atol.data();
  options.method = settings.method;
  options.difference_derivatives = settings.differences ? 1 : 0;
  options.max_steps = 4000;  // smooth solutions need some hundreds
  LinearCallbacks callbacks(problem);
  Solver solver(callbacks, options);

  std::vector<double> x = exact.x(problem.begin);
  IntegrationOutcome outcome;
  outcome.answer = answer_of(solver.get(), sfdae_start(solver.get(), problem.begin, problem.end, x.data(), nullptr));
  if (outcome.answer.status >= 0) outcome.error = largest_error(x, exact, problem.begin);
  double t = problem.begin;
  for (double part : {0.4, 1.0}) {
    if (outcome.answer.status < 0) break;
    const double tout = problem.begin + part * (problem.end - problem.begin);
    const int started = outcome.answer.status;  // a warning of the start stays
    const int status = sfdae_advance(solver.get(), tout, &t, x.data(), nullptr);
    outcome.answer = answer_of(solver.get(), status == SFDAE_OK ? started : status);
    if (status >= 0) outcome.error = std::max(outcome.error, largest_error(x, exact, tout));
  }
  sfdae_statistics statistics;
  sfdae_statistics_init(&statistics, sizeof statistics);
  if (sfdae_get_statistics(solver.get(), &statistics) == SFDAE_OK) outcome.steps = statistics.steps;
  if (single_problem()) print(problem, solver.get());
  return outcome;
}

bool error_fits(const ExactSolution& exact, double tolerance, const IntegrationOutcome& outcome) {
  if (outcome.error <= allowed * tolerance) return true;
  const double amplification = exact.amplification ? exact.amplification() : 1.0;
  // Errors of steps may all have the same sign: BDF follows 0.43 periods of a sine in 296 steps, each 0.11 tolerances
  // wrong in a potential that nothing damps (circuit 220), at all tolerances from 1e-3 to 1e-8.
  const double persistence = exact.persistence ? std::min(exact.persistence(), 1.0) : 0.0;
  const double added = persistence * static_cast<double>(outcome.steps);
  if (single_problem())
    std::printf("error %.3e of the size in %ld steps, amplification %.1e, %.2f of early errors persist\n",
                outcome.error, outcome.steps, amplification, persistence);
  return outcome.error <= tolerance * std::max(allowed * std::max(amplification, 1.0), added);
}

}  // namespace campaign
