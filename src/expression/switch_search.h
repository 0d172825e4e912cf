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
class LinearConditions {
 public:
  LinearConditions(const Record& record, const std::vector<Condition>& conditions);
  struct Factor {
    int unknown;
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
  // Those that are linear in t and x, and those of layers, are polynomials through their values at the points: their
  // terms may cancel all the way, as those of the larger of two equal unknowns do.
  SwitchSearch(const TaylorEvaluator& evaluator, const std::vector<Condition>& conditions);

  std::size_t count() const { return margins_.size(); }

  // As find(), without margins and cheap. Succeeds only if all conditions are polynomials of their own, and divided
  // differences show that each switches at most once; false: nothing is known. g is known at both ends.
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
  // A condition that is a polynomial, and its values at both ends.
  struct Line {
    std::size_t curve;  // its place in unknowns_
    const PointsOfCurve* points;
    double start, end;
  };
  // g: of all conditions at both ends.
  void set_differences(const PointsOfCurve& points, const double* g_start, const double* g_end);
  double own_value(const double* x, std::size_t condition) const;
  void set_bends(const PointsOfCurve& points);
  double value_of(const Line& line, double part) const;
  void find_times_between();

  const TaylorEvaluator& evaluator_;
  std::unique_ptr<TaylorEvaluator> along_;  // a function of the part of the way for each condition: 1 where it is met
  std::unique_ptr<SwitchingTimes> switches_;
  // Unknowns that conditions depend on; beyond those of the record, n + k is the value of condition k, which is a
  // polynomial of its own.
  std::vector<int> unknowns_;
  std::vector<int> curve_of_condition_;  // place in unknowns_, or -1
  std::optional<LinearConditions> linear_;
  bool has_layers_ = false;
  std::unique_ptr<ConditionFunctions> own_functions_;  // all conditions, if any is a polynomial of its own
  std::vector<double> values_, at_ends_;               // of these
  std::vector<double> differences_;         // of unknowns_, divided, by parts of the way: a row for each order
  std::vector<double> distances_, slopes_;  // from the straight line through both ends, and of slopes, at most
  std::vector<Line> lines_;                 // that switch
  std::vector<double> margins_, branches_, times_between_, zeros_;
  double known_to_ = 0.0;
  std::optional<double> first_;
};

}  // namespace sfdae::core
