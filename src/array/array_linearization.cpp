// A linearization of the derivative array.
// SPDX-License-Identifier: BSD-3-Clause
#include "array/array_linearization.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"
#include "problem/failure.h"
#include "reduction/elimination.h"
#include "reduction/rank_sequence.h"
#include "system/jet_coefficients.h"

namespace sfdae::core {

namespace {

// Preferred row factor far from any suitable one, so that a new one is chosen (the factors of the last point are reused
// while they are right to a factor of 8, docs/design/scaling_and_units.md).
constexpr double no_preference = 1e300;

bool has_constraints(const PointRanks& ranks, const IndexAnalysis& known) {
  return ranks.a == known.values.a && ranks.v_hat == known.v_hat;
}

// |x|, |y_1|, ..., |y_order| at the jet, scaled.
void scaled_sizes(const Jet& jet, int order, double tau, const Units& units, double* size) {
  double power = 1.0;
  for (int k = 0; k <= order; ++k) {
    const double factor = k == 0 ? 1.0 : k * (power *= tau);
    for (int j = 0; j < jet.n; ++j) size[k * jet.n + j] = std::fabs(factor * jet.column(k)[j]) / units[j];
  }
}

// Calls visit(i, k, block, factor) for the blocks of the derivative array in level i and the columns of x (k = 0) or
// y_k.
template <class Visit>
void for_each_block(const TaylorData& data, int level, Visit visit) {
  for (int i = 0; i <= level; ++i) {
    if (!data.is_zero_A(i)) visit(i, 0, data.A(i), 1.0);
    for (int k = 1; k <= i + 1; ++k) {
      if (!data.is_zero_E(i + 1 - k)) visit(i, k, data.E(i + 1 - k), 1.0);
      if (k <= i && !data.is_zero_A(i - k)) visit(i, k, data.A(i - k), 1.0 / k);
    }
  }
}

// to += factor |block| sizes
void add_sizes(ConstView block, double factor, const double* sizes, double* to) {
  for (int j = 0; j < block.cols; ++j)
    for (int i = 0; i < block.rows; ++i) to[i] += factor * std::fabs(block(i, j)) * sizes[j];
}

// Adds the sums of the terms in each equation of the array. size: sizes of x, y_1, ...
void add_array_sizes(const TaylorData& data, int level, const double* size, double* sums) {
  for_each_block(data, level, [&](int i, int k, ConstView block, double factor) {
    add_sizes(block, factor, size + k * data.n, sums + static_cast<std::ptrdiff_t>(i) * data.m);
  });
}

}  // namespace

void ArrayLinearization::resize() {
  const int m = problem_.m(), n = problem_.n();
  const IndexAnalysis& analysis = problem_.analysis();
  form_.resize(m, n, static_cast<int>(problem_.prescribed().size()), analysis.values.a + analysis.v_hat);
  matrix_.resize(n);
  noise_.assign(index(n) * index(problem_.jet_order() + 1), 0.0);
  constraint_terms_.assign(index(analysis.values.a + analysis.v_hat) * noise_.size(), 0.0);
  renewal_of_terms_ = -1;
  rounding_errors_.assign(index(n), 0.0);
  origin_.jet.n = n;
  origin_.jet.set_order(problem_.jet_order());
}

PointStatus ArrayLinearization::renew(const Jet& jet, bool judged) {
  is_complete_ = false;
  ++renewals_;
  const PointStatus status = linearize(jet, judged);
  is_complete_ = true;
  return status;
}

PointStatus ArrayLinearization::linearize(const Jet& jet, bool judged) {
  is_usable_ = false;
  matrix_.forget();
  origin_.jet = jet;
  origin_.is_judged = judged;
  origin_.age = 0;
  if (preferred_rows_.empty()) origin_.rows.assign(index(problem_.m()), no_preference);
  else origin_.rows = preferred_rows_;
  const PointStatus status = problem_.linearize(jet, preferred_rows(), data_);
  if (status != PointStatus::ok) return status;
  ++counts_.reductions;
  preferred_rows_.assign(data_.row_scale.begin(), data_.row_scale.end());
  const IndexAnalysis& known = problem_.analysis();
  const NoiseModel noise = known.noise == NoiseModel::data ? NoiseModel::data : NoiseModel::pivots;
  const Judge::Settings judging{problem_.settings().rank_tol, false, noise, judged ? nullptr : &ranks_};
  Judge judge(data_, problem_.mu(), judging, nullptr);
  const PointRanks ranks = eliminate_array(judge);
  if (!judge.fits_known_ranks()) return PointStatus::singular;
  const bool has_all_constraints = has_constraints(ranks, known);
  // Prescribed components that are differential take their equations away.
  const bool lacks_equations =
      judged && has_all_constraints && ranks.d < known.values.d && !problem_.prescribed().empty();
  demand_fitting_prescription(ranks.prescription_fits && !lacks_equations, jet.t);
  const bool is_plausible = !judged || !data_.differentiations.empty() ||
                            stages_rise(judge.ranks(), problem_.mu(), std::min(data_.m, data_.n));
  if (!has_all_constraints || ranks.d != known.values.d || !is_plausible)
    return judged ? renew_with_other_ranks(jet) : PointStatus::changed;
  is_usable_ = true;
  ranks_ = judge.ranks();
  measure_noise(jet);
  return PointStatus::ok;
}

PointRanks ArrayLinearization::eliminate_array(Judge& judge) {
  const int mu = problem_.mu();
  const Arena::Frame frame(arena_);
  const Carried carried = eliminate(data_, mu, data_.f_stack(mu), 1, judge, arena_, &elimination_);
  const Prescription inputs{&problem_.prescribed(), problem_.input_values().data()};
  const PointRanks ranks = form_.build(data_, carried, inputs, LeadingTerm::identity, judge, arena_);
  elimination_.mark_determined(determined_);
  quality_.kept_constraints = judge.kept_constraints();
  quality_.kept_differential = judge.kept_differential();
  quality_.smallest_pivot = judge.smallest_pivot();
  return ranks;
}

// Looks for ranks that give the known values: the cheap estimate of the noise may be too large or too small.
PointStatus ArrayLinearization::renew_with_other_ranks(const Jet& jet) {
  const AnalysisSettings& settings = problem_.settings();
  const IndexAnalysis& known = problem_.analysis();
  if (const std::optional<RankSequence> found =
          matching_ranks(data_, problem_.mu(), known, settings.rank_tol, {arena_, rank_form_})) {
    ranks_ = *found;
    return renew(jet, false);
  }
  if (ranks_.count == 0) {
    const std::optional<RankSequence> found = ranks_in_other_units(jet);
    if (!found) return PointStatus::changed;
    ranks_ = *found;
    return renew(jet, false);
  }
  JetCoefficients source(problem_.problem(), jet, problem_.units());
  if (!known_values_hold(source, jet.t, settings, known, arena_)) return PointStatus::changed;
  return renew(jet, false);
}

// Ranks found as an analysis finds the values: with one factor for all rows, or in another unit of time.
std::optional<RankSequence> ArrayLinearization::ranks_in_other_units(const Jet& jet) {
  struct Scaling {
    RowScaling rows;
    double factor;
  };
  const AnalysisSettings& settings = problem_.settings();
  const IndexAnalysis& known = problem_.analysis();
  const int mu = problem_.mu();
  TaylorData data;
  // The units of time that an analysis tries (docs/design/rank_decisions.md), and further ones.
  for (const Scaling& scaling : {Scaling{RowScaling::common, 1.0}, Scaling{RowScaling::each, 1.0 / 8.0},
                                 Scaling{RowScaling::each, 4.0}, Scaling{RowScaling::each, 1.0 / 64.0}}) {
    const NonlinearProblem::Scaling units{known.time_scale * scaling.factor, scaling.rows, nullptr,
                                          &problem_.units()};
    if (problem_.problem().linearize(jet.t, jet.x.data(), {mu, mu, mu}, units, data).status != SFDAE_OK)
      return std::nullopt;
    const auto found = matching_ranks(data, mu, known, settings.rank_tol, {arena_, rank_form_});
    if (found) return found;
  }
  return std::nullopt;
}

bool ArrayLinearization::has_tiny_pivots() const {
  return !(std::min({quality_.smallest_pivot, quality_.kept_constraints, quality_.kept_differential}) >=
           unit_roundoff);
}

PointStatus ArrayLinearization::restore(Origin origin, const RankSequence& ranks) {
  ranks_ = ranks;
  preferred_rows_ = origin.rows;
  const PointStatus status = renew(origin.jet, false);
  ranks_ = ranks;
  origin_.age = origin.age;
  origin_.is_judged = origin.is_judged;
  return status;
}

// Propagates rounding errors like residuals. One sample shows their size up to a factor.
void ArrayLinearization::measure_noise(const Jet& jet) {
  // At an initial guess numbers may overflow.
  const QuietArithmetic quiet;
  // Errors with other signs rarely exceed the sample by a larger factor (docs/design/error_control.md). Chosen, not
  // measured.
  constexpr double samples = 8.0;
  const int n = problem_.n();
  const Arena::Frame frame(arena_);
  double* errors = arena_.zeros(index(problem_.array_rows()) + 1);
  double* transformed = arena_.take(index(problem_.array_rows()) + 1);
  double* z = arena_.take(index(form_.unknowns()) + 1);
  double* size = arena_.take(noise_.size());
  scaled_sizes(jet, problem_.jet_order(), data_.time_scale, problem_.units(), size);
  add_array_sizes(data_, problem_.mu(), size, errors);
  // One rounding error for each equation, with alternating signs.
  for (int k = 0; k <= problem_.mu(); ++k)
    for (int i = 0; i < problem_.m(); ++i)
      errors[k * problem_.m() + i] *= (i + k) % 2 == 0 ? unit_roundoff : -unit_roundoff;
  std::copy_n(errors, problem_.m(), data_.f(0));
  elimination_.transform(errors, transformed, arena_);
  const std::vector<int>& components = problem_.prescribed();
  double* none = arena_.zeros(components.size() + 1);
  form_.replace_rhs(data_, transformed, {&components, none}, arena_, RightHandSides::constraints);
  keep_differential_part(z);
  change_of_x(z, noise_.data());
  elimination_.recover(data_, {errors, transformed}, noise_.data(), noise_.data() + n, arena_);
  for (double& noise : noise_) noise = samples * std::fabs(noise);
  for (std::size_t j = 0; j < index(n); ++j) rounding_errors_[j] = noise_[j] * problem_.units()[j];
}

bool ArrayLinearization::factor_step_matrix(double c) {
  assert(is_usable_);
  if (matrix_.is_valid() && matrix_.is_for(c)) return true;
  return matrix_.factor(form_, data_.time_scale, c, counts_.factorizations);
}

bool ArrayLinearization::factor_stages(const StageMethod& method, double h) {
  return factor_step_matrix(method.gamma / h) &&
         matrix_.factor_stages(form_, data_.time_scale, method, counts_.factorizations);
}

PointStatus ArrayLinearization::evaluate_array(const Jet& jet, const ArrayResiduals& residuals) {
  const int mu = problem_.mu(), m = problem_.m();
  const PointStatus status = problem_.residuals(jet.t, jet.x.data(), mu, residuals.f);
  if (status != PointStatus::ok) return status;
  double power = -1.0;
  for (int k = 0; k <= mu; ++k) {
    power *= data_.time_scale;
    for (int i = 0; i < m; ++i) residuals.f[k * m + i] *= power * data_.row_scale[index(i)];
  }
  return PointStatus::ok;
}

PointStatus ArrayLinearization::evaluate_differential(double t, const double* x, const double* xdot) {
  const std::size_t n = index(problem_.n());
  const Arena::Frame frame(arena_);
  double* jet = arena_.take(2 * n);
  std::copy_n(x, n, jet);
  std::copy_n(xdot, n, jet + n);
  const PointStatus status = problem_.residuals(t, jet, 0, data_.f(0));
  if (status != PointStatus::ok) return status;
  for (int i = 0; i < problem_.m(); ++i) data_.f(0)[i] *= -data_.time_scale * data_.row_scale[index(i)];
  return PointStatus::ok;
}

void ArrayLinearization::set_constraints(const Jet& jet, const ArrayResiduals& residuals, RightHandSides rhs) {
  const Units& units = problem_.units();
  const Arena::Frame frame(arena_);
  elimination_.transform(residuals.f, residuals.transformed, arena_);
  data_.least_norm_f = data_.norm(problem_.mu()) * units.largest(jet.x.data(), problem_.n());
  const std::vector<int>& components = problem_.prescribed();
  double* missing = arena_.take(components.size() + 1);
  for (std::size_t q = 0; q < components.size(); ++q) {
    const std::size_t i = index(components[q]);
    missing[q] = (problem_.input_values()[q] - jet.x[i]) / units[i];
  }
  form_.replace_rhs(data_, residuals.transformed, {&components, missing}, arena_, rhs);
  data_.least_norm_f = 0.0;
}

void ArrayLinearization::keep_differential_part(double* z) const {
  const Arena::Frame frame(arena_);
  double* q = arena_.take(index(form_.d) + 1);
  for (int i = 0; i < form_.d; ++i) q[i] = -form_.g0()[i];
  form_.solve_G(q, z, arena_);
}

void ArrayLinearization::change_of_x(const double* z, double* dx) const {
  std::copy_n(form_.xp(), problem_.n(), dx);
  multiply(1.0, Op::plain, form_.T2(), z, 1.0, dx);
}

void ArrayLinearization::apply_change(const ArrayResiduals& residuals, const double* dx, double* dy, Jet& jet) const {
  elimination_.recover(data_, {residuals.f, residuals.transformed}, dx, dy, arena_);
  jet.add_scaled(dx, dy, problem_.jet_order(), data_.time_scale, problem_.units());
}

void ArrayLinearization::copy_step_rows(const double* transformed, double* rows) const {
  multiply(1.0, Op::transposed, form_.Z1(), data_.f(0), 0.0, rows);
  for (int k = 0; k < form_.rank_of_constraints(); ++k)
    rows[form_.d + k] = transformed[form_.constraints().pivots()[k]];
}

// |Z2^T| |derivative array|, row by row of Z2^T, which the elimination stores in factored form.
void ArrayLinearization::measure_constraint_terms() {
  const int rank = form_.rank_of_constraints(), m = problem_.m();
  constraint_terms_.resize(index(rank) * noise_.size());
  std::fill(constraint_terms_.begin(), constraint_terms_.end(), 0.0);
  const Arena::Frame frame(arena_);
  double *unit = arena_.zeros(index(elimination_.carried_rows()) + 1),
         *row = arena_.take(index(problem_.array_rows()) + 1), *terms = constraint_terms_.data();
  for (int r = 0; r < rank; ++r, terms += noise_.size()) {
    const int pivot = form_.constraints().pivots()[r];
    unit[pivot] = 1.0;
    elimination_.transform_transposed(unit, row, arena_);
    unit[pivot] = 0.0;
    for_each_block(data_, problem_.mu(), [&](int level, int k, ConstView block, double factor) {
      for (int j = 0; j < block.cols; ++j) {
        double sum = 0.0;
        for (int i = 0; i < m; ++i) sum += std::fabs(row[level * m + i] * block(i, j));
        terms[k * block.cols + j] += factor * sum;
      }
    });
  }
  renewal_of_terms_ = renewals_;
}

void ArrayLinearization::add_step_terms(const Jet& sizes, const double* xdot, double* rows) {
  if (renewal_of_terms_ != renewals_) measure_constraint_terms();
  const int n = problem_.n(), m = problem_.m();
  const Arena::Frame frame(arena_);
  double *of_jet = arena_.take(noise_.size() + 1), *slopes = arena_.take(index(n) + 1),
         *step = arena_.zeros(index(m) + 1);
  scaled_sizes(sizes, problem_.jet_order(), data_.time_scale, problem_.units(), of_jet);
  const double* terms = constraint_terms_.data();
  for (int k = 0; k < form_.rank_of_constraints(); ++k, terms += noise_.size())
    for (std::size_t j = 0; j < noise_.size(); ++j) rows[form_.d + k] += terms[j] * of_jet[j];
  for (int j = 0; j < n; ++j) slopes[j] = data_.time_scale * std::fabs(xdot[j]) / problem_.units()[j];
  add_sizes(data_.A(0), 1.0, of_jet, step);
  add_sizes(data_.E(0), 1.0, slopes, step);
  for (int k = 0; k < form_.d; ++k)
    for (int i = 0; i < m; ++i) rows[k] += std::fabs(form_.Z1()(i, k)) * step[i];
}

void ArrayLinearization::free_part(double factor, const double* v, double* to) const {
  const int n = problem_.n();
  const Arena::Frame frame(arena_);
  double* scaled = arena_.take(index(n));
  double* along = arena_.take(index(form_.unknowns()));
  for (int i = 0; i < n; ++i) scaled[i] = v[i] / problem_.units()[i];
  multiply(1.0, Op::transposed, form_.T2(), scaled, 0.0, along);
  multiply(factor, Op::transposed, form_.Uz(), along, 0.0, to);
}

void ArrayLinearization::remove_free_part(double* xdot) const {
  if (!is_usable_ || form_.u == 0) return;
  const int n = problem_.n();
  const Units& units = problem_.units();
  const Arena::Frame frame(arena_);
  double* part = arena_.take(index(form_.u));
  double* along = arena_.take(index(form_.unknowns()));
  double* scaled = arena_.take(index(n));
  free_part(1.0, xdot, part);
  multiply(1.0, Op::plain, form_.Uz(), part, 0.0, along);
  for (int i = 0; i < n; ++i) scaled[i] = xdot[i] / units[i];
  multiply(-1.0, Op::plain, form_.T2(), along, 1.0, scaled);
  for (int i = 0; i < n; ++i) xdot[i] = scaled[i] * units[i];
}

PointStatus ArrayLinearization::correct_derivative(double t, const double* x, double* xdot) {
  const PointStatus status = evaluate_differential(t, x, xdot);
  if (status != PointStatus::ok) return status;
  const int n = problem_.n();
  const Arena::Frame frame(arena_);
  double* q = arena_.take(index(form_.d) + 1);
  double* z = arena_.take(index(form_.unknowns()) + 1);
  double* dx = arena_.take(index(n));
  multiply(1.0 / data_.time_scale, Op::transposed, form_.Z1(), data_.f(0), 0.0, q);
  form_.solve_G(q, z, arena_);
  multiply(1.0, Op::plain, form_.T2(), z, 0.0, dx);
  for (int i = 0; i < n; ++i) xdot[i] += dx[i] * problem_.units()[i];
  return PointStatus::ok;
}

void ArrayLinearization::error_in_x(const double* dw, int count, double* dx) const {
  const int m = problem_.m(), n = problem_.n();
  if (!is_usable_ || form_.a + form_.u == 0) {
    // Without constraints, or with unknown ones, all of dw is taken, as w = x.
    std::copy_n(dw, index(n) * index(count), dx);
    return;
  }
  const Units& units = problem_.units();
  const Arena::Frame frame(arena_);
  const View scaled = arena_.matrix(n, count), Ew = arena_.matrix(m, count), q = arena_.matrix(form_.d, count),
             z = arena_.matrix(form_.unknowns(), count);
  for (int j = 0; j < count; ++j)
    for (int i = 0; i < n; ++i) scaled(i, j) = dw[i + j * n] / units[i];
  multiply(1.0, Op::plain, data_.E(0), Op::plain, scaled, 0.0, Ew);
  multiply(1.0, Op::transposed, form_.Z1(), Op::plain, Ew, 0.0, q);
  for (int j = 0; j < count; ++j) form_.solve_G(q.column(j), z.column(j), arena_);
  const View to{dx, n, count, n};
  multiply(1.0, Op::plain, form_.T2(), Op::plain, z, 0.0, to);
  for (int j = 0; j < count; ++j)
    for (int i = 0; i < n; ++i) to(i, j) *= units[i];
}

}  // namespace sfdae::core
