// Zeros of event functions: search and location.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/events.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

constexpr double epsilon = std::numeric_limits<double>::epsilon();
// Halvings beyond those that are asked for, where a function might dip through zero between two points.
constexpr int more_halvings = 8;
// The interval around a guess that counts as hit, in units of the interval searched.
constexpr double near_guess = 1e-9;
// Of the size of g around an event: below, what is left of it is the inaccuracy of a zero.
constexpr double residue = 1e-6;
// A function has left zero when it is this much larger than what was left.
constexpr double clearly_larger = 4.0;
// Closer looks whether a function is to be armed, which cost a reduction each, before it is taken for rounding errors; then
// only points that are looked at anyway can arm it.
constexpr int max_attempts = 6;

}  // namespace

// ---- ZeroBracket ----

void ZeroBracket::resize(int count) {
  const std::size_t size = index(count);
  signs_.resize(size);
  g_before_.resize(size);
  g_after_.resize(size);
}

void ZeroBracket::start(const std::vector<int>& signs, double before, const Vector& g_before, double after,
                        const Vector& g_after) {
  signs_ = signs;
  before_ = before, after_ = after;
  g_before_ = g_before, g_after_ = g_after;
  // A zero at t = 0 has no relative accuracy.
  floor_ = 1e-6 * epsilon * std::fabs(after - before);
  factor_ = 1.0;
  last_side_ = 0;
  old_width_ = std::fabs(after - before);
  steps_ = 0;
  slow_rounds_ = 0;
}

bool ZeroBracket::is_lost(const Vector& g) const {
  for (std::size_t i = 0; i < g.size(); ++i)
    if (is_lost(signs_[i], g[i])) return true;
  return false;
}

double ZeroBracket::resolution() const {
  return std::max(2.0 * epsilon * std::max(std::fabs(before_), std::fabs(after_)), floor_);
}

bool ZeroBracket::is_resolved() const { return std::fabs(after_ - before_) <= resolution(); }

// The earliest zero of the chords of all functions that lose their signs.
double ZeroBracket::secant() const {
  double earliest = 1.0;
  for (std::size_t i = 0; i < signs_.size(); ++i) {
    if (!is_lost(signs_[i], g_after_[i])) continue;
    const double before = factor_ * std::fabs(g_before_[i]), after = std::fabs(g_after_[i]);
    earliest = std::min(earliest, before / (before + after));
  }
  return before_ + earliest * (after_ - before_);
}

double ZeroBracket::next() {
  // Chords tell nothing about functions that jump: bisection from then on.
  constexpr int patience = 3, given_up = 3;
  const double width = after_ - before_;
  double t = secant();
  const bool round_is_over = steps_ >= patience;
  const bool is_slow = round_is_over && std::fabs(width) > 0.5 * old_width_;
  if (is_slow) ++slow_rounds_;
  if (is_slow || slow_rounds_ >= given_up) t = before_ + 0.5 * width;
  if (round_is_over) {
    steps_ = 0;
    old_width_ = std::fabs(width);
  }
  // Not onto the ends: a point beside an end that hits the zero closes the bracket.
  const double margin = std::copysign(std::min(0.5 * resolution(), 0.5 * std::fabs(width)), width);
  const double first = before_ + margin, last = after_ - margin;
  if (!((t - first) * width > 0.0)) t = first;
  if (!((last - t) * width > 0.0)) t = last;
  return t;
}

bool ZeroBracket::place(double t, const Vector& g) {
  const bool lost = is_lost(g);
  const int side = lost ? 1 : -1;
  factor_ = side != last_side_ ? 1.0 : lost ? 0.5 * factor_ : 2.0 * factor_;
  last_side_ = side;
  ++steps_;
  (lost ? after_ : before_) = t;
  (lost ? g_after_ : g_before_) = g;
  return lost;
}

// ---- EventSearch ----

EventSearch::EventSearch(std::vector<int> directions) : directions_(std::move(directions)) {
  const std::size_t size = directions_.size();
  for (Vector* v : {&g_, &threshold_, &size_, &trial_, &rough_before_, &rough_after_, &noise_, &from_.g})
    v->assign(size, 0.0);
  for (std::vector<int>* v : {&signs_, &fired_, &vain_, &watched_}) v->assign(size, 0);
  pending_.resize(max_pending);
  for (Sample& sample : pending_) {
    sample.g.resize(size);
    sample.bend.resize(size);
  }
  bracket_.resize(count());
  rough_bracket_.resize(count());
}

void EventSearch::forget_event() { std::fill(fired_.begin(), fired_.end(), 0); }

void EventSearch::determine(EventValues& values, double t, bool may_improve, Vector& g) {
  has_determined_ = false;
  values.determine(t, may_improve, g.data());
  determined_t_ = t;
  has_determined_ = true;
}

