// floor, ceil, integer, div, mod and rem of what is discrete, or determined by initial equations, have the values that
// they have for numbers, wherever they stand.
// SPDX-License-Identifier: BSD-3-Clause
#include <functional>

#include "model_builder.h"

namespace sfdae::cli::test {
namespace {

Term mod(const Term& a, const Term& b) { return Term::of(Operation::mod, a, b); }
Term rem(const Term& a, const Term& b) { return Term::of(Operation::rem, a, b); }
Term div(const Term& a, const Term& b) { return Term::of(Operation::div, a, b); }
Term floor(const Term& a) { return Term::of(Operation::floor, a); }
Term ceil(const Term& a) { return Term::of(Operation::ceil, a); }
Term integer(const Term& a) { return Term::of(Operation::integer, a); }
double sign_of_second(double a, double b) { return a - std::floor(a / b) * b; }

// x' = formula(n), where n counts from first in steps of a quarter: x(1) is the mean of four values.
struct Rounded {
  const char* name;
  std::function<Term(const Term&)> formula;
  std::function<double(double)> value;
};

class RoundingOfIntegers : public testing::TestWithParam<Rounded> {};

TEST_P(RoundingOfIntegers, IsThatOfNumbersAtEveryEvent) {
  for (const double before : {-4.0, 0.0, 3.0}) {
    Builder b;
    const Term n = b.integer("n", {.start = before, .fixed = true}), x = b.real("x", {.start = 0.0, .fixed = true});
    b.equation(der(x), GetParam().formula(n));
    b.when({{{sample(0.0, 0.25)}, {assign(n, pre(n) + 1.0)}}});
    const Result result = solve(b.model, until(1.0));
    EXPECT_SOLVED(result);
    double mean = 0.0;
    for (int k = 1; k <= 4; ++k) mean += 0.25 * GetParam().value(before + k);
    EXPECT_NEAR(last(result, "x"), mean, 1e-10) << "n from " << before;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Formulas, RoundingOfIntegers,
    testing::Values(
        Rounded{"mod", [](const Term& n) { return mod(n, 3.0); }, [](double n) { return sign_of_second(n, 3.0); }},
        Rounded{"mod_negative", [](const Term& n) { return mod(n, -3.0); },
                [](double n) { return sign_of_second(n, -3.0); }},
        Rounded{"rem", [](const Term& n) { return rem(n, 3.0); }, [](double n) { return std::fmod(n, 3.0); }},
        Rounded{"div", [](const Term& n) { return div(n, 2.0); }, [](double n) { return std::trunc(n / 2.0); }},
        Rounded{"div_negative", [](const Term& n) { return div(n, -2.0); },
                [](double n) { return std::trunc(n / -2.0); }},
        Rounded{"floor", [](const Term& n) { return floor(n / 2.0); }, [](double n) { return std::floor(n / 2.0); }},
        Rounded{"ceil", [](const Term& n) { return ceil(n / 2.0); }, [](double n) { return std::ceil(n / 2.0); }},
        Rounded{"integer", [](const Term& n) { return integer(n / 2.0); },
                [](double n) { return std::floor(n / 2.0); }},
        Rounded{"equal_operands", [](const Term& n) { return div(n * n + 1.0, n * n + 1.0); },
                [](double) { return 1.0; }},
        Rounded{"nested", [](const Term& n) { return floor(mod(n, 3.0) / 2.0); },
                [](double n) { return std::floor(sign_of_second(n, 3.0) / 2.0); }},
        Rounded{"of_pre", [](const Term& n) { return mod(pre(n), 3.0); },
                [](double n) { return sign_of_second(n, 3.0); }},
        Rounded{"condition", [](const Term& n) { return choose(equal(mod(n, 2.0), 0.0), 1.0, 5.0); },
                [](double n) { return sign_of_second(n, 2.0) == 0.0 ? 1.0 : 5.0; }},
        Rounded{"condition_and_value", [](const Term& n) { return choose(mod(n, 2.0) > 0.0, 3.0 * mod(n, 2.0), n); },
                [](double n) { return sign_of_second(n, 2.0) > 0.0 ? 3.0 : n; }},
        Rounded{"subscript",
                [](const Term& n) {
                  const Term i = 1.0 + mod(n, 3.0);
                  return choose(equal(i, 1.0), 10.0, choose(equal(i, 2.0), 20.0, 30.0));
                },
                [](double n) { return 10.0 * (1.0 + sign_of_second(n, 3.0)); }},
        Rounded{"without_events", [](const Term& n) { return no_event(choose(mod(n, 2.0) > 0.5, n, div(n, 2.0))); },
                [](double n) { return sign_of_second(n, 2.0) > 0.5 ? n : n / 2.0; }}),
    [](const auto& instance) { return std::string(instance.param.name); });

// u is sampled every quarter: the slopes of x are those of the numbers u(k).
TEST(Rounding, OfSampledReals) {
  Builder b;
  const Term u = b.discrete("u", {.start = 0.0, .fixed = true}), x = b.real("x", {.start = 0.0, .fixed = true}),
             y = b.real("y");
  b.equation(y, floor(u) - x);
  b.equation(der(x), y + x + mod(u, 0.7) + rem(-u, 0.7) + choose(mod(u, 0.7) > 0.35, 1.0, 2.0));
  b.when({{{sample(0.0, 0.25)}, {assign(u, 3.7 * time_now() + 0.3)}}});
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  double sum = 0.0;
  for (int k = 0; k < 4; ++k) {
    const double value = 3.7 * 0.25 * k + 0.3, rest = sign_of_second(value, 0.7);
    sum += 0.25 * (std::floor(value) + rest + std::fmod(-value, 0.7) + (rest > 0.35 ? 1.0 : 2.0));
  }
  EXPECT_NEAR(last(result, "x"), sum, 1e-9);
  EXPECT_NEAR(last(result, "y"), std::floor(3.7 + 0.3) - sum, 1e-9);  // sampled at the end, too
}

// p^2 = 6.25 initially: floor(p) is 2, and floor(p + n / 2) follows n.
TEST(Rounding, OfFreeParameters) {
  Builder b;
  const Term p = b.free_parameter("p", 0.4), k = b.parameter("k", integer(2.0 * p)),
             n = b.integer("n", {.start = 0.0, .fixed = true}), x = b.real("x", {.start = 0.0, .fixed = true}),
             z = b.real("z", {.start = 0.0, .fixed = true});
  b.equation(der(x), floor(p) + 10.0 * mod(k, 3.0) + 100.0 * ceil(p) + 1000.0 * div(p, 0.7));
  b.equation(der(z), floor(p + n / 2.0));
  b.when({{{sample(0.0, 0.25)}, {assign(n, pre(n) + 1.0)}}});
  b.initial(square(p), 6.25);
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(first(result, "p"), 2.5, 1e-9);
  EXPECT_NEAR(last(result, "x"), 2.0 + 20.0 + 300.0 + 3000.0, 1e-6);
  EXPECT_NEAR(last(result, "z"), 0.25 * (3.0 + 3.0 + 4.0 + 4.0), 1e-9);
}

// While an event is iterated, m counts on to 5.
TEST(Rounding, FollowsWhatChangesSeveralTimesAtOneEvent) {
  for (const bool has_free : {false, true}) {
    Builder b;
    const Term p = has_free ? b.free_parameter("p", 0.3) : b.parameter("p", 0.0), m = b.integer("m", {.start = 0.0}),
               x = b.real("x", {.start = 0.0, .fixed = true});
    b.equation(m, choose(time_now() >= 0.25, choose(pre(m) < 5.0, pre(m) + 1.0, 5.0), 0.0));
    b.equation(der(x), floor(m / 1.0 + p));
    if (has_free) b.initial(p, 0.0);
    const Result result = solve(b.model, until(1.0));
    EXPECT_SOLVED(result);
    EXPECT_NEAR(last(result, "x"), 5.0 * 0.75, 1e-9);
  }
}

// A counter of samples divides their frequency; most values of n have been there never before.
TEST(Rounding, CountersDivideFrequencies) {
  Builder b;
  const Term n = b.integer("n", {.start = 0.0, .fixed = true}), x = b.real("x", {.start = 0.0, .fixed = true});
  b.equation(der(x), choose(equal(mod(n, 100.0), 0.0), 200.0, 1.0));
  b.when({{{sample(0.0, 0.005)}, {assign(n, pre(n) + 1.0)}}});
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(last(result, "x"), (198.0 * 1.0 + 2.0 * 200.0) / 200.0, 1e-9);
}

// Only branches that are taken need to be defined.
TEST(Rounding, UndefinedValuesOfOtherBranchesDoNoHarm) {
  Builder b;
  const Term n = b.integer("n", {.start = 0.0, .fixed = true}), x = b.real("x", {.start = 0.0, .fixed = true});
  b.equation(der(x), choose(n > 10.0, mod(5.0, n - 3.0), 1.0));
  b.when({{{sample(0.0, 0.25)}, {assign(n, pre(n) + 1.0)}}});
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(last(result, "x"), 1.0, 1e-10);
}

// A variable that a discrete equation determines is no unknown of a differential equation that stands before it.
TEST(Rounding, DiscreteVariablesMayStandAloneInDifferentialEquations) {
  Builder b;
  const Term n = b.integer("n"), x = b.real("x", {.start = 0.0, .fixed = true});
  b.equation(der(x), n);
  b.equation(n, 7.0);
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(last(result, "x"), 7.0, 1e-10);
}

// sign makes events where values are needed that change at events only: of a state, of time, in other operations.
TEST(Rounding, SignMakesEventsForDiscreteValues) {
  const auto sign = [](const Term& a) { return function(Operation::sign, a); };
  Builder b;
  const Term x = b.real("x", {.start = -1.0, .fixed = true}), y = b.real("y", {.start = 0.0, .fixed = true}),
             z = b.real("z"), n = b.integer("n"), m = b.integer("m"), up = b.boolean("up");
  const Term k = b.integer("k", {.start = 0.0, .fixed = true});
  b.equation(der(x), 2.0);
  b.equation(n, sign(x));
  b.equation(-m, 1.0 + 2.0 * sign(0.3 - time_now()));
  b.equation(z, Term::of(Operation::div, 0.958 * sign(x), -0.6));
  b.equation(up, sign(x) - 0.5 > 0.0);
  b.equation(der(y), choose(equal(sign(x), -1.0), 1.0, 3.0));
  b.when({{{sign(x) > 0.0}, {assign(k, pre(k) + 1.0)}}});
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  for (std::size_t row = 0; row < result.trajectory.t.size(); ++row) {
    const double t = result.trajectory.t[row];
    if (std::fabs(t - 0.3) > 1e-9) {
      EXPECT_EQ(value(result, "m", row), t < 0.3 ? -3.0 : 1.0) << t;
    }
    if (std::fabs(t - 0.5) < 1e-9) continue;
    EXPECT_EQ(value(result, "n", row), t < 0.5 ? -1.0 : 1.0) << t;
    EXPECT_EQ(value(result, "z", row), t < 0.5 ? 1.0 : -1.0) << t;
    EXPECT_EQ(value(result, "up", row), t < 0.5 ? 0.0 : 1.0) << t;
    EXPECT_EQ(value(result, "k", row), t < 0.5 ? 0.0 : 1.0) << t;
  }
  EXPECT_LE(largest_error(result, "y", [](double t) { return t < 0.5 ? t : 3.0 * t - 1.0; }), 1e-7);
}

// It is 0 while its argument is.
TEST(Rounding, SignIsZeroForSomeTime) {
  Builder b;
  const Term x = b.real("x", {.start = 0.0, .fixed = true}), n = b.integer("n");
  b.equation(der(x), choose(time_now() > 0.4, choose(time_now() > 0.8, -3.0, 1.0), 0.0));
  b.equation(n, function(Operation::sign, x));
  const Result result = solve(b.model, until(1.2));
  EXPECT_SOLVED(result);
  for (std::size_t row = 0; row < result.trajectory.t.size(); ++row) {
    const double t = result.trajectory.t[row], zero = 0.8 + 0.4 / 3.0;
    if (std::fabs(t - 0.4) < 1e-6 || std::fabs(t - zero) < 1e-6) continue;
    EXPECT_EQ(value(result, "n", row), t < 0.4 ? 0.0 : t < zero ? 1.0 : -1.0) << t;
  }
}

// In equations of continuous variables it makes none.
TEST(Rounding, SignOfContinuousEquationsMakesNoEvents) {
  Builder b;
  const Term x = b.real("x", {.start = -1.0, .fixed = true}), y = b.real("y");
  b.equation(der(x), 2.0);
  b.equation(y, function(Operation::sign, x));
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_TRUE(result.events.empty());
  EXPECT_EQ(last(result, "y"), 1.0);
}

// An argument that is zero for some time leaves zero within a step that contains an output before that.
TEST(Rounding, ArgumentsThatLeaveZeroWithinSteps) {
  for (const double stop : {1.0, 1.1, 1.2, 1.3, 1.4, 1.5})
    for (const double begin : {-1.0, -0.9}) {
      Builder b;
      const Term x = b.real("x", {.start = 1.0, .fixed = true}), w = b.real("w", {.start = 0.0, .fixed = true}),
                 y = b.integer("y");
      b.equation(der(x), -x);
      b.equation(der(w), y);
      b.equation(y, function(Operation::floor, Term::of(Operation::min, -0.5 * time_now(), 0.0)));
      Settings settings = until(stop);
      settings.start = begin;
      settings.num_outputs = 40;
      const Result result = solve(b.model, settings);
      EXPECT_SOLVED(result);
      EXPECT_LE(largest_error(result, "w", [](double t) { return -std::max(t, 0.0); }), 1e-9)
          << stop << ", " << begin;
    }
}

}  // namespace
}  // namespace sfdae::cli::test
