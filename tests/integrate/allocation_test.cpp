// Steps allocate nothing after the first.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

#include "family_problem.h"
#include "family_run.h"

namespace {

std::atomic<bool> counting{false};
std::atomic<long> allocations{0};

void* counted(std::size_t size) {
  if (counting.load(std::memory_order_relaxed)) ++allocations;
  void* memory = std::malloc(size > 0 ? size : 1);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

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

TEST(Allocation, IsCounted) {
  allocations = 0;
  counting = true;
  std::vector<double> something(100);
  counting = false;
  EXPECT_GE(allocations.load() + static_cast<long>(something[0]), 1);
}

}  // namespace
