// Consistent jets of a nonlinear problem.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/consistent_jet.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "reduction/elimination.h"
#include "reduction/null_space_form.h"
#include "reduction/rank_sequence.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

constexpr int max_iterations = 200;
// A step that reduces the residuals to this fraction needs no damping.
constexpr double good_reduction = 0.5;
// At a jet that counts as consistent the iteration goes on as long as it reduces them to this.
constexpr double still_gaining = 0.9;
// Residuals relative to what was added up in them, of a jet that counts as consistent.
constexpr double consistent_residual = 1e-9;
// y may change this much more easily than x.
constexpr double ease_of_y = 1e3;
constexpr double infinity = std::numeric_limits<double>::infinity();

double length(const double* v, std::size_t count) {
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) sum += v[i] * v[i];
  return std::sqrt(sum);
}

}  // namespace

void JetSolver::linearize(const Jet& jet, int level, double time_scale) {
  NonlinearProblem::Scaling scaling;
  scaling.time_scale = time_scale;
  scaling.units = &units_;
  const CallbackError error = problem_.linearize(jet.t, jet.x.data(), {level, level, level}, scaling, data_);
  if (error.status != SFDAE_OK) throw Failure(error.status, error.message());
  norm_ = length(data_.f(0), index(problem_.m()) * index(level + 1));
}

double JetSolver::residual_norm(const Jet& jet, int level) {
  const int m = problem_.m();
  residuals_.resize(index(m) * index(level + 1));
  const CallbackError error = problem_.residuals(jet.t, jet.x.data(), level, residuals_.data());
  if (error.status == SFDAE_STOPPED || error.status == SFDAE_CALLBACK_STOPPED || error.status == SFDAE_ORDER_MISSING)
    throw Failure(error.status, error.message());
  if (error.status != SFDAE_OK) return infinity;
  double power = 1.0;
  for (int k = 0; k <= level; ++k) {
    power *= data_.time_scale;
    for (int i = 0; i < m; ++i) residuals_[index(k * m + i)] *= power * data_.row_scale[index(i)];
  }
  for (double& r : residuals_)
    if (!(std::fabs(r) < 1e150)) return infinity;
  return length(residuals_.data(), residuals_.size());
}

// change: x, then y_1, ..., y_{level+1}, all scaled.
JetSolver::Trial JetSolver::try_change(const Jet& jet, int level, const Vector& change) {
  Trial trial;
  trial.jet = jet;
  const int n = jet.n;
  double power = 1.0;
  for (int k = 0; k <= level + 1; ++k) {
    const double factor = k == 0 ? 1.0 : 1.0 / (k * (power *= data_.time_scale));
    for (int i = 0; i < n; ++i) {
      const double unit = units_[i];
      trial.jet.column(k)[i] += unit * factor * change[index(k * n + i)];
    }
  }
  if (!all_finite(trial.jet.x.data(), trial.jet.x.size())) return trial;
  trial.norm = residual_norm(trial.jet, level);
  trial.valid = trial.norm < infinity;
  return trial;
}

// The smallest change of x by the staged elimination. noise: of the coefficients, as they are not those of a
// consistent jet.
bool JetSolver::staged_change(const Jet& jet, int level, NoiseModel model, double noise, Vector& change) {
  const int m = problem_.m(), n = jet.n;
  const Arena::Frame frame(arena_);
  data_.residual_noise = noise;
  const RankResult reading = determine_ranks(data_, level, {0.0, false, model, nullptr}, {arena_, form_});
  const Judge::Settings settings{0.0, false, NoiseModel::pivots, &reading.list};
  Judge judge(data_, level, settings, nullptr);
  const Carried carried = eliminate(data_, level, data_.f_stack(level), 1, judge, arena_, &stored_);
  NullSpaceForm& form = form_;
  form.resize(m, n, 0, carried.rows);
  form.build(data_, carried, {}, LeadingTerm::identity, judge, arena_);
  data_.residual_noise = 0.0;
  change.assign(index(n) * index(level + 2), 0.0);
  std::copy_n(form.xp(), n, change.data());
  recover_derivatives(level, change);
  return all_finite(change.data(), change.size());
}

// Changes that count as one: of x relative to its size, of y more.
Vector JetSolver::unit_changes(const Jet& jet, int level) const {
  const int n = jet.n;
  Vector unit(index(n) * index(level + 2));
  for (int i = 0; i < n; ++i) {
    const double scale = units_[i];
    const double size = std::max(1.0, std::fabs(jet.column(0)[i]) / scale);
    const bool is_fixed = !fixed_.empty() && fixed_[index(i)] != 0;
    unit[index(i)] = is_fixed ? 0.0 : size;
    for (int k = 1; k <= level + 1; ++k) unit[index(k * n + i)] = ease_of_y * size;
  }
  return unit;
}

