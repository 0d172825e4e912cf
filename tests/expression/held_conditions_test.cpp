// SPDX-License-Identifier: BSD-3-Clause
#include "expression/held_conditions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "expression/recorder.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// x0' = max(x1 - 1, 0) + where(t > 1, 5, 0), x1' = sign(x0).
std::shared_ptr<const Record> equations() {
  Recorder recorder(2);
  const int x0 = recorder.unknown(0), x1 = recorder.unknown(1), one = recorder.constant(1.0);
  const int step = recorder.apply(Operation::choose, recorder.apply(Operation::subtract, recorder.time(), one),
                                  recorder.constant(5.0), recorder.constant(0.0));
  const int largest = recorder.max(recorder.apply(Operation::subtract, x1, one), recorder.constant(0.0));
  const int first =
      recorder.apply(Operation::subtract, recorder.derivative(0), recorder.apply(Operation::add, largest, step));
  const int second = recorder.apply(Operation::subtract, recorder.derivative(1), recorder.sign(x0));
  return recorder.finish({first, second});
}

class Evaluation {
 public:
  explicit Evaluation(std::shared_ptr<const Record> record) : evaluator(with_conditions(std::move(record))) {
    conditions.emplace(evaluator, [this] { ++changes; });
  }
  // Right-hand sides.
  Vector values(double x0, double x1, double t = 0.0) {
    const Vector jet = {x0, x1, 0.0, 0.0};
    Vector F(2, std::nan(""));
    EXPECT_TRUE(evaluator.values(t, jet.data(), 0, F.data()));
    return {-F[0], -F[1]};
  }
  Vector functions(double x0, double x1) {
    const Vector x = {x0, x1}, xdot = {0.0, 0.0};
    Vector g(conditions->count());
    conditions->functions().evaluate(0.0, x.data(), xdot.data(), g.data());
    return g;
  }

  TaylorEvaluator evaluator;
  std::optional<HeldConditions> conditions;
  int changes = 0;
};

TEST(HeldConditions, AreThoseOnUnknowns) {
  Evaluation of(equations());
  // That of max, and both of sign; the one on t can be known beforehand.
  EXPECT_EQ(of.conditions->count(), 3u);
  EXPECT_FALSE(of.conditions->functions().depend_on_derivatives());
  EXPECT_EQ(of.evaluator.record().num_user_parameters(), 0);
  EXPECT_FALSE(of.evaluator.find_parameter("branch 1"));
}

TEST(HeldConditions, OfEquationsWithoutAnyLeaveThemAsTheyAre) {
  Recorder recorder(1);
  const int when = recorder.greater(recorder.time(), recorder.constant(1.0));
  const auto record = recorder.finish({recorder.apply(Operation::subtract, recorder.derivative(0), when)});
  EXPECT_EQ(with_conditions(record), record);
}

TEST(HeldConditions, DecideAsTheirValuesSayUnlessTheyAreHeld) {
  Evaluation of(equations());
  EXPECT_EQ(of.values(2.0, 3.0), (Vector{2.0, 1.0}));
  EXPECT_EQ(of.values(-2.0, 0.5), (Vector{0.0, -1.0}));
  EXPECT_EQ(of.values(0.0, 0.5), (Vector{0.0, 0.0}));
  of.conditions->hold(of.functions(2.0, 3.0).data());
  EXPECT_EQ(of.values(-2.0, 0.5), (Vector{-0.5, 1.0}));
  EXPECT_EQ(of.values(-2.0, 0.5, 1.5), (Vector{4.5, 1.0}));
  of.conditions->hold(of.functions(-2.0, 0.5).data());
  EXPECT_EQ(of.values(2.0, 3.0), (Vector{0.0, -1.0}));
  of.conditions->release();
  EXPECT_EQ(of.values(2.0, 3.0), (Vector{2.0, 1.0}));
  EXPECT_EQ(of.changes, 3);
}

TEST(HeldConditions, KnowByHowMuchTheirValuesMayChange) {
  Evaluation of(equations());
  const Vector x = {1.0, 2.0}, xdot = {0.0, 0.0}, changes = {0.1, 0.01};
  Vector resolution = of.conditions->functions().resolution(0.0, x.data(), xdot.data(), changes.data());
  std::sort(resolution.begin(), resolution.end());
  EXPECT_DOUBLE_EQ(resolution[0], 0.01);
  EXPECT_DOUBLE_EQ(resolution[1], 0.1);
  EXPECT_DOUBLE_EQ(resolution[2], 0.1);
}

// Of max(x1 - 1, 0) at x1 = 1 along x' = (1, 4): with dx/dp = (0, 2) its time moves by -1/2.
TEST(HeldConditions, KnowHowTheirTimesMove) {
  Evaluation of(equations());
  const Vector x = {3.0, 1.0}, xdot = {1.0, 4.0}, S = {0.0, 2.0, 1.0, 0.0};
  const auto shifts =
      of.conditions->functions().shifts({0}, {0.0, x.data(), xdot.data()}, {S.data(), 2, 2, 2}, {-1, -1});
  ASSERT_TRUE(shifts);
  EXPECT_EQ(*shifts, (Vector{-0.5, 0.0}));
  // The sign's condition has another time.
  EXPECT_FALSE(
      of.conditions->functions().shifts({0, 1}, {0.0, x.data(), xdot.data()}, {S.data(), 2, 2, 2}, {-1, -1}));
}

