// The equations of sensitivities at one jet of x, transposed.
// SPDX-License-Identifier: BSD-3-Clause
#include "sensitivity/adjoint_point.h"

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

PointStatus AdjointPoint::linearize(AnalyzedEquations& equations, ParameterSeries& parameters, const Place& place,
                                    Arena& arena) {
  PointStatus status = evaluate(equations, place.jet);
  if (status != PointStatus::ok) return status;
  if (!is_ordinary()) {
    if (no_rhs_.rows() != equations.array_rows()) no_rhs_ = Matrix(equations.array_rows(), 1);
    status = reduce(equations, place.known, {no_rhs_, no_rhs_hat_, &elimination_}, arena);
    if (status != PointStatus::ok) return status;
  }
  return take_differential(equations, place, parameters);
}

PointStatus AdjointPoint::add_gradient(ParameterSeries& parameters, const Jet& jet, const Weights& weights,
                                       View gradient, Arena& arena) {
  if (!parameters.has_columns()) return PointStatus::ok;
  const Arena::Frame frame(arena);
  const int m = data_.m, levels = is_ordinary() ? 1 : data_.orders.f + 1;
  const View rows = arena.matrix(m * levels, gradient.cols), of_F1 = arena.matrix(m, gradient.cols);
  if (is_ordinary()) {
    copy(weights.nu, of_F1);
    fill(rows, 0.0);
  } else {
    multiply(1.0, Op::plain, form_.Z1(), Op::plain, weights.nu, 0.0, of_F1);
    double* of_f_hat = arena.take(index(elimination_.carried_rows()) + 1);
    for (int q = 0; q < gradient.cols; ++q) {
      form_.constraints().solve_transposed(weights.eta.column(q), of_f_hat, arena);
      elimination_.transform_transposed(of_f_hat, rows.column(q), arena);
    }
  }
  if (has_slopes_) {
    callback_error_ = parameters.add_gradient(differential_data(), slope_jet_.data(), of_F1, gradient);
    if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
    if (is_ordinary()) return PointStatus::ok;
  } else {
    for (int q = 0; q < gradient.cols; ++q)
      for (int i = 0; i < m; ++i) rows(i, q) += of_F1(i, q);
  }
  callback_error_ = parameters.add_gradient(data_, jet.x.data(), rows, gradient);
  return callback_error_.status == SFDAE_OK ? PointStatus::ok : PointStatus::callback_error;
}

}  // namespace sfdae::core
