// SPDX-License-Identifier: BSD-3-Clause
#include "expression/switch_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <random>
#include <vector>

#include "expression/recorder.h"

namespace sfdae::core {

namespace {

std::vector<Condition> conditions_of(const std::vector<int>& nodes) {
  std::vector<Condition> conditions;
  for (const int node : nodes) conditions.push_back({node, 0});
  return conditions;
}

using Vector = std::vector<double>;

// Points of a polynomial for each unknown: powers of t.
struct Curve {
  std::vector<Vector> coefficients;
  Vector at(double t) const {
    Vector x;
    for (const Vector& each : coefficients) {
      double value = 0.0;
      for (std::size_t k = each.size(); k-- > 0;) value = value * t + each[k];
      x.push_back(value);
    }
    return x;
  }
};

struct Way {
  Way(const Curve& curve, const Vector& times) {
    for (const double t : times) values.push_back(curve.at(t));
    for (std::size_t i = 0; i < times.size(); ++i) points.add(times[i], values[i].data());
  }
  std::vector<Vector> values;
  PointsOfCurve points;
};

// g = x0 - p, and g = sin(x0) + x0 x1 t - p.
class Search {
 public:
  Search() {
    Recorder recorder(2);
    const int x0 = recorder.unknown(0), x1 = recorder.unknown(1), p = recorder.parameter("p", 0.0);
    const int sum = recorder.apply(
        Operation::add, recorder.apply(Operation::sin, x0),
        recorder.apply(Operation::multiply, recorder.apply(Operation::multiply, x0, x1), recorder.time()));
    nodes_ = {recorder.apply(Operation::subtract, x0, p), recorder.apply(Operation::subtract, sum, p)};
    evaluator_ = std::make_unique<TaylorEvaluator>(recorder.finish(nodes_));
    search_ = std::make_unique<SwitchSearch>(*evaluator_, conditions_of(nodes_));
  }
  void set_p(double p) { evaluator_->set_parameter(0, p); }
  Vector find(const PointsOfCurve& points, double margin = 0.0) {
    const Vector margins(2, margin);
    const Vector times = search_->find(points, margins.data());
    EXPECT_EQ(search_->known_to(), points.t[1]);
    return times;
  }
  Vector conditions(const Curve& curve, double t) {
    const Vector x = curve.at(t);
    const Vector jet = {x[0], x[1], 0.0, 0.0};
    Vector g(2);
    EXPECT_TRUE(evaluator_->values(t, jet.data(), 0, g.data()));
    return g;
  }

