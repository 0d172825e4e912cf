// SPDX-License-Identifier: BSD-3-Clause
// A LinearFamily as the callbacks of a sfdae_linear_problem: counts the calls, and misbehaves on demand.
#ifndef SFDAE_TESTS_FAMILY_PROBLEM_H
#define SFDAE_TESTS_FAMILY_PROBLEM_H

#include <array>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <sfdae/sfdae.h>

#include "linear_family.h"

namespace sfdae_test {

enum class Callback { E, A, f };

struct Call {
  Callback function;
  double t;
  int order;
  long number;  // of this call among all calls, from 1
};

// What the callbacks do besides their duty.
struct CallbackHooks {
  int highest_order = max_family_order;  // above: SFDAE_ORDER_NOT_AVAILABLE
  // Runs first; anything but 0 is returned at once, the array untouched.
  std::function<int(const Call&)> status = nullptr;
  // Runs last, may change the values.
  std::function<void(const Call&, std::span<double> values)> tamper = nullptr;
  bool measure_time = false;
};

// The usual hooks.
std::function<int(const Call&)> return_at_call(long number, int status);  // at that call alone
std::function<int(const Call&)> return_behind(double t, int status);      // at every call with time > t
std::function<void(const Call&, std::span<double>)> poison_behind(double t, double value);  // first entry, time > t

// E, A, f and all their orders at one t share the Taylor coefficients, and the last few t are kept.
// `problem` refers to this object, which has to live as long as the solver. For one thread.
class FamilyProblem {
 public:
  explicit FamilyProblem(std::shared_ptr<const LinearFamily> family, CallbackHooks hooks = {});
  FamilyProblem(const FamilyProblem&) = delete;
  FamilyProblem& operator=(const FamilyProblem&) = delete;

  // constant_E and constant_A are 0 even where the family is constant; declare_constants sets them.
  sfdae_linear_problem problem;
  CallbackHooks hooks;

  void declare_constants();
  const LinearFamily& family() const { return *family_; }
  int m() const { return family_->m(); }
  int n() const { return family_->n(); }

  // Counts since construction or the last reset, calls that failed included.
  long calls(Callback function) const;  // of all orders
  long calls(Callback function, int order) const;
  long calls() const { return count_; }
  int highest_order_asked() const { return highest_order_asked_; }  // -1: none
  double seconds() const { return seconds_; }                       // spent in callbacks, if measure_time
  void reset_counts();

 private:
  // Plain derivatives 0..order at t, one after the other.
  struct Slot {
    double t = 0.0;
    int order = -1;
    std::vector<double> values[2];  // E and A, or f
  };
  // Remembers the last points; builds at once as many orders as the point before needed.
  struct Cache {
    std::array<Slot, 4> slots;
    std::size_t oldest = 0;
    int expected_order;
    int asked_order = -1;
    double asked_t = 0.0;
  };

  static int call_E(double t, int order, double* out, void* user);
  static int call_A(double t, int order, double* out, void* user);
  static int call_f(double t, int order, double* out, void* user);
  int call(Callback function, double t, int order, double* out);
  int evaluate(const Call& call, double* out);
  std::span<const double> derivative(Callback function, double t, int order);
  const Slot& slot(Cache& cache, double t, int order, bool matrices);
  void build(Slot& slot, bool matrices) const;

  std::shared_ptr<const LinearFamily> family_;
  Cache matrices_, vectors_;
  std::array<std::array<long, max_family_order + 2>, 3> counts_{};  // the last: orders that no family has
  long count_ = 0;
  int highest_order_asked_ = -1;
  double seconds_ = 0.0;
};

}  // namespace sfdae_test

#endif
