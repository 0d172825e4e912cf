// SPDX-License-Identifier: BSD-3-Clause
// Recorded linear equations deliver the coefficients that functions for E, A and f would.
#include "problem/recorded_linear.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "jet.h"
#include "linalg/arena.h"
#include "matrix_checks.h"
#include "problem/linear_problem.h"
#include "recorded.h"

namespace sfdae::core {

namespace {

using sfdae_test::factorial;
using sfdae_test::Jet;
using sfdae_test::Recording;
using sfdae_test::rounding;
using sfdae_test::size;

// E = [cos t, p; 0, 0], A = [t^2, 1; exp t, -3], f = (sin t, t); column by column.
std::shared_ptr<const Record> record_of_example(double p) {
  Recording r(2);
  const auto& x = r.x;
  const auto parameter = r.parameter("p", p);
  return r.finish({cos(r.t) * r.xdot[0] + parameter * r.xdot[1] - r.t * r.t * x[0] - x[1] - sin(r.t),
                   3.0 * x[1] - exp(r.t) * x[0] - r.t});
}

struct Expected {
  std::array<Jet, 4> E, A;
  std::array<Jet, 2> f;
};
Expected expected_at(double time, double p) {
  const Jet t = Jet::variable(time, 6), zero = Jet::zero(6);
  return {{cos(t), zero, Jet(p), zero}, {t * t, exp(t), Jet(1.0), Jet(-3.0)}, {sin(t), t}};
}

void expect_derivatives(const LinearFunctions& problem, double t, int order, double p) {
  SCOPED_TRACE("t = " + std::to_string(t) + ", order " + std::to_string(order));
  const Expected expected = expected_at(t, p);
  double E[4], A[4], f[2];
  ASSERT_EQ(problem.A(t, order, A, problem.user), 0);
  ASSERT_EQ(problem.E(t, order, E, problem.user), 0);
  ASSERT_EQ(problem.f(t, order, f, problem.user), 0);
  const double tolerance = rounding(8) * factorial(order) * (1.0 + t * t);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(E[i], expected.E[i][order] * factorial(order), tolerance) << i;
    EXPECT_NEAR(A[i], expected.A[i][order] * factorial(order), tolerance * std::exp(t)) << i;
  }
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(f[i], expected.f[i][order] * factorial(order), tolerance) << i;
}

}  // namespace

// Orders and times in any sequence: what is kept from the last call serves only where it fits.
TEST(RecordedLinear, AnswersForAnyOrderAtAnyTime) {
  RecordedLinearCoefficients coefficients(record_of_example(2.0), {});
  const LinearFunctions problem = coefficients.functions();
  EXPECT_EQ(problem.m, 2);
  EXPECT_EQ(problem.n, 2);
  EXPECT_FALSE(problem.constant_E);
  EXPECT_FALSE(problem.constant_A);
  struct Question {
    double t;
    int order;
  };
  for (const Question q :
       {Question{0.0, 0}, {0.0, 3}, {0.0, 1}, {1.5, 1}, {1.5, 0}, {0.0, 6}, {-0.7, 0}, {1.5, 5}, {1.5, 6}})
    expect_derivatives(problem, q.t, q.order, 2.0);
}

TEST(RecordedLinear, FollowsParametersOnceToldToForget) {
  RecordedLinearCoefficients coefficients(record_of_example(2.0), {});
  const LinearFunctions problem = coefficients.functions();
  expect_derivatives(problem, 0.3, 1, 2.0);
  coefficients.evaluator().set_parameter(0, -8.0);
  coefficients.forget();
  expect_derivatives(problem, 0.3, 1, -8.0);
}

