// SPDX-License-Identifier: BSD-3-Clause
// Values and derivatives that do not exist: refused, with the operation and the equation named.
#include "expression/diagnosis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "recorded.h"

namespace sfdae::core {

namespace {

using namespace sfdae_test;
using Kind = EvaluationFailure::Kind;
using Formula = std::function<Term(const Term&)>;

// Equations x = 0 and f(x) = 0; x(s) = x0 + s.
struct Trial {
  Trial(const Formula& f, double x0)
      : recording(1), evaluator(recording.finish({recording.x[0], f(recording.x[0])})) {
    jet = {x0, 1.0, 0.0, 0.0, 0.0};
  }
  bool values(int order) { return evaluator.values(0.0, jet.data(), order, F); }
  bool gradients(int order) { return evaluator.gradients(0.0, jet.data(), {0, order, order}, F, F_xdot, F_x); }
  const EvaluationFailure& failure() const { return evaluator.failure(); }
  Recording recording;
  TaylorEvaluator evaluator;
  std::vector<double> jet;
  double F[8] = {}, F_xdot[8] = {}, F_x[8] = {};
};

const Formula square_root = [](const Term& x) { return sqrt(x); };

}  // namespace

TEST(Undefined, IsNamedWithTheEquation) {
  struct Case {
    Formula f;
    double x0;
    std::string operation, message;
  };
  const std::vector<Case> cases = {
      {[](const Term& x) { return log(x); }, -1.0, "log", "log of -1 in equation 1"},
      {[](const Term& x) { return log(x); }, 0.0, "log", "log of 0 in equation 1"},
      {[](const Term& x) { return log10(x); }, -1.0, "log10", "log10 of -1 in equation 1"},
      {[](const Term& x) { return modulo(Term(2.0), x - 1.0); }, 1.0, "modulo", "modulo of 2 by 0 in equation 1"},
      {[](const Term& x) { return 2.0 + sqrt(x - 3.0); }, 1.0, "sqrt", "sqrt of -2 in equation 1"},
      {[](const Term& x) { return 1.0 / (x - 1.0); }, 1.0, "division", "division of 1 by 0 in equation 1"},
      {[](const Term& x) { return (x - 1.0) / (x - 1.0); }, 1.0, "division", "division of 0 by 0 in equation 1"},
      {[](const Term& x) { return x / (0.0 * x); }, 1.0, "division", "division of 1 by 0 in equation 1"},
      {[](const Term& x) { return pow(x, 1.5); }, -2.0, "power", "power -2^1.5 in equation 1"},
      {[](const Term& x) { return pow(x, -1.5); }, 0.0, "power", "power 0^-1.5 in equation 1"},
      {[](const Term& x) { return pow(x, x); }, -2.0, "power", "power of -2 with a variable exponent in equation 1"},
      {[](const Term& x) { return asin(x); }, 1.5, "asin", "asin of 1.5 in equation 1"},
      {[](const Term& x) { return acos(x); }, -1.5, "acos", "acos of -1.5 in equation 1"},
      {[](const Term& x) { return x * log(0.0 * x - 1.0); }, 1.0, "log", "log of -1 in equation 1"},
  };
  for (const Case& c : cases)
    for (int order : {0, 1, 3}) {
      Trial trial(c.f, c.x0);
      EXPECT_FALSE(trial.values(order)) << c.message;
      EXPECT_EQ(trial.failure().kind, Kind::undefined);
      EXPECT_EQ(trial.failure().equation, 1);
      EXPECT_EQ(trial.failure().operation, c.operation);
      EXPECT_EQ(trial.failure().message, c.message);
      EXPECT_FALSE(trial.gradients(std::min(order, 2))) << c.message;
      EXPECT_EQ(trial.failure().message, c.message);
    }
}

TEST(NotSmooth, ValuesExistWhereDerivativesDoNot) {
  struct Case {
    Formula f;
    double x0, value;
    int order_of_values, order_of_gradients;  // highest that exist; -1: none
  };
  const std::vector<Case> cases = {
      {square_root, 0.0, 0.0, 0, 0},
      {[](const Term& x) { return asin(x); }, 1.0, std::asin(1.0), 0, 0},
      {[](const Term& x) { return acos(x); }, 1.0, 0.0, 0, 0},
      {[](const Term& x) { return pow(x, 1.5); }, 0.0, 0.0, 1, 0},
      {[](const Term& x) { return pow(x, 0.3); }, 0.0, 0.0, 0, 0},
      {[](const Term& x) { return atan2(x, 0.0 * x); }, 0.0, 0.0, 0, -1},
      {[](const Term& x) { return pow(x, 2.0) + pow(x, 3.0); }, 0.0, 0.0, 3, 2},
      {[](const Term& x) { return pow(x, 65.0); }, 0.0, 0.0, 3, 2},
      {[](const Term& x) { return abs(x); }, 0.0, 0.0, 3, 2},
  };
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& c = cases[i];
    for (int order = 0; order <= 3; ++order) {
      Trial trial(c.f, c.x0);
      EXPECT_EQ(trial.values(order), order <= c.order_of_values) << "case " << i << ", order " << order;
      EXPECT_EQ(trial.F[1], c.value) << i;
      if (order > c.order_of_values) {
        EXPECT_EQ(trial.failure().kind, Kind::not_smooth) << i;
      }
    }
    for (int order = 0; order <= 2; ++order) {
      Trial trial(c.f, c.x0);
      EXPECT_EQ(trial.gradients(order), order <= c.order_of_gradients)
          << "case " << i << ", gradients of order " << order;
      if (order > c.order_of_gradients) {
        EXPECT_EQ(trial.failure().equation, 1) << i;
      }
    }
  }
}

