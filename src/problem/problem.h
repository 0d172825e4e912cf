// Base of all problems, whatever their equations: errors of callbacks, requests to stop, limits.
//
// Folder problem: the user's equations, linear or nonlinear, checked and counted; they deliver Taylor coefficients.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "expression/equation_names.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

// Error of a callback. status: SFDAE_OK, _CALLBACK_STOPPED, _CALLBACK_FAILED, _NOT_FINITE, _ORDER_MISSING,
// _WRONG_PATTERN, _WRONG_DERIVATIVES (a derivative array contradicts itself) or _STOPPED (a stop request).
struct CallbackError {
  int status = SFDAE_OK;
  const char* function = "";
  int order = 0;
  int code = 0;  // return value of the callback
  int row = 0;   // of the first entry that is not finite
  int column = 0;
  const EquationNames* names = nullptr;  // of the rows; owned by the problem, which lives longer
  double t = 0.0;
  // If t is an internal point of the library, the time of the user's that it is close to. NaN: all times are the
  // user's.
  double user_t = std::numeric_limits<double>::quiet_NaN();
  std::string detail;  // text in place of function and order

  // A smaller step may help.
  bool is_recoverable() const { return status == SFDAE_CALLBACK_FAILED || status == SFDAE_NOT_FINITE; }
  std::string message() const;
  // "t = 0.5", or "the internal point t = 0.5007, beside t0 = 0.5"
  std::string where() const;
  // Throws Failure.
  [[noreturn]] void raise() const;
};

// Message: a matrix has an entry that is not in its pattern.
std::string lacking_entry(const char* matrix, const std::string& row, int column, double value,
                          const std::string& where);

// Limit on unknowns of problems with dense matrices: more are a mistake, and sizes would overflow.
constexpr int most_dense_unknowns = 5000;

// Components prescribed as functions of time.
struct PrescribedInputs {
  std::vector<int> components;
  sfdae_vector_function values = nullptr;
  void* user = nullptr;
};

class Problem {
 public:
  // Evaluations within [lowest, highest] use no difference points outside.
  void set_limits(double lowest, double highest) {
    lowest_t_ = lowest;
    highest_t_ = highest;
  }
  // See CallbackError::user_t.
  double user_t() const { return user_t_; }

  // Distance from t to the limit in a direction (+1 or -1).
  double room(double t, double direction) const { return direction > 0.0 ? highest_t_ - t : t - lowest_t_; }

  void request_stop() { stop_requested_.store(true, std::memory_order_relaxed); }
  // True once for every request.
  bool take_stop_request() { return stop_requested_.exchange(false, std::memory_order_relaxed); }
  bool stop_is_requested() const {
    return stop_requested_.load(std::memory_order_relaxed) || time_is_up() ||
           (leader_ != nullptr && leader_->stop_is_requested());
  }
  // True if the call takes longer than its TimeLimit.
  bool time_is_up() const {
    return (deadline_ && std::chrono::steady_clock::now() >= *deadline_) ||
           (leader_ != nullptr && leader_->time_is_up());
  }
  void set_equation_names(EquationNames names) { equation_names_ = std::move(names); }
  const EquationNames& equation_names() const { return equation_names_; }

  // Further remarks for messages if the structure, or a rank, is lost just after the point (t, x); n values.
  virtual std::string about_singular_point(double, const double*) { return {}; }

  // Values of the functions at t are requested once until forget_values(), as they do not change. Called by KeptValues.
  virtual void keep_values(double) {}
  virtual void forget_values() {}

  // Number of evaluations that failed because of the equations.
  long failed_evaluations() const { return failed_evaluations_; }

  // Calls of the user's functions that only check derivatives; no other counter includes them.
  long check_evaluations() const { return check_evaluations_; }
  // Stops when the leader is asked to, and leaves its request pending.
  void stop_with(const Problem& leader) { leader_ = &leader; }

 protected:
  Problem() = default;
  // Copies the equations, but not limits and requests.
  Problem(const Problem& other) : equation_names_(other.equation_names_) {}
  ~Problem() = default;

  EquationNames equation_names_;
  bool is_checking_ = false;
  long check_evaluations_ = 0;
  mutable long failed_evaluations_ = 0;

  double lowest_t_ = -std::numeric_limits<double>::infinity();
  double highest_t_ = std::numeric_limits<double>::infinity();

 private:
  friend class UserTime;
  friend class TimeLimit;
  friend class DerivativeChecking;

  std::atomic<bool> stop_requested_{false};
  std::optional<std::chrono::steady_clock::time_point> deadline_;  // set and removed by the thread of the call
  const Problem* leader_ = nullptr;
  double user_t_ = std::numeric_limits<double>::quiet_NaN();
};

// Limits a call to this many seconds: a stop is requested as long as it lives and they have passed. 0: no limit.
class TimeLimit {
 public:
  TimeLimit(Problem& problem, double seconds) : problem_(problem), is_set_(seconds > 0.0 && !problem.deadline_) {
    using Clock = std::chrono::steady_clock;
    constexpr double most_seconds = 1e9;  // 30 years; a clock counts nanoseconds in 64 bits
    if (is_set_)
      problem_.deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                              std::chrono::duration<double>(std::min(seconds, most_seconds)));
  }
  TimeLimit(const TimeLimit&) = delete;
  TimeLimit& operator=(const TimeLimit&) = delete;
  ~TimeLimit() {
    if (is_set_) problem_.deadline_.reset();
  }

 private:
  Problem& problem_;
  bool is_set_;
};

// While it lives, messages name this time t: other times are points of an analysis, or of differences.
class UserTime {
 public:
  UserTime(Problem& problem, double t) : problem_(problem) { problem_.user_t_ = t; }
  UserTime(const UserTime&) = delete;
  UserTime& operator=(const UserTime&) = delete;
  ~UserTime() { problem_.user_t_ = std::numeric_limits<double>::quiet_NaN(); }

 private:
  Problem& problem_;
};

// While it lives, within one call by the user, the functions do not change: each is evaluated at t once, if it can be
// stored.
class KeptValues {
 public:
  KeptValues(Problem& problem, double t) : problem_(problem) { problem_.keep_values(t); }
  KeptValues(const KeptValues&) = delete;
  KeptValues& operator=(const KeptValues&) = delete;
  ~KeptValues() { problem_.forget_values(); }

 private:
  Problem& problem_;
};

// While it lives, calls count as those of a check of derivatives.
class DerivativeChecking {
 public:
  explicit DerivativeChecking(Problem& problem) : problem_(problem) { problem_.is_checking_ = true; }
  DerivativeChecking(const DerivativeChecking&) = delete;
  DerivativeChecking& operator=(const DerivativeChecking&) = delete;
  ~DerivativeChecking() { problem_.is_checking_ = false; }

 private:
  Problem& problem_;
};

}  // namespace sfdae::core
