// DNFINI, DGEINI: consistent initial values and their derivative.
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/initial_values.h"

#include <algorithm>
#include <cmath>

#include "f77/derivative_stages.h"
#include "f77/reduced_system.h"
#include "f77/routine.h"
#include "f77/user_functions.h"
#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/rank.h"

namespace sfdae::f77 {

using namespace core;

namespace {

// Rows of A y = b made comparable in size, which changes no solution. The factors are powers of two.
void scale_rows(Matrix& A, std::vector<double>& b) {
  for (int i = 0; i < A.rows(); ++i) {
    const double largest = max_abs(A.view().block(i, 0, 1, A.cols()));
    if (largest == 0.0) continue;
    const double factor = std::ldexp(1.0, std::clamp(-std::ilogb(largest), -1000, 1000));
    for (int j = 0; j < A.cols(); ++j) A(i, j) *= factor;
    b[index(i)] *= factor;
  }
}

// y of smallest 2-norm with A K y = b, rows of A of size 1. False if A K has not full row rank.
bool smallest_solution(const Matrix& AK, const std::vector<double>& b, double noise, std::vector<double>& y) {
  const Svd decomposition = svd(AK);
  const int rows = AK.rows(), count = static_cast<int>(decomposition.s.size());
  const int rank =
      decide_rank(decomposition.s.data(), count, 1, {noise, 1.0, std::max({rows, AK.cols(), 1}), 0.0, 0.0}).rank;
  if (rank < rows) return false;
  std::vector<double> coefficients(index(rows), 0.0);
  multiply(1.0, Op::transposed, decomposition.U, b.data(), 0.0, coefficients.data());
  for (int k = 0; k < rows; ++k) coefficients[index(k)] /= decomposition.s[index(k)];
  y.assign(index(AK.cols()), 0.0);
  multiply(1.0, Op::plain, decomposition.V.view().columns(0, rows), coefficients.data(), 0.0, y.data());
  return all_finite(y.data(), y.size());
}

// A x + f
std::vector<double> residual(ConstView A, const double* f, const double* x) {
  std::vector<double> r(f, f + A.rows);
  multiply(1.0, Op::plain, A, x, 1.0, r.data());
  return r;
}

// Orthonormal basis of ker E1, and by how much it multiplies rounding errors: 1 over the smallest singular value
// kept.
Matrix null_space(ConstView E1, double& uncertainty) {
  Matrix scaled = to_matrix(E1);
  std::vector<double> unused(index(E1.rows), 0.0);
  scale_rows(scaled, unused);
  const Svd decomposition = svd(scaled);
  const int count = static_cast<int>(decomposition.s.size());
  const RankDecision decision =
      decide_rank(decomposition.s.data(), count, 1, {unit_roundoff, 1.0, std::max(E1.cols, 1), 0.0, 0.0});
  uncertainty = decision.rank > 0 ? std::max(1.0, 1.0 / decision.kept) : 1.0;
  return to_matrix(decomposition.V.view().columns(decision.rank, E1.cols - decision.rank));
}

}  // namespace

bool InitialSystem::is_finite() const {
  return f77::is_finite(E1) && f77::is_finite(A1) && f77::is_finite(A2) && all_finite(f1, index(E1.rows)) &&
         all_finite(f2, index(A2.rows));
}

bool make_consistent(const InitialSystem& system, Change change, double* x) {
  Matrix A2 = to_matrix(system.A2);
  std::vector<double> r = residual(A2, system.f2, x), y;
  scale_rows(A2, r);
  double uncertainty = 1.0;
  const Matrix K = change == Change::nearest ? identity(A2.cols()) : null_space(system.E1, uncertainty);
  if (!smallest_solution(product(A2, K), r, unit_roundoff * uncertainty, y)) return false;
  multiply(-1.0, Op::plain, K, y.data(), 1.0, x);
  return true;
}

bool initial_derivative(const InitialSystem& system, const double* x, double* xdot) {
  Matrix E1 = to_matrix(system.E1);
  std::vector<double> right = residual(system.A1, system.f1, x), y;
  scale_rows(E1, right);
  if (!smallest_solution(E1, right, unit_roundoff, y)) return false;
  std::copy(y.begin(), y.end(), xdot);
  return true;
}

namespace {

InitialSystem initial_system(ConstView E, ConstView A, const double* f, int d, int a) {
  return {E.top(d), A.top(d), A.block(d, 0, a, A.cols), f, f + d};
}

struct Start {
  double* x;
  double* xdot;
  bool take_x;  // as consistent
};

// Reduced system, x and x' from stage mu found at the point; a value of IERR.
int initialise(const StageRanks& ranks, const StageStorage& stage, const ReducedSystem& reduced, const Start& start) {
  const int n = ranks.n;
  if (guarded([&] { return reduce(ranks, {stage.EQ, stage.AQ, stage.FQ}, reduced); }) != 0) return not_reduced;
  const InitialSystem system =
      initial_system(reduced.E.view(n, n), reduced.A.view(n, n), reduced.F, ranks.d, ranks.a);
  if (!all_finite(start.x, index(n)) || !system.is_finite()) return no_consistent_value;
  const auto solved = [](auto solve) { return guarded([&] { return solve() ? 0 : not_converged; }) == 0; };
  if (!start.take_x && !solved([&] { return make_consistent(system, Change::nearest, start.x); }))
    return no_consistent_value;
  return solved([&] { return initial_derivative(system, start.x, start.xdot); }) ? 0 : no_initial_derivative;
}

}  // namespace

}  // namespace sfdae::f77

