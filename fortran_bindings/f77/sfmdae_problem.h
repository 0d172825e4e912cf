// The user's subroutines MASS, FORCE, CONSTR and CJAC, called from C++, as a problem of the core.
//
//     SUBROUTINE MASS   (T, NQ, Q, M, LDM, IPAR, RPAR, IERR)            M(LDM,NQ)
//     SUBROUTINE FORCE  (T, NQ, Q, V, F, IPAR, RPAR, IERR)              F(NQ)
//     SUBROUTINE CONSTR (T, NQ, NL, Q, G, IPAR, RPAR, IERR)             G(NL)
//     SUBROUTINE CJAC   (T, NQ, NL, Q, GQ, LDGQ, GT, IPAR, RPAR, IERR)  GQ(LDGQ,NQ), GT(NL)
//
// store M(t,q), f(t,q,v), g(t,q), g_q and g_t; all arrays are zero before.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "f77/user_problem.h"
#include "multibody/multibody_callbacks.h"

namespace sfdae::f77 {

template <class Integer>
using MassFunction = void (*)(const double* t, const Integer* nq, double* q, double* M, const Integer* ldm,
                              Integer* ipar, double* rpar, Integer* ierr);
template <class Integer>
using ForceFunction = void (*)(const double* t, const Integer* nq, double* q, double* v, double* f, Integer* ipar,
                               double* rpar, Integer* ierr);
template <class Integer>
using ConstraintFunction = void (*)(const double* t, const Integer* nq, const Integer* nl, double* q, double* g,
                                    Integer* ipar, double* rpar, Integer* ierr);
template <class Integer>
using GradientFunction = void (*)(const double* t, const Integer* nq, const Integer* nl, double* q, double* g_q,
                                  const Integer* ldgq, double* g_t, Integer* ipar, double* rpar, Integer* ierr);

class SfmdaeProblem : public UserProblem {
 public:
  SfmdaeProblem(int positions, int constraints) : nq_(positions), nl_(constraints) {}

  int positions() const { return nq_; }
  // For core::MultibodyModel; this object must outlive it.
  std::unique_ptr<core::CallbackMultibody> problem();

  bool has_other_width(double t, const double* x) override;

 protected:
  enum class Which { mass, forces, constraints, gradient };
  // Where to evaluate and what to write; v and g_t: null where there is none.
  struct Call {
    Which which;
    double t;
    double *q, *v, *result, *g_t;
    HighWord high_word = HighWord::zero;
  };
  virtual int call_user(const Call& call) = 0;

 private:
  int evaluate(Which which, double t, const double* q, const double* v, double* result);
  // g_t, which comes with g_q.
  int rate(double t, const double* q, double* g_t);
  template <Which which>
  static int of_position(double t, const double* q, double* result, void* user) {
    return static_cast<SfmdaeProblem*>(user)->evaluate(which, t, q, nullptr, result);
  }
  static int forces(double t, const double* q, const double* v, double* f, void* user) {
    return static_cast<SfmdaeProblem*>(user)->evaluate(Which::forces, t, q, v, f);
  }
  static int rates(double t, const double* q, double* g_t, void* user) {
    return static_cast<SfmdaeProblem*>(user)->rate(t, q, g_t);
  }

  int nq_, nl_;
  std::vector<double> q_, v_;  // the user's own copies
  // Where g_q was asked for last, and g_t there.
  double gradient_t_ = 0.0;
  std::vector<double> gradient_q_, g_t_, unused_;
};

template <class Integer>
class SfmdaeProblemOf final : public SfmdaeProblem {
 public:
  struct Functions {
    MassFunction<Integer> mass;
    ForceFunction<Integer> force;
    ConstraintFunction<Integer> constr;
    GradientFunction<Integer> cjac;
    Integer* ipar;
    double* rpar;
  };
  SfmdaeProblemOf(int positions, int constraints, const Functions& functions)
      : SfmdaeProblem(positions, constraints), nq_(positions), nl_(constraints), functions_(functions) {}

 protected:
  int call_user(const Call& call) override {
    using Argument = IntegerArgument<Integer>;
    Argument nq(nq_), nl(nl_), ldm(nq_), ldgq(nl_), ierr(0);
    if (call.high_word == HighWord::ones_in_dimension) nq.spoil(), nl.spoil();
    if (call.high_word == HighWord::ones_in_leading) ldm.spoil(), ldgq.spoil();
    ierr.watch();
    const double* const t = &call.t;
    Integer* const ipar = functions_.ipar;
    double* const rpar = functions_.rpar;
    switch (call.which) {
      case Which::mass:
        functions_.mass(t, nq.address(), call.q, call.result, ldm.address(), ipar, rpar, ierr.address());
        break;
      case Which::forces:
        functions_.force(t, nq.address(), call.q, call.v, call.result, ipar, rpar, ierr.address());
        break;
      case Which::constraints:
        functions_.constr(t, nq.address(), nl.address(), call.q, call.result, ipar, rpar, ierr.address());
        break;
      case Which::gradient:
        functions_.cjac(t, nq.address(), nl.address(), call.q, call.result, ldgq.address(), call.g_t, ipar, rpar,
                        ierr.address());
        break;
    }
    return code_of(ierr);
  }

 private:
  int nq_, nl_;
  Functions functions_;
};

}  // namespace sfdae::f77