void EventSearch::start(EventValues& values, double t, double rounding) {
  determine(values, t, true, trial_);
  if (t != t_) forget_event();
  start_ = t;
  start_rounding_ = rounding;
  for (std::size_t i = 0; i < signs_.size(); ++i) {
    signs_[i] = vain_[i] = 0;
    threshold_[i] = fired_[i] != 0 ? threshold_after_event(i, trial_[i]) : 0.0;
  }
  values.keep();
  move_on(values, t, trial_);
  started_ = true;
}

void EventSearch::move_on(EventValues& values, double t, const Vector& g) {
  update_signs(values, g);
  values.accept();
  t_ = t;
  g_ = g;
}

// Changes that do not count are followed silently; functions that have left zero are armed.
void EventSearch::update_signs(EventValues& values, const Vector& g) {
  bool has_noise = false;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (ZeroBracket::is_lost(signs_[i], g[i])) {
      signs_[i] = vain_[i] = 0;
      threshold_[i] = 0.0;
    }
    if (signs_[i] != 0) continue;
    if (!has_noise && std::fabs(g[i]) > threshold_[i]) {
      values.rounding(noise_.data());
      has_noise = true;
    }
    if (std::fabs(g[i]) > threshold_[i] && std::fabs(g[i]) > noise_[i]) signs_[i] = g[i] > 0.0 ? 1 : -1;
    else vain_[i] = std::min(vain_[i] + 1, max_attempts);
  }
}

bool EventSearch::search(EventValues& values, double end, int depth) {
  forget_event();
  from_.t = t_;
  from_.g = g_;
  num_pending_ = 1;
  pending_[0].t = end;
  pending_[0].depth = 0;
  determine(values, end, true, pending_[0].g);
  while (num_pending_ > 0) {
    Sample& to = pending_[num_pending_ - 1];
    if (must_split(to, depth)) {
      split(values);
      continue;
    }
    if (num_pending_ == 1 || is_suspicious(to.g)) {
      if (!has_determined_ || determined_t_ != to.t) determine(values, to.t, true, to.g);
      values.keep();
      if (is_event(to.g)) {
        if (locate(values, to)) return true;
        // What belongs to the start is past: the rest of the interval remains.
        from_.t = t_;
        from_.g = g_;
        continue;
      }
      move_on(values, to.t, to.g);
    }
    from_.t = to.t;
    from_.g = to.g;
    --num_pending_;
  }
  return false;
}

// Between two points of one sign a parabola with second difference `bend` over twice the interval comes closer to zero
// by bend / 8 than its ends do; the factor of 4 is for what is no parabola.
bool EventSearch::must_split(const Sample& to, int depth) const {
  const double middle = from_.t + 0.5 * (to.t - from_.t);
  if (middle == from_.t || middle == to.t || num_pending_ == pending_.size()) return false;
  if (to.depth < depth) return true;
  if (to.depth >= depth + more_halvings || to.depth == 0) return false;
  for (std::size_t i = 0; i < to.g.size(); ++i) {
    if (ZeroBracket::is_lost(signs_[i], to.g[i])) continue;
    if (std::min(std::fabs(from_.g[i]), std::fabs(to.g[i])) < 0.5 * to.bend[i]) return true;
  }
  return false;
}

void EventSearch::split(EventValues& values) {
  Sample& to = pending_[num_pending_ - 1];
  Sample& middle = pending_[num_pending_++];
  middle.t = from_.t + 0.5 * (to.t - from_.t);
  if (!values.approximate(middle.t, middle.g.data())) determine(values, middle.t, true, middle.g);
  middle.depth = ++to.depth;
  for (std::size_t i = 0; i < to.g.size(); ++i)
    middle.bend[i] = to.bend[i] = std::fabs(from_.g[i] - 2.0 * middle.g[i] + to.g[i]);
}

bool EventSearch::is_suspicious(const Vector& g) const {
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (ZeroBracket::is_lost(signs_[i], g[i])) return true;
    if (signs_[i] == 0 && std::fabs(g[i]) > threshold_[i] && vain_[i] < max_attempts) return true;
  }
  return false;
}

bool EventSearch::is_event(const Vector& g) const {
  for (std::size_t i = 0; i < g.size(); ++i)
    if (counts(i) && ZeroBracket::is_lost(signs_[i], g[i])) return true;
  return false;
}

// Where g jumped over zero, or was changed at the event, it may be armed at once.
double EventSearch::threshold_after_event(std::size_t i, double g) const {
  return std::fabs(g) <= residue * size_[i] ? clearly_larger * std::fabs(g) : 0.0;
}

