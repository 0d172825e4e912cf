// The strangeness-free system of a nonlinear problem.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/nonlinear_system.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "problem/failure.h"
#include "reduction/elimination.h"
#include "reduction/rank_reading.h"

namespace sfdae::core {

namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

// Linearizations are renewed, and characteristic values checked, after this many points at the latest.
constexpr int oldest = 10;
// A row factor far from anything that is right.
constexpr double no_preference = 1e300;

}  // namespace

NonlinearSystem::NonlinearSystem(NonlinearProblem& problem, const AnalysisSettings& settings, IndexAnalysis analysis,
                                 std::vector<double> column_scale, const Jet& jet)
    : problem_(problem), settings_(settings), analysis_(std::move(analysis)), column_scale_(std::move(column_scale)) {
  if (undetermined() < 0)
    throw Failure(SFDAE_PRESCRIPTION_SINGULAR,
                  format("%d components are prescribed, but only u = %d are free.",
                         static_cast<int>(problem_.prescribed().size()), analysis_.values.u));
  resize();
  if (stand_at(jet) == PointStatus::trouble) throw Failure(trouble_.status, trouble_.message());
}

NonlinearSystem::NonlinearSystem(NonlinearProblem& problem, const AnalysisSettings& settings, Archive& saved)
    : problem_(problem), settings_(settings) {
  archive(saved);
}

void NonlinearSystem::resize() {
  const std::size_t n = index(problem_.n()), m = index(problem_.m()), levels = index(analysis_.values.mu + 1);
  form_.resize(problem_.m(), problem_.n(), static_cast<int>(problem_.prescribed().size()),
               analysis_.values.a + analysis_.v_hat);
  prescribed_values_.resize(problem_.prescribed().size() + 1);
  matrix_.resize(n * n + 1);
  matrix_pivots_.resize(n + 1);
  for (auto* v : {&F_, &array_f_, &transformed_f_}) v->assign(m * levels + 1, 0.0);
  for (auto* v : {&change_, &xdot_, &z_}) v->assign(n + 1, 0.0);
  y_change_.assign(n * levels + 1, 0.0);
  noise_.assign(n * (levels + 1), 0.0);
  rounding_errors_.assign(n, 0.0);
  for (Jet* jet : {&jet_, &accepted_, &before_, &linearized_}) {
    jet->n = problem_.n();
    jet->set_order(analysis_.values.mu + 1);
  }
}

PointStatus NonlinearSystem::stand_at(const Jet& jet) {
  jet_ = jet;
  jet_.set_order(analysis_.values.mu + 1);
  accepted_ = before_ = jet_;
  rate_ = 1.0;
  trouble_ = problem_.evaluate_prescribed(jet_.t, prescribed_values_.data());
  if (trouble_.status != SFDAE_OK) return PointStatus::trouble;
  return renew(jet_, true);
}

void NonlinearSystem::apply_inputs() {
  if (problem_.prescribed().empty()) return;
  std::vector<double> x(index(problem_.n()));
  restore(nullptr, jet_.x.data(), x.data());
  accepted_ = before_ = jet_;
}

PointStatus NonlinearSystem::move_to(double t) {
  trouble_ = problem_.evaluate_prescribed(t, prescribed_values_.data());
  if (trouble_.status != SFDAE_OK) return PointStatus::trouble;
  if (t == accepted_.t) jet_ = accepted_;
  else if (t != jet_.t) interpolate_jet(t);
  return PointStatus::ok;
}

// Linear between the last two points, good enough to start from.
void NonlinearSystem::interpolate_jet(double t) {
  const double span = accepted_.t - before_.t;
  const double weight = span != 0.0 ? (t - before_.t) / span : 1.0;
  for (std::size_t i = 0; i < jet_.x.size(); ++i)
    jet_.x[i] = before_.x[i] + weight * (accepted_.x[i] - before_.x[i]);
  jet_.t = t;
}

void NonlinearSystem::accept() {
  if (jet_.t != accepted_.t) std::swap(before_, accepted_);
  accepted_ = jet_;
  ++age_;
}

