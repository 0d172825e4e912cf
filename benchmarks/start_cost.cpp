// What the start of an integration costs, recording excluded: index analysis, consistent values, first linearization.
// Beside it one LU of order n. Run it with OPENBLAS_NUM_THREADS=1.
// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <sfdae/sfdae.hpp>
#include <vector>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace {

// x_i' = -x_i + 0.3 x_(i+1) z_i - 0.1 z_(i+3), 0 = z_i + 0.1 z_i^3 - sin x_i - 0.2 z_(i+1): strangeness index 0, n / 2
// of each, z unknown.
void semi_explicit(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0)), h = n / 2;
  sfdae::NonlinearProblem problem(n, n);
  problem.equations = [h](const sfdae::Expression&, auto x, auto xdot, auto F) {
    for (int i = 0; i < h; ++i) {
      const auto z = x[h + i];
      F[i] = xdot[i] + x[i] - 0.3 * x[(i + 1) % h] * z + 0.1 * x[h + (i + 3) % h];
      F[h + i] = z + 0.1 * z * z * z - sin(x[i]) - 0.2 * x[h + (i + 1) % h];
    }
  };
  sfdae::Solver solver(problem);
  std::vector<double> guess(sfdae::core::index(n), 0.0);
  for (int i = 0; i < h; ++i) guess[sfdae::core::index(i)] = 0.5 + 0.01 * i;
  for (auto run : state) {
    sfdae::Point point{0.0, guess, {}};
    solver.start(point, 1.0);
  }
}

void lu(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  sfdae::core::Matrix a(n, n), factors(n, n);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) a(i, j) = i == j ? 2.0 : 1.0 / (1.0 + i + 2.0 * j);
  std::vector<int> pivots(sfdae::core::index(n));
  for (auto run : state) {
    copy(a, factors);
    benchmark::DoNotOptimize(factor_lu(factors, pivots.data()));
  }
}

BENCHMARK(semi_explicit)->Arg(20)->Arg(50)->Arg(100)->Arg(200)->Unit(benchmark::kMillisecond);
BENCHMARK(lu)->Arg(20)->Arg(50)->Arg(100)->Arg(200)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
