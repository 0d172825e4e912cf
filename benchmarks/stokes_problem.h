// Flow in a closed square by Stokes's equations on a staggered grid of k x k cells: velocities u on their vertical
// sides, v on their horizontal ones, pressures p inside. u' = nu L u - G p + f, D u = 0; the pressure of the first
// cell is 0 in place of its continuity, which follows from the others. n = 2 k (k - 1) + k^2.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <map>
#include <vector>

#include "ida_sparse.h"
#include "structure_problems.h"

namespace sfdae_bench {

// E x' = A x + sin(t) f, E = 1 for velocities and 0 for pressures; by rows.
class Stokes {
 public:
  explicit Stokes(int k) : k_(k), rows_(at(n())), force_(at(n()), 0.0) {
    for (int j = 0; j < k; ++j)
      for (int i = 1; i < k; ++i) add_momentum(i, j, true);
    for (int j = 1; j < k; ++j)
      for (int i = 0; i < k; ++i) add_momentum(i, j, false);
    for (int j = 0; j < k; ++j)
      for (int i = 0; i < k; ++i) add_continuity(i, j);
  }

  using Row = std::map<int, double>;
  int n() const { return 2 * k_ * (k_ - 1) + k_ * k_; }
  bool is_velocity(int i) const { return i < 2 * k_ * (k_ - 1); }
  const Row& row(int i) const { return rows_[at(i)]; }
  double force(int i) const { return force_[at(i)]; }

  // 0 = D (A u + f) in place of D u = 0.
  Stokes differentiated() const {
    Stokes result = *this;
    for (int i = 0; i < n(); ++i) {
      if (is_velocity(i) || row(i).size() < 2) continue;
      Row sum;
      double force = 0.0;
      for (const auto& [j, factor] : row(i)) {
        for (const auto& [k, value] : row(j)) sum[k] += factor * value;
        force += factor * this->force(j);
      }
      result.rows_[at(i)] = sum;
      result.force_[at(i)] = force;
    }
    return result;
  }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  int u(int i, int j) const { return j * (k_ - 1) + i - 1; }
  int v(int i, int j) const { return k_ * (k_ - 1) + (j - 1) * k_ + i; }
  int p(int i, int j) const { return 2 * k_ * (k_ - 1) + j * k_ + i; }

  // Walls: 0 at them, which lie half a cell away for the velocity along them.
  void add_momentum(int i, int j, bool along_x) {
    constexpr double nu = 0.1;
    const double h = 1.0 / k_, diffusion = nu / (h * h);
    const int self = along_x ? u(i, j) : v(i, j);
    Row& row = rows_[at(self)];
    const auto neighbour = [&](int di, int dj) {
      const int ni = i + di, nj = j + dj;
      const int first = along_x ? ni : nj, second = along_x ? nj : ni;
      const bool is_wall = first < 1 || first >= k_, is_beyond = second < 0 || second >= k_;
      row[self] -= is_beyond ? 2.0 * diffusion : diffusion;
      if (!is_wall && !is_beyond) row[along_x ? u(ni, nj) : v(ni, nj)] += diffusion;
    };
    neighbour(1, 0), neighbour(-1, 0), neighbour(0, 1), neighbour(0, -1);
    row[p(i, j)] -= 1.0 / h;
    row[along_x ? p(i - 1, j) : p(i, j - 1)] += 1.0 / h;
    force_[at(self)] = along_x ? std::sin(pi * (j + 0.5) * h) + i * h : std::cos(pi * i * h) * j * h;
  }
  void add_continuity(int i, int j) {
    Row& row = rows_[at(p(i, j))];
    if (i == 0 && j == 0) {
      row[p(0, 0)] = 1.0;
      return;
    }
    const double h = 1.0 / k_;
    if (i + 1 < k_) row[u(i + 1, j)] += 1.0 / h;
    if (i > 0) row[u(i, j)] -= 1.0 / h;
    if (j + 1 < k_) row[v(i, j + 1)] += 1.0 / h;
    if (j > 0) row[v(i, j)] -= 1.0 / h;
  }

  int k_;
  std::vector<Row> rows_;
  std::vector<double> force_;
};

inline SparseProblem stokes_problem(int k) {
  SparseProblem problem;
  problem.record = [stokes = Stokes(k)](const Expression& t, const Expression* x, const Expression* xdot,
                                        Expression* F) {
    for (int i = 0; i < stokes.n(); ++i) {
      Expression sum = stokes.force(i) * sin(t);
      for (const auto& [j, value] : stokes.row(i)) sum = sum + value * x[j];
      F[i] = stokes.is_velocity(i) ? xdot[i] - sum : sum;
    }
  };
  problem.x0.assign(static_cast<std::size_t>(Stokes(k).n()), 0.0);
  problem.tf = 1.0;
  return problem;
}

// Differentiated by hand; at t = 0 all values and slopes are zero but those that the force demands at once, cos 0 f:
// none.
inline SparsePeer stokes_peer(int k) {
  SparsePeer peer;
  const Stokes stokes = Stokes(k).differentiated();
  const std::size_t n = static_cast<std::size_t>(stokes.n());
  peer.x0.assign(n, 0.0);
  peer.xdot0.assign(n, 0.0);
  peer.tf = 1.0;
  peer.residual = [stokes](double t, const double* x, const double* xdot, double* F) {
    for (int i = 0; i < stokes.n(); ++i) {
      F[i] = (stokes.is_velocity(i) ? xdot[i] : 0.0) - stokes.force(i) * std::sin(t);
      for (const auto& [j, value] : stokes.row(i)) F[i] -= value * x[j];
    }
  };
  std::vector<std::map<int, double>> columns(n);
  for (int i = 0; i < stokes.n(); ++i)
    for (const auto& [j, value] : stokes.row(i)) columns[static_cast<std::size_t>(j)][i] = -value;
  peer.first.assign(1, 0);
  std::vector<double> plain, slopes;
  for (std::size_t j = 0; j < n; ++j) {
    for (const auto& [i, value] : columns[j]) {
      peer.row.push_back(i);
      plain.push_back(value);
      slopes.push_back(i == static_cast<int>(j) && stokes.is_velocity(i) ? 1.0 : 0.0);
    }
    peer.first.push_back(static_cast<int>(peer.row.size()));
  }
  peer.jacobian = [plain, slopes](double c, const double*, double* values) {
    for (std::size_t e = 0; e < plain.size(); ++e) values[e] = plain[e] + c * slopes[e];
  };
  return peer;
}

}  // namespace sfdae_bench
