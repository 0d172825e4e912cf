// Ranks of one level of the derivative array with a certificate.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/certificate.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "linalg/index.h"
#include "linalg/random.h"
#include "reduction/known_rank_elimination.h"

namespace sfdae::core {

namespace {

constexpr int versions = LockstepMatrix::versions, copies = LockstepMatrix::copies;
using Suspicion = BalancedUnits::Suspicion;

// E_k and A_k with their copies.
class PerturbedData {
 public:
  PerturbedData(const TaylorData& data, int level, const BalancedUnits& units, bool omits_suspects,
                TrialPerturbations& random)
      : m_(data.m), least_(omits_suspects ? Suspicion::maybe : Suspicion::certain) {
    const std::size_t entries = index(data.m) * index(data.n);
    const double* next = random.first(2 * index(level + 1) * entries * index(copies));
    for (int k = 0; k <= level; ++k) {
      const bool may_omit = k == 0 && !units.suspects_E.empty();
      E_.push_back(perturbed(data, {'E', k, may_omit ? units.suspects_E.data() : nullptr}, next));
      A_.push_back(perturbed(data, {'A', k, may_omit ? units.suspects_A.data() : nullptr}, next + entries * copies));
      next += 2 * entries * copies;
    }
  }
  const LockstepMatrix& E(int k) const { return E_[index(k)]; }
  const LockstepMatrix& A(int k) const { return A_[index(k)]; }

 private:
  struct Coefficient {
    char which;
    int order;
    const Suspicion* suspects;
  };
  // Besides its own rounding error, each entry has the errors of finite differences and of residuals along a jet.
  LockstepMatrix perturbed(const TaylorData& data, const Coefficient& of, const double* random) const {
    const ConstView block = of.which == 'E' ? data.E(of.order) : data.A(of.order);
    const double residual_error = data.residual_noise * data.norm(of.order);
    const double relative_error = std::max(trial_perturbation, data.difference_noise.of(of.which));
    LockstepMatrix result(data.m, data.n);
    for (int entry = 0; entry < data.m * data.n; ++entry, random += copies) {
      const bool is_omitted = of.suspects != nullptr && of.suspects[entry] >= least_;
      const double value = is_omitted ? 0.0 : block.data[entry];
      const double error = data.scaled_error(of.which, of.order, entry) +
                           (value != 0.0 ? relative_error * std::fabs(value) + residual_error : 0.0);
      if (value == 0.0 && error == 0.0) continue;
      double* to = &result.at(entry % m_, entry / m_);
      to[0] = value;
      for (int k = 1; k < versions; ++k) to[k * lane_count] = value + error * random[k - 1];
    }
    return result;
  }

