// SPDX-License-Identifier: BSD-3-Clause
// Work against precision on mechanical systems, as comma-separated values on standard output, as those of
// work_precision_nonlinear. Solvers: IDA on forms of lower index made by hand, the library on the same equations as a
// multibody system, the equations of the test set as they are with their derivative array ("general") and by their
// minimal extension ("structured"), and those of the multibody system with the constraints alone differentiated twice
// ("extended"). The least time for 4, 6 and 8 digits follows on standard error. A five-bar is solved by the library
// alone.
//
//   work_precision_multibody [problem...] > results.csv
//   work_precision_multibody chain                     cost of a step of pendulums of many links
//   gnuplot -e "results='results.csv'" benchmarks/work_precision_multibody.gp
//
// Runs one BLAS thread if OPENBLAS_NUM_THREADS=1 and the like say so.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <utility>
#include <vector>

#include "multibody/chain.h"
#include "multibody/five_bar.h"
#include "multibody/models.h"
#include "multibody/multibody_run.h"
#include "test_set/test_set.h"
#include "work_precision_nonlinear_sfdae.h"
#include "work_precision_rows.h"

namespace {

using sfdae_bench::Method;
using sfdae_bench::Results;
using sfdae_bench::Row;
using sfdae_bench::SolverRun;
using sfdae_test::MultibodyForm;
using sfdae_test::MultibodyRun;
using sfdae_test::TestProblem;

// Recording, analysis, initial values and integration.
template <class System>
SolverRun solve(const System& system, const TestProblem& problem, MultibodyForm form, Method method, double tol) {
  sfdae_bench::TimeLimit limit;
  sfdae_options options = sfdae_bench::options_for(method, tol, limit);
  options.stop_time = problem.tf;
  if (form == MultibodyForm::general) options.structure = SFDAE_STRUCTURE_REQUIRED;
  MultibodyRun run(system, form, options);
  SolverRun result;
  const int status = run.integrate(problem.t0, problem.tf, problem.x0);
  if (status < 0 || run.t != problem.tf) result.failure = run.text(status);
  const sfdae_statistics statistics = run.statistics();
  result.x = run.x;
  result.steps = statistics.steps;
  result.evaluations = statistics.evaluations_F + statistics.linearizations;
  result.factorizations = statistics.factorizations;
  return result;
}

template <class System>
void run_sfdae(const TestProblem& problem, const System& system, MultibodyForm form, Results& results) {
  const char* name = form == MultibodyForm::recorded  ? "multibody"
                     : form == MultibodyForm::general ? "structured"
                                                      : "extended";
  const std::pair<Method, const char*> methods[] = {{Method::bdf, "BDF"}, {Method::radau, "Radau"}};
  for (const auto& [method, method_name] : methods)
    for (const double tol : sfdae_bench::tolerances()) {
      Row row = sfdae_bench::measured([&, method = method] { return solve(system, problem, form, method, tol); });
      row.problem = problem.name;
      row.solver = std::string(name) + " " + method_name;
      row.form = name;
      row.tol = tol;
      results.add(problem, std::move(row));
    }
}

// Multipliers that are not consistent would change positions as well.
template <class System>
TestProblem with_multipliers(const TestProblem& problem, const System& system) {
  TestProblem result = problem;
  MultibodyRun run(system, MultibodyForm::recorded, sfdae_test::multibody_options(1e-6, SFDAE_METHOD_BDF));
  if (run.start(problem.t0, problem.tf, problem.x0) >= 0) result.x0 = run.x;
  return result;
}

// IDA and the library on the equations of the test set, judged by the components that multibody systems have, too.
void run_test_set(const TestProblem& problem, Results& results) {
  const std::string name = problem.name == "fekete" ? "fekete_position" : problem.name;
  sfdae_test::for_each_problem_of_test_set([&](TestProblem peer, const auto& equations) {
    if (peer.name != name) return;
    peer.counted = problem.counted;
    sfdae_bench::run_ida(peer, results);
    struct Run {
      Method method;
      const char *solver, *form;
      int structure;
    };
    const Run runs[] = {{Method::bdf, "general BDF", "general", SFDAE_STRUCTURE_AUTOMATIC},
                        {Method::radau, "general Radau", "general", SFDAE_STRUCTURE_AUTOMATIC},
                        {Method::bdf, "structured BDF", "structured", SFDAE_STRUCTURE_REQUIRED},
                        {Method::radau, "structured Radau", "structured", SFDAE_STRUCTURE_REQUIRED}};
    for (const Run& run : runs)
      for (const double tol : sfdae_bench::tolerances()) {
        Row row = sfdae_bench::measured(
            [&] { return sfdae_bench::solve_with_sfdae(peer, equations, run.method, tol, run.structure); });
        row.problem = problem.name;
        row.solver = run.solver;
        row.form = run.form;
        row.tol = tol;
        results.add(peer, std::move(row));
      }
  });
}

// The raw equations of a five-bar, 10 unknowns, beside its multibody form; the reference is that of the latter at
// 1e-13.
void run_five_bar(Results& results) {
  const sfdae_test::FiveBar system;
  TestProblem problem{.name = "five_bar", .m = 10, .n = 10, .t0 = 0.0, .tf = 2.0, .x0 = sfdae_test::five_bar_start()};
  problem.counted = sfdae_test::first_components(8);
  const SolverRun reference = solve(system, problem, MultibodyForm::recorded, Method::radau, 1e-13);
  problem.references = {{problem.tf, reference.x}};
  run_sfdae(problem, system, MultibodyForm::recorded, results);
  run_sfdae(problem, system, MultibodyForm::general, results);
}

void run_problems(const std::vector<std::string>& wanted) {
  Results results;
  if (wanted.empty() || std::find(wanted.begin(), wanted.end(), "five_bar") != wanted.end()) run_five_bar(results);
  sfdae_test::for_each_multibody_model([&](const TestProblem& problem, const auto& system) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), problem.name) == wanted.end()) return;
    run_test_set(problem, results);
    run_sfdae(problem, system, MultibodyForm::recorded, results);
    run_sfdae(with_multipliers(problem, system), system, MultibodyForm::extended, results);
  });
  results.summarize();
}

