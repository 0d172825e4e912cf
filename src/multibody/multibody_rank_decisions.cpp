// Rank decisions of a mechanical system at one point.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_rank_decisions.h"

#include <algorithm>
#include <cmath>

#include "linalg/balanced_matrix.h"
#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "reduction/index_analysis.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Rows of length 1; or orthonormal rows with the same span.
Matrix unit_rows(ConstView rows) {
  Matrix result = to_matrix(rows);
  for (int i = 0; i < rows.rows; ++i) {
    double largest = 0.0, sum = 0.0;
    for (int j = 0; j < rows.cols; ++j) largest = std::max(largest, std::fabs(rows(i, j)));
    for (int j = 0; j < rows.cols && largest > 0.0; ++j) result(i, j) /= largest;
    for (int j = 0; j < rows.cols; ++j) sum += result(i, j) * result(i, j);
    for (int j = 0; j < rows.cols && sum > 0.0; ++j) result(i, j) /= std::sqrt(sum);
  }
  return result;
}
Matrix orthonormal_rows(ConstView rows, Arena& arena) {
  Matrix work = transpose(unit_rows(rows)), basis(rows.cols, rows.rows);
  Vector tau(index(std::max(rows.rows, rows.cols)) + 1);
  factor_qr(work, tau.data(), arena);
  form_q(work, rows.rows, tau.data(), basis, arena);
  return transpose(basis);
}

RankDecision judge_matrix(ConstView matrix, Arena& arena) {
  Matrix work = to_matrix(matrix);
  Vector tau(index(matrix.cols) + 1);
  std::vector<int> pivots(index(matrix.cols) + 1);
  factor_qr_pivoted(work, pivots.data(), tau.data(), arena);
  RankScale scale;
  scale.noise = 8.0 * unit_roundoff;  // as of rows of constraints: entries are sums of products
  scale.norm = std::max(max_abs(matrix), 1e-300);
  scale.dimension = matrix.cols;
  return decide_rank(work.data(), matrix.cols, matrix.cols + 1, scale);
}

// [M C^T; C 0]
Matrix acceleration_matrix(const Matrix& M, const Matrix& C) {
  const int nv = M.rows(), rank = C.rows();
  Matrix K(nv + rank, nv + rank);
  for (int j = 0; j < nv; ++j) {
    for (int i = 0; i < nv; ++i) K(i, j) = M(i, j);
    for (int k = 0; k < rank; ++k) K(nv + k, j) = K(j, nv + k) = C(k, j);
  }
  return K;
}

// Returns whether something else than a small mass, which alone would determine only the unit, has the same velocity.
bool are_tied(const Matrix& M, const Matrix& C, double small) {
  const int nv = M.rows();
  for (int j = 0; j < nv; ++j) {
    if (M(j, j) > small) continue;
    bool is_tied = false;
    for (int i = 0; i < nv; ++i) is_tied = is_tied || (i != j && M(i, j) != 0.0);
    for (int k = 0; k < C.rows(); ++k) is_tied = is_tied || C(k, j) != 0.0;
    if (!(M(j, j) > 0.0) || !is_tied) return false;
  }
  return true;
}

// The rank of M, if units of velocities and constraints balance [M C^T; C 0] and make it nonsingular; -1: they do not.
// The sizes of masses and moments of inertia of microsystems are comparable only through the joints between them.
int rank_of_mass_in_balanced_units(const Matrix& M, const Matrix& C, double small, RankDecision& decision,
                                   Arena& arena) {
  if (!are_tied(M, C, small)) return -1;
  Matrix K = acceleration_matrix(M, C);
  if (!is_regular_in_balanced_units(K, Matrix(K.rows(), K.cols()), decision)) return -1;
  return judge_matrix(to_matrix(K.view().block(0, 0, M.rows(), M.cols())), arena).rank;
}

}  // namespace

