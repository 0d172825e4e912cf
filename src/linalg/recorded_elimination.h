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

#include "linalg/equilibration.h"
#include "linalg/sparse_pattern.h"

namespace sfdae::core {

class RecordedElimination {
 public:
  // Rows, columns and pivots scaled and chosen by finite values in the order of the pattern. False: singular to working
  // precision; nothing may be factored then.
  bool choose(const SparsePattern& pattern, const double* values);
  // Of the factors of one matrix.
  std::size_t fill() const { return index(slots_); }
  // factors: fill() numbers. False: a value is not finite, or a pivot much smaller than others of its row.
  bool factor(const double* values, double* factors) const;
  // b := A^-1 b
  void solve(const double* factors, double* b);

 private:
  struct Update {
    int target, left, right;  // slots: target -= left right
  };
  struct Entry {
    int slot, place;  // place: in the order of pivots
  };
  class Search;
  bool eliminate(Search& search);

  int size_ = 0, slots_ = 0;
  std::vector<int> slot_of_entry_;  // of the pattern
  std::vector<double> scale_;       // of its entries
  std::vector<int> row_, column_;   // of the pivots
  std::vector<double> row_scale_, column_scale_;
  std::vector<int> pivot_;  // slots
  // Of pivot k those from first[k] to first[k + 1] - 1: rows of U, columns of L, and what is subtracted.
  std::vector<int> first_lower_, first_upper_, first_update_;
  std::vector<Entry> lower_, upper_;
  std::vector<Update> updates_;
  Equilibration equilibration_;
  std::vector<double> work_;
};

}  // namespace sfdae::core
