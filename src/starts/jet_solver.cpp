// Gauss-Newton for consistent jets.
// SPDX-License-Identifier: BSD-3-Clause
#include "starts/jet_solver.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"
#include "linalg/matrix.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Limits of searches. Steps that reduce the residuals well do not count: with an exponential a Newton step gains one
// power of e, and guesses may be hundreds of them away. These steps have a limit, too: residuals that are measured in
// new units after each step may be large again. Chosen, not measured.
constexpr int max_iterations = 200, max_good_steps = 1000;
// A step that reduces the residuals to this fraction needs no damping. Chosen, not measured.
constexpr double good_reduction = 0.5;
// At a jet that counts as consistent the iteration continues while it reduces them to this. Chosen, not measured.
constexpr double still_gaining = 0.9;
// Residuals, relative to their terms, of a jet that counts as consistent: above what ill-conditioned arrays leave,
// below what users notice. Chosen, not measured.
constexpr double consistent_residual = 1e-9;
// Damped steps eventually get below any residual if derivatives run away to make up for constraints that x violates.
// Consistency shows in undamped steps, or in residuals at roundoff (docs/design/consistent_initialization.md).
constexpr double consistent_after_damping = 1e-12;

// About a hundred units of roundoff of the terms of a residual.
constexpr double rounding = 1e-14;

// Fixes further components during its lifetime.
class FixedForNow {
 public:
  FixedForNow(JetEquations& equations, std::vector<char> fixed) : equations_(equations), before_(equations.fixed()) {
    equations_.set_fixed(std::move(fixed));
  }
  ~FixedForNow() { equations_.set_fixed(std::move(before_)); }
  FixedForNow(const FixedForNow&) = delete;
  FixedForNow& operator=(const FixedForNow&) = delete;

 private:
  JetEquations& equations_;
  std::vector<char> before_;
};
// True if another step may lead to where the equations can be evaluated.
bool is_recoverable(const Failure& failure) {
  return failure.status() == SFDAE_NOT_FINITE || failure.status() == SFDAE_CALLBACK_FAILED;
}

}  // namespace

void JetSolver::solve(Jet& jet, int level) {
  if (jet.order < level + 1) jet.set_order(level + 1);
  find(jet, level);
  if (!equations_.E0_was_rounding()) return;
  // Derivatives are so large that their rounding errors make up for equations that x violates.
  std::fill(jet.x.begin() + jet.n, jet.x.end(), 0.0);
  find(jet, level);
}

void JetSolver::find(Jet& jet, int level) {
  const Jet start = jet;
  // False if steps lead out of the domain of the equations.
  const auto succeeds = [&](auto step) {
    try {
      return step();
    } catch (const Failure& failure) {
      if (!is_recoverable(failure)) throw;
      return false;
    }
  };
  // A consistent x must not move, even if y is far off.
  if (succeeds([&] { return solve_for_derivatives(jet, level); })) return;
  jet = start;
  try {
    search(jet, level, false);
  } catch (const Failure& failure) {
    if (failure.status() != SFDAE_NO_CONSISTENT_VALUES) throw;
    // Only algebraic variables may be far off: forces have other units.
    jet = start;
    if (succeeds([&] { return stays_near(jet, level); })) return;
    jet = start;
    search(jet, level, true);
  }
  // All equations together may then lead elsewhere, a pendulum to the other side of its support.
  if (!has_moved_far(start, jet)) return;
  Jet near = start;
  const double time_scale = equations_.time_scale();
  if (succeeds([&] { return stays_near(near, level); })) jet = std::move(near);
  else equations_.linearize(jet, level, time_scale);
}

// Solves for algebraic variables, such as forces, before all equations together are solved.
bool JetSolver::stays_near(Jet& jet, int level) {
  const Jet start = jet;
  if (!solve_for_algebraic(jet, level)) return false;
  const Jet nearly = jet;
  if (solve_for_derivatives(jet, level)) return true;
  jet = nearly;
  try {
    search(jet, level, false);
  } catch (const Failure& failure) {
    if (failure.status() != SFDAE_NO_CONSISTENT_VALUES) throw;
    return false;
  }
  return !has_moved_far(start, jet);
}