PointStatus NonlinearSystem::renew(const Jet& jet, bool judged) {
  const int mu = analysis_.values.mu;
  age_ = 0;
  if (judged) unjudged_ = 0;
  matrix_valid_ = false;
  transformed_.forget();
  linearized_ = jet;
  is_linearized_ = false;
  linearized_judged_ = judged;
  if (preferred_rows_.empty()) linearized_rows_.assign(index(problem_.m()), no_preference);
  else linearized_rows_ = preferred_rows_;
  const NonlinearProblem::Scaling scaling{analysis_.time_scale, RowScaling::each,
                                          preferred_rows_.empty() ? nullptr : &preferred_rows_, &column_scale_};
  trouble_ = problem_.linearize(jet.t, jet.x.data(), {mu, mu, mu}, scaling, data_);
  if (trouble_.status != SFDAE_OK) return PointStatus::trouble;
  ++reductions_;
  preferred_rows_.assign(data_.row_scale.begin(), data_.row_scale.end());
  const NoiseModel noise = analysis_.noise == NoiseModel::data ? NoiseModel::data : NoiseModel::pivots;
  Judge::Settings judging{settings_.rank_tol, false, noise, nullptr};
  if (!judged) judging.known_ranks = &ranks_;
  Judge judge(data_, mu, judging, nullptr);
  const Arena::Frame frame(arena_);
  const Carried carried = eliminate(data_, mu, data_.f_stack(mu), 1, judge, arena_, &elimination_);
  const PointRanks ranks = form_.build(data_, carried, {&problem_.prescribed(), prescribed_values_.data()},
                                       LeadingTerm::identity, judge, arena_);
  elimination_.mark_determined(determined_);
  kept_constraints_ = judge.kept_constraints();
  kept_differential_ = judge.kept_differential();
  pivot_ = judge.smallest_pivot();
  if (!judge.fits_known_ranks()) return PointStatus::singular;
  const CharacteristicValues& values = analysis_.values;
  const bool has_constraints = ranks.a == values.a && ranks.v_hat == analysis_.v_hat;
  // Prescribed components that are differential take their equations away.
  const bool lacks_equations = judged && has_constraints && ranks.d < values.d && !problem_.prescribed().empty();
  if (!ranks.prescription_fits || lacks_equations)
    throw Failure(SFDAE_PRESCRIPTION_SINGULAR,
                  format("the prescribed components do not determine the free part of the solution at t = %.15g: "
                         "choose others.",
                         jet.t));
  const bool same = has_constraints && ranks.d == values.d && (!judged || stages_rise(judge.ranks(), mu, std::min(data_.m, data_.n)));
  if (same) {
    is_linearized_ = true;
    ranks_ = judge.ranks();
    measure_noise(jet);
    return PointStatus::ok;
  }
  if (!judged) return PointStatus::changed;
  // The cheap estimate of the noise may be too large or too small.
  if (const std::optional<RankList> found = matching_ranks(data_, mu, analysis_, settings_.rank_tol, {arena_, reading_form_})) {
    ranks_ = *found;
    return renew(jet, false);
  }
  JetCoefficients source(problem_, jet, column_scale_);
  if (ranks_.count == 0 || !known_values_hold(source, jet.t, settings_, analysis_, arena_)) return PointStatus::changed;
  return renew(jet, false);
}

// Errors of a rounding of what is added up in each equation, of either sign, go the way of residuals. One sample tells
// their size to some factor.
void NonlinearSystem::measure_noise(const Jet& jet) {
  const int mu = analysis_.values.mu, m = problem_.m(), n = problem_.n();
  const Arena::Frame frame(arena_);
  double* size = arena_.take(index(n) * index(mu + 2));
  double power = 1.0;
  for (int k = 0; k <= mu + 1; ++k) {
    const double factor = k == 0 ? 1.0 : k * (power *= data_.time_scale);
    for (int j = 0; j < n; ++j)
      size[k * n + j] = std::fabs(factor * jet.column(k)[j]) / (column_scale_.empty() ? 1.0 : column_scale_[index(j)]);
  }
  double* errors = arena_.zeros(index(m) * index(mu + 1) + 1);
  const auto add = [&](ConstView block, double factor, const double* values, double* to) {
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < m; ++i) to[i] += factor * std::fabs(block(i, j)) * values[j];
  };
  for (int i = 0; i <= mu; ++i) {
    double* to = errors + static_cast<std::ptrdiff_t>(i) * m;
    if (!data_.is_zero_A(i)) add(data_.A(i), 1.0, size, to);
    for (int k = 1; k <= i + 1; ++k) {
      if (!data_.is_zero_E(i + 1 - k)) add(data_.E(i + 1 - k), 1.0, size + k * n, to);
      if (k <= i && !data_.is_zero_A(i - k)) add(data_.A(i - k), 1.0 / k, size + k * n, to);
    }
    for (int row = 0; row < m; ++row) to[row] *= (row + i) % 2 == 0 ? unit_roundoff : -unit_roundoff;
  }
  std::copy_n(errors, m, data_.f(0));
  elimination_.transform(errors, transformed_f_.data(), arena_);
  const std::vector<int>& components = problem_.prescribed();
  double* none = arena_.zeros(components.size() + 1);
  form_.replace_rhs(data_, transformed_f_.data(), {&components, none}, arena_);
  keep_differential_part();
  std::copy_n(form_.xp(), n, noise_.data());
  multiply(1.0, Op::plain, form_.T2(), z_.data(), 1.0, noise_.data());
  elimination_.recover(data_, {errors, transformed_f_.data()}, noise_.data(), noise_.data() + n, arena_);
  constexpr double samples = 8.0;
  for (double& noise : noise_) noise = samples * std::fabs(noise);
  for (std::size_t j = 0; j < index(n); ++j) rounding_errors_[j] = noise_[j] * (column_scale_.empty() ? 1.0 : column_scale_[j]);
}

