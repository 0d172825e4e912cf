// Entries of a sparse Jacobian by differences, a group of columns at a time.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "linalg/column_pattern.h"
#include "problem/problem.h"

namespace sfdae::core {

// F, one value for each row, at x, x', ..., one after the other.
using FunctionOfJet = std::function<CallbackError(const double* derivatives, double* F)>;

// Unknowns change from those of this jet, `level` of it: 0 for x, 1 for x'.
struct ChangingJet {
  std::vector<double>& derivatives;  // as before, afterwards
  int n, level;
  double& unknown(int j) const { return derivatives[index(j + level * n)]; }
};

// By how much unknowns change: of the largest that was seen of each, or of the others where all of these were zero.
class ChangeSizes {
 public:
  // values: n of them.
  void note(const double* values, int n);
  double size(int j) const { return seen_[index(j)] > 0.0 ? seen_[index(j)] : size_of_zeros_; }

 private:
  std::vector<double> seen_;
  double size_of_zeros_ = 1.0;
};

struct GroupedPattern {
  ColumnPattern pattern;
  ColumnGroups groups;
};
// Central differences; from one side where F cannot be evaluated at the other. values: one for each entry of the
// pattern. F: of the jet. Two evaluations for each group.
CallbackError colored_differences(const FunctionOfJet& evaluate, const ChangingJet& jet, const ChangeSizes& sizes,
                                  const GroupedPattern& grouped, const std::vector<double>& F, double* values);

}  // namespace sfdae::core
