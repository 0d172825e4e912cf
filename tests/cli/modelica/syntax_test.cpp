// Tokens, precedence, and the spellings that exports use.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "reading.h"

namespace sfdae::cli::testing {

namespace {

// The value of an expression of x = 3, y = 2, z = 5, b = true, c = false at t = 0.
double value_of(const std::string& expression, const std::string& type = "Real") {
  const FlatModel model = read("", "Real 'x', 'y', 'z'; Boolean 'b', 'c'; " + type + " 'r' = " + expression + ";");
  return solved(model, "r", {{"x", 3}, {"y", 2}, {"z", 5}, {"b", 1}, {"c", 0}, {"time", 0}});
}

}  // namespace

TEST(Precedence, OfArithmetic) {
  EXPECT_EQ(value_of("-'y' ^ 2"), -4);
  EXPECT_EQ(value_of("-'x' * 'y' + 'z'"), -1);
  EXPECT_EQ(value_of("'x' - 'y' - 'z'"), -4);
  EXPECT_EQ(value_of("'x' / 'y' / 'z'"), 0.3);
  EXPECT_EQ(value_of("'x' / 'y' * 'z'"), 7.5);
  EXPECT_EQ(value_of("'x' * 'y' ^ 2"), 12);
  EXPECT_EQ(value_of("2 .^ 'x' ./ 4 .* 'z' .- 1 .+ 2"), 11);
  EXPECT_EQ(value_of("2.*'x'"), 6);
  EXPECT_EQ(value_of("+'x' - -'y'"), 5);
  EXPECT_EQ(value_of("'x' * -'y'"), -6);
  EXPECT_EQ(value_of("'x' ^ -1"), 1.0 / 3.0);
  EXPECT_EQ(value_of("'x' + (if 'b' then 1 else 2) * 2"), 5);
  EXPECT_EQ(value_of("if 'c' then 1 else 2 + 'x'"), 5);
  EXPECT_EQ(value_of("if 'c' then 1 elseif 'b' then 4 else 7"), 4);
  EXPECT_EQ(value_of("if 'c' then 1 else if 'c' then 4 else 7"), 7);
}

TEST(Precedence, OfRelationsAndLogic) {
  EXPECT_EQ(value_of("'b' or 'c' and 'c'", "Boolean"), 1);
  EXPECT_EQ(value_of("('b' or 'c') and 'c'", "Boolean"), 0);
  EXPECT_EQ(value_of("not 'b' or 'b'", "Boolean"), 1);
  EXPECT_EQ(value_of("not 'x' < 'y'", "Boolean"), 1);
  EXPECT_EQ(value_of("not 'c' and 'b'", "Boolean"), 1);
  EXPECT_EQ(value_of("'x' + 1 > 'y' * 2 and 'z' >= 5", "Boolean"), 0);
  EXPECT_EQ(value_of("'b' == (not 'c')", "Boolean"), 1);
}

TEST(Numbers, AreReadAsWritten) {
  EXPECT_EQ(value_of("'x' + 2.2250738585072014e-308"), 3 + 2.2250738585072014e-308);
  EXPECT_EQ(value_of("'x' * 1.e3"), 3000);
  EXPECT_EQ(value_of("'x' * 2E-3"), 0.006);
  EXPECT_EQ(value_of("'x' + 1."), 4);
}

TEST(BuiltIns, HaveTheValuesOfTheLanguage) {
  EXPECT_EQ(value_of("mod(-'x', 'y')"), 1);
  EXPECT_EQ(value_of("rem(-'x', 'y')"), -1);
  EXPECT_EQ(value_of("div(-'x', 'y')"), -1);
  EXPECT_EQ(value_of("mod('x', -'y')"), -1);
  EXPECT_EQ(value_of("floor(-'x' / 'y') + ceil('x' / 'y')"), 0);
  EXPECT_EQ(value_of("integer('x' / 'y')", "Integer"), 1);
  EXPECT_EQ(value_of("sign(-'x') + sign('x' - 3)", "Integer"), -1);
  EXPECT_EQ(value_of("min('x', 'y') + max({'x', 'y', 'z'})"), 7);
  EXPECT_EQ(value_of("atan2('x', 'y')"), std::atan2(3, 2));
  EXPECT_EQ(value_of("log('x') + log10('x')"), std::log(3) + std::log10(3));
  EXPECT_EQ(value_of("semiLinear('x' - 5, 'y', 'z')"), -10);
  EXPECT_EQ(value_of("homotopy('x', 'y') + homotopy(simplified = 'x', actual = 'y')"), 5);
}

TEST(Names, AreDecodedAndDiffer) {
  const FlatModel model = read("", R"(Real 'a.b[1].x', 'm[\'T\'.\'A\']', '-M.R', '$i1', x, _y; Real 'back\\slash';
    equation 'a.b[1].x' = 1; 'm[\'T\'.\'A\']' = 2; '-M.R' = 3; '$i1' = 4; x = 5; _y = 6; 'back\\slash' = 7;)");
  EXPECT_EQ(solved(model, "a.b[1].x"), 1);
  EXPECT_EQ(solved(model, "m['T'.'A']"), 2);
  EXPECT_EQ(solved(model, "-M.R"), 3);
  EXPECT_EQ(solved(model, "$i1"), 4);
  EXPECT_EQ(solved(model, "x"), 5);
  EXPECT_EQ(solved(model, "_y"), 6);
  EXPECT_EQ(solved(model, "back\\slash"), 7);
  const FlatModel both = read("", "Real 'x', x; equation 'x' = 1; x = 2;");
  EXPECT_EQ(solved(both, "'x'"), 1);
  EXPECT_EQ(solved(both, "x"), 2);
}

TEST(Attributes, AreKept) {
  const FlatModel model = read("type 'V' = Real(unit = \"V\", nominal = 10.0);", R"(
    parameter Real 'p' = 2.0;
    'V' 'x'(start = 2 * 'p', fixed = true, min = -'p', max = 5, displayUnit = "kV",
      stateSelect = StateSelect.always) "a \"voltage\"";
    output Integer 'n'(start = 3);
    parameter Real 'free'(fixed = false, start = 1);
    equation der('x') = 1; 'n' = 4;
    annotation(experiment(StartTime = 1, StopTime = 2.5, Tolerance = 1e-7, Interval = 0.1));)");
  const Variable& x = variable(model, "x");
  EXPECT_EQ(x.unit, "V");
  EXPECT_EQ(x.display_unit, "kV");
  EXPECT_EQ(x.description, "a \"voltage\"");
  EXPECT_EQ(x.state_select, StateSelect::always);
  EXPECT_TRUE(x.is_fixed);
  EXPECT_EQ(value(model, x.start, {}), 4);
  EXPECT_EQ(value(model, x.start, {{"p", 5}}), 10);
  EXPECT_EQ(value(model, x.nominal, {}), 10);
  EXPECT_EQ(value(model, x.min, {}), -2);
  EXPECT_EQ(value(model, x.max, {}), 5);
  EXPECT_EQ(x.variability, Variability::continuous);
  EXPECT_EQ(variable(model, "n").variability, Variability::discrete);
  EXPECT_TRUE(variable(model, "n").is_output);
  EXPECT_FALSE(variable(model, "n").is_fixed);
  EXPECT_FALSE(variable(model, "free").is_fixed);
  EXPECT_TRUE(variable(model, "p").is_fixed);
  EXPECT_FALSE(variable(model, "p").is_structural);
  EXPECT_EQ(model.experiment.start, 1);
  EXPECT_EQ(model.experiment.stop, 2.5);
  EXPECT_EQ(model.experiment.tolerance, 1e-7);
  EXPECT_EQ(model.experiment.interval, 0.1);
  EXPECT_TRUE(model.warnings.empty());
}

TEST(Dialects, OfOlderExportsRead) {
  const FlatModel model = read("type 'E' = enumeration(a, b \"second\");", R"(
    final parameter Real[2] 'v'(each fixed = true, each min = 0.0) = {1.0, 2.0};
    Real[2, 3] 'm'[4];
    'E' 'e';
    Real 'x' @17, 'y', 'z';
    equation
    'm' = fill(1.0, 4, 2, 3) @18;
    'e' = if time > 1 then 'E'.a else 'E'.'b';
    if time < 1.0 then 'x' = 1; elseif time < 2 then 'x' = 2; elseif true then 'x' = 3; end if;
    .'y' = pure('x');
    'z' = if 'e' == 'E.a' then 1 else 2;)");
  EXPECT_EQ(variable(model, "m[4,2,3]").type, Type::real);
  EXPECT_EQ(solved(model, "x", {{"time", 5}}), 3);
  EXPECT_EQ(solved(model, "e", {{"time", 5}}), 1);
  EXPECT_EQ(variable(model, "e").literals, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(solved(model, "z", {{"e", 1}}), 1);
  ASSERT_EQ(model.warnings.size(), 1U);
  EXPECT_NE(model.warnings[0].find("decorations"), std::string::npos);
}

TEST(Files, MayLackTheVersionAndCarryMessagesAfterTheEnd) {
  const FlatModel model =
      read_model("package 'M' model 'M' Real x; equation x = 1; end 'M'; end 'M';\nWarning: \x01 \"open", "a.bmo");
  ASSERT_EQ(model.warnings.size(), 1U);
  EXPECT_EQ(model.warnings[0].rfind("a.bmo:1:1: ", 0), 0U);
  EXPECT_EQ(model.name, "M");
  EXPECT_EQ(
      read_model("\xEF\xBB\xBF//! base 0.1.0\r\npackage 'M'\r\nmodel 'M' \"d\" Real x = 1;\r\nend 'M';\r\nend 'M';",
                 "a")
          .description,
      "d");
  EXPECT_THROW(read_model_file("/nonexistent/file.bmo"), ModelError);
}

}  // namespace sfdae::cli::testing
