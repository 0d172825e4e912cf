// SPDX-License-Identifier: BSD-3-Clause
// Runs for counting instructions. What counts are the calls of the function sfdae_counted_run: creating a solver,
// starting, integrating; callbacks only copy values recorded before. For example
//
//   valgrind --tool=callgrind --collect-atstart=no --toggle-collect=sfdae_counted_run
//     result_hashes --only cost_kron_4_bdf
#include <string>

#include "../replay.h"
#include "multibody/models.h"
#include "problem.h"
#include "trace.h"

namespace {

struct Outcome {
  std::vector<double> x;
  sfdae_statistics statistics;
};

Outcome run(const sfdae_bench::Problem& problem, const sfdae_options& options) {
  Outcome outcome{problem.x0, {}};
  sfdae_statistics_init(&outcome.statistics, sizeof outcome.statistics);
  sfdae_solver* solver = nullptr;
  double t = problem.t0;
  int status = problem.create(&solver, &options);
  if (status >= 0) status = sfdae_start(solver, t, problem.tf, outcome.x.data(), nullptr);
  if (status >= 0) status = sfdae_advance(solver, problem.tf, &t, outcome.x.data(), nullptr);
  sfdae_get_statistics(solver, &outcome.statistics);
  sfdae_destroy(&solver);
  if (status < 0) outcome.x.clear();
  return outcome;
}

}  // namespace

extern "C" __attribute__((noinline)) void sfdae_counted_run(const sfdae_bench::Problem& problem,
                                                            const sfdae_options& options, void* outcome) {
  *static_cast<Outcome*>(outcome) = run(problem, options);
}

namespace sfdae_bench {

namespace {

using namespace sfdae_test;

void count(Trace& trace, const Problem& problem, const sfdae_options& options) {
  Outcome outcome{};
  sfdae_counted_run(problem, options, &outcome);
  trace.numbers("x", outcome.x);
  trace.integer("steps", outcome.statistics.steps);
  trace.integer("factorizations", outcome.statistics.factorizations);
}

void add_kron(Runs& runs, int n, int method) {
  runs.push_back({"cost_kron_" + std::to_string(n) + "_" + name_of(method), [=](Trace& trace) {
                    const Family family = kron(n, 2);
                    Replay replay(family);
                    Problem problem = family_problem(family, 0.0, 1.0);
                    problem.c = replay.problem;
                    run(problem, options_of(method, 1e-6));
                    replay.rewind();
                    count(trace, problem, options_of(method, 1e-6));
                  }});
}

// With both methods.
void add_recorded(Runs& runs, const std::string& name, const Problem& problem) {
  runs.push_back({"cost_" + name, [=](Trace& trace) {
                    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
                      count(trace, problem, options_of(method, 1e-6));
                  }});
}

}  // namespace

void add_cost_runs(Runs& runs) {
  for (const int n : {4, 32})
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) add_kron(runs, n, method);
  const TestProblem p = pendulum(), a = andrews();
  add_recorded(
      runs, "pendulum_raw",
      recorded(p.n, p.n,
               [](const auto& t, const auto* x, const auto* xdot, auto* F) { pendulum_residual(t, x, xdot, F); })
          .on(0.0, 2.0)
          .from(p.x0));
  add_recorded(runs, "pendulum_multibody",
               mechanical_problem(DirectSystem<Pendulum>(), Form::recorded, 0.0, 2.0, {1.0, 0.0}));
  add_recorded(
      runs, "andrews_raw",
      recorded(a.n, a.n,
               [](const auto& t, const auto* x, const auto* xdot, auto* F) { andrews_residual(t, x, xdot, F); })
          .on(0.0, 0.002)
          .from(a.x0));
  add_recorded(runs, "andrews_multibody",
               mechanical_problem(AcceleratedSystem<Andrews>(), Form::recorded, 0.0, 0.002,
                                  std::vector<double>(a.x0.begin(), a.x0.begin() + 14)));
}

}  // namespace sfdae_bench