// z_: Z1^T E (xp + T2 z) = 0.
void NonlinearSystem::keep_differential_part() {
  const Arena::Frame frame(arena_);
  double* q = arena_.take(index(form_.d) + 1);
  for (int i = 0; i < form_.d; ++i) q[i] = -form_.g0()[i];
  form_.solve_G(q, z_.data(), arena_);
}

// Ranks hold on F_mu = 0 only: pivots that vanish there are as large as the residuals that the iteration has left. With the
// known ranks these become rounding errors in a few iterations, unless the ranks do not hold.
PointStatus NonlinearSystem::renew_judged(const Jet& jet) {
  const PointStatus status = renew(jet, true);
  if (status != PointStatus::changed || ranks_.count == 0) return status;
  polished_ = jet;
  if (renew(jet, false) != PointStatus::ok || iterate(Task{}, polished_) != PointStatus::ok) return status;
  return renew(polished_, true);
}

bool NonlinearSystem::factor_step_matrix(double c) {
  // Steps of one size differ in their last bits, as times are rounded.
  constexpr double rounding_of_steps = 1e-13;
  if (matrix_valid_ && std::fabs(c - matrix_c_) <= rounding_of_steps * std::fabs(c)) return true;
  const int size = form_.unknowns();
  const View M{matrix_.data(), size, size, std::max(size, 1)};
  form_.step_matrix(c * data_.time_scale, M);
  matrix_valid_ = factor_lu(M, matrix_pivots_.data());
  matrix_c_ = c;
  if (size > 0) ++factorizations_;
  return matrix_valid_;
}

PointStatus NonlinearSystem::array_residuals(const Jet& jet, double* f) {
  const int mu = analysis_.values.mu, m = problem_.m();
  trouble_ = problem_.residuals(jet.t, jet.x.data(), mu, f);
  if (trouble_.status != SFDAE_OK) return PointStatus::trouble;
  double power = -1.0;
  for (int k = 0; k <= mu; ++k) {
    power *= data_.time_scale;
    for (int i = 0; i < m; ++i) f[k * m + i] *= power * data_.row_scale[index(i)];
  }
  return PointStatus::ok;
}

PointStatus NonlinearSystem::differential_residuals(double t, const double* x, const double* xdot) {
  const std::size_t n = index(problem_.n());
  const Arena::Frame frame(arena_);
  double* jet = arena_.take(2 * n);
  std::copy_n(x, n, jet);
  std::copy_n(xdot, n, jet + n);
  trouble_ = problem_.residuals(t, jet, 0, data_.f(0));
  if (trouble_.status != SFDAE_OK) return PointStatus::trouble;
  for (int i = 0; i < problem_.m(); ++i) data_.f(0)[i] *= -data_.time_scale * data_.row_scale[index(i)];
  return PointStatus::ok;
}

