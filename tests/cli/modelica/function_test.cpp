// Functions become formulas that have the values of the algorithms.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "reading.h"

namespace sfdae::cli::testing {

namespace {

// function 'f' of a Real 'x' with this body, compared with a function of C++ at several points.
void compare(const std::string& body, const std::function<double(double)>& expected,
             const std::string& definitions = "") {
  const FlatModel model = read(definitions + " function 'f' input Real 'x'; output Real 'y'; " + body + " end 'f';",
                               "Real 'u'; Real 'z' = 'f'('u');");
  for (const double x : {-2.5, -1.0, -0.3, 0.0, 0.4, 1.0, 1.7, 2.0, 3.2, 6.9})
    EXPECT_DOUBLE_EQ(solved(model, "z", {{"u", x}}), expected(x)) << "x = " << x;
}

}  // namespace

TEST(Functions, AssignAndLoop) {
  compare(
      "protected Real 's' = 1, 'c'[3] = {1, 2, 'x'}; algorithm 'y' := 0; for 'i' in 1:3 loop 'y' := 'y' + 'c'['i'] * "
      "'s'; 's' := 's' * 'x'; end for;",
      [](double x) { return 1 + 2 * x + x * x * x; });
}

TEST(Functions, ChooseBetweenBranches) {
  compare(
      "algorithm if 'x' < -1 then 'y' := -1; elseif 'x' > 1 then 'y' := 1; else 'y' := 'x'; end if; 'y' := 2 * 'y';",
      [](double x) { return 2 * std::clamp(x, -1.0, 1.0); });
}

TEST(Functions, ReturnAndBreakUnderConditions) {
  compare(
      "protected Integer 'k'; algorithm 'y' := 0; 'k' := 0; if 'x' < 0 then 'y' := -7; return; end if; "
      "for 'i' in 1:4 loop if 'x' < 'i' then break; end if; 'k' := 'k' + 1; if 'x' > 6 and 'i' == 3 then 'y' := 100; "
      "return; end if; end for; 'y' := 'y' + 'k' + 0.5;",
      [](double x) {
        if (x < 0) return -7.0;
        double k = 0;
        for (int i = 1; i <= 4; ++i) {
          if (x < i) break;
          ++k;
          if (x > 6 && i == 3) return 100.0;
        }
        return k + 0.5;
      });
}

TEST(Functions, NeedNoAlgorithmIfOutputsAreBound) {
  const FlatModel model = read(
      "function 'f' input Real 'x'; output Real 'y' = 2 * 'w'; output Real 'z' = 'y' + 1; protected Real 'w' = 'x' * "
      "'x'; "
      "end 'f';",
      "Real 'u', 'a', 'b'; equation ('a', 'b') = 'f'('u');");
  for (const double u : {-1.5, 0.0, 2.0}) {
    EXPECT_DOUBLE_EQ(solved(model, "a", {{"u", u}}), 2.0 * u * u);
    EXPECT_DOUBLE_EQ(solved(model, "b", {{"u", u}}), 2.0 * u * u + 1.0);
  }
}

// A return behind a break, and one in a loop whose condition varies.
TEST(Functions, ReturnOnlyWhereTheyAreReached) {
  compare("algorithm 'y' := 1; for 'i' in 1:2 loop if 'x' < 3 then break; end if; return; end for; 'y' := 7;",
          [](double x) { return x < 3 ? 7.0 : 1.0; });
  compare(
      "protected Integer 'w'; algorithm 'y' := 1; 'w' := 0; while 'w' < 2 and 'x' > 1.5 loop 'w' := 'w' + 1; "
      "if 'x' > 5 then break; end if; return; end while; 'y' := 7;",
      [](double x) { return x > 1.5 && x <= 5 ? 1.0 : 7.0; });
}

TEST(Functions, WhileLoopsWithKnownRounds) {
  compare(
      "protected Integer 'k' := 5; algorithm 'y' := 1; while 'k' > 0 loop 'y' := 'y' * 'x'; 'k' := 'k' - 2; end "
      "while;",
      [](double x) { return x * x * x; });
}

TEST(Functions, WhileLoopsThatVariablesEnd) {
  const FlatModel model = read(R"(function 'f' input Real 'x'; output Real 'y'; output Integer 'n'; algorithm
    'y' := 1; 'n' := 0;
    while abs('y' * 'y' - 'x') > 1e-3 loop 'y' := 0.5 * ('y' + 'x' / 'y'); 'n' := 'n' + 1; end while; end 'f';)",
                               "Real 'u', 'y'; Integer 'n'; equation 'u' = time; ('y', 'n') = 'f'('u');");
  for (const double x : {0.01, 1.0, 2.0, 50.0, 1e4}) {
    double y = 1;
    int n = 0;
    for (; std::fabs(y * y - x) > 1e-3; ++n) y = 0.5 * (y + x / y);
    EXPECT_DOUBLE_EQ(solved(model, "y", {{"u", x}}), y);
    EXPECT_EQ(solved(model, "n", {{"u", x}}), n);
    ASSERT_EQ(model.assertions.size(), 1U);
    EXPECT_EQ(value(model, model.assertions[0].condition, {{"u", x}}), 1);
  }
  EXPECT_EQ(value(model, model.assertions[0].condition, {{"u", -1}}), 0);  // it does not end within 50 rounds
}

