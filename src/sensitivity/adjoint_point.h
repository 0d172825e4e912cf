// The transposed equations of sensitivities at one point of x, which turn weights of S into gradients by parameters.
//
// S(p) depends on F_p by xp = -A2^+ f2 and by Z1^T f. With weights eta of xp and nu of Z1^T f, eta^T xp + nu^T Z1^T f
// is a sum over the rows of the derivative array, with weights from the stored elimination: one sum for any number of
// parameters.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/parameter_series.h"
#include "sensitivity/linearized_point.h"

namespace sfdae::core {

class AdjointPoint final : public LinearizedPoint {
 public:
  PointStatus linearize(AnalyzedEquations& equations, ParameterSeries& parameters, const Place& place, Arena& arena);

  // nu: d x q, eta: n x q, in scaled unknowns, without columns if xp is not needed. Their contribution to the
  // derivatives by the parameters at the point linearized last is added to gradient, count x q.
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
