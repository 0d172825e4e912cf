// Files of any size and form take bounded time, memory and stack.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "reading.h"

namespace sfdae::cli::testing {

namespace {

std::string repeated(int count, const std::function<std::string(int)>& part) {
  std::string result;
  for (int k = 1; k <= count; ++k) result += part(k);
  return result;
}

std::string repeated(int count, const std::string& part) {
  return repeated(count, [&](int) { return part; });
}

void expect_limit(const std::string& text, const std::string& words) {
  const std::string message = error_of(text);
  EXPECT_NE(message.find(words), std::string::npos) << message.substr(0, 300);
}

}  // namespace

TEST(Limits, OfNesting) {
  EXPECT_EQ(error_of(package("", "Real 'x' = " + repeated(150, "(") + "1" + repeated(150, ")") + ";")), "");
  for (const char* open : {"(", "{", "[", "sin(", "-(", "not (", "if true then 1 else (", "'a'[", "1 ^ ("})
    expect_limit(package("", "Real 'x' = " + repeated(20000, open)), "nested deeper than 200 levels");
  expect_limit(package("", "equation " + repeated(20000, "if true then ")), "nested deeper than 200 levels");
  expect_limit(package("", "algorithm " + repeated(20000, "for 'i' in 1:2 loop ")), "nested deeper than 200 levels");
  expect_limit(package("", "Real 'x'" + repeated(20000, "(a")), "nested deeper than 200 levels");
  expect_limit(package("", "Real 'x' = 'a'" + repeated(20000, ".'b'") + ";"), "more than 200 members");
  expect_limit(package(repeated(20000, "class 'A' extends ExternalObject; "), ""), "nested deeper than 200 levels");
}

TEST(Limits, LongSumsAndChainsAreNoNesting) {
  const FlatModel model = read("", "Real 'x' = 1" + repeated(20000, " + time - 0.5") + ";");
  EXPECT_EQ(solved(model, "x", {{"time", 1}}), 10001);
  EXPECT_EQ(solved(read("", "Real 'x' = " +
                                repeated(500,
                                         [](int k) {
                                           return "if time < " + std::to_string(k) + " then " + std::to_string(k) +
                                                  " else ";
                                         }) +
                                "0;"),
                   "x", {{"time", 350.5}}),
            351);
}

TEST(Limits, OfArraysAndLoops) {
  expect_limit(package("", "Real 'x'[1000000000];"), "more than 1000000 elements");
  expect_limit(package("", "Real 'x'[100000, 100000];"), "more than 1000000 elements");
  expect_limit(package("", "Real 'x' = sum(fill(1.0, 100000, 100000));"), "more than 1000000 elements");
  expect_limit(package("", "Real 'x' = sum(i for i in 1:1000000000);"), "more than 1000000 elements");
  expect_limit(package("", "Real 'x' = sum(identity(100000));"), "more than 1000000 elements");
  expect_limit(package("", "Real 'x'[-1];"), "negative");
  expect_limit(package("",
                       "Real 'x'; equation for 'i' in 1:1000 loop for 'j' in 1:1000 loop for 'k' in 1:1000 loop end "
                       "for; end for; end for;"),
               "million steps");
  expect_limit(
      package("function 'f' output Real 'y'; algorithm 'y' := 1; while true loop 'y' := 1; end while; end 'f';",
              "Real 'x' = 'f'();"),
      "million steps");
  expect_limit(package("function 'f' input Real 'x'; output Real 'y'; algorithm 'y' := 'x'; for 'i' in 1:100000 loop "
                       "'y' := sin('y'); end for; end 'f';",
                       "Real 'x' = 'f'(time);"),
               "nested deeper than 2000");
  expect_limit(
      package(
          "function 'f' input Integer 'n'; output Real 'y'; algorithm 'y' := 'f'('n' + 1) + 'f'('n' + 2); end 'f';",
          "Real 'x' = 'f'(1);"),
      "calls itself");
  expect_limit(package("record 'R' 'R' 'r'; end 'R';", "'R' 'x';"), "records within records");
  expect_limit(package("record 'R' 'S' 'a'[100]; end 'R'; record 'S' 'T' 'a'[100]; end 'S'; record 'T' 'U' 'a'[100]; "
                       "end 'T'; record 'U' Real 'a'[100]; end 'U';",
                       "'R' 'x';"),
               "more than");
}

TEST(Limits, LargeFilesAreReadInLinearTime) {
  // 20000 equations of a chain, 1.5 MB; quadratic work would take minutes.
  const int n = 20000;
  const FlatModel model = read("", repeated(n,
                                            [](int k) {
                                              return "Real 'chain.x[" + std::to_string(k) +
                                                     "]'(start = 1.0, fixed = true, unit = \"m\");\n";
                                            }) +
                                       "equation\n" + repeated(n, [](int k) {
                                         const std::string x = "'chain.x[" + std::to_string(k) + "]'";
                                         return "der(" + x + ") = 2.0 * 'chain.x[" + std::to_string(k % 20000 + 1) +
                                                "]' - " + x + " * sin(time);\n";
                                       }));
  EXPECT_EQ(model.equations.size(), static_cast<size_t>(n));
}

TEST(Limits, LongChainsOfDiscreteAliases) {
  const int n = 5000;
  const FlatModel model =
      read("", "Boolean 'b'[" + std::to_string(n) + "]; equation for 'i' in 1:" + std::to_string(n - 1) +
                   " loop 'b'['i'] = 'b'['i' + 1]; end for; 'b'[1] = time > 1;");
  EXPECT_EQ(solved(model, "b[5000]", {{"b[4999]", 1}}), 1);
}

}  // namespace sfdae::cli::testing
