// The equations linearized at one jet of x.
// SPDX-License-Identifier: BSD-3-Clause
#include "sensitivity/linearized_point.h"

#include <algorithm>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "reduction/elimination.h"
#include "reduction/rank_sequence.h"

namespace sfdae::core {

void LinearizedPoint::take_kind(const AnalyzedEquations& equations) {
  const CharacteristicValues& values = equations.analysis().values;
  is_ordinary_ = values.mu == 0 && values.d == equations.n() && equations.m() == equations.n();
}

PointStatus LinearizedPoint::evaluate(AnalyzedEquations& equations, const Jet& jet) {
  const int mu = equations.mu();
  const IndexAnalysis& analysis = equations.analysis();
  const NonlinearProblem::Scaling scaling{analysis.time_scale, analysis.rows, nullptr, &equations.units()};
  callback_error_ = equations.problem().linearize(jet.t, jet.x.data(), {mu, mu, mu}, scaling, data_);
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  has_tangents_ = false;
  take_kind(equations);
  return PointStatus::ok;
}

PointStatus LinearizedPoint::evaluate_along_tangents(AnalyzedEquations& equations, const Jet& jet, Arena& arena) {
  const IndexAnalysis& analysis = equations.analysis();
  const NonlinearProblem::Scaling scaling{analysis.time_scale, analysis.rows, nullptr, &equations.units()};
  callback_error_ = equations.problem().linearize(jet.t, jet.x.data(), {0, 0, -1}, scaling, data_);
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  is_ordinary_ = false;
  has_tangents_ = true;
  const int d = tangents_.cols();
  if (Z1_.rows() != data_.m || Z1_.cols() != d) Z1_ = Matrix(data_.m, d);
  const Arena::Frame frame(arena);
  const View ET = arena.matrix(data_.m, d);
  multiply(1.0, Op::plain, data_.E(0), Op::plain, tangents_, 0.0, ET);
  double* const tau = arena.take(index(d) + 1);
  factor_qr(ET, tau, arena);
  form_q(ET, d, tau, Z1_, arena);
  return PointStatus::ok;
}

void LinearizedPoint::take_slopes(const Place& place, const ParameterSeries& parameters) {
  has_slopes_ = place.xdot != nullptr && parameters.needs_slopes();
  if (!has_slopes_) return;
  slope_jet_.assign(place.jet.column(0), place.jet.column(0) + data_.n);
  slope_jet_.insert(slope_jet_.end(), place.xdot, place.xdot + data_.n);
}

PointStatus LinearizedPoint::take_differential(AnalyzedEquations& equations, const Place& place,
                                               const ParameterSeries& parameters) {
  const int n = data_.n, d = this->d();
  if (ZE_.rows() != d || ZE_.cols() != n) ZE_ = ZA_ = Matrix(d, n);
  take_slopes(place, parameters);
  has_slope_data_ = has_slopes_ && parameters.matrices_need_slopes();
  if (has_slope_data_) {
    const NonlinearProblem::Scaling scaling{data_.time_scale, RowScaling::given, &data_.row_scale,
                                            &equations.units()};
    callback_error_ = equations.problem().linearize(place.jet.t, slope_jet_.data(), {0, 0, -1}, scaling, slope_data_);
    if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  }
  const TaylorData& matrices = differential_data();
  if (is_ordinary_) {
    copy(matrices.E(0), ZE_);
    copy(matrices.A(0), ZA_);
    return PointStatus::ok;
  }
  multiply(1.0, Op::transposed, Z1(), Op::plain, matrices.E(0), 0.0, ZE_);
  multiply(1.0, Op::transposed, Z1(), Op::plain, matrices.A(0), 0.0, ZA_);
  return PointStatus::ok;
}

PointStatus LinearizedPoint::reduce(AnalyzedEquations& equations, const RankSequence& known, const Reduced& reduced,
                                    Arena& arena) {
  const int mu = equations.mu();
  const IndexAnalysis& analysis = equations.analysis();
  if (known.count > 0) {
    const Judge::Settings judging{equations.settings().rank_tol, false, NoiseModel::pivots, &known};
    Judge judge(data_, mu, judging, nullptr);
    const Arena::Frame frame(arena);
    const Carried carried = eliminate(data_, mu, reduced.f, 1, judge, arena, reduced.store);
    form_.resize(data_.m, data_.n, 0, carried.rows);
    const PointRanks ranks = form_.build(data_, carried, {}, LeadingTerm::identity, judge, arena);
    rank_E_ = carried.rank_E;
    kept_ = judge.kept_constraints() * judge.smallest_pivot();
    if (judge.fits_known_ranks() && ranks.a == analysis.values.a && ranks.d == analysis.values.d &&
        ranks.v_hat == analysis.v_hat) {
      Matrix& f_hat = reduced.f_hat;
      if (f_hat.rows() != carried.rows || f_hat.cols() != reduced.f.cols)
        f_hat = Matrix(carried.rows, reduced.f.cols);
      copy(carried.rhs, f_hat);
      return PointStatus::ok;
    }
  }
  return reduce_by_judgement(equations, reduced, arena);
}

PointStatus LinearizedPoint::reduce_by_judgement(AnalyzedEquations& equations, const Reduced& reduced, Arena& arena) {
  StoredElimination own;
  StoredElimination& elimination = reduced.store != nullptr ? *reduced.store : own;
  StoredReduction reduction{elimination, true};
  if (!reduce_with_known_values(data_, equations.mu(), equations.analysis(), equations.settings().rank_tol,
                                {arena, form_}, reduction))
    return PointStatus::singular;
  rank_E_ = reduction.rank_E;
  kept_ = reduction.kept;
  reduced.f_hat = Matrix(elimination.carried_rows(), reduced.f.cols);
  std::vector<double> transformed(index(reduced.f.rows) + 1);
  for (int j = 0; j < reduced.f.cols; ++j) {
    elimination.transform(reduced.f.column(j), transformed.data(), arena);
    std::copy_n(transformed.data(), reduced.f_hat.rows(), reduced.f_hat.view().column(j));
  }
  return PointStatus::ok;
}

}  // namespace sfdae::core
