// SPDX-License-Identifier: BSD-3-Clause
// Evaluations allocate no memory after the first one of the highest order.
#include <gtest/gtest.h>

#include <cstdlib>
#include <vector>

#include "expression/lane_evaluator.h"
#include "expression/spline.h"
#include "expression/taylor_evaluator.h"
#include "recorded.h"
#include "replaced_new.h"

namespace {

long allocations = 0;

}  // namespace

void sfdae::test::before_allocation() { ++allocations; }
void sfdae::test::before_release(void*) noexcept {}

namespace sfdae::core {

using namespace sfdae_test;

TEST(Allocation, HappensInTheFirstEvaluationOnly) {
  Recording recording(2);
  const auto& x = recording.x;
  const Term p = recording.parameter("p", 2.0);
  const FunctionCall table{Spline::through({3, {0.0, 1.0, 2.0, 3.0}, {0.0, 1.0, 0.0, 1.0}}), {x[1].node}, {}};
  const Term spline(&recording.recorder, recording.recorder.call(table));
  TaylorEvaluator evaluator(
      recording.finish({recording.xdot[0] - atan(x[1]) * sin(recording.t), pow(x[0], p) * x[1] + modulo(spline, p)}));
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

TEST(Allocation, HappensInTheFirstEvaluationOfSeveralPointsOnly) {
  Recording recording(2);
  const auto& x = recording.x;
  const Term p = recording.parameter("p", 2.0);
  TaylorEvaluator source(recording.finish({x[0] - atan(x[1]) * sin(recording.t), pow(x[0], p) * x[1]}));
  LaneEvaluator lanes;
  LaneBlock t;
  LaneArray jet(6);
  for (LaneBlock& block : jet)
    for (double& number : block.lane) number = 0.5;
  const auto evaluate_all = [&] {
    bool fine = true;
    for (int order = 2; order >= 0; --order) {
      t.lane[0] = 0.1 * order;
      fine = fine && lanes.evaluate(source, {&t, {jet.data(), jet.data() + 2, jet.data() + 4}}, order, order != 1);
      source.set_parameter(0, 1.5 + order);
    }
    return fine;
  };
  ASSERT_TRUE(evaluate_all());
  const long before = allocations;
  const bool fine = evaluate_all();
  const long after = allocations;
  EXPECT_TRUE(fine);
  EXPECT_EQ(after, before);
}

}  // namespace sfdae::core