namespace {

// [M | -N] with columns in the order x, y_1, ..., times `unit`.
Matrix scaled_array(const TaylorData& data, int level, const Vector& unit) {
  const Matrix array = taylor_array(data, level);
  const int n = data.n, last = (level + 1) * n;
  Matrix J(array.rows(), array.cols());
  for (int j = 0; j < array.cols(); ++j) {
    const int from = j < n ? last + j : j - n;
    const double factor = (j < n ? -1.0 : 1.0) * unit[index(j)];
    for (int i = 0; i < array.rows(); ++i) J(i, j) = factor * array(i, from);
  }
  return J;
}

}  // namespace

// change = U J^T (J J^T + damping I)^-1 f, J in units of U.
bool JetSolver::damped_change(const Jet& jet, int level, double damping, Vector& change) {
  const Vector unit = unit_changes(jet, level);
  const Matrix J = scaled_array(data_, level, unit);
  const int rows = J.rows();
  Matrix S(rows, rows);
  multiply(1.0, Op::plain, J, Op::transposed, J, 0.0, S);
  double largest = 0.0;
  for (int i = 0; i < rows; ++i) largest = std::max(largest, S(i, i));
  for (int i = 0; i < rows; ++i) S(i, i) += (damping + 1e-14) * largest + 1e-300;
  std::vector<int> pivots(index(rows) + 1);
  if (!factor_lu(S, pivots.data())) return false;
  Vector q(data_.f(0), data_.f(0) + rows);
  solve_lu(S, pivots.data(), q.data());
  change.assign(index(J.cols()), 0.0);
  multiply(1.0, Op::transposed, J, q.data(), 0.0, change.data());
  for (std::size_t j = 0; j < change.size(); ++j) change[j] *= unit[j];
  return all_finite(change.data(), change.size());
}

// The smallest change in units of U. Singular values at the level of the residuals are dropped, up to most_dropped.
bool JetSolver::dense_change(const Jet& jet, int level, double most_dropped, Vector& change) {
  const Vector unit = unit_changes(jet, level);
  const Matrix J = scaled_array(data_, level, unit);
  const double size = max_abs(J);
  if (!std::isfinite(size)) return false;
  const double threshold = std::max(1e-12, std::min(most_dropped, 10.0 * norm_ / std::max(size, 1e-300))) * size;
  change = least_squares(J, Vector(data_.f(0), data_.f(0) + J.rows()), threshold);
  for (std::size_t j = 0; j < change.size(); ++j) change[j] *= unit[j];
  return all_finite(change.data(), change.size());
}

bool JetSolver::is_converged(const Jet& jet, int level, double tolerance) const {
  const int m = data_.m, n = data_.n;
  double power = 1.0;
  Vector size(index(m) * index(level + 1), 0.0);
  for (int k = 0; k <= level + 1; ++k) {
    const double to_scaled = k == 0 ? 1.0 : k * (power *= data_.time_scale);
    for (int j = 0; j < n; ++j) {
      const double unit = units_[j];
      const double y = std::fabs(to_scaled * jet.column(k)[j] / unit);
      for (int i = 0; i <= level; ++i)
        for (int row = 0; row < m; ++row) {
          double entry = k == 0 ? std::fabs(data_.A(i)(row, j)) : 0.0;
          if (k > 0 && i + 1 >= k) entry = std::fabs(data_.E(i + 1 - k)(row, j));
          if (k > 0 && i >= k) entry += std::fabs(data_.A(i - k)(row, j)) / k;
          size[index(i * m + row)] += entry * y;
        }
    }
  }
  // Where nothing was added up, constants cancel: their size is that of the coefficients.
  const double least = data_.norm(level);
  for (std::size_t i = 0; i < size.size(); ++i)
    if (std::fabs(data_.f(0)[i]) > tolerance * (size[i] + least)) return false;
  return true;
}

