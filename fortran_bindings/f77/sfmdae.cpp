// SFMDAE: mechanical systems with constraints in NQ positions, NL constraints,
//
//       q' = v,   M(t,q) v' = f(t,q,v) - g_q(t,q)**T lambda,   0 = g(t,q),   X = (q, v, lambda),
//
// with arguments, codes and work arrays like those of DGELDA; four subroutines take the place of EDIF, ADIF and FDIF.
//
//       SUBROUTINE SFMDAE (MASS, FORCE, CONSTR, CJAC, NQ, NL, T, TOUT, X, XPRIME, CVAL, IPAR, RPAR, IWORK, LIW, RWORK,
//      $                   LRW, RTOL, ATOL, METHOD, INFO, IWARN, IERR)
//
// sfmdae_problem.h has the subroutines; docs/moving_from_gelda.md explains all of it.
//
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/entry.h"
#include "f77/routine.h"
#include "f77/sfmdae_call.h"

namespace sfdae::f77 {

namespace {

// 2 NQ + NL; a number that is illegal, or looks like one of another width, stays one.
template <class Integer>
Integer unknowns(Integer nq, Integer nl) {
  const bool is_legal = nq >= 1 && nq <= largest_order && nl >= 0 && nl <= largest_order;
  return is_legal ? 2 * nq + nl : nq >= 1 && nq <= largest_order ? 1 : nq;
}

}  // namespace

SFDAE_F77_ROUTINE(void, sfmdae,
                  (MassFunction<Integer> mass, ForceFunction<Integer> force, ConstraintFunction<Integer> constr,
                   GradientFunction<Integer> cjac, const Integer* nq, const Integer* nl, double* t,
                   const double* tout, double* x, double* xprime, Integer* cval, Integer* ipar, double* rpar,
                   Integer* iwork, const Integer* liw, double* rwork, const Integer* lrw, double* rtol, double* atol,
                   const Integer* method, Integer* info, Integer* iwarn, Integer* ierr),
                  (mass, force, constr, cjac, nq, nl, t, tout, x, xprime, cval, ipar, rpar, iwork, liw, rwork, lrw,
                   rtol, atol, method, info, iwarn, ierr)) {
  const Integer n = unknowns(*nq, *nl);
  // An illegal NL is reported as a number of equations.
  const Integer m = *nl >= 0 && *nl <= largest_order ? n : *nl > 0 ? *nl : -1;
  const Parameters<Integer> parameters{.n = &n,
                                       .m = &m,
                                       .width = nq,
                                       .t = t,
                                       .tout = tout,
                                       .x = x,
                                       .xprime = xprime,
                                       .cval = cval,
                                       .iwork = iwork,
                                       .liw = liw,
                                       .rwork = rwork,
                                       .lrw = lrw,
                                       .rtol = rtol,
                                       .atol = atol,
                                       .method = method,
                                       .info = info,
                                       .iwarn = iwarn,
                                       .ierr = ierr};
  solve_and_report(parameters, sfmdae_routine, [&](const Arguments& arguments) {
    const int positions = static_cast<int>(*nq), constraints = static_cast<int>(*nl);
    SfmdaeProblemOf<Integer> problem(positions, constraints, {mass, force, constr, cjac, ipar, rpar});
    return SfmdaeCall(arguments, problem).run();
  });
}

}  // namespace sfdae::f77
