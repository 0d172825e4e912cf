// Ranks of one level of the derivative array with a certificate.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/certificate.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "linalg/index.h"
#include "linalg/random.h"

namespace sfdae::core {

namespace {

constexpr int lanes = LockstepMatrix::lanes;
using Suspicion = BalancedUnits::Suspicion;

// E_k and A_k with their copies, order after order, entry after entry.
class PerturbedData {
 public:
  PerturbedData(const TaylorData& data, int level, const BalancedUnits& units, bool omits_suspects)
      : m_(data.m), n_(data.n), generator_(1), least_(omits_suspects ? Suspicion::maybe : Suspicion::certain) {
    for (int k = 0; k <= level; ++k) {
      const bool may_omit = k == 0 && !units.suspects_E.empty();
      add(data, 'E', k, may_omit ? units.suspects_E.data() : nullptr, E_);
      add(data, 'A', k, may_omit ? units.suspects_A.data() : nullptr, A_);
    }
  }
  const double* E(int k, int i, int j) const { return E_.data() + first(k, i, j); }
  const double* A(int k, int i, int j) const { return A_.data() + first(k, i, j); }

 private:
  std::size_t first(int k, int i, int j) const {
    return ((index(k) * index(n_) + index(j)) * index(m_) + index(i)) * index(lanes);
  }
  // On top of its own rounding each entry has the errors of differences and what residuals along a jet may change.
  void add(const TaylorData& data, char which, int order, const Suspicion* suspects, std::vector<double>& to) {
    const ConstView block = which == 'E' ? data.E(order) : data.A(order);
    const double residual_error = data.residual_noise * data.norm(order);
    for (int entry = 0; entry < m_ * n_; ++entry) {
      const bool is_omitted = suspects != nullptr && suspects[entry] >= least_;
      const double value = is_omitted ? 0.0 : block.data[entry];
      const double error = data.scaled_error(which, order, entry) +
                           (value != 0.0 ? trial_perturbation * std::fabs(value) + residual_error : 0.0);
      to.push_back(value);
      for (int k = 1; k < lanes; ++k) to.push_back(value + error * symmetric_random(generator_));
    }
  }

