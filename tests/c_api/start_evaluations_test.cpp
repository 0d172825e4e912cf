// SPDX-License-Identifier: BSD-3-Clause
// What a start asks of the user's functions: everything once at its point, and nothing that it has asked before
// another call.
#include <gtest/gtest.h>
#include <sfdae/sfdae.h>

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "family_problem.h"
#include "linear_family.h"
#include "testset_linear.h"

namespace {

using sfdae_test::Call;
using sfdae_test::Callback;
using sfdae_test::FamilyProblem;
using CountedFamily = std::shared_ptr<const sfdae_test::LinearFamily>;
using CountedNumbers = std::vector<double>;

struct CountedSolver {
  sfdae_solver* handle = nullptr;
  explicit CountedSolver(const sfdae_linear_problem& problem) {
    sfdae_options options;
    sfdae_options_init(&options, sizeof options);
    EXPECT_EQ(sfdae_create_linear(&handle, &problem, &options), SFDAE_OK);
  }
  CountedSolver(const CountedSolver&) = delete;
  CountedSolver& operator=(const CountedSolver&) = delete;
  ~CountedSolver() { sfdae_destroy(&handle); }
};

std::vector<CountedFamily> families() {
  return {CountedFamily(sfdae_test::kron(5, 0)),    CountedFamily(sfdae_test::kron(20, 1)),
          CountedFamily(sfdae_test::kron(30, 2)),   CountedFamily(sfdae_test::kron(9, 1, 0.5, 2)),
          CountedFamily(sfdae_test::kron(24, 3)),   CountedFamily(sfdae_test::chain(4, 2)),
          CountedFamily(sfdae_test::spin(0.3, 2.0))};
}

// x, x' and eight steps from there, one after the other.
CountedNumbers course(CountedSolver& solver, const sfdae_test::LinearFamily& family, double t) {
  const std::size_t n = static_cast<std::size_t>(family.n());
  CountedNumbers x(n), xdot(n), all;
  if (family.has_exact()) family.exact(t, x.data(), nullptr);
  EXPECT_GE(sfdae_start(solver.handle, t, t + 1.0, x.data(), xdot.data()), 0) << sfdae_message(solver.handle);
  const auto keep = [&] {
    all.insert(all.end(), x.begin(), x.end());
    all.insert(all.end(), xdot.begin(), xdot.end());
  };
  keep();
  for (int step = 0; step < 8; ++step) {
    EXPECT_GE(sfdae_step(solver.handle, t + 1.0, &t, x.data(), xdot.data()), 0);
    keep();
  }
  return all;
}

}  // namespace

TEST(StartEvaluations, AreMadeOnceAtThePoint) {
  for (const CountedFamily& family : families()) {
    FamilyProblem callbacks(family);
    std::map<std::pair<Callback, int>, int> count;
    callbacks.hooks.status = [&](const Call& call) {
      if (call.t == 0.25) ++count[{call.function, call.order}];
      return 0;
    };
    CountedSolver solver(callbacks.problem);
    CountedNumbers x(static_cast<std::size_t>(family->n()));
    if (family->has_exact()) family->exact(0.25, x.data(), nullptr);
    ASSERT_GE(sfdae_start(solver.handle, 0.25, 1.0, x.data(), nullptr), 0) << sfdae_message(solver.handle);
    EXPECT_GE(count.size(), 3u);
    for (const auto& [what, calls] : count) EXPECT_EQ(calls, 1) << family->name() << ", order " << what.second;
  }
}

// Values and factorizations that are kept within the start are none that anything depends on.
TEST(StartEvaluations, LeaveEveryBitAsItIsWithoutThem) {
  for (const CountedFamily& family : families()) {
    FamilyProblem one(family), other(family);
    CountedSolver at_once(one.problem), in_two_calls(other.problem);
    sfdae_characteristics values;
    sfdae_characteristics_init(&values, sizeof values);
    ASSERT_GE(sfdae_analyze(in_two_calls.handle, 0.25, 1.25, &values), 0) << sfdae_message(in_two_calls.handle);
    EXPECT_EQ(course(at_once, *family, 0.25), course(in_two_calls, *family, 0.25)) << family->name();
    // Started again, without an analysis.
    EXPECT_EQ(course(at_once, *family, 0.25), course(in_two_calls, *family, 0.25)) << family->name();
  }
}

// x_1' = x_2, 0 = x_2 - c: c is another one in each call.
TEST(StartEvaluations, SeeWhatHasChangedSinceTheCallBefore) {
  double c = 1.0;
  sfdae_linear_problem problem;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 2;
  problem.user = &c;
  problem.E = [](double, int order, double* E, void*) {
    if (order == 0) E[0] = 1.0;
    return 0;
  };
  problem.A = [](double, int order, double* A, void*) {
    if (order == 0) A[2] = A[3] = 1.0;
    return 0;
  };
  problem.f = [](double, int order, double* f, void* user) {
    if (order == 0) f[1] = -*static_cast<const double*>(user);
    return 0;
  };
  CountedSolver solver(problem);
  ASSERT_GE(sfdae_analyze(solver.handle, 0.0, 1.0, nullptr), 0);
  for (double next : {2.0, 3.0, -1.0}) {
    c = next;
    CountedNumbers x{0.0, 0.0}, xdot(2);
    ASSERT_GE(sfdae_start(solver.handle, 0.0, 1.0, x.data(), xdot.data()), 0) << sfdae_message(solver.handle);
    EXPECT_NEAR(x[1], c, 1e-12);
    EXPECT_NEAR(xdot[0], c, 1e-12);
  }
}
