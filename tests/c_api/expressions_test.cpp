// SPDX-License-Identifier: BSD-3-Clause
// Equations recorded by the C API and by C++ operators, and mistakes in writing them.
#include "c_api/expressions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "problem/failure.h"
#include "sfdae/sfdae.hpp"

namespace sfdae::core {

namespace {

using Numbers = std::vector<double>;

// What is written by a function in place of a C callback.
using Writer = std::function<int(sfdae_record* record, Expression t, const sfdae_expression* x,
                                 const sfdae_expression* xdot, sfdae_expression* residual)>;

int call_writer(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                sfdae_expression* residual, void* user) {
  return (*static_cast<Writer*>(user))(record, t, x, xdot, residual);
}

std::shared_ptr<const Record> record_from(Writer writer, int m, int n) {
  return record_equations(call_writer, m, n, &writer);
}

// F at order 0 for x = (2, 0.5, ...), x' = (3, 4, ...), t = 1.
Numbers evaluate_once(const std::shared_ptr<const Record>& record) {
  TaylorEvaluator evaluator(record);
  const Numbers jet = {2.0, 0.5, 3.0, 4.0};
  Numbers F(static_cast<std::size_t>(record->m()));
  EXPECT_TRUE(evaluator.values(1.0, jet.data(), 0, F.data())) << evaluator.failure().message;
  return F;
}

// "" if none.
std::string failure_of(const std::function<void()>& action, int status = SFDAE_ILLEGAL_ARGUMENT) {
  try {
    action();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.status(), status) << failure.what();
    return failure.what();
  }
  return "";
}

// One equation in two unknowns, wrong in some way.
void expect_mistake(const Writer& writer, const std::string& message) {
  EXPECT_EQ(failure_of([&] { record_from(writer, 1, 2); }), "recording of equations: " + message);
}

// Every function, once; arguments within all domains.
template <class Number>
std::vector<Number> all_functions(const Number& a, const Number& b) {
  using sfdae::choose;
  using std::abs, std::acos, std::asin, std::atan, std::atan2, std::cos, std::cosh, std::exp, std::log, std::max,
      std::min, std::pow, std::sin, std::sinh, std::sqrt, std::tan, std::tanh;
  return {a + b,
          a - b,
          a * b,
          a / b,
          -a,
          pow(a, b),
          sqrt(a),
          exp(a),
          log(a),
          sin(a),
          cos(a),
          tan(a),
          asin(b),
          acos(b),
          atan(a),
          atan2(a, b),
          sinh(a),
          cosh(a),
          tanh(a),
          abs(-a),
          abs(a),
          min(a, b),
          max(a, b),
          choose(a - b, a, b),
          choose(b - a, a, b),
          pow(a, 3.0),
          pow(2.0, a),
          1.0 + a,
          a - 1.0,
          2.0 * a,
          1.0 / a};
}

}  // namespace

TEST(Expressions, AreWhatTheirFunctionsSay) {
  const Numbers expected = all_functions(2.0, 0.5);
  const auto record = record_from(
      [&](sfdae_record*, Expression, const sfdae_expression* x, const sfdae_expression*, sfdae_expression* residual) {
        const auto values = all_functions<Expression>(x[0], x[1]);
        for (std::size_t i = 0; i < values.size(); ++i) residual[i] = values[i].c();
        return 0;
      },
      static_cast<int>(expected.size()), 2);
  const Numbers F = evaluate_once(record);
  const auto numbers = all_functions<Expression>(2.0, 0.5);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const double tolerance = 4.0 * std::numeric_limits<double>::epsilon() * std::fabs(expected[i]);
    EXPECT_NEAR(F[i], expected[i], tolerance) << i;
    EXPECT_EQ(numbers[i].c().record, nullptr);
    EXPECT_NEAR(numbers[i].c().value, expected[i], tolerance) << i;
  }
}

TEST(Expressions, KnowTimeDerivativesAndParameters) {
  const auto record = record_from(
      [](sfdae_record* r, Expression t, const sfdae_expression* x, const sfdae_expression* xdot,
         sfdae_expression* residual) {
        Expression sum = parameter(r, "rate", 10.0) * t;
        sum += xdot[0];
        sum *= x[1];
        sum -= xdot[1];
        sum /= 2.0;
        residual[0] = sum.c();
        return 0;
      },
      1, 2);
  EXPECT_EQ(evaluate_once(record)[0], ((10.0 * 1.0 + 3.0) * 0.5 - 4.0) / 2.0);
  ASSERT_EQ(record->parameters().size(), 1u);
  EXPECT_EQ(record->parameters()[0].name, "rate");
}

TEST(Expressions, PlainNumbersAreEquations) {
  const auto record = record_from(
      [](sfdae_record*, Expression, const sfdae_expression*, const sfdae_expression*, sfdae_expression* residual) {
        residual[0] = sfdae_number(2.5);
        return 0;
      },
      1, 2);
  EXPECT_EQ(evaluate_once(record)[0], 2.5);
}

