// Arithmetic whose overflows are seen in its results, in programs that let floating-point exceptions end them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cfenv>

namespace sfdae::core {

// No exception is raised while it lives.
class QuietArithmetic {
 public:
  QuietArithmetic() {
#ifdef __GLIBC__
    has_traps_ = fegetexcept() != 0;
#endif
    if (has_traps_) std::feholdexcept(&environment_);
  }
  ~QuietArithmetic() {
    if (has_traps_) std::fesetenv(&environment_);
  }
  QuietArithmetic(const QuietArithmetic&) = delete;
  QuietArithmetic& operator=(const QuietArithmetic&) = delete;

 private:
  std::fenv_t environment_;
  bool has_traps_ = false;
};

}  // namespace sfdae::core
