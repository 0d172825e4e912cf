// Sparse systems of linear equations with matrices that change little: pivots are chosen once, by values and fill, and all
// operations of the elimination are listed. Those of later matrices run through the list, without any search or test.
//
// Whether the pivots serve is seen from the solutions: their residuals have to be rounding errors of the scaled equations, after
// one step of refinement where necessary [ADD89]. If not, pivots are chosen anew for the matrix at hand.
//
// [ADD89] M. Arioli, J. W. Demmel, I. S. Duff: Solving sparse linear systems with sparse backward error. SIAM J. Matrix Anal.
//         Appl. 10 (1989), 165-190.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "linalg/archive.h"
#include "linalg/equilibration.h"
#include "linalg/sparse_pattern.h"

namespace sfdae::core {

class PlannedLu {
 public:
  // Forgets the pivots.
  void analyze(const SparsePattern& pattern);
  // Pivots for this matrix. False: it is singular or has values that are not finite, or the elimination takes longer than that of a
  // full matrix by LAPACK does; then, or where pivots had to be chosen too often, it is unsuitable until analyze().
  bool plan(const double* values);
  bool is_suitable() const { return is_suitable_; }
  // X := A^-1 B, both column-major, size x count, apart from each other. Chooses pivots where none are known or these do not serve.
  // False: as plan(), or no residual was small. Raises no floating-point exception, allocates only for new pivots.
  bool solve(const double* values, const double* b, int count, double* x);

  // After analyze() of the same pattern, when reading: the pivots are those of the same matrix again. Throws DamagedArchive.
  void archive(Archive& archive);

  // Choices of pivots.
  long plans() const { return plans_; }
  // Multiplications of the elimination.
  std::size_t operations() const { return target_.size(); }

 private:
  class Planning;
  void take(const Planning& planning);
  bool is_worthwhile(std::size_t operations) const;
  bool choose_pivots(const double* values);
  bool solve_with_plan(const double* values, const double* b, int count, double* x);
  bool factor(const double* values);
  template <int width>
  bool solve_columns(const double* b, int count, bool checked, double* x);
  bool solve_all(const double* b, int count, bool checked, double* x);
  template <int width>
  void add_to_sum();
  template <int width>
  void substitute(double* z) const;
  template <int width>
  double residual(const double* b, const double* y_of_all);

  static constexpr int at_once = 4;  // columns

  SparsePattern pattern_;
  bool is_suitable_ = true, has_plan_ = false;
  long plans_ = 0, solutions_ = 0;
  std::vector<double> planned_values_;  // of the matrix that the pivots were chosen for
  Equilibration scales_;
  std::vector<double> row_factor_, column_factor_, entry_factor_;
  std::vector<double> scaled_;  // in the order of the pattern
  // Step k of the elimination: the row of its pivot has the further entries first_u[k], ..., its column the multipliers
  // first_l[k], ...; rows and columns are numbered by their steps. All numbers are in values_.
  std::vector<int> step_of_row_, step_of_column_;
  std::vector<int> position_, row_step_, column_step_;  // of the entries of the pattern; the first in values_
  std::vector<int> first_u_, first_l_;                  // size + 1, of the lists of columns and of rows
  std::vector<int> u_column_, l_row_;
  std::vector<int> target_;               // of each multiplier with each entry of the row, in values_
  std::vector<double> values_;            // pivots, entries of rows, multipliers
  std::vector<double> inverse_;           // of the pivots
  std::vector<double> b_, y_, r_, sums_;  // by steps, columns side by side
  std::vector<double> b_sum_, y_sum_;     // of columns with weights
  double weight_ = 1.0;                   // of the last one
};

}  // namespace sfdae::core
