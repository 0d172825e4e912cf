// Models without events, against exact solutions.
// SPDX-License-Identifier: BSD-3-Clause
#include "model_builder.h"

namespace sfdae::cli::test {
namespace {

// y and vy fixed, x a guess; vx and F follow from hidden constraints. F = m (vx^2 + vy^2 - g y) / L^2, and the energy
// stays.
Builder pendulum() {
  Builder b;
  const Term m = b.parameter("m", 1.0), L = b.parameter("L", 1.0), g = b.parameter("g", 9.81);
  const Term x = b.real("x", {.start = 1.0}), y = b.real("y", {.start = 0.0, .fixed = true});
  const Term vx = b.real("vx"), vy = b.real("vy", {.start = 0.0, .fixed = true}), F = b.real("F");
  b.equation(der(x), vx);
  b.equation(der(y), vy);
  b.equation(m * der(vx), -(F * x));
  b.equation(m * der(vy), -(F * y) - m * g);
  b.equation(square(x) + square(y), square(L));
  return b;
}

TEST(Continuous, PendulumOfIndexThreeKeepsItsEnergy) {
  const Result result = solve(pendulum().model, until(2.0));
  EXPECT_SOLVED(result);
  EXPECT_EQ(result.characteristics.strangeness_index, 2);
  EXPECT_EQ(result.characteristics.differential, 2);
  EXPECT_EQ(result.trajectory.t.size(), 51u);
  for (std::size_t k = 0; k < result.trajectory.t.size(); ++k) {
    const double x = value(result, "x", k), y = value(result, "y", k), vx = value(result, "vx", k),
                 vy = value(result, "vy", k);
    EXPECT_NEAR(x * x + y * y, 1.0, 1e-12);
    EXPECT_NEAR(0.5 * (vx * vx + vy * vy) + 9.81 * y, 0.0, 1e-5);
    EXPECT_NEAR(value(result, "F", k), vx * vx + vy * vy - 9.81 * y, 1e-8);
  }
}

TEST(Continuous, GuessesMoveAndFixedValuesStay) {
  Builder b = pendulum();
  b.model.variables[3].start = Term(0.7).e;  // x, not on the circle
  b.model.variables[4].start = Term(-0.6).e;
  const Result result = analyze(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_EQ(first(result, "y"), -0.6);
  EXPECT_NEAR(first(result, "x"), 0.8, 1e-12);
  EXPECT_EQ(first(result, "vy"), 0.0);
  EXPECT_NEAR(first(result, "vx"), 0.0, 1e-12);
}

// Two capacitors in parallel, index 2: v = V0 (1 - exp(-t / (R (C1 + C2)))).
Builder two_capacitors() {
  Builder b;
  const Term V0 = b.parameter("V0", 10.0), R = b.parameter("R.R", 1000.0);
  const Term C1 = b.parameter("C[1].C", 1e-6), C2 = b.parameter("C[2].C", 2.0 * C1);
  const Term v1 = b.real("C[1].v", {.start = 0.0, .fixed = true}), v2 = b.real("C[2].v");
  const Term i1 = b.real("C[1].i"), i2 = b.real("C[2].i"), i = b.real("R.i");
  b.equation(V0, R * i + v1);
  b.equation(i1, C1 * der(v1));
  b.equation(i2, C2 * der(v2));
  b.equation(v1, v2);
  b.equation(i, i1 + i2);
  return b;
}

TEST(Continuous, TwoCapacitorsOfIndexTwo) {
  const Result result = solve(two_capacitors().model, until(0.02));
  EXPECT_SOLVED(result);
  EXPECT_LE(largest_error(result, "C[2].v", [](double t) { return 10.0 * (1.0 - std::exp(-t / 0.003)); }), 1e-6);
  EXPECT_LE(largest_error(result, "C[2].i", [](double t) { return 20.0 / 3000.0 * std::exp(-t / 0.003); }), 1e-8);
  EXPECT_GE(result.num_eliminated, 1);
}

TEST(Continuous, GivenParametersReplaceBindingsAndDependantsFollow) {
  Settings settings = until(0.02);
  settings.values = {{"C[1].C", 2e-6}};
  const Result result = solve(two_capacitors().model, settings);
  EXPECT_SOLVED(result);
  EXPECT_LE(largest_error(result, "C[1].v", [](double t) { return 10.0 * (1.0 - std::exp(-t / 0.006)); }), 1e-6);
  EXPECT_DOUBLE_EQ(result.parameters.at("C[2].C"), 4e-6);
}

// x' = -x through a chain of aliases with signs and offsets.
TEST(Continuous, AliasChainsKeepSignsAndOffsets) {
  Builder b;
  const Term x = b.real("x", {.start = 2.0, .fixed = true}), a = b.real("a"), c = b.real("c"), d = b.real("d"),
             e = b.real("e"), zero = b.real("zero"), sum = b.real("sum");
  b.equation(der(c), x);
  b.equation(a, -x);
  b.equation(a - c, 0.0);
  b.equation(d, c + 3.0);
  b.equation(zero, 0.0);
  b.equation(d + e + zero, 0.0);
  b.equation(sum, 2.0 * a + x * d);
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_EQ(result.num_unknowns, 1);
  EXPECT_EQ(result.num_eliminated, 6);
  const auto exact = [](double t) { return 2.0 * std::exp(-t); };
  EXPECT_LE(largest_error(result, "x", exact), 1e-7);
  EXPECT_LE(largest_error(result, "c", [&](double t) { return -exact(t); }), 1e-7);
  EXPECT_LE(largest_error(result, "d", [&](double t) { return 3.0 - exact(t); }), 1e-7);
  EXPECT_LE(largest_error(result, "e", [&](double t) { return exact(t) - 3.0; }), 1e-7);
  EXPECT_LE(largest_error(result, "sum", [&](double t) { return -2.0 * exact(t) + exact(t) * (3.0 - exact(t)); }),
            1e-6);
}

TEST(Continuous, WithoutAliasesTheUnknownsAreLeft) {
  Settings settings = until(0.02);
  settings.keeps_aliases = false;
  const Result result = solve(two_capacitors().model, settings);
  EXPECT_SOLVED(result);
  EXPECT_EQ(static_cast<int>(result.trajectory.names.size()), result.num_unknowns);
}

// y = sin t needs no integration at all.
TEST(Continuous, ModelsWithoutUnknownsAreEvaluated) {
  Builder b;
  const Term y = b.real("y");
  b.equation(y, function(Operation::sin, time_now()));
  const Result result = solve(b.model, until(3.0));
  EXPECT_SOLVED(result);
  EXPECT_LE(largest_error(result, "y", [](double t) { return std::sin(t); }), 1e-15);
}

TEST(Continuous, ProgressStops) {
  Settings settings = until(2.0);
  settings.progress = [](double t, double, int) { return t < 1.0; };
  const Result result = solve(pendulum().model, settings);
  EXPECT_OUTCOME(result, Outcome::stopped);
  EXPECT_LT(result.trajectory.t.back(), 1.5);
}

TEST(Continuous, ProgressStopsBeforeAnythingIsDone) {
  Settings settings = until(2.0);
  settings.progress = [](double, double, int) { return false; };
  const Result result = solve(pendulum().model, settings);
  EXPECT_OUTCOME(result, Outcome::stopped);
  EXPECT_TRUE(result.trajectory.t.empty());
}

// x' = -x, 3000 aliases with changing signs and 3000 explicit unknowns: one unknown is left.
TEST(Continuous, LongChainsLeaveTheUnknownsThatMatter) {
  Builder b;
  const int count = 3000;
  const Term x = b.real("x", {.start = 1.0, .fixed = true});
  Term alias = x, sum = Term(0.0);
  for (int k = 1; k <= count; ++k) {
    const std::string number = std::to_string(k);
    const Term next = b.real(std::string("a").append(number)), part = b.real(std::string("b").append(number));
    b.equation(next + alias, 0.0);
    b.equation(part, 0.5 * sum + next);
    alias = next;
    sum = part;
  }
  b.equation(der(x), -alias);
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_EQ(result.num_unknowns, 1);
  EXPECT_EQ(result.num_eliminated, 2 * count);
  EXPECT_NEAR(last(result, "a2999"), -std::exp(-1.0), 1e-7);
  // b_k = b_(k-1) / 2 + (-1)^k x tends to (2/3) (-1)^k x.
  EXPECT_NEAR(last(result, "b3000"), 2.0 / 3.0 * std::exp(-1.0), 1e-7);
}

TEST(Continuous, ExperimentSettingsAreDefaults) {
  Builder b = pendulum();
  b.model.experiment = {0.5, 1.5, 1e-6, 0.1};
  const Result result = solve(b.model, Settings{});
  EXPECT_SOLVED(result);
  EXPECT_EQ(result.trajectory.t.front(), 0.5);
  EXPECT_EQ(result.trajectory.t.back(), 1.5);
  EXPECT_EQ(result.trajectory.t.size(), 11u);
}

TEST(Continuous, ReportsNameUnknowns) {
  Builder b = pendulum();
  b.model.variables[3].start = Term(0.7).e;
  const Result result = analyze(b.model, until(1.0));
  EXPECT_CONTAINS(result.report, "strangeness index 2");
  EXPECT_EQ(result.report.find("x["), std::string::npos) << result.report;
}

}  // namespace
}  // namespace sfdae::cli::test
