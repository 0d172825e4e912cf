// SPDX-License-Identifier: BSD-3-Clause
// Equations at several points at once are those at each of them.
#include "expression/lane_evaluator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <tuple>
#include <vector>

#include "instruction_sets.h"
#include "matrix_checks.h"
#include "operators.h"
#include "recorded.h"

namespace sfdae::core {

namespace {

using namespace sfdae_test;
using Numbers = std::vector<double>;

constexpr int orders = LaneEvaluator::highest_order + 1, columns = orders + 1;

// Jets of n unknowns at the points of all lanes, and t.
struct Jets {
  Jets(const Numbers& x0, int points, std::uint64_t seed)
      : n(static_cast<int>(x0.size())), blocks(size(n * columns)) {
    const Matrix random = random_matrix(n * columns, points, seed);
    for (int l = 0; l < lane_count; ++l) {
      const int point = std::min(l, points - 1);
      t.lane[l] = 0.3 + 0.1 * point;
      for (int k = 0; k < columns; ++k)
        for (int j = 0; j < n; ++j) {
          const double own = random(j + k * n, point);
          blocks[size(j + k * n)].lane[l] = k == 0 ? x0[size(j)] * (1.0 + 0.02 * own) : own;
        }
    }
  }
  LaneEvaluator::Points points() const {
    return {&t, {blocks.data(), blocks.data() + n, blocks.data() + 2 * n, blocks.data() + 3 * n}};
  }
  // That of lane l.
  Numbers jet(int l) const {
    Numbers result;
    for (const LaneBlock& block : blocks) result.push_back(block.lane[l]);
    return result;
  }
  int n;
  LaneBlock t;
  LaneArray blocks;
};

// The same bits as the points one by one.
void expect_equal(const TaylorEvaluator& source, LaneEvaluator& lanes, const Jets& jets, int order) {
  const int m = source.record().m(), n = source.record().n();
  const Tape& tape = source.tape();
  TaylorEvaluator single = source;
  ASSERT_TRUE(lanes.evaluate(source, jets.points(), order, true));
  for (int l = 0; l < lane_count; ++l) {
    Numbers F(size(m * (order + 1))), F_x(size(m * n));
    ASSERT_TRUE(single.gradients(jets.t.lane[l], jets.jet(l).data(), {order, -1, 0}, F.data(), nullptr, F_x.data()))
        << single.failure().message;
    for (int i = 0; i < m; ++i) {
      for (int k = 0; k <= order; ++k)
        EXPECT_EQ(lanes.value(i)[k].lane[l], F[size(i + k * m)]) << i << ", order " << k;
      for (std::size_t e = tape.first_target[size(i)]; e < tape.first_target[size(i + 1)]; ++e)
        EXPECT_EQ(lanes.gradients()[e].lane[l], F_x[size(i + tape.targets[e].unknown * m)]);
    }
  }
}

// Coefficients of gradients, the last equation without those of the highest order.
void expect_equal_entries(const TaylorEvaluator& source, LaneEvaluator& lanes, const Jets& jets, int order) {
  const Tape& tape = source.tape();
  TaylorEvaluator single = source;
  std::vector<int> limits(size(source.record().m()), order);
  limits.back() = std::max(order - 1, 0);
  ASSERT_TRUE(lanes.evaluate_entries(source, jets.points(), order, limits));
  for (int l = 0; l < lane_count; ++l) {
    Numbers entries(tape.targets.size() * size(order + 1));
    ASSERT_TRUE(single.entries(jets.t.lane[l], jets.jet(l).data(), order, limits, entries.data()))
        << single.failure().message;
    for (std::size_t i = 0; i < limits.size(); ++i)
      for (std::size_t e = tape.first_target[i]; e < tape.first_target[i + 1]; ++e)
        for (int k = 0; k <= limits[i]; ++k) {
          const std::size_t place = e * size(order + 1) + size(k);
          EXPECT_EQ(lanes.gradients()[place].lane[l], entries[place]) << "equation " << i << ", coefficient " << k;
        }
  }
}

class EveryOperationInLanes : public testing::TestWithParam<Operator> {};

// Near x = (0.7, 0.45), where all of them are smooth; three points, and their repetition.
TEST_P(EveryOperationInLanes, IsThatOfEachPoint) {
  Recording recording(2);
  const TaylorEvaluator source(recording.finish(
      {GetParam().apply(recording.x[0], recording.x[1], recording),
       recording.x[1] * GetParam().apply(recording.x[0] + 0.1 * recording.x[1], recording.x[1], recording)}));
  for_each_instruction_set([&](InstructionSet) {
    LaneEvaluator lanes;
    for (int points : {1, 3, 8})
      for (int order = 0; order < orders; ++order) {
        const Jets jets({0.7, 0.45}, points, static_cast<std::uint64_t>(points));
        expect_equal(source, lanes, jets, order);
        expect_equal_entries(source, lanes, jets, order);
      }
  });
}

INSTANTIATE_TEST_SUITE_P(Operators, EveryOperationInLanes, testing::ValuesIn(operators()),
                         [](const auto& instance) { return instance.param.name; });

TEST(LaneEvaluator, TakesDerivativesOfUnknowns) {
  Recording recording(2);
  const auto& [x, xdot] = std::tie(recording.x, recording.xdot);
  const TaylorEvaluator source(
      recording.finish({xdot[0] * x[1] + sin(xdot[1] * recording.t), x[0] * xdot[0] / (3.0 + xdot[1] * xdot[1])}));
  for_each_instruction_set([&](InstructionSet) {
    LaneEvaluator lanes;
    for (int order = 0; order < orders; ++order) {
      const Jets jets({0.7, 0.45}, 5, 2);
      TaylorEvaluator single = source;
      ASSERT_TRUE(lanes.evaluate(source, jets.points(), order, false));
      for (int l = 0; l < lane_count; ++l) {
        Numbers F(size(2 * (order + 1)));
        ASSERT_TRUE(single.values(jets.t.lane[l], jets.jet(l).data(), order, F.data()));
        for (int i = 0; i < 2; ++i)
          for (int k = 0; k <= order; ++k) EXPECT_EQ(lanes.value(i)[k].lane[l], F[size(i + 2 * k)]) << order;
      }
      expect_equal_entries(source, lanes, jets, order);
    }
  });
}

// A product of factors that vanish in some points has the derivative there that it has.
TEST(LaneEvaluator, HasBranchesOfEachPoint) {
  Recording recording(2);
  const auto& x = recording.x;
  const TaylorEvaluator source(recording.finish({choose(x[0], sqrt(x[0]) * x[1], x[1] * x[1]), abs(x[0])}));
  Jets jets({1.0, 2.0}, lane_count, 3);
  for (int l = 0; l < lane_count; l += 2) jets.blocks[0].lane[l] *= -1.0;
  for_each_instruction_set([&](InstructionSet) {
    LaneEvaluator lanes;
    expect_equal(source, lanes, jets, 0);
    for (int order = 0; order < orders; ++order) expect_equal_entries(source, lanes, jets, order);
  });
}

TEST(LaneEvaluator, NoticesNewParametersAndTimes) {
  Recording recording(1);
  const Term p = recording.parameter("p", 2.0);
  TaylorEvaluator source(recording.finish({sin(p * p) * recording.x[0] + exp(p * recording.t)}));
  LaneEvaluator lanes;
  Jets jets({1.5}, 5, 7);
  for (int order : {2, 0, 1}) {
    expect_equal(source, lanes, jets, order);
    source.set_parameter(0, 1.0 + 0.25 * order);
    expect_equal(source, lanes, jets, order);
    jets.t.lane[lane_count - 1] += 0.5;
    expect_equal(source, lanes, jets, order);
  }
}

// Any point at which something is not finite, whatever it is; without a floating-point exception.
TEST(LaneEvaluator, RefusesPointsWhereSomethingIsNotFinite) {
  Recording recording(2);
  const auto& x = recording.x;
  const TaylorEvaluator source(recording.finish({log(x[0]) / x[1] + sqrt(x[0]), x[0] * exp(x[1])}));
  const Numbers bad[] = {{-1.0, 1.0},
                         {1.0, 0.0},
                         {0.0, 1.0},
                         {1.0, 1e6},
                         {std::numeric_limits<double>::infinity(), 1.0},
                         {1.0, std::numeric_limits<double>::quiet_NaN()}};
  for_each_instruction_set([&](InstructionSet) {
    LaneEvaluator lanes;
    for (const Numbers& point : bad)
      for (int l = 0; l < lane_count; ++l) {
        Jets jets({0.5, 0.25}, lane_count, 1);
        EXPECT_TRUE(lanes.evaluate(source, jets.points(), 1, true));
        for (std::size_t j = 0; j < 2; ++j) jets.blocks[j].lane[l] = point[j];
        EXPECT_FALSE(lanes.evaluate(source, jets.points(), 1, true))
            << point[0] << ", " << point[1] << ", lane " << l;
      }
    Jets late({0.5, 0.25}, lane_count, 1);
    late.t.lane[3] = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(lanes.evaluate(source, late.points(), 0, false));
    late.t.lane[3] = 0.0;
    EXPECT_TRUE(lanes.evaluate(source, late.points(), 0, false));
  });
}

// The derivative of sqrt at 0 does not exist, while its value does.
TEST(LaneEvaluator, RefusesGradientsThatDoNotExist) {
  Recording recording(1);
  const TaylorEvaluator source(recording.finish({sqrt(recording.x[0])}));
  Jets jets({1.0}, lane_count, 1);
  jets.blocks[0].lane[5] = 0.0;
  LaneEvaluator lanes;
  EXPECT_TRUE(lanes.evaluate(source, jets.points(), 0, false));
  EXPECT_FALSE(lanes.evaluate(source, jets.points(), 0, true));
}

}  // namespace

}  // namespace sfdae::core
