// Dependent equations by a column basis of the transposed block, those with high offsets first.
// SPDX-License-Identifier: BSD-3-Clause
#include "structure/dependent_equations.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "linalg/column_basis.h"
#include "linalg/sparse_lu.h"

namespace sfdae::core {

namespace {

// Least pivot of independent equations, see ColumnBasis; relative size of parts of sums that are roundoff.
constexpr double clear_pivot = 1e-7, negligible = 1e-12;

// One column for each equation of the block, one row for each of its unknowns.
class TransposedBlock {
 public:
  TransposedBlock(const Structure& structure, const SystemJacobian& jacobian, int block)
      : equations_(structure.blocks.equations(block)), columns_(equations_.size()), largest_(equations_.size(), 0.0) {
    BlockEntries(structure, jacobian).for_each(block, [&](int equation, int unknown, int e) {
      const double value = jacobian.values()[index(e)];
      if (value == 0.0) return;
      columns_[index(equation)].push_back({unknown, value});
      largest_[index(unknown)] = std::max(largest_[index(unknown)], std::fabs(value));
    });
  }

  struct Entry {
    int row;
    double value;
  };
  int size() const { return static_cast<int>(equations_.size()); }
  int equation(int column) const { return equations_[index(column)]; }
  const std::vector<Entry>& column(int column) const { return columns_[index(column)]; }
  // The largest entry of a column, in units of the largest entries of rows.
  double size_of(int column) const {
    double size = 0.0;
    for (const Entry& entry : columns_[index(column)])
      size = std::max(size, std::fabs(entry.value) / largest_[index(entry.row)]);
    return size;
  }
  SparseRows rows() const {
    std::vector<std::vector<std::pair<int, double>>> entries(index(size()));
    for (int column = 0; column < size(); ++column)
      for (const Entry& entry : this->column(column)) entries[index(entry.row)].emplace_back(column, entry.value);
    SparseRows rows;
    rows.columns = size();
    rows.first.assign(1, 0);
    for (const auto& row : entries) {
      for (const auto& [column, value] : row) {
        rows.column.push_back(column);
        rows.value.push_back(value);
      }
      rows.first.push_back(static_cast<int>(rows.column.size()));
    }
    return rows;
  }

 private:
  std::span<const int> equations_;
  std::vector<std::vector<Entry>> columns_;
  std::vector<double> largest_;  // of rows
};

// Solves A_B y = A_p in the independent rows.
class Basis {
 public:
  Basis(const TransposedBlock& block, const ColumnBasis& basis) : block_(block), place_(index(block.size()), -1) {
    for (int row = 0; row < block.size(); ++row) {
      if (basis.column_of_row[index(row)] < 0) continue;
      place_[index(row)] = static_cast<int>(columns_.size());
      columns_.push_back(basis.column_of_row[index(row)]);
    }
    r_.resize(columns_.size());
    y_ = r_;
  }

  bool factor() {
    if (columns_.empty()) return true;
    SparsePattern pattern;
    pattern.size = static_cast<int>(columns_.size());
    pattern.first.assign(1, 0);
    std::vector<double> values;
    for (int column : columns_) {
      for (const TransposedBlock::Entry& entry : block_.column(column)) {
        const int row = place_[index(entry.row)];
        if (row >= 0) sorted_.emplace_back(row, entry.value);
      }
      std::sort(sorted_.begin(), sorted_.end());
      for (const auto& [row, value] : sorted_) {
        pattern.row.push_back(row);
        values.push_back(value);
      }
      sorted_.clear();
      pattern.first.push_back(static_cast<int>(pattern.row.size()));
    }
    lu_.analyze(pattern);
    return lu_.factor(values.data());
  }

  // Refined twice: errors of one solution would be as large as those of sums that are to cancel.
  void solve(int dependent) {
    std::fill(y_.begin(), y_.end(), 0.0);
    for (int solution = 0; solution < 3 && !columns_.empty(); ++solution) {
      std::fill(r_.begin(), r_.end(), 0.0);
      subtract(dependent, -1.0);
      for (std::size_t k = 0; k < columns_.size(); ++k) subtract(columns_[k], y_[k]);
      lu_.solve(r_.data());
      for (std::size_t k = 0; k < y_.size(); ++k) y_[k] += r_[k];
    }
  }

  // Leaves out parts that are roundoff compared with the dependent equation; rows are measured by their largest entry.
  DependentEquation parts(int dependent) const {
    DependentEquation result{block_.equation(dependent), {}};
    const double least = negligible * block_.size_of(dependent);
    for (std::size_t k = 0; k < columns_.size(); ++k)
      if (std::fabs(y_[k]) * block_.size_of(columns_[k]) > least)
        result.parts.push_back({block_.equation(columns_[k]), y_[k]});
    return result;
  }

 private:
  void subtract(int column, double factor) {
    for (const TransposedBlock::Entry& entry : block_.column(column)) {
      const int row = place_[index(entry.row)];
      if (row < 0) continue;
      r_[index(row)] -= factor * entry.value;
    }
  }
  const TransposedBlock& block_;
  std::vector<int> columns_, place_;  // basic columns; places of rows in the square matrix, or -1
  std::vector<double> y_, r_;
  std::vector<std::pair<int, double>> sorted_;
  SparseLu<double> lu_;
};

}  // namespace

std::vector<DependentEquation> dependent_equations(const Structure& structure, const SystemJacobian& jacobian,
                                                   int block) {
  const TransposedBlock transposed(structure, jacobian, block);
  const std::vector<int>& c = structure.offsets.c;
  int highest = 0;
  for (int i : structure.blocks.equations(block)) highest = std::max(highest, c[index(i)]);
  BasisSettings settings;
  for (int i : structure.blocks.equations(block)) settings.classes.push_back(highest - c[index(i)]);
  const ColumnBasis basis = column_basis(transposed.rows(), settings);
  std::vector<DependentEquation> dependent;
  if (basis.left_over.empty() || basis.smallest_pivot < clear_pivot) return dependent;
  Basis independent(transposed, basis);
  if (!independent.factor()) return dependent;
  for (int column : basis.left_over) {
    independent.solve(column);
    dependent.push_back(independent.parts(column));
    const int c_p = c[index(dependent.back().equation)];
    for (const DependentEquation::Part& part : dependent.back().parts)
      if (c[index(part.equation)] < c_p) return {};
  }
  return dependent;
}

}  // namespace sfdae::core