TEST(Functions, InterpolateInTablesBySearching) {
  compare(
      "protected Real 't'[5] = {-2, -1, 0, 2, 4}, 'v'[5] = {4, 1, 0, 4, 16}; Integer 'i' = 1; algorithm "
      "while 'i' < 4 and 'x' >= 't'['i' + 1] loop 'i' := 'i' + 1; end while; "
      "'y' := 'v'['i'] + ('v'['i' + 1] - 'v'['i']) * ('x' - 't'['i']) / ('t'['i' + 1] - 't'['i']);",
      [](double x) {
        const double t[] = {-2, -1, 0, 2, 4}, v[] = {4, 1, 0, 4, 16};
        int i = 0;
        while (i < 3 && x >= t[i + 1]) ++i;
        return v[i] + (v[i + 1] - v[i]) * (x - t[i]) / (t[i + 1] - t[i]);
      });
}

TEST(Functions, AssignElementsWithVaryingSubscripts) {
  compare(
      "protected Real 'a'[4] = {1, 2, 3, 4}; Integer 'i'; algorithm 'i' := if 'x' < 0 then 1 elseif 'x' < 1 then 2 "
      "else 4; 'a'['i'] := 10 * 'x'; 'y' := 'a'[1] + 2 * 'a'[2] + 3 * 'a'[3] + 5 * 'a'['i'];",
      [](double x) {
        double a[] = {1, 2, 3, 4};
        const int i = x < 0 ? 0 : x < 1 ? 1 : 3;
        a[i] = 10 * x;
        return a[0] + 2 * a[1] + 3 * a[2] + 5 * a[i];
      });
}

// i is 1, 2 or 4; all these subscripts are i.
TEST(Functions, AssignElementsWithVaryingSubscriptsOfAnyForm) {
  for (const char* subscript :
       {"'i'", "1 + mod('i' - 1, 4)", "'i' + 0", "5 - (5 - 'i')", "end - (4 - 'i')", "div(2 * 'i', 2)", "-(-'i')",
        "if 'i' > 2 then 4 else 'i'", "{1, 2, 4}[if 'i' > 2 then 3 else 'i']", "max('i', 1)"})
    compare(
        "protected Real 'a'[4] = {1, 2, 3, 4}; Integer 'i'; algorithm 'i' := if 'x' < 0 then 1 elseif 'x' < 1 then 2 "
        "else 4; 'a'[" +
            std::string(subscript) + "] := 10 * 'x'; 'y' := 'a'[1] + 2 * 'a'[2] + 3 * 'a'[3] + 5 * 'a'[4];",
        [](double x) {
          double a[] = {1, 2, 3, 4};
          a[x < 0 ? 0 : x < 1 ? 1 : 3] = 10 * x;
          return a[0] + 2 * a[1] + 3 * a[2] + 5 * a[3];
        });
  compare(
      "protected Real 'm'[2, 3] = {{1, 2, 3}, {4, 5, 6}}; Integer 'i'; algorithm 'i' := if 'x' < 0 then 1 else 2; "
      "'m'['i' + 0, end] := 'x'; 'm'[end, 3 - 'i'] := 7; 'y' := 'm'[1, 3] + 2 * 'm'[2, 3] + 3 * 'm'[2, 1] + 5 * "
      "'m'[2, 2];",
      [](double x) { return x < 0 ? x + 2 * 6 + 3 * 4 + 5 * 7 : 3 + 2 * x + 3 * 7 + 5 * 5; });
}

