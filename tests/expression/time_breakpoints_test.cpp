// SPDX-License-Identifier: BSD-3-Clause
// Times at which tables of recorded equations have kinks.
#include "expression/time_breakpoints.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "expression/spline.h"
#include "expression/taylor_evaluator.h"
#include "recorded.h"

namespace sfdae::core {

namespace {

using namespace sfdae_test;
using Numbers = std::vector<double>;

std::shared_ptr<const Spline> polygon() { return Spline::through({1, {0.0, 1.0, 1.5, 4.0}, {0.0, 1.0, 0.0, 2.0}}); }

struct Kinks {
  template <class Argument>
  explicit Kinks(Argument argument) : recording(1), evaluator(recording.finish({equation(argument)})) {}
  template <class Argument>
  Term equation(Argument argument) {
    return recording.x[0] - call(polygon(), {argument(recording)});
  }
  // After t, the middles of their gaps, both ends of which are found.
  Numbers all(double t, double end) const {
    TimeBreakpoints breakpoints({&evaluator});
    const double direction = end > t ? 1.0 : -1.0;
    if (const auto around = breakpoints.gap_at(t)) t = direction > 0.0 ? around->end : around->start;
    Numbers found;
    while (const auto next = breakpoints.next(t, end)) {
      if ((next->t - end) * direction > 0.0) break;
      t = next->t;
      const auto gap = breakpoints.gap_at(t);
      if (!gap) {  // values and first derivatives go on
        found.push_back(t);
        continue;
      }
      EXPECT_TRUE(gap->ends_at(t));
      const double other = direction > 0.0 ? gap->end : gap->start;
      EXPECT_EQ(breakpoints.next(t, end).value().t, other);
      found.push_back(0.5 * (t + other));
      t = other;
    }
    return found;
  }
  Recording recording;
  TaylorEvaluator evaluator;
};

void expect_near(const Numbers& found, const Numbers& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i], expected[i], 1e-14 * (1.0 + std::fabs(expected[i])));
}

TEST(TimeBreakpoints, AreThoseOfTables) {
  const Kinks of_t([](Recording& r) { return r.t; });
  expect_near(of_t.all(-1.0, 10.0), {0.0, 1.0, 1.5, 4.0});
  expect_near(of_t.all(10.0, -1.0), {4.0, 1.5, 1.0, 0.0});
  expect_near(of_t.all(1.0, 10.0), {1.5, 4.0});
  expect_near(of_t.all(1.0, -10.0), {0.0});
  Kinks of_line([](Recording& r) { return 3.0 - r.t / r.parameter("p", 2.0); });
  expect_near(of_line.all(-10.0, 10.0), {-2.0, 3.0, 4.0, 6.0});
  of_line.evaluator.set_parameter(0, 1.0);
  expect_near(of_line.all(-10.0, 10.0), {-1.0, 1.5, 2.0, 3.0});
  const Kinks of_period([](Recording& r) { return 0.5 + modulo(r.t, Term(3.0)); });
  expect_near(of_period.all(-3.1, 3.1), {-3.0, -2.5, -2.0, 0.0, 0.5, 1.0, 3.0});
  expect_near(of_period.all(3.1, -3.1), {3.0, 1.0, 0.5, 0.0, -2.0, -2.5, -3.0});
  // t - 1 is at the ends of the table where it is not the argument any more.
  const Kinks held([](Recording& r) { return min(max(r.t - 1.0, Term(0.5)), Term(2.0)); });
  expect_near(held.all(-10.0, 10.0), {1.5, 2.0, 2.5, 3.0});
  expect_near(held.all(10.0, -10.0), {3.0, 2.5, 2.0, 1.5});
  const Kinks of_state([](Recording& r) { return r.x[0] * 0.5; });
  expect_near(of_state.all(-10.0, 10.0), {});
}