TEST(HeldConditions, KnowKinksFromJumps) {
  Evaluation of(equations());
  const Vector before = {-1.0, 0.9}, after = {1.0, 1.2}, xdot = {0.0, 0.0};
  const Vector g = of.functions(-1.0, 0.9);
  const HeldConditions::Point from{0.0, before.data(), xdot.data()}, to{0.0, after.data(), xdot.data()};
  EXPECT_EQ(of.conditions->passing(0, g.data(), from, to), HeldConditions::Passing::kink);
  EXPECT_EQ(of.conditions->passing(1, g.data(), from, to), HeldConditions::Passing::jump);
}

// g is exactly 0 where the line begins: the other branch is the one that is met.
TEST(HeldConditions, KnowKinksFromJumpsThatBeginAtZero) {
  Evaluation of(equations());
  const Vector before = {0.0, 1.0}, after = {1.0, 1.2}, xdot = {0.0, 0.0};
  const Vector g = of.functions(0.0, 1.0);
  const HeldConditions::Point from{0.0, before.data(), xdot.data()}, to{0.0, after.data(), xdot.data()};
  EXPECT_EQ(of.conditions->passing(0, g.data(), from, to), HeldConditions::Passing::kink);
  EXPECT_EQ(of.conditions->passing(1, g.data(), from, to), HeldConditions::Passing::jump);
}

// t % p > 0.3: the condition switches at 0.3 and, since the remainder jumps, at p, where only the latter moves.
TEST(HeldConditions, KnowWhatSwitchesBecauseOfTimeAndParameters) {
  Recorder recorder(1);
  const int p = recorder.parameter("p", 0.7);
  const int rest = recorder.apply(Operation::modulo, recorder.time(), p);
  const int when = recorder.greater(rest, recorder.constant(0.3));
  const int fixed = recorder.greater(recorder.time(), recorder.constant(0.5));
  const int rate = recorder.apply(Operation::add, when, fixed);
  Evaluation of(recorder.finish({recorder.apply(Operation::subtract, recorder.derivative(0), rate)}));
  constexpr double roundings = 1e-14;
  const auto at = [&](double t) { return of.conditions->timed_switches(t - roundings, t + roundings); };
  ASSERT_EQ(at(0.3).size(), 1u);
  ASSERT_EQ(at(0.7).size(), 1u);
  EXPECT_TRUE(at(0.5).empty());
  EXPECT_NE(at(0.3), at(0.7));
  const Vector nothing = {0.0};
  const auto shift = [&](double t) {
    const auto found = of.conditions->timed_functions().shifts(at(t), {t - roundings, nothing.data(), nothing.data()},
                                                               {nothing.data(), 1, 1, 1}, {0});
    return found ? (*found)[0] : std::nan("");
  };
  EXPECT_NEAR(shift(0.3), 0.0, 1e-12);
  EXPECT_NEAR(shift(0.7), 1.0, 1e-12);
  EXPECT_TRUE(of.conditions->jumps_between(0.3 - roundings, 0.3 + roundings, 0.2, nothing.data()));
  EXPECT_FALSE(of.conditions->jumps_between(0.4 - roundings, 0.4 + roundings, 0.2, nothing.data()));
}

// A condition that cannot be evaluated is not met, and the others are known.
TEST(HeldConditions, ThatFailAreNotNumbers) {
  Recorder recorder(2);
  const int root = recorder.apply(Operation::sqrt, recorder.unknown(0));
  const int first = recorder.apply(Operation::choose, root, recorder.constant(1.0), recorder.constant(2.0));
  const int second = recorder.max(recorder.unknown(1), recorder.constant(0.0));
  Evaluation of(recorder.finish({recorder.apply(Operation::subtract, recorder.derivative(0), first),
                                 recorder.apply(Operation::subtract, recorder.derivative(1), second)}));
  const Vector g = of.functions(-1.0, 3.0);
  EXPECT_TRUE(std::isnan(g[0]));
  EXPECT_EQ(g[1], 3.0);
}

// Names of parameters that the user has chosen are his.
TEST(HeldConditions, HaveNamesOfTheirOwn) {
  Recorder recorder(1);
  const int his = recorder.parameter("branch 1", 7.0);
  const int largest = recorder.max(recorder.unknown(0), his);
  Evaluation of(recorder.finish({recorder.apply(Operation::subtract, recorder.derivative(0), largest)}));
  EXPECT_EQ(of.conditions->count(), 1u);
  EXPECT_EQ(of.evaluator.find_parameter("branch 1"), std::optional<int>(0));
  EXPECT_EQ(of.evaluator.num_parameters(), 2);
  EXPECT_NE(of.conditions->equation_with(0), "the equations");
}

}  // namespace

}  // namespace sfdae::core
