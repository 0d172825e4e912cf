// SPDX-License-Identifier: BSD-3-Clause
// Enclosures of what depends on t alone: all operations and a table, against values and differences of values.
#include "expression/time_enclosures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "expression/spline.h"
#include "expression/time_inputs.h"
#include "linalg/quiet_arithmetic.h"
#include "operators.h"
#include "recorded.h"

namespace sfdae::core {

namespace {

using namespace sfdae_test;

// x_0' = x_0 op(0.7 + t / 4, 0.45 - t / 5).
std::unique_ptr<TaylorEvaluator> evaluator_of(const Operator& operation) {
  Recording recording(2);
  const Term a = 0.7 + 0.25 * recording.t, b = 0.45 - 0.2 * recording.t;
  const Term input = operation.apply(a, b, recording);
  return std::make_unique<TaylorEvaluator>(
      recording.finish({recording.xdot[0] - recording.x[0] * input, recording.x[1] * exp(recording.x[0])}));
}

const std::vector<Operator>& operators_and_tables() {
  static const std::vector<Operator> all = [] {
    std::vector<Operator> result = operators();
    for (const int degree : {1, 3, 5}) {
      TableData data{degree, {}, {}};
      for (int k = 0; k <= 12; ++k) {
        data.x.push_back(0.2 * k - 0.5);
        data.y.push_back(std::sin(3.0 * k));
      }
      const std::shared_ptr<const Spline> spline = Spline::through(data);
      result.push_back(
          {"table_" + std::to_string(degree), [spline](auto a, auto, const auto&) { return call(spline, {a}); }});
    }
    return result;
  }();
  return all;
}

double outside(const Interval& interval, double value) {
  return std::fmax(0.0, std::fmax(interval.low - value, value - interval.high));
}

class TimeEnclosure : public testing::TestWithParam<Operator> {};
INSTANTIATE_TEST_SUITE_P(Operations, TimeEnclosure, testing::ValuesIn(operators_and_tables()),
                         [](const auto& operation) { return operation.param.name; });

}  // namespace

// Mean values of u' and of u'' / 2 between three points, where u' is continuous, lie in enclosures, too.
TEST_P(TimeEnclosure, HoldsAllValuesAndSlopes) {
  const QuietArithmetic quiet;  // bounds may be infinite
  const std::unique_ptr<TaylorEvaluator> evaluator = evaluator_of(GetParam());
  TimeInputs inputs({evaluator.get()});
  ASSERT_TRUE(inputs.are_enclosed());
  const std::size_t count = static_cast<std::size_t>(inputs.count());
  std::vector<TimeSeries> series(count);
  std::vector<std::vector<double>> u(3, std::vector<double>(count));
  constexpr int points = 50;
  constexpr double rounding = 1e3 * std::numeric_limits<double>::epsilon();
  for (const double start : {-0.6, 0.0, 0.23})
    for (const double width : {1e-2, 0.1, 0.5, 1.5}) {
      inputs.evaluate(start, u[0].data());
      inputs.enclose({start, start + width}, series.data());
      const double step = width / points;
      for (int k = 0; k + 2 <= points; ++k) {
        for (int j = 0; j < 3; ++j) inputs.evaluate(start + (k + j) * step, u[static_cast<std::size_t>(j)].data());
        for (std::size_t i = 0; i < count; ++i) {
          if (!std::isfinite(u[0][i] + u[1][i] + u[2][i])) continue;
          const double noise = rounding * (1.0 + std::fabs(u[0][i]) + std::fabs(u[2][i]));
          EXPECT_LE(outside(series[i].value, u[1][i]), noise);
          EXPECT_LE(outside(series[i].slope, (u[1][i] - u[0][i]) / step), noise / step);
          EXPECT_LE(outside(series[i].bend, 0.5 * (u[2][i] - 2.0 * u[1][i] + u[0][i]) / (step * step)),
                    noise / (step * step));
        }
      }
    }
}

// On short intervals without a kink they are narrow: no more than a few times what values do there.
TEST_P(TimeEnclosure, IsNarrowOnShortIntervals) {
  const QuietArithmetic quiet;  // bounds may be infinite
  const std::unique_ptr<TaylorEvaluator> evaluator = evaluator_of(GetParam());
  TimeInputs inputs({evaluator.get()});
  std::vector<TimeSeries> series(static_cast<std::size_t>(inputs.count()));
  std::vector<double> u(series.size());
  constexpr double start = 0.2, width = 1e-4;
  inputs.evaluate(start, u.data());
  inputs.enclose({start, start + width}, series.data());
  for (std::size_t i = 0; i < series.size(); ++i) {
    const double size = 1.0 + std::fabs(u[i]);
    EXPECT_LE(series[i].value.high - series[i].value.low, 1e3 * width * size);
    EXPECT_LE(series[i].slope.magnitude(), 1e3 * size);
    EXPECT_LE(series[i].bend.magnitude(), 1e5 * size);
  }
}

// Branches of conditions are decided on intervals on which terms are much larger than their difference: t - sin t is
// t^3 / 6 near 0.
TEST(TimeEnclosuresOfConditions, KnowBranchesWhereTermsCancel) {
  const QuietArithmetic quiet;
  Recording recording(1);
  const Term input = choose(recording.t - sin(recording.t), 2.0 * recording.t, 5.0 + 0.0 * recording.t);
  const TaylorEvaluator evaluator(recording.finish({recording.xdot[0] - recording.x[0] * input}));
  TimeInputs inputs({&evaluator});
  ASSERT_GT(inputs.count(), 0);
  std::vector<TimeSeries> series(static_cast<std::size_t>(inputs.count()));
  for (const double start : {1e-3, 0.01, 0.3}) {
    inputs.enclose({start, 1.2 * start}, series.data());
    for (const TimeSeries& each : series) {
      EXPECT_LE(each.value.high, 2.5 * start) << start;
      EXPECT_NEAR(each.slope.low, 2.0, 1e-12) << start;
    }
    inputs.enclose({-1.2 * start, -start}, series.data());
    for (const TimeSeries& each : series) EXPECT_EQ(each.value.low, 5.0) << start;
  }
}

}  // namespace sfdae::core
