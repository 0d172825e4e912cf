// DNFPEN, DNFVAL, DNFIND: derivative arrays and characteristic values.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "f77/derivative_stages.h"
#include "f77/routine.h"
#include "f77/user_functions.h"
#include "linalg/index.h"

namespace sfdae::f77 {

namespace {

// Values of the user's functions straight into the new block rows; 0 or a code of user_functions.h.
template <class Integer>
int evaluate_stage(const UserFunctions<Integer>& functions, double t, int level, const core::View& E,
                   const core::View& A, double* f) {
  const int n = E.rows;
  core::fill(E, 0.0);
  core::fill(A, 0.0);
  std::fill_n(f, n, 0.0);
  int code = functions.call('E', n, t, level, E.data, E.ld);
  if (code == 0) code = functions.call('A', n, t, level, A.data, A.ld);
  if (code == 0) code = functions.call('f', n, t, level, f, n);
  if (code != 0) return code;
  const bool finite = is_finite(E) && is_finite(A) && core::all_finite(f, core::index(n));
  return finite ? function_ok : function_failed;
}

}  // namespace

}  // namespace sfdae::f77

using namespace sfdae::f77;

// Adds stage L >= 0 at the point T to the derivative array of an N x N system; to be called for L = 0, 1, ... in
// turn.
//   WQ(LDWQ,N)      block row k holds E^(k), k < L; block row L is added
//   EQ(LDEQ,N(L+1)) array of stage L-1, becomes that of stage L
//   AQ(LDAQ,N)      block row k holds A^(k), k < L; block row L is added
//   FQ(N(L+1))      block row k holds f^(k)
// Leading dimensions >= N(L+1).
// IERR 0; -1, -2: a user's function could not be evaluated (also NaN, Inf), does not provide order L; -3: an argument
// is wrong, nothing was changed; -140: a user's function has another width of INTEGER.
SFDAE_F77_ROUTINE(void, dnfpen,
                  (MatrixFunction<Integer> edif, MatrixFunction<Integer> adif, VectorFunction<Integer> fdif,
                   const Integer* n, const double* t, const Integer* l, double* wq, const Integer* ldwq, double* eq,
                   const Integer* ldeq, double* aq, const Integer* ldaq, double* fq, Integer* ipar, double* rpar,
                   Integer* ierr),
                  (edif, adif, fdif, n, t, l, wq, ldwq, eq, ldeq, aq, ldaq, fq, ipar, rpar, ierr)) {
  *ierr = guarded([&] {
    const int order = to_int(n), level = to_int(l);
    const std::int64_t rows = std::int64_t{order} * (std::int64_t{level} + 1);
    const Array WQ(wq, ldwq), EQ(eq, ldeq), AQ(aq, ldaq);
    if (level < 0 || !is_dimension(order) || !is_dimension(rows) || !WQ.holds(rows) || !EQ.holds(rows) ||
        !AQ.holds(rows))
      return argument_error;
    const int size = static_cast<int>(rows), first = level * order;
    const sfdae::core::View E = WQ.view(size, order), A = AQ.view(size, order);
    const UserFunctions<Integer> functions{edif, adif, fdif, ipar, rpar};
    const int code = evaluate_stage(functions, *t, level, E.block(first, 0, order, order),
                                    A.block(first, 0, order, order), fq + first);
    if (code == 0) append_stage(order, level, E, A, EQ.view(size, size));
    return code;
  });
}

