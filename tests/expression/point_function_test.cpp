// SPDX-License-Identifier: BSD-3-Clause
// Functions that are known by their partial derivatives, in recorded equations: the series that formulas have.
#include "expression/point_function.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "expression/lane_evaluator.h"
#include "expression/spline.h"
#include "expression/symbolic_gradient.h"
#include "expression/taylor_evaluator.h"
#include "instruction_sets.h"
#include "matrix_checks.h"
#include "recorded.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

namespace {

using namespace sfdae_test;
using Numbers = std::vector<double>;

// exp(a_0) sin(a_1) ... by as many arguments as wanted: exp of a sum of all but the last, times the sine of that.
class ExpSin : public PointFunction {
 public:
  ExpSin(int num_arguments, int highest_order)
      : PointFunction("exp_sin", num_arguments), highest_order_(highest_order) {}
  int derivatives(int order, const double* arguments, double* values) const override {
    if (order > highest_order_) return SFDAE_ORDER_NOT_AVAILABLE;
    const int k = num_arguments();
    double sum = 0.0;
    for (int i = 0; i + 1 < k; ++i) sum += arguments[i];
    const double last = arguments[k - 1];
    const std::array<double, 4> turned = {std::sin(last), std::cos(last), -std::sin(last), -std::cos(last)};
    int count = 1;
    for (int i = 0; i < order; ++i) count *= k;
    for (int place = 0; place < count; ++place) {
      int by_last = 0;
      for (int i = 0, rest = place; i < order; ++i, rest /= k) by_last += rest % k == k - 1 ? 1 : 0;
      values[place] = std::exp(sum) * turned[static_cast<std::size_t>(by_last % 4)];
    }
    return 0;
  }

 private:
  int highest_order_;
};

// The function of k terms that the last of them belong to, as a call or as a formula; and a derivative of it.
std::vector<Term> equations(Recording& r, int k, bool as_call) {
  const std::vector<Term> all = {r.x[0] * r.x[1], 0.2 * r.xdot[0], 0.5 * r.t + r.x[0], r.x[1] - 0.1 * r.t * r.x[0]};
  const std::vector<Term> arguments(all.begin(), all.begin() + k);
  Term value;
  if (as_call) {
    value = call(std::make_shared<ExpSin>(k, 14), arguments);
  } else {
    Term sum(&r.recorder, r.recorder.constant(0.0));
    for (int i = 0; i + 1 < k; ++i) sum = sum + arguments[static_cast<std::size_t>(i)];
    value = exp(sum) * sin(arguments.back());
  }
  const std::vector<int> slopes = symbolic_gradient(r.recorder, value.node, 2);
  return {value * r.x[1], Term(&r.recorder, slopes[0]) + Term(&r.recorder, slopes[1])};
}

TEST(PointFunction, HasTheSeriesAndGradientsOfTheFormula) {
  constexpr int n = 2, m = 2;
  for (int k = 1; k <= 4; ++k)
    for (int order : {0, 1, 2, 3, 4}) {
      Recording as_call(n), as_formula(n);
      TaylorEvaluator found(as_call.finish(equations(as_call, k, true)));
      TaylorEvaluator expected(as_formula.finish(equations(as_formula, k, false)));
      const Matrix random = random_matrix(n, order + 2, static_cast<std::uint64_t>(k));
      Numbers jet;
      for (int column = 0; column < order + 2; ++column)
        for (int j = 0; j < n; ++j) jet.push_back(random(j, column));
      const std::size_t blocks = size(order + 1);
      Numbers F[2], F_xdot[2], F_x[2];
      int which = 0;
      for (TaylorEvaluator* evaluator : {&found, &expected}) {
        F[which].resize(m * blocks), F_xdot[which].resize(m * n * blocks), F_x[which].resize(m * n * blocks);
        ASSERT_TRUE(evaluator->gradients(0.3, jet.data(), {order, order, order}, F[which].data(),
                                         F_xdot[which].data(), F_x[which].data()))
            << evaluator->failure().message;
        ++which;
      }
      const auto expect_equal = [&](const Numbers& a, const Numbers& b) {
        double largest = 1.0;
        for (double value : b) largest = std::max(largest, std::fabs(value));
        for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-12 * largest) << k << ", " << order;
      };
      expect_equal(F[0], F[1]);
      expect_equal(F_xdot[0], F_xdot[1]);
      expect_equal(F_x[0], F_x[1]);
    }
}

// Instructions are sorted: a call has to come after all of its arguments, not only the first.
TEST(PointFunction, WaitsForArgumentsThatTakeLonger) {
  for (const int late : {0, 1, 2}) {
    Recording r(2);
    std::vector<Term> arguments = {0.1 * r.x[0], 0.2 * r.x[0], 0.3 * r.x[0]};
    for (int depth = 0; depth < 5; ++depth)
      arguments[size(late)] = sin(arguments[size(late)]) * r.x[1] + arguments[size(late)];
    const Term by_call = call(std::make_shared<ExpSin>(3, 2), arguments);
    const Term by_formula = exp(arguments[0] + arguments[1]) * sin(arguments[2]);
    TaylorEvaluator evaluator(r.finish({by_call, by_formula}));
    const double jet[] = {0.7, -0.4, 0.3, 0.2, 0.0, 0.0};
    double F[4];
    // Nothing is there from an evaluation before.
    ASSERT_TRUE(evaluator.values(0.0, jet, 1, F));
    for (int k : {0, 1}) EXPECT_NEAR(F[2 * k], F[2 * k + 1], 1e-14) << late << ", " << k;
  }
}

