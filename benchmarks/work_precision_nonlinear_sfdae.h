// SPDX-License-Identifier: BSD-3-Clause
// One integration of recorded equations with the library itself: the equations as they are, nothing reduced by hand.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "ida_solver.h"
#include "sfdae/sfdae.h"
#include "test_set/recorded.h"
#include "test_set/test_problem.h"

namespace sfdae_bench {

enum class Method { bdf, radau };

// Stops a run after about 10 seconds.
struct TimeLimit {
  std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();
  static int monitor(const sfdae_progress*, void* self) {
    const auto elapsed = std::chrono::steady_clock::now() - static_cast<const TimeLimit*>(self)->begin;
    return elapsed > std::chrono::seconds(10) ? 1 : 0;
  }
};

inline sfdae_options options_for(Method method, double tol, TimeLimit& limit) {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.rtol = options.atol = tol;
  options.method = method == Method::bdf ? SFDAE_METHOD_BDF : SFDAE_METHOD_RADAU;
  options.use_stop_time = 1;
  options.monitor = &TimeLimit::monitor;
  options.monitor_user = &limit;
  return options;
}

// Recording, analysis, initial values and integration of one smooth segment from t to tout; adds to `run`.
template <class Recorded>
void solve_segment(Recorded& recorded, const sfdae_test::TestProblem& p, double t, const sfdae_options& options,
                   SolverRun& run) {
  sfdae_nonlinear_problem problem;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = p.m;
  problem.num_unknowns = p.n;
  problem.equations = &Recorded::write;
  problem.user = &recorded;
  sfdae_solver* solver = nullptr;
  std::vector<double> xdot(run.x.size());
  int status = sfdae_create_nonlinear(&solver, &problem, &options);
  if (status >= 0) status = sfdae_start(solver, t, options.stop_time, run.x.data(), xdot.data());
  if (status >= 0) status = sfdae_advance(solver, options.stop_time, &t, run.x.data(), xdot.data());
  if (status < 0 || t != options.stop_time)
    run.failure = std::string(sfdae_status_name(status)) + ": " + sfdae_message(solver);
  sfdae_statistics statistics;
  sfdae_statistics_init(&statistics, sizeof statistics);
  if (sfdae_get_statistics(solver, &statistics) >= 0) {
    run.steps += statistics.steps;
    run.evaluations += statistics.evaluations_F + statistics.linearizations;
    run.factorizations += statistics.factorizations;
  }
  sfdae_destroy(&solver);
}

// rtol = atol = tol. Problems with restarts are recorded anew in each segment.
template <class Equations>
SolverRun solve_with_sfdae(const sfdae_test::TestProblem& problem, const Equations& equations, Method method,
                           double tol, int structure = SFDAE_STRUCTURE_AUTOMATIC) {
  TimeLimit limit;
  sfdae_options options = options_for(method, tol, limit);
  options.structure = structure;
  std::vector<double> ends = problem.restarts;
  ends.push_back(problem.tf);
  SolverRun run;
  run.x = problem.x0;
  double begin = problem.t0;
  for (std::size_t k = 0; k < ends.size() && run.failure.empty(); ++k) {
    sfdae_test::RecordedEquations<Equations> recorded(problem, equations, static_cast<int>(k));
    options.stop_time = ends[k];
    solve_segment(recorded, problem, begin, options, run);
    begin = ends[k];
  }
  return run;
}

}  // namespace sfdae_bench