// The constraints of the form become those for changes of x at the jet; f: its residuals.
void NonlinearSystem::read_constraints(const Jet& jet, const double* f, double* transformed) {
  const Arena::Frame frame(arena_);
  elimination_.transform(f, transformed, arena_);
  double largest = 0.0;
  for (int i = 0; i < problem_.n(); ++i)
    largest = std::max(largest, std::fabs(jet.x[index(i)]) / (column_scale_.empty() ? 1.0 : column_scale_[index(i)]));
  data_.least_norm_f = data_.norm(analysis_.values.mu) * largest;
  const std::vector<int>& components = problem_.prescribed();
  double* missing = arena_.take(components.size() + 1);
  for (std::size_t q = 0; q < components.size(); ++q) {
    const std::size_t i = index(components[q]);
    missing[q] = (prescribed_values_[q] - jet.x[i]) / (column_scale_.empty() ? 1.0 : column_scale_[i]);
  }
  form_.replace_rhs(data_, transformed, {&components, missing}, arena_);
  data_.least_norm_f = 0.0;
}

// dx scaled; y_change_ := the change of y that belongs to it.
void NonlinearSystem::apply_change(const double* dx, const double* f, const double* transformed, Jet& jet) {
  elimination_.recover(data_, {f, transformed}, dx, y_change_.data(), arena_);
  const int n = problem_.n();
  double power = 1.0;
  for (int k = 0; k <= analysis_.values.mu + 1; ++k) {
    const double factor = k == 0 ? 1.0 : 1.0 / (k * (power *= data_.time_scale));
    const double* change = k == 0 ? dx : y_change_.data() + static_cast<std::ptrdiff_t>(k - 1) * n;
    double* to = jet.column(k);
    for (int i = 0; i < n; ++i) to[i] += factor * change[i] * (column_scale_.empty() ? 1.0 : column_scale_[index(i)]);
  }
}

// Of the last change, in units of the tolerance, or relative to x without weights. step: the changes of y count as far as
// they act over it.
double NonlinearSystem::change_norm(const Task& task, const double* dx, const Jet& jet) const {
  const int n = problem_.n();
  const auto unit = [&](int i) { return column_scale_.empty() ? 1.0 : column_scale_[index(i)]; };
  // Rounding errors will not become less.
  const auto above_noise = [&](double change, std::size_t i) { return std::max(0.0, std::fabs(change) - noise_[i]); };
  double norm = 0.0;
  if (task.inverse_weights == nullptr) {
    // y has to follow, if not to the last digits: ranks are read there.
    constexpr double share_of_y = 1e-3;
    double size = 0.0, size_y = 0.0, norm_y = 0.0, power = 1.0;
    for (int i = 0; i < n; ++i) {
      norm = std::max(norm, above_noise(dx[i], index(i)));
      size = std::max(size, std::fabs(jet.x[index(i)]) / unit(i));
    }
    for (int k = 1; k <= analysis_.values.mu + 1; ++k) {
      power *= data_.time_scale;
      for (int i = 0; i < n; ++i) {
        norm_y = std::max(norm_y, above_noise(y_change_[index((k - 1) * n + i)], index(k * n + i)));
        size_y = std::max(size_y, k * power * std::fabs(jet.column(k)[i]) / unit(i));
      }
    }
    return std::max(size > 0.0 ? norm / size : norm, size_y > 0.0 ? share_of_y * norm_y / std::max(size, size_y) : 0.0);
  }
  for (int i = 0; i < n; ++i) norm = std::max(norm, above_noise(dx[i], index(i)) * unit(i) * task.inverse_weights[i]);
  const double ratio = 1.0 / (std::fabs(task.c) * data_.time_scale);
  double power = 1.0;
  for (int k = 1; k <= analysis_.values.mu + 1; ++k) {
    power *= ratio;
    const double* change = y_change_.data() + static_cast<std::ptrdiff_t>(k - 1) * n;
    for (int i = 0; i < n; ++i) norm = std::max(norm, power / k * above_noise(change[i], index(k * n + i)) * unit(i) * task.inverse_weights[i]);
  }
  return norm;
}

// z of M z = b - c tau g0 and, for the free part, -tau Uz^T T2^T (c x + x_rest).
void NonlinearSystem::step_rhs(const Task& task, const Jet& jet, double* z) {
  const double tau = data_.time_scale;
  const int n = problem_.n(), d = form_.d;
  for (int i = 0; i < d; ++i) z[i] = form_.b()[i] - tau * task.c * form_.g0()[i];
  if (form_.u == 0) return;
  const Arena::Frame frame(arena_);
  double* rest = arena_.take(index(n));
  double* along = arena_.take(index(form_.unknowns()));
  for (int i = 0; i < n; ++i)
    rest[i] = (task.c * jet.x[index(i)] + task.x_rest[i]) / (column_scale_.empty() ? 1.0 : column_scale_[index(i)]);
  multiply(1.0, Op::transposed, form_.T2(), rest, 0.0, along);
  multiply(-tau, Op::transposed, form_.Uz(), along, 0.0, z + d);
}

