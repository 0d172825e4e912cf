// The strangeness-free system of a linear problem, reduced anew at every point.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/linear_system.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "problem/taylor_data.h"
#include "reduction/elimination.h"

namespace sfdae::core {

LinearSystem::LinearSystem(LinearProblem& problem, const AnalysisSettings& settings, IndexAnalysis analysis,
                           LeadingTerm leading)
    : DaeSystem(problem, problem.m(), std::move(analysis), leading), problem_(problem), settings_(settings) {
  update_traits();
  if (undetermined() < 0)
    throw Failure(SFDAE_PRESCRIPTION_SINGULAR,
                  format("%d components are prescribed, but only u = %d are free.",
                         static_cast<int>(problem_.prescribed().size()), analysis_.values.u));
  resize();
  choose_leading_term();
}

LinearSystem::LinearSystem(LinearProblem& problem, const AnalysisSettings& settings, Archive& saved)
    : DaeSystem(problem, problem.m(), {}, LeadingTerm::automatic), problem_(problem), settings_(settings) {
  archive(saved);
}

void LinearSystem::update_traits() {
  const int n = problem_.n(), num_prescribed = static_cast<int>(problem_.prescribed().size());
  traits_ = {.unknowns = n,
             .differential = analysis_.values.d,
             .undetermined = analysis_.values.u - num_prescribed,
             .leading_size = leading_ == LeadingTerm::matrix ? problem_.m() : n,
             .is_constant = problem_.is_constant(),
             .is_linear = true};
}

void LinearSystem::resize() {
  const int num_prescribed = static_cast<int>(problem_.prescribed().size());
  for (Point& point : points_)
    point.form.resize(problem_.m(), problem_.n(), num_prescribed, analysis_.values.a + analysis_.v_hat);
  prescribed_values_.resize(problem_.prescribed().size() + 1);
  matrix_.resize(problem_.n());
  // Where ranks are only compared with those known, the cheaper model comes first.
  noise_ = analysis_.noise == NoiseModel::data ? NoiseModel::data : NoiseModel::pivots;
}

void LinearSystem::archive(Archive& archive) {
  CharacteristicValues& values = analysis_.values;
  archive.small(values.mu, values.d, values.a, values.u, values.v, analysis_.v_hat, analysis_.rank_E, analysis_.noise,
                analysis_.rank_E_constant, leading_, rows_, needs_E1_);
  archive.real(analysis_.t);
  archive.real(analysis_.time_scale);
  problem_.archive(archive);
  if (archive.is_reading()) {
    update_traits();
    const int m = problem_.m(), n = problem_.n(), rank_bound = std::min(m, n);
    const bool plausible =
        values.mu >= 0 && values.mu <= max_derivative_order && values.d >= 0 && values.a >= 0 &&
        values.d + values.a + values.v == m && values.d + values.a + values.u == n && undetermined() >= 0 &&
        analysis_.rank_E >= 0 && analysis_.rank_E <= rank_bound && analysis_.v_hat >= 0 &&
        analysis_.v_hat <= (values.mu + 1) * m && std::isfinite(analysis_.time_scale) && analysis_.time_scale > 0.0 &&
        leading_ >= LeadingTerm::projector && leading_ <= LeadingTerm::identity && rows_ >= RowScaling::each &&
        rows_ <= RowScaling::common && analysis_.noise >= NoiseModel::carried && analysis_.noise <= NoiseModel::data;
    if (!plausible) throw DamagedArchive();
    resize();
  }
  // The point accepted last, as the next one is compared with it. Constant matrices are reduced anew.
  if (problem_.is_constant()) {
    matrix_.archive_c(archive);
    return;
  }
  if (archive.is_reading()) accepted_ = true;
  Point& point = accepted_ ? current() : reference();
  archive.small(point.det_sign);
  if (problem_.m() > 1) archive.reals(preferred_rows_, index(problem_.m()));
  point.form.archive_bases(archive);
  if (!archive.is_reading()) return;
  if (point.form.d != values.d || point.form.u != undetermined()) throw DamagedArchive();
  point.t = std::numeric_limits<double>::quiet_NaN();
}

void LinearSystem::choose_leading_term() {
  if (leading_ == LeadingTerm::automatic)
    leading_ = analysis_.rank_E_constant ? LeadingTerm::projector : LeadingTerm::matrix;
  if (leading_ == LeadingTerm::projector && !analysis_.rank_E_constant) leading_ = LeadingTerm::matrix;
  // P = I needs no derivative of E, nor does a constant E.
  const bool wants_E1 = !problem_.is_constant_E() && leading_ != LeadingTerm::identity &&
                        !(leading_ == LeadingTerm::projector && analysis_.rank_E == problem_.n());
  needs_E1_ = wants_E1;
  update_traits();
  if (!wants_E1 || analysis_.values.mu >= 1) return;
  if (settings_.orders_up_to_mu_only) {
    leading_ = LeadingTerm::identity;
    needs_E1_ = false;
    update_traits();
    return;
  }
  // mu = 0 would not need derivatives otherwise: do without where there are none.
  TaylorData data;
  const CallbackError error = problem_.evaluate_plain(analysis_.t, {1, -1, -1}, data);
  if (error.status == SFDAE_ORDER_MISSING) {
    leading_ = LeadingTerm::identity;
    needs_E1_ = false;
    update_traits();
  } else if (error.status != SFDAE_OK) {
    throw Failure(error.status, error.message());
  }
}

void LinearSystem::give_up_projector() {
  analysis_.rank_E_constant = false;
  leading_ = LeadingTerm::automatic;
  choose_leading_term();
  constant_ready_ = false;
  matrix_.forget();
}

Orders LinearSystem::orders() const {
  const int mu = analysis_.values.mu;
  return {std::max(mu, needs_E1_ ? 1 : 0), mu, mu};
}

void LinearSystem::scale_prescribed_values() {
  if (problem_.units().are_one()) return;
  for (std::size_t i = 0; i < problem_.prescribed().size(); ++i)
    prescribed_values_[i] /= problem_.units()[problem_.prescribed()[i]];
}

PointStatus LinearSystem::reduce(double t, double time_scale, Point& point, RowScaling rows) {
  const int mu = analysis_.values.mu;
  point.t = std::numeric_limits<double>::quiet_NaN();  // until it is complete
  callback_error_ = problem_.evaluate(t, orders(), time_scale, point.data, rows,
                                      preferred_rows_.empty() ? nullptr : &preferred_rows_);
  if (callback_error_.status == SFDAE_OK)
    callback_error_ = problem_.evaluate_prescribed(t, prescribed_values_.data());
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  scale_prescribed_values();
  ++counts_.reductions;
  const Judge::Settings judging{settings_.rank_tol, settings_.by_svd, noise_};
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
                                            leading_, judge, arena_);
  point.t = t;
  point.kept_constraints = judge.kept_constraints();
  point.kept_differential = judge.kept_differential();
  point.pivot = judge.smallest_pivot();
  const CharacteristicValues& values = analysis_.values;
  if (ranks.a != values.a || ranks.v_hat != analysis_.v_hat) return PointStatus::changed;
  if (!ranks.prescription_fits || (ranks.d != values.d && !problem_.prescribed().empty()))
    throw Failure(SFDAE_PRESCRIPTION_SINGULAR,
                  format("the prescribed components do not determine the free part of the solution at t = %.15g: "
                         "choose others.",
                         t));
  if (ranks.d != values.d) return PointStatus::changed;
  if (leading_ == LeadingTerm::projector && ranks.rank_E != analysis_.rank_E) return PointStatus::leading_changed;
  return PointStatus::ok;
}

