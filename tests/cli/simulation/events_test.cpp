// Models with events, against exact solutions.
// SPDX-License-Identifier: BSD-3-Clause
#include <functional>
#include <utility>

#include "model_builder.h"

namespace sfdae::cli::test {
namespace {

constexpr double g = 9.81;

// Falls from h = 1; each impact takes the part 1 - e of the velocity. The first impact is at sqrt(2/g), the k-th one 2
// e^k sqrt(2/g) after the one before.
Builder bouncing_ball(double vmin) {
  Builder b;
  const Term h = b.real("h", {.start = 1.0, .fixed = true}), v = b.real("v", {.start = 0.0, .fixed = true});
  const Term vnew = b.discrete("vnew", {.start = 0.0, .fixed = true}),
             n = b.integer("n", {.start = 0.0, .fixed = true});
  const Term flying = b.boolean("flying", {.start = 1.0, .fixed = true}), impact = b.boolean("impact");
  b.equation(der(h), v);
  b.equation(der(v), choose(flying, -g, 0.0));
  b.equation(impact, both(h <= 0.0, v < 0.0));
  const Term speed = 0.7 * function(Operation::abs, pre(v));
  b.when({{{impact},
           {assign(vnew, choose(speed > vmin, -0.7 * pre(v), 0.0)), assign(flying, vnew > 0.0),
            assign(n, pre(n) + 1.0), reinit(v, vnew)}}});
  return b;
}

TEST(Events, BouncingBallHitsAtExactTimes) {
  const Result result = solve(bouncing_ball(1e-3).model, until(3.0, 1e-10));
  EXPECT_SOLVED(result);
  std::vector<double> impacts;
  for (std::size_t k = 1; k < result.trajectory.t.size(); ++k)
    if (value(result, "n", k) != value(result, "n", k - 1)) {
      EXPECT_EQ(result.trajectory.t[k], result.trajectory.t[k - 1]) << "two rows at an event";
      impacts.push_back(result.trajectory.t[k]);
    }
  // v after impact k is 0.7^k sqrt(2 g): the first one not above 1e-3 is that of k = 24.
  ASSERT_EQ(impacts.size(), 24u);
  double t = std::sqrt(2.0 / g);
  for (std::size_t k = 0; k < impacts.size(); ++k) {
    EXPECT_NEAR(impacts[k], t, 1e-8);
    t += 2.0 * std::pow(0.7, static_cast<double>(k) + 1.0) * std::sqrt(2.0 / g);
  }
  EXPECT_NEAR(impacts[0], std::sqrt(2.0 / g), 1e-12);
  EXPECT_EQ(last(result, "flying"), 0.0);
  EXPECT_NEAR(last(result, "h"), 0.0, 1e-8);
  EXPECT_EQ(last(result, "v"), 0.0);
}

TEST(Events, ImpactsThatNeverEndAreNamed) {
  const Result result = solve(bouncing_ball(0.0).model, until(3.0));
  EXPECT_OUTCOME(result, Outcome::not_finished);
  EXPECT_CONTAINS(result.message, "events accumulate at t = 2.5586");  // sqrt(2/g) (1 + 2 * 0.7 / 0.3)
  EXPECT_CONTAINS(result.message, "when impact");
}

// Series RLC, voltage step at t0 = 1e-4: underdamped, vC = V (1 - e^(-a s) (cos w s + a/w sin w s)), s = t - t0.
TEST(Events, RlcCircuitSwitchesAtAKnownTime) {
  Builder b;
  const double R = 10.0, L = 1e-3, C = 1e-6, V = 24.0, t0 = 1e-4;
  const Term i = b.real("i", {.start = 0.0, .fixed = true, .nominal = 0.1}),
             vC = b.real("vC", {.start = 0.0, .fixed = true, .nominal = 10.0}), vR = b.real("vR"), vL = b.real("vL"),
             vs = b.real("vs");
  b.equation(vs, choose(time_now() < t0, 0.0, V));
  b.equation(vs, vR + vL + vC);
  b.equation(vR, R * i);
  b.equation(L * der(i), vL);
  b.equation(i, C * der(vC));
  const Result result = solve(b.model, until(2e-3, 1e-9));
  EXPECT_SOLVED(result);
  const double a = R / (2.0 * L), w = std::sqrt(1.0 / (L * C) - a * a);
  const auto exact = [&](double t) {
    const double s = std::max(0.0, t - t0);
    return V * (1.0 - std::exp(-a * s) * (std::cos(w * s) + a / w * std::sin(w * s)));
  };
  EXPECT_LE(largest_error(result, "vC", exact), 1e-6);
  ASSERT_EQ(result.events.size(), 1u);
  EXPECT_EQ(result.events[0].t, t0);
  EXPECT_EQ(result.characteristics.differential, 2);
}

// A two-point controller: x' = -1 while off, +1 while on, on at 0, off at 1: a triangle of period 2.
TEST(Events, HysteresisUsesPreviousValues) {
  Builder b;
  const Term x = b.real("x", {.start = 0.5, .fixed = true}), on = b.boolean("on", {.start = 0.0, .fixed = true});
  b.equation(der(x), choose(on, 1.0, -1.0));
  b.equation(on, either(x < 0.0, both(pre(on), x < 1.0)));
  const Result result = solve(b.model, until(5.0));
  EXPECT_SOLVED(result);
  const auto triangle = [](double t) {
    const double s = std::fmod(t + 0.5, 2.0);  // 1 at s = 0, 0 at s = 1
    return std::fabs(1.0 - s);
  };
  EXPECT_LE(largest_error(result, "x", triangle), 1e-7);
  int num_changes = 0;
  for (std::size_t k = 1; k < result.trajectory.t.size(); ++k)
    if (value(result, "on", k) != value(result, "on", k - 1)) ++num_changes;
  EXPECT_EQ(num_changes, 5);
}

TEST(Events, SamplesCountFromTheirStart) {
  Builder b;
  const Term n = b.integer("n", {.start = 0.0, .fixed = true}), x = b.real("x", {.start = 0.0, .fixed = true}),
             held = b.discrete("held", {.start = 0.0, .fixed = true});
  b.equation(der(x), 1.0);
  b.when({{{sample(0.0, 0.25)}, {assign(n, pre(n) + 1.0), assign(held, x)}}});
  const Result result = solve(b.model, until(1.1));
  EXPECT_SOLVED(result);
  EXPECT_EQ(last(result, "n"), 5.0);  // 0, 0.25, 0.5, 0.75, 1
  EXPECT_NEAR(last(result, "held"), 1.0, 1e-12);
  EXPECT_EQ(result.events.size(), 5u);
}

// Sampled control: x' = u, u = -x at the sample instants: x is multiplied by 1 - h in each interval.
TEST(Events, SampledRealsEnterEquations) {
  Builder b;
  const Term x = b.real("x", {.start = 1.0, .fixed = true}), u = b.discrete("u", {.start = 0.0, .fixed = true});
  b.equation(der(x), u);
  b.when({{{sample(0.0, 0.5)}, {assign(u, -x)}}});
  const Result result = solve(b.model, until(2.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(last(result, "x"), std::pow(0.5, 4), 1e-9);
}

// Values that when clauses assign fulfil all equations of that instant, also those with other assigned variables:
// y = n + 0.4 z, z = x + 0.5 y, so 0.8 y = n + 0.4 x. The held value w is part of its own equation v + sin(v) = w.
TEST(Events, AssignedValuesFollowUnknownsOfTheSameInstant) {
  for (const double size : {1.0, 1e-15}) {
    Builder b;
    const Term x = b.real("x", {.start = 0.0, .fixed = true}), y = b.real("y"), z = b.real("z"), v = b.real("v"),
               n = b.integer("n", {.start = 0.0, .fixed = true}),
               held = b.discrete("held", {.start = 0.0, .fixed = true}),
               sum = b.discrete("sum", {.start = 0.0, .fixed = true}),
               w = b.discrete("w", {.start = 0.0, .fixed = true});
    b.equation(der(x), 1.0);
    b.equation(y, n + 0.4 * z);
    b.equation(z, x + 0.5 * y);
    b.equation(v + function(Operation::sin, v), w / size);
    b.when({{{sample(0.25, 0.5)}, {assign(n, pre(n) + 1.0)}}});
    b.when({{{sample(0.25, 0.5)},
             {assign(held, size * y), assign(sum, pre(sum) + size * z), assign(w, size * (0.5 * v + 1.0))}}});
    const Result result = solve(b.model, until(1.0));
    EXPECT_SOLVED(result);
    const auto y_of = [](double k, double t) { return (k + 0.4 * t) / 0.8; };
    EXPECT_NEAR(last(result, "held") / size, y_of(2.0, 0.75), 1e-9);
    EXPECT_NEAR(last(result, "sum") / size, 0.25 + 0.5 * y_of(1.0, 0.25) + 0.75 + 0.5 * y_of(2.0, 0.75), 1e-9);
    EXPECT_NEAR(last(result, "w") / size, 0.5 * last(result, "v") + 1.0, 1e-11);
  }
}

// At t = 1 both conditions become true: the first branch acts alone.
TEST(Events, ElsewhenActsOnlyIfTheOthersDoNot) {
  Builder b;
  const Term a = b.integer("a", {.start = 0.0, .fixed = true});
  const Term t = time_now();
  b.when({{{t >= 1.0}, {assign(a, pre(a) + 1.0)}}, {{t >= 1.0, t >= 2.0}, {assign(a, pre(a) + 10.0)}}});
  const Result result = solve(b.model, until(3.0));
  EXPECT_SOLVED(result);
  EXPECT_EQ(last(result, "a"), 11.0);
}

// Two balls that hit at the same time, one event; a chain of whens at one instant, in one event iteration.
TEST(Events, SimultaneousEventsAreOne) {
  Builder b;
  const Term x = b.real("x", {.start = 1.0, .fixed = true}), y = b.real("y", {.start = 2.0, .fixed = true}),
             n = b.integer("n", {.start = 0.0, .fixed = true}), m = b.integer("m", {.start = 0.0, .fixed = true}),
             k = b.integer("k", {.start = 0.0, .fixed = true});
  b.equation(der(x), -1.0);
  b.equation(der(y), -2.0);
  b.when({{{x < 0.0}, {assign(n, pre(n) + 1.0), reinit(x, 1.0)}}});
  b.when({{{y < 0.0}, {assign(m, pre(m) + 1.0), reinit(y, 2.0)}}});
  b.when({{{pre(n) > 1.5}, {assign(k, n + m)}}});
  const Result result = solve(b.model, until(3.5));
  EXPECT_SOLVED(result);
  EXPECT_EQ(result.events.size(), 3u);
  EXPECT_EQ(last(result, "n"), 3.0);
  EXPECT_EQ(last(result, "m"), 3.0);
  EXPECT_EQ(last(result, "k"), 4.0);
  EXPECT_NEAR(last(result, "x"), 0.5, 1e-9);
}

// floor(t^2) jumps at sqrt(k): x = sum of (t - sqrt k).
TEST(Events, FloorJumpsAtIntegers) {
  Builder b;
  const Term x = b.real("x", {.start = 0.0, .fixed = true});
  b.equation(der(x), function(Operation::floor, square(time_now())));
  const Result result = solve(b.model, until(2.5));
  EXPECT_SOLVED(result);
  double exact = 0.0;
  for (int k = 1; k <= 6; ++k) exact += 2.5 - std::sqrt(static_cast<double>(k));
  EXPECT_NEAR(last(result, "x"), exact, 1e-9);
  EXPECT_EQ(result.events.size(), 6u);
}

// mod(x, 1) of x = t: a saw tooth, and rem of a falling argument.
TEST(Events, ModAndRemJump) {
  Builder b;
  const Term x = b.real("x", {.start = 0.5, .fixed = true}), saw = b.real("saw"), rest = b.real("rest");
  b.equation(der(x), -1.0);
  b.equation(saw, Term::of(Operation::mod, x, 1.0));
  b.equation(rest, Term::of(Operation::rem, x, 1.0));
  const Result result = solve(b.model, until(2.4));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(last(result, "saw"), 0.1, 1e-9);    // mod(-1.9, 1)
  EXPECT_NEAR(last(result, "rest"), -0.9, 1e-9);  // rem(-1.9, 1)
  EXPECT_EQ(result.events.size(), 2u);            // floor at x = 0, floor and trunc at x = -1
}

TEST(Events, TerminateEndsWithItsMessage) {
  Builder b;
  const Term x = b.real("x", {.start = 0.0, .fixed = true});
  b.equation(der(x), 2.0);
  b.when({{{x > 1.0}, {terminate("far enough")}}});
  const Result result = solve(b.model, until(3.0));
  EXPECT_SOLVED(result);
  EXPECT_EQ(result.message, "far enough");
  EXPECT_NEAR(result.trajectory.t.back(), 0.5, 1e-12);
}

TEST(Events, AssertionsEndOrWarnAtTheirTime) {
  Builder b;
  const Term x = b.real("x", {.start = 0.0, .fixed = true});
  b.equation(der(x), 2.0);
  b.assertion(x < 1.0, "is large", false);
  b.assertion(x < 2.0, "too large");
  const Result result = solve(b.model, until(3.0));
  EXPECT_OUTCOME(result, Outcome::not_finished);
  EXPECT_CONTAINS(result.message, "model.mo:4: assertion failed at t = 1: too large");
  EXPECT_CONTAINS(joined(result.warnings), "model.mo:3: assertion failed at t = 0.5: is large");
}

TEST(Events, BoundsAreWatched) {
  Builder b;
  const Term x = b.real("x", {.start = 0.0, .fixed = true, .max = 1.0});
  b.equation(der(x), 2.0);
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_EQ(result.warnings.size(), 1u);
  EXPECT_CONTAINS(joined(result.warnings), "x is 1.04 at t = 0.52, above max = 1");
}

// x' = -1 above zero, +1 below: the solution slides along x = 0, which these equations cannot say.
TEST(Events, ChatteringIsNamed) {
  Builder b;
  const Term x = b.real("x", {.start = 1.0, .fixed = true});
  b.equation(der(x), choose(x > 0.0, -1.0, 1.0));
  const Result result = solve(b.model, until(3.0));
  EXPECT_OUTCOME(result, Outcome::not_finished);
  EXPECT_CONTAINS(result.message, "events accumulate at t = 1,");
  EXPECT_CONTAINS(result.message, "x > 0 becomes");
}

// A relation that touches zero does not change: x = (t - 1)^2 > 0 but for one point.
TEST(Events, TouchingZeroChangesNothingForLong) {
  Builder b;
  const Term x = b.real("x", {.start = 1.0, .fixed = true}), y = b.real("y", {.start = 0.0, .fixed = true});
  b.equation(der(x), 2.0 * (time_now() - 1.0));
  b.equation(der(y), choose(x >= 0.0, 1.0, 100.0));
  const Result result = solve(b.model, until(2.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(last(result, "y"), 2.0, 1e-3);
}

// What stays zero and then leaves it: x = max(0, t - 1), y' = 1 from there on.
TEST(Events, LeavingZeroIsAnEvent) {
  Builder b;
  const Term x = b.real("x"), y = b.real("y", {.start = 0.0, .fixed = true});
  b.equation(x, Term::of(Operation::max, 0.0, time_now() - 1.0));
  b.equation(der(y), choose(x > 0.0, 1.0, 0.0));
  const Result result = solve(b.model, until(3.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(last(result, "y"), 2.0, 1e-7);
}

// A threshold that is moved by the event that it makes: x = t passes 1, 2, 3 ...; a second relation changes its sign
// with the threshold, without passing zero.
TEST(Events, ThresholdsMayBeDiscrete) {
  Builder b;
  const Term x = b.real("x", {.start = 0.5, .fixed = true}), next = b.discrete("next", {.start = 1.0, .fixed = true}),
             n = b.integer("n", {.start = 0.0, .fixed = true}), m = b.integer("m", {.start = 0.0, .fixed = true});
  b.equation(der(x), 1.0);
  b.when({{{x >= pre(next)}, {assign(next, pre(next) + 1.0)}}});
  b.when({{{x > next - 0.5}, {assign(n, pre(n) + 1.0)}}});
  b.when({{{x < next - 0.5}, {assign(m, pre(m) + 1.0)}}});
  const Result result = solve(b.model, until(4.25));  // x = 4.75
  EXPECT_SOLVED(result);
  EXPECT_EQ(last(result, "next"), 5.0);
  EXPECT_EQ(last(result, "n"), 5.0);  // right after the start, where 0.5 > 0.5 begins to hold, at 1.5, 2.5, 3.5, 4.5
  EXPECT_EQ(last(result, "m"), 4.0);  // at 1, 2, 3, 4
}

// floor only counts, in a discrete equation: nothing of the integration changes.
TEST(Events, FloorInDiscreteEquations) {
  Builder b;
  const Term x = b.real("x", {.start = 0.0, .fixed = true}), n = b.integer("n", {.start = 0.0, .fixed = true});
  b.equation(der(x), 1.0);
  b.equation(n, function(Operation::integer, 3.0 * function(Operation::sin, x)));
  const Result result = solve(b.model, until(2.0 * std::acos(-1.0)));
  EXPECT_SOLVED(result);
  for (std::size_t k = 1; k < result.trajectory.t.size(); ++k) {
    if (result.trajectory.t[k] == result.trajectory.t[k - 1]) continue;
    const double argument = 3.0 * std::sin(result.trajectory.t[k]);
    const bool is_clear = std::fabs(argument - std::round(argument)) > 1e-6;
    EXPECT_TRUE(!is_clear || value(result, "n", k) == std::floor(argument)) << result.trajectory.t[k];
  }
}

TEST(Events, ReinitOfWhatIsNoStateIsNamed) {
  Builder b;
  const Term x = b.real("x", {.start = 0.0, .fixed = true}), y = b.real("y");
  b.equation(der(x), 1.0);
  b.equation(y, 2.0 * x);
  b.when({{{x > 1.0}, {reinit(y, 0.0)}}});
  const Result result = solve(b.model, until(2.0));
  EXPECT_OUTCOME(result, Outcome::invalid_model);
  EXPECT_CONTAINS(result.message, "reinit of y, whose derivative occurs nowhere");
}

// The source of a bridge of diodes with leakage: two of them switch at one instant, and their voltages there are
// rounding errors of currents over a small conductance. The capacitor of 1 mF is charged to nearly the amplitude.
TEST(Events, DiodesThatSwitchTogetherDoNotChatter) {
  Builder b;
  const double Goff = 1e-5, Ron = 0.01;
  std::vector<Term> u, i;
  for (int k = 0; k < 4; ++k) {
    const std::string n = std::to_string(k);
    const Term s = b.real("s" + n), uk = b.real("u" + n), ik = b.real("i" + n), off = b.boolean("off" + n);
    b.equation(off, s < 0.0);
    b.equation(uk, s * choose(off, 1.0, Ron));
    b.equation(ik, s * choose(off, Goff, 1.0));
    u.push_back(uk);
    i.push_back(ik);
  }
  const Term v = b.real("v"), is = b.real("is"), a = b.real("a"), c = b.real("c"),
             vC = b.real("vC", {.start = 5.0, .fixed = true});
  b.equation(v, 20.0 * function(Operation::sin, 314.1592653589793 * time_now() + 0.2));
  b.equation(a - c, v - is);
  b.equation(u[0], a - vC);
  b.equation(u[1], c - vC);
  b.equation(u[2], -a);
  b.equation(u[3], -c);
  b.equation(is + i[2], i[0]);
  b.equation(i[3], is + i[1]);
  b.equation(1e-3 * der(vC), i[0] + i[1] - vC / 50.0);
  const Result result = solve(b.model, until(0.1));
  EXPECT_SOLVED(result);
  // In every row each diode blocks or conducts, and Kirchhoff's law holds; twice a period the capacitor is charged.
  for (std::size_t k = 0; k < result.trajectory.t.size(); ++k)
    for (int d = 0; d < 4; ++d) {
      const std::string n = std::to_string(d);
      EXPECT_LE(value(result, "u" + n, k), Ron * value(result, "i" + n, k) + 1e-7);
      EXPECT_GE(value(result, "i" + n, k), Goff * value(result, "u" + n, k) - 1e-7);
    }
  EXPECT_GT(last(result, "vC"), 14.0);
  EXPECT_LT(last(result, "vC"), 20.0);
  EXPECT_LT(result.events.size(), 100u);
}

// x' = value of a relation or rounding of time that changes at 0, from before, at and after 0; the end is 1.
struct AtZero {
  const char* name;
  std::function<Term()> slope;
  double before, after;  // mean values on (-1, 0) and (0, 1)
};

class TimeIsZero : public testing::TestWithParam<AtZero> {};

TEST_P(TimeIsZero, RelationsChangeThere) {
  for (const double start : {-1.0, -0.3, 0.0, 0.5}) {
    Builder b;
    const Term x = b.real("x", {.start = 0.0, .fixed = true});
    b.equation(der(x), choose(time_now() < -0.3, 0.0, GetParam().slope()));
    Settings settings = until(1.0);
    settings.start = start;
    const Result result = solve(b.model, settings);
    EXPECT_SOLVED(result);
    const double expected =
        GetParam().before * std::min(0.3, std::max(0.0, -start)) + GetParam().after * (1.0 - std::max(0.0, start));
    EXPECT_NEAR(last(result, "x"), expected, 1e-10) << "from " << start;
    for (const HappenedEvent& event : result.events)
      EXPECT_TRUE(std::fabs(event.t) < 1e-15 || event.t == -0.3) << event.text;
  }
}

Term rounded(Operation operation, const Term& a) { return Term::of(operation, a); }

INSTANTIATE_TEST_SUITE_P(
    Relations, TimeIsZero,
    testing::Values(AtZero{"greater", [] { return choose(time_now() > 0.0, 1.0, 0.0); }, 0.0, 1.0},
                    AtZero{"greater_equal", [] { return choose(time_now() >= 0.0, 1.0, 0.0); }, 0.0, 1.0},
                    AtZero{"less", [] { return choose(time_now() < 0.0, 5.0, 1.0); }, 5.0, 1.0},
                    AtZero{"less_equal", [] { return choose(time_now() <= 0.0, 5.0, 1.0); }, 5.0, 1.0},
                    AtZero{"falling", [] { return choose(-3.0 * time_now() < 0.0, 1.0, 0.0); }, 0.0, 1.0},
                    AtZero{"zero_first", [] { return choose(Term(0.0) < time_now(), 1.0, 0.0); }, 0.0, 1.0},
                    AtZero{"zero_by_rounding", [] { return choose(time_now() > Term(0.3) - 0.1 - 0.2, 1.0, 0.0); },
                           0.0, 1.0},
                    AtZero{"floor", [] { return rounded(Operation::floor, 0.9 * time_now()); }, -1.0, 0.0},
                    AtZero{"floor_falling", [] { return rounded(Operation::floor, -0.9 * time_now()); }, 0.0, -1.0},
                    AtZero{"ceil", [] { return rounded(Operation::ceil, 0.9 * time_now()); }, 0.0, 1.0},
                    AtZero{"integer", [] { return rounded(Operation::integer, -0.9 * time_now()); }, 0.0, -1.0}),
    [](const auto& instance) { return std::string(instance.param.name); });

// mod(-t, 1) = 1 - t on (0, 1).
TEST(Events, ModOfFallingTimeJumpsAtZero) {
  Builder b;
  const Term y = b.real("y"), x = b.real("x", {.start = 0.0, .fixed = true});
  b.equation(y, Term::of(Operation::mod, -time_now(), 1.0));
  b.equation(der(x), y);
  const Result result = solve(b.model, until(0.9));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(last(result, "y"), 0.1, 1e-12);
  EXPECT_NEAR(last(result, "x"), 0.9 - 0.405, 1e-8);
}

TEST(Events, WhenTimePassesZero) {
  for (const double start : {-1.0, 0.0}) {
    Builder b;
    const Term n = b.integer("n", {.start = 0.0, .fixed = true}), m = b.integer("m", {.start = 0.0, .fixed = true}),
               next = b.discrete("next", {.start = 0.0, .fixed = true});
    b.when({{{time_now() > 0.0}, {assign(n, pre(n) + 1.0)}}});
    b.when({{{time_now() > pre(next)}, {assign(m, pre(m) + 1.0), assign(next, pre(next) + 0.25)}}});
    Settings settings = until(0.9);
    settings.start = start;
    const Result result = solve(b.model, settings);
    EXPECT_SOLVED(result);
    EXPECT_EQ(last(result, "n"), 1.0);
    EXPECT_EQ(last(result, "m"), 4.0);  // 0, 0.25, 0.5, 0.75
  }
}

// A sample at the start that is there but for rounding: 0.07 / 0.01 is a little more than 7.
TEST(Events, SamplesAtTheStartAreNotLostByRounding) {
  for (const auto& [begin, interval] :
       {std::make_pair(-0.07, 0.01), {-0.14, 0.02}, {-0.6, 0.2}, {-0.7, 0.1}, {-0.28, 0.01}, {-1e6, 0.1}}) {
    Builder b;
    const Term n = b.integer("n", {.start = 0.0, .fixed = true});
    b.when({{{sample(begin, interval)}, {assign(n, pre(n) + 1.0)}}});
    const Result result = solve(b.model, until(0.5 * interval));
    EXPECT_SOLVED(result);
    EXPECT_EQ(last(result, "n"), 1.0) << begin << ", " << interval;
  }
}

// Steps that end at an output but for rounding, and events at which nothing happens, are no reason to leave it out.
TEST(Events, NoOutputIsLost) {
  for (const double stop : {1.0, 1.3, 2.0, 2.1, 7.0}) {
    Builder b;
    const Term x = b.real("x", {.start = 1.0, .fixed = true}), y = b.real("y", {.start = 0.0, .fixed = true}),
               far = b.boolean("far");
    b.equation(der(x), -0.1 * x);
    b.equation(der(y), 1.0);
    b.equation(far, either(x<0.1, function(Operation::abs, y - 0.2 * stop)> stop));
    const Result result = solve(b.model, until(stop));
    EXPECT_SOLVED(result);
    ASSERT_EQ(result.trajectory.t.size(), 51u) << stop;
    for (std::size_t k = 0; k < 51; ++k)
      EXPECT_NEAR(result.trajectory.t[k], stop * static_cast<double>(k) / 50.0, 1e-14 * stop);
    EXPECT_LE(largest_error(result, "x", [](double t) { return std::exp(-0.1 * t); }), 1e-6);
  }
}

// At the event where sqrt(x) ends, the row before it is just outside of its domain: the limit stands there.
TEST(Events, BranchesEndWithTheirDomains) {
  for (const double offset : {0.0, 0.1, 0.3}) {
    Builder b;
    const Term x = b.real("x", {.start = 1.0 + offset, .fixed = true}), y = b.real("y");
    b.equation(der(x), -2.0);
    b.equation(y, choose(x > 0.0, function(Operation::sqrt, x), 0.0));
    const Result result = solve(b.model, until(1.0));
    EXPECT_SOLVED(result);
    const auto exact = [&](double t) { return std::sqrt(std::max(0.0, 1.0 + offset - 2.0 * t)); };
    EXPECT_LE(largest_error(result, "y", exact), 1e-4);
    ASSERT_EQ(result.events.size(), 1u);
  }
}

// Internal steps end within rounding of times at which something is due, often where roots limit them to a hundredth of
// the interval: everything happens nevertheless. k counts the times 0.03 + 0.12 i.
TEST(Events, NothingIsLostWithinRoundingOfSteps) {
  for (const auto& [rate, offset] : {std::make_pair(3.0, 0.37), {0.5, 0.37}, {20.0, 0.1}, {-10.0, 0.2}})
    for (const double stop : {0.9, 1.3, 2.1, 2.7}) {
      SCOPED_TRACE(testing::Message() << rate << ", " << stop);
      Builder b;
      const Term x = b.real("x", {.start = 1.0, .fixed = true}), far = b.boolean("far"), n = b.integer("n");
      const Term k = b.integer("k", {.start = 0.0, .fixed = true});
      const Term next = b.discrete("next", {.start = 0.03, .fixed = true});
      b.equation(der(x), -0.747 * x);
      b.equation(far, x > 10.0);
      b.equation(n, function(Operation::floor, rate * time_now() + offset));
      b.when({{{time_now() >= pre(next)}, {assign(next, pre(next) + 0.12), assign(k, pre(k) + 1.0)}}});
      Settings settings = until(stop);
      settings.num_outputs = 40;
      const Result result = solve(b.model, settings);
      EXPECT_SOLVED(result);
      const auto check = [&](const std::string& name, std::size_t row, const std::function<double(double)>& exact) {
        const double t = result.trajectory.t[row], from = exact(t - 1e-9), to = exact(t + 1e-9);
        const double found = value(result, name, row);
        EXPECT_TRUE(found == from || found == to) << name << " = " << found << " at t = " << t << ", exact: " << to;
      };
      for (std::size_t row = 0; row < result.trajectory.t.size(); ++row) {
        check("n", row, [r = rate, o = offset](double t) { return std::floor(r * t + o); });
        check("k", row, [](double t) { return std::max(0.0, std::floor((t - 0.03) / 0.12) + 1.0); });
      }
    }
}

// floor(rem(time, ...)) has other values for a moment in the iteration of an event, then those from before.
TEST(Events, EquationsThatReturnInAnEventAreIntegratedAnew) {
  for (const double begin : {-1.0, -0.3}) {
    Builder b;
    const Term x = b.real("x", {.start = 0.0, .fixed = true}), y = b.real("y", {.start = 0.2, .fixed = true}),
               far = b.boolean("far");
    const Term sawtooth = Term::of(Operation::rem, 0.25 - time_now(), 0.7);
    b.equation(der(x), function(Operation::floor, sawtooth) + 1.0);
    b.equation(der(y), -y);
    b.equation(far, y > 0.1);
    Settings settings = until(1.1);
    settings.start = begin;
    const Result result = solve(b.model, settings);
    EXPECT_SOLVED(result);
    // floor is 0 until t = 0.25, -1 from there on to 0.95 and beyond.
    EXPECT_LE(largest_error(result, "x", [&](double t) { return std::min(t, 0.25) - begin; }), 1e-7);
  }
}

// The argument of the relation is not what reinit changes: it stays where it is, and acts once.
TEST(Events, ReinitOfAnotherStateActsOnce) {
  for (double threshold = 0.05; threshold < 0.36; threshold += 0.01) {
    Builder b;
    const Term x = b.real("x", {.start = 0.0, .fixed = true}), v = b.real("v", {.start = 0.3, .fixed = true}),
               z = b.real("z", {.start = 1.0, .fixed = true}), n = b.integer("n", {.start = 0.0, .fixed = true});
    b.equation(der(x), function(Operation::cos, 1.487 * time_now()) - 0.9 * x);
    b.equation(der(v), -v - 0.2 * n);
    b.equation(der(z), 0.5);
    b.when({{{x - 0.3 * v > threshold}, {assign(n, pre(n) + 1.0), reinit(z, -0.277 * pre(z))}}});
    const Result result = solve(b.model, until(1.0));
    EXPECT_SOLVED(result);
    EXPECT_EQ(last(result, "n"), 1.0) << threshold;
    ASSERT_EQ(result.events.size(), 1u) << threshold;
    const double t = result.events[0].t;
    EXPECT_NEAR(last(result, "z"), -0.277 * (1.0 + 0.5 * t) + 0.5 * (1.0 - t), 1e-8) << threshold;
  }
}

// If differential equations end with the branch that they stand in, no step leads beyond the event: z' = sqrt(x)
// while x > 0.
TEST(Events, DifferentialEquationsEndWithTheirBranches) {
  for (const double offset : {0.0, 0.1, 0.3, 0.43})
    for (const double slope : {2.0, 1.7, 30.0}) {
      Builder b;
      const Term x = b.real("x", {.start = 1.0 + offset, .fixed = true}),
                 z = b.real("z", {.start = 0.0, .fixed = true});
      b.equation(der(x), -slope);
      b.equation(der(z), choose(x > 0.0, function(Operation::sqrt, x), -1.0));
      const Result result = solve(b.model, until(1.0, 1e-6));
      EXPECT_SOLVED(result);
      const double end = (1.0 + offset) / slope, whole = 2.0 / 3.0 * std::pow(1.0 + offset, 1.5) / slope;
      const auto exact = [&](double t) {
        const double left = 1.0 + offset - slope * t;
        return left > 0.0 ? whole - 2.0 / 3.0 * std::pow(left, 1.5) / slope : whole - (t - end);
      };
      EXPECT_LE(largest_error(result, "z", exact), 1e-5) << offset << ", " << slope;
      EXPECT_EQ(result.events.size(), 1u);
    }
}

// An equation that ends elsewhere still ends the run.
TEST(Events, EquationsThatEndWithoutAnEventAreNamed) {
  for (const double threshold : {0.5, 0.0, -0.1}) {
    Builder b;
    const Term x = b.real("x", {.start = 1.0, .fixed = true}), z = b.real("z", {.start = 0.0, .fixed = true});
    b.equation(der(x), -2.0);
    b.equation(der(z), choose(x > threshold, 1.0, 2.0) + function(Operation::sqrt, x));
    const Result result = solve(b.model, until(1.0));
    EXPECT_OUTCOME(result, Outcome::not_finished);
    EXPECT_CONTAINS(result.message, "sqrt of -");
    EXPECT_NEAR(result.trajectory.t.back(), 0.5, 0.03);
  }
}

}  // namespace
}  // namespace sfdae::cli::test
