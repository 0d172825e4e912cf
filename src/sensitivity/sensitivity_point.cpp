// The equations of sensitivities at one jet of x.
// SPDX-License-Identifier: BSD-3-Clause
#include "sensitivity/sensitivity_point.h"

#include <algorithm>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

// Right-hand sides are always transformed in the same way, whether the matrices were eliminated here or before, so that
// an integration continued from a checkpoint is identical bit by bit.
PointStatus SensitivityPoint::linearize(AnalyzedEquations& equations, ParameterSeries& parameters, const Place& place,
                                        Arena& arena) {
  const bool is_known = constant_matrices_ >= 0 && constant_matrices_ == equations.problem().constant_matrices();
  const PointStatus status = is_known ? PointStatus::ok : eliminate(equations, parameters, place, arena);
  if (status != PointStatus::ok || constant_matrices_ < 0) return status;
  return transform(equations, parameters, place, arena);
}

PointStatus SensitivityPoint::eliminate(AnalyzedEquations& equations, ParameterSeries& parameters, const Place& place,
                                        Arena& arena) {
  forget();
  PointStatus status = evaluate(equations, place.jet);
  if (status != PointStatus::ok) return status;
  const int rows = equations.array_rows(), count = parameters.count();
  if (f_.rows() != rows || f_.cols() != count) f_ = Matrix(rows, count);
  callback_error_ = parameters.evaluate(data_, place.jet.x.data(), equations.mu(), f_);
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  inconsistency_ = 0.0;
  if (!is_ordinary()) {
    const bool is_constant = equations.problem().constant_matrices() >= 0;
    status = reduce(equations, place.known, {f_, f_hat_, is_constant ? &elimination_ : nullptr}, arena);
    if (status != PointStatus::ok) return status;
    take_columns(arena);
  }
  status = take_differential(equations, place, parameters);
  if (status == PointStatus::ok) status = take_right_hand_sides(parameters);
  if (status == PointStatus::ok && !is_ordinary()) constant_matrices_ = equations.problem().constant_matrices();
  return status;
}

// Uses the matrices of the last elimination.
PointStatus SensitivityPoint::transform(AnalyzedEquations& equations, ParameterSeries& parameters, const Place& place,
                                        Arena& arena) {
  data_.t = place.jet.t;
  callback_error_ = parameters.evaluate(data_, place.jet.x.data(), equations.mu(), f_);
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  transformed_.resize(index(f_.rows()) + 1);
  for (int j = 0; j < f_.cols(); ++j) {
    elimination_.transform(f_.view().column(j), transformed_.data(), arena);
    std::copy_n(transformed_.data(), f_hat_.rows(), f_hat_.view().column(j));
  }
  take_columns(arena);
  take_slopes(place, parameters);
  return take_right_hand_sides(parameters);
}

void SensitivityPoint::take_columns(Arena& arena) {
  if (xp_.rows() != data_.n || xp_.cols() != f_.cols()) xp_ = Matrix(data_.n, f_.cols());
  inconsistency_ = 0.0;
  for (int j = 0; j < f_.cols(); ++j) {
    take_column(j, arena);
    std::copy_n(form_.xp(), data_.n, xp_.view().column(j));
    inconsistency_ = std::max(inconsistency_, form_.inconsistency());
  }
}

PointStatus SensitivityPoint::linearize(AnalyzedEquations& equations, ParameterSeries& parameters,
                                        ExtendedSensitivityStep& extension, const Place& place, Arena& arena) {
  forget();
  const int n = equations.n(), d = extension.num_states(), count = parameters.count();
  if (tangents_.rows() != n || tangents_.cols() != d) tangents_ = Matrix(n, d);
  if (xp_.rows() != n || xp_.cols() != count) xp_ = Matrix(n, count);
  PointStatus status = extension.find_tangents(place.jet, tangents_, xp_);
  callback_error_ = extension.callback_error();
  if (status != PointStatus::ok || !extension.is_possible()) return status;
  for (const View& columns : {View(tangents_), View(xp_)})
    for (int j = 0; j < columns.cols; ++j)
      for (int i = 0; i < n; ++i) columns(i, j) /= equations.units()[i];
  status = evaluate_along_tangents(equations, place.jet, arena);
  if (status != PointStatus::ok) return status;
  if (level_0_f_.rows() != data_.m || level_0_f_.cols() != count) level_0_f_ = Matrix(data_.m, count);
  inconsistency_ = 0.0;
  status = take_differential(equations, place, parameters);
  if (status != PointStatus::ok) return status;
  callback_error_ =
      parameters.evaluate(differential_data(), has_slopes_ ? slope_jet_.data() : place.jet.x.data(), 0, level_0_f_);
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  if (Zf_.rows() != d || Zf_.cols() != count) Zf_ = Matrix(d, count);
  multiply(1.0, Op::transposed, Z1(), Op::plain, level_0_f_, 0.0, Zf_);
  return PointStatus::ok;
}

PointStatus SensitivityPoint::take_right_hand_sides(ParameterSeries& parameters) {
  if (Zf_.rows() != d() || Zf_.cols() != f_.cols()) Zf_ = Matrix(d(), f_.cols());
  ConstView f = f_.view().top(data_.m);
  if (has_slopes_) {
    if (slope_f_.rows() != data_.m || slope_f_.cols() != f.cols) slope_f_ = Matrix(data_.m, f.cols);
    callback_error_ = parameters.evaluate(differential_data(), slope_jet_.data(), 0, slope_f_);
    if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
    f = slope_f_;
  }
  if (is_ordinary()) copy(f, Zf_);
  else multiply(1.0, Op::transposed, form_.Z1(), Op::plain, f, 0.0, Zf_);
  return PointStatus::ok;
}

void SensitivityPoint::add_along_T2(ConstView q, View S, Arena& arena) const {
  const Arena::Frame frame(arena);
  const View z = arena.matrix(form_.unknowns(), q.cols);
  for (int j = 0; j < q.cols; ++j) form_.solve_G(q.column(j), z.column(j), arena);
  multiply(1.0, Op::plain, form_.T2(), Op::plain, z, 1.0, S);
}

// Sets the right-hand side of the form to that of parameter j.
void SensitivityPoint::take_column(int j, Arena& arena) {
  const double* f = f_.view().column(j);
  for (int k = 0; k <= data_.orders.f; ++k)
    std::copy_n(f + static_cast<std::ptrdiff_t>(k) * data_.m, data_.m, data_.f(k));
  form_.replace_rhs(data_, f_hat_.view().column(j), {}, arena);
}

ConstrainedPoint SensitivityPoint::constraints_of(int j, const Units& units, Arena& arena) {
  take_column(j, arena);
  return {form_, data_, units, rank_E_, kept_};
}

}  // namespace sfdae::core