struct ChainRow {
  int links, method, structure;
};

// Processor time of the start and of a step in microseconds, the least of some runs.
struct ChainCost {
  double create = 0.0, start = 0.0, step = 0.0;
  long steps = 0;
};

ChainCost cost_of(const ChainRow& row) {
  constexpr double tolerance = 1e-6;
  const sfdae_test::PendulumChain system(row.links);
  const double end = 5.0 / row.links;
  ChainCost best;
  const auto microseconds_since = [](std::clock_t begin) {
    return 1e6 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  };
  for (int k = 0; k < (row.links < 50 ? 5 : 1); ++k) {
    sfdae_options options = sfdae_test::multibody_options(tolerance, row.method);
    options.structure = row.structure;
    std::clock_t begin = std::clock();
    MultibodyRun run(system, MultibodyForm::recorded, options);
    const double create = microseconds_since(begin);
    begin = std::clock();
    if (run.start(0.0, end, system.start()) < 0) continue;
    const double start = microseconds_since(begin);
    begin = std::clock();
    if (run.advance(end) < 0) continue;
    best.steps = run.statistics().steps;
    const double step = microseconds_since(begin) / static_cast<double>(best.steps);
    const auto keep_least = [k](double value, double& least) { least = k == 0 ? value : std::min(least, value); };
    keep_least(create, best.create);
    keep_least(start, best.start);
    keep_least(step, best.step);
  }
  return best;
}

// With local coordinates and with sparse matrices; the exponents p of costs N^p from the row before.
void run_chains() {
  constexpr int most_links_with_dense_matrices = 100;
  std::printf("links,solver,matrices,steps,create us,start us,exponent,us a step,exponent\n");
  for (const int structure : {SFDAE_STRUCTURE_OFF, SFDAE_STRUCTURE_REQUIRED})
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      ChainCost before;
      int links_before = 0;
      for (const int links : {5, 10, 20, 50, 100, 200, 500}) {
        if (structure == SFDAE_STRUCTURE_OFF && links > most_links_with_dense_matrices) break;
        const ChainCost cost = cost_of({links, method, structure});
        const auto exponent = [&](double now, double then) {
          return then > 0.0 ? std::log(now / then) / std::log(static_cast<double>(links) / links_before) : 0.0;
        };
        std::printf("%d,%s,%s,%ld,%.4g,%.4g,%.2f,%.4g,%.2f\n", links, method == SFDAE_METHOD_BDF ? "BDF" : "Radau",
                    structure == SFDAE_STRUCTURE_OFF ? "dense" : "sparse", cost.steps, cost.create, cost.start,
                    exponent(cost.start, before.start), cost.step, exponent(cost.step, before.step));
        std::fflush(stdout);
        before = cost;
        links_before = links;
      }
    }
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> wanted(argv + 1, argv + argc);
  if (wanted.size() == 1 && wanted.front() == "chain") run_chains();
  else run_problems(wanted);
}
