// Rank decisions of one reduction: noise propagated from stage to stage, decisions recorded.
//
// eps is the unit roundoff, or the relative error of the derivatives if that is larger (for A^, of those of A); p is
// the smallest pivot kept so far, relative to the norm of its stage: a null vector of a matrix with relative pivot p is
// known to eps / p only. Rounding errors then amount to
//   E_0            eps |E_0|
//   later stages   e, at least eps |stage|
//   A^             e, at least eps |A|
//   E T2           eps |E_0| max(1, e / (eps sigma_a(A^)))
// with e the errors of the rows carried: eps |E_0| at first, then eps |data| in the columns of derivatives and eps |A|
// in those of x added at every stage. Staged elimination carries rows of errors along. For the array as a whole, e =
// eps |A| / p.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "linalg/arena.h"
#include "linalg/matrix.h"
#include "linalg/rank.h"
#include "problem/taylor_data.h"

namespace sfdae::core {

// Ranks of all decisions of one reduction in their order.
struct RankSequence {
  // Blocks of the diagonal and stages of every level, the constraints, E T2.
  std::array<int, 2 * (max_derivative_order + 1) + 4> rank{};
  std::size_t count = 0;
  void add(int value) { rank[count++] = value; }
  bool operator==(const RankSequence& other) const {
    return std::equal(rank.begin(), rank.begin() + count, other.rank.begin(), other.rank.begin() + other.count);
  }
};

// Source of the noise of a decision: errors carried along (e above), the smallest pivot alone (e = eps |data| / p,
// which several consecutive amplifying stages exceed), or the data without propagation. Decisions by the latter two
// have to be confirmed by perturbations of the data, or by ranks already known.
enum class NoiseModel { carried, pivots, data };

class Judge {
 public:
  struct Settings {
    double rank_tol = 0.0;
    bool by_singular_values = false;  // judge A^ and E T2 by singular values instead of pivots
    NoiseModel noise = NoiseModel::carried;
    // Known ranks of all decisions in their order; values near the point where they were found give no new information.
    // Nullptr: decided.
    const RankSequence* known_ranks = nullptr;
  };

  // log: receives the decisions and requests that unclear ones are repeated by singular values; nullptr in steps, which
  // only compare ranks with those known.
  Judge(const TaylorData& data, int level, const Settings& settings, std::vector<RankDecision>* log);

  // Ranks from the diagonal of a pivoted QR factorization `r` of `original` (may be empty without log).
  int decide_diagonal_block(ConstView r, ConstView original);  // E_0
  // norm: of the part of the stage that comes from carried rows.
  int decide_stage(int stage, ConstView r, ConstView original, double norm);
  int decide_constraints(ConstView r, ConstView original);
  int decide_differential(ConstView r, ConstView original);
  // Rank of M from its singular values.
  int decide_array(const std::vector<double>& s, int rows, int cols);

  // Rows of errors that are eliminated above the rows carried, in the same way: all operations on rows are linear in
  // them, so the transformed errors that enter at every stage are the noise of the decisions. (Bounds by norms and
  // pivots of every stage are too large by 1e4 at mu = 4, and the smallest pivot alone ignores the product of
  // amplifications of the stages: |E^-1 A| tau each, 1e6 in all with tau = 128; docs/design/rank_decisions.md.) Two
  // rows, as a single one happens to be small now and then: 30 instead of 40 named errors in 5000 stiff problems.
  int error_rows() const { return settings_.noise == NoiseModel::carried ? 2 : 0; }
  // Errors of rows that enter at a stage, in the columns of derivatives and in those of x; absolute.
  double entering_error() const { return sizes_.eps * sizes_.norm; }
  double entering_constraint_error() const { return sizes_.eps_A * sizes_.norm_A; }
  // Errors of E_0 in the first stage.
  double diagonal_error() const { return unit_roundoff * sizes_.norm_E0; }
  // Column length up to which the rest of a pivoted factorization that begins with entries of this size may be taken
  // for zero: as a block it is below the threshold, too. < 0: never, if ranks do not follow from noise.
  double negligible(double norm) const;
  double norm_E0() const { return sizes_.norm_E0; }
  // Errors of the matrix judged by the next decide_stage, and of A^.
  void set_errors(double errors) { errors_ = errors; }
  void set_constraint_errors(double errors) { constraint_errors_ = errors; }

  bool keeps_originals() const { return log_ != nullptr || settings_.by_singular_values; }
  bool all_clear() const { return all_clear_; }
  const RankSequence& ranks() const { return ranks_; }
  // False if known ranks do not fit, as there were other decisions to make.
  bool fits_known_ranks() const { return fits_; }
  double smallest_pivot() const { return pivot_; }                 // p
  double kept_constraints() const { return kept_constraints_; }    // sigma_a relative to |A|, 1 if a = 0
  double kept_differential() const { return kept_differential_; }  // sigma_d relative to |E|, 1 if d = 0

 private:
  // Subject of a decision, and scales of its values; kept: the smallest value kept so far, lowered.
  struct Question {
    Subject subject;
    int stage;
    double noise, norm;
    double& kept;
  };
  int decide(Question question, ConstView r, ConstView original);
  int take_known_rank(const Question& question, ConstView r);
  void record_known(const Question& question, ConstView r, int rank);
  int record(const RankDecision& decision, const Question& question);
  void log(RankDecision decision, const Question& question);

  // Sizes of the data of the reduction.
  struct Sizes {
    int dimension;
    double norm, norm_A, norm_E0;
    double eps, eps_A;       // of constraints, which are rows of A
    double residual_errors;  // of E_0 along a jet with residuals, however small E_0 is
  };

  const Settings& settings_;
  std::vector<RankDecision>* log_;
  double t_;
  int level_;
  Sizes sizes_;
  double errors_, constraint_errors_;
  double pivot_ = 1.0;
  double kept_constraints_ = 1.0;
  double kept_differential_ = 1.0;
  bool has_constraints_ = false;
  bool fits_ = true;
  RankSequence ranks_;
  bool all_clear_ = true;
};

}  // namespace sfdae::core
