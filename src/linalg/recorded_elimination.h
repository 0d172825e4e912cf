// LU factors of many small sparse matrices of one pattern: the elimination of one of them is recorded, and repeated
// with the values of others.
//
// Pivots are chosen by Markowitz's counts among entries that are not small in their row [DER86, 7.2]. Nothing is
// searched when the elimination is repeated; a pivot that has become small is refused. Matrices are real or complex.
//
// [DER86] I. S. Duff, A. M. Erisman, J. K. Reid: Direct Methods for Sparse Matrices. Oxford University Press, 1986.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "linalg/archive.h"
#include "linalg/determinant.h"
#include "linalg/equilibration.h"
#include "linalg/lanes.h"
#include "linalg/sparse_pattern.h"

namespace sfdae::core {

class RecordedElimination {
 public:
  // Chooses scales and pivots by finite values in the order of the pattern. Otherwise nothing may be factored:
  // `singular` to working precision, or values not finite; too_long: other methods are faster.
  enum class Choice { made, singular, too_long };
  template <class Number>
  Choice choose(const SparsePattern& pattern, const Number* values);
  bool has_pivots() const { return list_.slots > 0; }
  void forget() { list_.size = list_.slots = 0; }
  std::size_t size() const { return index(list_.size); }
  // Entries in the factors of one matrix.
  std::size_t fill() const { return index(list_.slots); }
  // Cost of repeating the elimination, in solutions; estimated from counts of operations.
  double factorization_in_solutions() const;
  // factors: fill() numbers. False: a value is not finite, or a pivot much smaller than others of its row.
  template <class Number>
  bool factor(const Number* values, Number* factors) const;
  // b := A^-1 b; work: size() numbers.
  template <class Number>
  void solve(const Number* factors, Number* b, Number* work) const;
  // As SparseLu::reciprocal_condition(), of the scaled matrix; values: those factored.
  double reciprocal_condition(const double* values, const double* factors) const;
  // Determinant of the matrix, not of the scaled one.
  Determinant<double> determinant(const double* factors) const;
  // The pivots, if there are any. Reading throws DamagedArchive.
  void archive(const SparsePattern& pattern, Archive& archive);

  // factor() for the matrices of eight points side by side, with pivots that may be smaller. -1, or the first lane that
  // refuses one.
  int factor_lanes(const LaneBlock* values, LaneBlock* factors) const;
  void solve_lanes(const LaneBlock* factors, LaneBlock* b) { solve_lanes(factors, lane_count, b); }
  // In the first `count` lanes at least; others may stay as they are.
  void solve_lanes(const LaneBlock* factors, int count, LaneBlock* b);
  // x: that row of A^-1, by rows of A, in these lanes.
  void row_of_inverse_lanes(const LaneBlock* factors, int count, int row, LaneBlock* x);

  struct Update {
    int target, left, right;  // slots: target -= left right
  };
  struct Entry {
    int slot, place;  // place: in the order of pivots
  };
  // All operations: those of pivot k from first[k] to first[k + 1] - 1, for rows of U, columns of L, and updates.
  struct List {
    int size = 0, slots = 0;
    std::vector<int> slot_of_entry;  // of the pattern
    std::vector<double> scale;       // of its entries
    std::vector<int> row, column;    // of the pivots
    std::vector<double> row_scale, column_scale;
    std::vector<int> pivot;  // slots
    std::vector<int> first_lower, first_upper, first_update;
    std::vector<Entry> lower, upper;
    std::vector<Update> updates;
  };
  // Bounds for the size of a pivot when the elimination is repeated; least_of_row: relative to the largest entry of its
  // row.
  struct PivotBounds {
    double least, least_of_row, largest;
  };

 private:
  template <class Number>
  class Search;
  enum class Pivots { wanted, known };
  static const PivotBounds pivot_bounds;
  template <class Number>
  Choice record(const SparsePattern& pattern, const Number* values, Pivots pivots);
  template <class Number>
  Choice eliminate(Search<Number>& search, Pivots pivots);
  bool are_pivots_sound(const SparsePattern& pattern) const;
  template <class Number>
  void substitute(const Number* factors, Number* y) const;
  void substitute_transposed(const double* factors, double* y) const;

  List list_;
  bool is_odd_ = false;                              // permutation from rows to columns of pivots
  std::vector<int> column_of_entry_;                 // of the pattern
  std::vector<int> row_exponent_, column_exponent_;  // of the scales
  Equilibration equilibration_;
  LaneArray lanes_;
};

}  // namespace sfdae::core
