// Detection of singular points between steps of the extension.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/extension_change_watch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/index.h"
#include "linalg/rank.h"

namespace sfdae::core {

namespace {

// Uncertainty of the point found, relative to the step, as x is interpolated.
constexpr double uncertain = 0.02;
// Step that is short enough to report a point, relative to the step in which it was found first.
constexpr double short_enough = 1e-5;
// Determinants that vanish, and do not only jump, have then fallen by this factor: to first order by short_enough, by
// its root where solutions end.
constexpr double vanished = 1e-2;
// Least step about a singular point, in units of roundoff of t.
constexpr double roundings = 1024.0;
// A determinant that falls by this factor inside a step may touch zero there.
constexpr double dip = 5e-2;
// Determinants of many unknowns vary by orders of magnitude, all pivots together: their dips mean nothing. Chosen, not
// measured.
constexpr int most_unknowns = 10;
// Before steps fail at a singular point, determinants have fallen to this fraction of their largest value, and by this
// factor in the last step, which is tiny.
constexpr double fallen = 1e-2, still_falling = 0.999;

double ratio(double log2, double log2_of_reference) { return std::exp2(std::min(log2 - log2_of_reference, 900.0)); }

}  // namespace

ExtensionChangeWatch::ExtensionChangeWatch(ExtensionSystem& system)
    : system_(system),
      determinants_(system.extension().structure(), system.extension().leading(),
                    system.extension().problem().evaluator()) {}

bool ExtensionChangeWatch::measure(const Jet& jet, Sample& sample) {
  sample.jet = jet;
  sample.jet.set_order(determinants_.jet_order());
  return determinants_.measure(sample.t(), sample.jet.x.data(), sample.values);
}

void ExtensionChangeWatch::start(double direction) {
  direction_ = direction;
  samples_ = 0;
  has_now_ = false;
  suspect_.reset();
  highest_.assign(index(determinants_.count()), -HUGE_VAL);
  accept();
}

void ExtensionChangeWatch::accept() {
  if (determinants_.count() == 0) return;
  // Steps across kinks are accepted without a search.
  if (!has_now_ || now_.t() != system_.jet().t) has_now_ = measure(system_.jet(), now_);
  if (!has_now_) return;
  has_now_ = false;
  std::swap(older_, last_);
  std::swap(last_, now_);
  samples_ = std::min(samples_ + 1, 2);
  for (std::size_t k = 0; k < highest_.size(); ++k)
    if (last_.values[k].sign != 0) highest_[k] = std::max(highest_[k], last_.values[k].log2);
}

// The last accepted point is measured once more if that was not possible before.
bool ExtensionChangeWatch::has_sample() {
  if (samples_ == 0 && measure(system_.accepted_jet(), last_)) samples_ = 1;
  return samples_ > 0;
}

StepSearch ExtensionChangeWatch::find(double) {
  if (determinants_.count() == 0) return {};
  has_now_ = has_sample() && measure(system_.jet(), now_);
  if (!has_now_) return {std::nullopt, false};
  if (const std::optional<int> block = turned_block(now_)) return {change_at(find_turn(*block), *block)};
  if (const std::optional<int> block = dipping_block()) return find_dip(*block);
  return {};
}

std::optional<int> ExtensionChangeWatch::turned_block(const Sample& now) const {
  for (std::size_t k = 0; k < now.values.size(); ++k)
    if (now.values[k].sign != last_.values[k].sign) return static_cast<int>(k);
  return std::nullopt;
}

// A block for which the line through the two points before goes about as far below zero as the value is above, or below
// zero if the value has turned: steps may end far beyond the point.
std::optional<int> ExtensionChangeWatch::dipping_block() const {
  constexpr double about = 0.75;
  if (samples_ < 2) return std::nullopt;
  const double part = (now_.t() - last_.t()) / (last_.t() - older_.t());
  for (std::size_t k = 0; k < now_.values.size(); ++k) {
    if (determinants_.size(static_cast<int>(k)) > most_unknowns) continue;
    const double reference = older_.values[k].log2, last = ratio(last_.values[k].log2, reference),
                 now = ratio(now_.values[k].log2, reference);
    const double expected = last + (last - 1.0) * part;
    const bool has_turned = expected < 0.0 && now > last;
    if (expected < -about * now || has_turned) return static_cast<int>(k);
  }
  return std::nullopt;
}

// Measures at this part of the way from the last point to the one tried. x and x' follow the cubic polynomial through
// both points and their slopes; a straight line misses determinants that touch zero within long steps.
bool ExtensionChangeWatch::measure_between(double part) {
  Jet& jet = between_.jet;
  jet = last_.jet;
  const double h = now_.t() - last_.t(), rest = 1.0 - part;
  jet.t = last_.t() + part * h;
  for (std::size_t i = 0; i < jet.x.size(); ++i) jet.x[i] += part * (now_.jet.x[i] - last_.jet.x[i]);
  for (int i = 0; i < jet.n && jet.order > 0; ++i) {
    const double x0 = last_.jet.column(0)[i], change = now_.jet.column(0)[i] - x0;
    const double v0 = h * last_.jet.column(1)[i], v1 = h * now_.jet.column(1)[i];
    const double bend0 = v0 - change, bend1 = change - v1;
    jet.column(0)[i] = x0 + part * (change + rest * (rest * bend0 + part * bend1));
    jet.column(1)[i] =
        (change + (1.0 - 2.0 * part) * (rest * bend0 + part * bend1) + part * rest * (bend1 - bend0)) / h;
  }
  return determinants_.measure(jet.t, jet.x.data(), between_.values);
}

double ExtensionChangeWatch::find_turn(int block) {
  constexpr int halvings = 20;
  double left = 0.0, right = 1.0;
  for (int k = 0; k < halvings; ++k) {
    const double middle = 0.5 * (left + right);
    const bool is_after =
        !measure_between(middle) || between_.values[index(block)].sign != last_.values[index(block)].sign;
    (is_after ? right : left) = middle;
  }
  return last_.t() + 0.5 * (left + right) * (now_.t() - last_.t());
}

// Golden-section search.
StepSearch ExtensionChangeWatch::find_dip(int block) {
  constexpr double golden = 0.3819660112501051;
  constexpr int most = 40;
  bool is_complete = true;
  const auto size_at = [&](double part) {
    if (!measure_between(part)) {
      is_complete = false;
      return HUGE_VAL;
    }
    const BlockDeterminants::Value& value = between_.values[index(block)];
    return value.sign == 0 ? -HUGE_VAL : value.log2;
  };
  double left = 0.0, middle = golden, right = 1.0, least = size_at(middle);
  for (int k = 0; k < most; ++k) {
    const bool is_right_longer = right - middle > middle - left;
    const double next = middle + golden * ((is_right_longer ? right : left) - middle), size = size_at(next);
    double& beyond = is_right_longer ? left : right;
    double& here = is_right_longer ? right : left;
    if (size < least) beyond = middle, middle = next, least = size;
    else here = next;
  }
  const double ends = std::min(last_.values[index(block)].log2, now_.values[index(block)].log2);
  if (!(least < ends + std::log2(dip))) return {std::nullopt, is_complete};
  return {change_at(last_.t() + middle * (now_.t() - last_.t()), block)};
}

// A change at t, in the step that is tried: to be confirmed by a shorter step, or reported, or dismissed as a jump.
std::optional<LocatedChange> ExtensionChangeWatch::change_at(double t, int block) {
  const double step = std::fabs(now_.t() - last_.t()), t_size = std::max(std::fabs(now_.t()), std::fabs(last_.t()));
  const double size = std::max(last_.values[index(block)].log2, now_.values[index(block)].log2);
  if (!suspect_ || suspect_->block != block || std::fabs(t - suspect_->t) > suspect_->step)
    suspect_ = Suspect{t, step, size, block};
  suspect_->t = t;
  LocatedChange change;
  change.t = t;
  change.uncertainty = uncertain * step;
  const double shortest = roundings * unit_roundoff * t_size;
  if (step > std::max(short_enough * suspect_->step, shortest / uncertain)) return change;
  // If steps cannot become so much shorter, jumps cannot be told from zeros.
  const bool can_tell = short_enough * suspect_->step >= shortest;
  if (can_tell && size > suspect_->log2 + std::log2(vanished)) return std::nullopt;
  change.uncertainty = 0.0;
  change.t_before = t - direction_ * std::max(uncertain * step, shortest);
  if ((change.t_before - last_.t()) * direction_ < 0.0) change.t_before = last_.t();
  system_.note_singular_block(determinants_.number(block));
  return change;
}

// Extrapolates as a square root, which is how determinants vanish where solutions end.
std::optional<LocatedChange> ExtensionChangeWatch::find_beyond() {
  if (samples_ < 2) return std::nullopt;
  LocatedChange change;
  change.t_before = change.t = last_.t();
  for (std::size_t k = 0; k < highest_.size(); ++k) {
    const double now = last_.values[k].log2, kept = ratio(now, older_.values[k].log2);
    if (ratio(now, highest_[k]) > fallen || kept > still_falling) continue;
    change.t += (last_.t() - older_.t()) * kept * kept / (1.0 - kept * kept);
    system_.note_singular_block(determinants_.number(static_cast<int>(k)));
    return change;
  }
  return std::nullopt;
}

// Determinants are not archived but measured again.
void ExtensionChangeWatch::archive(Archive& archive, double direction) {
  if (archive.is_reading()) start(direction);
  if (determinants_.count() == 0) return;
  bool has_suspect = suspect_.has_value();
  archive.small(has_suspect, samples_);
  if (samples_ < 0 || samples_ > 2) throw DamagedArchive();
  archive.reals(highest_, highest_.size());
  Sample* const newest_first[] = {&last_, &older_};
  for (int i = 0; i < samples_; ++i) {
    Jet& jet = newest_first[i]->jet;
    archive.real(jet.t);
    archive.reals(jet.x, index(system_.unknowns()) * index(determinants_.jet_order() + 1));
    if (!archive.is_reading()) continue;
    jet.n = system_.unknowns();
    jet.order = determinants_.jet_order();
    if (!determinants_.measure(jet.t, jet.x.data(), newest_first[i]->values)) throw DamagedArchive();
  }
  if (!has_suspect) return;
  if (archive.is_reading()) suspect_.emplace();
  double block = suspect_->block;
  for (double* number : {&suspect_->t, &suspect_->step, &suspect_->log2, &block}) archive.real(*number);
  if (!(block >= 0.0 && block < determinants_.count())) throw DamagedArchive();
  suspect_->block = static_cast<int>(block);
}

}  // namespace sfdae::core
