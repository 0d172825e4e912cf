// The strangeness-free system of a linear problem, recomputed at every point.
// SPDX-License-Identifier: BSD-3-Clause
#include "linear/linear_system.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "linear/linear_derivatives.h"
#include "linear/linear_leading_term.h"
#include "problem/failure.h"
#include "reduction/contradiction.h"
#include "reduction/rank_sequence.h"

namespace sfdae::core {

namespace {

SystemTraits traits_of(const LinearProblem& problem, const CharacteristicValues& values, LeadingTerm leading) {
  const int n = problem.n(), num_prescribed = static_cast<int>(problem.prescribed().size());
  return {.unknowns = n,
          .differential = values.d,
          .undetermined = values.u - num_prescribed,
          .leading_size = leading == LeadingTerm::matrix ? problem.m() : n,
          .is_constant = problem.is_constant(),
          .is_linear = true};
}

// P = I needs no derivative of E, nor does a constant E.
bool leading_term_needs_E1(const LinearProblem& problem, const IndexAnalysis& analysis, LeadingTerm leading) {
  return !problem.is_constant_E() && leading != LeadingTerm::identity &&
         !(leading == LeadingTerm::projector && analysis.rank_E == problem.n());
}

// True if an analysis that was read can be one of the problem.
bool is_plausible(const IndexAnalysis& analysis, int m, int n) {
  return fits_dimensions(analysis, m, n) && analysis.rank_E >= 0 && analysis.rank_E <= std::min(m, n) &&
         analysis.noise >= NoiseModel::carried && analysis.noise <= NoiseModel::data;
}

// x = xp + T2 z.
void expand(const NullSpaceForm& form, const double* z, double* x) {
  std::copy_n(form.xp(), form.n, x);
  multiply(1.0, Op::plain, form.T2(), z, 1.0, x);
}

}  // namespace

LinearSystem::LinearSystem(LinearProblem& problem, const AnalysisSettings& settings, IndexAnalysis analysis,
                           LeadingTerm leading)
    : DaeSystem(problem, problem.m(), std::move(analysis), leading),
      problem_(problem),
      settings_(settings),
      reduction_(problem_, settings_, arena_) {
  traits_ = traits_of(problem_, analysis_.values, leading_);
  demand_free_components(problem_.prescribed(), analysis_.values.u);
  resize();
  choose_leading_term(leading_);
}

LinearSystem::LinearSystem(LinearProblem& problem, const AnalysisSettings& settings, Archive& saved)
    : DaeSystem(problem, problem.m(), {}, LeadingTerm::automatic),
      problem_(problem),
      settings_(settings),
      reduction_(problem_, settings_, arena_) {
  archive(saved);
}

void LinearSystem::resize() {
  points_.resize(problem_.m(), problem_.n(), static_cast<int>(problem_.prescribed().size()),
                 analysis_.values.a + analysis_.v_hat);
  reduction_.start(analysis_);
  matrix_.resize(problem_.n());
}

void LinearSystem::archive(Archive& archive) {
  CharacteristicValues& values = analysis_.values;
  RowScaling rows = reduction_.rows();
  // Packed further, so that it fits the smallest arrays of Fortran 77.
  constexpr int num_scalings = 8;
  int scalings = static_cast<int>(rows) + num_scalings * static_cast<int>(analysis_.rows);
  int flags = (analysis_.rank_E_constant ? 1 : 0) + (needs_E1_ ? 2 : 0);
  int count = static_cast<int>(analysis_.certified_ranks.count);
  archive.small(values.mu, values.d, values.a, values.u, values.v, analysis_.v_hat, analysis_.rank_E, analysis_.noise,
                leading_, scalings, flags, count);
  archive_ranks(archive, analysis_.certified_ranks, count);
  archive.real(analysis_.t);
  archive.real(analysis_.time_scale);
  problem_.archive(archive);
  if (archive.is_reading()) {
    rows = static_cast<RowScaling>(scalings % num_scalings);
    analysis_.rows = static_cast<RowScaling>(scalings / num_scalings);
    analysis_.rank_E_constant = (flags & 1) != 0;
    needs_E1_ = (flags & 2) != 0;
    traits_ = traits_of(problem_, values, leading_);
    const bool plausible = is_plausible(analysis_, problem_.m(), problem_.n()) && undetermined() >= 0 &&
                           leading_ >= LeadingTerm::projector && leading_ <= LeadingTerm::identity &&
                           is_row_scaling(rows) && is_row_scaling(analysis_.rows);
    if (!plausible) throw DamagedArchive();
    reduction_.set_rows(rows);
    resize();
  }
  // The point accepted last, which the next one is compared with. Constant matrices are reduced again.
  if (problem_.is_constant()) {
    matrix_.archive_c(archive);
    return;
  }
  if (archive.is_reading()) points_.accept();
  LinearPoint& point = points_.last_accepted();
  archive.small(point.det_sign);
  if (problem_.m() > 1) reduction_.archive_preferred_rows(archive, problem_.m());
  point.form.archive_bases(archive);
  if (!archive.is_reading()) return;
  if (point.form.d != values.d || point.form.u != undetermined()) throw DamagedArchive();
  point.forget();
}

// mu = 0 would need derivatives of E only for the leading term. Throws Failure where E cannot be evaluated.
bool LinearSystem::has_derivative_of_E() {
  if (settings_.orders_up_to_mu_only) return false;
  TaylorData data;
  const CallbackError error = problem_.evaluate_plain(analysis_.t, {1, -1, -1}, data);
  if (error.status != SFDAE_ORDER_MISSING && error.status != SFDAE_OK) error.raise();
  return error.status == SFDAE_OK;
}

void LinearSystem::choose_leading_term(LeadingTerm wanted) {
  LeadingTerm leading = wanted == LeadingTerm::automatic ? LeadingTerm::projector : wanted;
  if (leading == LeadingTerm::projector && !analysis_.rank_E_constant) leading = LeadingTerm::matrix;
  bool needs_E1 = leading_term_needs_E1(problem_, analysis_, leading);
  if (needs_E1 && analysis_.values.mu < 1 && !has_derivative_of_E()) {
    leading = LeadingTerm::identity;
    needs_E1 = false;
  }
  leading_ = leading;
  needs_E1_ = needs_E1;
  traits_ = traits_of(problem_, analysis_.values, leading_);
}

void LinearSystem::give_up_projector() {
  analysis_.rank_E_constant = false;
  choose_leading_term(LeadingTerm::automatic);
  reduction_.forget_constant_form();
  matrix_.forget();
}

PointStatus LinearSystem::move_to(double t) {
  if (reduction_.has_constant_form())
    return reduction_.replace_rhs(t, analysis_.values.mu, points_.current(), callback_error_);
  points_.start_next();
  matrix_.forget();
  traces_.count = 0;
  return reduction_.reduce(t, known(), points_.current(), callback_error_, counts_.reductions);
}

PointQuality LinearSystem::quality() const {
  return {inconsistency(point(), analysis_.values.mu), point().kept_constraints, point().kept_differential,
          point().pivot};
}

std::string LinearSystem::inconsistency_message() const {
  return DaeSystem::inconsistency_message() + named_contradiction({}, nullptr);
}

std::string LinearSystem::named_contradiction(const std::vector<char>& fixed, const double* x) const {
  const LinearProblem::Settings settings = problem_.settings();
  std::string text;
  try {
    const DerivativeArray array = derivative_array(problem_, point().t, analysis_.values.mu);
    const std::string names =
        in_words(contradicting_equations(array, equations(), fixed, x), problem_.equation_names());
    if (!names.empty()) text = " It is " + names + " that cannot hold" + (fixed.empty() ? " together." : " then.");
  } catch (const Failure&) {
    // There is nothing to add.
  }
  problem_.set_settings(settings);
  return text;
}

CharacteristicValues LinearSystem::values_at(double t) { return find_local_values(problem_, t, settings_, arena_); }

void LinearSystem::accept() {
  if (reduction_.has_constant_form()) return;
  LinearPoint& point = points_.current();
  point.det_sign = undetermined() == 0 ? point.sign() : 1;
  reduction_.prefer_rows_of(point);
  points_.accept();
}

bool LinearSystem::orientation_kept() {
  if (reduction_.has_constant_form() || undetermined() > 0 || differential() == 0) return true;
  return core::orientation_kept(points_.reference(), point(), arena_);
}

void LinearSystem::return_to_accepted(double t) {
  if (!reduction_.has_constant_form()) return points_.return_to_accepted();
  // The point was evaluated before: a recoverable callback error is retried once.
  if (move_to(t) != PointStatus::ok && (!callback_error_.is_recoverable() || move_to(t) != PointStatus::ok))
    callback_error_.raise();
}

void LinearSystem::leading(const double* x, double* w) {
  const Arena::Frame frame(arena_);
  apply_leading(leading_, point(), problem_.units().inward(x, arena_.take(index(problem_.n()))), w, arena_);
}

// [c tau G - B; c tau Uz^T] = L U; reused for constant problems as long as c stays.
bool LinearSystem::factor_step_matrix(double c) {
  if (problem_.is_constant() && matrix_.is_for(c)) c = matrix_.c();
  if (reduction_.has_constant_form() && matrix_.is_valid() && matrix_.c() == c) return true;
  return matrix_.factor(point().form, point().data.time_scale, c, counts_.factorizations);
}

PointStatus LinearSystem::solve(const StepEquations& equations, double* x) {
  const double c = equations.c;
  if (!factor_step_matrix(c)) return PointStatus::singular;
  const NullSpaceForm& form = point().form;
  const int size = form.unknowns(), d = form.d;
  const double tau = point().data.time_scale;
  const Arena::Frame frame(arena_);
  double* z = arena_.take(index(size) + 1);
  differential_rows(leading_, point(), equations.w_rest, z, arena_);
  for (int i = 0; i < d; ++i) z[i] = form.b()[i] - tau * (c * form.g0()[i] + z[i]);
  if (form.u > 0) {
    double* free_part = arena_.take(index(size));
    const double* x_rest = problem_.units().inward(equations.x_rest, arena_.take(index(problem_.n())));
    multiply(1.0, Op::transposed, form.T2(), x_rest, 0.0, free_part);
    multiply(-tau, Op::transposed, form.Uz(), free_part, 0.0, z + d);
  }
  matrix_.solve(z);
  expand(form, z, x);
  problem_.units().outward(x);
  return PointStatus::ok;
}

PointStatus LinearSystem::solve_stages(const StageEquations& equations, double* x, double* w, double& t_reached) {
  const int s = equations.method.s, n = problem_.n();
  stages_.resize(s, traits_);
  for (int i = 0; i < s; ++i) {
    const double c = equations.method.c[index(i)];
    t_reached = i == s - 1 ? equations.t_end : equations.t + c * (equations.t_end - equations.t);
    const PointStatus status = move_to(t_reached);
    if (status != PointStatus::ok) return status;
    stages_.keep(i, point(), leading_, arena_);
    if (i < s - 1 && !is_constant()) traces_.of_stage[index(i)].take(point(), orientation_kept());
  }
  traces_.count = is_constant() ? 0 : s - 1;
  const Arena::Frame frame(arena_);
  const double* x_start = problem_.units().inward(equations.x, arena_.take(index(n)));
  if (is_constant()) {
    const double tau = point().data.time_scale, c = equations.method.gamma / (equations.t_end - equations.t);
    if (!factor_step_matrix(c) || !matrix_.factor_stages(point().form, tau, equations.method, counts_.factorizations))
      return PointStatus::singular;
    stages_.solve_decoupled(equations, x_start, {point(), leading_, matrix_}, arena_);
  } else if (!stages_.solve_coupled(equations, x_start, arena_, counts_.factorizations)) {
    return PointStatus::singular;
  }
  for (int i = 0; i < s; ++i) {
    double* x_i = x + static_cast<std::ptrdiff_t>(i) * n;
    double* w_i = w + static_cast<std::ptrdiff_t>(i) * leading_size();
    stages_.expand_x(i, x_i);
    if (is_constant()) apply_leading(leading_, point(), x_i, w_i, arena_);
    else stages_.expand_w(i, w_i);
    problem_.units().outward(x_i);
  }
  return PointStatus::ok;
}

void LinearSystem::error_in_x(const double* dw, int count, double* dx) {
  const NullSpaceForm& form = point().form;
  const int n = problem_.n();
  const Arena::Frame frame(arena_);
  const View q = arena_.matrix(form.d, count), z = arena_.matrix(form.unknowns(), count);
  differential_rows(leading_, point(), {dw, leading_size(), count, leading_size()}, q, arena_);
  for (int k = 0; k < count; ++k) form.solve_G(q.column(k), z.column(k), arena_);
  multiply(1.0, Op::plain, form.T2(), Op::plain, z, 0.0, {dx, n, count, n});
  for (int k = 0; k < count; ++k) problem_.units().outward(dx + static_cast<std::ptrdiff_t>(k) * n);
}

void LinearSystem::restore(const double* w, const double* x_free, const Guess&, double* x) {
  const NullSpaceForm& form = point().form;
  const int size = form.unknowns();
  const Arena::Frame frame(arena_);
  double* q = arena_.take(index(form.d) + 1);
  double* z = arena_.take(index(size) + 1);
  differential_rows(leading_, point(), w, q, arena_);
  for (int i = 0; i < form.d; ++i) q[i] -= form.g0()[i];
  form.solve_G(q, z, arena_);
  if (form.u > 0) {
    double* along = arena_.take(index(size));
    double* free_part = arena_.take(index(form.u));
    x_free = problem_.units().inward(x_free, arena_.take(index(problem_.n())));
    multiply(1.0, Op::transposed, form.T2(), x_free, 0.0, along);
    multiply(1.0, Op::transposed, form.Uz(), along, 0.0, free_part);
    multiply(1.0, Op::plain, form.Uz(), free_part, 1.0, z);
  }
  expand(form, z, x);
  problem_.units().outward(x);
}

void LinearSystem::correct_derivative(double c, const double* x, double* xdot) {
  const Arena::Frame frame(arena_);
  const Units& units = problem_.units();
  const std::size_t n = index(problem_.n());
  std::copy_n(units.inward(xdot, arena_.take(n)), n, xdot);
  correct_scaled_derivative(c, units.inward(x, arena_.take(n)), xdot);
  units.outward(xdot);
}

void LinearSystem::correct_scaled_derivative(double c, const double* x, double* xdot) {
  const TaylorData& data = point().data;
  const NullSpaceForm& form = point().form;
  const int m = problem_.m();
  const Arena::Frame frame(arena_);
  double* h = arena_.take(index(m));
  double* q = arena_.take(index(form.d) + 1);
  double* z = arena_.take(index(form.unknowns()) + 1);
  // E x' = (A x + f) / tau, all in scaled data.
  std::copy_n(data.f(0), m, h);
  multiply(1.0, Op::plain, data.A(0), x, 1.0, h);
  const double per_tau = 1.0 / data.time_scale;
  for (int i = 0; i < m; ++i) h[i] *= per_tau;
  multiply(-1.0, Op::plain, data.E(0), xdot, 1.0, h);
  multiply(1.0, Op::transposed, form.Z1(), h, 0.0, q);
  if (std::isinf(c) || !factor_step_matrix(c)) {
    form.solve_G(q, z, arena_);
  } else {
    // (c tau G - B) z = c tau q: the residual as a step of size 1 / c would damp it.
    for (int i = 0; i < form.d; ++i) z[i] = c * data.time_scale * q[i];
    std::fill_n(z + form.d, form.u, 0.0);
    matrix_.solve(z);
  }
  multiply(1.0, Op::plain, form.T2(), z, 1.0, xdot);
}

bool LinearSystem::exact_derivative(const double* x, double* xdot) {
  const Arena::Frame frame(arena_);
  const double* scaled_x = problem_.units().inward(x, arena_.take(index(problem_.n())));
  if (!derivative_from_array(problem_, {settings_, analysis_, point()}, scaled_x, xdot, {next_level_, arena_}))
    return false;
  problem_.units().outward(xdot);
  return true;
}

bool LinearSystem::consistent_derivative(const double* x, double direction, double* xdot) {
  if (exact_derivative(x, xdot)) return true;
  std::vector<double> buffer(index(problem_.n()));
  const double* scaled_x = problem_.units().inward(x, buffer.data());
  derivative_from_differences(*this, scaled_x, direction, xdot);
  correct_scaled_derivative(std::numeric_limits<double>::infinity(), scaled_x, xdot);
  problem_.units().outward(xdot);
  return false;
}

void LinearSystem::leading_derivative(const double* x, const double* xdot, double* wdot) {
  const Units& units = problem_.units();
  std::vector<double> x_buffer(index(problem_.n())), xdot_buffer(x_buffer);
  apply_leading(leading_, point(), units.inward(xdot, xdot_buffer.data()), wdot, arena_);
  add_derivative_of_leading(known(), point(), units.inward(x, x_buffer.data()), wdot, arena_);
}

void LinearSystem::difference_errors(const double* x, double* errors) {
  const Arena::Frame frame(arena_);
  const std::size_t n = index(problem_.n());
  reduction_.errors_of_x(known(), point(), problem_.units().inward(x, arena_.take(n)), errors);
  problem_.units().outward(errors);
}

}  // namespace sfdae::core
