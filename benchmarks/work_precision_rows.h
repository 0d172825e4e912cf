// SPDX-License-Identifier: BSD-3-Clause
// Rows of work against precision: each run measured, printed and compared.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "ida_forms.h"
#include "ida_solver.h"
#include "test_set/test_problem.h"

namespace sfdae_bench {

struct Row {
  std::string problem, solver, form;
  double tol = 0.0, digits = 0.0, milliseconds = 0.0;
  SolverRun run;
};

// Processor time, which other programs disturb least. Runs are repeated until they have taken a fifth of a second
// together, at most ten times.
template <class Solve>
Row measured(const Solve& solve) {
  Row row;
  row.milliseconds = std::numeric_limits<double>::infinity();
  double spent = 0.0;
  for (int k = 0; k < 10 && spent < 200.0; ++k) {
    const std::clock_t start = std::clock();
    row.run = solve();
    const double elapsed = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    row.milliseconds = std::min(row.milliseconds, elapsed);
    spent += elapsed;
  }
  return row;
}

class Results {
 public:
  Results() { std::printf("problem,solver,form,tol,digits,milliseconds,steps,evaluations,factorizations,failure\n"); }

  void add(const sfdae_test::TestProblem& problem, Row row) {
    std::printf("%s,%s,%s,%.2e,", row.problem.c_str(), row.solver.c_str(), row.form.c_str(), row.tol);
    if (row.run.failure.empty()) {
      row.digits = sfdae_test::correct_digits(problem, problem.references.back(), row.run.x.data());
      std::printf("%.2f,%.4g,%ld,%ld,%ld,\n", row.digits, row.milliseconds, row.run.steps, row.run.evaluations,
                  row.run.factorizations);
      rows_.push_back(std::move(row));
    } else {
      std::printf(",,%ld,%ld,%ld,\"%s\"\n", row.run.steps, row.run.evaluations, row.run.factorizations,
                  row.run.failure.c_str());
    }
    std::fflush(stdout);
  }

  // The fastest run of each solver that has at least so many digits.
  void summarize() const {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const Row& first = rows_[i];
      const auto same = [&](const Row& row) { return row.problem == first.problem && row.solver == first.solver; };
      if (std::find_if(rows_.begin(), rows_.end(), same) - rows_.begin() != static_cast<std::ptrdiff_t>(i)) continue;
      std::fprintf(stderr, "%-22s %-12s", first.problem.c_str(), first.solver.c_str());
      for (const double digits : {4.0, 6.0, 8.0}) {
        const Row* best = nullptr;
        for (const Row& row : rows_)
          if (same(row) && row.digits >= digits && (best == nullptr || row.milliseconds < best->milliseconds))
            best = &row;
        if (best == nullptr) std::fprintf(stderr, "  %.0f: -                         ", digits);
        else
          std::fprintf(stderr, "  %.0f: %8.3g ms (%s, %ld steps)", digits, best->milliseconds, best->form.c_str(),
                       best->run.steps);
      }
      std::fprintf(stderr, "\n");
    }
  }

 private:
  std::vector<Row> rows_;
};

inline std::vector<double> tolerances() {
  std::vector<double> all;
  for (double exponent = -3.0; exponent >= -11.0; exponent -= 0.5) all.push_back(std::pow(10.0, exponent));
  return all;
}

inline void run_ida(const sfdae_test::TestProblem& problem, Results& results) {
  if (!ida_is_available()) return;
  for (const PeerProblem& form : peer_forms(problem))
    for (const double tol : tolerances()) {
      Row row = measured([&] { return solve_with_ida(form, tol); });
      row.problem = form.problem;
      row.solver = "IDA";
      row.form = form.form;
      row.tol = tol;
      results.add(problem, std::move(row));
    }
}

}  // namespace sfdae_bench
