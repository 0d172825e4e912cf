// The equations of sensitivities at one point of x, transposed: what weights of S mean for the parameters.
//
// S(p) depends on F_p by xp = -A2^+ f2 and by Z1^T f. With weights eta of xp and nu of Z1^T f, eta^T xp + nu^T Z1^T f
// is a sum over the rows of the derivative array, whose weights the stored elimination gives: one sum for any number
// of parameters.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/parameter_series.h"
#include "sensitivity/linearized_point.h"

namespace sfdae::core {

class AdjointPoint final : public LinearizedPoint {
 public:
  PointStatus linearize(AnalyzedEquations& equations, ParameterSeries& parameters, const Place& place, Arena& arena);

  // nu: d x q, eta: n x q, in scaled unknowns, without columns where xp is not needed; to gradient, count x q, is
  // added what they mean for the parameters at the point linearized last.
  struct Weights {
    ConstView nu, eta;
  };
  PointStatus add_gradient(ParameterSeries& parameters, const Jet& jet, const Weights& weights, View gradient,
                           Arena& arena);

 private:
  StoredElimination elimination_;
  Matrix no_rhs_, no_rhs_hat_;
};

}  // namespace sfdae::core
