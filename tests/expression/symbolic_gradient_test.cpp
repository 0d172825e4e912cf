// SPDX-License-Identifier: BSD-3-Clause
// Recorded derivatives against those of the evaluator.
#include "expression/symbolic_gradient.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "recorded.h"

namespace sfdae::core {

namespace {

using namespace sfdae_test;

// x in (0, 1) and y > 1: every operation is defined.
std::vector<Term> expressions(Recording& r) {
  const Term &x = r.x[0], &y = r.x[1], &z = r.x[2], p = r.parameter("p", 1.7);
  return {x + y * z - x / y,
          -(x - z) * x * x * x,
          pow(y, p) + pow(y, Term(-2.5)) + pow(z, Term(3.0)),
          sqrt(y) * exp(x * z) + log(y),
          sin(x * y) - cos(z) * tan(x),
          asin(x) + acos(x * z) + atan(y),
          atan2(y, z) - atan2(x * y, Term(2.0) + z),
          sinh(x) + cosh(y) * tanh(z),
          abs(z - y) + min(x, y) * max(x * y, z),
          choose(x - y, x * x, z * y) + choose(y - x, x * y, z),
          log10(y) * x + floor(y * Term(3.0)) * z,
          modulo(y, x) + modulo(-z, x * y),
          r.t * x + Term(3.0),
          r.xdot[0] * x + r.xdot[1]};
}

}  // namespace

TEST(SymbolicGradient, IsThatOfTheEvaluator) {
  constexpr int n = 3;
  const std::vector<double> jet = {0.4, 1.8, 0.7, 0.3, -0.2, 0.9};
  Recording counting(n);
  const std::size_t count = expressions(counting).size();
  for (std::size_t k = 0; k < count; ++k) {
    SCOPED_TRACE(k);
    Recording original(n), differentiated(n);
    TaylorEvaluator evaluator(original.finish({expressions(original)[k]}));
    double F = 0.0, F_x[n] = {};
    ASSERT_TRUE(evaluator.gradients(0.3, jet.data(), {0, -1, 0}, &F, nullptr, F_x));
    std::vector<Term> recorded;
    for (int node : symbolic_gradient(differentiated.recorder, expressions(differentiated)[k].node, n))
      recorded.push_back({&differentiated.recorder, node});
    TaylorEvaluator gradient(differentiated.finish(recorded));
    double found[n] = {};
    ASSERT_TRUE(gradient.values(0.3, jet.data(), 0, found));
    for (int j = 0; j < n; ++j) {
      // Some ten operations on numbers of about this size.
      const double rounding = 100 * std::numeric_limits<double>::epsilon() * (1.0 + std::fabs(F_x[j]));
      EXPECT_NEAR(found[j], F_x[j], rounding) << "by x" << j;
    }
  }
}

// Unknowns beyond the count are held.
TEST(SymbolicGradient, StopsAtTheCount) {
  Recording r(2);
  const std::vector<int> gradient = symbolic_gradient(r.recorder, (r.x[0] * r.x[1]).node, 1);
  ASSERT_EQ(gradient.size(), 1u);
  EXPECT_EQ(gradient[0], r.x[1].node);
}

}  // namespace sfdae::core