// E and A stay; only f is read and transformed.
PointStatus LinearSystem::reduce_constant(double t, Point& point) {
  const int mu = analysis_.values.mu;
  point.t = std::numeric_limits<double>::quiet_NaN();
  callback_error_ = problem_.evaluate_plain(t, {-1, -1, mu}, rhs_);
  if (callback_error_.status == SFDAE_OK)
    callback_error_ = problem_.evaluate_prescribed(t, prescribed_values_.data());
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  scale_prescribed_values();
  double factor = 1.0;
  for (int k = 0; k <= mu; ++k) {
    factor *= point.data.time_scale / std::max(k, 1);
    for (int i = 0; i < problem_.m(); ++i)
      point.data.f(k)[i] = rhs_.f(k)[i] * factor * point.data.row_scale[index(i)];
  }
  const Arena::Frame frame(arena_);
  double* f_hat = arena_.take(index(Zt_.rows()) + 1);
  multiply(1.0, Op::plain, Zt_, point.data.f(0), 0.0, f_hat);
  point.form.replace_rhs(point.data, f_hat, {&problem_.prescribed(), prescribed_values_.data()}, arena_);
  point.t = t;
  return PointStatus::ok;
}

PointStatus LinearSystem::move_to(double t) {
  if (constant_ready_) return reduce_constant(t, current());
  if (accepted_) current_ = 1 - current_;
  accepted_ = false;
  matrix_.forget();
  num_stage_traces_ = 0;
  PointStatus status = reduce(t, analysis_.time_scale, current(), rows_);
  // Before the values are declared to have changed: rows that are small by cancellation must not be scaled up, and
  // data that have grown or shrunk may need another time scale.
  if (status == PointStatus::changed) status = reduce(t, analysis_.time_scale, current(), RowScaling::common);
  // The other ways to take noise into account; without propagation it has to be measured.
  const NoiseModel first = noise_;
  for (NoiseModel model : {NoiseModel::carried, NoiseModel::pivots, NoiseModel::data}) {
    if (status != PointStatus::changed || model == first) continue;
    noise_ = model;
    if (model != NoiseModel::data ||
        (problem_.prescribed().empty() && known_values_hold(problem_, t, settings_, analysis_, arena_)))
      status = reduce(t, analysis_.time_scale, current(), rows_);
  }
  noise_ = first;
  for (double factor : {1.0, 0.125}) {
    if (status != PointStatus::changed || settings_.time_scale > 0.0) break;
    TaylorData& data = current().data;
    callback_error_ = problem_.evaluate(t, orders(), 0.0, data);
    if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
    status = reduce(t, data.time_scale * factor, current(), rows_);
  }
  if (status != PointStatus::ok || !problem_.is_constant()) return status;
  // The same operations at every point: whether this is the first one does not show in any bit.
  constant_ready_ = true;
  return reduce_constant(t, current());
}

