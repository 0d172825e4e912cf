// A staged elimination stored for further right-hand sides: a chord iteration transforms residuals and recovers y with
// it.
//
// Stage j = i + 1 of elimination.h turns [block row i; carried] into rows that determine y_j and rows carried on:
//
//     R11 y_p + R12 y_q = Q1^T (f_i - block row i without y_j)          y_j P = [y_p; y_q]
//     [R_q S_q] P_q y_q = (rows leaving) - their part in y_1, ..., y_{j-1}, x
//
// Components of y that nothing determines stay as they are (their change is 0).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/arena.h"
#include "linalg/matrix.h"
#include "problem/taylor_data.h"

namespace sfdae::core {

class StoredElimination {
 public:
  // f of (level + 1) m entries is transformed: f^ = Z^T f, carried_rows() entries, comes first in `transformed`, of the
  // size of f; the data for recover() follow.
  void transform(const double* f, double* transformed, Arena& arena) const;
  // Maps weights of f^ to weights of f: weights_of_f^T f = weights^T f^; (level + 1) m entries.
  void transform_transposed(const double* weights, double* weights_of_f, Arena& arena) const;
  // A solution y_1, ..., y_{level+1} of M y = N x + f for a given x, if one exists. data: the coefficients that were
  // eliminated. y: n x (level + 1).
  struct RightHandSide {
    const double* f;
    const double* transformed;
  };
  void recover(const TaylorData& data, RightHandSide rhs, const double* x, double* y, Arena& arena) const;

  // n x (level + 1) flags: 1 where recover() changes y.
  void mark_determined(std::vector<char>& flags) const;

  int carried_rows() const { return carried_; }
  int level() const { return level_; }

  // Data of stage i, for callers that transform and recover several right-hand sides side by side.
  struct StageView {
    int rank, null_rows, leaving, rhs;
    bool by_reflections;
    ConstView R, Q, W, X, T, rows;
    const double *X_tau, *T_tau;
    const int *pivots, *pivots_of_rows;
    ConstView solution;  // no columns: is_combined() is false
  };
  StageView stage(int i) const;
  bool is_combined() const;

  // Called by eliminate().
  void begin(const TaylorData& data, int level);
  // Called for the following stages.
  void keep_diagonal_block(ConstView factors, const int* pivots, ConstView Q, int rank);
  void begin_stage(int i, int carried);
  void keep_reflections(ConstView X, const double* tau);
  void keep_combination(ConstView W);
  void keep_leaving(ConstView T, const int* pivots, const double* tau, ConstView rows);
  void finish(const TaylorData& data, Arena& arena);

 private:
  // rows x cols, ld = rows.
  struct Block {
    std::vector<double> entries;
    int rows = 0, cols = 0;
    void resize(int new_rows, int new_cols);
    void keep(ConstView from);
    View view() { return {entries.data(), rows, cols, rows > 0 ? rows : 1}; }
    ConstView view() const { return {entries.data(), rows, cols, rows > 0 ? rows : 1}; }
  };
  // E_0 restricted to the rows of a stage.
  struct Diagonal {
    Block R, Q;
    std::vector<int> pivots;
    int rank = 0, null_rows = 0;
  };
  struct Stage {
    std::size_t diagonal = 0;
    int carried = 0, leaving = 0;
    bool by_reflections = false;
    Block W, X, T, rows;  // rows: leaving ones in y_1, ..., y_i, x
    std::vector<double> X_tau, T_tau;
    int rhs = 0;  // position of the right-hand sides of the rows leaving
    std::vector<int> pivots;
    Block solution;  // y_j = solution [f_i; rows leaving; x; y_1; ...; y_i], for small problems
  };

  void combine(const TaylorData& data, int i, Arena& arena);
  // Known data from which y is recovered.
  struct Known {
    const TaylorData& data;
    RightHandSide rhs;
    const double* x;
  };
  void solve_stage(const Known& known, int i, double* y, Arena& arena) const;

  const Diagonal& diagonal_of(const Stage& stage) const { return diagonals_[stage.diagonal]; }

  int m_ = 0, n_ = 0, level_ = 0, carried_ = 0;
  std::vector<Diagonal> diagonals_;
  std::size_t num_diagonals_ = 0;
  std::vector<Stage> stages_;  // index i = 0..level
  Stage* stage_ = nullptr;     // being stored
};

}  // namespace sfdae::core
