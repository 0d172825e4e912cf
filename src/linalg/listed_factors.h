// LU factors of one sparse matrix after another, of one pattern and with values that change little: by a recorded
// elimination whose pivots are reused as long as they are suitable.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/archive.h"
#include "linalg/equilibration.h"
#include "linalg/quiet_arithmetic.h"
#include "linalg/recorded_elimination.h"
#include "linalg/sparse_pattern.h"

namespace sfdae::core {

// Number: double or std::complex<double>.
template <class Number>
class ListedFactors {
 public:
  // For larger ones the search for pivots takes longer than it saves: Stokes's equations in 239 unknowns.
  static constexpr int largest_size = 200;

  // Initial state: another pattern may follow.
  void reset() {
    elimination_.forget();
    is_too_long_ = false;
  }
  // True unless other methods are known to be faster.
  bool may_factor(const SparsePattern& pattern) const {
    return !is_too_long_ && pattern.size > 0 && pattern.size <= largest_size;
  }
  // Values in the order of the pattern. False: A is singular to working precision, a value is not finite, or other
  // methods are faster; nothing may be solved then. Allocates where pivots are chosen; raises no floating-point
  // exception.
  bool factor(const SparsePattern& pattern, const Number* values) {
    if (!may_factor(pattern) || !all_finite_numbers(values, pattern.row.size())) return false;
    const QuietArithmetic quiet;
    make_room();
    if (elimination_.has_pivots() && elimination_.factor(values, factors_.data())) return true;
    const RecordedElimination::Choice choice = elimination_.choose(pattern, values);
    is_too_long_ = choice == RecordedElimination::Choice::too_long;
    make_room();
    return choice == RecordedElimination::Choice::made && elimination_.factor(values, factors_.data());
  }
  void solve(Number* b) { elimination_.solve(factors_.data(), b, work_.data()); }
  // values: those factored.
  double reciprocal_condition(const Number* values) const {
    return elimination_.reciprocal_condition(values, factors_.data());
  }
  Determinant<Number> determinant() const { return elimination_.determinant(factors_.data()); }
  const RecordedElimination& elimination() const { return elimination_; }
  // Archives all but the factors, which are the same in every bit for the same values.
  void archive(const SparsePattern& pattern, Archive& archive) {
    archive.small(is_too_long_);
    elimination_.archive(pattern, archive);
    make_room();
  }

 private:
  void make_room() {
    factors_.resize(elimination_.fill());
    work_.resize(elimination_.size());
  }

  RecordedElimination elimination_;
  bool is_too_long_ = false;
  std::vector<Number> factors_, work_;
};

}  // namespace sfdae::core
