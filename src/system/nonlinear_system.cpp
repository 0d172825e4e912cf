// The strangeness-free system of a nonlinear problem.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/nonlinear_system.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "reduction/elimination.h"
#include "reduction/rank_sequence.h"

namespace sfdae::core {

namespace {

// Linearizations are renewed, and characteristic values checked, after this many points at the latest.
constexpr int oldest = 10;
// A row factor far from anything that is right.
constexpr double no_preference = 1e300;

}  // namespace

NonlinearSystem::NonlinearSystem(NonlinearProblem& problem, const AnalysisSettings& settings, IndexAnalysis analysis,
                                 Units units, const Jet& jet)
    : DaeSystem(problem, problem.m(), std::move(analysis), LeadingTerm::identity),
      problem_(problem),
      settings_(settings),
      units_(std::move(units)) {
  update_traits();
  if (undetermined() < 0)
    throw Failure(SFDAE_PRESCRIPTION_SINGULAR,
                  format("%d components are prescribed, but only u = %d are free.",
                         static_cast<int>(problem_.prescribed().size()), analysis_.values.u));
  resize();
  if (set_point(jet) == PointStatus::callback_error) throw Failure(callback_error_.status, callback_error_.message());
}

NonlinearSystem::NonlinearSystem(NonlinearProblem& problem, const AnalysisSettings& settings, Archive& saved)
    : DaeSystem(problem, problem.m(), {}, LeadingTerm::identity), problem_(problem), settings_(settings) {
  archive(saved);
}

void NonlinearSystem::update_traits() {
  traits_ = {.unknowns = problem_.n(),
             .differential = analysis_.values.d,
             .undetermined = analysis_.values.u - static_cast<int>(problem_.prescribed().size()),
             .leading_size = problem_.n(),
             .taylor_order = analysis_.values.mu + 1};
}

CharacteristicValues NonlinearSystem::values_at(double) {
  ConsistentJets jets(problem_, jet_.t, jet_.x.data(), {});
  Arena arena;
  return find_local_values(jets, jet_.t, settings_, arena);
}

void NonlinearSystem::resize() {
  const std::size_t n = index(problem_.n()), m = index(problem_.m()), levels = index(analysis_.values.mu + 1);
  form_.resize(problem_.m(), problem_.n(), static_cast<int>(problem_.prescribed().size()),
               analysis_.values.a + analysis_.v_hat);
  prescribed_values_.resize(problem_.prescribed().size() + 1);
  matrix_.resize(problem_.n());
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

PointStatus NonlinearSystem::set_point(const Jet& jet) {
  jet_ = jet;
  jet_.set_order(analysis_.values.mu + 1);
  accepted_ = before_ = jet_;
  chord_.forget_rate();
  callback_error_ = problem_.evaluate_prescribed(jet_.t, prescribed_values_.data());
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  return renew(jet_, true);
}

void NonlinearSystem::apply_inputs() {
  if (problem_.prescribed().empty()) return;
  std::vector<double> x(index(problem_.n()));
  restore(nullptr, jet_.x.data(), x.data());
  accepted_ = before_ = jet_;
}

PointStatus NonlinearSystem::move_to(double t) {
  callback_error_ = problem_.evaluate_prescribed(t, prescribed_values_.data());
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  if (t == accepted_.t) jet_ = accepted_;
  else if (t != jet_.t) interpolate_jet(t);
  return PointStatus::ok;
}

// Linear between the last two points, good enough to start from.
void NonlinearSystem::interpolate_jet(double t) {
  const double span = accepted_.t - before_.t;
  const double weight = span != 0.0 ? (t - before_.t) / span : 1.0;
  for (std::size_t i = 0; i < jet_.x.size(); ++i) jet_.x[i] = before_.x[i] + weight * (accepted_.x[i] - before_.x[i]);
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
  matrix_.forget();
  linearized_ = jet;
  is_linearized_ = false;
  linearized_judged_ = judged;
  if (preferred_rows_.empty()) linearized_rows_.assign(index(problem_.m()), no_preference);
  else linearized_rows_ = preferred_rows_;
  const NonlinearProblem::Scaling scaling{analysis_.time_scale, RowScaling::each,
                                          preferred_rows_.empty() ? nullptr : &preferred_rows_, &units_};
  callback_error_ = problem_.linearize(jet.t, jet.x.data(), {mu, mu, mu}, scaling, data_);
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  ++counts_.reductions;
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
  const bool is_plausible =
      !judged || !data_.differentiations.empty() || stages_rise(judge.ranks(), mu, std::min(data_.m, data_.n));
  const bool same = has_constraints && ranks.d == values.d && is_plausible;
  if (same) {
    is_linearized_ = true;
    ranks_ = judge.ranks();
    measure_noise(jet);
    return PointStatus::ok;
  }
  if (!judged) return PointStatus::changed;
  // The cheap estimate of the noise may be too large or too small.
  if (const std::optional<RankSequence> found =
          matching_ranks(data_, mu, analysis_, settings_.rank_tol, {arena_, rank_form_})) {
    ranks_ = *found;
    return renew(jet, false);
  }
  JetCoefficients source(problem_, jet, units_);
  if (ranks_.count == 0 || !known_values_hold(source, jet.t, settings_, analysis_, arena_))
    return PointStatus::changed;
  return renew(jet, false);
}

// Errors of a rounding of what is added up in each equation, of either sign, go the way of residuals. One sample
// tells their size to some factor.
void NonlinearSystem::measure_noise(const Jet& jet) {
  const int mu = analysis_.values.mu, m = problem_.m(), n = problem_.n();
  const Arena::Frame frame(arena_);
  double* size = arena_.take(index(n) * index(mu + 2));
  double power = 1.0;
  for (int k = 0; k <= mu + 1; ++k) {
    const double factor = k == 0 ? 1.0 : k * (power *= data_.time_scale);
    for (int j = 0; j < n; ++j) size[k * n + j] = std::fabs(factor * jet.column(k)[j]) / units_[j];
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
  for (std::size_t j = 0; j < index(n); ++j) rounding_errors_[j] = noise_[j] * units_[j];
}

// z_: Z1^T E (xp + T2 z) = 0.
void NonlinearSystem::keep_differential_part() {
  const Arena::Frame frame(arena_);
  double* q = arena_.take(index(form_.d) + 1);
  for (int i = 0; i < form_.d; ++i) q[i] = -form_.g0()[i];
  form_.solve_G(q, z_.data(), arena_);
}

// Ranks hold on F_mu = 0 only: pivots that vanish there are as large as the residuals that the iteration has left.
// With the known ranks these become rounding errors in a few iterations, unless the ranks do not hold.
PointStatus NonlinearSystem::renew_judged(const Jet& jet) {
  const PointStatus status = renew(jet, true);
  if (status != PointStatus::changed || ranks_.count == 0) return status;
  polished_ = jet;
  if (renew(jet, false) != PointStatus::ok || iterate(Task{}, polished_) != PointStatus::ok) return status;
  return renew(polished_, true);
}

PointStatus NonlinearSystem::check_ranks() {
  if (unjudged_ == 0 || checked_t_ == jet_.t) return PointStatus::ok;
  PointStatus status = match_known_ranks(jet_);
  if (status == PointStatus::changed) {
    // What the iteration has left as residuals looks like pivots that do not vanish.
    polished_ = jet_;
    const ChordIteration chord = chord_;
    if (iterate(Task{}, polished_) == PointStatus::ok) status = match_known_ranks(polished_);
    chord_ = chord;
  }
  if (status == PointStatus::changed) {
    JetCoefficients source(problem_, jet_, units_);
    if (known_values_hold(source, jet_.t, settings_, analysis_, arena_)) status = PointStatus::ok;
  }
  if (status == PointStatus::ok) checked_t_ = jet_.t;
  return status;
}

PointStatus NonlinearSystem::match_known_ranks(const Jet& jet) {
  const int mu = analysis_.values.mu;
  const NonlinearProblem::Scaling scaling{analysis_.time_scale, RowScaling::each,
                                          preferred_rows_.empty() ? nullptr : &preferred_rows_, &units_};
  callback_error_ = problem_.linearize(jet.t, jet.x.data(), {mu, mu, mu}, scaling, next_data_);
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  return matching_ranks(next_data_, mu, analysis_, settings_.rank_tol, {arena_, rank_form_}) ? PointStatus::ok
                                                                                             : PointStatus::changed;
}

PointStatus NonlinearSystem::iterate_from_guess(const Task& task) {
  start_ = jet_;
  return iterate_with_renewal(start_, [&] {
    jet_ = start_;
    return iterate(task, jet_);
  });
}

// After a point has converged: the linearization is renewed there where it has become slow; ranks are judged now and
// then.
PointStatus NonlinearSystem::review(bool renews) {
  ++unjudged_;
  const bool contradicts = inconsistency_ > contradiction;
  if (!(renews && chord_.is_slow()) && unjudged_ < oldest && !contradicts) return PointStatus::ok;
  const PointStatus status = renew_judged(jet_);
  chord_.set_rate(std::min(chord_.rate(), 0.1));
  if (status != PointStatus::ok || !contradicts) return status;
  // A linearization from elsewhere may have left residuals in redundant equations.
  polished_ = jet_;
  const bool was_slow = chord_.is_slow();
  iterate(Task{}, polished_);
  chord_.set_slow(was_slow);
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
  // y: that of the last point and what the polynomial says about its change. What no equation determines stays:
  // errors of the polynomial's derivatives would add up there, to 1e24 within hundreds of steps, and drown the rest
  // in rounding. Derivatives that change by more than their size are nothing but errors.
  for (std::size_t k = n; k < size; k += n) {
    double change = 0.0, before = 0.0;
    for (std::size_t i = k; i < k + n; ++i) {
      const double unit = units_[i - k];
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
  const Task task{
      true, equations.c, equations.w_rest, equations.x_rest, equations.guess.inverse_weights, newton_tolerance};
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
  for (int j = 0; j < count; ++j)
    for (int i = 0; i < n; ++i) scaled(i, j) = dw[i + j * n] / units_[i];
  multiply(1.0, Op::plain, data_.E(0), Op::plain, scaled, 0.0, Ew);
  multiply(1.0, Op::transposed, form_.Z1(), Op::plain, Ew, 0.0, q);
  for (int j = 0; j < count; ++j) form_.solve_G(q.column(j), z.column(j), arena_);
  const View to{dx, n, count, n};
  multiply(1.0, Op::plain, form_.T2(), Op::plain, z, 0.0, to);
  for (int j = 0; j < count; ++j)
    for (int i = 0; i < n; ++i) to(i, j) *= units_[i];
}

// What later steps depend on stays as it is: points that are asked for must not change those that follow.
void NonlinearSystem::restore(const double*, const double* x_free, double* x) {
  std::copy_n(x_free, problem_.n(), jet_.x.data());
  start_ = jet_;
  const bool was_slow = chord_.is_slow();
  const PointStatus status = is_linearized_ ? iterate(Task{}, jet_) : PointStatus::not_converged;
  chord_.set_slow(was_slow);
  if (status == PointStatus::callback_error) throw Failure(callback_error_.status, callback_error_.message());
  if (status != PointStatus::ok && problem_.prescribed().empty()) {
    // Between the ends of a long step the linearization, or derivatives, may be too far off.
    jet_ = start_;
    JetSolver(problem_, units_).solve(jet_, analysis_.values.mu);
  } else if (status != PointStatus::ok) {
    jet_ = start_;
    if (iterate_from_guess(Task{}) != PointStatus::ok)
      throw Failure(SFDAE_NO_CONSISTENT_VALUES,
                    format("no values consistent with the constraints were found at t = %.15g.", jet_.t));
  }
  std::copy_n(jet_.x.data(), problem_.n(), x);
}

}  // namespace sfdae::core