// Characteristic values of the pair EQ(LDEQ,NQ), AQ(LDAQ,N), NQ >= N rows. With Z, T bases of the left and right null
// space of EQ, T' of the complement of T, V of the left null space of Z^T AQ T:
//   R0 = rank EQ,  A0 = rank(Z^T AQ T),  S0 = rank(V^T Z^T AQ T'),  D0 = R0 - S0,  U0 = NQ - R0 - A0 - S0
//   ZQ(LDZQ,NQ)     left orthogonal factor of EQ = ZQ S V^T; its last NQ-R0 columns span the left null space
// Leading dimensions >= NQ. Ranks are judged with rounding errors of the entries of EQ and AQ, rows made comparable.
// RWORK is not used; LRWORK >= 3 NQ^2 + 6 NQ is required nevertheless.
// IERR 0; -3: an argument is wrong; -4: a singular value decomposition failed, or NaN or Inf in EQ, AQ; -5: LRWORK,
// or memory. Outputs are written with IERR = 0 only.
SFDAE_F77_ROUTINE(void, dnfval,
                  (const Integer* n, const Integer* nq, const double* eq, const Integer* ldeq, const double* aq,
                   const Integer* ldaq, Integer* r0, Integer* a0, Integer* s0, Integer* d0, Integer* u0, double* zq,
                   const Integer* ldzq, double*, const Integer* lrwork, Integer* ierr),
                  (n, nq, eq, ldeq, aq, ldaq, r0, a0, s0, d0, u0, zq, ldzq, nullptr, lrwork, ierr)) {
  *ierr = guarded([&] {
    const int order = to_int(n), rows = to_int(nq);
    const ConstArray EQ(eq, ldeq), AQ(aq, ldaq);
    const Array ZQ(zq, ldzq);
    if (!is_dimension(order) || !is_dimension(rows) || rows < order || !EQ.holds(rows) || !AQ.holds(rows) ||
        !ZQ.holds(rows))
      return argument_error;
    if (*lrwork < documented_work(rows)) return work_too_small;
    if (!is_finite(EQ.view(rows, rows)) || !is_finite(AQ.view(rows, order))) return not_converged;
    const PairValues values = pair_values(EQ.view(rows, rows), AQ.view(rows, order));
    *r0 = values.r;
    *a0 = values.a;
    *s0 = values.s;
    *d0 = values.d;
    *u0 = values.u;
    sfdae::core::copy(values.ZQ, ZQ.view(rows, rows));
    return 0;
  });
}

// Strangeness index M = mu <= LMAX and characteristic values IDF = d, IAF = a, IUF = u of an N x N system at the
// point T alone. No derivative of higher order than the stage looked at is asked for; indices above 12 are not found.
//   IREQ            rank of EQ of stage M, NQ = (M+1)N rows
//   AH(LDAH,N)      block row k is E^(k), k = 0..M
//   EQ, AQ, FQ      derivative array of stage M: EQ(LDEQ,NQ), AQ(LDAQ,N), FQ(NQ)
//   ZQ(LDZQ,NQ)     left orthogonal factor of EQ; its last NQ-IREQ columns span the left null space
// Leading dimensions >= (LMAX+1)N, so many columns of EQ and ZQ, entries of FQ. If no stage up to LMAX is
// strangeness-free, M = IDF = IAF = IUF = -1 with IERR = 0, nothing else is written.
// RWORK is not used; LRWORK >= 3 ((LMAX+1)N)^2 + 6 (LMAX+1)N is required nevertheless.
// IERR 0; -1, -2: a user's function could not be evaluated (also NaN, Inf), does not provide the order needed; -3: an
// argument is wrong; -4: a singular value decomposition failed; -5: LRWORK, or memory; -100: a rank decision is not
// clear; -140: a user's function has another width of INTEGER. With these no scalar output is written.
SFDAE_F77_ROUTINE(void, dnfind,
                  (MatrixFunction<Integer> edif, MatrixFunction<Integer> adif, VectorFunction<Integer> fdif,
                   const Integer* n, const double* t, const Integer* lmax, Integer* m, Integer* idf, Integer* iaf,
                   Integer* iuf, Integer* ireq, double* ah, const Integer* ldah, double* eq, const Integer* ldeq,
                   double* aq, const Integer* ldaq, double* fq, double* zq, const Integer* ldzq, Integer* ipar,
                   double* rpar, double*, const Integer* lrwork, Integer* ierr),
                  (edif, adif, fdif, n, t, lmax, m, idf, iaf, iuf, ireq, ah, ldah, eq, ldeq, aq, ldaq, fq, zq, ldzq,
                   ipar, rpar, nullptr, lrwork, ierr)) {
  *ierr = guarded([&] {
    const StageStorage storage{{ah, ldah}, {eq, ldeq}, {aq, ldaq}, fq, {zq, ldzq}};
    PointDerivatives point = derivatives_at(UserFunctions<Integer>{edif, adif, fdif, ipar, rpar}, to_int(n), *t);
    StageValues values;
    const int code = find_stage(point, *t, {to_int(lmax), *lrwork}, storage, values);
    if (code == 0) ValueArguments<Integer>{m, idf, iaf, iuf, ireq}.set(values);
    return code;
  });
}
