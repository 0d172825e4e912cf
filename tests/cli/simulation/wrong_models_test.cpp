// Models with mistakes: each is named.
// SPDX-License-Identifier: BSD-3-Clause
#include "model_builder.h"

namespace sfdae::cli::test {
namespace {

std::string complaint(const FlatModel& model, const Settings& settings = until(1.0)) {
  const Result result = solve(model, settings);
  EXPECT_OUTCOME(result, Outcome::invalid_model);
  return result.message;
}

TEST(WrongModels, TooFewEquations) {
  Builder b;
  const Term x = b.real("x"), y = b.real("y"), z = b.real("z");
  b.equation(der(x), y);
  b.equation(x, function(Operation::sin, time_now()));
  EXPECT_CONTAINS(complaint(b.model), "2 equations for 3 continuous unknowns; no equation contains z");
  b.model.equations.pop_back();
  b.equation(z + y, 1.0);
  b.equation(z - y, 1.0);
  b.equation(z + 2.0 * y, 1.0);
  EXPECT_CONTAINS(complaint(b.model), "4 equations for 3 continuous unknowns");
}

TEST(WrongModels, NothingIsLeftForAnUnknown) {
  Builder b;
  const Term x = b.real("x"), y = b.real("y"), z = b.real("z");
  b.equation(x, 1.0);
  b.equation(y + z, x);
  const std::string text = complaint(b.model);
  EXPECT_CONTAINS(text, "2 equations for 3 continuous unknowns; nothing is left to determine");
}

TEST(WrongModels, EquationsThatContradict) {
  Builder b;
  const Term x = b.real("x"), y = b.real("y");
  b.equation(x, y);
  b.equation(x - y, 1.0);
  EXPECT_CONTAINS(complaint(b.model), "model.mo:4:1: this equation contradicts others: it says 0 = -1");
}

// x = 1/4 - t reaches 0, where log ends: the library names the equation by its place, unknowns by their names.
TEST(WrongModels, EquationsThatCannotBeEvaluated) {
  Builder b;
  const Term x = b.real("x", {.start = 0.25, .fixed = true}), y = b.real("y");
  b.equation(der(x), -1.0);
  b.equation(y * y * y + y, function(Operation::log, x));
  const Result result = solve(b.model, until(1.0));
  EXPECT_OUTCOME(result, Outcome::not_finished);
  EXPECT_CONTAINS(result.message, "(model.mo:4)");
  EXPECT_CONTAINS(result.message, "log of -");
}

TEST(WrongModels, ParametersWithoutValueOrWithCycles) {
  Builder b;
  const Term p = b.parameter("p", 1.0), q = b.parameter("q", p), x = b.real("x");
  b.equation(x, q);
  b.model.variables[0].binding = nullptr;
  EXPECT_CONTAINS(complaint(b.model), "model.mo:1:1: parameter p has no value");
  b.model.variables[0].binding = q.e;
  EXPECT_CONTAINS(complaint(b.model), "depends on itself");
}

TEST(WrongModels, ValuesThatCannotBeSet) {
  Builder b;
  const Term p = b.parameter("p", 1.0), x = b.real("x");
  b.equation(x, p);
  Settings settings = until(1.0);
  settings.values["unknown"] = 1.0;
  EXPECT_CONTAINS(complaint(b.model, settings), "there is no parameter or variable unknown to set");
  settings.values = {{"p", 2.0}};
  b.model.variables[0].is_structural = true;
  EXPECT_CONTAINS(complaint(b.model, settings), "parameter p cannot be set");
}

TEST(WrongModels, InputsWithoutSignal) {
  Builder b;
  const Term u = b.real("u"), x = b.real("x", {.start = 0.0, .fixed = true});
  b.model.variables[0].is_input = true;
  b.equation(der(x), u);
  EXPECT_CONTAINS(complaint(b.model), "model.mo:1:1: input u has no signal");
  Settings settings = until(1.0);
  settings.values["u"] = 2.0;
  EXPECT_NEAR(last(solve(b.model, settings), "x"), 2.0, 1e-9);
}

TEST(WrongModels, DiscreteVariablesThatNothingDetermines) {
  Builder b;
  const Term x = b.real("x"), n = b.integer("n");
  b.equation(x, n + 1.0);
  EXPECT_CONTAINS(complaint(b.model), "no equation determines the discrete variable n");
}

TEST(WrongModels, BooleansThatSwitchEachOther) {
  Builder b;
  const Term p = b.boolean("p"), q = b.boolean("q"), x = b.real("x");
  b.equation(p, inverse(q));
  b.equation(q, p);
  b.equation(x, 1.0);
  const Result result = solve(b.model, until(1.0));
  EXPECT_NE(static_cast<int>(result.outcome), static_cast<int>(Outcome::solved));
  EXPECT_CONTAINS(result.message, "do not settle");
}

// x = y, y = x, z = 1: nothing determines x, which is constant, and that is said.
TEST(WrongModels, EquationsThatSayNothingAreNamed) {
  Builder b;
  const Term x = b.real("x"), y = b.real("y"), z = b.real("z", {.start = 1.0, .fixed = true});
  b.equation(x, y);
  b.equation(y, x);
  b.equation(der(z), x - x * z);
  const Result result = solve(b.model, until(1.0));
  EXPECT_CONTAINS(joined(result.warnings), "model.mo:5: this equation follows from others and determines nothing");
}

TEST(WrongModels, StopBeforeStart) {
  Builder b;
  const Term x = b.real("x");
  b.equation(x, 1.0);
  EXPECT_CONTAINS(complaint(b.model, until(-1.0)), "the stop time -1 is not after the start time 0");
}

// Values that are not defined are no results: the operation, its operands, the equation and the time are named.
TEST(WrongModels, ValuesThatAreNotFiniteAreNamed) {
  struct Case {
    Term value;
    const char* message;
  };
  const Term x(Term::make(Operation::variable, {}, 0.0, 0)), none(0.0);
  for (const auto& [value, message] :
       {Case{function(Operation::sqrt, x),
             "y is nan at t = 0.54: sqrt(-0.026) is not finite (model.mo:4: y = sqrt(x))"},
        Case{1.0 + function(Operation::log, x), "log(-0.026) is not finite"},
        Case{power(x, 0.5), "(-0.026)^0.5 is not"},
        Case{function(Operation::asin, 2.0 * x), "y is nan at t = 0: asin(2) is not finite"},
        Case{1.0 / none, "y is inf at t = 0: 1/0 is not finite (model.mo:4: y = 1/0)"},
        Case{function(Operation::log, Term(-1.0)), "log(-1) is not finite"},
        Case{function(Operation::exp, 1e3 * x), "exp(1000) is not finite"}}) {
    Builder b;
    b.real("x", {.start = 1.0, .fixed = true});
    const Term y = b.real("y");
    b.equation(der(x), -1.9);
    b.equation(y, value);
    const Result result = solve(b.model, until(1.0));
    EXPECT_OUTCOME(result, Outcome::not_finished);
    EXPECT_CONTAINS(result.message, message);
    for (const double number : result.trajectory.values) EXPECT_TRUE(std::isfinite(number));
  }
}

// The first cause, not what follows from it; discrete variables likewise, in iterations of an event.
TEST(WrongModels, ValuesThatAreNotFiniteAreNamedWhereTheyArise) {
  Builder b;
  const Term z = b.real("z"), x = b.real("x", {.start = 1.0, .fixed = true}),
             u = b.discrete("u", {.start = 0.0, .fixed = true}), n = b.integer("n", {.start = 0.0, .fixed = true});
  b.equation(z, u + 1.0);
  b.equation(der(x), -2.0);
  b.when({{{sample(0.25, 0.5)}, {assign(u, function(Operation::sqrt, x)), assign(n, pre(n) + 1.0)}}});
  const Result result = solve(b.model, until(1.0));
  EXPECT_OUTCOME(result, Outcome::not_finished);
  EXPECT_CONTAINS(result.message, "u is nan at t = 0.75: sqrt(-0.5) is not finite (model.mo:7)");
}

TEST(WrongModels, RelationsThatCannotBeEvaluatedAreNamed) {
  Builder b;
  const Term x = b.real("x", {.start = 1.0, .fixed = true}), y = b.real("y", {.start = 0.0, .fixed = true}),
             n = b.integer("n");
  b.equation(der(x), -1.9);
  b.equation(n, Term::of(Operation::integer, x));
  b.equation(der(y), choose(function(Operation::log, x) > -3.0, 1.0, n));
  const Result result = solve(b.model, until(1.0));
  EXPECT_OUTCOME(result, Outcome::not_finished);
  EXPECT_CONTAINS(result.message, "the argument of log(x) > -3 (model.mo) is");
}

// sign, min, max and relations of an undefined operand are undefined.
TEST(WrongModels, UndefinedOperandsMakeUndefinedValues) {
  const Term x(Term::make(Operation::variable, {}, 0.0, 0)), t = time_now();
  const Term root = function(Operation::sqrt, x), constant = function(Operation::sqrt, Term(-1.0));
  for (const Term& value :
       {function(Operation::sign, root), Term::of(Operation::max, 0.0, root), Term::of(Operation::min, 1.0, root),
        choose(no_event(root > 0.1), 1.0, 2.0), choose(inverse(no_event(root > 0.1)), 1.0, 2.0),
        choose(either(t<0.1, constant> 1.0), 1.0, 2.0), choose(t > constant, 1.0, 2.0), power(root, 0.0 * t),
        choose(equal(constant, 2.0), 1.0, 2.0)}) {
    Builder b;
    b.real("x", {.start = 1.0, .fixed = true});
    const Term y = b.real("y");
    b.equation(der(x), -1.9);
    b.equation(y, value);
    const Result result = solve(b.model, until(1.0));
    EXPECT_OUTCOME(result, Outcome::not_finished);
    EXPECT_CONTAINS(result.message, "y is nan at t = ");
  }
  for (const Term& value : {choose(constant > 1.0, 1.0, 2.0), choose(inverse(constant > 1.0), 1.0, 2.0),
                            Term::of(Operation::max, 3.0, constant), function(Operation::sign, constant)}) {
    Builder b;
    b.real("x", {.start = 1.0, .fixed = true});
    b.equation(der(x), value);
    EXPECT_FALSE(solve(b.model, until(1.0)).outcome == Outcome::solved);
  }
  Builder b;  // one operand decides
  b.real("x", {.start = 1.0, .fixed = true});
  b.equation(der(x), choose(either(both(t<0.0, constant> 1.0), t < 2.0), 3.0, constant));
  const Result result = solve(b.model, until(1.0));
  EXPECT_SOLVED(result);
  EXPECT_NEAR(last(result, "x"), 4.0, 1e-9);
}

TEST(WrongModels, UndefinedConditionsOfWhenClausesAndAssertionsAreNamed) {
  for (const bool is_assertion : {false, true}) {
    Builder b;
    const Term d = b.discrete("d", {.start = 1.0, .fixed = true}), x = b.real("x", {.start = 0.0, .fixed = true}),
               n = b.integer("n", {.start = 0.0, .fixed = true});
    const Term root = function(Operation::sqrt, d);
    b.equation(der(x), 1.0);
    b.when({{{sample(0.5, 1.0)}, {assign(d, -1.0)}}});
    if (is_assertion) b.equation(n, 0.0), b.assertion(root > 0.5, "small");
    else b.when({{{root < 0.5}, {assign(n, pre(n) + 1.0)}}});
    const Result result = solve(b.model, until(1.0));
    EXPECT_OUTCOME(result, Outcome::not_finished);
    EXPECT_CONTAINS(result.message, is_assertion ? "model.mo:7: assertion failed at t = 0.5"
                                                 : "model.mo:6: the condition of this when clause at t = 0.5 is");
  }
}

TEST(WrongModels, UndefinedValuesOfReinitAreNamed) {
  Builder b;
  const Term x = b.real("x", {.start = 1.0, .fixed = true});
  b.equation(der(x), 1.0);
  b.when({{{sample(0.5, 1.0)}, {reinit(x, function(Operation::log, -pre(x)))}}});
  b.model.whens[0].branches[0].actions[0].at = {3, 1};
  const Result result = solve(b.model, until(1.0));
  EXPECT_OUTCOME(result, Outcome::not_finished);
  EXPECT_CONTAINS(result.message, "model.mo:3: reinit of x at t = 0.5: the new value is nan");
}

TEST(WrongModels, IntegersThatAreNotExactAreNamed) {
  Builder b;
  const Term n = b.integer("n", {.start = 1.0, .fixed = true}), x = b.real("x", {.start = 0.0, .fixed = true});
  b.equation(der(x), 1.0);
  b.when({{{sample(0.1, 0.1)}, {assign(n, 1000.0 * pre(n))}}});
  const Result result = solve(b.model, until(1.0));
  EXPECT_OUTCOME(result, Outcome::not_finished);
  EXPECT_CONTAINS(result.message, "n is 1e+18 at t = 0.6, beyond 2^53");
}

TEST(WrongModels, IntegersThatAreNotWholeAreNamed) {
  Builder b;
  const Term p = b.parameter("p", 1.0), a = b.integer("a"), x = b.real("x", {.start = 0.0, .fixed = true});
  b.equation(der(x), a);
  b.equation(a, p + function(Operation::sin, p));
  const Result result = solve(b.model, until(1.0));
  EXPECT_OUTCOME(result, Outcome::not_finished);
  EXPECT_CONTAINS(
      result.message,
      "a is 1.84147 at t = 0, but its type is not Real and needs a whole number (model.mo:5: a = p + sin(p))");
}

// A discrete variable would keep the value from the start.
TEST(WrongModels, DiscreteEquationsWithoutEvents) {
  const Term t = time_now();
  for (const Term& value : {no_event(t > 0.5), no_event(function(Operation::sign, t - 0.5) > 0.0),
                            choose(no_event(t > 0.5), t > 0.2, t > 0.7)}) {
    Builder b;
    const Term x = b.real("x", {.start = 0.0, .fixed = true}), flag = b.boolean("flag");
    b.equation(der(x), 1.0);
    b.equation(flag, value);
    EXPECT_CONTAINS(complaint(b.model), "model.mo:4:1: the discrete variable flag would change without an event");
  }
}

}  // namespace
}  // namespace sfdae::cli::test
