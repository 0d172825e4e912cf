// What the routines of the Fortran 77 layer want to know about the calls of the user's subroutines.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "f77/user_functions.h"
#include "sfdae/sfdae.h"

namespace sfdae::f77 {

class UserProblem {
 public:
  UserProblem() = default;
  UserProblem(const UserProblem&) = delete;
  UserProblem& operator=(const UserProblem&) = delete;
  virtual ~UserProblem() = default;

  bool has_wrong_width() const { return has_wrong_width_; }
  bool lacks_derivative() const { return lacks_derivative_; }  // one that could not be done without
  int callback_error() const { return callback_error_; }       // the last one: SFDAE_...
  double last_t() const { return last_t_; }                    // at which a subroutine was called
  // Points at which the equations were evaluated.
  long points() const { return points_; }

 protected:
  // What callbacks return to the core.
  static constexpr int point_failed = 1, stop_at_once = -1;
  // code: what a call came to. Returns what a callback of the core returns for it.
  int result_of(int code) {
    switch (code) {
      case function_ok: return 0;
      case order_not_available: callback_error_ = SFDAE_ORDER_MISSING; return SFDAE_ORDER_NOT_AVAILABLE;
      case wrong_integer_width:
        has_wrong_width_ = true;
        callback_error_ = SFDAE_CALLBACK_STOPPED;
        return stop_at_once;
      default: callback_error_ = SFDAE_CALLBACK_FAILED; return point_failed;
    }
  }
  int stop_for_missing_derivative() {
    lacks_derivative_ = true;
    return stop_at_once;
  }
  void count_point(double t, bool is_new) {
    last_t_ = t;
    points_ += is_new ? 1 : 0;
  }

 private:
  bool has_wrong_width_ = false;
  bool lacks_derivative_ = false;
  int callback_error_ = SFDAE_OK;
  double last_t_ = 0.0;
  long points_ = 0;
};

}  // namespace sfdae::f77
