// Steps allocate nothing after the first.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <vector>

#include "../multibody/pendulum.h"
#include "family_problem.h"
#include "family_run.h"
#include "replaced_new.h"
#include "test_set/formula_problems.h"
#include "test_set/pendulum.h"
#include "test_set/recorded.h"

namespace {

std::atomic<bool> counting{false};
std::atomic<long> allocations{0};

}  // namespace

void sfdae::test::before_allocation() {
  if (counting.load(std::memory_order_relaxed)) ++allocations;
}
void sfdae::test::before_release(void*) noexcept {}

namespace {

using namespace sfdae_test;

// Callbacks of the problem allocate in the tests' own code: counting is on within the library only.
struct Paused {
  sfdae_linear_problem inner;
};

template <class Call>
int paused(Call call) {
  const bool was = counting.exchange(false);
  const int status = call();
  counting = was;
  return status;
}

int paused_E(double t, int k, double* to, void* user) {
  auto* p = static_cast<Paused*>(user);
  return paused([&] { return p->inner.E(t, k, to, p->inner.user); });
}
int paused_A(double t, int k, double* to, void* user) {
  auto* p = static_cast<Paused*>(user);
  return paused([&] { return p->inner.A(t, k, to, p->inner.user); });
}
int paused_f(double t, int k, double* to, void* user) {
  auto* p = static_cast<Paused*>(user);
  return paused([&] { return p->inner.f(t, k, to, p->inner.user); });
}

// Never zero, but near enough to zero to be looked at closely again and again.
int bending(double t, const double* x, const double* xdot, double* g, void*) {
  g[0] = 1.001 + std::cos(50.0 * t);
  g[1] = 1e-3 + x[0] * x[0];
  g[2] = 1e-3 + xdot[0] * xdot[0];
  return 0;
}

long allocations_in_steps(std::shared_ptr<const LinearFamily> family, bool constant, bool events = false,
                          int method = SFDAE_METHOD_BDF) {
  FamilyProblem problem(std::move(family));
  if (constant) problem.declare_constants();
  Paused p{problem.problem};
  sfdae_linear_problem counted_problem = problem.problem;
  counted_problem.E = paused_E;
  counted_problem.A = paused_A;
  counted_problem.f = paused_f;
  counted_problem.user = &p;
  sfdae_options options = options_with_tolerance(1e-6);
  options.method = method;
  if (method != SFDAE_METHOD_BDF) options.max_step = 0.02;
  sfdae_solver* solver = nullptr;
  EXPECT_EQ(sfdae_create_linear(&solver, &counted_problem, &options), SFDAE_OK);
  std::vector<double> x(static_cast<std::size_t>(problem.n())), xdot(x);
  if (problem.family().has_exact()) problem.family().exact(0.0, x.data(), nullptr);
  EXPECT_EQ(sfdae_set_events(solver, events ? 3 : 0, bending, nullptr, nullptr), SFDAE_OK);
  EXPECT_GE(sfdae_start(solver, 0.0, 1.0, x.data(), xdot.data()), 0);
  double t = 0.0;
  int status = SFDAE_STEP_TAKEN;
  // Where it comes to slopes within steps of Radau for the first time, room for more derivatives is made.
  const double warm = method == SFDAE_METHOD_BDF ? 0.0 : 0.3;
  while (status == SFDAE_STEP_TAKEN && t <= warm) status = sfdae_step(solver, 1.0, &t, x.data(), xdot.data());
  EXPECT_EQ(status, SFDAE_STEP_TAKEN);
  allocations = 0;
  long steps = 0;
  while (status == SFDAE_STEP_TAKEN && t < 0.9) {
    counting = true;
    status = sfdae_step(solver, 1.0, &t, x.data(), xdot.data());
    counting = false;
    ++steps;
  }
  EXPECT_EQ(status, SFDAE_STEP_TAKEN);
  EXPECT_GE(steps, 10);
  sfdae_destroy(&solver);
  return allocations;
}

TEST(Allocation, StepsAllocateNothingAfterTheFirst) {
  for (int n : {4, 8, 16, 32, 40})
    for (int mu = 0; mu <= 2; ++mu) EXPECT_EQ(allocations_in_steps(kron(n, mu, 0.5), false), 0) << n << " " << mu;
  EXPECT_EQ(allocations_in_steps(kron(8, 1, 0.5, 1), false), 0);
  EXPECT_EQ(allocations_in_steps(kron(8, 1, 0.0), true), 0);
  EXPECT_EQ(allocations_in_steps(chain(10, 2), false), 0);
}

TEST(Allocation, StepsWithEventFunctionsAllocateNothingAfterTheFirst) {
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    EXPECT_EQ(allocations_in_steps(kron(8, 1, 0.5), false, true, method), 0) << method;
    EXPECT_EQ(allocations_in_steps(kron(8, 1, 0.0), true, true, method), 0) << method;
    EXPECT_EQ(allocations_in_steps(chain(10, 2), false, true, method), 0) << method;
  }
}