PointStatus NonlinearSystem::iterate(const Task& task, Jet& jet) {
  // Contractions slower than this are given up; iterations at most.
  constexpr double slowest = 0.7;
  const int most = task.has_step ? 12 : 30, n = problem_.n();
  if (task.has_step && !factor_step_matrix(task.c)) return PointStatus::singular;
  double before = 0.0, earlier = 0.0, largest_residual = 0.0;
  is_slow_ = false;
  for (int iteration = 0; iteration < most; ++iteration) {
    PointStatus status = array_residuals(jet, array_f_.data());
    if (status == PointStatus::ok && task.has_step) {
      for (int i = 0; i < n; ++i) xdot_[index(i)] = task.c * jet.x[index(i)] + task.w_rest[i];
      status = differential_residuals(jet.t, jet.x.data(), xdot_.data());
    }
    if (status != PointStatus::ok) return status;
    const double residual = max_abs(array_f_.data(), problem_.m() * (analysis_.values.mu + 1));
    largest_residual = std::max(largest_residual, residual);
    read_constraints(jet, array_f_.data(), transformed_f_.data());
    if (task.has_step) {
      step_rhs(task, jet, z_.data());
      const int size = form_.unknowns();
      solve_lu(ConstView{matrix_.data(), size, size, std::max(size, 1)}, matrix_pivots_.data(), z_.data());
    } else {
      keep_differential_part();
    }
    std::copy_n(form_.xp(), n, change_.data());
    multiply(1.0, Op::plain, form_.T2(), z_.data(), 1.0, change_.data());
    apply_change(change_.data(), array_f_.data(), transformed_f_.data(), jet);
    const double norm = change_norm(task, change_.data(), jet);
    if (!std::isfinite(norm)) return PointStatus::not_converged;
    // Without a step, what one iteration gains the next may lose in part: linearizations are from elsewhere.
    const double reference = task.has_step ? before : std::max(before, earlier);
    if (has_converged(task, iteration, norm, reference) && derivatives_follow(jet, iteration, residual, largest_residual)) {
      read_inconsistency(task, jet);
      // Known ranks may not fit the jet that was linearized.
      const bool is_doubtful = task.has_step && !linearized_judged_ && inconsistency_ > contradiction;
      return is_doubtful ? PointStatus::not_converged : PointStatus::ok;
    }
    if (iteration > 1 && norm > slowest * reference) return PointStatus::not_converged;
    earlier = before;
    before = norm;
  }
  return PointStatus::not_converged;
}

// Residuals that the iteration has left look like contradictions, but vanish when it goes on.
void NonlinearSystem::read_inconsistency(const Task& task, const Jet& jet) {
  const bool is_noise = form_.inconsistency() <= 1e3 * data_.noise(analysis_.values.mu) / pivot_;
  inconsistency_ = is_noise ? 0.0 : form_.inconsistency();
  if (is_noise || task.inverse_weights == nullptr) return;
  polished_ = jet;
  const bool was_slow = is_slow_;
  if (iterate(Task{}, polished_) != PointStatus::ok) inconsistency_ = std::min(inconsistency_, form_.inconsistency());
  is_slow_ = was_slow;
}

// The error left is rate / (1 - rate) times the last change.
bool NonlinearSystem::has_converged(const Task& task, int iteration, double norm, double before) {
  if (task.inverse_weights == nullptr) {
    // To rounding: until changes stop becoming smaller.
    constexpr double negligible = 4.0 * unit_roundoff, small = 1e-13;
    return norm <= negligible || (iteration > 1 && norm <= small && norm > 0.5 * before);
  }
  // Rounding errors of the equations may be all that is left.
  constexpr double negligible = 1e-9;
  if (iteration > 0) rate_ = before > 0.0 ? norm / before : 0.0;
  is_slow_ = iteration >= 3 || (iteration > 0 && rate_ > 0.3 && norm > negligible);
  // A rate from another point is trusted less.
  const double rate = std::clamp(rate_, iteration == 0 ? 0.05 : 1e-3, 0.99);
  // Changes that stop becoming smaller far below the tolerance are rounding errors.
  if (iteration > 1 && norm <= 0.1 * task.tolerance) return true;
  if (iteration > 0 && rate_ >= 1.0) return false;
  return rate / (1.0 - rate) * norm <= task.tolerance || norm <= negligible;
}

