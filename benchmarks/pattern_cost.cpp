// The Brusselator by lines as recorded equations and by a function with sparsity patterns: processor time of starts
// and of integrations with BDF to t = 10, rtol = atol = 1e-6, each the least of three runs that take turns;
// evaluations of F; memory at the peak, of one form in a process. Run it with OPENBLAS_NUM_THREADS=1.
//
//   pattern_cost <cells> [recorded|dense|compressed|differences]      one form: memory
//
// SPDX-License-Identifier: BSD-3-Clause
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <map>
#include <string>
#include <vector>

#include "sfdae/sfdae.hpp"
#include "structure_problems.h"

namespace {

constexpr int repetitions = 3;

double milliseconds() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

sfdae::NonlinearProblem problem_of(const std::string& form, int cells) {
  const int n = 2 * cells;
  sfdae::NonlinearProblem problem(n, n);
  if (form == "recorded") {
    problem.equations = [cells](const sfdae::Expression&, auto x, auto xdot, auto F) {
      sfdae_bench::brusselator(cells, &x[0], &xdot[0], &F[0]);
    };
    return problem;
  }
  const sfdae_bench::SparsePeer peer = sfdae_bench::brusselator_peer(cells);
  problem.F_x_pattern = {peer.first, peer.row};
  for (int j = 0; j <= n; ++j) problem.F_xdot_pattern.col_start.push_back(j);
  for (int j = 0; j < n; ++j) problem.F_xdot_pattern.row_index.push_back(j);
  problem.matrices = form == "dense"        ? SFDAE_MATRICES_DENSE
                     : form == "compressed" ? SFDAE_MATRICES_COMPRESSED
                                            : SFDAE_MATRICES_DIFFERENCES;
  problem.total_derivative = [peer, n, form](double t, int order, sfdae::ConstMatrixRef derivatives,
                                             sfdae::TotalDerivatives to) {
    if (order > 0) return SFDAE_ORDER_NOT_AVAILABLE;
    peer.residual(t, &derivatives(0, 0), &derivatives(0, 1), &to.F[0]);
    if (!to.F_x) return 0;
    if (form == "compressed") {
      peer.jacobian(0.0, &derivatives(0, 0), &to.F_x(0, 0));
      for (int j = 0; j < n; ++j) to.F_xdot(j, 0) = 1.0;
      return 0;
    }
    std::vector<double> entries(peer.row.size());
    peer.jacobian(0.0, &derivatives(0, 0), entries.data());
    for (int j = 0; j < n; ++j) {
      for (int e = peer.first[static_cast<std::size_t>(j)]; e < peer.first[static_cast<std::size_t>(j) + 1]; ++e)
        to.F_x(peer.row[static_cast<std::size_t>(e)], j) = entries[static_cast<std::size_t>(e)];
      to.F_xdot(j, j) = 1.0;
    }
    return 0;
  };
  return problem;
}

struct Figures {
  double start = HUGE_VAL, integration = HUGE_VAL;
  sfdae_statistics statistics{};
  std::vector<double> x;
};

void run(const std::string& form, int cells, Figures& figures) {
  sfdae::Options options;
  options.rtol = options.atol = 1e-6;
  options.max_steps = 1000000;
  options.difference_derivatives = true;
  options.method = SFDAE_METHOD_BDF;
  const double begin = milliseconds();
  sfdae::Solver solver(problem_of(form, cells), options);
  const sfdae_bench::SparseProblem start = sfdae_bench::brusselator_problem(cells);
  sfdae::Point point{0.0, start.x0, {}};
  solver.start(point, start.tf);
  const double middle = milliseconds();
  solver.advance(start.tf, point);
  figures.start = std::min(figures.start, middle - begin);
  figures.integration = std::min(figures.integration, milliseconds() - middle);
  figures.statistics = solver.statistics();
  figures.x = point.x;
}

}  // namespace

int main(int argc, char** argv) try {
  const int cells = argc > 1 ? std::atoi(argv[1]) : 200;
  std::vector<std::string> forms = {"recorded", "compressed", "differences"};
  if (cells <= 1000) forms.push_back("dense");
  if (argc > 2) forms = {argv[2]};
  std::map<std::string, Figures> all;
  for (int repetition = 0; repetition < (argc > 2 ? 1 : repetitions); ++repetition)
    for (const std::string& form : forms) run(form, cells, all[form]);
  std::printf("n = %d\n", 2 * cells);
  for (const std::string& form : forms) {
    const Figures& f = all[form];
    double difference = 0.0;
    for (std::size_t i = 0; i < f.x.size(); ++i)
      difference = std::max(difference, std::fabs(f.x[i] - all[forms[0]].x[i]) / (1.0 + std::fabs(f.x[i])));
    std::printf(
        "%-12s start %8.2f ms, integration %9.2f ms, %ld steps, %ld F, %ld linearizations, beside the first %.1e\n",
        form.c_str(), f.start, f.integration, f.statistics.steps, f.statistics.evaluations_F,
        f.statistics.linearizations, difference);
  }
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  if (argc > 2) std::printf("peak of memory %.1f MB\n", static_cast<double>(usage.ru_maxrss) / 1024.0);
  return 0;
} catch (const sfdae::Error& error) {
  std::fprintf(stderr, "%s: %s\n", sfdae::status_name(error.status()), error.what());
  return 1;
}