TEST(Functions, CallOthersAndThemselves) {
  compare(
      "algorithm 'y' := 'power'('x', 5) + 'power'('x', 0);", [](double x) { return x * x * x * x * x + 1; },
      "function 'power' input Real 'b'; input Integer 'n'; output Real 'p'; algorithm if 'n' == 0 then 'p' := 1; "
      "else 'p' := 'b' * 'power'('b', 'n' - 1); end if; end 'power';");
}

TEST(Functions, ReturnSeveralOutputsAndRecords) {
  compare(
      "protected Real 'a'; 'R' 'r'; algorithm ('a', , 'r') := 'g'('x'); 'y' := 'a' + 'r'.'v'[2]; 'r'.'v'[1] := 3; "
      "'y' := 'y' + 'r'.'v' * {1, 10};",
      [](double x) { return x + 1 + 3 * x + 3 + 30 * x; },
      "record 'R' Real 'v'[2]; end 'R'; function 'g' input Real 'u'; output Real 'p'; output Real 'q'; output 'R' "
      "'r'; algorithm 'p' := 'u' + 1; 'q' := 0; 'r'.'v' := {2, 3} * 'u'; end 'g';");
}

TEST(Functions, TakeDefaultsNamesArraysAndFunctions) {
  compare(
      "algorithm 'y' := 'g'('x', 'c' = 3) + sum('h'({1, 'x'})) + 'k'('h', 'x');",
      [](double x) { return x + 2 * 10 + 3 + 1 + x * x + x * x + 1; },
      "function 'g' input Real 'a'; input Real 'b' = 10; input Real 'c'; output Real 'r'; algorithm 'r' := 'a' + 2 * "
      "'b' + 'c'; end 'g'; "
      "function 'h' input Real 'a'; output Real 'r'; algorithm 'r' := 'a' ^ 2; end 'h'; "
      "partial function 'p' input Real 'a'; output Real 'r'; end 'p'; "
      "function 'k' input 'p' 'q'; input Real 'a'; output Real 'r'; algorithm 'r' := 'q'('a') + 1; end 'k';");
}

TEST(Functions, BindLocalsBeforeTheFirstStatement) {
  compare("protected Real 'b' = 2 * 'a'; Real 'a' = 'x'; algorithm 'a' := 100; 'y' := 'b';",
          [](double x) { return 2 * x; });
}

TEST(Functions, OfTheMathematicalLibraryOfC) {
  compare(
      "algorithm 'y' := 'Modelica.Math.sin'('x') + 'p'('x');", [](double x) { return std::sin(x) + x * x; },
      "function 'Modelica.Math.sin' input Real 'u'; output Real 'y'; external \"builtin\" 'y' = sin('u'); end "
      "'Modelica.Math.sin'; "
      "function 'p' input Real 'u'; output Real 'y'; external \"C\" 'y' = pow('u', 2.0) annotation(Library = \"m\"); "
      "end 'p';");
}

TEST(Functions, MultiplyMatricesOfAnySize) {
  const FlatModel model = read(
      "function 'f' input Real 'A'[:, :]; input Real 'b'[size('A', 2)]; output Real 'c'[size('A', 1)]; algorithm "
      "for 'i' in 1:size('A', 1), 'j' in 1:size('A', 2) loop 'c'['i'] := if 'j' == 1 then 'A'['i', 1] * 'b'[1] else "
      "'c'['i'] + 'A'['i', 'j'] * 'b'['j']; end for; end 'f';",
      "Real 'x'[3]; Real 'y'[2] = 'f'([1, 2, 3; 4, 5, 6], 'x');");
  const Values v = {{"x[1]", 1}, {"x[2]", 10}, {"x[3]", 100}};
  EXPECT_EQ(solved(model, "y[1]", v), 321);
  EXPECT_EQ(solved(model, "y[2]", v), 654);
}

