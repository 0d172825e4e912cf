// The user's subroutine NDIF, called from C++, as a problem of the core.
//
//     SUBROUTINE NDIF (T, IDIF, N, M, XJET, LDX, F, FX, LDFX, FXP, LDFXP, IPAR, RPAR, IERR)
//
// stores the total derivatives of order IDIF of F, F_x and F_x' along the jet XJET(:, 0:IDIF+1) at T.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "f77/nonlinear_user_problem.h"

namespace sfdae::f77 {

template <class Integer>
using TotalDerivative = void (*)(const double* t, const Integer* order, const Integer* n, const Integer* m,
                                 double* jet, const Integer* ld_jet, double* F, double* F_x, const Integer* ld_F_x,
                                 double* F_xdot, const Integer* ld_F_xdot, Integer* ipar, double* rpar,
                                 Integer* ierr);

class SfndaeProblem : public NonlinearUserProblem {
 public:
  SfndaeProblem(int m, int n) : m_(m), n_(n) {}

  std::unique_ptr<core::CallbackProblem> problem() override;

  bool has_other_width(double t, const double* x) override;

 protected:
  struct Arrays {
    double *jet, *F, *F_x, *F_xdot;
  };
  virtual int call_user(double t, int order, const Arrays& arrays, HighWord high_word = HighWord::zero) = 0;

 private:
  int evaluate(double t, int order, const double* derivatives, Arrays arrays);
  static int callback(double t, int order, const double* derivatives, double* F, double* F_x, double* F_xdot,
                      void* user) {
    return static_cast<SfndaeProblem*>(user)->evaluate(t, order, derivatives, {nullptr, F, F_x, F_xdot});
  }

  int m_, n_;
  std::vector<double> jet_;                     // the user's own copy
  std::vector<double> unused_x_, unused_xdot_;  // Jacobians that the core does not ask for
};

template <class Integer>
class SfndaeProblemOf final : public SfndaeProblem {
 public:
  struct Function {
    TotalDerivative<Integer> ndif;
    Integer* ipar;
    double* rpar;
  };
  SfndaeProblemOf(int m, int n, const Function& function) : SfndaeProblem(m, n), m_(m), n_(n), function_(function) {}

 protected:
  int call_user(double t, int order, const Arrays& arrays, HighWord high_word) override {
    using Argument = IntegerArgument<Integer>;
    Argument order_argument(order), n(n_), m(m_), ld_jet(n_), ld_F_x(m_), ld_F_xdot(m_), ierr(0);
    if (high_word == HighWord::ones_in_dimension) n.spoil(), m.spoil();
    if (high_word == HighWord::ones_in_leading) ld_F_x.spoil(), ld_F_xdot.spoil();
    ierr.watch();
    function_.ndif(&t, order_argument.address(), n.address(), m.address(), arrays.jet, ld_jet.address(), arrays.F,
                   arrays.F_x, ld_F_x.address(), arrays.F_xdot, ld_F_xdot.address(), function_.ipar, function_.rpar,
                   ierr.address());
    return code_of(ierr);
  }

 private:
  int m_, n_;
  Function function_;
};

}  // namespace sfdae::f77
