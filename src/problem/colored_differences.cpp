// Entries of a sparse Jacobian by differences.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/colored_differences.h"

#include <algorithm>
#include <cmath>

#include "linalg/rank.h"

namespace sfdae::core {

void ChangeSizes::note(const double* values, int n) {
  seen_.resize(index(n), 0.0);
  double largest = 0.0;
  for (int j = 0; j < n; ++j) {
    seen_[index(j)] = std::max(seen_[index(j)], std::fabs(values[j]));
    largest = std::max(largest, seen_[index(j)]);
  }
  size_of_zeros_ = largest > 0.0 ? std::min(largest, 1.0) : 1.0;
}

CallbackError colored_differences(const FunctionOfJet& evaluate, const ChangingJet& jet, const ChangeSizes& sizes,
                                  const GroupedPattern& grouped, const std::vector<double>& F, double* values) {
  // Of the error of truncation and that of rounding the sum is least near eps^(1/3).
  const double part = std::cbrt(unit_roundoff);
  const std::vector<double> before(jet.derivatives);
  std::vector<double> above(F.size()), below(F.size());
  const auto move = [&](const std::vector<int>& group, double side, std::vector<double>& to) {
    for (int j : group) jet.unknown(j) += side * part * sizes.size(j);
    const CallbackError error = evaluate(jet.derivatives.data(), to.data());
    return error;
  };
  for (const std::vector<int>& group : grouped.groups) {
    CallbackError error = move(group, 1.0, above);
    const bool has_above = error.status == SFDAE_OK;
    if (!has_above && !error.is_recoverable()) return error;
    std::vector<double> distance;
    for (int j : group) {
      const double x = before[index(j + jet.level * jet.n)];
      distance.push_back(has_above ? jet.unknown(j) - x : 0.0);
      jet.unknown(j) = x;
    }
    const CallbackError other = move(group, -1.0, below);
    const bool has_below = other.status == SFDAE_OK;
    if (!has_below && (!has_above || !other.is_recoverable())) return other;
    for (std::size_t k = 0; k < group.size(); ++k) {
      const int j = group[k];
      const double x = before[index(j + jet.level * jet.n)];
      if (has_below) distance[k] += x - jet.unknown(j);
      jet.unknown(j) = x;
      for (int e = grouped.pattern.start[index(j)]; e < grouped.pattern.start[index(j + 1)]; ++e) {
        const std::size_t i = index(grouped.pattern.row[index(e)]);
        values[e] = ((has_above ? above[i] : F[i]) - (has_below ? below[i] : F[i])) / distance[k];
      }
    }
  }
  return {};
}

}  // namespace sfdae::core