using namespace sfdae::f77;

// Consistent initial value of the strangeness-free system E(LDE,N), A(LDA,N), F(N) of ID = d, IA = a, IU = u rows:
// changes X(N) as little as possible in the 2-norm so that A2 X + f2 = 0 (rows d+1..d+a).
//   METHOD          0: all components may change; 1: only those in the null space of the differential rows of E
// Leading dimensions >= N. E and A are kept; DELTA, TAU, RWORK are not used; LRWORK >= IA + N is required
// nevertheless. IERR 0; -3: an argument is wrong; -4: NaN or Inf; -5: LRWORK, or memory; -24: no such X, A2 is
// singular (METHOD = 1: on that null space). X is changed with IERR = 0 only. IA = 0: nothing is to be done, IERR is
// left alone.
SFDAE_F77_ROUTINE(void, dnfini,
                  (const Integer* n, const Integer* id, const Integer* ia, const Integer* iu, double* x,
                   const double* e, const Integer* lde, const double* a, const Integer* lda, const double* f, double*,
                   double*, double*, const Integer* lrwork, const Integer* method, Integer* ierr),
                  (n, id, ia, iu, x, e, lde, a, lda, f, nullptr, nullptr, nullptr, lrwork, method, ierr)) {
  if (*ia == 0) return;
  *ierr = guarded([&] {
    const ConstArray E(e, lde), A(a, lda);
    const StageRanks ranks{to_int(n), to_int(n), to_int(id), to_int(ia), to_int(iu), 0};
    const int order = ranks.n;
    if (!ranks.possible() || !E.holds(order) || !A.holds(order) || *method < 0 || *method > 1) return argument_error;
    if (*lrwork < std::int64_t{ranks.a} + order) return work_too_small;
    const InitialSystem system = initial_system(E.view(order, order), A.view(order, order), f, ranks.d, ranks.a);
    if (!system.is_finite() || !sfdae::core::all_finite(x, sfdae::core::index(order))) return not_converged;
    const Change change = *method == 0 ? Change::nearest : Change::keep_differential;
    return make_consistent(system, change, x) ? 0 : no_consistent_value;
  });
}

// Initialisation at the point TN: DNFIND up to MXINDX and DNFRED (for mu = 0 as well), whose arguments EQ ... AH, M,
// ID, IA, IU, IREQ, F, Z1, Z2Q have the meaning they have there; then
//   X(NEQ)          INIVAL = 0: becomes the nearest consistent value in the 2-norm; else taken as it is
//   XPRIME(NEQ)     solution of smallest 2-norm of E1 x' = A1 X + f1: not the derivative of the solution in the
//                   algebraic directions
// D, V, RWORK are not used; LRWORK as DNFIND.
// IERR is changed by errors only: -22 characteristic values cannot be found (M = -1: none up to MXINDX; or DNFIND
// failed); -23 no reduced system; -24 no consistent initial value; -25 no initial derivative; -140: a user's function
// has another width of INTEGER.
SFDAE_F77_ROUTINE(void, dgeini,
                  (MatrixFunction<Integer> edif, MatrixFunction<Integer> adif, VectorFunction<Integer> fdif,
                   const Integer* neq, const double* tn, const Integer* mxindx, double* x, double* xprime, Integer* m,
                   Integer* id, Integer* ia, Integer* iu, Integer* ireq, double* eq, const Integer* ldeq, double* aq,
                   const Integer* ldaq, double* fq, double* e, const Integer* lde, double* a, const Integer* lda,
                   double* f, double* z1, const Integer* ldz1, double* z2q, const Integer* ldz2q, double*, double* ah,
                   const Integer* ldah, double*, Integer* ipar, double* rpar, double*, const Integer* lrwork,
                   const Integer* inival, Integer* ierr),
                  (edif, adif, fdif, neq, tn, mxindx, x, xprime, m, id, ia, iu, ireq, eq, ldeq, aq, ldaq, fq, e, lde,
                   a, lda, f, z1, ldz1, z2q, ldz2q, nullptr, ah, ldah, nullptr, ipar, rpar, nullptr, lrwork, inival,
                   ierr)) {
  const int code = guarded([&] {
    const StageStorage stage{{ah, ldah}, {eq, ldeq}, {aq, ldaq}, fq, {z2q, ldz2q}};
    const ReducedSystem reduced{{z2q, ldz2q}, {z1, ldz1}, {e, lde}, {a, lda}, f};
    PointDerivatives point = derivatives_at(UserFunctions<Integer>{edif, adif, fdif, ipar, rpar}, to_int(neq), *tn);
    StageValues found;
    const int outcome = guarded([&] { return find_stage(point, *tn, {to_int(mxindx), *lrwork}, stage, found); });
    if (outcome != 0) return outcome == wrong_integer_width ? outcome : no_characteristic_values;
    ValueArguments<Integer>{m, id, ia, iu, ireq}.set(found);
    if (found.characteristic.mu < 0) return no_characteristic_values;
    return initialise(ranks_of(found, point.n()), stage, reduced, {x, xprime, *inival != 0});
  });
  if (code != 0) *ierr = code;
}