// Changes of y count little in short steps. Where they lead nowhere, so that residuals stay, the constraints for x are those
// of a wrong y.
bool NonlinearSystem::derivatives_follow(const Jet& jet, int iteration, double residual, double largest) const {
  constexpr double reduction = 0.5, negligible = 1e-10;
  if (iteration == 0 || residual <= reduction * largest) return true;
  double size = 0.0, power = 1.0;
  for (int k = 0; k <= analysis_.values.mu + 1; ++k) {
    const double factor = k == 0 ? 1.0 : k * (power *= data_.time_scale);
    for (int j = 0; j < problem_.n(); ++j)
      size = std::max(size, factor * std::fabs(jet.column(k)[j]) / (column_scale_.empty() ? 1.0 : column_scale_[index(j)]));
  }
  return residual <= negligible * size * data_.norm(analysis_.values.mu);
}

PointStatus NonlinearSystem::examine() {
  if (unjudged_ == 0 || examined_t_ == jet_.t) return PointStatus::ok;
  PointStatus status = match_known_ranks(jet_);
  if (status == PointStatus::changed) {
    // What the iteration has left as residuals looks like pivots that do not vanish.
    polished_ = jet_;
    const bool was_slow = is_slow_;
    const double rate = rate_;
    if (iterate(Task{}, polished_) == PointStatus::ok) status = match_known_ranks(polished_);
    is_slow_ = was_slow;
    rate_ = rate;
  }
  if (status == PointStatus::changed) {
    JetCoefficients source(problem_, jet_, column_scale_);
    if (known_values_hold(source, jet_.t, settings_, analysis_, arena_)) status = PointStatus::ok;
  }
  if (status == PointStatus::ok) examined_t_ = jet_.t;
  return status;
}

PointStatus NonlinearSystem::match_known_ranks(const Jet& jet) {
  const int mu = analysis_.values.mu;
  const NonlinearProblem::Scaling scaling{analysis_.time_scale, RowScaling::each,
                                          preferred_rows_.empty() ? nullptr : &preferred_rows_, &column_scale_};
  trouble_ = problem_.linearize(jet.t, jet.x.data(), {mu, mu, mu}, scaling, next_data_);
  if (trouble_.status != SFDAE_OK) return PointStatus::trouble;
  return matching_ranks(next_data_, mu, analysis_, settings_.rank_tol, {arena_, reading_form_}) ? PointStatus::ok
                                                                                                : PointStatus::changed;
}

bool NonlinearSystem::is_hopeless(PointStatus status) const {
  return status == PointStatus::changed || (status == PointStatus::trouble && !trouble_.is_recoverable());
}

PointStatus NonlinearSystem::iterate_from_guess(const Task& task) {
  start_ = jet_;
  return iterate_with_renewal(start_, [&] {
    jet_ = start_;
    return iterate(task, jet_);
  });
}

// After a point has converged: the linearization is renewed there where it has become slow; ranks are judged now and then.
PointStatus NonlinearSystem::review(bool renews) {
  ++unjudged_;
  const bool contradicts = inconsistency_ > contradiction;
  if (!(renews && is_slow_) && unjudged_ < oldest && !contradicts) return PointStatus::ok;
  const PointStatus status = renew_judged(jet_);
  rate_ = std::min(rate_, 0.1);
  if (status != PointStatus::ok || !contradicts) return status;
  // A linearization from elsewhere may have left residuals in redundant equations.
  polished_ = jet_;
  const bool was_slow = is_slow_;
  iterate(Task{}, polished_);
  is_slow_ = was_slow;
  return PointStatus::ok;
}

