// DGELDA: solves E(t) x' = A(t) x + f(t), E and A square, with the arguments, codes and work arrays of the routine of
// that name in GELDA 1.1, so that programs written for it can be linked with this library instead.
//
//       SUBROUTINE DGELDA (EDIF, ADIF, FDIF, NEQ, T, TOUT, X, XPRIME, CVAL, IPAR, RPAR, IWORK, LIW, RWORK, LRW,
//      $                   RTOL, ATOL, METHOD, INFO, IWARN, IERR)
//
// Codes beside the documented ones of illegal input: -102 also for NEQ > 5000; -101 also for a continuation whose
// IWORK and RWORK are not those of the last call; -115 also for T or TOUT that is not finite; -132 METHOD is not 1 or
// 2, or not that of the first call; -140 INTEGERs, or those of the user's subroutines, have another width. -21 is
// returned wherever a subroutine returns -2, the start included; METHOD=2 reports -10, -21 and -26 as METHOD=1 does.
// IERR=-998 and -999: called with INFO(1)=-1 after a failure, or after illegal input.
//
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/dgelda_call.h"
#include "f77/entry.h"
#include "f77/routine.h"

namespace sfdae::f77 {

SFDAE_F77_ROUTINE(void, dgelda,
                  (MatrixFunction<Integer> edif, MatrixFunction<Integer> adif, VectorFunction<Integer> fdif,
                   const Integer* neq, double* t, const double* tout, double* x, double* xprime, Integer* cval,
                   Integer* ipar, double* rpar, Integer* iwork, const Integer* liw, double* rwork, const Integer* lrw,
                   double* rtol, double* atol, const Integer* method, Integer* info, Integer* iwarn, Integer* ierr),
                  (edif, adif, fdif, neq, t, tout, x, xprime, cval, ipar, rpar, iwork, liw, rwork, lrw, rtol, atol,
                   method, info, iwarn, ierr)) {
  const Parameters<Integer> parameters{neq, nullptr, nullptr, t,    tout, x,      xprime, cval,  iwork,
                                       liw, rwork,   lrw,     rtol, atol, method, info,   iwarn, ierr};
  solve_and_report(parameters, dgelda_routine, [&](const Arguments& arguments) {
    DgeldaProblemOf<Integer> problem(arguments.n, {edif, adif, fdif, ipar, rpar});
    return DgeldaCall(arguments, problem).run();
  });
}

}  // namespace sfdae::f77
