// The user's derivative array, one function for all orders, as a function for total derivatives order by order.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "problem/array_blocks.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

class DerivativeArrayFunction {
 public:
  DerivativeArrayFunction(int m, int n, sfdae_derivative_array_function function, void* user)
      : m_(m), n_(n), function_(function), user_(user) {}

  // A sfdae_total_derivative_function; user: a DerivativeArrayFunction.
  static int evaluate(double t, int order, const double* derivatives, double* F, double* F_x, double* F_xdot,
                      void* user);

  // While this object exists, calls request all orders up to `highest` at one jet, in ascending order, and pass all
  // highest + 1 derivatives: the array of order `highest` is evaluated once for all of them. Null: no effect.
  class Ascending {
   public:
    Ascending(DerivativeArrayFunction* array, int highest);
    ~Ascending();
    Ascending(const Ascending&) = delete;
    Ascending& operator=(const Ascending&) = delete;

   private:
    DerivativeArrayFunction* array_;
  };

  // The error in the Jacobian that the latest call has found, and the array that it is in.
  const ArrayFault& fault() const { return fault_; }
  ArrayShape shape() const { return {m_, n_, loaded_order_}; }

 private:
  bool is_loaded(double t, int order, const double* derivatives, bool with_jacobian) const;
  int load(double t, int order, const double* derivatives, bool with_jacobian);
  int call(double t, int order, const double* derivatives, bool with_jacobian);

  int m_, n_;
  sfdae_derivative_array_function function_;
  void* user_;
  int highest_ = -1;       // order that the calls ascend to
  int loaded_order_ = -1;  // of the array below
  bool has_jacobian_ = false;
  double t_ = 0.0;
  std::vector<double> derivatives_, F_, jacobian_, F_x_, F_xdot_;
  ArrayFault fault_;
};

}  // namespace sfdae::core