TEST(NotSmooth, IsNamed) {
  Trial trial(square_root, 0.0);
  ASSERT_FALSE(trial.values(2));
  const std::string what = "sqrt of 0 has no finite derivative of order 1 in equation 1. It depends on x[0]";
  EXPECT_EQ(trial.failure().message.substr(0, what.size()), what);
  ASSERT_FALSE(trial.gradients(1));
  EXPECT_EQ(trial.failure().message.substr(0, what.size()), what);
}

TEST(Powers, WithParametersAsExponentsAreProductsAtZero) {
  Recording recording(1);
  const Term p = recording.parameter("p", 2.0);
  TaylorEvaluator evaluator(recording.finish({pow(recording.x[0], p)}));
  const double jet[] = {0.0, 3.0, 1.0, 0.0};  // (3 s + s^2)^2 = 9 s^2 + ...
  double F[3], F_xdot[3], F_x[3];
  ASSERT_TRUE(evaluator.gradients(0.0, jet, {2, 2, 2}, F, F_xdot, F_x)) << evaluator.failure().message;
  EXPECT_EQ(std::vector(F, F + 3), std::vector({0.0, 0.0, 9.0}));
  EXPECT_EQ(std::vector(F_x, F_x + 3), std::vector({0.0, 6.0, 2.0}));
  EXPECT_EQ(std::vector(F_xdot, F_xdot + 3), std::vector({0.0, 0.0, 0.0}));
}

TEST(Choices, BranchesNotTakenMayBeUndefined) {
  const Formula f = [](const Term& x) { return choose(x, sqrt(x) + log(x), x * x) + choose(-x, 1.0 / (x + 2.0), x); };
  Trial left(f, -1.0), right(f, 4.0), pole(f, -2.0);
  EXPECT_TRUE(left.gradients(2)) << left.failure().message;
  EXPECT_EQ(left.F_x[1], -2.0 - 1.0);
  EXPECT_TRUE(right.gradients(2)) << right.failure().message;
  EXPECT_EQ(right.F_x[1], 0.25 + 0.25 + 1.0);
  EXPECT_FALSE(pole.gradients(2));
  EXPECT_EQ(pole.failure().message, "division of 1 by 0 in equation 1");
}

TEST(Choices, UndefinedConditionsAreUndefined) {
  Trial trial([](const Term& x) { return choose(log(x), x, 2.0 * x); }, -1.0);
  EXPECT_FALSE(trial.values(0));
  EXPECT_EQ(trial.failure().message, "log of -1 in equation 1");
}

TEST(NotFinite, ArgumentsAndOverflow) {
  Trial overflow([](const Term& x) { return exp(x); }, 1000.0);
  EXPECT_FALSE(overflow.values(1));
  EXPECT_EQ(overflow.failure().kind, Kind::not_finite);
  EXPECT_EQ(overflow.failure().message, "exp of 1000 is not finite in equation 1");
  Trial infinite(square_root, 1.0);
  infinite.jet[1] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(infinite.values(1));
  EXPECT_EQ(infinite.failure().kind, Kind::not_finite);
}

TEST(Evaluation, GoesOnAfterAFailure) {
  Trial trial([](const Term& x) { return sqrt(x) * x; }, -1.0);
  EXPECT_FALSE(trial.gradients(1));
  trial.jet[0] = 4.0;
  ASSERT_TRUE(trial.gradients(1));
  EXPECT_EQ(trial.F[1], 8.0);
  EXPECT_EQ(trial.F_x[1], 3.0);
}

}  // namespace sfdae::core
