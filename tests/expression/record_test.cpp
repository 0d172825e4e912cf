// SPDX-License-Identifier: BSD-3-Clause
// Recording: sharing, trivial algebra, sparsity, linearity.
#include "expression/record.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "recorded.h"

namespace sfdae::core {

namespace {

using namespace sfdae_test;

// x, x', t of one or two unknowns.
class Recorded : public testing::Test {
 protected:
  Recorded() : recording(2) {}
  const Term& x(std::size_t j) const { return recording.x[j]; }
  const Term& xdot(std::size_t j) const { return recording.xdot[j]; }
  int nodes() const { return recording.recorder.num_nodes(); }
  Recording recording;
};

void expect_same(const Term& a, const Term& b) { EXPECT_EQ(a.node, b.node); }

void expect_number(const Term& a, double value) { EXPECT_EQ(a.node, a.recorder->constant(value)); }

}  // namespace

TEST_F(Recorded, EqualExpressionsAreOneNode) {
  const Term first = sin(x(0) * x(1)) + xdot(0);
  const int before = nodes();
  expect_same(xdot(0) + sin(x(1) * x(0)), first);
  EXPECT_EQ(nodes(), before);
}

// The table of nodes grows many times on the way.
TEST_F(Recorded, ManyExpressionsAreFoundAgain) {
  std::vector<int> first, again;
  for (auto* found : {&first, &again})
    for (int k = 1; k <= 3000; ++k) found->push_back((sin(x(0) * (1.0 / k)) + x(1) * (k + 0.5)).node);
  EXPECT_EQ(first, again);
  std::sort(first.begin(), first.end());
  EXPECT_EQ(std::adjacent_find(first.begin(), first.end()), first.end());
}

TEST_F(Recorded, DifferencesAndQuotientsAreNotCommuted) {
  EXPECT_NE((x(0) / x(1)).node, (x(1) / x(0)).node);
  EXPECT_NE((x(0) - x(1)).node, (x(1) - x(0)).node);
  EXPECT_NE(atan2(x(0), x(1)).node, atan2(x(1), x(0)).node);
}

TEST_F(Recorded, NumbersAreFolded) {
  const Term zero = x(0) - x(0), two = zero + 2.0;
  expect_number(zero, 0.0);
  expect_number(sqrt(two * 8.0), 4.0);
  expect_number(pow(two, 10.0), 1024.0);
  expect_number(cos(zero), 1.0);
  expect_number(cosh(zero), 1.0);
  expect_number(max(two, -3.0), 2.0);
  expect_number(min(two, -3.0), -3.0);
  expect_number(abs(zero - 3.0), 3.0);
  expect_same(choose(two, x(0), x(1)), x(0));
  expect_same(choose(zero, x(0), x(1)), x(1));
}

TEST_F(Recorded, UndefinedNumbersAreKeptForTheEvaluationToName) {
  const Term minus_one = (x(0) - x(0)) - 1.0;
  const auto record = recording.finish({log(minus_one)});
  EXPECT_EQ(record->node(record->residual(0)).operation, Operation::log);
}

TEST_F(Recorded, TrivialAlgebraIsDone) {
  const Term a = x(0), b = x(1);
  expect_same(a + 0.0, a);
  expect_same(0.0 + a, a);
  expect_same(a - 0.0, a);
  expect_same(0.0 - a, -a);
  expect_same(-(-a), a);
  expect_same(a * 1.0, a);
  expect_number(0.0 * a, 0.0);
  expect_same(a / 1.0, a);
  expect_same(-1.0 * a, -a);
  expect_same(pow(a, 1.0), a);
  expect_number(pow(a, 0.0), 1.0);
  expect_same(pow(a, 2.0), a * a);
  expect_same(pow(a, 3.0), a * a * a);
  expect_same(pow(a, -1.0), 1.0 / a);
  expect_same(pow(a, 0.5), sqrt(a));
  expect_same(a + -b, a - b);
  expect_same(a - -b, a + b);
  expect_same(-(a - b), b - a);
  expect_same(-a * b, -(a * b));
  expect_same(-a * -b, a * b);
  expect_same(-(2.0 * a), -2.0 * a);
  expect_same(a / 4.0, 0.25 * a);
}

TEST_F(Recorded, EntriesAreTheSparsity) {
  const auto record = recording.finish({xdot(0) * recording.t - x(1) * x(1), x(0) + 3.0 * x(1), recording.t});
  const auto find = [&](int equation, int unknown, bool derivative) -> const Entry* {
    for (const Entry& entry : record->entries(equation))
      if (entry.unknown == unknown && entry.derivative == derivative) return &entry;
    return nullptr;
  };
  ASSERT_EQ(record->entries(0).size(), 2u);
  EXPECT_EQ(find(0, 0, true)->dependence, on_time);
  EXPECT_EQ(find(0, 1, false)->dependence, on_unknowns);
  ASSERT_EQ(record->entries(1).size(), 2u);
  EXPECT_TRUE(find(1, 0, false)->is_constant());
  EXPECT_TRUE(find(1, 1, false)->is_constant());
  EXPECT_TRUE(record->entries(2).empty());
}

TEST_F(Recorded, LinearEquationsAreKnownAsSuch) {
  const Term t = recording.t, p = recording.parameter("p", 2.0);
  struct Case {
    Term F;
    bool linear, constant_E, constant_A;
  };
  const std::vector<Case> cases = {
      {xdot(0) - 2.0 * x(0) + sin(t), true, true, true},
      {p * xdot(0) - x(0) / p + t, true, true, true},
      {t * xdot(0) - x(0), true, false, true},
      {xdot(0) - exp(t) * (x(0) - 3.0 * x(1)), true, true, false},
      {(xdot(0) + x(1)) / (1.0 + t * t), true, false, false},
      {xdot(0) - choose(t - 1.0, x(0), 2.0 * x(0)), true, true, false},
      {xdot(0) * x(0), false, false, false},
      {xdot(0) - abs(x(0)), false, false, false},
      {xdot(0) - 1.0 / x(0), false, false, false},
      {xdot(0) - sin(x(0)), false, false, false},
      {xdot(0) - max(x(0), x(1)), false, false, false},
      {xdot(0) - choose(x(0), x(0), x(1)), false, false, false},
      {xdot(0) - choose(x(0), 1.0, 2.0), false, false, false},
      {xdot(0) - x(1) * choose(t, 1.0, 2.0), true, true, false},
  };
  std::vector<int> residuals;
  for (const Case& c : cases) residuals.push_back(c.F.node);
  Recorder copy = recording.recorder;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    Recorder recorder = copy;
    const auto record = recorder.finish({residuals[i]});
    EXPECT_EQ(record->is_linear(), cases[i].linear) << i;
    EXPECT_EQ(record->is_constant_E(), cases[i].constant_E) << i;
    EXPECT_EQ(record->is_constant_A(), cases[i].constant_A) << i;
  }
}