// True if differential variables that are to stay have moved far: steps along the constraints do not lead back.
bool JetSolver::has_moved_far(const Jet& from, const Jet& to) const {
  constexpr double far = 0.1, little = 1e-6;  // of a value, and of the largest one; chosen, not measured
  if (!equations_.keeps_differentiated()) return false;
  double size = 0.0;
  for (int j = 0; j < from.n; ++j) size = std::max(size, std::fabs(from.x[index(j)]) / equations_.units()[index(j)]);
  for (int j = 0; j < from.n; ++j) {
    const double change = std::fabs(to.x[index(j)] - from.x[index(j)]);
    if (equations_.has_derivative_of(j) && change > far * std::fabs(from.x[index(j)]) &&
        change > little * size * equations_.units()[index(j)])
      return true;
  }
  return false;
}

// The jet becomes that of the trial, with the equations linearized there; if they cannot be, false without a change.
bool JetSolver::accept(Jet& jet, Trial&& trial, int level) {
  const double time_scale = equations_.time_scale();
  try {
    equations_.linearize(trial.jet, level, time_scale);
  } catch (const Failure& failure) {
    if (!is_recoverable(failure)) throw;
    equations_.linearize(jet, level, time_scale);
    return false;
  }
  jet = std::move(trial.jet);
  return true;
}

// Changes y alone: true if then F_level = 0 to machine precision, and no change of x is required. Large y alone may
// satisfy the equations near inconsistent points. If x must not change, rounding errors of x stay in residuals, which
// stiff equations amplify: then the jet only has to count as consistent.
bool JetSolver::solve_for_derivatives(Jet& jet, int level) {
  constexpr int most = 12;
  // Change relative to x: some thousand units of roundoff.
  constexpr double negligible = 1e-12;
  equations_.linearize(jet, level, 0.0);
  const std::size_t n = index(jet.n);
  const std::vector<char>& fixed = equations_.fixed();
  const bool is_x_given = !fixed.empty() && std::find(fixed.begin(), fixed.end(), 0) == fixed.end();
  Vector change;
  for (int iteration = 0; iteration < most && equations_.norm() > 0.0; ++iteration) {
    const double before = equations_.norm();
    Trial trial;
    for (double noise : {equations_.residual_noise(), 0.0}) {
      equations_.eliminate_staged(noise > 0.0 ? NoiseModel::pivots : NoiseModel::carried, noise);
      change.assign(n * index(level + 2), 0.0);
      equations_.recover_derivatives(change);
      if (!all_finite(change.data(), change.size())) continue;
      trial = equations_.try_change(jet, change);
      if (trial.valid && trial.norm < still_gaining * before) break;
    }
    if (!trial.valid || trial.norm >= still_gaining * before) {
      if (!equations_.is_converged(jet, is_x_given ? consistent_residual : rounding)) return false;
      double size = 0.0;
      for (std::size_t i = 0; i < n; ++i) size = std::max(size, std::fabs(jet.x[i]) / equations_.units()[i]);
      return equations_.staged_change(true, change) && max_abs(change.data(), jet.n) <= negligible * size &&
             (is_x_given || equations_.is_negligible(jet, change));
    }
    jet = trial.jet;
    equations_.linearize(jet, level, equations_.time_scale());
  }
  return equations_.norm() == 0.0;
}

// Changes y and those components of x whose derivatives are in no equation: true if then F_level = 0.
bool JetSolver::solve_for_algebraic(Jet& jet, int level) {
  constexpr int most = 8;
  // Products of unknowns that are far off make residuals grow at first. Chosen, not measured.
  constexpr double too_far = 1e12;
  equations_.linearize(jet, level, 0.0);
  std::vector<char> fixed = equations_.fixed();
  fixed.resize(index(jet.n), 0);
  bool any_free = false;
  for (int j = 0; j < jet.n; ++j) {
    if (equations_.has_derivative_of(j)) fixed[index(j)] = 1;
    any_free = any_free || fixed[index(j)] == 0;
  }
  const FixedForNow fixed_for_now(equations_, std::move(fixed));
  const double first = equations_.norm();
  bool goes_on = any_free;
  Vector change;
  for (int iteration = 0; iteration < most && goes_on && equations_.norm() > 0.0; ++iteration) {
    goes_on = equations_.dense_change(jet, 0.0, change);
    if (!goes_on) break;
    Trial trial = equations_.try_change(jet, change);
    goes_on = trial.valid && trial.norm <= too_far * first;
    if (equations_.is_converged(jet, consistent_residual) && trial.norm > good_reduction * equations_.norm())
      goes_on = false;
    if (!goes_on) break;
    jet = std::move(trial.jet);
    equations_.linearize(jet, level, equations_.time_scale());
  }
  return any_free && (equations_.norm() == 0.0 || equations_.is_converged(jet, consistent_residual));
}

