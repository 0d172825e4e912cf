// Initial values: fixed starts, initial equations, free parameters, too few and too many conditions.
// SPDX-License-Identifier: BSD-3-Clause
#include "model_builder.h"

namespace sfdae::cli::test {
namespace {

// h' = 1 - k sqrt(h): h(0) = 0.5 and h'(0) = 0 determine k = sqrt 2.
TEST(Initialization, FreeParametersFollowFromTheSteadyState) {
  Builder b;
  const Term k = b.free_parameter("k", 1.0), h0 = b.parameter("h0", 0.5), h = b.real("h", {.start = 0.4}),
             qout = b.real("qout");
  b.equation(qout, k * function(Operation::sqrt, h));
  b.equation(der(h), 1.0 - qout);
  b.initial(h, h0);
  b.initial(der(h), 0.0);
  const Result result = solve(b.model, until(5.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(first(result, "k"), std::sqrt(2.0), 1e-9);
  EXPECT_LE(largest_error(result, "h", [](double) { return 0.5; }), 1e-8);
  EXPECT_TRUE(result.warnings.empty()) << joined(result.warnings);
}

// Free parameters are unknowns while initial values are found, but no free values of the model.
TEST(Initialization, FreeParametersAreNotCountedAsFreeValues) {
  Builder b;
  const Term k = b.free_parameter("k", 1.0), h = b.real("h", {.start = 0.4, .fixed = true});
  b.equation(der(h), 1.0 - k * h);
  b.initial(h, 0.5);
  const Result result = analyze(b.model, until(1.0));
  EXPECT_OUTCOME(result, Outcome::not_started);
  EXPECT_EQ(result.num_unknowns, 1);
  EXPECT_EQ(result.characteristics.differential, 1);
}

// A parameter whose binding contains a free one follows it.
TEST(Initialization, ParametersThatDependOnFreeOnesFollow) {
  Builder b;
  const Term k = b.free_parameter("k", 1.0), twice = b.parameter("twice", 2.0 * k),
             x = b.real("x", {.start = 3.0, .fixed = true});
  b.equation(der(x), 6.0 - twice * x);
  b.initial(der(x), 0.0);
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(first(result, "k"), 1.0, 1e-10);
  EXPECT_NEAR(last(result, "x"), 3.0, 1e-9);
}

// All derivatives zero: x = 2, y = 4.
TEST(Initialization, SteadyStateOfSeveralStates) {
  Builder b;
  const Term x = b.real("x", {.start = 1.0}), y = b.real("y", {.start = 1.0});
  b.equation(der(x), 8.0 - x * y);
  b.equation(der(y), square(x) - y);
  b.initial(der(x), 0.0);
  b.initial(der(y), 0.0);
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(first(result, "x"), 2.0, 1e-9);
  EXPECT_NEAR(first(result, "y"), 4.0, 1e-9);
  EXPECT_NEAR(last(result, "x"), 2.0, 1e-7);
}

// x + y = 3 and x y = 2 initially, near (2.2, 1.2): x = 2, y = 1.
TEST(Initialization, NonlinearInitialEquations) {
  Builder b;
  const Term x = b.real("x", {.start = 2.2}), y = b.real("y", {.start = 1.2});
  b.equation(der(x), -x);
  b.equation(der(y), -y);
  b.initial(x + y, 3.0);
  b.initial(x * y, 2.0);
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(first(result, "x"), 2.0, 1e-9);
  EXPECT_NEAR(first(result, "y"), 1.0, 1e-9);
}

// Two states, one condition: the start value of the one that is preferred is used, too.
TEST(Initialization, MissingConditionsAreCompletedByStartValues) {
  Builder b;
  const Term x = b.real("x", {.start = 1.0, .state_select = StateSelect::avoid}), y = b.real("y", {.start = 2.0}),
             z = b.real("z", {.start = 7.0});
  b.equation(der(x), -x);
  b.equation(der(y), -y);
  b.equation(z, x + y);
  b.initial(z, 5.0);
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(first(result, "y"), 2.0, 1e-12);
  EXPECT_NEAR(first(result, "x"), 3.0, 1e-9);
  EXPECT_CONTAINS(joined(result.warnings), "1 initial condition is missing; start values are used: y = 2");
}

TEST(Initialization, RedundantConditionsAreDropped) {
  Builder b;
  const Term x = b.real("x", {.start = 1.0, .fixed = true}), y = b.real("y", {.start = 2.0, .fixed = true}),
             z = b.real("z");
  b.equation(der(x), -x);
  b.equation(y, 2.0 * x);
  b.equation(z, x + y);
  b.initial(z, 3.0);
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(last(result, "y"), 2.0 * std::exp(-1.0), 1e-7);
  EXPECT_CONTAINS(joined(result.warnings), "model.mo:7: the initial condition z = 3 follows from the others");
}

TEST(Initialization, ContradictionsAreNamed) {
  Builder b;
  const Term x = b.real("x", {.start = 1.0, .fixed = true}), z = b.real("z");
  b.equation(der(x), -x);
  b.equation(z, 2.0 * x);
  b.initial(z, 3.0);
  const Result result = solve(b.model, until(1.0));
  EXPECT_OUTCOME(result, Outcome::not_started);
  EXPECT_CONTAINS(result.message, "model.mo:5: the initial condition z = 3 contradicts");
  EXPECT_CONTAINS(result.message, "violated by -1");
}

// Both ends of a rigid connection are fixed to different values.
TEST(Initialization, FixedValuesThatContradictConstraintsAreNamed) {
  Builder b;
  const Term x = b.real("x", {.start = 1.0, .fixed = true}), y = b.real("y", {.start = 0.5, .fixed = true}),
             vx = b.real("vx", {.start = 0.0, .fixed = true}), vy = b.real("vy"), F = b.real("F");
  b.equation(der(x), vx);
  b.equation(der(y), vy);
  b.equation(der(vx), -(F * x));
  b.equation(der(vy), -(F * y) - 9.81);
  b.equation(square(x) + square(y), 1.0);
  const Result result = solve(b.model, until(1.0));
  EXPECT_OUTCOME(result, Outcome::not_started);
  EXPECT_CONTAINS(result.message, "contradicts");
}

// pre() of what a when clause assigns comes from the initial equation; initial() makes a clause act.
TEST(Initialization, DiscreteVariablesHaveInitialEquationsAndInitialClauses) {
  Builder b;
  const Term d = b.discrete("d"), n = b.integer("n", {.start = 3.0}), x = b.real("x", {.start = 0.0, .fixed = true});
  b.equation(der(x), d);
  b.when({{{time_now() >= 1.0}, {assign(d, pre(d) + 1.0)}}});
  b.when({{{initially(), time_now() >= 1.0}, {assign(n, pre(n) + 1.0)}}});
  b.initial(d, 5.0);
  const Result result = solve(b.model, until(2.0));
  EXPECT_SOLVED(result);
  EXPECT_EQ(first(result, "d"), 5.0);
  EXPECT_EQ(first(result, "n"), 4.0);
  EXPECT_EQ(last(result, "n"), 5.0);
  EXPECT_NEAR(last(result, "x"), 11.0, 1e-9);
}

// The branch that holds at the start depends on values that are found there: x = 3, not the guess 0.
TEST(Initialization, RelationsAgreeWithTheValuesFound) {
  Builder b;
  const Term x = b.real("x"), y = b.real("y"), big = b.boolean("big");
  b.equation(der(x), choose(x > 2.0, 1.0, -1.0));
  b.equation(y, choose(big, 10.0, 9.0));
  b.equation(big, x > 2.0);
  b.initial(x + y, 13.0);
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(first(result, "x"), 3.0, 1e-9);
  EXPECT_NEAR(last(result, "x"), 4.0, 1e-9);
}

// Start values can be given from outside, those of fixed states and of guesses.
TEST(Initialization, StartValuesCanBeGiven) {
  Builder b;
  const Term x = b.real("x", {.start = 1.0, .fixed = true});
  b.equation(der(x), -x);
  Settings settings = until(1.0);
  settings.values["x"] = 3.0;
  EXPECT_NEAR(last(solve(b.model, settings), "x"), 3.0 * std::exp(-1.0), 1e-7);
}

// All start values zero, where the constraint of a pendulum is singular.
TEST(Initialization, SingularGuessesAreLeft) {
  Builder b;
  const Term x = b.real("x"), y = b.real("y"), vx = b.real("vx"), vy = b.real("vy"), F = b.real("F");
  b.equation(der(x), vx);
  b.equation(der(y), vy);
  b.equation(der(vx), -(F * x));
  b.equation(der(vy), -(F * y) - 9.81);
  b.equation(square(x) + square(y), 1.0);
  const Result result = analyze(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(std::hypot(first(result, "x"), first(result, "y")), 1.0, 1e-10);
}

// Start values may depend on parameters that initial equations determine: by chains, bindings, roundings and aliases.
TEST(Initialization, StartValuesFollowFreeParameters) {
  Builder b;
  const Term p = b.free_parameter("p", 0.0), q = b.free_parameter("q", 1.0), k = b.parameter("k", 3.0 * p),
             chain = b.real("chain", {.fixed = true}), bound = b.real("bound", {.fixed = true}),
             root = b.real("root"), alias = b.real("alias", {.fixed = true}),
             rounded = b.real("rounded", {.fixed = true}), guessed = b.real("guessed");
  const auto start = [&](const Term& v, const Term& value) { b.model.variables[v.e->index].start = value.e; };
  start(chain, 2.0 * p + q);
  start(bound, k + 1.0);
  start(alias, p);
  start(rounded, Term::of(Operation::floor, q + 0.7));
  start(guessed, p - q);
  for (const Term& v : {chain, bound, root, rounded, guessed}) b.equation(der(v), 0.0 * v);
  b.equation(alias, 1.0 - root);
  b.initial(p, 2.0);
  b.initial(q * q * q, 4.0 * p);
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(first(result, "chain"), 6.0, 1e-9);
  EXPECT_NEAR(first(result, "bound"), 7.0, 1e-9);
  EXPECT_NEAR(first(result, "root"), -1.0, 1e-9);
  EXPECT_NEAR(first(result, "rounded"), 2.0, 1e-9);
  EXPECT_NEAR(first(result, "guessed"), 0.0, 1e-9);  // nothing else determines it
  EXPECT_CONTAINS(joined(result.warnings), "1 initial condition is missing; start values are used: guessed = p - q");
}

// x starts at p, and x' = -3 there: p = 3.
TEST(Initialization, StartValuesMayDetermineFreeParameters) {
  Builder b;
  const Term p = b.free_parameter("p", 0.0), x = b.real("x", {.fixed = true});
  b.model.variables[1].start = p.e;
  b.equation(der(x), -x);
  b.initial(der(x), -3.0);
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(first(result, "p"), 3.0, 1e-9);
  EXPECT_NEAR(last(result, "x"), 3.0 * std::exp(-1.0), 1e-6);
}

// A free parameter that nothing determines has its start value, which may follow others, declared before or after it.
TEST(Initialization, GuessesOfFreeParametersFollowEachOther) {
  for (const bool is_first : {true, false}) {
    Builder b;
    const Term p = is_first ? b.free_parameter("p", 1.0) : Term(0.0), q = b.free_parameter("q", 1.0),
               r = is_first ? p : b.free_parameter("p", 1.0), x = b.real("x", {.fixed = true});
    b.model.variables[q.e->index].start = (2.0 * r).e;
    b.model.variables[x.e->index].start = q.e;
    b.equation(der(x), 0.0 * x);
    b.initial(r, 2.0);
    const Result result = solve(b.model, until(1.0));
    EXPECT_SOLVED(result);
    EXPECT_NEAR(first(result, "q"), 4.0, 1e-9);
    EXPECT_NEAR(first(result, "x"), 4.0, 1e-9);
  }
}

TEST(Initialization, StartValuesOfDiscreteVariablesFollowFreeParameters) {
  Builder b;
  const Term p = b.free_parameter("p", 3.0), u = b.discrete("u", {.fixed = true}),
             x = b.real("x", {.start = 0.0, .fixed = true});
  b.model.variables[1].start = (p + 1.0).e;
  b.equation(der(x), u);
  b.when({{{sample(0.5, 1.0)}, {assign(u, pre(u) + 1.0)}}});
  b.initial(p, 2.0);
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(last(result, "x"), 0.5 * 3.0 + 0.5 * 4.0, 1e-9);
}

TEST(Initialization, GivenStartValuesFollowNothing) {
  Builder b;
  const Term p = b.free_parameter("p", 0.0), x = b.real("x", {.fixed = true});
  b.model.variables[1].start = p.e;
  b.equation(der(x), 0.0 * x);
  b.initial(p, 2.0);
  Settings settings = until(1.0);
  settings.values["x"] = 5.0;
  const Result result = solve(b.model, settings);
  EXPECT_SOLVED(result);
  EXPECT_EQ(first(result, "x"), 5.0);
}

// Small solutions are as accurate as others, from a near or far guess, with every tolerance.
TEST(Initialization, SmallSolutionsAreFound) {
  for (const double tolerance : {1e-4, 1e-10})
    for (const double guess : {2e-9, 1e-9, 1e-3, 1.0}) {
      Builder b;
      const Term a = b.free_parameter("a", guess), x = b.real("x", {.start = guess}), y = b.real("y"),
                 s = b.real("s", {.start = guess});
      b.equation(der(x), 0.0 * x);
      b.equation(der(s), 2e-18 - square(s));
      b.equation(y, 3.0 * x);
      b.initial(square(a), 2e-18);
      b.initial(square(y), 18e-18);
      if (guess < 1e-8) b.initial(der(s), 0.0);
      const Result result = solve(b.model, until(1.0, tolerance));
      EXPECT_SOLVED(result);
      EXPECT_NEAR(first(result, "a"), std::sqrt(2.0) * 1e-9, 1e-17) << guess;
      EXPECT_NEAR(first(result, "x"), std::sqrt(2.0) * 1e-9, 1e-17) << guess;
      if (guess < 1e-8) {
        EXPECT_NEAR(first(result, "s"), std::sqrt(2.0) * 1e-9, 1e-17);
      }
    }
}

// The scale of a is 1e-7, that of b is 1: rows of both equations differ, though not in units of 1.
TEST(Initialization, SmallAndLargeUnknownsTogether) {
  Builder b;
  const Term a = b.free_parameter("a", 1e-7), c = b.free_parameter("c", 1.0),
             x = b.real("x", {.start = 0.0, .fixed = true});
  const Term e = function(Operation::exp, -1e-7 / a);
  b.equation(der(x), 0.0 * x);
  b.initial(e + c, 3.1);
  b.initial(e - c, -2.9);
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(first(result, "a"), 1e-7 / std::log(10.0), 1e-16);
  EXPECT_NEAR(first(result, "c"), 3.0, 1e-9);
}

// Sizes that no nominal value tells: squares underflow, other unknowns are of size 1, a guess is far too small.
TEST(Initialization, SolutionsOfAllSizesAreFound) {
  for (const double size : {1e-100, 1e-30, 1e-15, 1.0, 1e15, 1e40}) {
    Builder b;
    const Term a = b.free_parameter("a", 2.0 * size), c = b.free_parameter("c", 0.0), d = b.free_parameter("d", 1.0),
               x = b.real("x", {.start = 0.0, .fixed = true}), s = b.real("s", {.start = 2.0 * size});
    b.equation(der(x), a + c);
    b.equation(der(s), 0.0 * s);
    b.initial(square(a), 2.0 * size * size);
    b.initial(square(s), 2.0 * size * size);
    b.initial(c, size);
    b.initial(square(d), 2.0);
    const Result result = solve(b.model, until(1.0));
    EXPECT_SOLVED(result);
    EXPECT_NEAR(first(result, "a"), std::sqrt(2.0) * size, 1e-12 * size);
    EXPECT_NEAR(first(result, "s"), std::sqrt(2.0) * size, 1e-12 * size);
    EXPECT_EQ(first(result, "c"), size);
    EXPECT_NEAR(first(result, "d"), std::sqrt(2.0), 1e-12);
    EXPECT_TRUE(result.warnings.empty()) << joined(result.warnings);
  }
}

// Conditions that are not defined at the guess, or nowhere, are not fulfilled.
TEST(Initialization, UndefinedConditionsAreNamed) {
  const Term p(Term::make(Operation::variable, {}, 0.0, 0)), none(0.0);
  const auto with = [&](const Term& left, const Term& right) {
    Builder b;
    b.free_parameter("p", 0.0);
    const Term x = b.real("x", {.start = 1.0, .fixed = true});
    b.equation(der(x), p);
    b.initial(left, right);
    return solve(b.model, until(1.0));
  };
  for (const auto& [left, right] : {std::pair(p, function(Operation::log, Term(-1.0))), std::pair(p, 1.0 / none),
                                    std::pair(p + function(Operation::sqrt, -2.0 + 0.0 * p), Term(1.0)),
                                    std::pair(function(Operation::sqrt, p - 5.0), Term(2.0)),
                                    std::pair(Term::of(Operation::max, p, 1.0 / none), p)}) {
    const Result result = with(left, right);
    EXPECT_OUTCOME(result, Outcome::not_started);
    EXPECT_CONTAINS(result.message, "model.mo:4: the initial condition ");
    EXPECT_CONTAINS(result.message, " is not defined at the start values");
  }
  const Result near = with(function(Operation::log, p), 1.0), inverse_of = with(1.0 / p, 4.0);
  EXPECT_SOLVED(near);
  EXPECT_NEAR(first(near, "p"), std::exp(1.0), 1e-9);
  EXPECT_SOLVED(inverse_of);
  EXPECT_NEAR(first(inverse_of, "p"), 0.25, 1e-9);
}

TEST(Initialization, SmallContradictionsAreNamed) {
  Builder b;
  const Term x = b.real("x", {.start = 1e-9, .fixed = true});
  b.equation(der(x), 0.0 * x);
  b.initial(x, 3e-9);
  const Result result = solve(b.model, until(1.0));
  EXPECT_OUTCOME(result, Outcome::not_started);
  EXPECT_CONTAINS(result.message, "violated by -2e-09");
}

// A start value given for a variable without fixed = true is a guess: a warning says which value replaced it.
TEST(Initialization, GuessesThatAreGivenAndNotKeptAreNamed) {
  for (const double given : {0.3, 2.0}) {
    Builder b;
    const Term x = b.real("x", {.start = 1.0}), y = b.real("y", {.start = 1.0, .fixed = true});
    b.equation(x, 2.0 * y);
    b.equation(der(y), 0.0 * y);
    Settings settings = until(1.0);
    settings.values["x"] = given;
    const Result result = solve(b.model, settings);
    EXPECT_SOLVED(result);
    EXPECT_EQ(first(result, "x"), 2.0);
    const std::string warnings = joined(result.warnings);
    if (given == 2.0) EXPECT_EQ(warnings, "");
    else
      EXPECT_CONTAINS(
          warnings,
          "model.mo:1: the value 0.3 given for x is only a guess, its start value is not fixed; x starts at 2");
  }
}

TEST(Initialization, SmallGuessesThatAreNotKeptAreNamed) {
  Builder b;
  const Term x = b.real("x"), y = b.real("y", {.start = 1.0, .fixed = true});
  b.equation(x, 2e-12 * y);
  b.equation(der(y), 0.0 * y);
  Settings settings = until(1.0);
  settings.values["x"] = 3e-12;
  const Result result = solve(b.model, settings);
  EXPECT_SOLVED(result);
  EXPECT_CONTAINS(joined(result.warnings), "the value 3e-12 given for x is only a guess");
}

// Limits of parameters count, also where free parameters are in them or in the value.
TEST(Initialization, ParametersOutsideOfTheirLimitsAreNamed) {
  Builder b;
  const Term given = b.parameter("given", 5.0), inside = b.parameter("inside", 5.0), p = b.free_parameter("p", 0.0),
             twice = b.parameter("twice", 2.0 * p), x = b.real("x", {.start = 1.0, .fixed = true});
  b.model.variables[0].max = Term(4.0).e;
  b.model.variables[1].max = Term(5.0).e;
  b.model.variables[2].min = Term(4.0).e;
  b.model.variables[3].max = given.e;
  b.model.variables[4].min = p.e;
  b.equation(der(x), 0.0 * x + 0.0 * twice + 0.0 * inside);
  b.initial(p, 3.0);
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  const std::string warnings = joined(result.warnings);
  EXPECT_CONTAINS(warnings, "model.mo:1: parameter given is 5, above max = 4");
  EXPECT_CONTAINS(warnings, "model.mo:3: parameter p is 3 at t = 0, below min = 4");
  EXPECT_CONTAINS(warnings, "model.mo:4: parameter twice is 6 at t = 0, above max = 5");
  EXPECT_CONTAINS(warnings, "model.mo:5: x is 1 at t = 0, below min = 3");
  EXPECT_EQ(warnings.find("inside"), std::string::npos) << warnings;
}

// pre(b) becomes b after the initial values have been found; when clauses that it makes active then are carried out,
// and the row at the start satisfies all equations.
TEST(Initialization, WhenClausesActAsPreTakesItsInitialValue) {
  Builder b;
  const Term x = b.real("x", {.start = 0.0, .fixed = true}), flag = b.boolean("b", {.start = 0.0, .fixed = true}),
             n = b.integer("n", {.start = 0.0, .fixed = true}), d = b.discrete("d", {.start = 1.0, .fixed = true}),
             y = b.real("y"), z = b.real("z");
  b.equation(der(x), 1.0);
  b.equation(flag, x < 2.0);
  b.equation(y, x + 0.5 * z);
  b.equation(z, d - 0.3 * y);
  b.when({{{both(pre(flag), time_now() < 0.7)}, {assign(n, pre(n) + 1.0), assign(d, 3.0), reinit(x, 0.5)}}});
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_EQ(result.trajectory.t[1] > 0.0, true) << "one row at the start";
  EXPECT_EQ(first(result, "n"), 1.0);
  EXPECT_EQ(last(result, "n"), 1.0);
  EXPECT_LE(largest_error(result, "x", [](double t) { return 0.5 + t; }), 1e-8);
  EXPECT_LE(largest_error(result, "y", [](double t) { return (2.0 + t) / 1.15; }), 1e-8);
  EXPECT_LE(largest_error(result, "z", [](double t) { return 3.0 - 0.3 * (2.0 + t) / 1.15; }), 1e-8);
  EXPECT_NEAR(first(analyze(b.model, until(1.0)), "x"), 0.5, 1e-10);
}

// A value that reinit changes there may change relations, and these other when clauses.
TEST(Initialization, WhenClausesAtTheStartChangeRelations) {
  for (const double target : {0.5, 3.0, 5.0}) {
    Builder b;
    const Term x = b.real("x", {.start = 0.0, .fixed = true}), y = b.real("y", {.start = 0.0, .fixed = true}),
               flag = b.boolean("b", {.start = 0.0, .fixed = true}),
               n = b.integer("n", {.start = 0.0, .fixed = true});
    b.equation(der(x), 1.0);
    b.equation(der(y), choose(x > 2.0, 1.0, -1.0));
    b.equation(flag, x < 10.0);
    b.when({{{pre(flag)}, {reinit(x, target)}}});
    b.when({{{x > 4.0}, {assign(n, pre(n) + 1.0)}}});
    const Result result = solve(b.model, until(0.9));
    EXPECT_SOLVED(result);
    EXPECT_EQ(first(result, "n"), target > 4.0 ? 1.0 : 0.0);
    EXPECT_NEAR(first(result, "x"), target, 1e-12);
    EXPECT_NEAR(last(result, "x"), target + 0.9, 1e-8);
    EXPECT_NEAR(last(result, "y"), target > 2.0 ? 0.9 : -0.9, 1e-8);
    EXPECT_EQ(last(result, "n"), target > 4.0 ? 1.0 : 0.0);
  }
}

// A simulation may end there.
TEST(Initialization, TerminateActsAtTheStart) {
  Builder b;
  const Term x = b.real("x", {.start = 0.0, .fixed = true}), flag = b.boolean("b", {.start = 0.0, .fixed = true});
  b.equation(der(x), 1.0);
  b.equation(flag, x < 10.0);
  b.when({{{pre(flag)}, {terminate("at once")}}});
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_EQ(result.message, "at once");
  EXPECT_EQ(result.trajectory.t.back(), 0.0);
}

}  // namespace
}  // namespace sfdae::cli::test
