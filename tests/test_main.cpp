// SPDX-License-Identifier: BSD-3-Clause
// main() of the GoogleTest programs. With SFDAE_TEST_FPE_TRAPS=1 in the environment a division by zero, an overflow
// and an invalid operation end the program.

#include <gtest/gtest.h>

#include <cfenv>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

bool traps_wanted() {
  const char* value = std::getenv("SFDAE_TEST_FPE_TRAPS");
  return value != nullptr && std::strcmp(value, "1") == 0;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
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