double LinearSystem::row_ratio() const {
  const double here = data().row_scale_ratio();
  if (preferred_rows_.empty()) return here;
  const auto [smallest, largest] = std::minmax_element(preferred_rows_.begin(), preferred_rows_.end());
  return std::min(here, *largest / *smallest);
}

PointQuality LinearSystem::quality() const {
  const Point& point = current();
  return {inconsistency(), point.kept_constraints, point.kept_differential, point.pivot};
}

CharacteristicValues LinearSystem::values_at(double t) { return find_local_values(problem_, t, settings_, arena_); }

double LinearSystem::inconsistency() const {
  // Rounding errors and errors of derivatives, carried on by the elimination; three digits of safety.
  const int mu = analysis_.values.mu;
  const double noise = std::max(current().data.noise(mu), current().data.noise_f(mu)) / current().pivot;
  const double found = current().form.inconsistency();
  return found > 1e3 * noise ? found : 0.0;
}

void LinearSystem::leading(const double* x, double* w) {
  const Arena::Frame frame(arena_);
  leading_of(inward(x, arena_.take(index(problem_.n()))), w);
}

void LinearSystem::leading_of(const double* x, double* w) {
  const Point& point = current();
  if (leading_ == LeadingTerm::matrix) {
    multiply(1.0, Op::plain, point.data.E(0), x, 0.0, w);
    for (int i = 0; i < problem_.m(); ++i) w[i] /= point.data.row_scale[index(i)];
    return;
  }
  std::copy_n(x, problem_.n(), w);
  if (leading_ == LeadingTerm::projector) point.form.project(w, arena_);
}