TEST(TimeBreakpoints, AreKinksWhereSlopesJump) {
  const auto kinks_of = [](int degree, double t) {
    Recording r(1);
    const TableData data{degree, {0, 1, 2, 3, 4, 5, 6, 7}, {0, 1, 0, 1, 0, 1, 0, 1}};
    const TaylorEvaluator evaluator(r.finish({r.x[0] - call(Spline::through(data), {r.t})}));
    return TimeBreakpoints({&evaluator}).gap_at(t).has_value();
  };
  EXPECT_TRUE(kinks_of(1, 3.0));
  EXPECT_FALSE(kinks_of(1, 3.5));
  EXPECT_FALSE(kinks_of(3, 3.0));
  EXPECT_FALSE(kinks_of(3, 7.0));  // where it ends there is nothing behind a gap
}

// Where distances of knots are a few thousand roundings of their places, and where slopes vanish.
TEST(TimeBreakpoints, AreKinksWhereverTheDataAre) {
  const auto has_kink = [](const TableData& data, std::size_t k) {
    Recording r(1);
    const TaylorEvaluator evaluator(r.finish({r.x[0] - call(Spline::through(data), {r.t})}));
    return TimeBreakpoints({&evaluator}).gap_at(data.x[k]).has_value();
  };
  for (double place : {0.0, 1e4, 1e6, 1.7e9})
    EXPECT_TRUE(has_kink({1, {place, place + 1.0, place + 2.0}, {0.0, 1.0, 0.0}}, 1)) << place;
  EXPECT_FALSE(has_kink({1, {0.0, 1.0, 2.0}, {0.0, 1.0, 2.0}}, 1));
  EXPECT_FALSE(has_kink({3, {-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0}, {0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0}}, 3));
}

// The derivative of order p - 1 is a polygon.
TEST(TimeBreakpoints, AreKinksOfDerivatives) {
  const TableData data{3, {0, 1, 2, 3, 4, 5, 6, 7}, {0, 1, 0, 1, 0, 1, 0, 1}};
  for (std::size_t order : {0u, 1u, 2u, 3u}) {
    Recording r(1);
    const std::vector<int> by(order, 0);
    const TaylorEvaluator evaluator(r.finish({r.x[0] - call(Spline::through(data), {r.t}, by)}));
    EXPECT_EQ(TimeBreakpoints({&evaluator}).gap_at(3.0).has_value(), order >= 2) << order;
  }
}

// Unknowns that depend on the derivative of order p jump with it.
TEST(TimeBreakpoints, AreKinksWhereWhatIsDifferentiatedJumps) {
  Recording r(1);
  const TableData data{3, {0, 1, 2, 3, 4, 5, 6, 7}, {0, 1, 0, 1, 0, 1, 0, 1}};
  const TaylorEvaluator evaluator(r.finish({r.x[0] - call(Spline::through(data), {r.t})}));
  TimeBreakpoints breakpoints({&evaluator});
  for (int count : {0, 1, 2, 3, 4}) {
    breakpoints.set_differentiations(count);
    EXPECT_EQ(breakpoints.gap_at(3.0).has_value(), count >= 3) << count;
  }
}

// What takes a path for every use of a part, or a call for every operation, does not end.
TEST(TimeBreakpoints, OfArgumentsThatShareParts) {
  constexpr int many = 60, very_many = 200000;
  const Kinks doubled([](Recording& r) {
    Term sum = r.t, factor = r.parameter("p", 1.0);
    for (int i = 0; i < many; ++i) sum = 0.5 * (sum + sum), factor = 0.5 * (factor + factor);
    return factor * sum;
  });
  expect_near(doubled.all(-1.0, 10.0), {0.0, 1.0, 1.5, 4.0});
  const Kinks limited([](Recording& r) {
    Term least = r.t;
    for (int i = 0; i < many; ++i) least = min(least, Term(5.0 + i));
    return least;
  });
  expect_near(limited.all(-1.0, 4.5), {0.0, 1.0, 1.5, 4.0});
  const Kinks deep([](Recording& r) {
    Term sum = r.t - 0.5 * very_many;
    for (int i = 0; i < very_many; ++i) sum = sum + 0.5;
    return sum;
  });
  EXPECT_EQ(deep.all(0.5, 10.0).size(), 3u);
}

}  // namespace

}  // namespace sfdae::core
