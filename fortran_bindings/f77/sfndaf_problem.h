// The user's subroutine NARR, called from C++, as a problem of the core.
//
//     SUBROUTINE NARR (T, MU, N, M, XJET, LDX, F, FJ, LDFJ, IPAR, RPAR, IERR)
//
// stores the total derivatives of order 0, ..., MU of F along the jet XJET(:, 0:MU+1) at T, and their Jacobian with
// respect to this jet.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "f77/nonlinear_user_problem.h"
#include "problem/derivative_array_function.h"

namespace sfdae::f77 {

template <class Integer>
using ArrayRoutine = void (*)(const double* t, const Integer* order, const Integer* n, const Integer* m, double* jet,
                              const Integer* ld_jet, double* F, double* jacobian, const Integer* ld_jacobian,
                              Integer* ipar, double* rpar, Integer* ierr);

class SfndafProblem : public NonlinearUserProblem {
 public:
  SfndafProblem(int m, int n);

  std::unique_ptr<core::CallbackProblem> problem() override;
  bool has_other_width(double t, const double* x) override;
  // The entry of FJ that the latest call has found to contradict others.
  const core::ArrayFault& fault() const { return array_->fault(); }

 protected:
  struct Arrays {
    double *jet, *F, *jacobian;
  };
  virtual int call_user(double t, int order, const Arrays& arrays, HighWord high_word = HighWord::zero) = 0;

 private:
  int evaluate(double t, int order, const double* derivatives, double* F, double* jacobian);
  static int callback(double t, int order, const double* derivatives, double* F, double* jacobian, void* user) {
    return static_cast<SfndafProblem*>(user)->evaluate(t, order, derivatives, F, jacobian);
  }

  int m_, n_;
  std::shared_ptr<core::DerivativeArrayFunction> array_;
  std::vector<double> jet_;     // the user's own copy
  std::vector<double> unused_;  // Jacobian that the core does not ask for
};

template <class Integer>
class SfndafProblemOf final : public SfndafProblem {
 public:
  struct Function {
    ArrayRoutine<Integer> narr;
    Integer* ipar;
    double* rpar;
  };
  SfndafProblemOf(int m, int n, const Function& function) : SfndafProblem(m, n), m_(m), n_(n), function_(function) {}

 protected:
  int call_user(double t, int order, const Arrays& arrays, HighWord high_word) override {
    using Argument = IntegerArgument<Integer>;
    Argument order_argument(order), n(n_), m(m_), ld_jet(n_), ld_jacobian((order + 1) * m_), ierr(0);
    if (high_word == HighWord::ones_in_dimension) n.spoil(), m.spoil();
    if (high_word == HighWord::ones_in_leading) ld_jacobian.spoil();
    ierr.watch();
    function_.narr(&t, order_argument.address(), n.address(), m.address(), arrays.jet, ld_jet.address(), arrays.F,
                   arrays.jacobian, ld_jacobian.address(), function_.ipar, function_.rpar, ierr.address());
    return code_of(ierr);
  }

 private:
  int m_, n_;
  Function function_;
};

}  // namespace sfdae::f77