// x1' = -x1 x2, 0 = x2 - x1 by total derivatives.
int hyperbola(double, int order, const double* x, double* F, double* F_x, double* F_xdot, void*) {
  const auto derivative = [x](int i, int k) { return x[i + 2 * k]; };
  F[0] = derivative(0, order + 1);
  double binomial = 1.0;
  for (int j = 0; j <= order; ++j) {
    F[0] += binomial * derivative(0, j) * derivative(1, order - j);
    binomial *= static_cast<double>(order - j) / (j + 1);
  }
  F[1] = derivative(1, order) - derivative(0, order);
  const double one = order == 0 ? 1.0 : 0.0;
  if (F_x != nullptr) {
    F_x[0] = derivative(1, order);
    F_x[1] = -one;
    F_x[2] = derivative(0, order);
    F_x[3] = one;
  }
  if (F_xdot != nullptr) F_xdot[0] = one;
  return 0;
}

// From the consistent x at t0.
long allocations_in_nonlinear_steps(const sfdae_nonlinear_problem& problem, double t0, std::vector<double> x,
                                    int method) {
  sfdae_options options = options_with_tolerance(1e-6);
  options.method = method;
  options.max_step = 0.01;
  sfdae_solver* solver = nullptr;
  EXPECT_EQ(sfdae_create_nonlinear(&solver, &problem, &options), SFDAE_OK);
  std::vector<double> xdot(x);
  EXPECT_GE(sfdae_start(solver, t0, t0 + 1.0, x.data(), xdot.data()), 0) << sfdae_message(solver);
  double t = t0;
  int status = SFDAE_STEP_TAKEN;
  // Judged linearizations, at the latest after 20 points, and slopes within steps have come by at least once.
  while (status == SFDAE_STEP_TAKEN && t <= t0 + 0.5)
    status = sfdae_step(solver, t0 + 1.0, &t, x.data(), xdot.data());
  EXPECT_EQ(status, SFDAE_STEP_TAKEN) << sfdae_message(solver);
  allocations = 0;
  long steps = 0;
  while (status == SFDAE_STEP_TAKEN && t < t0 + 0.9) {
    counting = true;
    status = sfdae_step(solver, t0 + 1.0, &t, x.data(), xdot.data());
    counting = false;
    ++steps;
  }
  EXPECT_EQ(status, SFDAE_STEP_TAKEN) << sfdae_message(solver);
  EXPECT_GE(steps, 10);
  sfdae_destroy(&solver);
  return allocations;
}

// Recorded, from its consistent start.
template <class Equations>
long allocations_in_recorded_steps(const TestProblem& p, const Equations& equations, int method) {
  RecordedEquations<Equations> recorded(p, equations);
  sfdae_nonlinear_problem problem;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = p.m;
  problem.num_unknowns = p.n;
  problem.equations = &RecordedEquations<Equations>::write;
  problem.user = &recorded;
  return allocations_in_nonlinear_steps(problem, p.t0, p.x0, method);
}

long allocations_of_formulas(const char* name, int method) {
  const FormulaProblem& p = formula_problem(name);
  const auto equations = [&p](int, const auto& t, const auto* x, const auto* xdot, auto* F) {
    p.residual(t, x, xdot, F);
  };
  return allocations_in_recorded_steps(p.data, equations, method);
}

TEST(Allocation, NonlinearStepsAllocateNothingAfterTheFirst) {
  const auto falling = [](int, const auto& t, const auto* x, const auto* xdot, auto* F) {
    pendulum_residual(t, x, xdot, F);
  };
  sfdae_nonlinear_problem by_callback;
  sfdae_nonlinear_problem_init(&by_callback, sizeof by_callback);
  by_callback.num_equations = by_callback.num_unknowns = 2;
  by_callback.total_derivative = hyperbola;
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    EXPECT_EQ(allocations_in_nonlinear_steps(by_callback, 0.0, {1.0, 1.0}, method), 0) << method;
    EXPECT_EQ(allocations_in_recorded_steps(pendulum(), falling, method), 0) << method;
    EXPECT_EQ(allocations_of_formulas("torus", method), 0) << method;
    EXPECT_EQ(allocations_of_formulas("robot_arm", method), 0) << method;
  }
}

