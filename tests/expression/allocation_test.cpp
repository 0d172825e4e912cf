// SPDX-License-Identifier: BSD-3-Clause
// Evaluations allocate no memory after the first one of the highest order.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "recorded.h"

namespace {

long allocations = 0;

void* counted(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  try {
    return counted(size);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

namespace sfdae::core {

using namespace sfdae_test;

TEST(Allocation, HappensInTheFirstEvaluationOnly) {
  Recording recording(2);
  const auto& x = recording.x;
  const Term p = recording.parameter("p", 2.0);
  TaylorEvaluator evaluator(
      recording.finish({recording.xdot[0] - atan(x[1]) * sin(recording.t), pow(x[0], p) * x[1]}));
  std::vector<double> jet(2 * 8, 0.5), F(2 * 7), F_xdot(4 * 7), F_x(4 * 7);
  const auto evaluate_all = [&](int highest) {
    bool fine = true;
    for (int order = highest; order >= 0; --order) {
      fine = fine && evaluator.values(0.1 * order, jet.data(), order, F.data());
      const SeriesOrders orders{order, order, 0};
      fine = fine && evaluator.gradients(0.2 * order, jet.data(), orders, F.data(), F_xdot.data(), F_x.data());
      evaluator.set_parameter(0, 1.5 + order);
    }
    return fine;
  };
  ASSERT_TRUE(evaluate_all(6));
  const long before = allocations;
  ASSERT_GT(before, 0);
  const bool fine = evaluate_all(6);
  const long after = allocations;
  EXPECT_TRUE(fine);
  EXPECT_EQ(after, before);
}

}  // namespace sfdae::core
