// The stages of an implicit Runge-Kutta step of sensitivities, solved together for all parameters.
//
// With S_i = xp_i + T2_i z_i at stage i the equations are those of linear_stages.h for W = I:
//
//     tau/h L_i sum_j D_ij (xp_j + T2_j z_j - S) = B_i z_i + b_i
//     L_i = Z1^T E,  B_i = Z1^T A T2,  b_i = Z1^T (A xp + f)
//
// one matrix of order s d for all columns. T2 = I where the point is ordinary.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/arena.h"
#include "linalg/matrix.h"
#include "sensitivity/sensitivity_point.h"
#include "system/stage_method.h"

namespace sfdae::core {

class SensitivityStages {
 public:
  void resize(int s, int n, int d, int count);
  void keep(int i, const SensitivityPoint& point);
  void keep_matrices(int i, const LinearizedPoint& point);
  // Stage i of points that are not ordinary, to be filled by callers with other linearizations.
  struct Parts {
    View xp, T2, L, B, b;
  };
  Parts parts(int i, double time_scale);
  // S_start: n x count, of scaled unknowns. False if the matrix is singular.
  bool solve(const StageMethod& method, double h, ConstView S_start, Arena& arena);
  // The matrix of z alone; false if it is singular. Then right-hand sides for its transpose, s d x any number.
  bool factor(const StageMethod& method, double h, Arena& arena);
  void solve_transposed(View weights) const;
  // Errors of the differential part at the last stage: T2 z with Z1^T E T2 z = Z1^T E e; scaled. False: Z1^T E T2 is
  // singular.
  bool map_errors(ConstView errors, View mapped, Arena& arena) const;
  // S of stage i, scaled.
  void expand(int i, View S) const;

 private:
  struct Stage {
    Matrix xp, L, B, b;
    double tau = 1.0;
  };

  int s_ = 0, n_ = 0, d_ = 0, count_ = 0;
  bool is_ordinary_ = false;
  std::vector<Stage> stages_;
  ConstView T2(int j) const { return ConstView(T2_).block(0, j * d_, n_, d_); }

  Matrix T2_;          // n x s d, of all stages
  Matrix matrix_, z_;  // s d x s d, s d x count
  std::vector<int> pivots_;
};

}  // namespace sfdae::core
