// Ranks of the constraints of a mechanical system at consistent positions, and whether they mean anything.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "multibody/multibody_consistency.h"
#include "problem/failure.h"
#include "reduction/index_analysis.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Rows of length 1; or orthonormal ones that span the same.
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
  scale.noise = 8.0 * unit_roundoff;
  scale.norm = std::max(max_abs(matrix), 1e-300);
  scale.dimension = matrix.cols;
  return decide_rank(work.data(), matrix.cols, matrix.cols + 1, scale);
}

}  // namespace

MultibodyRanks MultibodyConsistency::local_ranks(std::vector<RankDecision>* decisions) {
  const auto judge = [&](const ConstraintRows& rows, int directions, int level) {
    if (rows.matrix.rows == 0) return 0;
    Partition partition;
    partition.resize(directions, rows.matrix.rows);
    partition.rank_tol = rank_tol_;
    RankDecision decision = choose_partition(rows, Coordinates::orthogonal, -1, partition, arena_);
    decision.t = t_;
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
  ranks.positions = judge(point_.position_rows(), sizes_.positions, 0);
  const bool same_rows = point_.terms.S.rows() == 0 && sizes_.nonholonomic == 0;
  ranks.velocities = same_rows ? ranks.positions : judge(point_.velocity_rows(), sizes_.velocities, 1);
  return ranks;
}

MultibodyRanks MultibodyConsistency::ranks(const Vector& q, double rank_tol, std::vector<RankDecision>& decisions) {
  rank_tol_ = rank_tol;
  evaluate_at(q);
  const MultibodyRanks ranks = local_ranks(&decisions);
  check_matrix(ranks.velocities, decisions);
  if (sizes_.holonomic > 0) check_nearby(q, ranks);
  return ranks;
}

// Constraints that depend on each other at the point alone, or gradients that vanish where their constraints hold,
// make it a singular configuration.
void MultibodyConsistency::check_nearby(const Vector& q, const MultibodyRanks& known) {
  constexpr double distance = 1e-3, vanishing = 1e-6;
  const Vector units = point_.position_units;
  const double largest = max_abs(q.data(), sizes_.positions),
               size = largest > 0.0 ? std::max(largest, position_tolerance()) : 1.0;
  Vector beside(q);
  // No direction in particular, and the same in every run.
  for (std::size_t i = 0; i < q.size(); ++i)
    beside[i] += distance * size * std::sin(1.0 + 2.3 * static_cast<double>(i));
  MultibodyRanks found;
  try {
    evaluate_at(beside);
    for (int i = 0; i < sizes_.holonomic; ++i)
      if (units[index(i)] < vanishing * point_.position_units[index(i)])
        throw Failure(
            SFDAE_CHARACTERISTICS_CHANGED,
            format("the configuration at t = %.15g is singular: the gradient of %s vanishes. Start elsewhere, or "
                   "write the constraint so that its gradient does not vanish where it holds.",
                   t_, name_of(i).c_str()));
    approach(beside);
    evaluate_at(beside);
    found = local_ranks(nullptr);
  } catch (const Failure& failure) {
    // A neighbour that cannot be reached says nothing.
    const int status = failure.status();
    if (status == SFDAE_CHARACTERISTICS_CHANGED || status == SFDAE_CALLBACK_STOPPED || status == SFDAE_STOPPED) throw;
    return;
  }
  if (found.positions <= known.positions && found.velocities <= known.velocities) return;
  throw Failure(
      SFDAE_CHARACTERISTICS_CHANGED,
      format("the configuration at t = %.15g is singular: %d of %d constraints are independent there, but %d "
             "beside it. Start elsewhere.",
             t_, known.velocities, sizes_.constraints(), found.velocities));
}

// K, every unknown in its unit, has to be regular.
void MultibodyConsistency::check_matrix(int rank, std::vector<RankDecision>& decisions) {
  const int nv = sizes_.velocities;
  const Matrix& M = point_.terms.M;
  Partition partition;
  partition.resize(nv, sizes_.constraints());
  choose_partition(point_.velocity_rows(), Coordinates::orthogonal, rank, partition, arena_);
  const double mass = max_abs(M);
  Vector unit(index(nv + rank), 1.0);
  for (int j = 0; j < nv; ++j) unit[index(j)] = 1.0 / std::sqrt(std::max({std::fabs(M(j, j)), 1e-8 * mass, 1e-300}));
  Matrix K(nv + rank, nv + rank), C(rank, nv);
  for (int j = 0; j < nv; ++j) {
    for (int i = 0; i < nv; ++i) K(i, j) = unit[index(i)] * unit[index(j)] * M(i, j);
    for (int k = 0; k < rank; ++k) C(k, j) = unit[index(j)] * point_.terms.C(partition.rows[index(k)], j);
  }
  const auto judge_with = [&](const Matrix& rows) {
    for (int k = 0; k < rank; ++k)
      for (int j = 0; j < nv; ++j) K(nv + k, j) = K(j, nv + k) = rows(k, j);
    return judge_matrix(K, arena_);
  };
  rank_of_mass_ = judge_matrix(to_matrix(K.view().block(0, 0, nv, nv)), arena_).rank;
  RankDecision decision = judge_with(unit_rows(C));
  decision.t = t_;
  decision.subject = Subject::array;
  decision.rows = decision.cols = nv + rank;
  decisions.push_back(decision);
  const bool has_mass = mass > 0.0 || rank == nv;
  if (decision.rank == nv + rank && has_mass) return;
  // The condition of K is the square of that of C: without it, M is left as the reason.
  const int missing = nv + rank - judge_with(orthonormal_rows(C, arena_)).rank;
  if (missing == 0 && has_mass)
    throw Failure(
        SFDAE_SINGULAR,
        format("[M C^T; C 0] is singular to working accuracy at t = %.15g: the constraints nearly depend on "
               "each other. Set rank_tol to have those that nearly do count as dependent.",
               t_));
  throw Failure(SFDAE_SINGULAR, format("[M C^T; C 0] is singular at t = %.15g: M is singular on velocities that the "
                                       "constraints leave open, and %d acceleration(s) are not determined.",
                                       t_, missing));
}

}  // namespace sfdae::core
