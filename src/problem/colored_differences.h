// Entries of a Jacobian by differences, a group of columns at a time.
//
// [CR74] A. R. Curtis, J. K. Reid: The choice of step lengths when using differences to approximate Jacobian matrices.
//        IMA J. Appl. Math. 13 (1974), 121-126.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "linalg/column_pattern.h"
#include "problem/problem.h"

namespace sfdae::core {

// Central differences have errors of 1e-10, as a rule.
inline constexpr double noise_of_differences = 1e-9;

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
  bool is_zero(int j) const { return seen_[index(j)] == 0.0; }
  // F does not depend on it, however large its increment is.
  void note_absent(int j) { is_absent_[index(j)] = 1; }
  bool is_absent(int j) const { return is_absent_[index(j)] != 0; }

 private:
  std::vector<double> seen_;
  std::vector<char> is_absent_;
  double size_of_zeros_ = 1.0;
};

struct GroupedPattern {
  ColumnPattern pattern;
  ColumnGroups groups;
};
// Every entry, each column a group of its own.
GroupedPattern full_pattern(int rows, int columns);

// Central differences; from one side where F cannot be evaluated at the other. Increments that rounding errors drown
// become larger, and increments between which F bends become smaller [CR74].
// If F jumps at the point, differences are those of the side on which it does not.
class ColoredDifferences {
 public:
  // F: of the jet. All live longer.
  ColoredDifferences(const FunctionOfJet& evaluate, const ChangingJet& jet, ChangeSizes& sizes,
                     const std::vector<double>& F);
  // values: one for each entry of the pattern. terms: sizes of the terms in each row, as far as known; those of this
  // level are added. Two evaluations for each group, as a rule.
  CallbackError find(const GroupedPattern& grouped, std::vector<double>& terms, double* values);

 private:
  // Differences of one group of columns.
  struct Group {
    Group(const std::vector<int>& its_columns, double its_factor) : columns(&its_columns), factor(its_factor) {}
    const std::vector<int>* columns;
    double factor;  // of increments
    bool is_central = false;
    std::vector<double> values, bends;  // of its entries, columns one after the other; |F+ - 2 F + F-|
    std::vector<double> sided;          // the smaller one of both one-sided differences
    std::vector<double> increments;     // of its columns
  };
  CallbackError difference(const GroupedPattern& grouped, Group& group);
  CallbackError move(const std::vector<int>& columns, double distance, std::vector<double>& to);
  CallbackError improve(const GroupedPattern& grouped, const std::vector<double>& terms, Group& group);
  template <class Visit>
  static void visit(const GroupedPattern& grouped, const Group& group, Visit entry);
  int most_increases(const Group& group) const;
  CallbackError increase(const GroupedPattern& grouped, const std::vector<double>& terms, Group& group);
  bool is_below_rounding(const GroupedPattern& grouped, const std::vector<double>& terms, const Group& group) const;
  bool bends(const GroupedPattern& grouped, const std::vector<double>& terms, const Group& group) const;
  static bool jumps(const Group& group, const Group& with_smaller_increments);
  bool agree(const GroupedPattern& grouped, const std::vector<double>& terms, const Group& a, const Group& b) const;

  const FunctionOfJet& evaluate_;
  const ChangingJet& jet_;
  ChangeSizes& sizes_;
  const std::vector<double>& F_;
  std::vector<double> before_, above_, below_;
};

}  // namespace sfdae::core
