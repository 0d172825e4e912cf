// x' of the solution of a nonlinear problem, from the derivative array of level mu + 1; checkpoints.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "reduction/elimination.h"
#include "reduction/rank_sequence.h"
#include "system/nonlinear_system.h"

namespace sfdae::core {

// y of F_{mu+1}(t, x, y) = 0 for the given x; y_1 = x' is determined but for free directions.
bool NonlinearSystem::solve_next_level(const double* x) {
  const int level = analysis_.values.mu + 1, n = problem_.n(), m = problem_.m();
  if (has_next_level_ == Availability::no) return false;
  const bool continues = next_jet_.order == level + 1 && next_jet_.n == n;
  Jet& next = next_trial_;
  next = jet_;
  next.set_order(level + 1);
  if (continues) std::copy_n(next_jet_.column(level + 1), n, next.column(level + 1));
  std::copy_n(x, n, next.column(0));
  std::vector<double>&transformed = next_transformed_, &change = next_change_;
  transformed.resize(index(m) * index(level + 1) + 1);
  change.resize(index(n) * index(level + 1));
  const Arena::Frame outer_frame(arena_);
  const double* none = arena_.zeros(index(n));
  constexpr int most = 6;
  double before = 0.0;
  for (int iteration = 0; iteration < most; ++iteration) {
    const NonlinearProblem::Scaling scaling{analysis_.time_scale, RowScaling::each, nullptr, &units_, true};
    const CallbackError error = problem_.linearize(next.t, next.x.data(), {level, level, level}, scaling, next_data_);
    if (error.status == SFDAE_ORDER_MISSING) has_next_level_ = Availability::no;
    if (error.status == SFDAE_STOPPED || error.status == SFDAE_CALLBACK_STOPPED)
      throw Failure(error.status, error.message());
    if (error.status != SFDAE_OK) return false;
    const std::optional<RankSequence> ranks =
        matching_ranks(next_data_, level, analysis_, settings_.rank_tol, {arena_, rank_form_});
    if (!ranks) return false;
    const Judge::Settings judging{settings_.rank_tol, false, NoiseModel::pivots, &*ranks};
    Judge judge(next_data_, level, judging, nullptr);
    const Arena::Frame frame(arena_);
    eliminate(next_data_, level, next_data_.f_stack(level), 1, judge, arena_, &next_elimination_);
    next_elimination_.transform(next_data_.f(0), transformed.data(), arena_);
    next_elimination_.recover(next_data_, {next_data_.f(0), transformed.data()}, none, change.data(), arena_);
    if (!all_finite(change.data(), change.size())) return false;
    double power = 1.0, norm = 0.0, size = 0.0;
    for (int k = 1; k <= level + 1; ++k) {
      power *= next_data_.time_scale;
      for (int i = 0; i < n; ++i) {
        const double unit = units_[i];
        const double dy = change[index((k - 1) * n + i)];
        next.column(k)[i] += dy * unit / (k * power);
        if (k > 1) continue;
        norm = std::max(norm, std::fabs(dy));
        size = std::max(size, std::fabs(next.column(1)[i]) * power / unit);
      }
    }
    if (norm <= 1e-14 * size || (iteration > 0 && norm >= 0.1 * before)) break;
    before = norm;
  }
  next_jet_ = next;
  return true;
}

// Free directions: x' of smallest norm, as the free part is held.
void NonlinearSystem::hold_free_directions(double* xdot) {
  if (form_.u == 0) return;
  const Arena::Frame frame(arena_);
  const int n = problem_.n();
  double* scaled = arena_.take(index(n));
  double* along = arena_.take(index(form_.unknowns()));
  double* free_part = arena_.take(index(form_.u));
  for (int i = 0; i < n; ++i) scaled[i] = xdot[i] / units_[i];
  multiply(1.0, Op::transposed, form_.T2(), scaled, 0.0, along);
  multiply(1.0, Op::transposed, form_.Uz(), along, 0.0, free_part);
  multiply(1.0, Op::plain, form_.Uz(), free_part, 0.0, along);
  multiply(-1.0, Op::plain, form_.T2(), along, 1.0, scaled);
  for (int i = 0; i < n; ++i) xdot[i] = scaled[i] * units_[i];
}

bool NonlinearSystem::exact_derivative(const double* x, double* xdot) {
  if (!problem_.prescribed().empty() || !solve_next_level(x)) return false;
  std::copy_n(next_jet_.column(1), problem_.n(), xdot);
  hold_free_directions(xdot);
  return true;
}

bool NonlinearSystem::consistent_derivative(const double* x, double, double* xdot) {
  if (exact_derivative(x, xdot)) return true;
  // What the array of level mu knows; F1 = 0 settles the differential part.
  std::copy_n(jet_.column(1), problem_.n(), xdot);
  correct_differential_part(x, xdot);
  return false;
}

void NonlinearSystem::correct_derivative(double, const double* x, double* xdot) {
  if (!exact_derivative(x, xdot)) correct_differential_part(x, xdot);
}

// F1(t, x, xdot) = 0 by changes within the directions that the constraints leave open.
void NonlinearSystem::correct_differential_part(const double* x, double* xdot) {
  const int n = problem_.n(), d = form_.d;
  if (differential_residuals(jet_.t, x, xdot) != PointStatus::ok) {
    if (!callback_error_.is_recoverable()) throw Failure(callback_error_.status, callback_error_.message());
    return;
  }
  const Arena::Frame frame(arena_);
  double* q = arena_.take(index(d) + 1);
  double* dx = arena_.take(index(n));
  multiply(1.0 / data_.time_scale, Op::transposed, form_.Z1(), data_.f(0), 0.0, q);
  form_.solve_G(q, z_.data(), arena_);
  multiply(1.0, Op::plain, form_.T2(), z_.data(), 0.0, dx);
  for (int i = 0; i < n; ++i) xdot[i] += dx[i] * units_[i];
}

void NonlinearSystem::archive(Archive& archive) {
  CharacteristicValues& values = analysis_.values;
  bool has_scale = !units_.are_one(), has_matrix = matrix_.is_valid(), has_next = next_jet_.n > 0;
  archive.small(values.mu, values.d, values.a, values.u, values.v, analysis_.v_hat, analysis_.rank_E, analysis_.noise,
                analysis_.rank_E_constant, has_scale, linearized_judged_, age_, unjudged_);
  archive.small(has_matrix, has_next, has_next_level_);
  // Where there is none, that of the last point will do.
  if (!archive.is_reading() && !is_linearized_) linearized_ = accepted_;
  for (double* value : {&analysis_.t, &analysis_.time_scale}) archive.real(*value);
  chord_.archive_rate(archive);
  matrix_.archive_c(archive);
  const int m = problem_.m(), n = problem_.n();
  if (archive.is_reading()) {
    update_traits();
    const bool plausible = values.mu >= 0 && values.mu <= max_strangeness_index && values.d >= 0 && values.a >= 0 &&
                           values.d + values.a + values.v == m && values.d + values.a + values.u == n &&
                           undetermined() >= 0 && analysis_.v_hat >= 0 && analysis_.v_hat <= (values.mu + 1) * m &&
                           std::isfinite(analysis_.time_scale) && analysis_.time_scale > 0.0 && age_ >= 0;
    if (!plausible) throw DamagedArchive();
    resize();
  }
  if (has_scale) archive.reals(units_.values(), index(n));
  for (Jet* jet : {&accepted_, &before_, &linearized_}) {
    archive.real(jet->t);
    archive.reals(jet->x, index(n) * index(values.mu + 2));
  }
  archive.reals(linearized_rows_, index(m));
  if (has_next) archive_highest_derivative(archive);
  int count = static_cast<int>(ranks_.count);
  archive.small(count);
  if (archive.is_reading() && (count < 0 || count > static_cast<int>(ranks_.rank.size()))) throw DamagedArchive();
  ranks_.count = index(count);
  for (int i = 0; i < count; ++i) archive.small(ranks_.rank[index(i)]);
  if (!archive.is_reading()) return;
  // The linearization as it was.
  const Jet where = linearized_;
  const RankSequence ranks = ranks_;
  const int age = age_, unjudged = unjudged_;
  const double rate = chord_.rate();
  const bool judged = linearized_judged_;
  preferred_rows_ = linearized_rows_;
  jet_ = accepted_;
  callback_error_ = problem_.evaluate_prescribed(where.t, prescribed_values_.data());
  if (callback_error_.status != SFDAE_OK || renew(where, false) != PointStatus::ok) throw DamagedArchive();
  ranks_ = ranks;
  age_ = age;
  unjudged_ = unjudged;
  chord_.set_rate(rate);
  linearized_judged_ = judged;
  // Steps that differ from it by rounding are taken with this very matrix.
  if (has_matrix && !factor_step_matrix(matrix_.c())) throw DamagedArchive();
}

// The column of next_jet_ that iterations start from.
void NonlinearSystem::archive_highest_derivative(Archive& archive) {
  const int n = problem_.n(), level = analysis_.values.mu + 1;
  if (archive.is_reading()) {
    next_jet_.n = n;
    next_jet_.set_order(level + 1);
  }
  archive.reals(next_jet_.column(level + 1), index(n));
}

}  // namespace sfdae::core
