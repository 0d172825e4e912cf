// SPDX-License-Identifier: BSD-3-Clause
// The formulas of an exported system: those of the minimal extension, and its derivatives.
#include "extension/exported_system.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "nonlinear_examples.h"

namespace sfdae::core {

namespace {

using namespace sfdae_test;

double factorial(int k) { return k < 2 ? 1.0 : k * factorial(k - 1); }

// A recording with its extension, some states of it and the system exported with these.
struct Exported {
  explicit Exported(const RecordPointer& record, std::vector<int> states = {})
      : problem(TaylorEvaluator(record)), extension(problem, problem.shared_structure()) {
    jet.n = problem.n();
    jet.t = 0.3;
    jet.order = extension.jet_order();
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> number(0.2, 0.8);
    jet.x.resize(index(jet.n) * index(jet.order + 1));
    for (double& x : jet.x) x = number(generator);
    // As the exported system has it: no equation of the extension contains what lies beyond.
    for (int j = 0; j < jet.n; ++j)
      for (int k = extension.offsets().d[index(j)] + 1; k <= jet.order; ++k) jet.column(k)[j] = 0.0;
    choice.set(extension, std::move(states));
    system = exported_system(extension, choice, jet);
  }

  RecordedProblem problem;
  MinimalExtension extension;
  Jet jet;
  StateChoice choice;
  ExportedSystem system;
};

// F, then the partials.
std::vector<double> values_of(const ExportedSystem& system) {
  TaylorEvaluator evaluator(system.formulas);
  std::vector<double> point = system.z, values(index(system.formulas->m()));
  point.insert(point.end(), system.zdot.begin(), system.zdot.end());
  EXPECT_TRUE(evaluator.values(system.t, point.data(), 0, values.data())) << evaluator.failure().message;
  return values;
}

// Rows are derivatives, not Taylor coefficients; sums of up to some 20 terms are rounded in another order.
void expect_values_of_extension(Exported& exported) {
  MinimalExtension& extension = exported.extension;
  const ExportedSystem& system = exported.system;
  const std::vector<double> values = values_of(system);
  std::vector<double> r(index(extension.num_rows()));
  ASSERT_EQ(extension.residuals(exported.jet, r.data()).status, SFDAE_OK);
  ASSERT_EQ(extension.linearize(exported.jet).status, SFDAE_OK);
  Matrix dense(extension.num_rows(), extension.num_columns());
  for (int row = 0; row < extension.num_rows(); ++row) {
    const double scale = factorial(extension.rows()[index(row)].order);
    EXPECT_NEAR(values[index(row)], scale * r[index(row)], 1e-12 * (1.0 + std::fabs(scale * r[index(row)])));
    for (int e = extension.first()[index(row)]; e < extension.first()[index(row + 1)]; ++e) {
      const auto [unknown, order] = extension.columns()[index(extension.column()[index(e)])];
      dense(row, extension.column()[index(e)]) = scale / factorial(order) * extension.values()[index(e)];
    }
  }
  for (std::size_t e = 0; e < system.partials.size(); ++e) {
    const ExportedSystem::Partial& partial = system.partials[e];
    const ExportedSystem::Unknown& z = system.unknowns[index(partial.column)];
    double& expected = dense(partial.row, extension.column_of(z.unknown, z.order + (partial.derivative ? 1 : 0)));
    const double value = values[index(system.size()) + e];
    EXPECT_NEAR(value, expected, 1e-12 * (1.0 + std::fabs(expected))) << partial.row << " " << partial.column;
    expected = 0.0;
  }
  for (int row = 0; row < dense.rows(); ++row)
    for (int column = 0; column < dense.cols(); ++column) EXPECT_EQ(dense(row, column), 0.0) << row << " " << column;
}

using Formula = std::function<Term(const Term&, const Term&, const Term&)>;

// x1' = x2, x2' = x3, 0 = x4 + formula(x1, x4, t): the formula is differentiated twice, in x1 and x4.
RecordPointer twice_differentiated(const Formula& formula) {
  Recording r(4);
  return r.finish({r.xdot[0] - r.x[1], r.xdot[1] - r.x[2], r.xdot[3] - r.x[1] * r.x[1],
                   r.x[0] * 2.0 + r.x[3] + formula(r.x[0], r.x[3], r.t)});
}

}  // namespace

TEST(ExportedSystem, HasTheValuesAndDerivativesOfTheExtensionForEveryOperation) {
  const std::vector<Formula> formulas = {
      [](auto& x, auto& y, auto& t) { return x * y - y / (1.0 + x) + t * x; },
      [](auto& x, auto& y, auto& t) { return pow(x, Term(2.5)) + pow(y, Term(-1.5)) * t + pow(x, Term(3.0)); },
      [](auto& x, auto& y, auto& t) { return pow(x + 1.0, y * t); },
      [](auto& x, auto& y, auto&) { return sqrt(x + y) * exp(x * y) + log(y) - log10(x); },
      [](auto& x, auto& y, auto& t) { return sin(x * y) - cos(y + t) * tan(x); },
      [](auto& x, auto& y, auto&) { return asin(x * y) + acos(x) * atan(y); },
      [](auto& x, auto& y, auto& t) { return atan2(x + t, y) * atan2(y, x + 2.0); },
      [](auto& x, auto& y, auto&) { return sinh(x) + cosh(y) * tanh(x * y); },
      [](auto& x, auto& y, auto&) { return abs(x - y) * x + min(x * x, y) + max(x, y * y); },
      [](auto& x, auto& y, auto&) { return floor(y * 7.0) * x + modulo(x * 9.0, y + 0.5); },
      // The branch that is not chosen has no derivatives.
      [](auto& x, auto& y, auto&) { return choose(x + 1.0, x * y, sqrt(-x)) + choose(-x, log(-y), x * x); }};
  for (std::size_t k = 0; k < formulas.size(); ++k) {
    SCOPED_TRACE(k);
    Exported exported(twice_differentiated(formulas[k]), {0});
    ASSERT_EQ(exported.extension.freedom(), 1);
    EXPECT_EQ(exported.extension.offsets().c[3], 2);
    expect_values_of_extension(exported);
  }
}

TEST(ExportedSystem, OfThePendulumHasTwoStates) {
  Exported exported(record_of_pendulum(), {0, 2});
  EXPECT_EQ(exported.system.size(), 9);
  EXPECT_EQ(exported.system.num_states(), 2);
  expect_values_of_extension(exported);
}

TEST(ExportedSystem, OfStrangenessFreeEquationsIsTheseEquations) {
  Exported exported(record_of_hyperbola(), {0});
  EXPECT_EQ(exported.system.size(), 2);
  for (const ExportedSystem::Equation& equation : exported.system.equations) EXPECT_EQ(equation.order, 0);
  expect_values_of_extension(exported);
}

// Products of products are what makes repeated differentiation of formulas exponential.
TEST(ExportedSystem, GrowsByNoMoreThanTheSquareOfTheOrder) {
  const auto nodes = [](int index) {
    Recording r(index + 1);  // x1 x1 x1 = t, x1' = x2 x2, x2' = x3 x3, ...
    std::vector<Term> F{r.x[0] * r.x[0] * r.x[0] - sin(r.t)};
    for (int i = 0; i < index; ++i) F.push_back(r.xdot[core::index(i)] - r.x[core::index(i + 1)]);
    Exported exported(r.finish(F));
    expect_values_of_extension(exported);
    return exported.system.formulas->num_nodes();
  };
  const int few = nodes(5), many = nodes(10);
  EXPECT_LT(many, 6 * few);
}

}  // namespace sfdae::core
