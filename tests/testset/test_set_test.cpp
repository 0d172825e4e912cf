// SPDX-License-Identifier: BSD-3-Clause
// The problems of the test set: sizes, start values, references, and agreement with the formulas of problems.json.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "matrix_checks.h"
#include "test_set/formula_problems.h"
#include "test_set/test_set.h"

namespace {

using namespace sfdae_test;

// Residuals at the start, in the units of F. The modes of the slider crank are published to 5e-15 and meet
// the stiffness 16/3 E b h / L2 = 2.3e8. The amplifier has currents of up to 1e-3.
double start_tolerance(const TestProblem& p) {
  if (p.name == "slider_crank") return 5e-15 * 2.3e8;
  if (p.name == "transistor_amplifier") return 1e-3 * rounding(p.n);
  return rounding(p.n) * max_abs(column(p.x0));
}

TEST(TestSet, HasSizesThatFit) {
  for_each_problem_of_test_set([](const TestProblem& p, const auto&) {
    EXPECT_EQ(p.m, p.values.d + p.values.a + p.values.v) << p.name;
    EXPECT_EQ(p.n, p.values.d + p.values.a + p.values.u) << p.name;
    EXPECT_EQ(p.x0.size(), size(p.n)) << p.name;
    EXPECT_EQ(p.xdot0.size(), size(p.n)) << p.name;
    ASSERT_EQ(p.references.size(), 1u) << p.name;
    EXPECT_EQ(p.references[0].t, p.tf) << p.name;
    for (const int i : p.counted) EXPECT_NE(p.references[0].x.at(size(i)), 0.0) << p.name;
  });
}

TEST(TestSet, StartsConsistently) {
  for_each_problem_of_test_set([](const TestProblem& p, const auto& equations) {
    std::vector<double> F(size(p.m));
    equations(0, p.t0, p.x0.data(), p.xdot0.data(), F.data());
    EXPECT_LE(max_abs(column(F)), start_tolerance(p)) << p.name;
  });
}

TEST(TestSet, EveryEquationDependsOnSomething) {
  for_each_problem_of_test_set([](const TestProblem& p, const auto& equations) {
    std::vector<double> F(size(p.m)), G(size(p.m)), x = p.x0, xdot = p.xdot0;
    equations(0, p.t0, x.data(), xdot.data(), F.data());
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] += 1e-3 * (1.0 + 0.1 * static_cast<double>(i % 7));
      xdot[i] += 1.0;
    }
    equations(0, p.t0, x.data(), xdot.data(), G.data());
    for (std::size_t i = 0; i < F.size(); ++i) EXPECT_NE(F[i], G[i]) << p.name << ", equation " << i;
  });
}

TEST(TestSet, DigitsAreCountedByTheWorstCountedComponent) {
  TestProblem p{.name = "two of three", .m = 3, .n = 3, .values = {0, 3, 0, 0, 0}};
  p.counted = {0, 2};
  const ReferencePoint reference{1.0, {2.0, 1.0, -4.0}};
  const double x[] = {2.0 + 2e-7, 9.0, -4.0 - 4e-5};
  EXPECT_NEAR(correct_digits(p, reference, x), 5.0, 1e-6);
  const double broken[] = {std::nan(""), 1.0, -4.0};
  EXPECT_LT(correct_digits(p, reference, broken), 0.0);
}

// The same equations written down twice, at points where nothing is special.
template <class Residual>
void expect_same(const std::string& name, const Residual& residual, double multiplier_unit = 1.0) {
  const FormulaProblem& formulas = formula_problem(name);
  const auto n = size(formulas.data.n), m = size(formulas.data.m);
  for (int sample = 1; sample <= 5; ++sample) {
    RandomNumbers numbers(static_cast<std::uint64_t>(sample));
    std::vector<double> x(n), xdot(n), F(m), G(m);
    for (double& value : x) value = numbers.uniform(-0.1, 0.1);
    for (double& value : xdot) value = numbers.uniform(-1.0, 1.0);
    for (std::size_t i = 0; i < n; ++i) x[i] += formulas.data.x0[i];
    const double t = 0.01 * sample;
    formulas.residual(t, x.data(), xdot.data(), F.data());
    x.back() *= multiplier_unit;
    residual(t, x.data(), xdot.data(), G.data());
    for (std::size_t i = 0; i < m; ++i) EXPECT_NEAR(F[i], G[i], rounding(10) * 10.0) << name << ", equation " << i;
  }
}

