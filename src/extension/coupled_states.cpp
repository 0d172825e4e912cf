// Coupled equations for the states of all stages.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/coupled_states.h"

#include <algorithm>

#include "linalg/dense.h"
#include "linalg/small_kernels.h"

namespace sfdae::core {

void CoupledStates::resize(const StageMethod& method, double h) {
  s_ = method.s;
  const std::size_t size = index(s_) * index(d_);
  D_.resize(index(s_) * index(s_));
  for (int i = 0; i < s_; ++i)
    for (int k = 0; k < s_; ++k) D_[index(i + k * s_)] = method.D_at(i, k) / h;
  matrix_.resize(std::max(matrix_.size(), size * size));
  w_.resize(std::max(w_.size(), size));
  z_.resize(w_.size());
  pivots_.resize(std::max(pivots_.size(), size));
}

void CoupledStates::set_pairs(int d, const std::vector<Pair>& pairs) {
  d_ = d;
  pairs_ = pairs;
  pair_of_a_.assign(index(d), -1);
  pair_of_b_.assign(index(d), -1);
  for (std::size_t p = 0; p < pairs.size(); ++p)
    pair_of_a_[index(pairs[p].a)] = pair_of_b_[index(pairs[p].b)] = static_cast<int>(p);
  kept_.clear();
  equations_.clear();
  place_.assign(index(d), -1);
  for (int j = 0; j < d; ++j) {
    if (pair_of_a_[index(j)] < 0) equations_.push_back(j);
    if (pair_of_b_[index(j)] >= 0) continue;
    place_[index(j)] = static_cast<int>(kept_.size());
    kept_.push_back(j);
  }
}

// Condensed equations: z_b in terms of z_a of all stages, in the rows of equations_.
void CoupledStates::fill_condensed() {
  const int left = static_cast<int>(kept_.size()), size = s_ * left;
  const auto D = [this](int i, int k) { return D_[index(i + k * s_)]; };
  D2_.assign(D_.size(), 0.0);
  for (int i = 0; i < s_; ++i)
    for (int k = 0; k < s_; ++k)
      for (int l = 0; l < s_; ++l) D2_[index(i + l * s_)] += D(i, k) * D(k, l);
  for (int l = 0; l < s_; ++l)
    for (int u = 0; u < left; ++u)
      for (int i = 0; i < s_; ++i) {
        const int state = kept_[index(u)], pair = pair_of_a_[index(state)];
        double* __restrict to = matrix_.data() + index(l * left + u) * index(size) + index(i * left);
        const double* const own = slopes_of(i) + index(state) * index(left);
        if (pair < 0 || i == l) std::fill_n(to, left, 0.0);
        if (i == l)
          for (int c = 0; c < left; ++c) to[c] -= own[c];
        if (pair < 0) continue;
        const double* const of_b = slopes_of(i) + index(pairs_[index(pair)].b) * index(left);
        const double factor = D(i, l);
        if (i == l)
          for (int c = 0; c < left; ++c) to[c] -= factor * of_b[c];
        else
          for (int c = 0; c < left; ++c) to[c] = -factor * of_b[c];
      }
  for (int c = 0; c < left; ++c) {
    const int state = equations_[index(c)], pair = pair_of_b_[index(state)];
    const int u = place_[index(pair < 0 ? state : pairs_[index(pair)].a)];
    const std::vector<double>& of_slope = pair < 0 ? D_ : D2_;
    for (int l = 0; l < s_; ++l)
      for (int i = 0; i < s_; ++i)
        matrix_[index(l * left + u) * index(size) + index(i * left + c)] += of_slope[index(i + l * s_)];
  }
}

bool CoupledStates::factor_matrix() {
  const View M{matrix_.data(), size(), size(), std::max(size(), 1)};
  return size() <= most_by_loops ? small::factor_lu(M, pivots_.data()) : factor_lu(M, pivots_.data());
}

// x := L^-1 x of a whole panel, L with a unit diagonal.
void CoupledStates::solve_unit_lower(ConstView panel, double* x) {
  double z[panel_width];
  for (int i = 0; i < panel_width; ++i) z[i] = x[i];
#pragma GCC unroll 8
  for (int k = 0; k < panel_width; ++k) {
    const double* const L = panel.column(k);
#pragma GCC unroll 8
    for (int i = k + 1; i < panel_width; ++i) z[i] -= L[i] * z[k];
  }
  for (int i = 0; i < panel_width; ++i) x[i] = z[i];
}

// Factors by panels of few columns; the part to their right is updated by products of matrices.
bool CoupledStates::factor_by_panels() {
  const int n = size();
  const View M{matrix_.data(), n, n, std::max(n, 1)};
  for (int first = 0; first < n; first += panel_width) {
    const int width = std::min(panel_width, n - first), rest = n - first - width;
    if (!small::factor_lu(M.block(first, first, n - first, width), pivots_.data() + first)) return false;
    for (int k = first; k < first + width; ++k) pivots_[index(k)] += first;
    int exchanges[2][panel_width], count = 0;
    for (int k = first; k < first + width; ++k) {
      if (pivots_[index(k)] == k + 1) continue;
      exchanges[0][count] = k;
      exchanges[1][count++] = pivots_[index(k)] - 1;
    }
    const auto exchange = [&](int from, int to) {
      for (int j = from; j < to; ++j) {
        double* const column = M.column(j);
        for (int k = 0; k < count; ++k) std::swap(column[exchanges[0][k]], column[exchanges[1][k]]);
      }
    };
    exchange(0, first);
    exchange(first + width, n);
    if (rest == 0) break;
    const View above = M.block(first, first + width, width, rest);
    const ConstView panel = M.block(first, first, width, width);
    for (int j = 0; j < rest; ++j) solve_unit_lower(panel, above.column(j));
    multiply(-1.0, Op::plain, M.block(first + width, first, rest, width), Op::plain, above, 1.0,
             M.block(first + width, first + width, rest, rest));
  }
  return true;
}

void CoupledStates::solve() {
  const ConstView lu{matrix_.data(), size(), size(), std::max(size(), 1)};
  if (pairs_.empty()) return solve_lu(lu, pivots_.data(), w_.data());
  const int left = static_cast<int>(kept_.size());
  const auto w = [&](int i, int j) -> double& { return w_[index(i * d_ + j)]; };
  const auto D_times = [&](int i, int j) {
    double sum = 0.0;
    for (int k = 0; k < s_; ++k) sum += D_[index(i + k * s_)] * w(k, j);
    return sum;
  };
  for (int i = 0; i < s_; ++i) {
    double* const to = z_.data() + index(i * left);
    for (int c = 0; c < left; ++c) {
      const int state = equations_[index(c)], pair = pair_of_b_[index(state)];
      to[c] = w(i, state) + (pair < 0 ? 0.0 : D_times(i, pairs_[index(pair)].a));
    }
    for (const Pair& pair : pairs_) {
      const double* const of_b = slopes_of(i) + index(pair.b) * index(left);
      const double known = w(i, pair.a);
      for (int c = 0; c < left; ++c) to[c] -= known * of_b[c];
    }
  }
  solve_lu(lu, pivots_.data(), z_.data());
  // Besides z_a the right-hand side of its equation is still needed.
  for (int i = 0; i < s_; ++i)
    for (const Pair& pair : pairs_) w(i, pair.b) = -w(i, pair.a);
  for (int i = 0; i < s_; ++i)
    for (int u = 0; u < left; ++u) w(i, kept_[index(u)]) = z_[index(i * left + u)];
  for (int i = 0; i < s_; ++i)
    for (const Pair& pair : pairs_) w(i, pair.b) += D_times(i, pair.a);
}

}  // namespace sfdae::core
