// What one BDF step costs without the user's callbacks, next to LAPACK calls timed in the same run.
//
// Columns: microseconds per attempted step; per reduction (callbacks' data to null-space form); one dgesvd with left
// vectors of the derivative array M of level mu; one dgetrf of order n; and the ratios dgesvd / reduction and
// step / dgetrf ("LUs"). Run it with OPENBLAS_NUM_THREADS=1. Arguments: the largest n; or n, mu and a number of runs of
// 18 steps, to be profiled or compared with another build in turns: the shortest, callbacks that copy included, and the
// median in units of a dgetrf of order 100 timed before each run, for machines whose speed changes all the time.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "c_api/problems.h"
#include "linalg/dense.h"
#include "linear/linear_system.h"
#include "reduction/elimination.h"
#include "replay.h"

extern "C" {
void dgesvd_(const char*, const char*, const int*, const int*, double*, const int*, double*, double*, const int*,
             double*, const int*, double*, const int*, int*);
void dgetrf_(const int*, const int*, double*, const int*, int*, int*);
}

namespace {

using namespace sfdae::core;
using Clock = std::chrono::steady_clock;

// Best of several runs, each of at least a few milliseconds.
template <class Work>
double microseconds(Work work, int runs = 7, double least = 5e3) {
  double best = 1e300;
  work();
  for (int run = 0; run < runs; ++run) {
    long repetitions = 1;
    for (;; repetitions *= 2) {
      const auto start = Clock::now();
      for (long i = 0; i < repetitions; ++i) work();
      const double elapsed = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
      if (elapsed < least) continue;
      best = std::min(best, elapsed / static_cast<double>(repetitions));
      break;
    }
  }
  return best;
}

double time_dgetrf(int n, int runs = 7, double least = 5e3) {
  Matrix a(n, n), work(n, n);
  unsigned state = 1;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) a(i, j) = static_cast<double>((state = state * 1664525u + 1013904223u) >> 8) * 1e-7;
  std::vector<int> pivots(static_cast<std::size_t>(n));
  return microseconds(
      [&] {
        copy(a, work);
        int info = 0;
        dgetrf_(&n, &n, work.data(), &n, pivots.data(), &info);
      },
      runs, least);
}

double time_dgesvd(const Matrix& M) {
  const int rows = M.rows(), cols = M.cols(), one = 1;
  Matrix work(rows, cols), U(rows, rows);
  std::vector<double> s(static_cast<std::size_t>(rows)), scratch(static_cast<std::size_t>(200 * rows));
  const int length = static_cast<int>(scratch.size());
  double none = 0.0;
  return microseconds([&] {
    copy(M, work);
    int info = 0;
    dgesvd_("A", "N", &rows, &cols, work.data(), &rows, s.data(), U.data(), &rows, &none, &one, scratch.data(),
            &length, &info);
  });
}

struct StepCost {
  double step = 0.0, reduction = 0.0, svd = 0.0;
  long steps = 0;
};

double run_once(sfdae_bench::Replay& replay, const sfdae_test::LinearFamily& family, double tol, long& attempts) {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.rtol = options.atol = tol;
  sfdae_solver* solver = nullptr;
  if (sfdae_create_linear(&solver, &replay.problem, &options) != SFDAE_OK) std::abort();
  std::vector<double> x(static_cast<std::size_t>(family.n()));
  family.exact(0.0, x.data(), nullptr);
  if (sfdae_start(solver, 0.0, 1.0, x.data(), nullptr) < 0) std::abort();
  double t = 0.0;
  // 19 steps of the run are timed from the second on: the first allocates.
  if (sfdae_step(solver, 1.0, &t, x.data(), nullptr) < 0) std::abort();
  const auto start = Clock::now();
  int status = SFDAE_STEP_TAKEN;
  for (int i = 0; i < 18 && status == SFDAE_STEP_TAKEN; ++i) status = sfdae_step(solver, 1.0, &t, x.data(), nullptr);
  const double elapsed = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
  sfdae_statistics statistics;
  sfdae_statistics_init(&statistics, sizeof statistics);
  sfdae_get_statistics(solver, &statistics);
  attempts = statistics.steps + statistics.error_failures - 1;
  sfdae_destroy(&solver);
  return elapsed;
}

