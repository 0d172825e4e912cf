// Sparse systems of linear equations with matrices that change little: pivots are chosen once, by values and fill, and
// all operations of the elimination are listed. Later matrices are eliminated by the list, without any search or test.
//
// Residuals of the solutions show whether the pivots are suitable: they have to be rounding errors of the scaled
// equations, after one step of refinement if necessary [ADD89]. If not, new pivots are chosen for the current matrix.
//
// [ADD89] M. Arioli, J. W. Demmel, I. S. Duff: Solving sparse linear systems with sparse backward error. SIAM J.
// Matrix Anal.
//         Appl. 10 (1989), 165-190.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "linalg/archive.h"
#include "linalg/equilibration.h"
#include "linalg/sparse_pattern.h"

namespace sfdae::core {

// Operations of the elimination for matrices of one pattern, without any search or test. Step k: the row of its pivot
// has the further entries first_u[k], ..., its column the multipliers first_l[k], ...; rows and columns are numbered by
// their steps. All numbers are in one array of `fill`: pivots, entries of rows, multipliers.
struct EliminationList {
  std::size_t size() const { return row_factor.size(); }

  std::vector<double> row_factor, column_factor,
      entry_factor;  // of equilibration; entries in the order of the pattern
  std::vector<int> step_of_row, step_of_column;
  std::vector<int> position, row_step, column_step;  // of the entries of the pattern; the first among all numbers
  std::vector<int> first_u, first_l;                 // size + 1, of the lists of columns and of rows
  std::vector<int> u_column, l_row;
  std::vector<int> target;  // of each multiplier with each entry of the row, among all numbers
  std::size_t fill = 0;
};

// Residuals of scaled equations relative to their terms: limits below which solutions are not refined, and above which
// they are refused. With residuals up to 1e-14 accepted, the error test of sensitivities was limited by their noise,
// and steps became ever shorter.
inline constexpr double rounding_of_residuals = 1e-16, refused_residuals = 1e-12;

class EliminationPlanning;

class PlannedLu {
 public:
  // Forgets the pivots. accepted: residuals with which solutions are not refined.
  void analyze(const SparsePattern& pattern, double accepted = rounding_of_residuals);
  // Chooses pivots for this matrix. False: it is singular or has values that are not finite, or the elimination takes
  // longer than that of a full matrix by LAPACK; then, or if pivots had to be chosen too often, it is unsuitable until
  // analyze().
  bool plan(const double* values);
  bool is_suitable() const { return is_suitable_; }
  // X := A^-1 B, both column-major, size x count, without overlap. Chooses pivots if none are known or these are
  // unsuitable. False: as plan(), or no residual was small. Raises no floating-point exception, allocates only for new
  // pivots.
  bool solve(const double* values, const double* b, int count, double* x);

  // Reading, after analyze() of the same pattern, restores the pivots of the same matrix. Throws DamagedArchive.
  void archive(Archive& archive);

  // Used to eliminate several matrices at once; null if no pivots are known.
  const EliminationList* list() const { return is_suitable_ && has_plan_ ? &list_ : nullptr; }
  // Number of pivot choices.
  long plans() const { return plans_; }
  // Multiplications of the elimination.
  std::size_t operations() const { return list_.target.size(); }

 private:
  void take(const EliminationPlanning& planning);
  bool is_worthwhile(std::size_t operations) const;
  bool choose_pivots(const double* values);
  bool solve_with_plan(const double* values, const double* b, int count, double* x);
  void list_rows();
  bool factor(const double* values);
  template <int width>
  bool solve_columns(const double* b, int count, double* x);
  template <int width>
  void substitute(double* z) const;
  enum class Terms { all, last };
  template <int width, Terms terms>
  double residual();

  static constexpr int at_once = 4;  // columns

  SparsePattern pattern_;
  bool is_suitable_ = true, has_plan_ = false;
  long plans_ = 0, solutions_ = 0;
  double accepted_ = rounding_of_residuals;
  std::vector<double> planned_values_;  // of the matrix that the pivots were chosen for
  Equilibration scales_;
  EliminationList list_;
  // The entries of the pattern by the steps of their rows.
  struct RowEntry {
    int entry, position;  // in the pattern; among all numbers
    double factor;
  };
  std::vector<RowEntry> rows_;
  std::vector<int> first_of_row_, column_in_row_;  // steps
  std::vector<double> scaled_;                     // in this order
  std::vector<double> values_;                     // pivots, entries of rows, multipliers
  std::vector<double> inverse_;                    // of the pivots
  std::vector<double> b_, y_, r_;                  // by steps, columns side by side
};

}  // namespace sfdae::core
