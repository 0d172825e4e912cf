// Derivatives of the equations of impulses of a recorded problem, by x and by parameters.
//
// The equations of impulses.h, sum_{j >= p} (E_{j-p} + A_{j-p-1} / j) theta_j with E = F_x' and A = -F_x, are the
// Taylor coefficients of order mu - p of
//
//     F_x' v - F_x w,   v(s) = sum_j theta_j s^(mu-j),   w(s) = sum_{j >= 1} theta_j / j s^(mu-j+1)
//
// along the jet of x, so that their derivatives are Taylor coefficients of those of this formula. Derivatives of x do
// not contribute: factors of jumps and impulses do not depend on these (nonlinear_jump.h).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "linalg/matrix.h"
#include "linalg/units.h"
#include "problem/nonlinear_problem.h"
#include "problem/taylor_data.h"

namespace sfdae::core {

class ImpulseSlopes {
 public:
  // parameters: their numbers, one for each column; -1: the column is zero.
  ImpulseSlopes(const TaylorEvaluator& equations, const std::vector<int>& parameters);

  // Derivatives by all unknowns and by the parameters, scaled as `data` and theta (n x (mu + 1)) are: (mu + 1) m rows.
  // jet: of order mu + 1 at least. Parameters have the values of `equations`. False if they cannot be evaluated.
  bool evaluate(const TaylorEvaluator& equations, const TaylorData& data, const Units& units, ConstView theta,
                const double* jet, View by_x, View by_parameters);

 private:
  struct Place {
    int equation, column;  // of an unknown, then of a parameter
  };
  struct Formulas {
    std::shared_ptr<const Record> record;  // one for each place, of x, v and w
    std::vector<Place> places;
  };
  explicit ImpulseSlopes(Formulas formulas, int n);
  static Formulas formulas_of(const Record& record, const std::vector<int>& parameters);

  int n_;
  std::vector<Place> places_;
  TaylorEvaluator evaluator_;
  std::vector<double> jet_, values_;
};

}  // namespace sfdae::core
