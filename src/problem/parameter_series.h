// Derivatives of recorded equations by chosen parameters along a jet, as the right-hand sides of sensitivities.
//
// With S = dx/dp the derivative array of F(t, x, x', p) = 0, differentiated by p, is the array of the linear problem
// E S' = A S + f along the solution, E = F_x', A = -F_x, f = -F_p.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "expression/lane_evaluator.h"
#include "expression/parameter_gradient.h"
#include "expression/taylor_evaluator.h"
#include "linalg/index.h"
#include "problem/nonlinear_problem.h"
#include "problem/taylor_data.h"

namespace sfdae::core {

// Error for formulas of F_p that could not be evaluated.
CallbackError parameter_gradient_error(const TaylorEvaluator& F_p, double t, double user_t);

class ParameterSeries {
 public:
  // parameters: their numbers, one for each column; -1: the column is zero, as only initial values differ.
  ParameterSeries(RecordedProblem& problem, std::vector<int> parameters);

  int count() const { return static_cast<int>(parameters_.size()); }
  // True if any equation contains one of the parameters.
  bool has_columns() const { return !places_.empty(); }
  // needs_slopes: F_x', F_x or F_p contain x'. matrices_need_slopes: F_x' or F_x does.
  bool needs_slopes() const { return needs_slopes_; }
  bool matrices_need_slopes() const { return matrices_need_slopes_; }
  // Uses the present values of parameters from now on.
  void take_parameters();
  // f: column j holds f_0, ..., f_order of parameter j one below the other, m (order + 1) entries, scaled as `data`
  // are; jet: of order + 1. Rows that the array of the data leaves out are zero.
  CallbackError evaluate(const TaylorData& data, const double* jet, int order, View f);
  // The Taylor coefficients of F_p as they are, m (order + 1) x count.
  CallbackError values(double t, const double* jet, int order, View F_p);
  // Coefficients of the entries of F_p at several points (see LaneEvaluator): of entry e from e (order + 1) on. Null:
  // they have to be evaluated one by one. Valid until the next call.
  const LaneBlock* values_side_by_side(const LaneBlock* t, const LaneBlock* jets, int order);
  // Values of the last side-by-side evaluation.
  const LaneBlock* last_values_side_by_side() const { return lanes_of_F_p_.data(); }
  const std::vector<ParameterGradient::Place>& places() const { return places_; }
  // gradient += f^T weights, f as for evaluate(): m (order + 1) x q and count x q. The cost is proportional to the
  // number of entries.
  CallbackError add_gradient(const TaylorData& data, const double* jet, ConstView weights, View gradient);
  // gradient -= F_p^T weights, m x q.
  CallbackError add_gradient(double t, const double* jet, ConstView weights, View gradient);

 private:
  ParameterSeries(RecordedProblem& problem, std::vector<int> parameters, ParameterGradient gradient);
  CallbackError evaluate_series(double t, const double* jet, int order);
  double coefficient(std::size_t entry, int k) const { return F_p_[entry + places_.size() * index(k)]; }

  RecordedProblem& problem_;
  std::vector<int> parameters_;
  std::vector<ParameterGradient::Place> places_;  // of the entries of F_p, with columns of f
  TaylorEvaluator evaluator_;
  bool matrices_need_slopes_, needs_slopes_;
  std::vector<double> F_p_;
  LaneEvaluator lanes_;
  LaneArray lanes_of_F_p_;
};

}  // namespace sfdae::core
