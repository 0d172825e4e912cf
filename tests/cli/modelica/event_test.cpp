// When clauses, algorithm sections of models, initial sections.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "reading.h"

namespace sfdae::cli::testing {

namespace {

const Action& action_of(const FlatModel& model, const When& when, size_t branch, const std::string& name) {
  for (const Action& one : when.branches.at(branch).actions)
    if (one.variable == index_of(model, name)) return one;
  throw std::runtime_error("no action on " + name);
}

}  // namespace

TEST(Whens, HaveBranchesVectorsAndActions) {
  const FlatModel model =
      read("", R"(Real 'x'(start = 1, fixed = true), 'd', 'w'[2]; Integer 'n'(start = 0, fixed = true); Boolean 'b';
    equation der('x') = -1; 'b' = 'x' < 0.5;
    when {'b', 'x' < 0.2, initial()} then
      'n' = pre('n') + 1; 'w' = {time, 2 * time}; reinit('x', 1.0);
      if 'n' > 3 then 'd' = 1; else 'd' = pre('d') + 2; end if;
      assert('n' < 10, "many", AssertionLevel.warning);
    elsewhen edge('b') or change('n') then
      'd' = 7;
    elsewhen sample(1.0, 0.5) then
      terminate("done");
    end when;)");
  ASSERT_EQ(model.whens.size(), 1U);
  const When& when = model.whens[0];
  ASSERT_EQ(when.branches.size(), 3U);
  ASSERT_EQ(when.branches[0].conditions.size(), 3U);
  EXPECT_EQ(when.branches[0].conditions[2]->operation, Operation::initial);
  EXPECT_EQ(value(model, action_of(model, when, 0, "n").value, {{"pre(n)", 4}}), 5);
  EXPECT_EQ(value(model, action_of(model, when, 0, "w[2]").value, {{"time", 4}}), 8);
  EXPECT_EQ(value(model, action_of(model, when, 0, "d").value, {{"n", 4}, {"pre(d)", 0}}), 1);
  EXPECT_EQ(value(model, action_of(model, when, 0, "d").value, {{"n", 2}, {"pre(d)", 5}}), 7);
  EXPECT_EQ(action_of(model, when, 0, "x").kind, Action::Kind::reinit);
  EXPECT_EQ(when.branches[0].actions.back().kind, Action::Kind::assertion);
  EXPECT_FALSE(when.branches[0].actions.back().is_error);
  const Expression& condition = when.branches[1].conditions[0];
  EXPECT_EQ(value(model, condition, {{"b", 1}, {"pre(b)", 0}, {"n", 1}, {"pre(n)", 1}}), 1);
  EXPECT_EQ(value(model, condition, {{"b", 1}, {"pre(b)", 1}, {"n", 1}, {"pre(n)", 1}}), 0);
  EXPECT_EQ(value(model, condition, {{"b", 1}, {"pre(b)", 1}, {"n", 1}, {"pre(n)", 2}}), 1);
  EXPECT_EQ(when.branches[2].conditions[0]->operation, Operation::sample);
  EXPECT_EQ(when.branches[2].actions[0].kind, Action::Kind::terminate);
  EXPECT_EQ(when.branches[2].actions[0].message, "done");
  EXPECT_EQ(variable(model, "d").variability, Variability::discrete);
  EXPECT_EQ(variable(model, "x").variability, Variability::continuous);
}

TEST(Algorithms, BecomeEquations) {
  const FlatModel model = read("", R"(Real 'x'(start = 3), 'y', 'z'[2], 'u' = time; Boolean 'b'(start = true);
    algorithm
      'y' := 'x' + 'u';
      'x' := 2 * 'y';
      if 'u' > 1 then 'y' := 'x'; end if;
      for 'i' in 1:2 loop 'z'['i'] := 'i' * 'y'; end for;
      'b' := not 'b';)");
  for (const double t : {0.5, 2.0}) {
    const Values v = {{"u", t}, {"pre(b)", 1}};
    EXPECT_EQ(solved(model, "x", v), 2 * (3 + t));  // x is its start value before
    EXPECT_EQ(solved(model, "y", v), t > 1 ? 2 * (3 + t) : 3 + t);
    EXPECT_EQ(solved(model, "z[2]", v), 2 * solved(model, "y", v));
    EXPECT_EQ(solved(model, "b", v), 0);  // and b its left limit
  }
  EXPECT_EQ(model.equations.size(), 6U);
}

TEST(Algorithms, HaveWhens) {
  const FlatModel model = read("", R"(Real 'x'(start = 1), 'm'(start = 0); Integer 'n'(start = 0);
    equation der('x') = 'm';
    algorithm
      when 'x' > 2 then
        'n' := pre('n') + 1;
        if 'n' > 5 then 'm' := 'n'; else 'm' := -'m'; end if;
        reinit('x', 'm');
        assert('n' < 9, "many");
      elsewhen 'x' < 0 then
        'm' := 1;
      end when;)");
  ASSERT_EQ(model.whens.size(), 1U);
  const When& when = model.whens[0];
  ASSERT_EQ(when.branches.size(), 2U);
  EXPECT_EQ(value(model, action_of(model, when, 0, "n").value, {{"pre(n)", 2}}), 3);
  EXPECT_EQ(value(model, action_of(model, when, 0, "m").value, {{"pre(n)", 2}, {"pre(m)", 4}}), -4);
  EXPECT_EQ(value(model, action_of(model, when, 0, "m").value, {{"pre(n)", 7}, {"pre(m)", 4}}), 8);
  EXPECT_EQ(value(model, action_of(model, when, 0, "x").value, {{"pre(n)", 7}, {"pre(m)", 4}}), 8);
  EXPECT_EQ(value(model, action_of(model, when, 1, "m").value, {}), 1);
  EXPECT_EQ(variable(model, "m").variability, Variability::discrete);
  EXPECT_EQ(model.equations.size(), 1U);
}

TEST(Algorithms, MayAssignInSeveralWhens) {
  const FlatModel model = read("", R"(Integer 'n'(start = 0); Boolean 'b';
    equation 'b' = time > 1;
    algorithm
      when 'b' then 'n' := 1; end when;
      when time > 2 then 'n' := pre('n') + 10; end when;)");
  ASSERT_EQ(model.whens.size(), 1U);
  const When& when = model.whens[0];
  ASSERT_EQ(when.branches.size(), 2U);  // the last one first: it overrides the others
  EXPECT_EQ(value(model, when.branches[0].conditions[0], {{"time", 2.5}}), 1);
  EXPECT_EQ(value(model, when.branches[0].actions[0].value, {{"pre(n)", 4}}), 14);
  EXPECT_EQ(value(model, when.branches[1].actions[0].value, {}), 1);
}

TEST(Initial, SectionsAreRead) {
  const FlatModel model = read("",
                               R"(Real 'x', 'y'; parameter Real 'p'(fixed = false, start = 2), 'q'(fixed = false);
    parameter Boolean 'steady' = true;
    parameter equation guess('y') = 1.5;
    initial equation
      if 'steady' then der('x') = 0; else 'x' = 1; end if;
      'y' = guess('y');
      assert('p' > 0, "p");
    initial algorithm
      'q' := 2; 'q' := 'q' + 1;
    equation der('x') = 'p' - 'x'; der('y') = 'q';
    initial equation 'p' = 3;)");
  ASSERT_EQ(model.initial_equations.size(), 4U);
  EXPECT_EQ(model.initial_equations[0].left->operation, Operation::derivative);
  EXPECT_EQ(value(model, model.initial_equations[1].right, {}), 1.5);
  EXPECT_EQ(model.initial_equations[2].left->index, index_of(model, "q"));
  EXPECT_EQ(value(model, model.initial_equations[2].right, {}), 3);
  EXPECT_EQ(value(model, variable(model, "y").start, {}), 1.5);
  ASSERT_EQ(model.assertions.size(), 1U);
  EXPECT_EQ(value(model, model.assertions[0].condition, {{"initial", 0}, {"p", -1}}), 1);
  EXPECT_EQ(value(model, model.assertions[0].condition, {{"initial", 1}, {"p", -1}}), 0);
}

TEST(Events, NoEventAndSmooth) {
  const FlatModel model = read(
      "", R"(Real 'x'; Real 'a' = noEvent(if 'x' > 0 then 1 else 2), 'b' = smooth(1, if 'x' > 0 then 'x' ^ 2 else 0),
    'c' = smooth(0, if 'x' > 0 then 'x' else 0); equation 'x' = time;)");
  EXPECT_EQ(right_of(model, "a")->operation, Operation::no_event);
  EXPECT_EQ(right_of(model, "b")->operation, Operation::no_event);
  EXPECT_EQ(right_of(model, "c")->operation, Operation::choose);
}

TEST(Tables, OfEnumerationsAreIndexedByThem) {
  const FlatModel model = read(
      "type 'E' = enumeration('a', 'b', 'c'); constant 'E' 'T'['E', 3] = {{'E'.'a', 'E'.'b', 'E'.'c'}, {'E'.'b', "
      "'E'.'b', 'E'.'a'}, {'E'.'c', 'E'.'a', 'E'.'c'}};",
      "'E' 'p', 'q', 'r'; equation 'p' = if time > 1 then 'E'.'b' else 'E'.'c'; 'q' = 'E'(2); 'r' = 'T'['p', 'q'];");
  const int table[3][3] = {{1, 2, 3}, {2, 2, 1}, {3, 1, 3}};
  for (int p = 1; p <= 3; ++p)
    for (int q = 1; q <= 3; ++q) EXPECT_EQ(solved(model, "r", {{"p", p}, {"q", q}}), table[p - 1][q - 1]);
  EXPECT_TRUE(model.assertions.empty());
}

}  // namespace sfdae::cli::testing