 private:
  std::vector<int> nodes_;
  std::unique_ptr<TaylorEvaluator> evaluator_;
  std::unique_ptr<SwitchSearch> search_;
};

TEST(SwitchSearch, FindsPulsesHoweverShort) {
  for (const double width : {0.2, 1e-3, 1e-6}) {
    // x0 is positive for a time of 2 width.
    const Curve curve{{{width * width - 3.3 * 3.3, 6.6, -1.0}, {0.0}}};
    const Way way(curve, {3.0, 4.0, 2.5});
    Search search;
    const Vector times = search.find(way.points);
    ASSERT_EQ(times.size(), 1u) << width;
    EXPECT_LT(std::fabs(times[0] - 3.3), width);
  }
}

TEST(SwitchSearch, SeesNothingWithoutSecondSwitch) {
  Search search;
  search.set_p(0.9);
  const Way rises({{{0.0, 1.0}, {0.0}}}, {0.0, 1.0});
  EXPECT_TRUE(search.find(rises.points).empty());
  const Way rests({{{0.9}, {0.0}}}, {0.0, 1.0, -1.0});
  EXPECT_TRUE(search.find(rests.points).empty());
}

// x0 is next to the value of the condition and touches it.
TEST(SwitchSearch, LetsPassWhatStaysWithinTheMargin) {
  Search search;
  const Way way({{{-1e-9, 4e-8, -4e-8}, {0.0}}}, {0.0, 1.0, 0.5});
  EXPECT_FALSE(search.find(way.points).empty());
  EXPECT_TRUE(search.find(way.points, 1e-6).empty());
}

// Between many switches.
TEST(SwitchSearch, KnowsHowFarItKnows) {
  Recorder recorder(1);
  const int g = recorder.apply(Operation::sin,
                               recorder.apply(Operation::multiply, recorder.constant(1e6), recorder.unknown(0)));
  const TaylorEvaluator evaluator(recorder.finish({g}));
  SwitchSearch search(evaluator, conditions_of({g}));
  const Vector start = {0.1}, end = {1.0};
  PointsOfCurve points;
  points.add(0.1, start.data());
  points.add(1.0, end.data());
  EXPECT_FALSE(search.find(points, nullptr).empty());
  EXPECT_GT(search.known_to(), 0.1);
  EXPECT_LT(search.known_to(), 0.2);
}

// On the straight line between two points of a circle g is far below 0, and at both points it is 0.1.
TEST(SwitchSearch, OfLayersGoesThroughValuesAtThePoints) {
  Recorder recorder(2);
  const int x0 = recorder.unknown(0), x1 = recorder.unknown(1);
  const auto square = [&](int x) { return recorder.apply(Operation::multiply, x, x); };
  const int g = recorder.apply(Operation::subtract, recorder.apply(Operation::add, square(x0), square(x1)),
                               recorder.constant(0.9));
  const TaylorEvaluator evaluator(recorder.finish({g}));
  const Vector start = {1.0, 0.0}, end = {0.0, 1.0};
  PointsOfCurve points;
  points.add(0.0, start.data());
  points.add(1.0, end.data());
  for (const bool is_of_layer : {false, true}) {
    SwitchSearch search(evaluator, {Condition{g, 0, is_of_layer}});
    EXPECT_EQ(search.find(points, nullptr).size(), is_of_layer ? 0U : 1U);
    const double at_ends = 0.1;
    EXPECT_EQ(search.find_simple(points, &at_ends, &at_ends), is_of_layer);
  }
}

// Values at both ends and divided differences, where they suffice, lead to the same times as intervals do.
TEST(SwitchSearch, OfLinearConditionsAgreesWithIntervals) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  Recorder recorder(2);
  const int x0 = recorder.unknown(0), x1 = recorder.unknown(1), p = recorder.parameter("p", 0.0);
  const std::vector<int> nodes = {
      recorder.apply(Operation::subtract, x0, p),
      recorder.apply(Operation::add, x0, recorder.apply(Operation::negate, x1)),
      recorder.apply(Operation::subtract, recorder.apply(Operation::multiply, p, x1), recorder.time())};
  TaylorEvaluator evaluator(recorder.finish(nodes));
  SwitchSearch search(evaluator, conditions_of(nodes));
  int simple = 0, with_times = 0;
  for (int k = 0; k < 400; ++k) {
    const std::size_t degree = 1 + static_cast<std::size_t>(k) % 7;
    Curve curve;
    for (int i = 0; i < 2; ++i) {
      Vector coefficients = {number(random), 2.0 * number(random)};
      for (std::size_t j = 2; j <= degree; ++j) coefficients.push_back(0.3 * number(random));
      curve.coefficients.push_back(coefficients);
    }
    Vector times = {0.3, k % 2 == 0 ? 1.0 : -0.4};
    for (std::size_t i = 2; i <= degree; ++i)
      times.push_back(times[0] - 0.4 * static_cast<double>(i) * (times[1] - times[0]));
    evaluator.set_parameter(0, number(random));
    const Way way(curve, times);
    const auto values = [&](std::size_t point) {
      const Vector& x = way.values[point];
      const Vector jet = {x[0], x[1], 0.0, 0.0};
      Vector g(3);
      EXPECT_TRUE(evaluator.values(times[point], jet.data(), 0, g.data()));
      return g;
    };
    const Vector start = values(0), finish = values(1);
    if (!search.find_simple(way.points, start.data(), finish.data())) continue;
    ++simple;
    const Vector found = search.times_between();
    const Vector expected = search.find(way.points, nullptr);
    ASSERT_EQ(search.known_to(), times[1]);
    ASSERT_EQ(found.size(), expected.size()) << k;
    with_times += found.empty() ? 0 : 1;
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-9) << k;
  }
  EXPECT_GT(simple, 100);
  EXPECT_GT(with_times, 20);
}

// In each part of a curve on which branches stay, between two others, there is a time: 150 random curves, forward and
// backward, and what 3,001 points say of them.
TEST(SwitchSearch, AgreesWithPointsOfRandomCurves) {
  constexpr int samples = 3000;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  Search search;
  std::size_t parts = 0;
  for (int k = 0; k < 150; ++k) {
    const std::size_t degree = 1 + static_cast<std::size_t>(k) % 7;
    Curve curve;
    for (int i = 0; i < 2; ++i) {
      Vector coefficients;
      for (std::size_t j = 0; j <= degree; ++j) coefficients.push_back(4.0 * number(random));
      curve.coefficients.push_back(coefficients);
    }
    Vector times = {k % 2 == 0 ? -0.9 : 0.9, k % 2 == 0 ? 0.9 : -0.9};
    for (std::size_t i = 2; i <= degree; ++i) times.push_back(times[0] - 0.25 * static_cast<double>(i) * times[1]);
    search.set_p(2.0 * number(random));
    const Way way(curve, times);
    const Vector found = search.find(way.points);
    const auto branches = [&](double t) {
      const Vector g = search.conditions(curve, t);
      return 2 * static_cast<int>(g[0] > 0.0) + static_cast<int>(g[1] > 0.0);
    };
    const double length = times[1] - times[0], step = std::fabs(length) / samples;
    std::vector<Vector> expected;  // begin and end of each part
    int last = branches(times[0]);
    double begin = times[0];
    for (int i = 1; i <= samples; ++i) {
      const double t = times[0] + length * i / samples;
      const int now = branches(t);
      if (now == last) continue;
      if (begin != times[0] && std::fabs(t - begin) > 3.0 * step) expected.push_back({begin, t});
      begin = t;
      last = now;
    }
    for (const Vector& part : expected) {
      const double middle = 0.5 * (part[0] + part[1]), half = 0.5 * std::fabs(part[1] - part[0]) + step;
      const bool has_time =
          std::any_of(found.begin(), found.end(), [&](double t) { return std::fabs(t - middle) <= half; });
      EXPECT_TRUE(has_time) << k << ": " << middle;
    }
    // Parts shorter than the points tell, and switches that only touch, are few.
    EXPECT_LE(found.size(), expected.size() + 2) << k;
    parts += expected.size();
  }
  EXPECT_GT(parts, 100u);
}

}  // namespace

}  // namespace sfdae::core
