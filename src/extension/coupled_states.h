// Coupled equations for the states, after each stage of an implicit Runge-Kutta step has been reduced to them:
//
//     sum_k D_ik / h z_k - B_i z_i = w_i,    i = 1, ..., s,    d each.
//
// If the slope of a state is another state, as that of a position is a velocity, that row of B_i is a unit vector, and
//
//     z_i,b = sum_k D_ik / h z_k,a - w_i,a    for each such pair a, b
//
// leaves s (d - pairs) equations. With time in units of h these pivots are 1, next to entries of D.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "linalg/index.h"
#include "linalg/matrix.h"
#include "system/stage_method.h"

namespace sfdae::core {

class CoupledStates {
 public:
  // slope(a, b, i): entry (a, b) of B_i. False: singular.
  template <class Slope>
  bool factor(const StageMethod& method, double h, int d, Slope slope);
  // Like factor(), with pairs eliminated: in row a of B_i the entry of b is 1, and all others are 0. Each state is in
  // at most one pair.
  struct Pair {
    int a, b;
  };
  void set_pairs(int d, const std::vector<Pair>& pairs);
  // Remaining rows of B_i.
  const std::vector<int>& equations() const { return equations_; }
  // slope(c, b, i): in the row of equations()[c].
  template <class Slope>
  bool factor_condensed(const StageMethod& method, double h, Slope slope);
  // w, stage after stage; solve() replaces it by the solution.
  double* right() { return w_.data(); }
  void solve();
  // Size of the matrix that was factored.
  int size() const { return s_ * static_cast<int>(kept_.size()); }
  int pairs() const { return static_cast<int>(pairs_.size()); }

  // Largest order for the loops of small_kernels.h; LAPACK takes 1.6 times their instructions for 20 equations.
  static constexpr int most_by_loops = 40;

 private:
  void resize(const StageMethod& method, double h);
  void fill_condensed();
  bool factor_matrix();
  bool factor_by_panels();
  static constexpr int panel_width = 8;
  static void solve_unit_lower(ConstView panel, double* x);
  double* slopes_of(int i) { return slopes_.data() + index(i) * index(d_) * kept_.size(); }

  int s_ = 0, d_ = 0;
  std::vector<double> D_, D2_;  // D / h, and its square
  std::vector<Pair> pairs_;
  // States except the b of pairs, which are the unknowns; equations except those of the a; for each state its pair as a
  // or b, and its place among the unknowns, or -1.
  std::vector<int> kept_, equations_, pair_of_a_, pair_of_b_, place_;
  std::vector<double> slopes_;  // the remaining rows of B_i, column-major, stage after stage
  std::vector<double> matrix_, w_, z_;
  std::vector<int> pivots_;
};

template <class Slope>
bool CoupledStates::factor(const StageMethod& method, double h, int d, Slope slope) {
  set_pairs(d, {});
  resize(method, h);
  const int size = s_ * d_;
  double* const M = matrix_.data();
  const auto at = [M, size](int row, int column) -> double& { return M[index(row) + index(column) * index(size)]; };
  std::fill_n(M, index(size) * index(size), 0.0);
  for (int i = 0; i < s_; ++i) {
    for (int k = 0; k < s_; ++k)
      for (int a = 0; a < d_; ++a) at(i * d_ + a, k * d_ + a) = D_[index(i + k * s_)];
    for (int b = 0; b < d_; ++b)
      for (int a = 0; a < d_; ++a) at(i * d_ + a, i * d_ + b) -= slope(a, b, i);
  }
  return factor_matrix();
}

template <class Slope>
bool CoupledStates::factor_condensed(const StageMethod& method, double h, Slope slope) {
  resize(method, h);
  slopes_.resize(std::max(slopes_.size(), index(s_ * d_) * kept_.size()));
  for (int i = 0; i < s_; ++i) {
    double* next = slopes_of(i);
    for (int b = 0; b < d_; ++b)
      for (std::size_t c = 0; c < equations_.size(); ++c) *next++ = slope(static_cast<int>(c), b, i);
  }
  fill_condensed();
  return factor_by_panels();
}

}  // namespace sfdae::core