  int m_;
  Suspicion least_;  // smallest one taken for zero
  std::vector<LockstepMatrix> E_, A_;
};

// Present rows of the level.
std::vector<int> rows_of_level(const TaylorData& data, int i) {
  std::vector<int> rows;
  for (int row = 0; row < data.m; ++row)
    if (data.has_row(row, i)) rows.push_back(row);
  return rows;
}

void copy_entry(const LockstepMatrix& from, int row, int col, double* to) {
  const double* entry = &from.column(col)[row / lane_count * versions].lane[row % lane_count];
  for (int k = 0; k < versions; ++k) to[k * lane_count] = entry[k * lane_count];
}

// Copies these rows of a column to the first rows of a column of another matrix.
void copy_rows(const LockstepMatrix& from, int col, const std::vector<int>& rows, LockstepMatrix& to, int to_col) {
  const int count = static_cast<int>(rows.size());
  // Whole groups of rows: the last one may have more rows, as the rest of the column is still empty.
  if (count == from.rows()) {
    std::copy_n(from.column(col), from.blocks_of_column(), to.column(to_col));
    return;
  }
  for (int row = 0; row < count; ++row) copy_entry(from, rows[index(row)], col, &to.at(row, to_col));
}

LockstepMatrix rows_of_E(const PerturbedData& data, const std::vector<int>& rows) {
  const LockstepMatrix& E = data.E(0);
  LockstepMatrix result(static_cast<int>(rows.size()), E.cols());
  for (int j = 0; j < E.cols(); ++j) copy_rows(E, j, rows, result, j);
  return result;
}

// E_p - A_q / j
LockstepMatrix difference(const LockstepMatrix& E, const LockstepMatrix& A, int j) {
  LockstepMatrix result(E.rows(), E.cols());
  for (int col = 0; col < E.cols(); ++col)
    for (int b = 0; b < E.blocks_of_column(); ++b)
      for (int l = 0; l < lane_count; ++l)
        result.column(col)[b].lane[l] = E.column(col)[b].lane[l] - A.column(col)[b].lane[l] / j;
  return result;
}

// Block row i of the array in columns y_(i+1), ..., y_1, x: E_(i+1-j) - A_(i-j) / j at y_j, A_i at x. They are the
// first rows of `to`, and written before the others.
void write_block_row(const PerturbedData& data, const std::vector<int>& rows, int i, LockstepMatrix& to) {
  const int n = data.E(0).cols();
  const auto write = [&](const LockstepMatrix& block, int first) {
    for (int col = 0; col < n; ++col) copy_rows(block, col, rows, to, first + col);
  };
  write(data.E(0), 0);
  for (int j = 1; j <= i; ++j) write(difference(data.E(i + 1 - j), data.A(i - j), j), (i + 1 - j) * n);
  write(data.A(i), (i + 1) * n);
}

// Columns from `first` on of the rows from `top` on.
LockstepMatrix remainder(const LockstepMatrix& stage, int top, int first) {
  LockstepMatrix rest(stage.rows() - top, stage.cols() - first);
  for (int j = 0; j < rest.cols(); ++j)
    for (int i = 0; i < rest.rows(); ++i) copy_entry(stage, top + i, first + j, &rest.at(i, j));
  rest.normalize_rows();
  return rest;
}

// Rows of `one` above those of `other`.
LockstepMatrix stack(const LockstepMatrix& one, int rows_of_one, const LockstepMatrix& other) {
  LockstepMatrix all(rows_of_one + other.rows(), other.cols());
  for (int j = 0; j < all.cols(); ++j) {
    for (int i = 0; i < rows_of_one; ++i) copy_entry(one, i, j, &all.at(i, j));
    for (int i = 0; i < other.rows(); ++i) copy_entry(other, i, j, &all.at(rows_of_one + i, j));
  }
  return all;
}

// Eliminations of one certificate: ranks are found, or come from a list one after the other.
class Eliminations {
 public:
  Eliminations(const CertificateSettings& settings, Significance& significance)
      : settings_(settings), significance_(significance) {}

  bool has_suggestions() const { return settings_.suggested != nullptr; }
  // known: pivots decided elsewhere. decides: false: the rank is `known`.
  int run(LockstepMatrix& matrix, int width, int known = 0, bool decides = true,
          ZeroScale scale = ZeroScale::whole_rows) {
    if (!has_suggestions()) return matrix.eliminate(width, significance_, settings_.rank_tol, scale);
    const int rank = known + (decides ? next() : 0), most = std::min(matrix.rows(), width);
    eliminate_with_rank(matrix, width, rank, significance_, scale);
    return std::min(rank, most);
  }

 private:
  int next() {
    const RankSequence& list = *settings_.suggested;
    if (used_ < list.count) return list.rank[used_++];
    significance_.weakest = 0.0;
    return 0;
  }