TEST(TestSet, AgreesWithTheFormulas) {
  expect_same("car_axis", car_axis_residual<double>);
  expect_same("transistor_amp", transistor_amplifier_residual<double>);
  expect_same("pendulum", pendulum_residual<double>, 2.0);  // the formulas have 2 lambda for our lambda
}

// 0 = |p_i| - 1, and the forces at rest vanish with the multipliers -19/4: sum_i p_i . sum_j D_ij = 190 by symmetry.
TEST(FeketeReference, IsAtRest) {
  std::vector<double> x = fekete().references[0].x, F(60);
  x.resize(160, 0.0);
  for (std::size_t i = 120; i < 140; ++i) x[i] = -4.75;
  Fekete::forces(0.0, x.data(), F.data());
  std::vector<double> g(20);
  Fekete::constraints(0.0, x.data(), g.data());
  EXPECT_LE(max_abs(column(g)), rounding(3));
  EXPECT_LE(max_abs(column(F)), rounding(20));
}

TEST(AkzoReference, IsInEquilibrium) {
  const std::vector<double> x = akzo().references[0].x, xdot(6, 0.0);
  std::vector<double> F(6);
  akzo_residual(180.0, x.data(), xdot.data(), F.data());
  EXPECT_LE(std::abs(F[5]), rounding(1) * x[5]);
}

// The capacitors drop out of the sums of the equations at their ends; currents are up to 1e-3.
TEST(TransistorReference, SatisfiesKirchhoffsLaw) {
  const std::vector<double> x = transistor_amplifier().references[0].x, xdot(8, 0.0);
  std::vector<double> F(8);
  transistor_amplifier_residual(0.2, x.data(), xdot.data(), F.data());
  for (std::size_t i : {0u, 3u, 6u}) EXPECT_LE(std::abs(F[i] + F[i + 1]), 1e-3 * rounding(10)) << i;
}

TEST(NandInputs, AreContinuousAndHaveTheirSlopes) {
  for (int k = 0; k < 16; ++k) {
    const double begin = 5.0 * k, end = begin + 5.0;
    const auto a = nand_inputs(begin, k), b = nand_inputs(end, k), next = nand_inputs(end, k + 1);
    EXPECT_EQ(b.V1, next.V1) << k;
    EXPECT_EQ(b.V2, next.V2) << k;
    EXPECT_EQ(b.V1 - a.V1, 5.0 * a.V1_slope) << k;
    EXPECT_EQ(b.V2 - a.V2, 5.0 * a.V2_slope) << k;
  }
  // V1 is high in [10, 15] and [30, 35], V2 in [20, 35].
  EXPECT_EQ(nand_inputs(12.0, 2).V1, 5.0);
  EXPECT_EQ(nand_inputs(22.0, 4).V1, 0.0);
  EXPECT_EQ(nand_inputs(22.0, 4).V2, 5.0);
  EXPECT_EQ(nand_inputs(12.0, 2).V2, 0.0);
}

// [Shichman, Hodges] The current is continuous at the threshold, at saturation and at DS = 0.
TEST(NandTransistor, IsContinuousInItsBranches) {
  using N = Nand;
  const auto current = [](double DS, double GS, double GD) {
    return N::drain_current(N::enhancement, N::Voltages<double>{DS, GS, -1.0, GD, -1.0});
  };
  const double threshold = 0.2 + 0.035 * (std::sqrt(2.01) - std::sqrt(1.01)), step = 1e-9;
  EXPECT_EQ(current(1.0, threshold - step, 0.0), 0.0);
  EXPECT_EQ(current(1.0, threshold - 1.0, 0.0), 0.0);
  EXPECT_NEAR(current(1.0, threshold + step, 0.0), 0.0, 1e-11);
  // Saturation: B u^2 (1 + D DS), below it B DS (2 u - DS) (1 + D DS).
  EXPECT_NEAR(current(2.0, threshold + 1.5, 0.0), -1.748e-3 * 2.25 * 1.04, rounding(1));
  EXPECT_NEAR(current(1.0, threshold + 1.5, 0.0), -1.748e-3 * 1.0 * 2.0 * 1.02, rounding(1));
  EXPECT_NEAR(current(-2.0, 0.0, threshold + 1.5), 1.748e-4 * 2.25 * 1.04, rounding(1));
  EXPECT_NEAR(current(step, threshold + 1.5, 0.0), current(-step, 0.0, threshold + 1.5), 1e-10);
}

}  // namespace
