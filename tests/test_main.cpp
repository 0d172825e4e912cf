// SPDX-License-Identifier: BSD-3-Clause
// main() of the GoogleTest programs. With SFDAE_TEST_FPE_TRAPS=1 in the environment a division by zero, an overflow
// and an invalid operation end the program. With the argument --source=<name>_test.cpp the tests of that file are run.

#include <gtest/gtest.h>

#include <cfenv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

namespace {

bool traps_wanted() {
  const char* value = std::getenv("SFDAE_TEST_FPE_TRAPS");
  return value != nullptr && std::strcmp(value, "1") == 0;
}

// What a program of several files is made of: tests of other files, say of a header, would be run by no entry of ctest.
std::string file_of(const testing::TestInfo& test) {
  const std::string_view path = test.file();
  const std::string_view name = path.substr(path.find_last_of('/') + 1);
  const std::string_view ending = "_test.cpp";
  if (name.size() < ending.size() || name.substr(name.size() - ending.size()) != ending)
    throw std::runtime_error(std::string(path) + " has tests, but is not named *_test.cpp");
  return std::string(name);
}

// The filter that chooses the tests of this file: whole suites where all of their tests are in it, which is shorter.
std::string filter_of(const std::string& file) {
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  std::string filter;
  for (int i = 0; i < all.total_test_suite_count(); ++i) {
    const testing::TestSuite& suite = *all.GetTestSuite(i);
    const std::string name = std::string(suite.name()) + ".";
    std::string tests;
    int chosen = 0;
    for (int j = 0; j < suite.total_test_count(); ++j) {
      const testing::TestInfo& test = *suite.GetTestInfo(j);
      if (file_of(test) != file) continue;
      tests += name + test.name() + ":";
      ++chosen;
    }
    filter += chosen == suite.total_test_count() ? name + "*:" : tests;
  }
  if (filter.empty()) throw std::runtime_error("there are no tests in " + file);
  return filter;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const std::string_view option = "--source=";
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument.substr(0, option.size()) != option) continue;
    try {
      testing::GTEST_FLAG(filter) = filter_of(std::string(argument.substr(option.size())));
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
      return 1;
    }
  }
  if (traps_wanted()) {
#ifdef __GLIBC__
    feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW);
#else
    std::fputs("SFDAE_TEST_FPE_TRAPS needs the GNU C library\n", stderr);
    return 1;
#endif
  }
  return RUN_ALL_TESTS();
}
