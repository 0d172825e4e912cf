// DNFOTR, DNFRED, DNFIX1: the strangeness-free system at one point.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "f77/derivative_stages.h"
#include "f77/reduced_system.h"
#include "f77/routine.h"
#include "f77/user_functions.h"
#include "linalg/index.h"

namespace sfdae::f77 {

namespace {

// f^(0), f^(1), ... at t, one below the other.
template <class Integer>
int evaluate_right_side(const UserFunctions<Integer>& functions, const StageRanks& ranks, double t, double* FQ) {
  for (int k = 0; k * ranks.n < ranks.rows; ++k) {
    double* f = FQ + static_cast<std::ptrdiff_t>(k) * ranks.n;
    std::fill_n(f, ranks.n, 0.0);
    const int code = functions.call('f', ranks.n, t, k, f, ranks.n);
    if (code != 0) return code;
    if (!core::all_finite(f, core::index(ranks.n))) return function_failed;
  }
  return 0;
}

}  // namespace

}  // namespace sfdae::f77

using namespace sfdae::f77;

// Orthogonal transformations to the strangeness-free system of N rows, ID = d, IA = a, from EQ(LDEQ,NQ), AQ(LDAQ,N),
// NQ = (mu+1)N, IREQ = rank EQ.
//   Z2Q(LDZ2Q,NQ)   in: NQ-IREQ columns that span the left null space of EQ. Out: the first IA of them are Z2, Z2^T AQ
//                   of full rank; the others annihilate AQ as well. IREQ = NQ: identity
//   Z1(LDZ1,N)      first ID columns: Z1, orthonormal basis of the range of E T2, T2 a basis of ker Z2^T AQ. ID = 0:
//                   not touched. IREQ = NQ: identity
// Leading dimensions >= NQ, LDZ1 >= N. AH and RWORK are not used; LRWORK >= 3 N + 2 NQ + 2 NQ^2 is required
// nevertheless.
// IERR 0; -3: an argument is wrong; -4: NaN or Inf in EQ, AQ, Z2Q; -5: LRWORK, or memory. Outputs are written with
// IERR = 0 only.
SFDAE_F77_ROUTINE(void, dnfotr,
                  (const Integer* n, const Integer* nq, const Integer* id, const Integer* ia, const Integer* ireq,
                   const double* eq, const Integer* ldeq, const double* aq, const Integer* ldaq, double* z2q,
                   const Integer* ldz2q, double* z1, const Integer* ldz1, double*, const Integer*, double*,
                   const Integer* lrwork, Integer* ierr),
                  (n, nq, id, ia, ireq, eq, ldeq, aq, ldaq, z2q, ldz2q, z1, ldz1, nullptr, nullptr, nullptr, lrwork,
                   ierr)) {
  *ierr = guarded([&] {
    const StageRanks ranks{to_int(n), to_int(nq), to_int(id), to_int(ia), 0, to_int(ireq)};
    const ConstArray EQ(eq, ldeq), AQ(aq, ldaq);
    const Array Z2Q(z2q, ldz2q), Z1(z1, ldz1);
    const int rows = ranks.rows;
    if (!ranks.possible() || !EQ.holds(rows) || !AQ.holds(rows) || !Z2Q.holds(rows) || !Z1.holds(ranks.n))
      return argument_error;
    if (*lrwork < documented_work(ranks)) return work_too_small;
    const sfdae::core::View Z = Z2Q.view(rows, ranks.kernel());
    if (!is_finite(EQ.view(rows, rows)) || !is_finite(AQ.view(rows, ranks.n)) || !is_finite(Z)) return not_converged;
    const Transformations found = transformations(ranks, EQ.view(rows, rows), AQ.view(rows, ranks.n), Z);
    if (!found.is_finite()) return not_converged;
    store(found, ranks, Z2Q, Z1);
    return 0;
  });
}

// Strangeness-free system of N rows (ID = d, IA = a, IU = u) at one point from what DNFIND has found: EQ(LDEQ,NQ),
// AQ(LDAQ,N), FQ(NQ), NQ = (mu+1)N, IREQ = rank EQ.
//   Z2Q(LDZ2Q,NQ)   in: full left factor of EQ, the left null space last. Out: as DNFOTR leaves it
//   Z1(LDZ1,N)      out: as DNFOTR
//   E(LDE,N), A(LDA,N), F(N)   E = [Z1^T E; 0; 0], A = [Z1^T A; Z2^T AQ; 0], F = [Z1^T f; Z2^T FQ; rest]. The rest: FQ
//                   along u further left null vectors, zero if the redundant equations do not contradict each other
// Leading dimensions >= NQ, those of Z1, E, A >= N. AH and RWORK are not used; LRWORK >= 3 N + 2 NQ + 2 NQ^2 is
// required nevertheless.
// IERR as DNFOTR.
SFDAE_F77_ROUTINE(void, dnfred,
                  (const Integer* n, const Integer* nq, const Integer* id, const Integer* ia, const Integer* iu,
                   const Integer* ireq, const double* eq, const Integer* ldeq, const double* aq, const Integer* ldaq,
                   const double* fq, double* z2q, const Integer* ldz2q, double* z1, const Integer* ldz1, double* e,
                   const Integer* lde, double* a, const Integer* lda, double* f, double*, const Integer*, double*,
                   const Integer* lrwork, Integer* ierr),
                  (n, nq, id, ia, iu, ireq, eq, ldeq, aq, ldaq, fq, z2q, ldz2q, z1, ldz1, e, lde, a, lda, f, nullptr,
                   nullptr, nullptr, lrwork, ierr)) {
  *ierr = guarded([&] {
    const StageRanks ranks{to_int(n), to_int(nq), to_int(id), to_int(ia), to_int(iu), to_int(ireq)};
    if (!ranks.possible()) return argument_error;
    if (*lrwork < documented_work(ranks)) return work_too_small;
    return reduce(ranks, {{eq, ldeq}, {aq, ldaq}, fq}, {{z2q, ldz2q}, {z1, ldz1}, {e, lde}, {a, lda}, f});
  });
}

