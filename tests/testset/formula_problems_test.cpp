// SPDX-License-Identifier: BSD-3-Clause
// What tests/data/problems.json says in different ways agrees: equations, exact solutions, start values, references.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "matrix_checks.h"
#include "test_set/formula_problems.h"

namespace {

using namespace sfdae_test;

class Problems : public testing::TestWithParam<std::string> {
 protected:
  const FormulaProblem& problem() const { return formula_problem(GetParam()); }
  bool has_exact() const { return problem().solution != ExactSolution::none; }
};

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const FormulaProblem& p : formula_problems()) all.push_back(p.data.name);
  return all;
}
std::string test_name(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  for (char& c : name)
    if (c == '-' || c == '.') c = '_';
  return name;
}
INSTANTIATE_TEST_SUITE_P(File, Problems, testing::ValuesIn(names()), test_name);

TEST_P(Problems, HaveSizesThatFit) {
  const TestProblem& p = problem().data;
  EXPECT_EQ(p.m, p.values.d + p.values.a + p.values.v);
  EXPECT_EQ(p.n, p.values.d + p.values.a + p.values.u);
  EXPECT_EQ(problem().F.size(), size(p.m));
  EXPECT_EQ(p.x0.size(), size(p.n));
  EXPECT_LT(p.t0, p.tf);
  for (const ReferencePoint& reference : p.references) EXPECT_EQ(reference.x.size(), size(p.n));
}

// Taylor coefficients of F(t, x(t), x'(t)) vanish up to rounding, which grows with x and its derivatives.
TEST_P(Problems, AreSolvedByTheirExactSolutions) {
  if (!has_exact()) GTEST_SKIP() << "no exact solution";
  constexpr int order = 3;
  const TestProblem& p = problem().data;
  for (const double fraction : {0.0, 0.37, 1.0}) {
    const double t = p.t0 + fraction * (p.tf - p.t0);
    const std::vector<Jet> x = problem().exact(t, order + 1);
    std::vector<Jet> xdot, F(size(p.m));
    double scale = 1.0;
    for (const Jet& component : x) {
      xdot.push_back(derivative(component));
      for (int k = 0; k <= order + 1; ++k) scale = std::max(scale, std::abs(component[k]) * factorial(k + 1));
    }
    problem().residual(Jet::variable(t, order), x.data(), xdot.data(), F.data());
    // Parameters are at most 50, squares of components occur.
    for (const Jet& equation : F)
      for (int k = 0; k <= order; ++k) EXPECT_LE(std::abs(equation[k]), rounding(p.n) * 50.0 * scale * scale) << t;
  }
}

// The path of the crane is a polynomial with coefficients up to 24024 that nearly cancel.
TEST_P(Problems, AgreeWithTheirReferences) {
  if (!has_exact()) GTEST_SKIP() << "no exact solution";
  const double largest_term = problem().solution == ExactSolution::crane ? 24024.0 : 1.0;
  for (const ReferencePoint& reference : problem().data.references) {
    const std::vector<Jet> x = problem().exact(reference.t, 0);
    const double tolerance = rounding(problem().data.n) * (largest_term + max_abs(column(reference.x)));
    for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(x[i][0], reference.x[i], tolerance) << i;
  }
}

// Equations without x', which two different x' reveal, hold at the start.
TEST_P(Problems, StartConsistently) {
  const TestProblem& p = problem().data;
  std::vector<double> zero(size(p.n), 0.0), other(size(p.n)), F0(size(p.m)), F1(size(p.m));
  for (std::size_t i = 0; i < other.size(); ++i) other[i] = 1.0 + 0.3 * static_cast<double>(i * i);
  problem().residual(p.t0, p.x0.data(), zero.data(), F0.data());
  problem().residual(p.t0, p.x0.data(), other.data(), F1.data());
  const double tolerance = rounding(p.n) * (1.0 + max_abs(column(p.x0)));
  for (std::size_t i = 0; i < F0.size(); ++i) {
    const bool without_slopes = F0[i] == F1[i];
    EXPECT_TRUE(!without_slopes || std::abs(F0[i]) <= tolerance) << "equation " << i << ": " << F0[i];
  }
}

}  // namespace
