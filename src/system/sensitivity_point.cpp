// The equations of sensitivities at one jet of x.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/sensitivity_point.h"

#include <algorithm>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "reduction/elimination.h"
#include "reduction/rank_sequence.h"

namespace sfdae::core {

PointStatus SensitivityPoint::linearize(AnalyzedEquations& equations, ParameterSeries& parameters, const Place& place,
                                        Arena& arena) {
  const int mu = equations.mu(), m = equations.m(), count = parameters.count();
  const Jet& jet = place.jet;
  const IndexAnalysis& analysis = equations.analysis();
  const NonlinearProblem::Scaling scaling{analysis.time_scale, analysis.rows, nullptr, &equations.units()};
  callback_error_ = equations.problem().linearize(jet.t, jet.x.data(), {mu, mu, mu}, scaling, data_);
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  if (f_.rows() != m * (mu + 1) || f_.cols() != count) f_ = Matrix(m * (mu + 1), count);
  callback_error_ = parameters.evaluate(data_, jet.x.data(), mu, f_);
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  inconsistency_ = 0.0;
  is_ordinary_ = mu == 0 && analysis.values.d == equations.n() && m == equations.n();
  if (is_ordinary_) {
    resize();
    return take_differential(equations, parameters, place);
  }
  const PointStatus status = reduce(equations, place.known, arena);
  if (status != PointStatus::ok) return status;
  resize();
  for (int j = 0; j < count; ++j) {
    take_column(j, arena);
    std::copy_n(form_.xp(), data_.n, xp_.view().column(j));
    inconsistency_ = std::max(inconsistency_, form_.inconsistency());
  }
  return take_differential(equations, parameters, place);
}

void SensitivityPoint::resize() {
  const int n = data_.n, d = this->d(), count = f_.cols();
  if (xp_.rows() == n && Zf_.rows() == d && Zf_.cols() == count) return;  // the last one that needs memory
  xp_ = Matrix(n, count);
  ZE_ = ZA_ = Matrix(d, n);
  Zf_ = Matrix(d, count);
}

PointStatus SensitivityPoint::take_differential(AnalyzedEquations& equations, ParameterSeries& parameters,
                                                const Place& place) {
  const int n = data_.n;
  const TaylorData* matrices = &data_;
  ConstView f = f_.view().top(data_.m);
  if (place.xdot != nullptr && parameters.needs_slopes()) {
    slope_jet_.assign(place.jet.column(0), place.jet.column(0) + n);
    slope_jet_.insert(slope_jet_.end(), place.xdot, place.xdot + n);
    const NonlinearProblem::Scaling scaling{data_.time_scale, RowScaling::given, &data_.row_scale,
                                            &equations.units()};
    callback_error_ = equations.problem().linearize(place.jet.t, slope_jet_.data(), {0, 0, -1}, scaling, slope_data_);
    if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
    if (slope_f_.rows() != data_.m || slope_f_.cols() != f_.cols()) slope_f_ = Matrix(data_.m, f_.cols());
    callback_error_ = parameters.evaluate(slope_data_, slope_jet_.data(), 0, slope_f_);
    if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
    matrices = &slope_data_;
    f = slope_f_;
  }
  if (is_ordinary_) {
    copy(matrices->E(0), ZE_);
    copy(matrices->A(0), ZA_);
    copy(f, Zf_);
    return PointStatus::ok;
  }
  multiply(1.0, Op::transposed, form_.Z1(), Op::plain, matrices->E(0), 0.0, ZE_);
  multiply(1.0, Op::transposed, form_.Z1(), Op::plain, matrices->A(0), 0.0, ZA_);
  multiply(1.0, Op::transposed, form_.Z1(), Op::plain, f, 0.0, Zf_);
  return PointStatus::ok;
}

void SensitivityPoint::add_along_T2(ConstView q, View S, Arena& arena) const {
  const Arena::Frame frame(arena);
  const View z = arena.matrix(form_.unknowns(), q.cols);
  for (int j = 0; j < q.cols; ++j) form_.solve_G(q.column(j), z.column(j), arena);
  multiply(1.0, Op::plain, form_.T2(), Op::plain, z, 1.0, S);
}

PointStatus SensitivityPoint::reduce(AnalyzedEquations& equations, const RankSequence& known, Arena& arena) {
  const int mu = equations.mu();
  const IndexAnalysis& analysis = equations.analysis();
  const double rank_tol = equations.settings().rank_tol;
  if (known.count > 0) {
    const Judge::Settings judging{rank_tol, false, NoiseModel::pivots, &known};
    Judge judge(data_, mu, judging, nullptr);
    const Arena::Frame frame(arena);
    const Carried carried = eliminate(data_, mu, f_, 1, judge, arena);
    form_.resize(data_.m, data_.n, 0, carried.rows);
    const PointRanks ranks = form_.build(data_, carried, {}, LeadingTerm::identity, judge, arena);
    rank_E_ = carried.rank_E;
    kept_ = judge.kept_constraints() * judge.smallest_pivot();
    if (judge.fits_known_ranks() && ranks.a == analysis.values.a && ranks.d == analysis.values.d &&
        ranks.v_hat == analysis.v_hat) {
      if (f_hat_.rows() != carried.rows || f_hat_.cols() != f_.cols()) f_hat_ = Matrix(carried.rows, f_.cols());
      copy(carried.rhs, f_hat_);
      return PointStatus::ok;
    }
  }
  return reduce_by_judgement(equations, arena);
}

PointStatus SensitivityPoint::reduce_by_judgement(AnalyzedEquations& equations, Arena& arena) {
  StoredElimination elimination;
  StoredReduction reduction{elimination, true};
  if (!reduce_with_known_values(data_, equations.mu(), equations.analysis(), equations.settings().rank_tol,
                                {arena, form_}, reduction))
    return PointStatus::singular;
  rank_E_ = reduction.rank_E;
  kept_ = reduction.kept;
  f_hat_ = Matrix(elimination.carried_rows(), f_.cols());
  std::vector<double> transformed(index(f_.rows()) + 1);
  for (int j = 0; j < f_.cols(); ++j) {
    elimination.transform(f_.view().column(j), transformed.data(), arena);
    std::copy_n(transformed.data(), f_hat_.rows(), f_hat_.view().column(j));
  }
  return PointStatus::ok;
}

// The right-hand side of the form becomes that of parameter j.
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
