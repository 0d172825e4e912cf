// LU factors of many small sparse matrices of one pattern: the elimination of one of them is recorded, and repeated with the
// values of others.
//
// Pivots are chosen by Markowitz' counts among entries that are not small in their row [DER86, 7.2]. Nothing is searched
// when the elimination is repeated; a pivot that has become small is refused.
//
// [DER86] I. S. Duff, A. M. Erisman, J. K. Reid: Direct Methods for Sparse Matrices. Oxford University Press, 1986.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "linalg/archive.h"
#include "linalg/equilibration.h"
#include "linalg/sparse_pattern.h"

namespace sfdae::core {

class RecordedElimination {
 public:
  // Rows, columns and pivots scaled and chosen by finite values in the order of the pattern. Else nothing may be factored:
  // `singular` to working precision, or values not finite; too_long: other methods are faster.
  enum class Choice { made, singular, too_long };
  Choice choose(const SparsePattern& pattern, const double* values);
  bool has_pivots() const { return slots_ > 0; }
  void forget() { size_ = slots_ = 0; }
  std::size_t size() const { return index(size_); }
  // Of the factors of one matrix.
  std::size_t fill() const { return index(slots_); }
  // What it takes to repeat the elimination, in solutions; estimated from counts of operations.
  double factorization_in_solutions() const;
  // factors: fill() numbers. False: a value is not finite, or a pivot much smaller than others of its row.
  bool factor(const double* values, double* factors) const;
  // b := A^-1 b
  void solve(const double* factors, double* b);
  // As SparseLu::reciprocal_condition(), of the scaled matrix; values: those factored.
  double reciprocal_condition(const double* values, const double* factors) const;
  // The pivots, if there are any. Reading throws DamagedArchive.
  void archive(const SparsePattern& pattern, Archive& archive);

 private:
  struct Update {
    int target, left, right;  // slots: target -= left right
  };
  struct Entry {
    int slot, place;  // place: in the order of pivots
  };
  class Search;
  enum class Pivots { wanted, known };
  Choice record(const SparsePattern& pattern, const double* values, Pivots pivots);
  Choice eliminate(Search& search, Pivots pivots);
  bool are_pivots_sound(const SparsePattern& pattern) const;
  void substitute(const double* factors, double* y) const;
  void substitute_transposed(const double* factors, double* y) const;

  int size_ = 0, slots_ = 0;
  std::vector<int> slot_of_entry_, column_of_entry_;  // of the pattern
  std::vector<double> scale_;                         // of its entries
  std::vector<int> row_, column_;                     // of the pivots
  std::vector<int> row_exponent_, column_exponent_;   // of the scales
  std::vector<double> row_scale_, column_scale_;      // of the pivots
  std::vector<int> pivot_;                            // slots
  // Of pivot k those from first[k] to first[k + 1] - 1: rows of U, columns of L, and what is subtracted.
  std::vector<int> first_lower_, first_upper_, first_update_;
  std::vector<Entry> lower_, upper_;
  std::vector<Update> updates_;
  Equilibration equilibration_;
  std::vector<double> work_;
};

}  // namespace sfdae::core
