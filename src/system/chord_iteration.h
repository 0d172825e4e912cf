// When a chord iteration, Newton's method with a matrix that is kept, is good enough, too slow, or of no use.
//
// The error left after a change is rate / (1 - rate) times that change, the rate being that of the last two changes
// [HW96, IV.8]. Norms are in units of the tolerance; what rounding errors contribute has been subtracted.
//
// [HW96] E. Hairer, G. Wanner: Solving Ordinary Differential Equations II. Springer, 2nd ed. 1996.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/archive.h"

namespace sfdae::core {

// What an iteration has to reach.
struct ChordTarget {
  double tolerance;  // of the error left
  // A measured rate is not taken for less: the next one may be larger.
  double least_rate;
  // The first change may be small by chance: at least two are made unless it is negligible.
  bool needs_two = false;
};

class ChordIteration {
 public:
  // Slower contractions are given up [HW96 recommends to stop at 1; beyond 0.7 renewing the matrix is cheaper].
  static constexpr double slowest = 0.7;

  void begin() { is_slow_ = false; }
  // After the change of the given norm; before: that of the last one, which counts from the second iteration on.
  bool has_converged(const ChordTarget& target, int iteration, double norm, double before);
  // The same where the matrix may have entries that are larger by orders of magnitude than those at the point, which
  // is_out_of_date() says; it is asked where it matters. Changes are small beside the error then, and the first one
  // solves what is linear: at least three are made unless one is negligible, and only the last two say how they
  // become smaller.
  template <class IsOutOfDate>
  bool has_converged(const ChordTarget& target, int iteration, double norm, double before,
                     IsOutOfDate is_out_of_date) {
    if (!has_converged(target, iteration, norm, before)) return false;
    if (!is_out_of_date()) return true;
    // A new one pays for the next point.
    is_slow_ = true;
    return has_certainly_converged(target, iteration, norm);
  }
  static bool is_too_slow(int iteration, double norm, double before) {
    return iteration > 1 && norm > slowest * before;
  }

  // The matrix is that of a guess, where entries may be larger by orders of magnitude than at any solution: the first
  // change solves what is linear, and the second one, small beside it, says nothing about the rate of what comes.
  void doubt_matrix(bool is_in_doubt) { is_in_doubt_ = is_in_doubt; }
  // A new matrix will pay for the next point.
  bool is_slow() const { return is_slow_; }
  void set_slow(bool is_slow) { is_slow_ = is_slow; }
  // Of the last iteration; with another matrix nothing is known of it.
  double rate() const { return rate_; }
  void set_rate(double rate) { rate_ = rate; }
  void forget_rate() { rate_ = 1.0; }
  void archive_rate(Archive& archive) { archive.real(rate_); }

 private:
  bool has_certainly_converged(const ChordTarget& target, int iteration, double norm) const;

  double rate_ = 1.0;
  bool is_slow_ = false, is_in_doubt_ = false;
};

// As long as it lives the matrix is in doubt.
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

}  // namespace sfdae::core
