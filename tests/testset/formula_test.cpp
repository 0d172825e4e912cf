// SPDX-License-Identifier: BSD-3-Clause
// The reader of formulas.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "test_set/formula.h"

namespace {

using sfdae_test::Formula;
using sfdae_test::FormulaScope;
using sfdae_test::Jet;

double value(const char* source) { return Formula(source).evaluate(FormulaScope<double>{.t = 3.0}); }

TEST(Formula, FollowsTheUsualPrecedence) {
  EXPECT_EQ(value("2+3*4"), 14.0);
  EXPECT_EQ(value("(2+3)*4"), 20.0);
  EXPECT_EQ(value("20-8-2"), 10.0);
  EXPECT_EQ(value("16/4/2"), 2.0);
  EXPECT_EQ(value("-t**2"), -9.0);
  EXPECT_EQ(value("2*-t + 1"), -5.0);
  EXPECT_EQ(value("25e-2*t*10"), 7.5);
  EXPECT_EQ(value("sqrt(t+13)/(t-1)"), 2.0);
}

TEST(Formula, KnowsFunctionsNamesAndUnknowns) {
  const double x[] = {2.0, 5.0}, xdot[] = {7.0, 11.0};
  FormulaScope<double> scope{.t = 0.5, .x = x, .xdot = xdot, .names = {{"k", 3.0}}};
  EXPECT_EQ(Formula("k*x[1]-xd[0]").evaluate(scope), 8.0);
  EXPECT_EQ(Formula("sin(pi*t)+cos(t-t)*exp(0)").evaluate(scope), std::sin(std::acos(-1.0) * 0.5) + 1.0);
  EXPECT_THROW(Formula("q").evaluate(scope), std::runtime_error);
}

// d/dt (t^3 - 1/t) = 3 t^2 + 1/t^2
TEST(Formula, EvaluatesSeries) {
  const FormulaScope<Jet> scope{.t = Jet::variable(2.0, 1)};
  const Jet y = Formula("t**3-1/t").evaluate(scope);
  EXPECT_DOUBLE_EQ(y[0], 7.5);
  EXPECT_DOUBLE_EQ(y[1], 12.25);
}

TEST(Formula, RefusesWhatItDoesNotUnderstand) {
  for (const char* source : {"", "1+", "(1", "1)", "tan(t)", "y[0]", "t**0.5", "t**x[0]", "2 3", "x[0", "a+*b"})
    EXPECT_THROW(Formula{source}, std::runtime_error) << source;
}

}  // namespace
