// Formulas of all derivatives of recorded equations, evaluated along jets at one point or at several.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "expression/lane_evaluator.h"
#include "expression/taylor_evaluator.h"
#include "problem/nonlinear_problem.h"
#include "problem/parameter_series.h"

namespace sfdae::core {

class DerivativeFormulas {
 public:
  // parameters: as of `series`, which is the series of their F_p. The problem has to outlive this object.
  DerivativeFormulas(RecordedProblem& problem, const ParameterSeries& series, const std::vector<int>& parameters);
  // False if they would be too long.
  bool are_there() const { return evaluator_.has_value(); }
  // Takes the current values of the parameters.
  void take_parameters();

  // True if formula e contains neither t nor x nor x': coefficients beyond the first are zero.
  bool is_number(std::size_t e) const { return is_number_[e] != 0; }
  // Changes when numbers may have changed.
  long version() const { return version_; }

  // Taylor coefficients up to the order: coefficient k of formula e at [e + k count()], entries of F_x and F_x' in the
  // order of the tape, then those of F_p. Null if they cannot be evaluated; the equations still may be. Valid until the
  // next call.
  const double* evaluate(double t, const double* jet, int order);
  // Likewise at several points, with the results in of_lanes(e)[k]. False: as above.
  bool evaluate_side_by_side(int count, const LaneBlock* t, const LaneBlock* jets, int order);
  const LaneBlock* of_lanes(std::size_t e) const { return lanes_.value(static_cast<int>(e)); }
  std::size_t count() const { return count_; }

 private:
  RecordedProblem& problem_;
  std::optional<TaylorEvaluator> evaluator_;
  LaneEvaluator lanes_;
  std::size_t count_ = 0;
  std::vector<char> is_number_;
  std::vector<int> varying_;  // the others
  long version_ = 0;
  // Version and order of the numbers in values_; -1: none.
  long known_version_ = -1;
  int known_order_ = -1;
  std::vector<double> values_;
};

}  // namespace sfdae::core
