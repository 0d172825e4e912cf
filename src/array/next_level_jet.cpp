// The jet of level mu + 1 through a consistent x.
// SPDX-License-Identifier: BSD-3-Clause
#include "array/next_level_jet.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "linalg/index.h"
#include "problem/failure.h"
#include "reduction/rank_sequence.h"
#include "starts/jet_solver.h"

namespace sfdae::core {

bool NextLevelJet::solve(const Jet& start, const double* x) {
  if (availability_ == Availability::no) return false;
  const bool is_solved = is_solved_for(start, x);
  is_new_ = false;
  if (is_solved) return true;
  begin(start, x);
  if (!iterate()) {
    if (availability_ == Availability::no) return false;
    begin(start, x);
    if (!search()) return false;
  }
  jet_ = trial_;
  is_new_ = true;
  return true;
}

// trial_ := x with the known derivatives.
void NextLevelJet::begin(const Jet& start, const double* x) {
  const int n = problem_.n();
  const bool continues = jet_.order == level() + 1 && jet_.n == n;
  trial_ = start;
  trial_.set_order(level() + 1);
  if (continues) std::copy_n(jet_.column(level() + 1), n, trial_.column(level() + 1));
  std::copy_n(x, n, trial_.column(0));
}

// Newton's method. It needs the known ranks at every iterate, which derivatives far off may not have.
bool NextLevelJet::iterate() {
  // Newton's method converges quadratically: it ends long before this limit, or never. It ends when changes of x' are a
  // few tens of units of roundoff, or no longer decrease because of roundoff. Chosen, not measured.
  constexpr int most = 6;
  constexpr double negligible = 1e-14, still_gaining = 0.1, small = 1e-6;
  double before = 0.0;
  for (int iteration = 0; iteration < most; ++iteration) {
    if (!eliminate_at(trial_)) return false;
    const std::optional<Change> change = change_derivatives(trial_);
    if (!change) return false;
    if (change->norm <= negligible * change->size) return true;
    if (iteration > 0 && change->norm >= still_gaining * before) return change->norm <= small * change->size;
    before = change->norm;
  }
  return false;
}

// Searches as for consistent initial values, with x fixed.
bool NextLevelJet::search() {
  JetSolver solver(problem_.problem(), problem_.units());
  solver.set_fixed(std::vector<char>(index(problem_.n()), 1));
  try {
    solver.solve(trial_, level());
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
    return false;
  }
  return true;
}

void NextLevelJet::copy_derivatives(Jet& jet) const {
  std::copy(jet_.column(1), jet_.column(1) + jet_.n * std::min(jet.order, jet_.order), jet.column(1));
}

// True if the jet is the last solution, which is reused once only since the equations may change later.
bool NextLevelJet::is_solved_for(const Jet& start, const double* x) const {
  const int n = problem_.n();
  return is_new_ && jet_.n == n && jet_.t == start.t && start.order == level() &&
         std::equal(x, x + n, jet_.column(0)) &&
         std::equal(start.column(1), start.column(1) + n * level(), jet_.column(1));
}

// False if F_{mu+1} cannot be evaluated or has other ranks.
bool NextLevelJet::eliminate_at(const Jet& jet) {
  const IndexAnalysis& analysis = problem_.analysis();
  const double rank_tol = problem_.settings().rank_tol;
  const Orders orders{level(), level(), level()};
  const NonlinearProblem::Scaling scaling{analysis.time_scale, analysis.rows, nullptr, &problem_.units(), true};
  const CallbackError error = problem_.problem().linearize(jet.t, jet.x.data(), orders, scaling, data_);
  if (error.status == SFDAE_ORDER_MISSING) availability_ = Availability::no;
  if (ends_everything(error.status)) error.raise();
  if (error.status != SFDAE_OK) return false;
  StoredReduction reduction{elimination_};
  return reduce_with_known_values(data_, level(), analysis, rank_tol, {arena_, rank_form_}, reduction);
}

// Changes y once; no result if the change is not finite.
std::optional<NextLevelJet::Change> NextLevelJet::change_derivatives(Jet& jet) {
  const int n = problem_.n();
  const Arena::Frame frame(arena_);
  const double* none = arena_.zeros(index(n));
  transformed_.resize(index(problem_.m()) * index(level() + 1) + 1);
  dy_.resize(index(n) * index(level() + 1));
  elimination_.transform(data_.f(0), transformed_.data(), arena_);
  elimination_.recover(data_, {data_.f(0), transformed_.data()}, none, dy_.data(), arena_);
  if (!all_finite(dy_.data(), dy_.size())) return std::nullopt;
  Change change;
  double power = 1.0;
  for (int k = 1; k <= level() + 1; ++k) {
    power *= data_.time_scale;
    for (int i = 0; i < n; ++i) {
      const double unit = problem_.units()[i];
      const double dy = dy_[index((k - 1) * n + i)];
      jet.column(k)[i] += dy * unit / (k * power);
      if (k > 1) continue;
      change.norm = std::max(change.norm, std::fabs(dy));
      change.size = std::max(change.size, std::fabs(jet.column(1)[i]) * power / unit);
    }
  }
  return change;
}

void NextLevelJet::archive_highest_derivative(Archive& archive) {
  if (archive.is_reading()) {
    is_new_ = false;
    jet_.n = problem_.n();
    jet_.set_order(level() + 1);
  }
  archive.reals(jet_.column(level() + 1), index(problem_.n()));
}

}  // namespace sfdae::core
