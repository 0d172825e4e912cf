// Kernels: one reduction next to the LAPACK calls it is measured against. Run with OPENBLAS_NUM_THREADS=1.
// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <memory>
#include <vector>

#include "c_api/problems.h"
#include "family_problem.h"
#include "linalg/dense.h"
#include "problem/linear_problem.h"
#include "reduction/elimination.h"
#include "reduction/null_space_form.h"

namespace {

using namespace sfdae::core;

TaylorData data_of(const std::shared_ptr<const sfdae_test::LinearFamily>& family, int mu) {
  sfdae_test::FamilyProblem problem(family);
  LinearProblem linear(functions_of(problem.problem));
  TaylorData data;
  if (linear.evaluate(0.3, {std::max(mu, 1), mu, mu}, 0.0, data).status != SFDAE_OK) std::abort();
  return data;
}

void reduction(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0)), mu = static_cast<int>(state.range(1));
  const TaylorData data = data_of(sfdae_test::kron(n, mu), mu);
  NullSpaceForm form;
  form.resize(n, n, 0, n);
  Arena arena;
  const Judge::Settings judging;
  for (auto _ : state) {
    Judge judge(data, mu, judging, nullptr);
    const Arena::Frame frame(arena);
    const Carried carried = eliminate(data, mu, data.f_stack(mu), 1, judge, arena);
    form.build(data, carried, {}, LeadingTerm::projector, judge, arena);
    benchmark::DoNotOptimize(form.xp());
  }
}
BENCHMARK(reduction)->ArgsProduct({{4, 8, 16, 32, 64, 100}, {0, 1, 2, 3}});

void svd_of_derivative_array(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0)), mu = static_cast<int>(state.range(1));
  const TaylorData data = data_of(sfdae_test::kron(n, mu), mu);
  const Matrix array = taylor_array(data, mu);
  for (auto _ : state) benchmark::DoNotOptimize(svd(array.view().columns(0, (mu + 1) * n)).s.data());
}
BENCHMARK(svd_of_derivative_array)->ArgsProduct({{8, 32, 64}, {2}});

void lu(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  const TaylorData data = data_of(sfdae_test::kron(n, 0), 0);
  Matrix work(n, n);
  std::vector<int> pivots(static_cast<std::size_t>(n));
  for (auto _ : state) {
    copy(data.A(0), work);
    benchmark::DoNotOptimize(factor_lu(work, pivots.data()));
  }
}
BENCHMARK(lu)->Arg(4)->Arg(8)->Arg(16)->Arg(32)->Arg(64)->Arg(100);

}  // namespace

BENCHMARK_MAIN();
