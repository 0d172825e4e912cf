// SFNDAF: SFNDAE for programs that have the derivative array of F(t, x, x') = 0 as one subroutine NARR.
//
//       SUBROUTINE SFNDAF (NARR, N, M, T, TOUT, X, XPRIME, CVAL, IPAR, RPAR, IWORK, LIW, RWORK, LRW,
//      $                   RTOL, ATOL, METHOD, INFO, IWARN, IERR)
//       SUBROUTINE NARR (T, MU, N, M, XJET, LDX, F, FJ, LDFJ, IPAR, RPAR, IERR)
//       INTEGER MU, N, M, LDX, LDFJ, IPAR(*), IERR
//       DOUBLE PRECISION T, XJET(LDX,0:MU+1), F((MU+1)*M), FJ(LDFJ,(MU+2)*N), RPAR(*)
//
// docs/moving_from_gelda.md explains all of them.
//
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/entry.h"
#include "f77/routine.h"
#include "f77/sfndae_call.h"
#include "f77/sfndaf_problem.h"

namespace sfdae::f77 {

SFDAE_F77_ROUTINE(void, sfndaf,
                  (ArrayRoutine<Integer> narr, const Integer* n, const Integer* m, double* t, const double* tout,
                   double* x, double* xprime, Integer* cval, Integer* ipar, double* rpar, Integer* iwork,
                   const Integer* liw, double* rwork, const Integer* lrw, double* rtol, double* atol,
                   const Integer* method, Integer* info, Integer* iwarn, Integer* ierr),
                  (narr, n, m, t, tout, x, xprime, cval, ipar, rpar, iwork, liw, rwork, lrw, rtol, atol, method, info,
                   iwarn, ierr)) {
  const Parameters<Integer> parameters{n,   m,     nullptr, t,    tout, x,      xprime, cval,  iwork,
                                       liw, rwork, lrw,     rtol, atol, method, info,   iwarn, ierr};
  solve_and_report(parameters, sfndaf_routine, [&](const Arguments& arguments) {
    SfndafProblemOf<Integer> problem(arguments.m, arguments.n, {narr, ipar, rpar});
    const int code = SfndaeCall(arguments, problem).run();
    if (code == wrong_array) {
      // The entry of FJ that contradicts others, counted from 1.
      arguments.iwork.set(1, problem.fault().row + 1);
      arguments.iwork.set(2, problem.fault().column + 1);
    }
    return code;
  });
}

}  // namespace sfdae::f77