// As the points one by one, to the last bit.
TEST(PointFunction, IsTheSameInLanes) {
  Recording r(2);
  const std::vector<Term> arguments = {r.x[0] * r.t, r.x[1], r.x[0] - 2.0 * r.x[1]};
  const TaylorEvaluator source(r.finish({call(std::make_shared<ExpSin>(3, 14), arguments) * r.x[0],
                                         call(std::make_shared<ExpSin>(1, 14), {r.x[1]}) + r.x[0]}));
  const Matrix random = random_matrix(6, lane_count, 5);
  LaneBlock t;
  LaneArray blocks(6);
  for (int l = 0; l < lane_count; ++l) {
    t.lane[l] = 0.1 * l;
    for (int j = 0; j < 6; ++j) blocks[size(j)].lane[l] = random(j, l);
  }
  for_each_instruction_set([&](InstructionSet) {
    for (int order : {0, 1, 2}) {
      LaneEvaluator lanes;
      TaylorEvaluator single = source;
      ASSERT_TRUE(lanes.evaluate(source, {&t, {blocks.data(), blocks.data() + 2, blocks.data() + 4}}, order, true));
      for (int l = 0; l < lane_count; ++l) {
        Numbers jet, F(size(2 * (order + 1))), F_x(4);
        for (const LaneBlock& block : blocks) jet.push_back(block.lane[l]);
        jet.resize(8, 0.0);
        ASSERT_TRUE(single.gradients(t.lane[l], jet.data(), {order, -1, 0}, F.data(), nullptr, F_x.data()));
        for (int i = 0; i < 2; ++i) {
          for (int k = 0; k <= order; ++k) EXPECT_EQ(lanes.value(i)[k].lane[l], F[size(i + 2 * k)]);
          const Tape& tape = source.tape();
          for (std::size_t e = tape.first_target[size(i)]; e < tape.first_target[size(i + 1)]; ++e)
            EXPECT_EQ(lanes.gradients()[e].lane[l], F_x[size(i + tape.targets[e].unknown * 2)]);
        }
      }
    }
  });
}

// Lower orders are there, what is missing is named.
TEST(PointFunction, MayLackHighOrders) {
  Recording r(1);
  TaylorEvaluator evaluator(r.finish({call(std::make_shared<ExpSin>(1, 2), {r.x[0]})}));
  const Numbers jet(8, 0.5);
  double F[5], F_x[5];
  EXPECT_TRUE(evaluator.values(0.0, jet.data(), 2, F));
  EXPECT_TRUE(evaluator.gradients(0.0, jet.data(), {2, -1, 1}, F, nullptr, F_x));
  EXPECT_FALSE(evaluator.values(0.0, jet.data(), 3, F));
  EXPECT_EQ(evaluator.failure().message, "exp_sin has no derivatives of order 3 in equation 0");
  EXPECT_EQ(evaluator.failure().code, SFDAE_ORDER_NOT_AVAILABLE);
  EXPECT_EQ(status_of(evaluator.failure()), SFDAE_ORDER_MISSING);
  EXPECT_FALSE(evaluator.gradients(0.0, jet.data(), {2, -1, 2}, F, nullptr, F_x));
  EXPECT_EQ(status_of(evaluator.failure()), SFDAE_ORDER_MISSING);
}

// 4^7 derivatives of order 7 are more than there is room for.
TEST(PointFunction, HasNoOrdersWithTooManyDerivatives) {
  Recording r(1);
  TaylorEvaluator evaluator(r.finish({call(std::make_shared<ExpSin>(4, 14), {r.x[0], r.x[0], r.t, r.x[0]})}));
  const Numbers jet(10, 0.5);
  double F[9];
  EXPECT_TRUE(evaluator.values(0.0, jet.data(), 6, F));
  EXPECT_FALSE(evaluator.values(0.0, jet.data(), 7, F));
  EXPECT_EQ(status_of(evaluator.failure()), SFDAE_ORDER_MISSING);
}

TEST(PointFunction, PassesOnWhatIsNotFinite) {
  Recording r(1);
  TaylorEvaluator evaluator(r.finish({call(std::make_shared<ExpSin>(1, 14), {log(r.x[0])})}));
  const Numbers jet = {-1.0, 1.0};
  double F = 0.0;
  EXPECT_FALSE(evaluator.values(0.0, jet.data(), 0, &F));
  EXPECT_EQ(evaluator.failure().message, "log of -1 in equation 0");
}

}  // namespace

}  // namespace sfdae::core
