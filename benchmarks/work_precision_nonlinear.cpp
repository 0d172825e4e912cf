// SPDX-License-Identifier: BSD-3-Clause
// Work against precision on the nonlinear test set, as comma-separated values on standard output:
// problem, solver, form, tol, correct digits of the counted components, milliseconds of processor time (best of several
// runs), steps, evaluations of F, factorizations, failure. The least time for 4, 6 and 8 digits follows on standard
// error.
//
//   work_precision_nonlinear [problem...] > results.csv
//   gnuplot -e "results='results.csv'" benchmarks/work_precision_nonlinear.gp
//
// Runs one BLAS thread if OPENBLAS_NUM_THREADS=1 and the like say so.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "test_set/test_set.h"
#include "work_precision_nonlinear_sfdae.h"
#include "work_precision_rows.h"

namespace {

using sfdae_bench::measured;
using sfdae_bench::Method;
using sfdae_bench::Results;
using sfdae_bench::Row;
using sfdae_bench::tolerances;
using sfdae_test::TestProblem;

template <class Equations>
void run_sfdae(const TestProblem& problem, const Equations& equations, Results& results) {
  const std::pair<Method, const char*> methods[] = {{Method::bdf, "sfdae BDF"}, {Method::radau, "sfdae Radau"}};
  const bool position_form = problem.name == "fekete_position";
  for (const auto& [method, name] : methods)
    for (const double tol : tolerances()) {
      Row row =
          measured([&, method = method] { return sfdae_bench::solve_with_sfdae(problem, equations, method, tol); });
      row.problem = position_form ? "fekete" : problem.name;
      row.solver = name;
      row.form = position_form ? "idx3" : "raw";
      row.tol = tol;
      results.add(problem, std::move(row));
    }
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> wanted(argv + 1, argv + argc);
  Results results;
  sfdae_test::for_each_problem_of_test_set([&](const TestProblem& problem, const auto& equations) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), problem.name) == wanted.end()) return;
    sfdae_bench::run_ida(problem, results);
    run_sfdae(problem, equations, results);
  });
  results.summarize();
}
