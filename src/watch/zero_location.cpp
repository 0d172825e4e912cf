// Location of zeros of event functions.
// SPDX-License-Identifier: BSD-3-Clause
#include "watch/zero_location.h"

#include <cmath>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Size of the interval around an initial guess, relative to the interval searched, within which further guesses stop.
// (Chosen: they would save few evaluations.)
constexpr double near_guess = 1e-9;
// Maximum of initial guesses for one zero: the second uses values improved at the first. (Chosen.)
constexpr int max_guesses = 3;
// Zeros nearer to each other than this, in units of the resolution of the bracket, are one. (Chosen: rounding errors of
// the functions move them by a few units.)
constexpr double simultaneous = 4.0;

}  // namespace

ZeroLocation::ZeroLocation(int functions) {
  for (Vector* v : {&trial_, &rough_before_, &rough_after_}) v->assign(index(functions), 0.0);
  watched_.assign(index(functions), 0);
  bracket_.resize(functions);
  rough_bracket_.resize(functions);
}

// The initial guess uses inexpensive values; the result uses the values that are returned.
void ZeroLocation::find(DeterminedValues& values, const EventSigns& signs, const ZeroInterval& interval) {
  signs.watch(watched_);
  bracket_.start(watched_, interval.searched, interval.g_searched, interval.to, interval.g_to);
  double t = interval.to;
  if (guess(values, interval, t)) place(values, t);
  while (!bracket_.is_resolved()) {
    t = bracket_.next();
    if (t == bracket_.before() || t == bracket_.after()) break;
    place(values, t);
  }
  include_simultaneous(values, interval);
}

void ZeroLocation::place(DeterminedValues& values, double t) {
  values.determine(t, false, trial_);
  if (bracket_.place(t, trial_)) values->keep();
}

// Zero of the approximate values at t, strictly inside. Determining the returned values there may improve the
// approximate ones: then another guess pays off. From then on they do not change.
bool ZeroLocation::guess(DeterminedValues& values, const ZeroInterval& interval, double& t) {
  const double from = interval.from, to = interval.to;
  bool found = false;
  for (int round = 0; round < max_guesses; ++round) {
    if (!values->approximate(from, rough_before_.data()) || !values->approximate(to, rough_after_.data()))
      return found;
    rough_bracket_.start(watched_, from, rough_before_, to, rough_after_);
    if (rough_bracket_.is_lost(rough_before_) || !rough_bracket_.is_lost(rough_after_)) return found;
    while (!rough_bracket_.is_resolved()) {
      const double middle = rough_bracket_.next();
      if (middle == rough_bracket_.before() || middle == rough_bracket_.after()) break;
      if (!values->approximate(middle, rough_after_.data())) return found;
      rough_bracket_.place(middle, rough_after_);
    }
    const double zero = rough_bracket_.after();
    if (found && std::fabs(zero - t) <= near_guess * std::fabs(to - from)) return true;
    if (zero == to || zero == interval.searched) return found;
    t = zero;
    values.determine(t, true, trial_);
    found = true;
  }
  return found;
}

// Zeros that coincide to machine precision are one event.
void ZeroLocation::include_simultaneous(DeterminedValues& values, const ZeroInterval& interval) {
  const double after = bracket_.after();
  const double margin = std::copysign(simultaneous * bracket_.resolution(), interval.to - interval.from);
  if (!((interval.to - after - margin) * margin > 0.0)) return;
  const auto is_lost = [&](std::size_t i, const Vector& g) { return ZeroBracket::is_lost(watched_[i], g[i]); };
  bool others = false;
  for (std::size_t i = 0; i < watched_.size(); ++i)
    others = others || (watched_[i] != 0 && !is_lost(i, bracket_.g_after()));
  if (!others) return;
  values.determine(after + margin, false, trial_);
  bool has_new = false, all_lost = true;
  for (std::size_t i = 0; i < watched_.size(); ++i) {
    const bool was_lost = is_lost(i, bracket_.g_after()), is_now = is_lost(i, trial_);
    has_new = has_new || (is_now && !was_lost);
    all_lost = all_lost && (!was_lost || is_now);
  }
  if (!has_new || !all_lost) return;
  bracket_.place(after + margin, trial_);
  values->keep();
}

}  // namespace sfdae::core
