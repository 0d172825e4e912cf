// Signs with which event functions are armed.
// SPDX-License-Identifier: BSD-3-Clause
#include "watch/event_signs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "watch/zero_bracket.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Residues of g after an event that are below this part of its size around the event are due to the accuracy of the
// zero. (Chosen between rounding errors and tolerances, far from both.)
constexpr double residue = 1e-6;
// A function has left zero when it is this many times larger than its residue. (Chosen.)
constexpr double clearly_larger = 4.0;
// Attempts to arm a function, at the cost of a reduction each, before it is considered dominated by roundoff; then only
// points that are evaluated anyway can arm it. (Chosen.)
constexpr int max_attempts = 6;
// Rounding errors elsewhere may be this many times larger than those measured. (Chosen.)
constexpr double noise_factor = 4.0;

}  // namespace

EventSigns::EventSigns(std::vector<int> directions) : directions_(std::move(directions)) {
  const std::size_t size = directions_.size();
  for (Vector* v : {&threshold_, &size_, &noise_}) v->assign(size, 0.0);
  for (std::vector<int>* v : {&signs_, &fired_, &vain_}) v->assign(size, 0);
  is_clear_at_start_.assign(size, 0);
}

void EventSigns::forget_event() { std::fill(fired_.begin(), fired_.end(), 0); }

void EventSigns::start(const Vector& g) {
  for (std::size_t i = 0; i < signs_.size(); ++i) {
    signs_[i] = vain_[i] = 0;
    const bool is_residue = fired_[i] != 0 && is_clear_at_start_[i] == 0;
    threshold_[i] = is_residue ? threshold_after_event(i, g[i]) : 0.0;
  }
}

void EventSigns::update(EventValues& values, const Vector& g) {
  bool has_noise = false;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (is_lost(i, g[i])) {
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

bool EventSigns::is_rounding(std::size_t i, double g, double other_g) const {
  return signs_[i] == 0 && std::fmax(std::fabs(g), std::fabs(other_g)) <= noise_factor * noise_[i];
}

bool EventSigns::is_lost(std::size_t i, double g) const { return ZeroBracket::is_lost(signs_[i], g); }

bool EventSigns::is_suspicious(const Vector& g) const {
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (is_lost(i, g[i])) return true;
    if (signs_[i] == 0 && std::fabs(g[i]) > threshold_[i] && vain_[i] < max_attempts) return true;
  }
  return false;
}

bool EventSigns::is_event(const Vector& g) const {
  for (std::size_t i = 0; i < g.size(); ++i)
    if (counts(i) && is_lost(i, g[i])) return true;
  return false;
}

void EventSigns::watch(std::vector<int>& watched) const {
  for (std::size_t i = 0; i < watched.size(); ++i) watched[i] = counts(i) ? signs_[i] : 0;
}

bool EventSigns::disarm(const std::vector<int>& watched, const Surroundings& g, bool is_at_start) {
  bool has_fired = false;
  for (std::size_t i = 0; i < watched.size(); ++i) {
    if (!ZeroBracket::is_lost(watched[i], g.at[i])) continue;
    if (!is_at_start || is_clear_at_start_[i] != 0) {
      fired_[i] = -signs_[i];
      has_fired = true;
    }
    signs_[i] = vain_[i] = 0;
    size_[i] = std::max(std::fabs(g.before[i]), std::fabs(g.after[i]));
    threshold_[i] = threshold_after_event(i, g.at[i]);
  }
  return has_fired;
}

// A function that jumped over zero, or was changed at the event, may be armed at once.
double EventSigns::threshold_after_event(std::size_t i, double g) const {
  return std::fabs(g) <= residue * size_[i] ? clearly_larger * std::fabs(g) : 0.0;
}

void EventSigns::archive(Archive& archive) {
  for (Vector* v : {&threshold_, &size_, &noise_}) archive.reals(v->data(), v->size());
  for (std::size_t i = 0; i < signs_.size(); ++i) {
    int sign = signs_[i] + 1, fired = fired_[i] + 1;
    archive.small(sign, fired, vain_[i]);
    if (vain_[i] < 0 || sign < 0 || sign > 2 || fired < 0 || fired > 2) throw DamagedArchive();
    signs_[i] = sign - 1;
    fired_[i] = fired - 1;
  }
}

}  // namespace sfdae::core