StepCost measure(int n, int mu) {
  const std::shared_ptr<const sfdae_test::LinearFamily> family = sfdae_test::kron(n, mu, 0.5);
  StepCost cost;
  sfdae_bench::Replay replay(family);
  double best = 1e300;
  run_once(replay, *family, 1e-7, cost.steps);
  for (int run = 0; run < (n <= 32 ? 60 : 12); ++run) {
    replay.rewind();
    best = std::min(best, run_once(replay, *family, 1e-7, cost.steps));
  }
  // The callbacks' share: every evaluation copies mu + 1 derivatives of E and A (E at least 2).
  const std::size_t size = static_cast<std::size_t>(n * n);
  std::vector<double> from(size, 1.0), to(size);
  const double copies = microseconds([&] {
    for (int k = 0; k < std::max(mu + 1, 2) + mu + 1; ++k) {
      std::memcpy(to.data(), from.data(), size * sizeof(double));
      __asm__ volatile("" : : "r"(to.data()) : "memory");
    }
  });
  cost.step = best / static_cast<double>(cost.steps) - copies;

  // One reduction: evaluation apart.
  sfdae_test::FamilyProblem problem(family);
  LinearProblem linear(functions_of(problem.problem));
  Arena arena;
  std::vector<RankDecision> decisions;
  TaylorData data;
  if (linear.evaluate(0.3, {std::max(mu, 1), mu, mu}, 0.0, data).status != SFDAE_OK) std::abort();
  NullSpaceForm form;
  form.resize(n, n, 0, n);
  cost.reduction = microseconds([&] {
    const Judge::Settings judging;
    Judge judge(data, mu, judging, nullptr);
    const Arena::Frame frame(arena);
    const Carried carried = eliminate(data, mu, data.f_stack(mu), 1, judge, arena);
    form.build(data, carried, {}, LeadingTerm::projector, judge, arena);
  });
  const Matrix array = taylor_array(data, mu);
  cost.svd = time_dgesvd(to_matrix(array.view().columns(0, (mu + 1) * n)));
  return cost;
}

int time_steps(int n, int mu, int runs) {
  const std::shared_ptr<const sfdae_test::LinearFamily> family = sfdae_test::kron(n, mu, 0.5);
  sfdae_bench::Replay replay(family);
  long steps = 0;
  run_once(replay, *family, 1e-7, steps);
  double best = 1e300;
  std::vector<double> ratios;
  for (int run = 0; run < runs; ++run) {
    const double lu = time_dgetrf(100, 1, 300.0);
    replay.rewind();
    const double elapsed = run_once(replay, *family, 1e-7, steps);
    best = std::min(best, elapsed);
    ratios.push_back(elapsed / lu);
  }
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  const double each = static_cast<double>(steps);
  std::printf("%.3f us; %.3f where dgetrf of order 100 takes 52 (median)\n", best / each, 52.0 * *middle / each);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 3) return time_steps(std::atoi(argv[1]), std::atoi(argv[2]), std::atoi(argv[3]));
  const int largest = argc > 1 ? std::atoi(argv[1]) : 100;
  const double lu100 = time_dgetrf(100);
  std::printf("dgetrf n = 100: %.1f us; step (scaled) refers to a machine where it takes 52 us\n", lu100);
  std::printf("%4s %3s %10s %14s %10s %12s %10s %12s %10s\n", "n", "mu", "step", "step (scaled)", "reduction",
              "dgesvd", "dgetrf", "svd/reduct.", "step/LU");
  for (int n : {4, 8, 16, 32, 64, 100}) {
    if (n > largest) break;
    const double lu = time_dgetrf(n);
    for (int mu = 0; mu <= 3; ++mu) {
      if (n == 4 && mu == 3) continue;  // d = 0: one step to anywhere
      const StepCost cost = measure(n, mu);
      std::printf("%4d %3d %10.2f %14.2f %10.2f %12.1f %10.2f %12.1f %10.1f\n", n, mu, cost.step,
                  cost.step * 52.0 / lu100, cost.reduction, cost.svd, lu, cost.svd / cost.reduction, cost.step / lu);
      std::fflush(stdout);
    }
  }
}
