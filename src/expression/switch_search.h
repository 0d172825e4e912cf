// All times at which conditions g(t, x) > 0 switch while x moves along a polynomial from one point to another; g is
// then a function of t alone (switching_times.h).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "expression/condition_functions.h"
#include "expression/switching_times.h"
#include "expression/taylor_evaluator.h"
#include "linalg/points_of_curve.h"

namespace sfdae::core {

// Conditions that are linear in t and x, and their derivatives by x.
class ConditionSlopes {
 public:
  // unknowns: those that the conditions depend on; the numbers of factors are places in this list. Beyond the unknowns
  // of the record, n + k is the value of condition k, which determines it completely.
  ConditionSlopes(const Record& record, const std::vector<Condition>& conditions, const std::vector<int>& unknowns);
  struct Factor {
    std::size_t unknown;
    double value;
  };
  // Computes derivatives for the parameters that the evaluator has now.
  void update(const TaylorEvaluator& evaluator);
  // Null: the condition is not linear.
  const std::vector<Factor>* factors(std::size_t condition) const {
    return is_linear_[condition] != 0 ? &factors_[condition] : nullptr;
  }

 private:
  std::optional<TaylorEvaluator> derivatives_;  // a value for each factor
  std::vector<char> is_linear_;
  std::vector<std::vector<Factor>> factors_;
  std::vector<double> values_;
  long version_ = -1;
};

class SwitchSearch {
 public:
  // conditions: nodes of the record of the evaluator, which must outlive this object; parameters have the evaluator's
  // values at the time of a call. No condition depends on x' or on a user-supplied function, as nothing is known of the
  // latter between points.
  // Those of layers are interpolated by polynomials through their values at the points.
  SwitchSearch(const TaylorEvaluator& evaluator, const std::vector<Condition>& conditions);

  std::size_t count() const { return margins_.size(); }

  // As find(), without margins and cheap. Succeeds only if conditions are linear in t and x, and divided differences
  // show that each switches at most once; false: nothing is known. g is known at both ends.
  bool find_simple(const PointsOfCurve& points, const double* g_start, const double* g_end);

  // Finds a time between every two successive switches of any conditions, on the way from the first to the second of
  // these points, up to known_to(). A condition switches where it passes zero by its margin; null: margins are 0.
  // Allocates nothing.
  const std::vector<double>& find(const PointsOfCurve& points, const double* margins);
  // Results of the last search: these times, and the time up to which all switches are known.
  const std::vector<double>& times_between() const { return times_between_; }
  double known_to() const { return known_to_; }
  std::optional<double> first_switch() const { return first_; }

 private:
  void set_curve(const PointsOfCurve& points);
  // A linear condition, and its values at both ends.
  struct Line {
    const std::vector<ConditionSlopes::Factor>* factors;
    const PointsOfCurve* points;
    double start, end;
  };
  void set_differences(const PointsOfCurve& points);
  void set_bends(const PointsOfCurve& points);
  double value_of(const Line& line, double part) const;
  void find_times_between();

  const TaylorEvaluator& evaluator_;
  std::unique_ptr<TaylorEvaluator> along_;  // a function of the part of the way for each condition: 1 where it is met
  std::unique_ptr<SwitchingTimes> switches_;
  std::vector<int> unknowns_;                      // that conditions depend on, as ConditionSlopes has them
  std::unique_ptr<ConditionFunctions> of_layers_;  // all conditions, if any is of a layer
  std::vector<double> values_;                     // of these
  std::optional<ConditionSlopes> linear_;
  std::vector<double> differences_;         // of unknowns_, divided, by parts of the way: a row for each order
  std::vector<double> distances_, slopes_;  // from the straight line through both ends, and of slopes, at most
  std::vector<Line> lines_;                 // that switch
  std::vector<double> margins_, branches_, times_between_, zeros_;
  double known_to_ = 0.0;
  std::optional<double> first_;
};

}  // namespace sfdae::core
