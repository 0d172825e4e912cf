// SPDX-License-Identifier: BSD-3-Clause
// Recorded equations of whole problems agree with the same templates evaluated with numbers and with Taylor series.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "c_api/expressions.h"
#include "expression/taylor_evaluator.h"
#include "matrix_checks.h"
#include "test_set/formula_problems.h"
#include "test_set/recorded.h"
#include "test_set/test_set.h"

namespace {

using namespace sfdae_test;

constexpr int order = 3;

// A smooth curve through a point near the start of the problem: n x (order + 2) Taylor coefficients.
std::vector<double> curve_near_start(const TestProblem& p) {
  RandomNumbers numbers(5);
  std::vector<double> jet(size(p.n) * (order + 2));
  for (double& coefficient : jet) coefficient = numbers.uniform(-0.01, 0.01);
  for (std::size_t i = 0; i < size(p.n); ++i) jet[i] = p.x0[i] * (1.0 + jet[i]) + 1e-3 * std::abs(jet[i]);
  return jet;
}

std::vector<Jet> as_series(const std::vector<double>& jet, int n) {
  std::vector<Jet> x(size(n), Jet::zero(order + 1));
  for (std::size_t i = 0; i < x.size(); ++i)
    for (int k = 0; k <= order + 1; ++k) x[i][k] = jet[i + size(n) * size(k)];
  return x;
}

template <class Equations>
void expect_record_agrees(const TestProblem& p, const Equations& equations, int segment) {
  SCOPED_TRACE(p.name + ", segment " + std::to_string(segment));
  RecordedEquations<Equations> recorded(p, equations, segment);
  sfdae::core::TaylorEvaluator evaluator(
      sfdae::core::record_equations(&RecordedEquations<Equations>::write, p.m, p.n, &recorded));
  const std::vector<double> jet = curve_near_start(p);
  const std::vector<Jet> x = as_series(jet, p.n);
  std::vector<Jet> xdot, F(size(p.m));
  for (const Jet& component : x) xdot.push_back(derivative(component));
  const double t = p.t0 + 5.0 * segment + 0.2 * std::min(1.0, p.tf - p.t0);
  equations(segment, Jet::variable(t, order), x.data(), xdot.data(), F.data());

  std::vector<double> values(size(p.m) * (order + 1));
  ASSERT_TRUE(evaluator.values(t, jet.data(), order, values.data())) << evaluator.failure().message;
  for (int k = 0; k <= order; ++k) {
    // Terms of one equation may cancel; they are as large as the largest coefficients of any equation.
    double scale = max_abs(column(p.x0));
    for (const Jet& equation : F) scale = std::max(scale, std::abs(equation[k]));
    for (int i = 0; i < p.m; ++i)
      EXPECT_NEAR(values[size(i) + size(p.m) * size(k)], F[size(i)][k], rounding(p.n) * scale)
          << i << ", order " << k;
  }
}

TEST(RecordedTestSet, AgreesWithSeries) {
  for_each_problem_of_test_set([](const TestProblem& p, const auto& equations) {
    const int segments = static_cast<int>(p.restarts.size()) + 1;
    for (int segment = 0; segment < segments; ++segment) expect_record_agrees(p, equations, segment);
  });
}

TEST(RecordedFormulas, AgreeWithSeries) {
  for (const FormulaProblem& p : formula_problems())
    expect_record_agrees(
        p.data, [&p](int, const auto& t, const auto* x, const auto* xdot, auto* F) { p.residual(t, x, xdot, F); }, 0);
}

}  // namespace