void JetSolver::give_up(const Jet& jet, int level) {
  // The largest residuals, in words.
  const int m = problem_.m(), count = m * (level + 1);
  std::vector<int> order(index(count));
  for (int i = 0; i < count; ++i) order[index(i)] = i;
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return std::fabs(data_.f(0)[a]) > std::fabs(data_.f(0)[b]); });
  std::string text = format("no consistent values were found near the guess at t = %.15g; what remains:", jet.t);
  double factorial = 1.0;
  for (int q = 0; q < std::min(count, 4); ++q) {
    const int k = order[index(q)] / m, i = order[index(q)] % m;
    factorial = 1.0;
    for (int j = 2; j <= k; ++j) factorial *= j;
    const double value = -data_.f(k)[i] / (data_.row_scale[index(i)] * std::pow(data_.time_scale, k + 1)) * factorial;
    if (value == 0.0) break;
    text += k == 0 ? format(" equation %d by %.3g,", i, value)
                   : format(" derivative %d of equation %d by %.3g,", k, i, value);
  }
  text.back() = '.';
  throw Failure(SFDAE_NO_CONSISTENT_VALUES,
                text + " Give a better guess, fix fewer components, or check the equations.");
}

// Pivots that vanish at consistent jets do not do so here: what is below the residuals counts as noise, relative to
// the coefficients.
double JetSolver::residual_noise(int level) const {
  constexpr double most = 1e-4;
  return std::min(most, norm_ / std::max(data_.norm(level), 1e-300));
}

// Which ranks are right shows in what they achieve.
JetSolver::Trial JetSolver::undamped_trial(const Jet& jet, int level) {
  Vector change;
  Trial best;
  if (!fixed_.empty()) {
    if (dense_change(jet, level, 1e-4, change)) best = try_change(jet, level, change);
    return best;
  }
  struct Attempt {
    NoiseModel model;
    double noise;
  };
  for (const Attempt& attempt : {Attempt{NoiseModel::pivots, residual_noise(level)}, Attempt{NoiseModel::pivots, 0.0},
                                 Attempt{NoiseModel::carried, 0.0}, Attempt{NoiseModel::data, 0.0}}) {
    if (!staged_change(jet, level, attempt.model, attempt.noise, change)) continue;
    Trial trial = try_change(jet, level, change);
    if (trial.valid && (!best.valid || trial.norm < best.norm)) best = std::move(trial);
    if (best.valid && best.norm <= good_reduction * norm_) break;
  }
  return best;
}

// Products of unknowns that are far off make residuals grow at first, though the next steps remove them all: that is
// how a pendulum at rest below its support finds its force. Undamped steps from `trial` on; the jet stays if they
// lead nowhere.
bool JetSolver::run_freely(Jet& jet, int level, Trial trial) {
  constexpr int most = 5;
  constexpr double too_far = 1e4;
  const Jet start = jet;
  const double before = norm_, time_scale = data_.time_scale;
  for (int step = 0; step < most && trial.valid && trial.norm <= too_far * before; ++step) {
    jet = trial.jet;
    try {
      linearize(jet, level, time_scale);
    } catch (const Failure& failure) {
      if (failure.status() != SFDAE_NOT_FINITE && failure.status() != SFDAE_CALLBACK_FAILED) throw;
      break;
    }
    if (norm_ <= good_reduction * before) return true;
    trial = undamped_trial(jet, level);
  }
  jet = start;
  linearize(jet, level, time_scale);
  return false;
}

void JetSolver::solve(Jet& jet, int level) {
  if (jet.order < level + 1) jet.set_order(level + 1);
  find(jet, level);
  if (!data_.E0_was_rounding) return;
  // Derivatives so large that rounding errors times them make up for equations that x does not fulfil.
  std::fill(jet.x.begin() + jet.n, jet.x.end(), 0.0);
  find(jet, level);
}

void JetSolver::find(Jet& jet, int level) {
  const Jet start = jet;
  // Where x is consistent it must not move, though y is far off.
  if (solve_for_derivatives(jet, level)) return;
  jet = start;
  try {
    search(jet, level, false);
  } catch (const Failure& failure) {
    if (failure.status() != SFDAE_NO_CONSISTENT_VALUES) throw;
    // What has no derivative may be far off alone: forces have other units.
    jet = start;
    if (solve_for_algebraic(jet, level) && solve_for_derivatives(jet, level)) return;
    jet = start;
    search(jet, level, true);
  }
}