// Tries several ranks and judges them by their results. of_most_ranks: receives the first trial without noise, or null.
JetSolver::Trial JetSolver::undamped_trial(const Jet& jet, Trial* of_most_ranks) {
  // Residuals larger than this part of the coefficients do not tell which singular values vanish. Chosen, not measured.
  constexpr double most_dropped = 1e-4;
  Vector change;
  Trial best;
  if (!equations_.fixed().empty()) {
    if (equations_.dense_change(jet, most_dropped, change)) best = equations_.try_change(jet, change);
    return best;
  }
  struct Attempt {
    NoiseModel model;
    double noise;
  };
  const bool is_at_rounding = equations_.is_converged(jet, rounding);
  const auto is_good = [&](const Trial& trial) {
    return trial.valid && trial.norm <= good_reduction * equations_.norm();
  };
  for (bool keep : {equations_.keeps_differentiated(), false}) {
    std::vector<RankSequence> tried;
    for (const Attempt& attempt :
         {Attempt{NoiseModel::pivots, equations_.residual_noise()}, Attempt{NoiseModel::pivots, 0.0},
          Attempt{NoiseModel::carried, 0.0}, Attempt{NoiseModel::data, 0.0}}) {
      // If only rounding errors are left, other ranks do not reduce them.
      if (is_at_rounding && best.valid && (!keep || best.moved <= 1.0)) return best;
      const RankSequence& ranks = equations_.eliminate_staged(attempt.model, attempt.noise);
      if (std::find(tried.begin(), tried.end(), ranks) != tried.end()) continue;
      tried.push_back(ranks);
      if (!equations_.staged_change(keep, change)) continue;
      Trial trial = equations_.try_change(jet, change);
      if (keep) trial.moved = equations_.moved_by_last_change();
      const bool is_first_of_them = of_most_ranks != nullptr && attempt.noise == 0.0 && !of_most_ranks->valid;
      if (is_first_of_them) *of_most_ranks = trial;
      // Wrong ranks move variables that could stay.
      const bool is_better = keep && is_good(best) ? is_good(trial) && trial.moved < best.moved
                                                   : trial.valid && (!best.valid || trial.norm < best.norm);
      if (is_better) best = std::move(trial);
      if (is_good(best) && (!keep || best.moved <= 1.0)) return best;
    }
    // If differential variables have to move far, the smallest change may do better.
    if (!keep || is_good(best)) break;
  }
  return best;
}

// Products of unknowns that are far off make residuals grow at first, though the next steps remove them all: this is
// how a pendulum at rest below its support finds its force. Undamped steps from `trial` on; the jet stays if they do
// not succeed.
bool JetSolver::search_undamped(Jet& jet, int level, Trial trial, double too_far) {
  // Chosen so that the pendulum does.
  constexpr int most = 5;
  const Jet start = jet;
  const double before = equations_.norm(), time_scale = equations_.time_scale();
  for (int step = 0; step < most && trial.valid && trial.norm <= too_far * before; ++step) {
    if (!accept(jet, std::move(trial), level)) break;
    if (equations_.norm() <= good_reduction * before) return true;
    trial = undamped_trial(jet);
  }
  jet = start;
  equations_.linearize(jet, level, time_scale);
  return false;
}

// Part of an undamped step that led out of the domain of the equations, or enormously far: not valid if no part reduces
// the residuals.
JetSolver::Trial JetSolver::shortened_trial(const Jet& jet) {
  // 2^-10 of a step is shorter than what damping would make of it. Chosen, not measured.
  constexpr int halvings = 10;
  constexpr double least_gain = 0.1;
  Vector change;
  bool is_found = false;
  if (equations_.fixed().empty()) {
    equations_.eliminate_staged(NoiseModel::pivots, 0.0);
    is_found = equations_.staged_change(true, change);
  } else {
    is_found = equations_.dense_change(jet, 0.0, change);
  }
  double part = 1.0;
  for (int k = 0; is_found && k < halvings; ++k) {
    part *= 0.5;
    for (double& entry : change) entry *= 0.5;
    Trial trial = equations_.try_change(jet, change);
    if (trial.valid && trial.norm < (1.0 - least_gain * part) * equations_.norm()) return trial;
  }
  return {};
}