  int m_, n_;
  std::minstd_rand generator_;
  Suspicion least_;  // that is taken for zero
  std::vector<double> E_, A_;
};

// Rows of the level that are there.
std::vector<int> rows_of_level(const TaylorData& data, int i) {
  std::vector<int> rows;
  for (int row = 0; row < data.m; ++row)
    if (data.has_row(row, i)) rows.push_back(row);
  return rows;
}

void copy_entry(const double* from, double* to) { std::copy_n(from, lanes, to); }

LockstepMatrix rows_of_E(const PerturbedData& data, const std::vector<int>& rows, int n) {
  LockstepMatrix E(static_cast<int>(rows.size()), n);
  for (int row = 0; row < E.rows(); ++row)
    for (int j = 0; j < n; ++j) copy_entry(data.E(0, rows[index(row)], j), E.at(row, j));
  return E;
}

// Block row i of the array in columns y_(i+1), ..., y_1, x: E_(i+1-j) - A_(i-j) / j at y_j, A_i at x.
void write_block_row(const PerturbedData& data, const std::vector<int>& rows, int i, int n, LockstepMatrix& to) {
  for (int row = 0; row < static_cast<int>(rows.size()); ++row)
    for (int col = 0; col < n; ++col) {
      const int from = rows[index(row)];
      copy_entry(data.E(0, from, col), to.at(row, col));
      for (int j = 1; j <= i; ++j) {
        double* entry = to.at(row, (i + 1 - j) * n + col);
        for (int k = 0; k < lanes; ++k) entry[k] = data.E(i + 1 - j, from, col)[k] - data.A(i - j, from, col)[k] / j;
      }
      copy_entry(data.A(i, from, col), to.at(row, (i + 1) * n + col));
    }
}

// Columns from `first` on of the rows from `top` on.
LockstepMatrix remainder(const LockstepMatrix& stage, int top, int first) {
  LockstepMatrix rest(stage.rows() - top, stage.cols() - first);
  for (int i = 0; i < rest.rows(); ++i)
    for (int j = 0; j < rest.cols(); ++j) copy_entry(stage.at(top + i, first + j), rest.at(i, j));
  rest.normalize_rows();
  return rest;
}

// Rows of `one` above those of `other`.
LockstepMatrix stack(const LockstepMatrix& one, int rows_of_one, const LockstepMatrix& other) {
  LockstepMatrix all(rows_of_one + other.rows(), other.cols());
  for (int j = 0; j < all.cols(); ++j) {
    for (int i = 0; i < rows_of_one; ++i) copy_entry(one.at(i, j), all.at(i, j));
    for (int i = 0; i < other.rows(); ++i) copy_entry(other.at(i, j), all.at(rows_of_one + i, j));
  }
  return all;
}

}  // namespace

CertifiedRanks certified_ranks(const TaylorData& data, int level, const CertificateSettings& settings) {
  const int n = data.n;
  const PerturbedData perturbed(data, level, settings.units, settings.omits_suspects);
  CertifiedRanks found;
  LockstepMatrix carried(0, (level + 1) * n);
  int diagonal_rank = 0, array_rank = 0;
  for (int i = level; i >= 0; --i) {
    const std::vector<int> rows = rows_of_level(data, i);
    if (i == level || data.has_last_rows(i)) {
      diagonal_rank = rows_of_E(perturbed, rows, n).eliminate(n, found.significance, settings.rank_tol);
      found.list.add(diagonal_rank);
    }
    const int count = static_cast<int>(rows.size());
    LockstepMatrix stage(count + carried.rows(), (i + 2) * n);
    write_block_row(perturbed, rows, i, n, stage);
    for (int row = 0; row < carried.rows(); ++row)
      for (int j = 0; j < carried.cols(); ++j) copy_entry(carried.at(row, j), stage.at(count + row, j));
    const int rank = stage.eliminate(n, found.significance, settings.rank_tol);
    array_rank += rank;
    if (carried.rows() > 0 && diagonal_rank < n) found.list.add(rank - diagonal_rank);
    carried = remainder(stage, rank, n);
  }
  found.ranks.rank_E = diagonal_rank;
  const int rows = carried.rows();
  LockstepMatrix constraints = std::move(carried);
  const int a = constraints.eliminate(n, found.significance, settings.rank_tol);
  if (rows > 0) found.list.add(a);
  LockstepMatrix E = stack(constraints, a, rows_of_E(perturbed, rows_of_level(data, 0), n));
  E.normalize_rows();
  const int d = E.eliminate(n, found.significance, settings.rank_tol) - a;
  if (a < n) found.list.add(d);
  for (int rank : {diagonal_rank, array_rank}) found.list_by_svd.add(rank);
  if (rows > 0) found.list_by_svd.add(a);
  if (a < n) found.list_by_svd.add(d);
  found.ranks.a = a;
  found.ranks.d = d;
  found.ranks.v_hat = rows - a;
  return found;
}

bool has_independent_rows(const TaylorData& data, int level, const BalancedUnits& units) {
  const int n = data.n;
  const PerturbedData perturbed(data, level, units, false);
  int total = 0;
  for (int i = 0; i <= level; ++i) total += static_cast<int>(rows_of_level(data, i).size());
  LockstepMatrix array(total, (level + 2) * n);
  int first = 0;
  for (int i = 0; i <= level; ++i) {
    const std::vector<int> rows = rows_of_level(data, i);
    const int count = static_cast<int>(rows.size());
    LockstepMatrix block(count, (i + 2) * n);
    write_block_row(perturbed, rows, i, n, block);
    for (int row = 0; row < count; ++row)
      for (int j = 0; j < block.cols(); ++j) copy_entry(block.at(row, j), array.at(first + row, (level - i) * n + j));
    first += count;
  }
  array.normalize_rows();
  Significance significance;
  return array.eliminate(array.cols(), significance) == total && significance.weakest > clear_significance;
}

int clear_pencil_rank(const TaylorData& data, const BalancedUnits& units) {
  const PerturbedData perturbed(data, 0, units, false);
  const int full = std::min(data.m, data.n);
  int largest = 0;
  // lambda in balanced units of time, of either sign: far below and above what systems of a stiffness of 1e6 have.
  for (int step = 0; step <= 12 && largest < full; ++step) {
    const double lambda = (step % 2 == 0 ? 0.618 : -1.37) * std::pow(10.0, -12.0 + 1.5 * step);
    LockstepMatrix pencil(data.m, data.n);
    for (int j = 0; j < data.n; ++j)
      for (int i = 0; i < data.m; ++i)
        for (int k = 0; k < lanes; ++k)
          pencil.at(i, j)[k] = lambda * perturbed.E(0, i, j)[k] - perturbed.A(0, i, j)[k];
    pencil.normalize_rows();
    Significance significance;
    const int rank = pencil.eliminate(data.n, significance);
    if (significance.weakest > clear_significance) largest = std::max(largest, rank);
  }
  return largest;
}

}  // namespace sfdae::core