TEST(LinearEquations, AreRecordedFromTheirCoefficients) {
  // E = [1 t; 0 0], A = [2 0; 0 -t], f = (0, sin t)
  const auto coefficients = [](sfdae_record*, sfdae_expression t, sfdae_expression* E, sfdae_expression* A,
                               sfdae_expression* f, void*) {
    E[0] = sfdae_number(1.0);
    E[2] = t;
    A[0] = sfdae_number(2.0);
    A[3] = sfdae_negate(t);
    f[1] = sfdae_sin(t);
    return 0;
  };
  const auto record = record_linear_equations(coefficients, 2, 2, nullptr);
  const Numbers F = evaluate_once(record);
  EXPECT_EQ(F[0], 3.0 + 1.0 * 4.0 - 2.0 * 2.0);
  EXPECT_EQ(F[1], 1.0 * 0.5 - std::sin(1.0));
  EXPECT_TRUE(record->is_linear());
  EXPECT_FALSE(record->is_constant_E());
  EXPECT_FALSE(record->is_constant_A());
}

TEST(Mistakes, ForgottenEquationsAreNamed) {
  const auto forget = [](sfdae_record*, Expression, const sfdae_expression* x, const sfdae_expression*,
                         sfdae_expression* residual) {
    residual[0] = x[0];
    residual[2] = x[1];
    return 0;
  };
  EXPECT_EQ(failure_of([&] { record_from(forget, 3, 2); }), "recording of equations: residual[1] was not set.");
}

TEST(Mistakes, AreRememberedAndNamed) {
  using X = const sfdae_expression*;
  using R = sfdae_expression*;
  expect_mistake([](auto*, auto, X x, X, R F) { return F[0] = sfdae_add(F[0], x[0]), 0; },
                 "add: an expression has no value yet.");
  expect_mistake(
      [](auto*, auto, X x, X, R F) {
        sfdae_expression damaged = x[0];
        damaged.node = 12345;
        return F[0] = sfdae_sin(damaged), 0;
      },
      "sin: an expression is damaged.");
  expect_mistake(
      [](auto*, auto, X x, X, R F) { return F[0] = sfdae_multiply(x[0], sfdae_log(sfdae_number(-1.0))), 0; },
      "multiply: a number is not finite, or was computed where it is not defined, as log(-1) is.");
  expect_mistake(
      [](auto*, auto, X, X, R F) { return F[0] = sfdae_number(std::numeric_limits<double>::quiet_NaN()), 0; },
      "residual[0]: a number is not finite, or was computed where it is not defined, as log(-1) is.");
  expect_mistake([](auto* r, auto, X, X, R F) { return F[0] = sfdae_parameter(r, nullptr, 1.0), 0; },
                 "sfdae_parameter: a parameter needs a name.");
  expect_mistake([](auto* r, auto, X, X, R F) { return F[0] = sfdae_parameter(r, "k", INFINITY), 0; },
                 "sfdae_parameter: the value of k is not finite.");
  expect_mistake(
      [](auto*, auto, X x, X, R F) { return F[0] = sfdae_add(x[0], sfdae_parameter(nullptr, "k", 1.0)), 0; },
      "add: a number is not finite, or was computed where it is not defined, as log(-1) is.");
}

TEST(Mistakes, TheFirstOneCounts) {
  expect_mistake(
      [](sfdae_record* r, Expression, const sfdae_expression* x, const sfdae_expression*, sfdae_expression* F) {
        const sfdae_expression wrong = sfdae_parameter(r, "", 1.0);
        F[0] = sfdae_choose(sfdae_max(wrong, x[0]), sfdae_abs(wrong), x[1]);
        return 0;
      },
      "sfdae_parameter: a parameter needs a name.");
}

TEST(Mistakes, RecordingsMustNotBeMixed) {
  std::string inner;
  const auto outer = [&](sfdae_record*, Expression, const sfdae_expression* x, const sfdae_expression*,
                         sfdae_expression* F) {
    const sfdae_expression foreign = x[0];
    inner = failure_of([&] {
      record_from(
          [&](sfdae_record*, Expression, const sfdae_expression* y, const sfdae_expression*, sfdae_expression* G) {
            G[0] = sfdae_divide(y[0], foreign);
            return 0;
          },
          1, 1);
    });
    F[0] = x[0];
    return 0;
  };
  const std::string message = "recording of equations: division: the operands belong to different recordings.";
  EXPECT_EQ(failure_of([&] { record_from(outer, 1, 1); }), message);
  EXPECT_EQ(inner, message);
}

TEST(Mistakes, FunctionsCanGiveUp) {
  for (int returned : {-3, 5}) {
    const auto give_up = [&](sfdae_record*, Expression, const sfdae_expression*, const sfdae_expression*,
                             sfdae_expression*) { return returned; };
    EXPECT_EQ(failure_of([&] { record_from(give_up, 1, 1); },
                         returned < 0 ? SFDAE_CALLBACK_STOPPED : SFDAE_CALLBACK_FAILED),
              "the function that writes equations returned " + std::to_string(returned) + ".");
  }
}

TEST(PlainNumbers, AreUndefinedQuietly) {
  for (const sfdae_expression& value :
       {sfdae_divide(sfdae_number(1.0), sfdae_number(0.0)), sfdae_sqrt(sfdae_number(-1.0)),
        sfdae_exp(sfdae_number(1e4)), sfdae_power(sfdae_number(-8.0), sfdae_number(0.5)),
        sfdae_acos(sfdae_number(2.0)), sfdae_parameter(nullptr, "k", 1.0)})
    EXPECT_TRUE(std::isnan(value.value));
}

}  // namespace sfdae::core