void NonlinearSystem::guess_jet(double t, const Guess& guess, int block, Jet& jet) const {
  const std::size_t size = jet.x.size();
  const double* taylor = guess.taylor + size * index(block);
  const std::size_t n = index(jet.n);
  std::copy_n(taylor, n, jet.x.data());
  jet.t = t;
  if (guess.taylor_at_start != nullptr && before_.t != accepted_.t) {
    guess_between(guess, taylor, jet);
    return;
  }
  // y: that of the last point and what the polynomial says about its change. What no equation determines stays: errors of
  // the polynomial's derivatives would add up there, to 1e24 within hundreds of steps, and drown the rest in rounding.
  // Derivatives that change by more than their size are nothing but errors.
  for (std::size_t k = n; k < size; k += n) {
    double change = 0.0, before = 0.0;
    for (std::size_t i = k; i < k + n; ++i) {
      const double unit = column_scale_.empty() ? 1.0 : column_scale_[i - k];
      jet.x[i] = determined_[i - n] != 0 ? taylor[i] - guess.taylor_before[i] : 0.0;
      change = std::max(change, std::fabs(jet.x[i]) / unit);
      before = std::max(before, std::fabs(accepted_.x[i]) / unit);
    }
    const double trust = change <= before ? 1.0 : 0.0;
    for (std::size_t i = k; i < k + n; ++i) jet.x[i] = accepted_.x[i] + trust * jet.x[i];
  }
}

// y within the last step: that of both its ends, and what the polynomial says about changes since then.
void NonlinearSystem::guess_between(const Guess& guess, const double* taylor, Jet& jet) const {
  const std::size_t n = index(jet.n);
  const double weight = (jet.t - before_.t) / (accepted_.t - before_.t);
  for (std::size_t i = n; i < jet.x.size(); ++i) {
    const double knows = determined_[i - n] != 0 ? 1.0 : 0.0;
    jet.x[i] = (1.0 - weight) * (before_.x[i] + knows * (taylor[i] - guess.taylor_at_start[i])) +
               weight * (accepted_.x[i] + knows * (taylor[i] - guess.taylor_before[i]));
  }
}

PointStatus NonlinearSystem::solve(const StepEquations& equations, double* x) {
  guess_jet(jet_.t, equations.guess, 0, jet_);
  const Task task{true, equations.c, equations.w_rest, equations.x_rest, equations.guess.inverse_weights, newton_tolerance};
  PointStatus status = iterate_from_guess(task);
  if (status == PointStatus::ok) status = review(true);
  std::copy_n(jet_.x.data(), problem_.n(), x);
  return status;
}

void NonlinearSystem::error_in_x(const double* dw, int count, double* dx) {
  const int m = problem_.m(), n = problem_.n();
  const Arena::Frame frame(arena_);
  const View scaled = arena_.matrix(n, count), Ew = arena_.matrix(m, count), q = arena_.matrix(form_.d, count),
             z = arena_.matrix(form_.unknowns(), count);
  const auto unit = [&](int i) { return column_scale_.empty() ? 1.0 : column_scale_[index(i)]; };
  for (int j = 0; j < count; ++j)
    for (int i = 0; i < n; ++i) scaled(i, j) = dw[i + j * n] / unit(i);
  multiply(1.0, Op::plain, data_.E(0), Op::plain, scaled, 0.0, Ew);
  multiply(1.0, Op::transposed, form_.Z1(), Op::plain, Ew, 0.0, q);
  for (int j = 0; j < count; ++j) form_.solve_G(q.column(j), z.column(j), arena_);
  const View to{dx, n, count, n};
  multiply(1.0, Op::plain, form_.T2(), Op::plain, z, 0.0, to);
  for (int j = 0; j < count; ++j)
    for (int i = 0; i < n; ++i) to(i, j) *= unit(i);
}

// What later steps depend on stays as it is: points that are asked for must not change those that follow.
void NonlinearSystem::restore(const double*, const double* x_free, double* x) {
  std::copy_n(x_free, problem_.n(), jet_.x.data());
  start_ = jet_;
  const bool was_slow = is_slow_;
  const PointStatus status = is_linearized_ ? iterate(Task{}, jet_) : PointStatus::not_converged;
  is_slow_ = was_slow;
  if (status == PointStatus::trouble) throw Failure(trouble_.status, trouble_.message());
  if (status != PointStatus::ok && problem_.prescribed().empty()) {
    // Between the ends of a long step the linearization, or derivatives, may be too far off.
    jet_ = start_;
    JetSolver(problem_, column_scale_).solve(jet_, analysis_.values.mu);
  } else if (status != PointStatus::ok) {
    jet_ = start_;
    if (iterate_from_guess(Task{}) != PointStatus::ok)
      throw Failure(SFDAE_NO_CONSISTENT_VALUES,
                    format("no values consistent with the constraints were found at t = %.15g.", jet_.t));
  }
  std::copy_n(jet_.x.data(), problem_.n(), x);
}

}  // namespace sfdae::core
