// Arithmetic without floating-point exceptions, for programs that trap them: overflows are detected in the results.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cfenv>

namespace sfdae::core {

// During its lifetime no exception is raised.
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
