// What is not accepted is named, with its place.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <string>

#include "reading.h"

namespace sfdae::cli::testing {

namespace {

// The error stands where the text has the mark, and its message contains the words.
void expect_error(const std::string& definitions, const std::string& model, const std::string& mark,
                  const std::string& words) {
  const std::string text = package(definitions, model), message = error_of(text);
  EXPECT_EQ(message.rfind("test.bmo:" + place(text, mark) + ": ", 0), 0U)
      << message << "\nexpected at " << place(text, mark) << " " << mark;
  EXPECT_NE(message.find(words), std::string::npos) << message;
}

}  // namespace

// Positions count from 1; an end before the start is an error of the function, not an empty string.
TEST(Rejections, OfPartsThatStringsDoNotHave) {
  const std::string functions =
      "function 'part' input String 's'; input Integer 'i', 'j'; output String 'r'; external \"C\" 'r' = "
      "ModelicaStrings_substring('s', 'i', 'j'); end 'part'; function 'length' input String 's'; output Integer 'n'; "
      "external \"C\" 'n' = ModelicaStrings_length('s'); end 'length';";
  EXPECT_EQ(error_of(package(functions,
                             "parameter Integer 'n' = 'length'('part'(\"abcdef\", 2, 6)); Real 'x'['n'] = "
                             "fill(time, 5);")),
            "");
  for (const std::string range : {"2, 0", "3, 2", "0, 2", "2, 7"}) {
    const std::string message =
        error_of(package(functions, "Integer 'n' = 'length'('part'(\"abcdef\", " + range + "));"));
    const std::size_t comma = range.find(',');
    EXPECT_NE(message.find("a string of 6 characters has no part from " + range.substr(0, comma) + " to " +
                           range.substr(comma + 2)),
              std::string::npos)
        << message;
  }
}

TEST(Rejections, OfWhatIsNotFlat) {
  expect_error("", "extends 'A';", "extends", "not flat");
  expect_error("", "import A;", "import", "not flat");
  expect_error("", "inner Real 'x';", "inner", "not flat");
  expect_error("", "replaceable Real 'x';", "replaceable", "not flat");
  expect_error("", "flow Real 'x';", "flow", "not flat");
  expect_error("", "Real 'x' if 'b';", "if 'b'", "conditional declaration");
  expect_error("", "Real 'x'; equation connect('a', 'b');", "connect", "omc --baseModelica");
  expect_error("", "equation partition", "partition", "clocked partitions");
  expect_error("", "Clock 'c';", "Clock", "clocks ('Clock')");
  expect_error("", "Real 'x' = hold('x');", "hold", "'hold' is not supported");
  expect_error("", "Real 'x', 'u'; equation when sample('u', Clock(1, 2)) then 'x' = 1; end when;", "Clock",
               "not supported");
  expect_error("", "Boolean 'x' = sample(1.0);", "sample", "sample(start, interval)");
  expect_error("", "Real 'x' = delay(time, 1.0);", "delay", "'delay' is not supported");
  expect_error("", "Real 'x' = spatialDistribution(1.0, 2.0);", "spatialDistribution", "not supported");
}

TEST(Rejections, OfSyntax) {
  expect_error("", "Real 'x'; equation 'x' = ;", ";\nend", "expected an expression");
  expect_error("", "Real 'x' equation", "equation", "expected ';'");
  expect_error("", "Real 'x'; equation 'x' := 1;", ":=", "written with '='");
  expect_error("", "Real 'x'; algorithm 'x' = 1;", "= 1", "written with ':='");
  expect_error("", "Real 'x' = 1 < 2 < 3;", "< 3", "parentheses");
  expect_error("", "Real 'x' = 2 ^ 3 ^ 4;", "^ 4", "parentheses");
  expect_error("", "Real 'x' = \"open;", "\"open", "string is not closed");
  expect_error("", "Real 'x;\n", "'x;", "quoted name is not closed");
  expect_error("", "Real 'x'; /* open", "/* open", "comment");
  expect_error("", "Real 'x' = 1 $ 2;", "$", "not a token");
  expect_error("", "Real 'x'; equation if true then 'x' = 1; end for;", "for;", "expected 'if' after 'end'");
  expect_error("", "equation for 'i' loop end for;", "'i'", "range");
  expect_error("record 'R' Real 'a'; end 'S';", "", "'S'", "closes 'R'");
  expect_error("junk", "", "junk", "expected a definition");
  EXPECT_NE(error_of("package 'A' end 'A';").find("has no model"), std::string::npos);
  EXPECT_NE(error_of("").find("1:1: expected 'package'"), std::string::npos);
}

TEST(Rejections, OfNamesAndTypes) {
  expect_error("", "Real 'x' = 'y';", "'y'", "unknown name 'y'");
  expect_error("", "Real 'x'; Real 'z' = x;", "x;\nend", "in quotes");
  expect_error("", "Real 'x' = foo(1);", "foo", "unknown function 'foo'");
  expect_error("", "Foo 'x';", "Foo", "unknown type 'Foo'");
  expect_error("", "Real 'x'(strat = 1);", "1);", "unknown attribute 'strat'");
  expect_error("", "Real 'x'; Real 'x';", "'x';\nend", "declared twice");
  expect_error("", "Real 'x' = 1 + true;", "+", "'+' between Integer and Boolean");
  expect_error("", "Real 'x' = sin(true);", "true", "expected a number");
  expect_error("", "Boolean 'x' = 1;", "1;", "make the types agree");
  expect_error("", "Real 'x' = sin(1, 2);", "sin", "takes 1 arguments, not 2");
  expect_error("", "Real 'x'[2] = {1, 2, 3};", "{1", "size");
  expect_error("", "Real 'x'[2]; equation 'x' = 1;", "'x' = 1", "an equation between Real[2] and Integer");
  expect_error("", "Real 'x'[2] = {1, 2}, 'y' = 'x'[3];", "3];", "out of range");
  expect_error("", "Real 'x' = if 1 then 2 else 3;", "1 then", "expected a Boolean");
  expect_error("type 'A' = 'B'; type 'B' = 'A';", "'A' 'x';", "'A' 'x'", "defined by itself");
  expect_error("type 'E' = enumeration('a');", "'E' 'x' = 'E'.'b';", ".'b'", "has no literal 'b'");
  expect_error("record 'R' Real 'a'; end 'R';", "'R' 'r'; Real 'x' = 'r'.'b';", ".'b'", "has no field 'b'");
  expect_error("", "String 's' = \"a\";", "'s'", "String variable");
  expect_error("", "parameter Real 'p' = time;", "'p'", "depends on time or a variable");
  expect_error("", "Real 'x'(start = 'y'), 'y';", "'y'), ", "depends on time or a variable");
}

TEST(Rejections, OfParameters) {
  expect_error("", "parameter Real 'a' = 'b', 'b' = 'c', 'c' = 'a'; Real 'x' = 'a';",
               "'a' =", "'a' -> 'b' -> 'c' -> 'a'");
  expect_error("", "constant Real 'a' = 'b', 'b' = 'a'; Real 'x' = 'a';", "'a'; Real", "depends on itself");
  expect_error("", "parameter Integer 'n' = 'n' + 1; Real 'x'['n'];", "'n' =", "depends on itself");
  expect_error("", "parameter Real 'a'; Real 'x' = 'a';", "'a'", "has no value");
  EXPECT_EQ(error_of(package("", "parameter Real 'unused'; Real 'x' = 1;")), "");
  expect_error("", "parameter Integer 'n'(fixed = false); Real 'x'['n'];", "'n'];", "varies");
  expect_error("", "Integer 'n' = 2; Real 'x'['n'];", "'n'];", "varies");
}

TEST(Rejections, OfFunctions) {
  const std::string external =
      "function 'f' input Real 'x'; output Real 'y'; external \"C\" 'y' = foo('x'); end 'f';";
  expect_error(external, "Real 'x' = 'f'(time);", "external", "the external function 'foo' is not supported");
  EXPECT_EQ(error_of(package(external, "Real 'x' = 1;")), "");
  expect_error("function 'f' input Real 'x'; output Real 'y'; algorithm 'y' := 'f'('x'); end 'f';",
               "Real 'x' = 'f'(time);", "'f'('x')", "calls itself more than");
  expect_error(
      "function 'f' input Real 'x'; output Real 'y'; protected Real 'a'; algorithm 'y' := 'a' + 'x'; end 'f';",
      "Real 'x' = 'f'(time);", "+ 'x'", "before it has been assigned");
  expect_error("function 'f' input Real 'x'; output Real 'y'; algorithm 'x' := 1; end 'f';", "Real 'x' = 'f'(time);",
               "'x' := 1", "is an input");
  expect_error("function 'f' input Real 'x'; output Real 'y'; algorithm 'y' := time; end 'f';", "Real 'x' = 'f'(1);",
               "time", "unknown name 'time'");
  expect_error("function 'f' input Real 'x'; output Real 'y'; algorithm 'y' := der('x'); end 'f';",
               "Real 'x' = 'f'(time);", "der", "in a function");
  expect_error("partial function 'f' input Real 'x'; output Real 'y'; end 'f';", "Real 'x' = 'f'(1);", "'f'(1)",
               "no algorithm");
  expect_error("function 'f' input Real 'x'[2]; output Real 'y'; algorithm 'y' := 'x'[1]; end 'f';",
               "Real 'x' = 'f'({1, 2, 3});", "'f'({", "has the size [2] but gets [3]");
  expect_error("function 'f' input Real 'x'; output Real 'y'; algorithm 'y' := 'x'; end 'f';",
               "Real 'x' = 'f'(1, 2);", "2);", "more arguments");
  expect_error("function 'f' input Real 'x'; output Real 'y'; algorithm 'y' := 'x'; end 'f';", "Real 'x' = 'f'();",
               "'f'()", "is not given");
  expect_error(
      "class 'T' extends ExternalObject; end 'T'; function 'g' input 'T' 't'; output Real 'y'; external \"C\" 'y' = "
      "get('t'); end 'g';",
      "parameter 'T' 't' = 'T'(); Real 'x' = 'g'('t');", "external \"C\"",
      "external function 'get' is not supported");
}

TEST(Rejections, OfEquations) {
  expect_error("", "Real 'x', 'y'; equation if time > 1 then 'x' = 1; 'y' = 2; else 'x' = 1; end if;", "if time",
               "branches of 2 and 1 equations");
  expect_error("", "Real 'x'; equation if time > 1 then 'x' = 1; end if;", "if time", "a missing else has none");
  expect_error("", "Real 'x', 'y'; equation if time > 1 then when 'x' > 1 then 'y' = 1; end when; end if;", "if time",
               "when clause in an if-equation");
  expect_error("", "Real 'x'; equation when time > 1 then when time > 2 then 'x' = 1; end when; end when;",
               "when time > 2", "within another");
  expect_error("", "Real 'x'; initial equation when time > 1 then 'x' = 1; end when;", "when time",
               "initial section");
  expect_error("", "Real 'x'; equation reinit('x', 1);", "reinit", "outside of a when clause");
  expect_error("", "Real 'x'; equation when time > 1 then reinit('x', 1); end when;", "reinit", "not differentiated");
  expect_error("",
               "Real 'x'; equation der('x') = 1; when time > 1 then reinit('x', 1); end when; when time > 2 then "
               "reinit('x', 2); end when;",
               "reinit('x', 2)", "in two when clauses");
  expect_error("", "Real 'x'; equation when time > 1 then 'x' = 1; end when; when time > 2 then 'x' = 2; end when;",
               "'x' = 2", "in two when clauses");
  expect_error("", "Real 'x'; equation when time > 1 then 'x' + 1 = 2; end when;", "'x' + 1", "no variable");
  expect_error("", "parameter Real 'p' = 1; equation when time > 1 then 'p' = 2; end when;", "'p' = 2",
               "cannot be assigned");
  expect_error("", "parameter Real 'p' = 1; algorithm 'p' := 2;", "'p' :=", "cannot be assigned");
  expect_error("", "Integer 'n'; Real 'x' = der('n');", "der", "which is discrete");
  expect_error("", "Real 'n'; Real 'x' = der('n'); equation when time > 1 then 'n' = 1; end when;", "'x' = der",
               "which is discrete");
  expect_error("", "Real 'x' = time; Boolean 'b' = 'x' == 1.0;", "== 1.0", "Reals that vary continuously");
  EXPECT_EQ(error_of(package("", "parameter Real 'x' = 1; Boolean 'b' = 'x' == 1.0;")), "");
  expect_error("", "Boolean 'b', 'c'; equation 'b' = true; 'c' and 'b' = time > 1;", "'c' and",
               "determines no variable");
  // false and 0 on the left are values, too: 'p' does not change that of the relation.
  for (const char* const text : {"Boolean 'b'; equation false = 'b';", "Integer 'n'; equation 0 = 'n';",
                                 "constant Real 'c'[2] = {0.5, 0.6}; parameter Integer 'p' = 3; Boolean 'b' = "
                                 "'c'[1 + mod('p', 2)] < -0.6;",
                                 "constant Real 'c'[2] = {0.5, 0.6}; parameter Integer 'p' = 3; Boolean 'b'; "
                                 "equation ('c'[1 + mod('p', 2)] < -0.6) = 'b';"})
    EXPECT_EQ(error_of(package("", text)), "") << text;
  expect_error("", "Integer 'n'; equation 'n' = 1.5 * time;", "'n'; equation", "no discrete equation");
  expect_error("", "discrete Real 'd' = time;", "'d' = time", "no discrete equation");
  expect_error("", "Integer 'n'; Real 'x'; equation 2 * 'n' = 'x'; 'x' = time;", "'n'; Real", "no discrete equation");
  expect_error("", "Integer 'n'; equation when time > 1 then 'n' = 1.5; end when;", "'n' = 1.5", "use integer(...)");
  expect_error("", "equation 1 = 2;", "1 = 2", "not true");
  expect_error("", "Real 'x' = pre(sin(time));", "pre(", "of a formula");
  expect_error("", "equation assert(1, \"a\");", "1, ", "expected a Boolean");
}

TEST(Rejections, OfTextAfterTheLastEnd) {
  const std::string text = package("", "Real 'x' = time;");
  for (const std::string after : {"hello world", "'x' = 3;", "; ;", "end 'M';", "\"text\""}) {
    const std::string message = error_of(text + after);
    EXPECT_NE(message.find("expected the end of the file after the last end"), std::string::npos) << after << message;
  }
  for (const std::string after :
       {"", "\n\n", "// a comment\n", "/* another */", "Notification: it's done", "[a.mo:1:2] Error: no"})
    EXPECT_EQ(error_of(text + after), "");
}

}  // namespace sfdae::cli::testing