void LinearSystem::differential_rows(const double* w, double* q) {
  const TaylorData& data = current().data;
  const Arena::Frame frame(arena_);
  double* Ew = arena_.take(index(data.m));
  if (leading_ == LeadingTerm::matrix)
    for (int i = 0; i < data.m; ++i) Ew[i] = w[i] * data.row_scale[index(i)];
  else multiply(1.0, Op::plain, data.E(0), w, 0.0, Ew);
  multiply(1.0, Op::transposed, current().form.Z1(), Ew, 0.0, q);
}

// [c tau G - B; c tau Uz^T] = L U; kept for constant problems as long as c stays.
bool LinearSystem::factor_step_matrix(double c) {
  if (problem_.is_constant() && matrix_.is_for(c)) c = matrix_.c();
  if (constant_ready_ && matrix_.is_valid() && matrix_.c() == c) return true;
  return matrix_.factor(current().form, current().data.time_scale, c, counts_.factorizations);
}

PointStatus LinearSystem::solve(const StepEquations& equations, double* x) {
  const double c = equations.c;
  if (!factor_step_matrix(c)) return PointStatus::singular;
  const Point& point = current();
  const NullSpaceForm& form = point.form;
  const int size = form.unknowns(), d = form.d, n = problem_.n();
  const double tau = point.data.time_scale;
  const Arena::Frame frame(arena_);
  double* z = arena_.take(index(size) + 1);
  differential_rows(equations.w_rest, z);
  for (int i = 0; i < d; ++i) z[i] = form.b()[i] - tau * (c * form.g0()[i] + z[i]);
  if (form.u > 0) {
    double* free_part = arena_.take(index(size));
    const double* x_rest = inward(equations.x_rest, arena_.take(index(n)));
    multiply(1.0, Op::transposed, form.T2(), x_rest, 0.0, free_part);
    multiply(-tau, Op::transposed, form.Uz(), free_part, 0.0, z + d);
  }
  matrix_.solve(z);
  std::copy_n(form.xp(), n, x);
  multiply(1.0, Op::plain, form.T2(), z, 1.0, x);
  outward(x);
  return PointStatus::ok;
}

void LinearSystem::error_in_x(const double* dw, int count, double* dx) {
  const NullSpaceForm& form = current().form;
  const TaylorData& data = current().data;
  const int m = problem_.m(), n = problem_.n();
  const Arena::Frame frame(arena_);
  const View Ew = arena_.matrix(m, count), q = arena_.matrix(form.d, count),
             z = arena_.matrix(form.unknowns(), count);
  const ConstView w{dw, leading_size(), count, leading_size()};
  if (leading_ == LeadingTerm::matrix) {
    for (int k = 0; k < count; ++k)
      for (int i = 0; i < m; ++i) Ew(i, k) = w(i, k) * data.row_scale[index(i)];
  } else {
    multiply(1.0, Op::plain, data.E(0), Op::plain, w, 0.0, Ew);
  }
  multiply(1.0, Op::transposed, form.Z1(), Op::plain, Ew, 0.0, q);
  for (int k = 0; k < count; ++k) form.solve_G(q.column(k), z.column(k), arena_);
  multiply(1.0, Op::plain, form.T2(), Op::plain, z, 0.0, {dx, n, count, n});
  for (int k = 0; k < count; ++k) outward(dx + static_cast<std::ptrdiff_t>(k) * n);
}