TEST(Allocation, MultibodyStepsAllocateNothingAfterTheFirst) {
  sfdae::test::Pendulum pendulum, twice{2, 0.0};
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (const sfdae_multibody_problem& problem : {pendulum.problem(), twice.problem()}) {
      sfdae::test::MultibodyRun run(problem, sfdae::test::options_of(method, 1e-6));
      ASSERT_EQ(run.start(0.0, 20.0, sfdae::test::Pendulum::state(0.3, 2.3)), SFDAE_OK) << run.message();
      ASSERT_EQ(run.advance(10.0), SFDAE_OK) << run.message();
      const long partitions = run.report().partitions;
      allocations = 0;
      while (run.t < 18.0) {
        counting = true;
        run.status = sfdae_step(run.solver.get(), 20.0, &run.t, run.x.data(), run.xdot.data());
        counting = false;
        ASSERT_EQ(run.status, SFDAE_STEP_TAKEN) << run.message();
      }
      EXPECT_EQ(allocations, 0) << method;
      EXPECT_GT(run.report().partitions, partitions);
    }
}

// After the first ones; x' is asked for at every second one, or at none.
long allocations_of_outputs(sfdae_solver* solver, std::vector<double> x, double tf, bool with_slopes = true) {
  std::vector<double> xdot(x.size());
  EXPECT_GE(sfdae_start(solver, 0.0, tf, x.data(), xdot.data()), 0) << sfdae_message(solver);
  double t = 0.0;
  allocations = 0;
  for (int i = 1; i <= 400; ++i) {
    counting = i > 200;
    const int status =
        sfdae_advance(solver, tf * i / 400, &t, x.data(), with_slopes && i % 2 == 0 ? xdot.data() : nullptr);
    counting = false;
    EXPECT_EQ(status, SFDAE_OK) << sfdae_message(solver);
  }
  sfdae_destroy(&solver);
  return allocations;
}

TEST(Allocation, OutputsWithinStepsAllocateNothing) {
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (int output : {SFDAE_OUTPUT_CONSISTENT, SFDAE_OUTPUT_INTERPOLATED}) {
      sfdae_options options = options_with_tolerance(1e-6);
      options.method = method;
      options.output = output;
      sfdae_solver* solver = nullptr;
      FamilyProblem family(kron(8, 1, 2.0));
      Paused p{family.problem};
      sfdae_linear_problem linear = family.problem;
      linear.E = paused_E, linear.A = paused_A, linear.f = paused_f, linear.user = &p;
      ASSERT_EQ(sfdae_create_linear(&solver, &linear, &options), SFDAE_OK);
      std::vector<double> x(8);
      family.family().exact(0.0, x.data(), nullptr);
      // x' from the array of the next level has data of its own.
      const bool with_slopes = method == SFDAE_METHOD_BDF || output == SFDAE_OUTPUT_INTERPOLATED;
      EXPECT_EQ(allocations_of_outputs(solver, x, 4.0, with_slopes), 0) << method << " " << output;

      const TestProblem raw = pendulum();
      const auto falling = [](int, const auto& t, const auto* values, const auto* xdot, auto* F) {
        pendulum_residual(t, values, xdot, F);
      };
      RecordedEquations<decltype(falling)> recorded(raw, falling);
      sfdae_nonlinear_problem nonlinear;
      sfdae_nonlinear_problem_init(&nonlinear, sizeof nonlinear);
      nonlinear.num_equations = raw.m;
      nonlinear.num_unknowns = raw.n;
      nonlinear.equations = &RecordedEquations<decltype(falling)>::write;
      nonlinear.user = &recorded;
      ASSERT_EQ(sfdae_create_nonlinear(&solver, &nonlinear, &options), SFDAE_OK);
      EXPECT_EQ(allocations_of_outputs(solver, raw.x0, 4.0), 0) << method << " " << output;

      sfdae::test::Pendulum swinging;
      const sfdae_multibody_problem multibody = swinging.problem();
      ASSERT_EQ(sfdae_create_multibody(&solver, &multibody, &options), SFDAE_OK);
      EXPECT_EQ(allocations_of_outputs(solver, sfdae::test::Pendulum::state(0.3, 2.3), 10.0), 0)
          << method << " " << output;
    }
}

TEST(Allocation, IsCounted) {
  allocations = 0;
  counting = true;
  std::vector<double> something(100);
  counting = false;
  EXPECT_GE(allocations.load() + static_cast<long>(something[0]), 1);
}

}  // namespace
