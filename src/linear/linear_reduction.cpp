// Reduction of a linear problem at a point with known ranks.
// SPDX-License-Identifier: BSD-3-Clause
#include "linear/linear_reduction.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "reduction/elimination.h"
#include "reduction/index_search.h"

namespace sfdae::core {

namespace {

// Errors with other signs rarely exceed the largest of these by much. Chosen.
constexpr int error_samples = 4;

// std::max would drop an error that is not a number.
double larger_error(double a, double b) {
  return std::isnan(b) ? std::numeric_limits<double>::infinity() : std::max(a, b);
}

// Values that are purely rounding errors.
bool has_vanished(const LinearPoint& point) {
  return std::min({point.pivot, point.kept_constraints, point.kept_differential}) < unit_roundoff;
}

}  // namespace

void LinearReduction::start(const IndexAnalysis& analysis) {
  prescribed_values_.resize(problem_.prescribed().size() + 1);
  // When ranks are only compared with known ones, the cheaper model comes first.
  noise_ = analysis.noise == NoiseModel::data ? NoiseModel::data : NoiseModel::pivots;
  rows_ = analysis.rows;
}

// Values of the prescribed components, in the units of the unknowns.
CallbackError LinearReduction::evaluate_prescribed(double t) {
  CallbackError error = problem_.evaluate_prescribed(t, prescribed_values_.data());
  if (error.status != SFDAE_OK || problem_.units().are_one()) return error;
  for (std::size_t i = 0; i < problem_.prescribed().size(); ++i)
    prescribed_values_[i] /= problem_.units()[problem_.prescribed()[i]];
  return error;
}

PointStatus LinearReduction::reduce(double t, const KnownForm& known, LinearPoint& point, CallbackError& error,
                                    long& count) {
  // Ranks found by a certificate, which norms alone would not give.
  const RankSequence& certified = known.analysis.certified_ranks;
  PointStatus status =
      attempt({t, known.analysis.time_scale, rows_, noise_, certified.count > 0 ? &certified : nullptr}, known, point,
              error, count);
  if (certified.count > 0 && status == PointStatus::ok && has_vanished(point)) status = PointStatus::changed;
  if (status == PointStatus::changed) status = attempt_others(t, known, point, error, count);
  if (status == PointStatus::changed) status = keep_known_ranks(t, known, point, error, count);
  if (status != PointStatus::ok || !problem_.is_constant()) return status;
  // The same operations at every point: results do not depend, in any bit, on whether this is the first one.
  has_constant_form_ = true;
  return replace_rhs(t, known.analysis.values.mu, point, error);
}

// Last attempts before the values are declared to have changed.
PointStatus LinearReduction::attempt_others(double t, const KnownForm& known, LinearPoint& point,
                                            CallbackError& error, long& count) {
  const double time_scale = known.analysis.time_scale;
  // Rows that are small by cancellation must not be scaled up (docs/design/rank_decisions.md).
  PointStatus status = attempt({t, time_scale, RowScaling::common, noise_}, known, point, error, count);
  // The other noise models; without propagation the noise has to be measured.
  for (NoiseModel model : {NoiseModel::carried, NoiseModel::pivots, NoiseModel::data}) {
    if (status != PointStatus::changed || model == noise_) continue;
    if (model != NoiseModel::data ||
        (problem_.prescribed().empty() && known_values_hold(problem_, t, settings_, known.analysis, arena_)))
      status = attempt({t, time_scale, rows_, model}, known, point, error, count);
  }
  // Data that have grown or shrunk may need another unit of time: that of the point, or, three binary digits faster,
  // one of those that an analysis tries as well (docs/design/rank_decisions.md).
  for (double factor : {1.0, 0.125}) {
    if (status != PointStatus::changed || settings_.time_scale > 0.0) break;
    error = problem_.evaluate(t, known.orders(), 0.0, point.data);
    if (error.status != SFDAE_OK) return PointStatus::callback_error;
    status = attempt({t, point.data.time_scale * factor, rows_, noise_}, known, point, error, count);
  }
  return status;
}

// Known ranks are retained unless the full analysis clearly finds others (docs/design/rank_decisions.md).
PointStatus LinearReduction::keep_known_ranks(double t, const KnownForm& known, LinearPoint& point,
                                              CallbackError& error, long& count) {
  if (settings_.by_svd || settings_.rank_tol > 0.0) return PointStatus::changed;
  // After a checkpoint they are recomputed.
  if (ranks_.count == 0 && known.analysis.t != t)
    attempt({known.analysis.t, known.analysis.time_scale, rows_, noise_}, known, point, error, count);
  if (ranks_.count == 0) return PointStatus::changed;
  IndexSearch search({problem_, settings_, arena_}, t);
  SearchResult found;
  try {
    found = search.search(settings_.max_index);
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
    found.last.clear = false;
  }
  const bool is_confirmed = found.last.clear && found.values == known.analysis.values;
  if (found.last.clear && !is_confirmed) return PointStatus::changed;
  const RankSequence ranks = ranks_;
  const PointStatus status =
      attempt({t, known.analysis.time_scale, rows_, noise_, &ranks}, known, point, error, count);
  if (status != PointStatus::ok || is_confirmed) return status;
  return has_vanished(point) ? PointStatus::changed : status;
}

PointStatus LinearReduction::attempt(const Attempt& attempt, const KnownForm& known, LinearPoint& point,
                                     CallbackError& error, long& count) {
  point.forget();
  error = problem_.evaluate(attempt.t, known.orders(), attempt.time_scale, point.data, attempt.rows,
                            preferred_rows_.empty() ? nullptr : &preferred_rows_);
  if (error.status == SFDAE_OK) error = evaluate_prescribed(attempt.t);
  if (error.status != SFDAE_OK) return PointStatus::callback_error;
  ++count;
  const PointRanks ranks = build_form(attempt, known, point);
  const CharacteristicValues& values = known.analysis.values;
  if (candidate_.count == 0) return PointStatus::changed;
  if (ranks.a != values.a || ranks.v_hat != known.analysis.v_hat) return PointStatus::changed;
  const bool lacks_equations = ranks.d != values.d && !problem_.prescribed().empty();
  demand_fitting_prescription(ranks.prescription_fits && !lacks_equations, attempt.t);
  if (ranks.d != values.d) return PointStatus::changed;
  if (known.leading == LeadingTerm::projector && ranks.rank_E != known.analysis.rank_E)
    return PointStatus::leading_changed;
  ranks_ = candidate_;
  return PointStatus::ok;
}

// Elimination and null-space form of the coefficients evaluated.
PointRanks LinearReduction::build_form(const Attempt& attempt, const KnownForm& known, LinearPoint& point) {
  const int mu = known.analysis.values.mu;
  const Judge::Settings judging{settings_.rank_tol, settings_.by_svd, attempt.noise, attempt.known_ranks};
  Judge judge(point.data, mu, judging, nullptr);
  const Arena::Frame frame(arena_);
  const bool keep_transformation = problem_.is_constant();
  const ConstView f = point.data.f_stack(mu);
  const Matrix unit = keep_transformation ? identity(f.rows) : Matrix();
  const ConstView rhs = keep_transformation ? unit.view() : f;
  Carried carried = settings_.by_svd ? eliminate_by_svd(point.data, mu, rhs, judge, arena_)
                                     : eliminate(point.data, mu, rhs, 1, judge, arena_);
  if (keep_transformation) {
    Zt_ = to_matrix(carried.rhs);
    const View f_hat = arena_.matrix(carried.rows, 1);
    multiply(1.0, Op::plain, Zt_, f.data, 0.0, f_hat.data);
    carried.rhs = f_hat;
  }
  const PointRanks ranks = point.form.build(point.data, carried, {&problem_.prescribed(), prescribed_values_.data()},
                                            known.leading, judge, arena_);
  point.t = attempt.t;
  point.rank_E = ranks.rank_E;
  point.kept_constraints = judge.kept_constraints();
  point.kept_differential = judge.kept_differential();
  point.pivot = judge.smallest_pivot();
  candidate_ = judge.fits_known_ranks() ? judge.ranks() : RankSequence();
  return ranks;
}

PointStatus LinearReduction::replace_rhs(double t, int mu, LinearPoint& point, CallbackError& error) {
  point.forget();
  error = problem_.evaluate_plain(t, {-1, -1, mu}, rhs_);
  if (error.status == SFDAE_OK) error = evaluate_prescribed(t);
  if (error.status != SFDAE_OK) return PointStatus::callback_error;
  double factor = 1.0;
  for (int k = 0; k <= mu; ++k) {
    factor *= point.data.time_scale / std::max(k, 1);
    for (int i = 0; i < problem_.m(); ++i)
      point.data.f(k)[i] = rhs_.f(k)[i] * factor * point.data.row_scale[index(i)];
  }
  point.data.take_errors_of_f(rhs_);
  const Arena::Frame frame(arena_);
  double* f_hat = arena_.take(index(Zt_.rows()) + 1);
  multiply(1.0, Op::plain, Zt_, point.data.f(0), 0.0, f_hat);
  point.form.replace_rhs(point.data, f_hat, {&problem_.prescribed(), prescribed_values_.data()}, arena_);
  point.t = t;
  return PointStatus::ok;
}

void LinearReduction::errors_of_x(const KnownForm& known, const LinearPoint& point, const double* x, double* errors) {
  const int n = problem_.n();
  std::fill_n(errors, n, 0.0);
  std::minstd_rand generator(1);
  TaylorData changed;
  NullSpaceForm form;
  const Arena::Frame frame(arena_);
  double* Ex = arena_.take(index(problem_.m()));
  multiply(1.0, Op::plain, point.data.E(0), x, 0.0, Ex);
  int counted = 0;
  for (int sample = 0; sample < error_samples; ++sample) {
    changed = point.data;
    changed.change_by_errors(generator);
    // A sample with other ranks has no solution to compare with.
    if (!build_changed_form(known, point, changed, form)) continue;
    ++counted;
    double* q = arena_.take(index(form.d) + 1);
    double* z = arena_.take(index(form.unknowns()) + 1);
    double* moved = arena_.take(index(n));
    multiply(1.0, Op::transposed, form.Z1(), Ex, 0.0, q);
    for (int i = 0; i < form.d; ++i) q[i] -= form.g0()[i];
    form.solve_G(q, z, arena_);
    if (form.u > 0) {
      // The free part of x stays.
      double* along = arena_.take(index(form.unknowns()));
      double* free_part = arena_.take(index(form.u));
      multiply(1.0, Op::transposed, form.T2(), x, 0.0, along);
      multiply(1.0, Op::transposed, form.Uz(), along, 0.0, free_part);
      multiply(1.0, Op::plain, form.Uz(), free_part, 1.0, z);
    }
    std::copy_n(form.xp(), n, moved);
    multiply(1.0, Op::plain, form.T2(), z, 1.0, moved);
    for (int i = 0; i < n; ++i) errors[i] = larger_error(errors[i], std::fabs(moved[i] - x[i]));
  }
  if (counted == 0) std::fill_n(errors, n, std::numeric_limits<double>::infinity());
}

// Uses the ranks of the point.
bool LinearReduction::build_changed_form(const KnownForm& known, const LinearPoint& point, TaylorData& changed,
                                         NullSpaceForm& form) {
  const int mu = known.analysis.values.mu;
  const Prescription prescription{&problem_.prescribed(), prescribed_values_.data()};
  const Arena::Frame frame(arena_);
  if (has_constant_form_) {
    form = point.form;
    double* f_hat = arena_.take(index(Zt_.rows()) + 1);
    multiply(1.0, Op::plain, Zt_, changed.f(0), 0.0, f_hat);
    form.replace_rhs(changed, f_hat, prescription, arena_);
    return true;
  }
  const Judge::Settings judging{settings_.rank_tol, settings_.by_svd, noise_, &ranks_};
  Judge judge(changed, mu, judging, nullptr);
  const Carried carried = settings_.by_svd ? eliminate_by_svd(changed, mu, changed.f_stack(mu), judge, arena_)
                                           : eliminate(changed, mu, changed.f_stack(mu), 1, judge, arena_);
  form.resize(problem_.m(), problem_.n(), static_cast<int>(problem_.prescribed().size()), carried.rows);
  const PointRanks ranks = form.build(changed, carried, prescription, known.leading, judge, arena_);
  return judge.fits_known_ranks() && ranks.prescription_fits && ranks.a == known.analysis.values.a &&
         ranks.d == known.analysis.values.d;
}

void LinearReduction::prefer_rows_of(const LinearPoint& point) {
  preferred_rows_.assign(point.data.row_scale.begin(), point.data.row_scale.end());
}

double LinearReduction::row_ratio(const LinearPoint& point) const {
  const double here = point.data.row_scale_ratio();
  if (preferred_rows_.empty()) return here;
  const auto [smallest, largest] = std::minmax_element(preferred_rows_.begin(), preferred_rows_.end());
  return std::min(here, *largest / *smallest);
}

}  // namespace sfdae::core