// y alone changes: true if F_level = 0 to rounding then, and nothing calls for a change of x. Large y alone may
// fulfil the equations near points that are not consistent.
bool JetSolver::solve_for_derivatives(Jet& jet, int level) {
  constexpr int most = 12;
  constexpr double rounding = 1e-14, negligible = 1e-12;
  linearize(jet, level, 0.0);
  const std::size_t n = index(jet.n);
  Vector change;
  for (int iteration = 0; iteration < most && norm_ > 0.0; ++iteration) {
    const double before = norm_;
    double wanted = 0.0, size = 0.0;
    Trial trial;
    for (double noise : {residual_noise(level), 0.0}) {
      if (!staged_change(jet, level, noise > 0.0 ? NoiseModel::pivots : NoiseModel::carried, noise, change)) continue;
      wanted = max_abs(change.data(), jet.n);
      std::fill_n(change.begin(), n, 0.0);
      recover_derivatives(level, change);
      if (!all_finite(change.data(), change.size())) continue;
      trial = try_change(jet, level, change);
      if (trial.valid && trial.norm < still_gaining * before) break;
    }
    for (std::size_t i = 0; i < n; ++i) size = std::max(size, std::fabs(jet.x[i]) / units_[i]);
    if (!trial.valid || trial.norm >= still_gaining * before)
      return wanted <= negligible * size && is_converged(jet, level, rounding);
    jet = trial.jet;
    linearize(jet, level, data_.time_scale);
  }
  return norm_ == 0.0;
}

// y and those components of x change whose derivatives are in no equation: true if F_level = 0 then.
bool JetSolver::solve_for_algebraic(Jet& jet, int level) {
  constexpr int most = 8;
  const std::vector<char> fixed_by_user = fixed_;
  linearize(jet, level, 0.0);
  fixed_.resize(index(jet.n), 0);
  bool any_free = false;
  for (int j = 0; j < jet.n; ++j) {
    for (int k = 0; k <= level && fixed_[index(j)] == 0; ++k)
      if (max_abs(data_.E(k).column(j), data_.m) > 0.0) fixed_[index(j)] = 1;
    any_free = any_free || fixed_[index(j)] == 0;
  }
  // Products of unknowns that are far off make residuals grow at first.
  constexpr double too_far = 1e12;
  const double first = norm_;
  bool goes_on = any_free;
  Vector change;
  for (int iteration = 0; iteration < most && goes_on && norm_ > 0.0; ++iteration) {
    goes_on = dense_change(jet, level, 0.0, change);
    if (!goes_on) break;
    Trial trial = try_change(jet, level, change);
    goes_on = trial.valid && trial.norm <= too_far * first;
    if (is_converged(jet, level, consistent_residual) && trial.norm > good_reduction * norm_) goes_on = false;
    if (!goes_on) break;
    jet = std::move(trial.jet);
    linearize(jet, level, data_.time_scale);
  }
  fixed_ = fixed_by_user;
  return any_free && (norm_ == 0.0 || is_converged(jet, level, consistent_residual));
}

// Of the last staged_change, for another change of x.
void JetSolver::recover_derivatives(int level, Vector& change) {
  Vector transformed(index(data_.m) * index(level + 1) + 1);
  stored_.transform(data_.f(0), transformed.data(), arena_);
  stored_.recover(data_, {data_.f(0), transformed.data()}, change.data(), change.data() + data_.n, arena_);
}

void JetSolver::search(Jet& jet, int level, bool may_run_freely) {
  linearize(jet, level, 0.0);
  double damping = 1e-3;
  bool may_step_freely = true;
  Vector change;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    if (norm_ == 0.0) return;
    const double before = norm_;
    // An undamped step first; it is the last one if rounding lets it gain nothing.
    Trial trial;
    if (may_step_freely) trial = undamped_trial(jet, level);
    const bool converged = is_converged(jet, level, consistent_residual);
    if (!trial.valid || trial.norm > good_reduction * before) {
      if (converged && trial.valid && trial.norm < still_gaining * before) {
        jet = trial.jet;
        linearize(jet, level, data_.time_scale);
        continue;
      }
      if (converged) return;
      if (may_run_freely && may_step_freely && run_freely(jet, level, std::move(trial))) continue;
      may_step_freely = false;
    }
    if (!may_step_freely) {
      for (int attempt = 0; attempt < 30; ++attempt, damping *= 8.0) {
        trial.valid = damped_change(jet, level, damping * std::min(1.0, before * before), change);
        if (trial.valid) trial = try_change(jet, level, change);
        // However little it gains: where the damping is too strong, less of it follows.
        if (trial.valid && trial.norm < before) break;
        trial.valid = false;
      }
      if (!trial.valid) {
        if (converged) return;
        give_up(jet, level);
      }
      damping = std::max(damping / 16.0, 1e-12);
      may_step_freely = trial.norm < good_reduction * before;
    }
    jet = trial.jet;
    linearize(jet, level, data_.time_scale);
  }
  if (!is_converged(jet, level, consistent_residual)) give_up(jet, level);
}

}  // namespace sfdae::core