TEST_F(Recorded, WhatNoEquationUsesIsNotEvaluated) {
  const Term unused = log(x(0) - 10.0);
  EXPECT_GE(unused.node, 0);
  TaylorEvaluator evaluator(recording.finish({x(0) + x(1), xdot(0)}));
  const double jet[] = {1.0, 2.0, 3.0, 4.0};
  double F[2];
  ASSERT_TRUE(evaluator.values(0.0, jet, 0, F));
  EXPECT_EQ(F[0], 3.0);
  EXPECT_EQ(F[1], 3.0);
}

TEST_F(Recorded, ParametersChangeWithoutRecordingAnew) {
  const Term p = recording.parameter("p", 2.0), q = recording.parameter("q", 0.0);
  expect_same(recording.parameter("p", 7.0), p);
  const auto record = recording.finish({p * p * x(0) + sin(q * recording.t), pow(x(1), p)});
  TaylorEvaluator evaluator(record), other(record);
  ASSERT_EQ(evaluator.num_parameters(), 2);
  EXPECT_EQ(evaluator.find_parameter("q"), 1);
  EXPECT_EQ(evaluator.find_parameter("r"), std::nullopt);
  const double jet[] = {1.0, -2.0, 0.0, 0.0, 0.0, 0.0};
  double F[4];
  ASSERT_TRUE(evaluator.values(0.5, jet, 1, F));
  EXPECT_EQ(F[0], 4.0);
  EXPECT_EQ(F[1], 4.0);
  EXPECT_EQ(F[2], 0.0);
  evaluator.set_parameter(0, 3.0);
  evaluator.set_parameter(1, 1.0);
  ASSERT_TRUE(evaluator.values(0.5, jet, 1, F));
  EXPECT_EQ(F[0], 9.0 + std::sin(0.5));
  EXPECT_EQ(F[1], -8.0);
  EXPECT_EQ(F[2], std::cos(0.5));
  ASSERT_TRUE(other.values(0.5, jet, 1, F));
  EXPECT_EQ(F[0], 4.0);
}

TEST_F(Recorded, CopiesOfEvaluatorsHaveParametersAndValuesOfTheirOwn) {
  const Term p = recording.parameter("p", 2.0);
  TaylorEvaluator evaluator(recording.finish({p * x(0) * recording.t}));
  const double jet[] = {1.0, 0.0}, other_jet[] = {5.0, 0.0};
  double F = 0.0;
  evaluator.set_parameter(0, 3.0);
  ASSERT_TRUE(evaluator.values(0.5, jet, 0, &F));
  TaylorEvaluator copy(evaluator);
  EXPECT_EQ(&copy.record(), &evaluator.record());
  EXPECT_EQ(copy.parameter(0), 3.0);
  copy.set_parameter(0, 7.0);
  ASSERT_TRUE(copy.values(2.0, other_jet, 0, &F));
  EXPECT_EQ(F, 70.0);
  ASSERT_TRUE(evaluator.values(0.5, jet, 0, &F));
  EXPECT_EQ(F, 1.5);
}

}  // namespace sfdae::core
