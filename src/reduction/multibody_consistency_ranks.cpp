// Ranks of the constraints of a mechanical system at consistent positions, and whether they mean anything.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "problem/failure.h"
#include "reduction/index_analysis.h"
#include "reduction/multibody_consistency.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

MultibodyRanks MultibodyConsistency::local_ranks(std::vector<RankDecision>* decisions) {
  const auto judge = [&](const ConstraintRows& rows, int directions, int level) {
    if (rows.matrix.rows == 0) return 0;
    Partition partition;
    partition.resize(directions, rows.matrix.rows);
    RankDecision decision = choose_partition(rows, Coordinates::orthogonal, -1, partition, arena_);
    decision.t = t_;
    decision.level = level;
    if (decisions != nullptr) {
      decisions->push_back(decision);
      if (decision.verdict == Verdict::unclear)
        throw Failure(SFDAE_RANK_UNCLEAR,
                      "whether constraints depend on each other is not clear: " + describe(decision));
    }
    return decision.rank;
  };
  MultibodyRanks ranks;
  ranks.positions = judge(point_.position_rows(), sizes_.positions, 0);
  const bool same_rows = point_.terms.S.rows() == 0 && sizes_.nonholonomic == 0;
  ranks.velocities = same_rows ? ranks.positions : judge(point_.velocity_rows(), sizes_.velocities, 1);
  return ranks;
}

MultibodyRanks MultibodyConsistency::ranks(const Vector& q, std::vector<RankDecision>& decisions) {
  look_at(q);
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
    look_at(beside);
    for (int i = 0; i < sizes_.holonomic; ++i)
      if (units[index(i)] < vanishing * point_.position_units[index(i)])
        throw Failure(
            SFDAE_CHARACTERISTICS_CHANGED,
            format("the configuration at t = %.15g is singular: the gradient of %s vanishes. Start elsewhere, or "
                   "write the constraint so that its gradient does not vanish where it holds.",
                   t_, name_of(i).c_str()));
    approach(beside);
    look_at(beside);
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

// K, every unknown in its unit, has to be regular. C has full rank: K is regular where T^T M T is, C T = 0, and so
// constraints that are nearly dependent have no influence.
void MultibodyConsistency::check_matrix(int rank, std::vector<RankDecision>& decisions) {
  const int nv = sizes_.velocities, open = nv - rank;
  Matrix M = point_.terms.M;
  Partition partition;
  partition.resize(nv, sizes_.constraints());
  const RankDecision constraints =
      choose_partition(point_.velocity_rows(), Coordinates::orthogonal, rank, partition, arena_);
  // Squares of that are pivots of K.
  constexpr double nearly_dependent = 3e-8;
  if (rank > 0 && constraints.rank >= rank && constraints.kept < nearly_dependent)
    throw Failure(SFDAE_RANK_UNCLEAR,
                  format("constraints nearly depend on each other at t = %.15g, without being redundant: of "
                         "gradients in units of their lengths one is only %.2g away from those of the others, which "
                         "is too little for forces. Leave it out, or write it in another way.",
                         t_, constraints.kept));
  const double mass = max_abs(M);
  Vector unit(index(nv), 1.0);
  for (int j = 0; j < nv; ++j)
    unit[index(j)] = 1.0 / std::sqrt(std::max({std::fabs(M(j, j)), 1e-8 * mass, 1e-280}));
  Matrix gradients(nv, rank);
  for (int j = 0; j < nv; ++j) {
    for (int i = 0; i < nv; ++i) M(i, j) *= unit[index(i)] * unit[index(j)];
    for (int k = 0; k < rank; ++k) {
      const int row = partition.rows[index(k)];
      gradients(j, k) = unit[index(j)] * (point_.terms.C(row, j) / point_.velocity_units[index(row)]);
    }
  }
  const auto judge = [&](Matrix matrix) {
    Vector tau(index(matrix.cols()) + 1);
    std::vector<int> pivots(index(matrix.cols()) + 1);
    factor_qr_pivoted(matrix, pivots.data(), tau.data(), arena_);
    RankScale scale;
    scale.noise = 8.0 * unit_roundoff;
    scale.norm = std::max(max_abs(M), 1e-300);
    scale.dimension = nv;
    return decide_rank(matrix.data(), matrix.cols(), matrix.cols() + 1, scale);
  };
  rank_of_mass_ = judge(M).rank;
  RankDecision decision = judge(reduced_mass(M, gradients));
  decision.t = t_;
  decision.subject = Subject::array;
  decision.rows = decision.cols = open;
  decisions.push_back(decision);
  if (decision.rank == open) return;
  throw Failure(SFDAE_SINGULAR, format("[M C^T; C 0] is singular at t = %.15g: M is singular on velocities that the "
                                       "constraints leave open, and %d acceleration(s) are not determined.",
                                       t_, open - decision.rank));
}

// T^T M T, T orthonormal, gradients^T T = 0. gradients is overwritten.
Matrix MultibodyConsistency::reduced_mass(const Matrix& M, Matrix& gradients) {
  const int nv = M.rows(), rank = gradients.cols();
  Matrix Q = identity(nv);
  if (rank > 0) {
    Vector tau(index(rank) + 1);
    factor_qr(gradients, tau.data(), arena_);
    form_q(gradients, rank, tau.data(), Q, arena_);
  }
  const ConstView T = Q.view().columns(rank, nv - rank);
  return transpose_product(T, product(M, T));
}

}  // namespace sfdae::core