void LinearSystem::restore(const double* w, const double* x_free, double* x) {
  const NullSpaceForm& form = current().form;
  const int n = problem_.n(), size = form.unknowns();
  const Arena::Frame frame(arena_);
  double* q = arena_.take(index(form.d) + 1);
  double* z = arena_.take(index(size) + 1);
  differential_rows(w, q);
  for (int i = 0; i < form.d; ++i) q[i] -= form.g0()[i];
  form.solve_G(q, z, arena_);
  if (form.u > 0) {
    double* along = arena_.take(index(size));
    double* free_part = arena_.take(index(form.u));
    x_free = inward(x_free, arena_.take(index(n)));
    multiply(1.0, Op::transposed, form.T2(), x_free, 0.0, along);
    multiply(1.0, Op::transposed, form.Uz(), along, 0.0, free_part);
    multiply(1.0, Op::plain, form.Uz(), free_part, 1.0, z);
  }
  std::copy_n(form.xp(), n, x);
  multiply(1.0, Op::plain, form.T2(), z, 1.0, x);
  outward(x);
}

void LinearSystem::correct_derivative(double c, const double* x, double* xdot) {
  const Arena::Frame frame(arena_);
  const std::size_t n = index(problem_.n());
  std::copy_n(inward(xdot, arena_.take(n)), n, xdot);
  correct_scaled_derivative(c, inward(x, arena_.take(n)), xdot);
  outward(xdot);
}

void LinearSystem::correct_scaled_derivative(double c, const double* x, double* xdot) {
  const Point& point = current();
  const NullSpaceForm& form = point.form;
  const Arena::Frame frame(arena_);
  double* h = arena_.take(index(problem_.m()));
  double* q = arena_.take(index(form.d) + 1);
  double* z = arena_.take(index(form.unknowns()) + 1);
  // E x' = (A x + f) / tau, all in scaled data.
  std::copy_n(point.data.f(0), problem_.m(), h);
  multiply(1.0, Op::plain, point.data.A(0), x, 1.0, h);
  const double per_tau = 1.0 / point.data.time_scale;
  for (int i = 0; i < problem_.m(); ++i) h[i] *= per_tau;
  multiply(-1.0, Op::plain, point.data.E(0), xdot, 1.0, h);
  multiply(1.0, Op::transposed, form.Z1(), h, 0.0, q);
  if (std::isinf(c) || !factor_step_matrix(c)) {
    form.solve_G(q, z, arena_);
  } else {
    // (c tau G - B) z = c tau q: the residual as a step of size 1 / c would damp it.
    for (int i = 0; i < form.d; ++i) z[i] = c * point.data.time_scale * q[i];
    std::fill_n(z + form.d, form.u, 0.0);
    matrix_.solve(z);
  }
  multiply(1.0, Op::plain, form.T2(), z, 1.0, xdot);
}

void LinearSystem::accept() {
  if (constant_ready_) return;
  current().det_sign = undetermined() == 0 ? current().form.sign_of_G() : 1;
  preferred_rows_.assign(current().data.row_scale.begin(), current().data.row_scale.end());
  accepted_ = true;
}

bool LinearSystem::orientation_kept() {
  if (constant_ready_ || undetermined() > 0 || differential() == 0) return true;
  const NullSpaceForm& now = current().form;
  const NullSpaceForm& then = reference().form;
  const Arena::Frame frame(arena_);
  const View K = arena_.matrix(now.d, now.d), T = arena_.matrix(now.d, now.d);
  multiply(1.0, Op::transposed, then.Z1(), Op::plain, now.Z1(), 0.0, K);
  multiply(1.0, Op::transposed, then.T2(), Op::plain, now.T2(), 0.0, T);
  const int aligned = determinant_sign(K, arena_) * determinant_sign(T, arena_) * now.sign_of_G();
  return aligned == reference().det_sign;
}

}  // namespace sfdae::core