// Strangeness-free system of N rows at the point T, where the characteristic values M, ID, IA, IU are expected.
// MCONST = .FALSE.: DNFIND up to LMAX, then DNFRED, for mu = 0 as well. Out: MQ, IDQ, IAQ, IUQ the values at T, IREQ;
//   EQ, AQ, FQ, AH  as DNFIND;   E(LDE,N), A(LDA,N), F(N), Z1(LDZ1,N), Z2Q(LDZ2Q,(LMAX+1)N)  as DNFRED
// MCONST = .TRUE. (E and A constant): Z1 and Z2Q are those of an earlier call; FDIF alone is called, and FQ and F
// alone
//   are written.
// Leading dimensions >= (LMAX+1)N, those of E, A, Z1 >= N. RWORK is not used; LRWORK as DNFIND.
// IERR 0; -22: DNFIND failed, whatever the reason; -23: DNFRED failed; -26: the values found are not those expected
// (MQ = -1: none up to LMAX), E, A, F are not written; MCONST = .TRUE.: -1, -2 of FDIF; -22: an argument is wrong;
// -140: a user's function has another width of INTEGER.
SFDAE_F77_ROUTINE(void, dnfix1,
                  (MatrixFunction<Integer> edif, MatrixFunction<Integer> adif, VectorFunction<Integer> fdif,
                   const Integer* n, const double* t, const Integer* lmax, const Integer* m, const Integer* id,
                   const Integer* ia, const Integer* iu, Integer* ireq, Integer* mq, Integer* idq, Integer* iaq,
                   Integer* iuq, double* e, const Integer* lde, double* a, const Integer* lda, double* f, double* eq,
                   const Integer* ldeq, double* aq, const Integer* ldaq, double* fq, double* z1, const Integer* ldz1,
                   double* z2q, const Integer* ldz2q, double* ah, const Integer* ldah, Integer* ipar, double* rpar,
                   double*, const Integer* lrwork, const Integer* mconst, Integer* ierr),
                  (edif, adif, fdif, n, t, lmax, m, id, ia, iu, ireq, mq, idq, iaq, iuq, e, lde, a, lda, f, eq, ldeq,
                   aq, ldaq, fq, z1, ldz1, z2q, ldz2q, ah, ldah, ipar, rpar, nullptr, lrwork, mconst, ierr)) {
  *ierr = guarded([&] {
    const UserFunctions<Integer> functions{edif, adif, fdif, ipar, rpar};
    const ReducedSystem reduced{{z2q, ldz2q}, {z1, ldz1}, {e, lde}, {a, lda}, f};
    const int order = to_int(n), level = to_int(m), most = to_int(lmax);
    if (*mconst != 0) {
      const bool sensible =
          is_dimension(order) && level >= 0 && level <= most && is_dimension((std::int64_t{level} + 1) * order);
      StageRanks known{order, sensible ? (level + 1) * order : -1, to_int(id), to_int(ia), to_int(iu), 0};
      if (!known.possible() || !reduced.Z2Q.holds(known.rows) || !reduced.Z1.holds(order))
        return no_characteristic_values;
      const int code = evaluate_right_side(functions, known, *t, fq);
      if (code == 0) reduce_right_side(known, fq, reduced);
      return code;
    }
    PointDerivatives point = derivatives_at(functions, order, *t);
    StageValues found;
    const StageStorage storage{{ah, ldah}, {eq, ldeq}, {aq, ldaq}, fq, reduced.Z2Q};
    const int code = guarded([&] { return find_stage(point, *t, {most, *lrwork}, storage, found); });
    if (code != 0) return code == wrong_integer_width ? code : no_characteristic_values;
    ValueArguments<Integer>{mq, idq, iaq, iuq, ireq}.set(found);
    const sfdae::core::CharacteristicValues& values = found.characteristic;
    if (values.mu < 0 || values.mu != *m || values.d != *id || values.a != *ia || values.u != *iu)
      return values_changed;
    const StageRanks ranks = ranks_of(found, order);
    return guarded([&] { return reduce(ranks, {storage.EQ, storage.AQ, fq}, reduced); }) == 0 ? 0 : not_reduced;
  });
}
