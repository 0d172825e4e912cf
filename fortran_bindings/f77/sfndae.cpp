// SFNDAE: solves F(t, x, x') = 0, M equations in N unknowns of arbitrary index, with arguments, codes and work arrays
// like those of DGELDA; one subroutine NDIF takes the place of EDIF, ADIF and FDIF.
//
//       SUBROUTINE SFNDAE (NDIF, N, M, T, TOUT, X, XPRIME, CVAL, IPAR, RPAR, IWORK, LIW, RWORK, LRW,
//      $                   RTOL, ATOL, METHOD, INFO, IWARN, IERR)
//       SUBROUTINE NDIF (T, IDIF, N, M, XJET, LDX, F, FX, LDFX, FXP, LDFXP, IPAR, RPAR, IERR)
//       INTEGER IDIF, N, M, LDX, LDFX, LDFXP, IPAR(*), IERR
//       DOUBLE PRECISION T, XJET(LDX,0:IDIF+1), F(M), FX(LDFX,N), FXP(LDFXP,N), RPAR(*)
//
// docs/moving_from_gelda.md explains all of them.
//
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/entry.h"
#include "f77/routine.h"
#include "f77/sfndae_call.h"
#include "f77/sfndae_problem.h"

namespace sfdae::f77 {

SFDAE_F77_ROUTINE(void, sfndae,
                  (TotalDerivative<Integer> ndif, const Integer* n, const Integer* m, double* t, const double* tout,
                   double* x, double* xprime, Integer* cval, Integer* ipar, double* rpar, Integer* iwork,
                   const Integer* liw, double* rwork, const Integer* lrw, double* rtol, double* atol,
                   const Integer* method, Integer* info, Integer* iwarn, Integer* ierr),
                  (ndif, n, m, t, tout, x, xprime, cval, ipar, rpar, iwork, liw, rwork, lrw, rtol, atol, method, info,
                   iwarn, ierr)) {
  const Parameters<Integer> parameters{n,   m,     nullptr, t,    tout, x,      xprime, cval,  iwork,
                                       liw, rwork, lrw,     rtol, atol, method, info,   iwarn, ierr};
  solve_and_report(parameters, sfndae_routine, [&](const Arguments& arguments) {
    SfndaeProblemOf<Integer> problem(arguments.m, arguments.n, {ndif, ipar, rpar});
    return SfndaeCall(arguments, problem).run();
  });
}

}  // namespace sfdae::f77
