// Large and high-index recorded problems by their minimal extension: processor time of starts (recording, analysis,
// consistent values) and of integrations with BDF, rtol = atol = 1e-6, medians of three runs. Each case is run in a
// process of its own, whose peak of memory is told without what the program takes before. The Brusselator and
// Stokes's equations (size: cells a side; IDA: differentiated by hand) beside IDA with band matrices and KLU, both
// with analytic Jacobians; errors are those of the worst component relative to 1 + |x|, of runs at 1e-9 (amplifiers:
// 1e-8, as their start fails at 1e-9). Run it with OPENBLAS_NUM_THREADS=1.
//
//   structure_cost csv > structure_cost.csv     for the plots that structure_cost.gp makes
//   structure_cost [brusselator|stokes|ladder|amplifiers|currents|links|pendula [size [alone]]]
//
// alone: one run of this library, for profilers.
// SPDX-License-Identifier: BSD-3-Clause
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include "ida_sparse.h"
#include "sfdae/sfdae.h"
#include "stokes_problem.h"
#include "structure_problems.h"
#include "text_table.h"

namespace {

using sfdae_bench::Expression;
using sfdae_bench::SparsePeer;
using sfdae_bench::SparseProblem;
using sfdae_bench::text;
using sfdae_bench::TextTable;

constexpr double work_tol = 1e-6, reference_tol = 1e-9;
constexpr int repetitions = 3;

double milliseconds() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// What a child process hands back; the values x at the end follow.
struct Figures {
  double start, integration, megabytes;
  long steps, evaluations, linearizations, factorizations;
  char failure[600];
};

struct Run {
  Figures figures{};
  std::vector<double> x;
};

double peak_megabytes() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

// The same in a process of its own.
Run in_child(std::size_t n, const std::function<Run()>& work) {
  const std::size_t length = sizeof(Figures) + n * sizeof(double);
  char* shared = static_cast<char*>(mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  if (shared == MAP_FAILED) std::abort();
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    const double before = peak_megabytes();
    Run run = work();
    run.figures.megabytes = peak_megabytes() - before;
    run.x.resize(n);
    std::memcpy(shared, &run.figures, sizeof(Figures));
    std::memcpy(shared + sizeof(Figures), run.x.data(), n * sizeof(double));
    _exit(0);
  }
  int status = 0;
  Run run;
  run.x.resize(n);
  if (child < 0 || waitpid(child, &status, 0) != child || status != 0)
    std::snprintf(run.figures.failure, sizeof run.figures.failure, "the process failed");
  else {
    std::memcpy(&run.figures, shared, sizeof(Figures));
    std::memcpy(run.x.data(), shared + sizeof(Figures), n * sizeof(double));
  }
  munmap(shared, length);
  return run;
}

int write(sfdae_record*, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
          sfdae_expression* residual, void* user) {
  const auto& problem = *static_cast<const SparseProblem*>(user);
  const std::size_t n = problem.x0.size();
  const std::vector<Expression> unknowns(x, x + n), slopes(xdot, xdot + n);
  std::vector<Expression> F(n);
  problem.record(Expression(t), unknowns.data(), slopes.data(), F.data());
  std::transform(F.begin(), F.end(), residual, [](const Expression& e) { return e.c(); });
  return 0;
}

Run solve(const SparseProblem& problem, double tol, bool integrate) {
  Run run;
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.rtol = options.atol = tol;
  options.method = SFDAE_METHOD_BDF;
  options.structure = SFDAE_STRUCTURE_REQUIRED;
  options.use_stop_time = 1;
  options.stop_time = problem.tf;
  sfdae_nonlinear_problem equations;
  sfdae_nonlinear_problem_init(&equations, sizeof equations);
  equations.num_equations = equations.num_unknowns = static_cast<int>(problem.x0.size());
  equations.equations = &write;
  equations.user = const_cast<SparseProblem*>(&problem);
  run.x = problem.x0;
  std::vector<double> xdot(run.x.size());
  sfdae_solver* solver = nullptr;
  double t = 0.0;
  const double begin = milliseconds();
  int status = sfdae_create_nonlinear(&solver, &equations, &options);
  if (status >= 0) status = sfdae_start(solver, t, problem.tf, run.x.data(), xdot.data());
  run.figures.start = milliseconds() - begin;
  if (status >= 0 && integrate) status = sfdae_advance(solver, problem.tf, &t, run.x.data(), xdot.data());
  run.figures.integration = milliseconds() - begin - run.figures.start;
  if (status < 0)
    std::snprintf(run.figures.failure, sizeof run.figures.failure, "%s: %s", sfdae_status_name(status),
                  sfdae_message(solver));
  sfdae_statistics counts;
  sfdae_statistics_init(&counts, sizeof counts);
  sfdae_get_statistics(solver, &counts);
  run.figures.steps = counts.steps;
  run.figures.evaluations = counts.evaluations_F;
  run.figures.linearizations = counts.linearizations;
  run.figures.factorizations = counts.factorizations;
  sfdae_destroy(&solver);
  return run;
}

Run solve_peer(const SparsePeer& peer, double tol, sfdae_bench::PeerMatrix kind) {
  Run run;
  const double begin = milliseconds();
  const sfdae_bench::SparsePeerRun ida = sfdae_bench::solve_with_sparse_ida(peer, tol, kind);
  run.figures.integration = milliseconds() - begin;
  run.figures.steps = ida.steps;
  run.figures.evaluations = ida.residuals;
  run.figures.linearizations = run.figures.factorizations = ida.jacobians;
  std::snprintf(run.figures.failure, sizeof run.figures.failure, "%s", ida.failure.c_str());
  run.x = ida.x;
  return run;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// The last of a few runs, with the medians of their times.
Run typical(std::size_t n, const std::function<Run()>& work) {
  std::vector<double> starts, integrations;
  Run run;
  for (int k = 0; k < repetitions; ++k) {
    run = in_child(n, work);
    if (run.figures.failure[0] != '\0') return run;
    starts.push_back(run.figures.start);
    integrations.push_back(run.figures.integration);
  }
  run.figures.start = median(starts);
  run.figures.integration = median(integrations);
  return run;
}

double error(const Run& run, const std::vector<double>& reference) {
  double largest = 0.0;
  for (std::size_t i = 0; i < reference.size(); ++i)
    largest = std::max(largest, std::fabs(run.x[i] - reference[i]) / (1.0 + std::fabs(reference[i])));
  return largest;
}

std::string small_number(double value) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.1e", value);
  return digits;
}

// Empty cells where nothing was measured.
void print(const TextTable& table, const char* problem, const char* solver, const Run& run,
           const std::vector<double>& reference) {
  const Figures& f = run.figures;
  const std::string n = text(static_cast<int>(run.x.size()));
  if (f.failure[0] != '\0') {
    table.row({problem, n, solver, f.failure});
    return;
  }
  const double per_step = f.steps > 0 ? 1e3 * f.integration / static_cast<double>(f.steps) : NAN;
  table.row({problem, n, solver, text(f.start), f.steps > 0 ? text(f.integration) : "", text(f.start + f.integration),
             f.steps > 0 ? std::to_string(f.steps) : "", text(per_step), std::to_string(f.evaluations),
             std::to_string(f.linearizations), std::to_string(f.factorizations),
             reference.empty() ? "" : small_number(error(run, reference)), text(f.megabytes)});
}

// with_band: where bands are narrow.
void compare(const TextTable& table, const char* name, const SparsePeer& peer, const SparseProblem& problem,
             bool with_band) {
  const std::size_t size = problem.x0.size();
  using sfdae_bench::PeerMatrix;
  const auto ours = [&] { return solve(problem, work_tol, true); };
  const auto reference = [&] {
    return sfdae_bench::sparse_ida_is_available() ? solve_peer(peer, reference_tol, PeerMatrix::klu)
                                                  : solve(problem, reference_tol, true);
  };
  const std::vector<double> x = in_child(size, reference).x;
  print(table, name, "sfdae", typical(size, ours), x);
  if (!sfdae_bench::sparse_ida_is_available()) return;
  const auto band = [&] { return solve_peer(peer, work_tol, PeerMatrix::band); };
  const auto klu = [&] { return solve_peer(peer, work_tol, PeerMatrix::klu); };
  if (with_band) print(table, name, "IDA band", typical(size, band), x);
  print(table, name, "IDA KLU", typical(size, klu), x);
  // About as accurate as ours.
  const auto tight = [&] { return solve_peer(peer, 0.1 * work_tol, PeerMatrix::klu); };
  print(table, name, "IDA 1e-7", typical(size, tight), x);
  const Run exact = in_child(size, [&] { return solve(problem, reference_tol, true); });
  print(table, name, "sfdae 1e-9", exact, x);
}

// For plots: milliseconds for all against the number of unknowns at one tolerance, and against the error at one size.
void write_rows(const char* name, const SparsePeer& peer, const SparseProblem& problem,
                const std::vector<double>& tolerances) {
  using sfdae_bench::PeerMatrix;
  const std::size_t n = problem.x0.size();
  const std::vector<double> reference =
      in_child(n, [&] { return solve_peer(peer, reference_tol, PeerMatrix::klu); }).x;
  for (const double tol : tolerances) {
    const auto row = [&](const char* solver, const Run& run) {
      const Figures& f = run.figures;
      if (f.failure[0] != '\0') std::fprintf(stderr, "%s %zu %s: %s\n", name, n, solver, f.failure);
      else
        std::printf("%s,%zu,%s,%.0e,%.4g,%.3g,%.4g\n", name, n, solver, tol, f.start + f.integration,
                    error(run, reference), f.megabytes);
      std::fflush(stdout);
    };
    row("sfdae", typical(n, [&] { return solve(problem, tol, true); }));
    row("IDA KLU", typical(n, [&] { return solve_peer(peer, tol, PeerMatrix::klu); }));
  }
}

void write_csv() {
  const std::vector<double> one = {work_tol}, many = {1e-4, 1e-5, 1e-6, 1e-7};
  std::printf("problem,unknowns,solver,tolerance,milliseconds,error,megabytes\n");
  for (const int cells : {50, 100, 200, 500, 1000, 2000, 5000})
    write_rows("brusselator", sfdae_bench::brusselator_peer(cells), sfdae_bench::brusselator_problem(cells),
               cells == 1000 ? many : one);
  for (const int cells : {6, 8, 12, 18, 28, 41})
    write_rows("stokes", sfdae_bench::stokes_peer(cells), sfdae_bench::stokes_problem(cells),
               cells == 18 ? many : one);
}

struct Family {
  const char* name;
  SparseProblem (*problem)(int);
  std::vector<int> sizes;
  int largest_integrated;
  double reference_tol;  // 0: no errors are wanted
};

void measure(const TextTable& table, const Family& family, int size) {
  const SparseProblem problem = family.problem(size);
  const std::size_t n = problem.x0.size();
  const bool integrate = size <= family.largest_integrated;
  std::vector<double> reference;
  if (family.reference_tol > 0.0 && integrate) {
    const Run run = in_child(n, [&] { return solve(problem, family.reference_tol, true); });
    if (run.figures.failure[0] != '\0') print(table, family.name, "reference", run, {});
    else reference = run.x;
  }
  const Run run = typical(n, [&] { return solve(problem, work_tol, integrate); });
  print(table, (std::string(family.name) + " " + std::to_string(size)).c_str(), "sfdae", run, reference);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string wanted = argc > 1 ? argv[1] : "all";
  const int only = argc > 2 ? std::atoi(argv[2]) : 0;
  if (wanted == "csv") {
    write_csv();
    return 0;
  }
  const TextTable table({{"problem", -14},
                         {"n", 5},
                         {"solver", -10},
                         {"start, ms", 9},
                         {"integration", 11},
                         {"all", 7},
                         {"steps", 6},
                         {"us a step", 9},
                         {"F", 6},
                         {"lin.", 5},
                         {"LU", 5},
                         {"error", 8},
                         {"MB", 6}},
                        false);
  if (argc > 3 && wanted == "stokes") {
    print(table, "stokes", "sfdae", solve(sfdae_bench::stokes_problem(only), work_tol, true), {});
    return 0;
  }
  if (argc > 3 && wanted == "brusselator") {
    print(table, "brusselator", "sfdae", solve(sfdae_bench::brusselator_problem(only / 2), work_tol, true), {});
    return 0;
  }
  if (wanted == "all" || wanted == "brusselator")
    for (const int n : {400, 2000, 10000})
      if (only == 0 || only == n)
        compare(table, "brusselator", sfdae_bench::brusselator_peer(n / 2), sfdae_bench::brusselator_problem(n / 2),
                true);
  if (wanted == "all" || wanted == "stokes")
    for (const int k : {8, 18, 41})
      if (only == 0 || only == k)
        compare(table, "stokes", sfdae_bench::stokes_peer(k), sfdae_bench::stokes_problem(k), false);
  const Family families[] = {
      {"ladder", sfdae_bench::ladder_problem, {500}, 500, reference_tol},
      {"amplifiers", sfdae_bench::amplifier_problem, {1, 3, 10, 30, 100}, 100, 1e-8},
      {"currents", sfdae_bench::amplifier_problem_with_currents, {1, 3, 10, 30, 100}, 100, 1e-8},
      {"links", sfdae_bench::link_problem, {10, 20, 50, 100, 200, 500}, 500, 0.0},
      {"pendula", sfdae_bench::pendula_problem, {1, 2, 3, 4, 5, 6, 8, 10, 12}, 5, reference_tol}};
  for (const Family& family : families)
    if (argc > 3 && wanted == family.name) {
      print(table, family.name, "sfdae", solve(family.problem(only), work_tol, only <= family.largest_integrated),
            {});
      return 0;
    }
  for (const Family& family : families)
    for (const int size : family.sizes)
      if ((wanted == "all" || wanted == family.name) && (only == 0 || only == size)) measure(table, family, size);
}
