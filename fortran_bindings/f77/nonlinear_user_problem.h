// The user's subroutine of SFNDAE or SFNDAF.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "f77/user_problem.h"
#include "problem/callback_problem.h"

namespace sfdae::f77 {

class NonlinearUserProblem : public UserProblem {
 public:
  // For core::NonlinearModel; this object must outlive it.
  virtual std::unique_ptr<core::CallbackProblem> problem() = 0;
};

}  // namespace sfdae::f77
