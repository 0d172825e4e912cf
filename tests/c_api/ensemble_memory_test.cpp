// Ensembles where memory is missing, here and there or at all: the instances that it concerns say so, all others are
// as they should be. SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>
#include <tuple>
#include <vector>

#include "family_run.h"
#include "replaced_new.h"
#include "sfdae/sfdae.h"

namespace sfdae::test {

// Of all threads.
std::atomic<bool> is_armed{false};
std::atomic<long> seen{0}, first_to_fail{0};
std::atomic<bool> all_later_fail{false};
std::atomic<long> blocks{0};

void before_allocation() {
  if (is_armed) {
    const long number = ++seen, first = first_to_fail;
    if (first > 0 && (number == first || (all_later_fail && number > first))) throw std::bad_alloc();
  }
  ++blocks;
}

void before_release(void* memory) noexcept {
  if (memory != nullptr) --blocks;
}

namespace {

constexpr int n = 5, instances = 3, outputs = 2;

// a^2.
int square(int order, const double* a, double* derivatives, void*) {
  derivatives[0] = order == 0 ? a[0] * a[0] : order == 1 ? 2.0 * a[0] : order == 2 ? 2.0 : 0.0;
  return 0;
}

enum class Squares { formulas, functions };

sfdae_expression squared(const sfdae_expression& a, Squares kind) {
  return kind == Squares::formulas ? sfdae_multiply(a, a) : sfdae_external("square", square, 1, &a, nullptr);
}

// A pendulum of length L; user: its squares.
int pendulum(sfdae_record* record, sfdae_expression, const sfdae_expression* x, const sfdae_expression* xdot,
             sfdae_expression* F, void* user) {
  const Squares kind = *static_cast<const Squares*>(user);
  const sfdae_expression L = sfdae_parameter(record, "L", 1.0);
  F[0] = sfdae_subtract(xdot[0], x[2]);
  F[1] = sfdae_subtract(xdot[1], x[3]);
  F[2] = sfdae_add(xdot[2], sfdae_multiply(x[0], x[4]));
  F[3] = sfdae_add(sfdae_add(xdot[3], sfdae_multiply(x[1], x[4])), sfdae_number(1.0));
  F[4] = sfdae_subtract(sfdae_add(squared(x[0], kind), squared(x[1], kind)), sfdae_multiply(L, L));
  return 0;
}

struct Attempt {
  int status = SFDAE_OK;
  std::vector<double> x = std::vector<double>(n * outputs * instances, -1.0);
  std::vector<int> statuses = std::vector<int>(instances, -1), num_outputs = statuses;

  void solve(sfdae_solver* solver, int threads) {
    static const char* const names[] = {"L"};
    static const double parameters[] = {1.0, 2.0, 0.5}, times[] = {0.1, 0.2};
    static const double x0[] = {1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -2.0, 0.1, 0.0, 0.0, 0.3, -0.4, 0.0, 0.0, 0.0};
    sfdae_ensemble ensemble;
    sfdae_ensemble_init(&ensemble, sizeof ensemble);
    ensemble.num_instances = instances;
    ensemble.num_parameters = 1;
    ensemble.parameter_names = names;
    ensemble.parameters = parameters;
    ensemble.x0 = x0;
    ensemble.num_times = outputs;
    ensemble.times = times;
    ensemble.num_threads = threads;
    sfdae_ensemble_results results;
    sfdae_ensemble_results_init(&results, sizeof results);
    results.x = x.data();
    results.statuses = statuses.data();
    results.num_outputs = num_outputs.data();
    is_armed = true;
    status = sfdae_solve_ensemble(solver, &ensemble, &results);
    is_armed = false;
  }
};

class MissingMemory : public testing::TestWithParam<std::tuple<int, Squares>> {
 protected:
  MissingMemory() {
    sfdae_nonlinear_problem problem;
    sfdae_nonlinear_problem_init(&problem, sizeof problem);
    problem.num_equations = problem.num_unknowns = n;
    problem.equations = pendulum;
    Squares kind = std::get<1>(GetParam());
    problem.user = &kind;
    sfdae_create_nonlinear(&solver_, &problem, nullptr);
    for (int pass = 0; pass < 2; ++pass) expected_.solve(solver_, 1);  // tables are computed at their first use
    EXPECT_EQ(expected_.status, SFDAE_OK);
    Attempt counted;
    seen = 0;
    counted.solve(solver_, threads_);
    allocations_ = seen;
  }
  ~MissingMemory() override { sfdae_destroy(&solver_); }

  void fail_at(long k, bool later) {
    SCOPED_TRACE(testing::Message() << "allocation " << k << (later ? " and later" : ""));
    const long before = blocks;
    {
      Attempt run;
      seen = 0;
      all_later_fail = later;
      first_to_fail = k;
      run.solve(solver_, threads_);
      first_to_fail = 0;
      check(run, later);
    }
    if (!HasFailure()) {
      EXPECT_EQ(blocks, before) << "not given back";
    }
  }

  void check(const Attempt& run, bool later) {
    if (run.status == SFDAE_OUT_OF_MEMORY) {
      EXPECT_EQ(run.statuses, std::vector<int>(instances, -1));
      EXPECT_EQ(run.x, std::vector<double>(run.x.size(), -1.0));
      return;
    }
    int failed = 0;
    for (std::size_t i = 0; i < instances; ++i) {
      if (run.statuses[i] != SFDAE_OK) {
        ++failed;
        EXPECT_EQ(run.statuses[i], SFDAE_OUT_OF_MEMORY);
      }
      for (std::size_t j = 0; j < n * outputs; ++j) {
        const std::size_t place = i * n * outputs + j;
        const bool is_reached = j < n * static_cast<std::size_t>(run.num_outputs[i]);
        EXPECT_EQ(run.x[place], is_reached ? expected_.x[place] : -1.0);
      }
      EXPECT_TRUE(run.statuses[i] != SFDAE_OK || run.num_outputs[i] == outputs);
    }
    EXPECT_EQ(run.status, failed > 0 ? SFDAE_INSTANCES_FAILED : SFDAE_OK);
    if (!later) {
      EXPECT_LE(failed, 1);
    }
  }

  const int threads_ = std::get<0>(GetParam());
  sfdae_solver* solver_ = nullptr;
  Attempt expected_;
  long allocations_ = 0;
};

TEST_P(MissingMemory, ConcernsInstancesThatNeedIt) {
  ASSERT_GT(allocations_, 100);
  const long step = std::max(1L, allocations_ / sfdae_test::scaled_count(150));
  for (long k = 1; k <= allocations_; k += k < 60 ? 1 : step)
    for (const bool later : {false, true}) fail_at(k, later);
  Attempt afterwards;
  afterwards.solve(solver_, threads_);
  EXPECT_EQ(afterwards.status, SFDAE_OK);
  EXPECT_EQ(afterwards.x, expected_.x);
}

INSTANTIATE_TEST_SUITE_P(Threads, MissingMemory,
                         testing::Combine(testing::Values(1, 2),
                                          testing::Values(Squares::formulas, Squares::functions)));

}  // namespace
}  // namespace sfdae::test
