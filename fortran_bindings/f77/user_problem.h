// What the routines of the Fortran 77 layer want to know about the calls of the user's subroutines.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstring>
#include <vector>

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
  // Whether the subroutines are compiled for INTEGERs of another width than those they are given: the same call is made
  // again with what they cannot see if they are not. x: n values.
  virtual bool has_other_width(double t, const double* x) = 0;
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

  // Whether a call shows what it should not see: evaluate(high_word, values) writes so many values and returns a code.
  template <class Evaluate>
  static bool sees(HighWord high_word, std::size_t size, Evaluate evaluate) {
    // What is not written stays; an ordinary number, in case it is used.
    constexpr double untouched = 0.7315489136;
    const auto result = [&](HighWord given) {
      std::vector<double> values(size + 1, untouched);
      values[size] = evaluate(given, values.data());
      return values;
    };
    const auto are_equal = [](const std::vector<double>& a, const std::vector<double>& b) {
      return std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
    };
    const std::vector<double> first = result(HighWord::zero);
    if (first[size] == wrong_integer_width) return true;
    // Functions that answer the same call in different ways tell nothing.
    return !are_equal(first, result(high_word)) && are_equal(first, result(HighWord::zero));
  }

 private:
  bool has_wrong_width_ = false;
  bool lacks_derivative_ = false;
  int callback_error_ = SFDAE_OK;
  double last_t_ = 0.0;
  long points_ = 0;
};

}  // namespace sfdae::f77
