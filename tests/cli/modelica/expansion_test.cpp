// Arrays, records, parameters and equations become scalars.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "reading.h"

namespace sfdae::cli::testing {

TEST(Arrays, OperatorsFollowLinearAlgebra) {
  const FlatModel model = read("", R"(
    parameter Real 'A'[2, 2] = [1, 2; 3, 4];
    Real 'v'[2] = {5, 6} * time, 'Av'[2] = 'A' * 'v', 'vA'[2] = 'v' * 'A', 'AA'[2, 2] = 'A' * 'A', 'A3'[2, 2] = 'A' ^ 3;
    Real 'vv' = 'v' * 'v', 'e'[2] = 'v' .* 'v' ./ {1, 2} .^ 2 .+ 1,
      't'[2, 2] = transpose('A'), 's'[2] = 2 * 'v' / 4 - 'v';
    Real 'o'[2, 2] = outerProduct('v', 'v'), 'c'[3] = cross({1, 2, 3}, {4, 5, time}),
      'k'[3] = skew({1, 2, 3}) * {4, 5, time};
    Real 'd'[2, 2] = diagonal({1, 2}), 'i'[2, 2] = identity(2), 'l'[3] = linspace(0, 1, 3),
      'b'[2, 3] = [1, 2, 3; {{4, 5, 6}}];
    Real 'cat1'[3] = cat(1, {1}, {2, 3}), 'cat2'[2, 3] = cat(2, 'A', {{7}, {8}});)");
  const Values v = {{"time", 1}, {"v[1]", 5}, {"v[2]", 6}};
  const auto check = [&](const std::string& name, double expected) {
    EXPECT_EQ(solved(model, name, v), expected) << name;
  };
  check("Av[1]", 17), check("Av[2]", 39);
  check("vA[1]", 23), check("vA[2]", 34);
  check("AA[1,2]", 10), check("AA[2,1]", 15);
  check("A3[1,1]", 37), check("A3[2,2]", 118);
  check("vv", 61);
  check("e[1]", 26), check("e[2]", 10);
  check("t[1,2]", 3), check("t[2,1]", 2);
  check("s[2]", -3);
  check("o[1,2]", 30), check("o[2,2]", 36);
  check("c[1]", 2 * 1 - 3 * 5), check("c[2]", 3 * 4 - 1 * 1), check("c[3]", 1 * 5 - 2 * 4);
  check("k[1]", 2 * 1 - 3 * 5), check("k[2]", 3 * 4 - 1 * 1), check("k[3]", 1 * 5 - 2 * 4);
  check("d[1,1]", 1), check("d[1,2]", 0), check("i[2,2]", 1), check("l[2]", 0.5);
  check("b[1,3]", 3), check("b[2,1]", 4), check("cat1[3]", 3), check("cat2[2,3]", 8), check("cat2[1,2]", 2);
}

TEST(Arrays, SlicesComprehensionsAndReductions) {
  const FlatModel model = read("", R"(
    parameter Integer 'n' = 3;
    Real 'x'['n', 2] = {{10 * 'i' + 'j' for 'j' in 1:2} for 'i' in 1:'n'} * time;
    Real 'c'['n'] = 'x'[:, 2], 'r'[2] = 'x'[end, :], 'p'[2] = 'x'[{3, 1}, 1], 'q'[2] = 'x'[2:end, 2];
    Real 's' = sum('x'), 'm' = max('x'['i', 1] for 'i' in 1:'n'), 'f' = product({2, 3, 4}) * time,
      'w' = sum(1 / 'k' for 'k' in 1:4);
    Real 'z' = size('x', 1) + ndims('x') + sum(size('x')), 'y'[0], 'g' = sum('y'), 'ev'[3] = 2:2:6,
      'h'[2, 3] = {'a' + 'b' for 'a' in 1:3, 'b' in {10, 20}};)");
  Values v = {{"time", 1}};
  for (int i = 1; i <= 3; ++i)
    for (int j = 1; j <= 2; ++j) v["x[" + std::to_string(i) + "," + std::to_string(j) + "]"] = 10 * i + j;
  const auto check = [&](const std::string& name, double expected) {
    EXPECT_EQ(solved(model, name, v), expected) << name;
  };
  check("x[2,1]", 21), check("c[3]", 32), check("r[1]", 31), check("p[1]", 31), check("p[2]", 11), check("q[2]", 32);
  check("s", 11 + 12 + 21 + 22 + 31 + 32), check("m", 31), check("f", 24), check("z", 3 + 2 + 5), check("g", 0),
      check("ev[3]", 6);
  check("h[2,3]", 23);
  EXPECT_NEAR(solved(model, "w", v), 25.0 / 12.0, 1e-15);
  EXPECT_TRUE(variable(model, "n").is_structural);
}

TEST(Arrays, OfScalarNamesAreAssembled) {
  const FlatModel model = read(
      "record 'R' Real 'x'; Real 'y'[2]; end 'R'; "
      "function 'f' input 'R' 'r'; output Real 'y'; algorithm 'y' := 'r'.'x' + 2 * 'r'.'y'[2]; end 'f'; "
      "function 's' input Real 'm'[:, :]; output Real 'y'; algorithm 'y' := 'm'[2, 1]; end 's';",
      R"(Real 'q.x' = 1, 'q.y[1]' = 2, 'q.y[2]' = 3, 'm[1,1]' = 4, 'm[1,2]' = 5, 'm[2,1]' = 6, 'm[2,2]' = 7;
    Real 'z' = 'f'('q'), 'w' = 's'('m'), 'a'[2], 'u' = 'a[2]', 'l' = 'm'[1, 2]; equation 'a' = {8, 9};)");
  const Values v = {{"q.x", 1}, {"q.y[2]", 3}, {"m[2,1]", 6}, {"m[1,2]", 5}, {"a[2]", 9}};
  EXPECT_EQ(solved(model, "z", v), 7);
  EXPECT_EQ(solved(model, "w", v), 6);
  EXPECT_EQ(solved(model, "u", v), 9);
  EXPECT_EQ(solved(model, "l", v), 5);
}

TEST(Records, HaveFieldsDefaultsAndModifications) {
  const FlatModel model = read(
      "record 'In' Real 'a' = 7; Real 'v'[2](each unit = \"m\"); end 'In'; record 'R' 'In' 'in'; Real 'b'; Integer "
      "'n' = 4; end 'R';",
      R"(
    parameter 'R' 'p'('b' = 3, 'in'('v' = {1, 2}));
    parameter 'R' 'q' = 'R'('In'(1, {5, 6}), 8, 'n' = 9);
    'In' 's'[2]('a'(start = {10, 20}, each fixed = true));
    Real 'x' = 'p'.'in'.'v'[2] + 'q'.'in'.'v'[1], 'y'[2] = 's'.'a';
    equation 's'[1].'v' = {1, 2}; 's'[2].'v' = 'p'.'in'.'v';)");
  EXPECT_EQ(value(model, variable(model, "p.in.a").binding, {}), 7);
  EXPECT_EQ(value(model, variable(model, "p.in.v[2]").binding, {}), 2);
  EXPECT_EQ(value(model, variable(model, "p.n").binding, {}), 4);
  EXPECT_EQ(value(model, variable(model, "q.n").binding, {}), 9);
  EXPECT_EQ(value(model, variable(model, "q.in.a").binding, {}), 1);
  EXPECT_EQ(solved(model, "x"), 7);
  EXPECT_EQ(solved(model, "s[2].v[2]"), 2);
  EXPECT_EQ(value(model, variable(model, "s[2].a").start, {}), 20);
  EXPECT_TRUE(variable(model, "s[1].a").is_fixed);
  EXPECT_EQ(variable(model, "s[1].v[2]").unit, "m");
  EXPECT_EQ(solved(model, "y[2]", {{"s[2].a", 5}}), 5);
}

TEST(Parameters, AreBoundInAnyOrder) {
  const FlatModel model = read("constant Real 'k' = 2 * 'k0'; constant Real 'k0' = 3;", R"(
    parameter Real 'a' = 'b' + 'k', 'b' = 2 * 'c', 'c' = 5;
    constant Real 'd' = 'e' ^ 2, 'e' = 4;
    parameter Real 'start_only'(start = 6);
    Real 'x' = 'a' + 'd' + 'start_only';)");
  EXPECT_EQ(solved(model, "x"), 16 + 16 + 6);
  EXPECT_EQ(solved(model, "x", {{"c", 1}}), 8 + 16 + 6);
  ASSERT_EQ(model.warnings.size(), 1U);
  EXPECT_NE(model.warnings[0].find("'start_only' has no binding; its start value is used"), std::string::npos);
}

TEST(Parameters, ThatDecideStructureAreStructural) {
  const FlatModel model =
      read("", R"(parameter Boolean 'on' = 'mode' > 1; parameter Integer 'mode' = 2; parameter Real 'p' = 1;
    Real 'x'; equation if 'on' then 'x' = 'p'; else 'x' = 2; 'x' = 3; end if;)");
  EXPECT_EQ(model.equations.size(), 1U);
  EXPECT_TRUE(variable(model, "on").is_structural);
  EXPECT_TRUE(variable(model, "mode").is_structural);
  EXPECT_FALSE(variable(model, "p").is_structural);
}

TEST(Inputs, AreSuppliedByBindings) {
  const FlatModel model = read("", "input Real 'u'; input Integer 'k' = 3; input Real 'v' = 'k' * time;");
  EXPECT_TRUE(variable(model, "u").is_input);
  EXPECT_FALSE(variable(model, "k").is_input);
  EXPECT_EQ(solved(model, "k"), 3);
  EXPECT_EQ(solved(model, "v", {{"k", 3}, {"time", 2}}), 6);
}

TEST(Equations, OfIfBranchesAreJoinedByTheirLeftSides) {
  const FlatModel model = read("", R"(Real 'x', 'y', 'z'; equation
    if time < 1 then 'x' = 1; 'y' = 2; 'z' + 'x' = 3; elseif time < 2 then 5 = 'y'; 'x' = 4; 'z' - 'x' = 6;
    else 'x' = 7; 'z' = 9; 'y' = 8; end if;)");
  ASSERT_EQ(model.equations.size(), 3U);
  for (const auto& [t, x, y, z] : {std::tuple{0.0, 1.0, 2.0, 2.0}, {1.5, 4.0, 5.0, 10.0}, {3.0, 7.0, 8.0, 9.0}}) {
    const Values v = {{"time", t}, {"x", x}, {"y", y}, {"z", z}};
    for (const Equation& one : model.equations) EXPECT_EQ(value(model, one.left, v), value(model, one.right, v)) << t;
  }
  EXPECT_EQ(solved(model, "x", {{"time", 3}}), 7);
}

TEST(Equations, OfDiscreteVariablesAreDirected) {
  const FlatModel model = read("", R"(Boolean 'a', 'b', 'c', 'd'; Integer 'm', 'n'; Real 'x'; equation
    'a' = 'b'; not 'c' = 'b'; 'd' = 'c'; time > 1 = 'd'; 'm' = -'n'; 'n' = integer(time); 'x' = 'n';)");
  const Values v = {{"time", 3}, {"a", 0}, {"b", 0}, {"c", 1}, {"d", 1}, {"m", -3}, {"n", 3}};
  for (const char* name : {"a", "b", "c", "d", "m", "n"}) EXPECT_EQ(solved(model, name, v), v.at(name)) << name;
  EXPECT_EQ(solved(model, "x", v), 3);
}

TEST(Derivatives, OfFormulasFollowTheChainRule) {
  const std::string all =
      "'x' ^ 3 * sin('y') / exp('x') + sqrt('x') * tan('y') - log('x' * 'y') + atan2('x', 'y') + 'x' ^ 'y' + "
      "asin('x' / 9) + acos('y' / 9) + atan('x') + sinh('x') + cosh('y') + tanh('x') + abs('x') + log10('y') + "
      "min('x', 'y') + max('x', 'y') + (if time > 1 then 'x' else 'y') + mod('x', 'y') + rem('x', 'y') + 'p' * 'x' + "
      "time ^ 2";
  const FlatModel model =
      read("", "parameter Real 'p' = 4; Real 'x', 'y', 'f' = " + all + ", 'd' = der(" + all + ");");
  const double h = 1e-5, dx = 0.7, dy = -0.4;
  const auto at = [&](double s) { return Values{{"time", 2 + s}, {"x", 1.3 + s * dx}, {"y", 0.6 + s * dy}}; };
  Values v = at(0);
  v["der(x)"] = dx, v["der(y)"] = dy;
  const double difference = (solved(model, "f", at(h)) - solved(model, "f", at(-h))) / (2 * h);
  EXPECT_NEAR(solved(model, "d", v), difference, 1e-8);
}

TEST(Derivatives, OfDerivativesGetVariables) {
  const FlatModel model =
      read("", "Real 'x'(start = 1, unit = \"m\"), 'y'; equation der(der('x')) = -'x'; 'y' = der('x' * der('x'));");
  EXPECT_EQ(variable(model, "der(x)").unit, "m/s");
  ASSERT_EQ(model.equations.size(), 3U);
  EXPECT_EQ(solved(model, "y", {{"x", 2}, {"der(x)", 3}, {"der(der(x))", 5}}), 19);
}

TEST(Relations, OfFunctionsAreTakenLiterally) {
  const FlatModel model =
      read("function 'f' input Real 'x'; output Real 'y'; algorithm 'y' := if 'x' > 0 then 1 else 2; end 'f';",
           "Real 'a' = 'f'(time), 'b' = if time > 0 then 1 else 2;");
  EXPECT_EQ(right_of(model, "a")->operands[0]->operation, Operation::no_event);
  EXPECT_EQ(right_of(model, "b")->operands[0]->operation, Operation::greater);
}

}  // namespace sfdae::cli::testing
