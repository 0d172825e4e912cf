// Changes of the characteristic values of a nonlinear problem during an integration.
// SPDX-License-Identifier: BSD-3-Clause
#include "array/nonlinear_change_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "linalg/index.h"
#include "system/relative_orientation.h"

namespace sfdae::core {

namespace {

// Uncertainty of a point found by interpolation, relative to the step, and the length of a step that is short enough to
// report it, relative to the first step in which it was found.
constexpr double uncertain = 0.05, short_enough = 0.25;
// Distance before the point where the solution is wanted, relative to the first step in which it was found.
constexpr double beside = 1e-6;
// Distance before the point where the vanishing part is determined, relative to the step or the way to the point.
constexpr double beside_point = 0.02;
// Least step about a singular point, in units of roundoff of t.
constexpr double roundings_about_point = 1024.0;
// A value that falls by confirmed_dip inside a step has vanished there, as for linear problems
// (docs/design/singular_points.md); first_dip suffices for values that a shorter step has yet to confirm.
constexpr double confirmed_dip = 1e-3, first_dip = 5e-2;
// Failed steps before the first look ahead, which costs as much as a few of them; then twice as many each time.
constexpr int failures_before_look = 4, most_failures = 64;
// A singular point ahead has to be at least this many failed steps away.
constexpr double many_steps = 100.0;
// Largest difference of two successive extrapolated points, relative to the distance to them.
constexpr double steadiness = 0.1;
// Consistent values that keep more than this fraction have not fallen. Chosen between the fractions at singular points,
// 1e-3 or less with few exceptions up to 0.6, and the 0.98 of false alarms.
constexpr double kept_value_not_fallen = 0.7;
// Values fall to this, and by this in the last few steps, before steps fail at a singular point.
constexpr double fallen = 1e-2, still_falling = 0.999;

struct Sized {
  double t, value;
};

// True if the line through older and last goes about as far below zero as the next value is above.
bool would_vanish(Sized older, Sized last, Sized next) {
  constexpr double about = 0.75;
  return last.value + (last.value - older.value) * (next.t - last.t) / (last.t - older.t) < -about * next.value;
}

}  // namespace

void NonlinearChangeWatch::start(double direction) {
  direction_ = direction;
  samples_ = 0;
  suspect_.reset();
  witness_.reset();
  failures_ = 0;
  expected_.reset();
  next_failure_ = failures_before_look;
  first_ = system_.jet();
  for (Fall& fall : falls_) fall = {0.0, 0.0, first_, first_, false};
  search_.course().start(first_);
  has_within_ = has_end_ = false;
  // Determinants of bases are needed rarely: reserves memory for the first one, so that no later step allocates.
  const int n = first_.n;
  {
    const Arena::Frame frame(arena_);
    arena_.take(index(n) * index(n + 8) + index(n));
  }
  const ArrayLinearization& linearization = system_.linearization();
  if (linearization.is_usable() && linearization.origin().jet.t == first_.t)
    last_.take(first_.t, linearization.data(), system_.analysis().values.mu, linearization.form());
  else if (!search_.measure(first_, last_)) return;
  samples_ = 1;
  // Sizes are known from here on: steps allocate nothing.
  older_ = within_ = end_ = last_;
  reserve_orientation(system_.differential() + system_.undetermined(), arena_);
  set_next_look();
}

// Samples the linearization of the step, and its end if that was compared or is due.
void NonlinearChangeWatch::take_samples() {
  const double t = system_.jet().t;
  const ArrayLinearization& linearization = system_.linearization();
  const int mu = system_.analysis().values.mu;
  has_within_ = has_end_ = false;
  const double t_origin = linearization.origin().jet.t;
  const bool is_new = linearization.is_usable() && (samples_ == 0 || is_after(t_origin, last_.t));
  if (is_new && !is_after(t_origin, t)) {
    within_.take(t_origin, linearization.data(), mu, linearization.form());
    has_within_ = true;
    is_within_sure_ = linearization.origin().is_judged;
    if (t_origin == t && is_within_sure_) {
      std::swap(within_, end_);
      std::swap(has_within_, has_end_);
    }
  }
  if (has_end_) return;
  const NullSpaceForm* form = system_.rank_check().compared_form(t);
  if (form != nullptr && system_.analyzed_equations().prescribed().empty()) {
    end_.take(t, system_.rank_check().compared_data(), mu, *form);
    has_end_ = true;
  } else if (samples_ < 2 || is_after(t, next_look_)) {
    has_end_ = search_.measure(system_.jet(), end_);
  }
  if (has_end_ && has_within_ && t_origin == t) has_within_ = false;
  // Predicted jets raise suspicions, but do not confirm any.
  if (!has_within_ || is_within_sure_) return;
  is_within_sure_ = has_within_ = is_suspicious(within_) && search_.measure_at(t_origin, within_);
}

// True if a sign or a value, compared with those of the neighboring samples, suggests a zero.
bool NonlinearChangeWatch::is_suspicious(const SingularitySample& now) {
  if (samples_ == 0) return false;
  if (now.is_turned_from(last_, arena_)) return true;
  for (std::size_t i = 0; i < now.values.size(); ++i) {
    const Sized last{last_.t, last_.values[i]}, here{now.t, now.values[i]};
    if (samples_ > 1 && would_vanish({older_.t, older_.values[i]}, last, here)) return true;
    if (has_end_ && would_vanish({end_.t, end_.values[i]}, here, last)) return true;
  }
  return false;
}

StepSearch NonlinearChangeWatch::find(double t_last) {
  search_.course().set_attempt(system_.jet(), system_.stages());
  // The last accepted point is measured once more if that was not possible before.
  if (samples_ == 0 && search_.measure(search_.course().newest(), last_)) samples_ = 1;
  take_samples();
  if (samples_ == 0) return {};
  return {find_in_samples(t_last)};
}

std::optional<LocatedChange> NonlinearChangeWatch::find_in_samples(double t_last) {
  search_.set_dip(is_short(t_last) ? confirmed_dip : first_dip);
  const SingularitySample* older = samples_ < 2 ? nullptr : &older_;
  const SingularitySample* last = &last_;
  bool was_turned = false;
  for (const SingularitySample* now : {&within_, &end_}) {
    if (now == &within_ ? !has_within_ : !has_end_) continue;
    const bool is_turned = now->is_turned_from(last_, arena_);
    std::optional<double> t;
    if (is_turned != was_turned) t = search_.find_turn(last->t, now->t);
    if (!t) t = search_dips(older, *last, *now);
    if (t)
      if (auto change = change_at(*t, t_last)) return change;
    was_turned = is_turned;
    older = last;
    last = now;
  }
  return find_passed(was_turned);
}

// Small steps may have passed a singular point where values are too inaccurate for a search.
std::optional<LocatedChange> NonlinearChangeWatch::find_passed(bool is_turned) {
  for (Fall& fall : falls_) fall.has_turned |= is_turned;
  if (!has_end_) return std::nullopt;
  const Jet& jet = system_.jet();
  for (std::size_t i = 0; i < 2; ++i) {
    Fall& fall = falls_[i];
    const double now = end_.values[i];
    if (now < fall.lowest) fall.lowest = now, fall.at_lowest = jet;
    const bool has_dipped = fall.highest > 0.0 && fall.lowest <= confirmed_dip * std::min(fall.highest, now);
    if (now < fall.highest && !has_dipped) continue;
    const bool is_confirmed = has_dipped && search_.kept(fall.at_highest, fall.at_lowest) <= confirmed_dip &&
                              search_.kept(jet, fall.at_lowest) <= confirmed_dip && has_passed_zero(fall, jet);
    const double t = fall.at_lowest.t;
    fall.highest = fall.lowest = now;
    fall.has_turned = false;
    fall.at_highest = fall.at_lowest = jet;
    constexpr SingularPart parts[] = {SingularPart::constraints, SingularPart::differential};
    if (is_confirmed) return LocatedChange{t, t, {}, 0.0, parts[i]};
  }
  return std::nullopt;
}

// Tells a zero from a value that is merely small for a while, as with blocking diodes: behind a zero the sign differs.
bool NonlinearChangeWatch::has_passed_zero(const Fall& fall, const Jet& now) {
  if (!witness().speaks()) return fall.has_turned;
  return !witness().keeps_signs(fall.at_lowest, fall.at_highest, now);
}

std::optional<double> NonlinearChangeWatch::search_dips(const SingularitySample* older, const SingularitySample& last,
                                                        const SingularitySample& now) {
  if (older == nullptr) return std::nullopt;
  for (std::size_t i = 0; i < now.values.size(); ++i) {
    const Sized before{older->t, older->values[i]}, here{last.t, last.values[i]}, after{now.t, now.values[i]};
    // A point of the integration may be the singular point, which a search between points would miss.
    const bool has_vanished = here.value <= confirmed_dip * std::min(before.value, after.value);
    if (has_vanished && search_.vanishes_at(last.t, older->t, now.t)) return last.t;
    if (would_vanish(before, here, after))
      if (auto t = search_.find_dip({last.t, now.t, i, here.value, after.value})) return t;
    // Values that have gone down and up again since the sample before the last one.
    if (would_vanish(after, here, before))
      if (auto t = search_.find_dip({older->t, last.t, i, before.value, here.value})) return t;
  }
  return std::nullopt;
}

// True if the step is short enough to report a point found in it.
bool NonlinearChangeWatch::is_short(double t_last) const {
  const double t = system_.jet().t, step = std::fabs(t - t_last);
  if (step <= roundings_about_point * unit_roundoff * std::max(std::fabs(t), std::fabs(t_last)) / uncertain)
    return true;
  return suspect_ && suspect_->is_near(t) && step <= short_enough * suspect_->step;
}

// A singular point at t, found in the step from t_last: to be confirmed by a shorter step, or reported. In an accepted
// step only consistent values can confirm it; in a short step they may refute it.
std::optional<LocatedChange> NonlinearChangeWatch::change_at(double t, double t_last) {
  const double step = std::fabs(system_.jet().t - t_last);
  const bool is_late = !is_after(t, t_last), is_final = is_late || is_short(t_last);
  if (is_never_singular()) return std::nullopt;
  if (is_final) {
    const std::optional<double> kept = kept_consistently(t);
    if (kept ? *kept > kept_value_not_fallen : is_late) return std::nullopt;
  }
  if (!suspect_ || !suspect_->is_near(t)) suspect_ = {t, step};
  LocatedChange change;
  change.t = t;
  change.uncertainty = is_final ? 0.0 : uncertain * step;
  if (!is_final) return change;
  // New values equal to the known ones contradict the finding and are dropped.
  change.part = search_.fallen_part_at(t - direction_ * beside_point * step);
  change.new_values = search_.values_at(t);
  if (change.new_values == system_.analysis().values) change.new_values = {};
  change.t_before =
      t - direction_ * std::max(beside * suspect_->step, roundings_about_point * unit_roundoff * std::fabs(t));
  return change;
}

StructuralWitness& NonlinearChangeWatch::witness() {
  if (!witness_) witness_.emplace(system_.analyzed_equations(), first_);
  return *witness_;
}

bool NonlinearChangeWatch::is_never_singular() { return witness().is_always_regular(); }

// Fraction kept by consistent values near t in the step that is tried; 1 if the structural analysis shows that nothing
// has vanished there.
std::optional<double> NonlinearChangeWatch::kept_consistently(double t) {
  const std::optional<Jet> jet = search_.consistent_at(t);
  if (!jet) return std::nullopt;
  if (witness().is_regular_at(*jet, search_.course().newest(), system_.jet())) return 1.0;
  return search_.kept_of(*jet);
}

void NonlinearChangeWatch::shift(SingularitySample& sample) {
  std::swap(older_, last_);
  std::swap(last_, sample);
  samples_ = std::min(samples_ + 1, 2);
}

void NonlinearChangeWatch::accept() {
  if (has_within_) shift(within_);
  if (has_end_) shift(end_);
  if (has_within_ || has_end_) {
    set_next_look();
  }
  has_within_ = has_end_ = false;
  search_.course().add(system_.jet());
}

void NonlinearChangeWatch::set_next_look() {
  next_look_ = direction_ * std::numeric_limits<double>::infinity();
  if (samples_ < 2) return;
  for (std::size_t i = 0; i < last_.values.size(); ++i) {
    const double fall = older_.values[i] - last_.values[i];
    if (fall <= 0.0) continue;
    const double look = last_.t + last_.values[i] * (last_.t - older_.t) / fall;
    if (is_after(next_look_, look)) next_look_ = look;
  }
}

std::optional<LocatedChange> NonlinearChangeWatch::find_ahead(double h) {
  if (failures_ + 1 < next_failure_ || samples_ == 0) {
    ++failures_;
    return std::nullopt;
  }
  search_.set_dip(confirmed_dip);
  const std::optional<double> t = search_.find_ahead(h);
  std::optional<LocatedChange> change;
  if (t && is_confirmed_ahead(*t, h) && kept_consistently(*t).value_or(0.0) <= kept_value_not_fallen) {
    change.emplace();
    change->t_before = search_.course().newest().t;
    change->t = *t;
    change->part = search_.fallen_part_at(*t - beside_point * (*t - change->t_before));
    change->new_values = search_.values_at(*t);
    if (change->new_values == system_.analysis().values) change->new_values = {};
  }
  // If the search throws, it is repeated after the same step.
  ++failures_;
  next_failure_ += std::min(next_failure_, most_failures);
  if (t) expected_ = *t;
  return change;
}

// False if steps may still get there, or if the extrapolated point has moved.
bool NonlinearChangeWatch::is_confirmed_ahead(double t, double h) const {
  const double distance = std::fabs(t - search_.course().newest().t);
  return expected_ && distance >= many_steps * std::fabs(h) && std::fabs(t - *expected_) <= steadiness * distance;
}

std::optional<LocatedChange> NonlinearChangeWatch::find_beyond() {
  const Jet& jet = search_.course().newest();
  const double t = jet.t;
  LocatedChange change;
  change.t_before = t;
  // Already found, but no short step leads there.
  if (suspect_ && is_after(suspect_->t, t) && suspect_->is_near(t)) {
    change.t = suspect_->t;
    return change;
  }
  const Jet& earlier = search_.course().oldest();
  if (earlier.t == t) return std::nullopt;
  const double kept = search_.kept(earlier, jet), kept_since_start = search_.kept(first_, jet);
  const bool is_falling = kept <= still_falling;
  if (kept_since_start > (is_falling ? fallen : confirmed_dip)) return std::nullopt;
  if (search_.kept_consistently_at_end(first_, jet).value_or(0.0) > kept_value_not_fallen) return std::nullopt;
  if (witness().is_regular_at(jet, first_, first_)) return std::nullopt;
  change.part = search_.fallen_part(jet);
  // Determinants vanish like a square root where solutions end. In tiny steps the point is here.
  change.t = is_falling ? t + (t - earlier.t) * kept * kept / (1.0 - kept * kept) : t;
  return change;
}

void NonlinearChangeWatch::archive(Archive& archive, double direction) {
  if (archive.is_reading()) start(direction);
}

}  // namespace sfdae::core
