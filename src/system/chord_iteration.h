// Chord iterations, Newton's method with a matrix that is reused: criteria for converged, too slow, or of no use.
//
// The error left after a change is rate / (1 - rate) times that change, where rate is the ratio of the last two changes
// [HW96, IV.8]. Norms are in units of the tolerance; the contribution of rounding errors has been subtracted. The
// matrix alone is not trusted: a point is accepted only if residuals confirm it (residual_test.h).
//
// [HW96] E. Hairer, G. Wanner: Solving Ordinary Differential Equations II. Springer, 2nd ed. 1996.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "linalg/archive.h"
#include "system/residual_test.h"
#include "system/strangeness_free_system.h"

namespace sfdae::core {

// Slower contractions are abandoned [HW96 recommends to stop at 1; beyond 0.7 refactoring the matrix is cheaper].
inline constexpr double slowest_contraction = 0.7;
// With the matrix of an initial guess, each change reduces residuals by a factor of e where an exponential is far too
// large (docs/design/steps.md, section 5).
inline constexpr double largest_ratio_from_guess = 0.1;

// The target of an iteration.
struct ChordTarget {
  double tolerance;  // of the error left
  // Lower bound of measured rates: the next one may be larger.
  double least_rate;
  // The first change may be small by chance: at least two are made unless it is negligible.
  bool needs_two = false;
  int most_iterations = 12;
  // Every second change may be hardly smaller than the one before it.
  bool alternates = false;
  // The largest ratio of a residual to the one before (residual_test.h).
  double largest_ratio = slowest_contraction;
};

class ChordIteration {
 public:
  // Until the target is reached and residuals confirm it. `equations` has
  //
  //     std::size_t num_rows()
  //     PointStatus evaluate(double* rows)      residuals at the present values, times -1
  //     double change(const double* rows)       solves with the matrix, changes the values; the norm of the change
  //     void add(RowSums kind, double* rows)    see ResidualTest
  //     bool may_end(int iteration)             false: the iteration has to continue
  //
  // Ok: the values are those after the last change.
  template <class Equations>
  PointStatus solve(const ChordTarget& target, Equations& equations);

  void begin() { is_slow_ = false; }
  // Called after a change of the given norm; before: norm of the last one, which counts from the second iteration on.
  bool has_converged(const ChordTarget& target, int iteration, double norm, double before);
  static bool is_too_slow(int iteration, double norm, double before) {
    return iteration > 1 && norm > slowest_contraction * before;
  }

  // The matrix is that of an initial guess, whose entries may be larger by orders of magnitude than at any solution.
  void doubt_matrix(bool is_in_doubt) { is_in_doubt_ = is_in_doubt; }
  // A new matrix will pay for the next point.
  bool is_slow() const { return is_slow_; }
  void set_slow(bool is_slow) { is_slow_ = is_slow; }
  // The largest ratio of two changes in the last iteration; unknown for another matrix.
  double rate() const { return rate_; }
  void set_rate(double rate) { rate_ = rate; }
  void forget_rate() { rate_ = 1.0; }
  void archive_rate(Archive& archive) { archive.real(rate_); }

 private:
  template <class Equations>
  PointStatus evaluate(Equations& equations);

  double rate_ = 1.0;
  bool is_slow_ = false, is_in_doubt_ = false;
  ResidualTest test_;
};

// During its lifetime the matrix is in doubt.
class DoubtedMatrix {
 public:
  explicit DoubtedMatrix(ChordIteration& chord, bool is_in_doubt = true) : chord_(chord) {
    chord_.doubt_matrix(is_in_doubt);
  }
  DoubtedMatrix(const DoubtedMatrix&) = delete;
  DoubtedMatrix& operator=(const DoubtedMatrix&) = delete;
  ~DoubtedMatrix() { chord_.doubt_matrix(false); }

 private:
  ChordIteration& chord_;
};

template <class Equations>
PointStatus ChordIteration::evaluate(Equations& equations) {
  const PointStatus status = equations.evaluate(test_.next(equations.num_rows()));
  if (status != PointStatus::ok) return status;
  test_.note();
  return PointStatus::ok;
}

// Residuals are evaluated once more after the change that is to be accepted; if they reject it, the next iteration uses
// them.
template <class Equations>
PointStatus ChordIteration::solve(const ChordTarget& target, Equations& equations) {
  begin();
  test_.begin();
  const auto add = [&](RowSums kind, double* rows) { equations.add(kind, rows); };
  double before = 0.0, earlier = 0.0;
  bool is_evaluated = false;
  for (int iteration = 0; iteration < target.most_iterations; ++iteration) {
    PointStatus status = is_evaluated ? PointStatus::ok : evaluate(equations);
    is_evaluated = false;
    if (status != PointStatus::ok) return status;
    const double norm = equations.change(test_.residuals());
    if (!std::isfinite(norm)) return PointStatus::not_converged;
    if (has_converged(target, iteration, norm, before) && equations.may_end(iteration)) {
      const ResidualTest::Allowed allowed{target.tolerance, norm,
                                          is_in_doubt_ ? largest_ratio_from_guess : target.largest_ratio};
      status = evaluate(equations);
      if (status != PointStatus::ok) return status;
      is_evaluated = true;
      if (test_.allows(allowed, !is_in_doubt_, add)) return PointStatus::ok;
    }
    if (is_too_slow(iteration, norm, target.alternates ? std::max(before, earlier) : before))
      return PointStatus::not_converged;
    earlier = before;
    before = norm;
  }
  return PointStatus::not_converged;
}

}  // namespace sfdae::core