// The same problem by functions: the same Taylor data, bit for bit as far as scaling is concerned.
TEST(RecordedLinear, AgreesWithCallbacks) {
  RecordedLinearCoefficients coefficients(record_of_example(2.0), {});
  const LinearFunctions recorded = coefficients.functions();
  LinearFunctions functions;
  functions.m = functions.n = 2;
  functions.E = [](double t, int k, double* E, void*) {
    for (std::size_t i = 0; i < 4; ++i) E[i] = expected_at(t, 2.0).E[i][k] * factorial(k);
    return 0;
  };
  functions.A = [](double t, int k, double* A, void*) {
    for (std::size_t i = 0; i < 4; ++i) A[i] = expected_at(t, 2.0).A[i][k] * factorial(k);
    return 0;
  };
  functions.f = [](double t, int k, double* f, void*) {
    for (std::size_t i = 0; i < 2; ++i) f[i] = expected_at(t, 2.0).f[i][k] * factorial(k);
    return 0;
  };
  LinearProblem one(recorded), other(functions);
  for (double tau : {0.0, 0.1, 3.0}) {
    TaylorData a, b;
    ASSERT_EQ(one.evaluate(0.4, {3, 3, 3}, tau, a).status, SFDAE_OK);
    ASSERT_EQ(other.evaluate(0.4, {3, 3, 3}, tau, b).status, SFDAE_OK);
    EXPECT_NEAR(a.time_scale, b.time_scale, rounding(2) * b.time_scale);
    EXPECT_EQ(a.row_scale, b.row_scale);
    for (int k = 0; k <= 3; ++k) {
      EXPECT_LE(sfdae_test::distance(a.E(k), b.E(k)), rounding(4) * b.norm(3)) << k;
      EXPECT_LE(sfdae_test::distance(a.A(k), b.A(k)), rounding(4) * b.norm(3)) << k;
      for (int i = 0; i < 2; ++i) EXPECT_NEAR(a.f(k)[i], b.f(k)[i], rounding(4) * b.norm(3)) << k;
    }
  }
}

TEST(RecordedLinear, DeclaresConstantMatrices) {
  Recording r(2);
  RecordedLinearCoefficients coefficients(r.finish({r.xdot[0] + 2.0 * r.x[1], r.x[0] - sin(r.t)}), {});
  EXPECT_TRUE(coefficients.functions().constant_E);
  EXPECT_TRUE(coefficients.functions().constant_A);
  Recording s(1);
  RecordedLinearCoefficients half(s.finish({s.xdot[0] + s.t * s.x[0]}), {});
  EXPECT_TRUE(half.functions().constant_E);
  EXPECT_FALSE(half.functions().constant_A);
}

// sqrt(t) has a value at 0, but no derivative; at -1 it has neither. What has failed is no answer to the next question.
TEST(RecordedLinear, FailsOnlyWhereTheDerivativeAskedForCannotBeEvaluated) {
  Recording r(1);
  RecordedLinearCoefficients coefficients(r.finish({r.xdot[0] - sqrt(r.t)}), {});
  const LinearFunctions problem = coefficients.functions();
  double f = 7.0;
  EXPECT_EQ(problem.f(1.0, 2, &f, problem.user), 0);
  EXPECT_GT(problem.f(0.0, 1, &f, problem.user), 0);
  EXPECT_EQ(problem.f(0.0, 0, &f, problem.user), 0);
  EXPECT_EQ(f, 0.0);
  EXPECT_GT(problem.f(-1.0, 0, &f, problem.user), 0);
  EXPECT_GT(problem.f(-1.0, 0, &f, problem.user), 0);
  EXPECT_EQ(problem.f(1.0, 1, &f, problem.user), 0);
  EXPECT_NEAR(f, 0.5, rounding(1));
  EXPECT_EQ(problem.f(1.0, max_derivative_order + 1, &f, problem.user), SFDAE_ORDER_NOT_AVAILABLE);
}

TEST(RecordedLinear, PassesPrescribedValuesOn) {
  Recording r(2);
  double factor = 3.0;
  const auto values = [](double t, int order, double* to, void* user) {
    to[0] = *static_cast<double*>(user) * (order == 0 ? t : 1.0);
    return order > 1 ? 4 : 0;
  };
  RecordedLinearCoefficients coefficients(r.finish({r.xdot[0] + r.x[1]}), {{1}, values, &factor});
  const PrescribedInputs inputs = coefficients.functions().inputs;
  ASSERT_EQ(inputs.components.size(), 1u);
  EXPECT_EQ(inputs.components[0], 1);
  double value = 0.0;
  EXPECT_EQ(inputs.values(2.0, 0, &value, inputs.user), 0);
  EXPECT_EQ(value, 6.0);
  EXPECT_EQ(inputs.values(2.0, 2, &value, inputs.user), 4);
}

}  // namespace sfdae::core
