// Rank decisions: the one place where a number is declared to be zero.
//
// Every decision compares values (pivots or singular values, decreasing) with the noise that rounding errors, or
// errors of the derivatives, may have left in them. The noise is propagated from the data through the elimination,
// never taken from the matrix judged: a product such as E T2 may consist of nothing but rounding errors.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace sfdae::core {

// Matrix that was judged: S(:, y_j), A^, E T2, M, a diagonal block of the system Jacobian.
enum class Subject { stage, constraints, differential, array, block };
enum class Verdict { clear, confirmed, unclear, user };

struct RankDecision {
  double t = 0.0;
  int level = 0;
  int stage = 0;
  Subject subject = Subject::stage;
  int rows = 0;
  int cols = 0;
  int rank = 0;
  double kept = 0.0;     // smallest value kept, relative to the norm of the data, 0 if none is
  double dropped = 0.0;  // largest value dropped, 0 if none is
  double noise = 0.0;
  double threshold = 0.0;
  double gap = 0.0;  // kept / max(dropped, noise); 1e300 if nothing was kept
  Verdict verdict = Verdict::clear;
  bool operator==(const RankDecision&) const = default;
};

// A smaller gap does not separate a rank from rounding errors. Kept values of well-posed problems lie 1e6 and more
// above the noise, accidental ones within a factor 1e2 of the threshold.
inline constexpr double clear_gap = 1e3;
inline constexpr double unit_roundoff = 1.1102230246251565e-16;  // 2^-53

// Scales of a decision; absolute.
struct RankScale {
  double noise = 0.0;     // bound for rounding errors of single entries
  double norm = 1.0;      // of the data
  int dimension = 1;      // of the matrices that went into the one judged: errors of entries add up
  double rank_tol = 0.0;  // > 0 overrides the threshold: rank_tol * norm
  // Rounding errors of the matrix itself: the noise is never less. A value dropped although it lies well above is
  // doubtful; 0 turns that off.
  double least_noise = 0.0;
};

// Judges `count` decreasing magnitudes values[0], values[stride], ...
RankDecision decide_rank(const double* values, int count, int stride, const RankScale& scale);

// The smallest gap, 1e300 without decisions, and the smallest value kept, 1 if there is none.
double smallest_gap(const std::vector<RankDecision>& decisions);
double smallest_kept(const std::vector<RankDecision>& decisions);

}  // namespace sfdae::core
