// The least change of unknowns that fulfils linear equations.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/least_change_step.h"

#include <algorithm>

#include "linalg/index.h"

namespace sfdae::core {

void LeastChangeStep::analyze(const Equations& equations, bool decides_all) {
  decides_all_ = decides_all;
  if (decides_all) note_square(equations);
  else note_symmetric(equations);
  lu_.analyze(pattern_);
}

// Pattern of J by columns.
void LeastChangeStep::note_square(const Equations& equations) {
  pattern_.size = equations.unknowns;
  pattern_.first.assign(index(equations.unknowns) + 1, 0);
  for (int j : equations.column) ++pattern_.first[index(j + 1)];
  for (std::size_t j = 1; j < pattern_.first.size(); ++j) pattern_.first[j] += pattern_.first[j - 1];
  pattern_.row.assign(equations.column.size(), 0);
  lower_.resize(equations.column.size());
  std::vector<int> next(pattern_.first.begin(), pattern_.first.end() - 1);
  for (int i = 0; i < equations.rows(); ++i)
    for (int e = equations.first[index(i)]; e < equations.first[index(i + 1)]; ++e) {
      lower_[index(e)] = next[index(equations.column[index(e)])]++;
      pattern_.row[index(lower_[index(e)])] = i;
    }
}

void LeastChangeStep::note_symmetric(const Equations& equations) {
  const int n = equations.unknowns, m = equations.rows();
  std::vector<int> count(index(n), 1);  // the diagonal, and J
  for (int j : equations.column) ++count[index(j)];
  pattern_.size = n + m;
  pattern_.first.assign(1, 0);
  for (int j = 0; j < n; ++j) pattern_.first.push_back(pattern_.first.back() + count[index(j)]);
  for (int i = 0; i < m; ++i)
    pattern_.first.push_back(pattern_.first.back() + equations.first[index(i + 1)] - equations.first[index(i)]);
  pattern_.row.assign(index(pattern_.first.back()), 0);
  std::vector<int> next(pattern_.first.begin(), pattern_.first.end() - 1);
  for (int j = 0; j < n; ++j) pattern_.row[index(next[index(j)]++)] = j;
  lower_.resize(equations.column.size());
  upper_.resize(equations.column.size());
  for (int i = 0; i < m; ++i) {
    // Column n + i is row i of J; its entries have to ascend.
    std::vector<int> entries;
    for (int e = equations.first[index(i)]; e < equations.first[index(i + 1)]; ++e) entries.push_back(e);
    std::sort(entries.begin(), entries.end(),
              [&](int a, int b) { return equations.column[index(a)] < equations.column[index(b)]; });
    for (int e : entries) {
      const int j = equations.column[index(e)];
      lower_[index(e)] = next[index(j)]++;
      pattern_.row[index(lower_[index(e)])] = n + i;
      upper_[index(e)] = next[index(n + i)]++;
      pattern_.row[index(upper_[index(e)])] = j;
    }
  }
}

bool LeastChangeStep::factor(const Equations& equations, const std::vector<double>& values,
                             const std::vector<double>& W, const std::vector<char>& is_held) {
  values_.assign(pattern_.row.size(), 0.0);
  if (decides_all_) {
    for (std::size_t e = 0; e < values.size(); ++e) values_[index(lower_[e])] = values[e];
    return lu_.factor(values_.data());
  }
  for (int j = 0; j < equations.unknowns; ++j)
    values_[index(pattern_.first[index(j)])] = is_held[index(j)] != 0 ? 1.0 : W[index(j)];
  for (std::size_t e = 0; e < values.size(); ++e) {
    if (is_held[index(equations.column[e])] != 0) continue;
    values_[index(lower_[e])] = values_[index(upper_[e])] = values[e];
  }
  return lu_.factor(values_.data());
}

void LeastChangeStep::solve(const Equations& equations, const std::vector<char>& is_held, double* dx,
                            const double* r) {
  const std::size_t n = index(equations.unknowns);
  if (decides_all_) {
    b_.assign(r, r + n);
  } else {
    b_.resize(index(pattern_.size));
    for (std::size_t j = 0; j < n; ++j) b_[j] = is_held[j] != 0 ? 0.0 : dx[j];
    std::copy_n(r, equations.rows(), b_.begin() + equations.unknowns);
  }
  z_ = b_;
  lu_.solve(z_.data());
  refine();
  std::copy_n(z_.begin(), n, dx);
}

// Weights of many sizes cost digits: without this, equations were satisfied to 1e-9 instead of roundoff.
void LeastChangeStep::refine() {
  for (int j = 0; j < pattern_.size; ++j)
    for (int e = pattern_.first[index(j)]; e < pattern_.first[index(j + 1)]; ++e)
      b_[index(pattern_.row[index(e)])] -= values_[index(e)] * z_[index(j)];
  lu_.solve(b_.data());
  for (std::size_t k = 0; k < z_.size(); ++k) z_[k] += b_[k];
}

}  // namespace sfdae::core