// A damped step that reduces the residuals, however little: damping that is too strong is reduced afterwards.
// Not valid if none is found.
JetSolver::Trial JetSolver::damped_trial(const Jet& jet, double& damping) {
  // 8^30 = 1e27: steps vanish before.
  constexpr int most = 30;
  constexpr double stronger = 8.0;
  const double before = equations_.norm();
  Vector change;
  Trial trial;
  for (int attempt = 0; attempt < most; ++attempt, damping *= stronger) {
    trial.valid = equations_.damped_change(jet, damping * std::min(1.0, before * before), change);
    if (trial.valid) trial = equations_.try_change(jet, change);
    if (trial.valid && trial.norm < before) return trial;
    trial.valid = false;
  }
  return trial;
}

void JetSolver::search(Jet& jet, int level, bool may_grow) {
  // Damping relative to the squared norm of the derivative array. Chosen, not measured.
  constexpr double first_damping = 1e-3, least_damping = 1e-12, weaker = 16.0, after_failure = 1e3;
  // Growth of residuals by exponentials that have run away. Chosen, not measured.
  constexpr double enormous = 1e6;
  // The first one is chosen so that the pendulum below its support finds its force.
  constexpr double too_far = 1e4, too_far_with_all_ranks = 1e12;
  // Undamped steps with little gain that are allowed once the residuals have been reduced to this part
  // (docs/design/consistent_initialization.md).
  constexpr int most_slow = 2;
  constexpr double near = 1e-3;
  const auto is_converged = [this](const Jet& of, bool by_undamped_steps) {
    return equations_.is_converged(of, by_undamped_steps ? consistent_residual : consistent_after_damping);
  };
  equations_.linearize(jet, level, 0.0);
  double damping = first_damping;
  bool is_undamped = true;
  int slow_steps = 0;
  const double first = equations_.norm();
  int steps = 0;
  for (int iteration = 0; iteration < max_iterations && steps < max_good_steps; ++steps) {
    if (equations_.norm() == 0.0) return;
    const double before = equations_.norm();
    // An undamped step first; it is the last one if roundoff prevents a gain.
    Trial trial, of_most_ranks;
    if (is_undamped) trial = undamped_trial(jet, may_grow ? &of_most_ranks : nullptr);
    const bool converged = is_converged(jet, is_undamped);
    if (!trial.valid || trial.norm > good_reduction * before) {
      ++iteration;
      if (converged && trial.valid && trial.norm < still_gaining * before) {
        if (accept(jet, std::move(trial), level)) continue;
        return;
      }
      if (converged) return;
      // Near a solution a step with little gain may be followed by one with much, while damped ones creep forever.
      if (trial.valid && trial.norm < before && before <= near * first && slow_steps < most_slow) {
        ++slow_steps;
        if (accept(jet, std::move(trial), level)) continue;
      }
      const bool is_far_off = is_undamped && (!trial.valid || trial.norm > enormous * before);
      if (may_grow && is_undamped && search_undamped(jet, level, std::move(trial), too_far)) continue;
      // Values that are small relative to the residuals of other equations may be all that constraints have.
      if (of_most_ranks.valid && search_undamped(jet, level, std::move(of_most_ranks), too_far_with_all_ranks))
        continue;
      trial.valid = false;
      if (is_far_off) trial = shortened_trial(jet);
      is_undamped = trial.valid;
    }
    if (!is_undamped) {
      trial = damped_trial(jet, damping);
      if (!trial.valid) equations_.give_up(jet);
      damping = std::max(damping / weaker, least_damping);
      is_undamped = trial.norm < good_reduction * before;
    }
    if (accept(jet, std::move(trial), level)) continue;
    if (converged && is_undamped) return;
    // Shorter steps from here.
    ++iteration;
    is_undamped = false;
    damping *= after_failure;
  }
  if (!is_converged(jet, is_undamped)) equations_.give_up(jet);
}

}  // namespace sfdae::core
