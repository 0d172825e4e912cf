// The user's subroutines as a problem of the core.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "f77/user_functions.h"
#include "sfdae/sfdae.h"

namespace sfdae::f77 {

class DgeldaProblem {
 public:
  explicit DgeldaProblem(int n) : n_(n) {}
  DgeldaProblem(const DgeldaProblem&) = delete;
  DgeldaProblem& operator=(const DgeldaProblem&) = delete;
  virtual ~DgeldaProblem() = default;

  // E and A do not depend on t: they are computed once and kept, E first, column by column.
  void declare_constant() { is_constant_ = true; }
  bool is_constant() const { return is_constant_; }
  std::vector<double>& matrices() { return matrices_; }
  // EDIF and ADIF are not called any more.
  void set_matrices(const double* values);

  // For core::LinearProblem; this object must outlive it.
  sfdae_linear_problem callbacks();

  bool has_wrong_width() const { return has_wrong_width_; }
  bool lacks_derivative() const { return lacks_derivative_; }  // one that was asked for
  double last_t() const { return last_t_; }                    // at which a subroutine was called
  // Points at which f was computed.
  long points() const { return points_; }

 protected:
  virtual int call_user(char which, double t, int order, double* values) = 0;

 private:
  int evaluate(char which, double t, int order, double* values);
  template <char which>
  static int callback(double t, int order, double* values, void* user) {
    return static_cast<DgeldaProblem*>(user)->evaluate(which, t, order, values);
  }

  int n_;
  bool is_constant_ = false;
  bool has_E_ = false, has_A_ = false;  // in matrices_
  std::vector<double> matrices_;
  bool has_wrong_width_ = false;
  bool lacks_derivative_ = false;
  double last_t_ = 0.0;
  long points_ = 0;
};

template <class Integer>
class DgeldaProblemOf final : public DgeldaProblem {
 public:
  DgeldaProblemOf(int n, const UserFunctions<Integer>& functions) : DgeldaProblem(n), n_(n), functions_(functions) {}

 protected:
  int call_user(char which, double t, int order, double* values) override {
    return functions_.call(which, n_, t, order, values, n_);
  }

 private:
  int n_;
  UserFunctions<Integer> functions_;
};

}  // namespace sfdae::f77
