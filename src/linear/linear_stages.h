// The stages of an implicit Runge-Kutta step of a linear problem, solved together.
//
// With x_j = X_j [z_j; 1], X_j = [T2 xp] at t_j, and Y_j = W_j X_j the equations of stage i are
//
//     tau/h L_i sum_j D_ij (Y_j [z_j; 1] - w) = [B b]_i [z_i; 1]        L_i = Z1^T E (or Z1^T for W = E)
//     sum_j D_ij V_i (X_j [z_j; 1] - x) = 0                             V_i = (T2 Uz)^T, free components
//
// s(d+u) linear equations. If the matrices do not depend on t, transformation by T decouples them into one real system
// and (s-1)/2 complex ones of order d + u [HW96, IV.8]; nothing has to be iterated, as the problem is linear.
//
// [HW96] E. Hairer, G. Wanner: Solving Ordinary Differential Equations II. Springer, 2nd ed. 1996.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/arena.h"
#include "linalg/matrix.h"
#include "linear/linear_point.h"
#include "system/step_matrix.h"
#include "system/strangeness_free_system.h"

namespace sfdae::core {

// Workspace of a step: stage data that the equations need, side by side, and their matrix. It grows in the first step
// and is used again in the others.
class LinearStages {
 public:
  // For s stages of a system with these traits.
  void resize(int s, const SystemTraits& traits);
  // Copies what the equations of all stages need from a point, stage i.
  void keep(int i, const LinearPoint& point, LeadingTerm leading, Arena& arena);

  // All z from one system for all stages. False if it is singular. x: at the start, in the units of the unknowns;
  // count: of factorizations, raised.
  bool solve_coupled(const StageEquations& equations, const double* x, Arena& arena, long& count);

  // The last stage of a constant problem, whose matrices are those of all stages, and their factors.
  struct ConstantMatrices {
    const LinearPoint& point;
    LeadingTerm leading;
    StepMatrix& matrix;  // factored, with those of the stages
  };
  // All z from one system for each pair of eigenvalues.
  void solve_decoupled(const StageEquations& equations, const double* x, const ConstantMatrices& constant,
                       Arena& arena);

  // x_i = X_i [z_i; 1] and w_i = Y_i [z_i; 1]; the latter not for constant problems.
  void expand_x(int i, double* x) const { combine(i, X_, traits_.unknowns, x); }
  void expand_w(int i, double* w) const { combine(i, Y_, traits_.leading_size, w); }

 private:
  // One kind of equations of all stages: `rows` to a stage, from row `at` of each; left right_j [z_j; 1] differenced.
  struct Rows {
    int rows, at;
    const std::vector<double>& left;
    ConstView right;
    const double* start;
  };
  void add_rows(const Rows& rows, const StageEquations& equations, std::vector<double>& products, Arena& arena);
  void assemble(const StageEquations& equations, const double* x, Arena& arena);
  void fill_residuals(const StageEquations& equations, double factor, ConstView offsets, View r) const;
  void combine(int i, const std::vector<double>& columns, int rows, double* to) const;

  int unknowns() const { return traits_.differential + traits_.undetermined; }  // q: of a stage
  int columns() const { return s_ * (unknowns() + 1); }

  int s_ = 0;
  SystemTraits traits_;
  std::vector<double> X_, Y_;                     // n x s(q+1): X_i; leading_size x s(q+1): W_i X_i
  std::vector<double> L_;                         // s d x leading_size: Z1^T E, without the E for W = E
  std::vector<double> B_, tau_;                   // d x s(q+1): [B b]; time scales
  std::vector<double> V_;                         // s u x n: (T2 Uz)^T
  std::vector<double> products_, free_products_;  // L Y, V X
  std::vector<double> matrix_, z_;
  std::vector<int> pivots_;
};

}  // namespace sfdae::core
