// What the start of an integration costs, recording excluded: index analysis, consistent values, first linearization.
// Beside it one LU of order n. Run it with OPENBLAS_NUM_THREADS=1.
// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <sfdae/sfdae.hpp>
#include <string>
#include <vector>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "linear_family.h"
#include "multibody/models.h"
#include "multibody/multibody_run.h"
#include "replay.h"
#include "start_problems.h"
#include "test_set/test_set.h"

namespace {

using sfdae_bench::StartProblem;

void start(benchmark::State& state, const StartProblem& problem) {
  for (auto run : state) {
    state.PauseTiming();
    auto solver = std::make_unique<sfdae::Solver>(problem.equations);
    state.ResumeTiming();
    sfdae::Point point{problem.t0, problem.guess, problem.xdot};
    solver->start(point, problem.tf);
    state.PauseTiming();
    solver.reset();
    state.ResumeTiming();
  }
}

// Once more from the same point: what was analyzed is known.
void restart(benchmark::State& state, const StartProblem& problem) {
  sfdae::Solver solver(problem.equations);
  for (auto run : state) {
    sfdae::Point point{problem.t0, problem.guess, problem.xdot};
    solver.start(point, problem.tf);
  }
}

// The whole life of an instance: recorded, created, started, destroyed.
void instance(benchmark::State& state, const StartProblem& problem) {
  for (auto run : state) {
    sfdae::Solver solver(problem.equations);
    sfdae::Point point{problem.t0, problem.guess, problem.xdot};
    solver.start(point, problem.tf);
  }
}

// Linear problems, whose callbacks copy what was recorded in a first run.
void linear(benchmark::State& state, const std::shared_ptr<const sfdae_test::LinearFamily>& family) {
  sfdae_bench::Replay replay(family);
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  const auto run_once = [&] {
    sfdae_solver* solver = nullptr;
    std::vector<double> x(sfdae::core::index(family->n()));
    family->exact(0.0, x.data(), nullptr);
    if (sfdae_create_linear(&solver, &replay.problem, &options) != SFDAE_OK ||
        sfdae_start(solver, 0.0, 1.0, x.data(), nullptr) < 0)
      state.SkipWithError(sfdae_message(solver));
    sfdae_destroy(&solver);
  };
  run_once();
  for (auto run : state) {
    replay.rewind();
    run_once();
  }
}

using MultibodyRun = sfdae_test::MultibodyRun<sfdae_test::DirectSystem<sfdae_test::Pendulum>>;

// A multibody pendulum: started again, created and started, solved to t = 10 with rtol = atol = 1e-6 by Radau.
enum class Part { again, instance, solution };

void multibody_pendulum(benchmark::State& state, Part part) {
  const sfdae_test::DirectSystem<sfdae_test::Pendulum> system;
  const sfdae_test::TestProblem problem = sfdae_test::pendulum();
  const std::vector<double> guess(problem.x0.begin(), problem.x0.begin() + 4);
  const sfdae_options options = sfdae_test::multibody_options(1e-6, SFDAE_METHOD_RADAU);
  const auto create = [&] {
    return std::make_unique<MultibodyRun>(system, sfdae_test::MultibodyForm::recorded, options);
  };
  std::unique_ptr<MultibodyRun> run = create();
  for (auto repetition : state) {
    if (part != Part::again) run = create();
    if (run->start(0.0, 10.0, guess) < 0) std::abort();
    if (part == Part::solution && run->advance(10.0) < 0) std::abort();
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

void register_starts() {
  const auto add = [](const std::string& name, auto run) {
    benchmark::RegisterBenchmark(name.c_str(), run)->Unit(benchmark::kMillisecond);
  };
  for (int n : {20, 50, 100, 200}) {
    const std::string size = std::string("/").append(std::to_string(n));
    add(std::string("semi_explicit").append(size),
        [n](benchmark::State& s) { start(s, sfdae_bench::semi_explicit(n)); });
    add(std::string("semi_explicit").append(size).append("/again"),
        [n](benchmark::State& s) { restart(s, sfdae_bench::semi_explicit(n)); });
    for (int mu = 0; mu <= 2 && n <= 100; ++mu) {
      const std::string name = std::string("kron").append(size).append("/mu").append(std::to_string(mu));
      add(name, [n, mu](benchmark::State& s) { linear(s, sfdae_test::kron(n, mu)); });
    }
  }
  for (int n : {50, 100, 400})
    add(std::string("heat/").append(std::to_string(n)), [n](benchmark::State& s) { start(s, sfdae_bench::heat(n)); });
  add("stokes/176", [](benchmark::State& s) { start(s, sfdae_bench::stokes(8)); });
  add("pendulum", [](benchmark::State& s) { start(s, sfdae_bench::pendulum()); });
  add("pendulum/instance", [](benchmark::State& s) { instance(s, sfdae_bench::pendulum()); });
  add("andrews", [](benchmark::State& s) { start(s, sfdae_bench::andrews()); });
  add("transistor_amplifier", [](benchmark::State& s) { start(s, sfdae_bench::transistor_amplifier()); });
  add("multibody_pendulum/again", [](benchmark::State& s) { multibody_pendulum(s, Part::again); });
  add("multibody_pendulum/instance", [](benchmark::State& s) { multibody_pendulum(s, Part::instance); });
  add("multibody_pendulum/solution", [](benchmark::State& s) { multibody_pendulum(s, Part::solution); });
}

BENCHMARK(lu)->Arg(20)->Arg(50)->Arg(100)->Arg(176)->Arg(200)->Arg(400)->Unit(benchmark::kMillisecond);

}  // namespace

int main(int argc, char** argv) {
  register_starts();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
