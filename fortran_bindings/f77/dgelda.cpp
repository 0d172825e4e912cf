// DGELDA: solves E(t) x' = A(t) x + f(t), E and A square, with the arguments, codes and work arrays of the routine of that
// name in GELDA 1.1, so that programs written for it can be linked with this library instead.
//
//       SUBROUTINE DGELDA (EDIF, ADIF, FDIF, NEQ, T, TOUT, X, XPRIME, CVAL, IPAR, RPAR, IWORK, LIW, RWORK, LRW,
//      $                   RTOL, ATOL, METHOD, INFO, IWARN, IERR)
//
// Codes beside the documented ones of illegal input: -102 also for NEQ > 5000; -101 also for a continuation whose IWORK and
// RWORK are not those of the last call; -115 also for T or TOUT that is not finite; -132 METHOD is not 1 or 2, or not that
// of the first call; -140 INTEGERs, or those of the user's subroutines, have another width. -21 is returned wherever a
// subroutine returns -2, the start included; METHOD=2 reports -10, -21 and -26 as METHOD=1 does. IERR=-998 and -999: called
// with INFO(1)=-1 after a failure, or after illegal input.
//
// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <cstring>

#include "f77/dgelda_call.h"
#include "f77/routine.h"

namespace sfdae::f77 {

namespace {

bool is_narrow(std::int64_t value) { return value >= INT32_MIN && value <= INT32_MAX; }

// How many of the numbers look like INTEGERs of 32 bits read as ones of 64. LRW may be as large as that.
template <class Integer>
int count_wide(const Integer* neq, const Integer* method, const Integer* liw, const Integer* info) {
  int count = !is_narrow(*neq) + !is_narrow(*method) + !is_narrow(*liw);
  for (int k = 0; k < num_info; ++k) count += !is_narrow(info[k]);
  return count;
}

template <class Integer>
struct Parameters {
  UserFunctions<Integer> functions;
  const Integer* neq;
  double* t;
  const double* tout;
  double* x;
  double* xprime;
  Integer* cval;
  Integer* iwork;
  const Integer* liw;
  double* rwork;
  const Integer* lrw;
  double* rtol;
  double* atol;
  const Integer* method;
  Integer* info;
  Integer* iwarn;
  Integer* ierr;
};

template <class Integer>
int solve(const Parameters<Integer>& p) noexcept {
  Arguments arguments{.n = static_cast<int>(*p.neq),
                      .method = static_cast<int>(*p.method),
                      .liw = *p.liw,
                      .lrw = *p.lrw,
                      .tout = *p.tout,
                      .t = p.t,
                      .x = p.x,
                      .xprime = p.xprime,
                      .rtol = p.rtol,
                      .atol = p.atol,
                      .cval = IntegerArray(p.cval),
                      .iwork = IntegerArray(p.iwork),
                      .rwork_values = p.rwork};
  for (int k = 0; k < num_info; ++k) arguments.info[k + 1] = static_cast<int>(p.info[k]);
  DgeldaProblemOf<Integer> problem(arguments.n, p.functions);
  const int ierr = DgeldaCall(arguments, problem).run();
  const bool is_repeated = arguments.info[1] == -1;
  if (arguments.liw >= shortest_iwork && !is_repeated) arguments.iwork.set(last_ierr, ierr);
  return ierr;
}

template <class Integer>
void solve_and_report(const Parameters<Integer>& p) noexcept {
  const int num_wide = count_wide(p.neq, p.method, p.liw, p.info);
  if (num_wide > 1) {
    // INFO(1) and IERR have 32 bits, then.
    const std::int32_t failed = -1, wrong_width = code::wrong_width;
    std::memcpy(p.info, &failed, sizeof failed);
    std::memcpy(p.ierr, &wrong_width, sizeof wrong_width);
    return;
  }
  const int ierr = num_wide == 1 ? static_cast<int>(code::wrong_width) : solve(p);
  p.info[0] = ierr < 0 ? -1 : ierr == 4 ? 2 : 1;
  *p.ierr = ierr;
  // Some callers hand over a constant zero, which may not be written.
  if (*p.iwarn != 0) *p.iwarn = 0;
}

}  // namespace

SFDAE_F77_ROUTINE(void, dgelda,
                  (MatrixFunction<Integer> edif, MatrixFunction<Integer> adif, VectorFunction<Integer> fdif,
                   const Integer* neq, double* t, const double* tout, double* x, double* xprime, Integer* cval,
                   Integer* ipar, double* rpar, Integer* iwork, const Integer* liw, double* rwork, const Integer* lrw,
                   double* rtol, double* atol, const Integer* method, Integer* info, Integer* iwarn, Integer* ierr),
                  (edif, adif, fdif, neq, t, tout, x, xprime, cval, ipar, rpar, iwork, liw, rwork, lrw, rtol, atol,
                   method, info, iwarn, ierr)) {
  solve_and_report<Integer>({{edif, adif, fdif, ipar, rpar}, neq, t, tout, x, xprime, cval, iwork, liw, rwork, lrw, rtol,
                             atol, method, info, iwarn, ierr});
}

}  // namespace sfdae::f77
