// Jacobian entries by finite differences, a group of columns at a time.
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

// Unknowns are changed in level `level` of this jet: 0 for x, 1 for x'.
struct ChangingJet {
  std::vector<double>& derivatives;  // as before, afterwards
  int n, level;
  double& unknown(int j) const { return derivatives[index(j + level * n)]; }
};

// Sizes of unknowns, for relative increments: the largest value so far of each.
class ChangeSizes {
 public:
  // values: n of them.
  void note(const double* values, int n);
  double size(int j) const { return is_zero(j) ? size_of_zeros_ : seen_[index(j)]; }
  bool is_zero(int j) const { return seen_[index(j)] == 0.0; }
  // Notes whether F did not depend on this unknown, even for large increments.
  void note_absence(int j, bool is_absent) { is_absent_[index(j)] = is_absent; }
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

// Central differences; one-sided if F cannot be evaluated on one side. Increments are enlarged if rounding errors of F
// exceed the differences, and reduced if F bends between them [CR74].
// If F jumps at the point, differences are those of the side on which it does not.
class ColoredDifferences {
 public:
  // F: of the jet. All arguments must outlive this object.
  ColoredDifferences(const FunctionOfJet& evaluate, const ChangingJet& jet, ChangeSizes& sizes,
                     const std::vector<double>& F);
  // values: one for each entry of the pattern. terms: sizes of the terms in each row, if known; those of this level are
  // added. Two evaluations for each group as a rule, two more for x'.
  CallbackError find(const GroupedPattern& grouped, std::vector<double>& terms, double* values);
  // F was linear in x' over increments as large as x' itself: entries have rounding errors only.
  bool is_linear() const { return is_linear_; }

 private:
  // Differences of one group of columns.
  struct Group {
    Group(const std::vector<int>& its_columns, double its_factor, double its_least)
        : columns(&its_columns), factor(its_factor), least(its_least) {}
    Group scaled(double by) const { return {*columns, by * factor, by * least}; }
    bool is_zero() const;
    double largest_bend() const;
    const std::vector<int>* columns;
    double factor, least;  // increments are parts of max(factor size, least)
    bool is_central = false;
    std::vector<double> values, bends;  // of its entries, columns one after the other; |F+ - 2 F + F-|
    std::vector<double> sided;          // the smaller one of both one-sided differences
    std::vector<double> increments;     // of its columns
  };
  CallbackError difference(const GroupedPattern& grouped, Group& group);
  CallbackError first_difference(const GroupedPattern& grouped, Group& group);
  CallbackError move(const Group& group, double side, std::vector<double>& to);
  CallbackError improve(const GroupedPattern& grouped, const std::vector<double>& terms, Group& group);
  template <class Visit>
  static void visit(const GroupedPattern& grouped, const Group& group, Visit entry);
  bool are_zero(const std::vector<int>& columns) const;
  double longest_increment(const std::vector<int>& columns) const;
  CallbackError increase(const GroupedPattern& grouped, const std::vector<double>& terms, Group& group);
  CallbackError lengthen(const GroupedPattern& grouped, const std::vector<double>& terms, Group& group,
                         bool& is_linear);
  bool is_below_rounding(const GroupedPattern& grouped, const std::vector<double>& terms, const Group& group) const;
  bool bends(const GroupedPattern& grouped, const std::vector<double>& terms, const Group& group) const;
  bool is_straight(const GroupedPattern& grouped, const std::vector<double>& terms, const Group& group) const;
  double disagreement(const GroupedPattern& grouped, const std::vector<double>& terms, const Group& a,
                      const Group& b) const;

  const FunctionOfJet& evaluate_;
  const ChangingJet& jet_;
  ChangeSizes& sizes_;
  const std::vector<double>& F_;
  bool is_linear_ = true;
  std::vector<double> before_, above_, below_;
};

}  // namespace sfdae::core