  const CertificateSettings& settings_;
  Significance& significance_;
  std::size_t used_ = 0;
};

}  // namespace

const double* TrialPerturbations::first(std::size_t count) {
  values_.reserve(count);
  while (values_.size() < count) values_.push_back(symmetric_random(generator_));
  return values_.data();
}

CertifiedRanks certified_ranks(const TaylorData& data, int level, const CertificateSettings& settings) {
  const int n = data.n;
  const PerturbedData perturbed(data, level, settings.units, settings.omits_suspects, settings.random);
  CertifiedRanks found;
  Eliminations eliminations(settings, found.significance);
  LockstepMatrix carried(0, (level + 1) * n);
  int diagonal_rank = 0, array_rank = 0;
  for (int i = level; i >= 0; --i) {
    const std::vector<int> rows = rows_of_level(data, i);
    if (i < level && data.has_last_rows(i)) {
      LockstepMatrix E = rows_of_E(perturbed, rows);
      diagonal_rank = eliminations.run(E, n);
      found.list.add(diagonal_rank);
    }
    const int count = static_cast<int>(rows.size());
    LockstepMatrix stage(count + carried.rows(), (i + 2) * n);
    write_block_row(perturbed, rows, i, stage);
    for (int j = 0; j < carried.cols(); ++j)
      for (int row = 0; row < carried.rows(); ++row) copy_entry(carried, row, j, &stage.at(count + row, j));
    // The first stage eliminates the block of the diagonal, and nothing else: it decides its rank as well.
    const ZeroScale scale = i == level ? ZeroScale::eliminated_columns : ZeroScale::whole_rows;
    const bool decides = i == level || (carried.rows() > 0 && diagonal_rank < n);
    const int rank = eliminations.run(stage, n, diagonal_rank, decides, scale);
    if (decides) found.list.add(rank - diagonal_rank);
    if (i == level) diagonal_rank = rank;
    array_rank += rank;
    carried = remainder(stage, rank, n);
  }
  found.ranks.rank_E = diagonal_rank;
  const int rows = carried.rows();
  LockstepMatrix constraints = std::move(carried);
  const int a = eliminations.run(constraints, n, 0, rows > 0);
  if (rows > 0) found.list.add(a);
  LockstepMatrix E = stack(constraints, a, rows_of_E(perturbed, rows_of_level(data, 0)));
  E.normalize_rows();
  const int d = eliminations.run(E, n, a, a < n) - a;
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
  TrialPerturbations random;
  const PerturbedData perturbed(data, level, units, false, random);
  int total = 0;
  for (int i = 0; i <= level; ++i) total += static_cast<int>(rows_of_level(data, i).size());
  LockstepMatrix array(total, (level + 2) * n);
  int first = 0;
  for (int i = 0; i <= level; ++i) {
    const std::vector<int> rows = rows_of_level(data, i);
    const int count = static_cast<int>(rows.size());
    LockstepMatrix block(count, (i + 2) * n);
    write_block_row(perturbed, rows, i, block);
    for (int j = 0; j < block.cols(); ++j)
      for (int row = 0; row < count; ++row) copy_entry(block, row, j, &array.at(first + row, (level - i) * n + j));
    first += count;
  }
  array.normalize_rows();
  Significance significance;
  return array.eliminate(array.cols(), significance) == total && significance.weakest > clear_significance;
}

int clear_pencil_rank(const TaylorData& data, const BalancedUnits& units) {
  TrialPerturbations random;
  const PerturbedData perturbed(data, 0, units, false, random);
  const int full = std::min(data.m, data.n);
  int largest = 0;
  // lambda in balanced units of time, of either sign: from far below to far above the values in systems of a stiffness
  // of 1e6.
  for (int step = 0; step <= 12 && largest < full; ++step) {
    const double lambda = (step % 2 == 0 ? 0.618 : -1.37) * std::pow(10.0, -12.0 + 1.5 * step);
    LockstepMatrix pencil(data.m, data.n);
    for (int j = 0; j < data.n; ++j)
      for (int i = 0; i < data.m; ++i)
        for (int k = 0; k < versions; ++k)
          pencil.at(i, j, k) = lambda * perturbed.E(0).at(i, j, k) - perturbed.A(0).at(i, j, k);
    pencil.normalize_rows();
    Significance significance;
    if (full >= large_problem) {
      LockstepMatrix regular = pencil;
      eliminate_with_rank(regular, data.n, full, significance);
      if (significance.weakest > clear_significance) return full;
      significance = {};
    }
    const int rank = pencil.eliminate(data.n, significance);
    if (significance.weakest > clear_significance) largest = std::max(largest, rank);
  }
  return largest;
}

}  // namespace sfdae::core
