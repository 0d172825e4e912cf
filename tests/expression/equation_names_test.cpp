// SPDX-License-Identifier: BSD-3-Clause
#include "expression/equation_names.h"

#include <gtest/gtest.h>

#include <string>

namespace sfdae::core {
namespace {

TEST(EquationNames, FollowTheNumber) {
  const EquationNames names({"balance of mass", "", "level"});
  EXPECT_EQ(names.in_words(0), "equation 0 (balance of mass)");
  EXPECT_EQ(names.row(2), "equation 2 (level)");
  EXPECT_EQ(names.appended_to("residual[2]", 2), "residual[2] (level)");
}

TEST(EquationNames, AreLeftOutWhereThereAreNone) {
  const EquationNames names({"balance of mass", ""}), none;
  EXPECT_EQ(names.in_words(1), "equation 1");
  EXPECT_EQ(names.row(1), "row 1");
  EXPECT_EQ(none.in_words(7), "equation 7");
  EXPECT_EQ(none.row(7), "row 7");
  // What lies outside, as -1 for "none in particular".
  EXPECT_EQ(names[2], "");
  EXPECT_EQ(names[-1], "");
}

// A message keeps its one line, and its room for other things.
TEST(EquationNames, FitIntoALine) {
  EXPECT_EQ(EquationNames({"two\nlines\tand a tab"})[0], "two lines and a tab");
  const std::string just_fits(80, 'a');
  EXPECT_EQ(EquationNames({just_fits})[0], just_fits);
  std::string cut = just_fits;
  cut.replace(77, 3, "...");
  EXPECT_EQ(EquationNames({std::string(81, 'a')})[0], cut);
}

// Characters of two bytes from byte 1 on: the cut at 77 would fall between theirs.
TEST(EquationNames, AreCutBetweenCharacters) {
  std::string name = "a";
  for (int i = 0; i < 50; ++i) name += "\xc3\xa4";
  const std::string cut = EquationNames({name})[0];
  EXPECT_EQ(cut, name.substr(0, 77) + "...");
  const std::string shifted = EquationNames({name.substr(1)})[0];
  EXPECT_EQ(shifted, name.substr(1, 76) + "...");
}

}  // namespace
}  // namespace sfdae::core