MultibodyRanks ranks_of_constraints(const MultibodyPoint& point, double rank_tol,
                                    std::vector<RankDecision>* decisions, Arena& arena) {
  const auto judge = [&](const ConstraintRows& rows, int directions, int level) {
    if (rows.matrix.rows == 0) return 0;
    Partition partition;
    partition.resize(directions, rows.matrix.rows);
    partition.rank_tol = rank_tol;
    RankDecision decision = choose_partition(rows, Coordinates::orthogonal, -1, partition, arena);
    decision.t = point.t;
    decision.level = level;
    if (decisions != nullptr) {
      decisions->push_back(decision);
      if (decision.verdict == Verdict::unclear)
        throw Failure(
            SFDAE_RANK_UNCLEAR,
            "whether constraints depend on each other is not clear: " + describe(decision) +
                format(". Set rank_tol between %.1e and 1 to have them dependent, below to have them independent.",
                       2.0 * decision.kept));
    }
    return decision.rank;
  };
  MultibodyRanks ranks;
  ranks.positions = judge(point.position_rows(), point.terms.g_q.cols(), 0);
  const bool same_rows = point.terms.S.rows() == 0 && point.terms.g_q.rows() == point.terms.C.rows();
  ranks.velocities = same_rows ? ranks.positions : judge(point.velocity_rows(), point.terms.C.cols(), 1);
  return ranks;
}

int check_acceleration_matrix(const MultibodyPoint& point, int rank, std::vector<RankDecision>& decisions,
                              Arena& arena) {
  const Matrix& M = point.terms.M;
  const int nv = M.rows();
  Partition partition;
  partition.resize(nv, point.terms.C.rows());
  choose_partition(point.velocity_rows(), Coordinates::orthogonal, rank, partition, arena);
  const double mass = max_abs(M);
  // Velocities without a mass of their own, to half the digits, get the unit of such a mass.
  constexpr double least_mass = 1e-8;
  Vector unit(index(nv + rank), 1.0);
  for (int j = 0; j < nv; ++j)
    unit[index(j)] = 1.0 / std::sqrt(std::max({std::fabs(M(j, j)), least_mass * mass, 1e-300}));
  Matrix scaled_M(nv, nv), C(rank, nv), scaled_C(rank, nv);
  for (int j = 0; j < nv; ++j) {
    for (int i = 0; i < nv; ++i) scaled_M(i, j) = unit[index(i)] * unit[index(j)] * M(i, j);
    for (int k = 0; k < rank; ++k) C(k, j) = point.terms.C(partition.rows[index(k)], j);
    for (int k = 0; k < rank; ++k) scaled_C(k, j) = unit[index(j)] * C(k, j);
  }
  const auto judge_with = [&](const Matrix& rows) {
    return judge_matrix(acceleration_matrix(scaled_M, rows), arena);
  };
  const int rank_of_mass = judge_matrix(scaled_M, arena).rank;
  RankDecision decision = judge_with(unit_rows(scaled_C));
  decision.t = point.t;
  decision.subject = Subject::array;
  decision.rows = decision.cols = nv + rank;
  decisions.push_back(decision);
  const bool has_mass = mass > 0.0 || rank == nv;
  if (decision.rank == nv + rank && has_mass) return rank_of_mass;
  if (const int found = rank_of_mass_in_balanced_units(M, C, least_mass * mass, decisions.back(), arena);
      found >= 0 && has_mass)
    return found;
  // The condition of K is the square of that of C (docs/design/multibody.md): apart from that, M is the cause.
  const int missing = nv + rank - judge_with(orthonormal_rows(scaled_C, arena)).rank;
  if (missing == 0 && has_mass)
    throw Failure(
        SFDAE_SINGULAR,
        format("[M C^T; C 0] is singular to working accuracy at t = %.15g: the constraints nearly depend on "
               "each other. Set rank_tol to have those that nearly do count as dependent.",
               point.t));
  throw Failure(SFDAE_SINGULAR, format("[M C^T; C 0] is singular at t = %.15g: M is singular on velocities that the "
                                       "constraints leave open, and %d acceleration(s) are not determined.",
                                       point.t, missing));
}

}  // namespace sfdae::core
