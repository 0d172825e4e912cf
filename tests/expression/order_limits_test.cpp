// SPDX-License-Identifier: BSD-3-Clause
// Equations evaluated up to orders of their own have the bits that all of them have at the highest order.
#include "expression/order_limits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "expression/lane_evaluator.h"
#include "expression/taylor_evaluator.h"
#include "instruction_sets.h"
#include "matrix_checks.h"
#include "operators.h"
#include "recorded.h"

namespace sfdae::core {

namespace {

using namespace sfdae_test;
using LimitedNumbers = std::vector<double>;
using Limits = std::shared_ptr<const OrderLimits>;

constexpr int highest = 2, jet_columns = highest + 3;

// x near (0.7, 0.45), where all operations are smooth.
LimitedNumbers smooth_jet() {
  const Matrix random = random_matrix(2, jet_columns, 5);
  LimitedNumbers jet{0.7, 0.45};
  for (int k = 1; k < jet_columns; ++k)
    for (int j = 0; j < 2; ++j) jet.push_back(random(j, k));
  return jet;
}

LimitedNumbers all_values(const TaylorEvaluator& source, const LimitedNumbers& jet, int order) {
  TaylorEvaluator evaluator = source;
  LimitedNumbers F(size(source.record().m() * (order + 1)));
  EXPECT_TRUE(evaluator.values(0.3, jet.data(), order, F.data())) << evaluator.failure().message;
  return F;
}

void expect_equal_values(const TaylorEvaluator& source, TaylorEvaluator& limited, const Limits& limits, int more) {
  const int m = source.record().m(), order = highest + more;
  const LimitedNumbers jet = smooth_jet(), all = all_values(source, jet, order);
  LimitedNumbers F(all.size(), -7.0);
  ASSERT_TRUE(limited.values_within(0.3, jet.data(), limits, more, F.data())) << limited.failure().message;
  for (int i = 0; i < m; ++i)
    for (int k = 0; k <= order; ++k) {
      const bool is_wanted = k <= limits->of_equations[size(i)] + more;
      EXPECT_EQ(F[size(i + k * m)], is_wanted ? all[size(i + k * m)] : -7.0) << i << ", order " << k << ", " << more;
    }
}

void expect_equal_entries(const TaylorEvaluator& source, TaylorEvaluator& limited, const Limits& limits) {
  const Tape& tape = source.tape();
  TaylorEvaluator evaluator = source;
  LimitedNumbers all(tape.targets.size() * size(highest + 1), -7.0), entries(all);
  const LimitedNumbers jet = smooth_jet();
  ASSERT_TRUE(evaluator.entries(0.3, jet.data(), highest, limits->of_equations, all.data()));
  ASSERT_TRUE(limited.entries_within(0.3, jet.data(), limits, entries.data())) << limited.failure().message;
  EXPECT_EQ(entries, all);
}

void expect_equal_lanes(const TaylorEvaluator& source, const Limits& limits) {
  const Tape& tape = source.tape();
  const int m = source.record().m();
  const LimitedNumbers jet = smooth_jet(), all = all_values(source, jet, highest);
  TaylorEvaluator evaluator = source;
  LimitedNumbers entries(tape.targets.size() * size(highest + 1));
  ASSERT_TRUE(evaluator.entries(0.3, jet.data(), highest, limits->of_equations, entries.data()));
  LaneArray t(1), jets(jet.size());
  for (int l = 0; l < lane_count; ++l) {
    t[0].lane[l] = 0.3;
    for (std::size_t i = 0; i < jet.size(); ++i) jets[i].lane[l] = jet[i];
  }
  const auto points = LaneEvaluator::points_of(t.data(), jets.data(), highest, 2);
  for_each_instruction_set([&](InstructionSet) {
    LaneEvaluator lanes;
    for (const bool with_gradients : {false, true}) {
      ASSERT_TRUE(lanes.evaluate_within(source, points, limits, with_gradients));
      for (int i = 0; i < m; ++i) {
        const int limit = limits->of_equations[size(i)];
        for (int k = 0; k <= limit; ++k) EXPECT_EQ(lanes.value(i)[k].lane[lane_count - 1], all[size(i + k * m)]);
        if (!with_gradients) continue;
        for (std::size_t e = tape.first_target[size(i)]; e < tape.first_target[size(i + 1)]; ++e)
          for (int k = 0; k <= limit; ++k) {
            const std::size_t place = e * size(highest + 1) + size(k);
            EXPECT_EQ(lanes.gradients()[place].lane[0], entries[place]);
          }
      }
    }
    // All of them by the same lists.
    ASSERT_TRUE(lanes.evaluate(source, points, highest, false));
    for (int i = 0; i < m; ++i)
      for (int k = 0; k <= highest; ++k) EXPECT_EQ(lanes.value(i)[k].lane[0], all[size(i + k * m)]);
  });
}

class EveryOperationWithinLimits : public testing::TestWithParam<Operator> {};

// Equations share operands; what the first one wants to order 0 the second one wants to order 1, the third one to
// order 2.
TEST_P(EveryOperationWithinLimits, HasTheBitsOfAllOrders) {
  Recording recording(2);
  const auto& x = recording.x;
  const Term shared = GetParam().apply(x[0], x[1], recording), sine = sin(x[0]);
  const TaylorEvaluator source(
      recording.finish({GetParam().apply(x[0] + 0.1 * x[1] * shared, x[1], recording) * recording.xdot[1],
                        shared * recording.t + cos(x[0]) * recording.xdot[0], sine * x[0] + exp(recording.t)}));
  const auto limits = std::make_shared<const OrderLimits>(std::vector<int>{0, 1, highest});
  TaylorEvaluator limited = source;
  limited.prepare(limits);
  for (int more : {0, -1, -2, 1, 0}) expect_equal_values(source, limited, limits, more);
  expect_equal_entries(source, limited, limits);
  expect_equal_lanes(source, limits);
  // Others afterwards, and all orders of all equations by the lists that are there.
  const auto others = std::make_shared<const OrderLimits>(std::vector<int>{highest, 0, 0});
  expect_equal_values(source, limited, others, 0);
  expect_equal_entries(source, limited, others);
  const LimitedNumbers jet = smooth_jet(), all = all_values(source, jet, highest);
  LimitedNumbers F(all.size());
  ASSERT_TRUE(limited.values(0.3, jet.data(), highest, F.data()));
  EXPECT_EQ(F, all);
}

INSTANTIATE_TEST_SUITE_P(Operators, EveryOperationWithinLimits, testing::ValuesIn(operators()),
                         [](const auto& instance) { return instance.param.name; });

// sqrt x_0 has no derivative at x_0 = 0, and what x_1' is matters to nobody.
TEST(OrderLimits, LeaveAloneWhatIsNotWanted) {
  Recording recording(2);
  const auto& x = recording.x;
  const TaylorEvaluator source(recording.finish({sqrt(x[0]) + x[1], x[1] * x[1]}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const LimitedNumbers jet{0.0, 2.0, nan, 3.0, nan, nan};
  const auto limits = std::make_shared<const OrderLimits>(std::vector<int>{0, 1});
  TaylorEvaluator evaluator = source;
  LimitedNumbers F(6, -7.0);
  ASSERT_TRUE(evaluator.values_within(0.0, jet.data(), limits, 0, F.data())) << evaluator.failure().message;
  EXPECT_EQ(F, (LimitedNumbers{2.0, 4.0, -7.0, 12.0, -7.0, -7.0}));
  // x_0' is wanted if there is one order more.
  EXPECT_FALSE(evaluator.values_within(0.0, jet.data(), limits, 1, F.data()));
  const LimitedNumbers moving{0.0, 2.0, 1.0, 3.0, 0.0, 1.0};
  EXPECT_FALSE(evaluator.values_within(0.0, moving.data(), limits, 1, F.data()));
  EXPECT_EQ(evaluator.failure().equation, 0);
}

// One operation for the product, two for the constraint.
TEST(OrderLimits, OrderInstructionsByWhatTheyAreWantedFor) {
  Recording recording(2);
  const auto& x = recording.x;
  const Term square = x[0] * x[0];
  const TaylorEvaluator source(recording.finish({x[1] * square, square - 1.0}));
  const InstructionsByOrder by_order(source.tape(), OrderLimits({0, 2}));
  ASSERT_EQ(by_order.lists.size(), 3u);
  const auto count = [&](int order) { return by_order.lists[size(order)].all().size(); };
  EXPECT_EQ(count(0), 1u);
  EXPECT_EQ(count(1), 0u);
  EXPECT_EQ(count(2), 2u);
  const std::vector<Tape::Leaf>& leaves = source.tape().leaves;
  for (std::size_t i = 0; i < leaves.size(); ++i) EXPECT_EQ(by_order.of_leaves[i], leaves[i].unknown == 0 ? 2 : 0);
}

}  // namespace

}  // namespace sfdae::core