TEST(Functions, SolveLinearSystemsByElimination) {
  // Gauss without pivoting on a matrix of formulas.
  const FlatModel model = read(
      R"(function 'solve' input Real 'A'[:, size('A', 1)]; input Real 'b'[size('A', 1)]; output Real 'x'[size('b', 1)];
    protected Integer 'n' = size('A', 1); Real 'M'[size('A', 1), size('A', 1)] = 'A';
      Real 'r'[size('A', 1)] = 'b'; Real 'l';
    algorithm
      for 'k' in 1:'n' - 1 loop for 'i' in 'k' + 1:'n' loop
        'l' := 'M'['i', 'k'] / 'M'['k', 'k']; 'M'['i', :] := 'M'['i', :] - 'l' * 'M'['k', :];
        'r'['i'] := 'r'['i'] - 'l' * 'r'['k'];
      end for; end for;
      for 'i' in 'n':-1:1 loop
        'x'['i'] := ('r'['i'] - sum('M'['i', 'j'] * 'x'['j'] for 'j' in 'i' + 1:'n')) / 'M'['i', 'i']; end for;
    end 'solve';)",
      "Real 'a'; Real 'x'[3] = 'solve'([4, 1, 0; 1, 'a', 1; 0, 1, 5], {6, 9, 17});");
  const Values v = {{"a", 2}};
  const double x = solved(model, "x[1]", v), y = solved(model, "x[2]", v), z = solved(model, "x[3]", v);
  EXPECT_NEAR(4 * x + y, 6, 1e-14);
  EXPECT_NEAR(x + 2 * y + z, 9, 1e-14);
  EXPECT_NEAR(y + 5 * z, 17, 1e-14);
}

TEST(Functions, AssertWhereTheyAreCalled) {
  const FlatModel model = read(
      "function 'f' input Real 'x'; output Real 'y'; algorithm assert('x' > 0, \"x = \" + String('x')); if 'x' > 5 "
      "then assert('x' < 9, \"large\", AssertionLevel.warning); end if; 'y' := 'x'; end 'f';",
      "Real 'u'; Boolean 'b'; Real 'z' = if 'b' then 'f'('u') else 1;");
  ASSERT_EQ(model.assertions.size(), 2U);
  const auto holds = [&](size_t k, double u, double b) {
    return value(model, model.assertions[k].condition, {{"u", u}, {"b", b}}) != 0;
  };
  EXPECT_FALSE(holds(0, -1, 1));
  EXPECT_TRUE(holds(0, -1, 0));
  EXPECT_TRUE(holds(1, 4, 1));
  EXPECT_FALSE(holds(1, 10, 1));
  EXPECT_TRUE(holds(1, 10, 0));
  EXPECT_TRUE(model.assertions[0].is_error);
  EXPECT_FALSE(model.assertions[1].is_error);
  EXPECT_EQ(model.assertions[1].message, "large");
}

TEST(Functions, WithSharedPartsStaySmall) {
  // 2^200 terms if parts were not shared.
  const FlatModel model = read(
      "function 'f' input Real 'x'; output Real 'y'; algorithm 'y' := 'x'; for 'i' in 1:200 loop 'y' := 0.5 * ('y' + "
      "'y' * cos('y')); end for; end 'f';",
      "Real 'u'; Real 'z' = 'f'('u'), 'd' = der('f'('u'));");
  double x = 0.3;
  for (int i = 0; i < 200; ++i) x = 0.5 * (x + x * std::cos(x));
  EXPECT_DOUBLE_EQ(solved(model, "z", {{"u", 0.3}}), x);
}

}  // namespace sfdae::cli::testing
