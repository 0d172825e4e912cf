// The user's subroutines as a problem of the core.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "f77/user_problem.h"
#include "problem/linear_problem.h"

namespace sfdae::f77 {

class DgeldaProblem : public UserProblem {
 public:
  explicit DgeldaProblem(int n) : n_(n) {}

  // E and A do not depend on t: they are computed once and kept, E first, column by column.
  void declare_constant() { is_constant_ = true; }
  const std::vector<double>& matrices() const { return matrices_; }
  // EDIF and ADIF are not called any more.
  void set_matrices(const double* values);

  // For core::LinearModel; this object must outlive it.
  core::LinearFunctions functions();

  bool has_other_width(double t, const double* x) override;

 protected:
  virtual int call_user(char which, double t, int order, double* values, HighWord high_word = HighWord::zero) = 0;

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
};

template <class Integer>
class DgeldaProblemOf final : public DgeldaProblem {
 public:
  DgeldaProblemOf(int n, const UserFunctions<Integer>& functions) : DgeldaProblem(n), n_(n), functions_(functions) {}

 protected:
  int call_user(char which, double t, int order, double* values, HighWord high_word) override {
    return functions_.call(which, n_, t, order, values, n_, high_word);
  }

 private:
  int n_;
  UserFunctions<Integer> functions_;
};

}  // namespace sfdae::f77