// False if the zero found belongs to the start.
bool EventSearch::locate(EventValues& values, const Sample& to) {
  for (std::size_t i = 0; i < watched_.size(); ++i) watched_[i] = counts(i) ? signs_[i] : 0;
  narrow(values, to);
  include_simultaneous(values, to.t);
  const Vector& g = bracket_.g_after();
  const bool at_start = std::fabs(bracket_.after() - start_) <= start_rounding_;
  for (std::size_t i = 0; i < watched_.size(); ++i) {
    if (!ZeroBracket::is_lost(watched_[i], g[i])) continue;
    if (!at_start) fired_[i] = -signs_[i];
    signs_[i] = vain_[i] = 0;
    size_[i] = std::max(std::fabs(g_[i]), std::fabs(to.g[i]));
    threshold_[i] = threshold_after_event(i, g[i]);
  }
  move_on(values, bracket_.after(), g);
  return !at_start;
}

// The first guess comes from cheap values; what counts are those that are returned. The end `to` is kept already.
void EventSearch::narrow(EventValues& values, const Sample& to) {
  bracket_.start(watched_, t_, g_, to.t, to.g);
  double t = to.t;
  if (guess(values, to.t, t)) {
    determine(values, t, false, trial_);
    if (bracket_.place(t, trial_)) values.keep();
  }
  while (!bracket_.is_resolved()) {
    t = bracket_.next();
    if (t == bracket_.before() || t == bracket_.after()) break;
    determine(values, t, false, trial_);
    if (bracket_.place(t, trial_)) values.keep();
  }
}

// A zero of the cheap values at t, strictly inside. To determine the values that are returned there may make the cheap
// ones better: then it is worth while to look again. From then on nothing changes any more.
bool EventSearch::guess(EventValues& values, double to, double& t) {
  constexpr int max_rounds = 3;
  const double from = from_.t;
  bool found = false;
  for (int round = 0; round < max_rounds; ++round) {
    if (!values.approximate(from, rough_before_.data()) || !values.approximate(to, rough_after_.data())) return found;
    rough_bracket_.start(watched_, from, rough_before_, to, rough_after_);
    if (rough_bracket_.is_lost(rough_before_) || !rough_bracket_.is_lost(rough_after_)) return found;
    while (!rough_bracket_.is_resolved()) {
      const double middle = rough_bracket_.next();
      if (middle == rough_bracket_.before() || middle == rough_bracket_.after()) break;
      if (!values.approximate(middle, rough_after_.data())) return found;
      rough_bracket_.place(middle, rough_after_);
    }
    const double zero = rough_bracket_.after();
    if (found && std::fabs(zero - t) <= near_guess * std::fabs(to - from)) return true;
    if (zero == to || zero == t_) return found;
    t = zero;
    determine(values, t, true, trial_);
    found = true;
  }
  return found;
}

// Zeros that are one but for rounding errors are one event.
void EventSearch::include_simultaneous(EventValues& values, double limit) {
  const double after = bracket_.after();
  const double margin = std::copysign(4.0 * bracket_.resolution(), limit - from_.t);
  if (!((limit - after - margin) * margin > 0.0)) return;
  const auto is_new = [&](std::size_t i, const Vector& g) {
    return ZeroBracket::is_lost(watched_[i], g[i]) && !ZeroBracket::is_lost(watched_[i], bracket_.g_after()[i]);
  };
  bool others = false;
  for (std::size_t i = 0; i < watched_.size(); ++i)
    others = others || (watched_[i] != 0 && !ZeroBracket::is_lost(watched_[i], bracket_.g_after()[i]));
  if (!others) return;
  determine(values, after + margin, false, trial_);
  bool has_new = false, all_lost = true;
  for (std::size_t i = 0; i < watched_.size(); ++i) {
    has_new = has_new || is_new(i, trial_);
    all_lost = all_lost && (!ZeroBracket::is_lost(watched_[i], bracket_.g_after()[i]) ||
                            ZeroBracket::is_lost(watched_[i], trial_[i]));
  }
  if (!has_new || !all_lost) return;
  bracket_.place(after + margin, trial_);
  values.keep();
}

void EventSearch::archive(Archive& archive) {
  archive.small(started_);
  for (double* value : {&t_, &start_, &start_rounding_}) archive.real(*value);
  for (Vector* v : {&g_, &threshold_, &size_}) archive.reals(v->data(), v->size());
  for (std::size_t i = 0; i < signs_.size(); ++i) {
    int sign = signs_[i] + 1, fired = fired_[i] + 1;
    archive.small(sign, fired, vain_[i]);
    if (vain_[i] < 0 || sign < 0 || sign > 2 || fired < 0 || fired > 2) throw DamagedArchive();
    signs_[i] = sign - 1;
    fired_[i] = fired - 1;
  }
}

}  // namespace sfdae::core
