// Choice of step size and number of stages for the Radau methods.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/radau_control.h"

#include <algorithm>
#include <cmath>

#include "integrate/radau_method.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Replaces an error of zero.
constexpr double least_positive_error = 1e-30;
// Bound on the ratio of step sizes, whatever the options: estimates are not trusted beyond it. (Chosen.)
constexpr double largest_ratio = 1e3;
// A new number of stages must promise this much more progress for the same work (docs/design/radau.md).
constexpr double worthwhile = 1.2;
// A step of one stage cannot predict errors with more stages: one stage must promise twice the progress. (Chosen.)
constexpr double reluctance = 2.0;
// Limit of an extrapolated logarithm: e^50 is never chosen, and does not overflow.
constexpr double largest_log = 50.0;
// Lower limits of errors: for the ratio of steps (chosen), and for the last error in predictive control (that of RADAU5
// [HW96, IV.8]).
constexpr double least_stage_error = 1e-10, least_last_error = 1e-2;
// Upper limit of the count of steps with one number of stages: a checkpoint stores small integers.
constexpr int most_steps_with_stages = 1000;
// h_new / h_old after a failed error test: overflow; lower limit for the very first step; limits for later ones.
// (Chosen; the first step may be wrong by orders of magnitude.)
constexpr double fall_at_overflow = 0.1, lowest_first_ratio = 1e-3, lowest_ratio = 0.5, highest_ratio = 0.9;
// Reduction of the safety factor: unit, units for a rejected step (the first of several consecutive ones), and maximum;
// each accepted step takes back one unit, so that about one step in twenty is rejected (docs/design/radau.md).
constexpr double part_of_safety = 0.0025;
constexpr int caution_of_rejection = 20, most_caution = 80;
// h_new / h_old if a step failed without an estimate, as in DASSL.
constexpr double fall_at_failure = 0.25;

// |h^k w[k]| by geometric interpolation and extrapolation of the known values.
double decay_at(int k, const ErrorTerms& terms) {
  int below = 0, above = 0, highest = 0, before = 0;
  for (int j = 1; j <= 2 * max_stages; ++j) {
    if (terms.decay[index(j)] < 0.0) continue;
    if (j <= k) below = j;
    if (j >= k && above == 0) above = j;
    before = highest;
    highest = j;
  }
  const auto value = [&](int j) { return std::max(terms.decay[index(j)], least_positive_error); };
  if (below == k) return value(k);
  if (below == 0 || highest == 0) return 1.0 / least_positive_error;
  if (above > 0) {
    const double weight = static_cast<double>(k - below) / (above - below);
    return std::pow(value(below), 1.0 - weight) * std::pow(value(above), weight);
  }
  // Odd and even terms may differ much: do not extrapolate from neighbors if there are others.
  if (highest - before == 1 && before > 1 && terms.decay[index(before - 1)] >= 0.0) before -= 1;
  if (before == 0) return 1.0 / least_positive_error;
  const double per_order = std::log(value(highest) / value(before)) / (highest - before);
  return value(highest) * std::exp(std::min(per_order * (k - highest), largest_log));
}

}  // namespace

ErrorTerms larger_of(const ErrorTerms& one, const ErrorTerms& other) {
  const auto wanted_step = [](const ErrorTerms& terms) {
    return std::pow(std::max(terms.error, least_positive_error), -1.0 / terms.exponent);
  };
  const bool is_other = !(other.error <= 1.0) || (one.error <= 1.0 && wanted_step(other) < wanted_step(one));
  ErrorTerms larger = is_other ? other : one;
  for (std::size_t k = 0; k < larger.decay.size(); ++k)
    larger.decay[k] = one.decay[k] < 0.0 || other.decay[k] < 0.0 ? -1.0 : std::max(one.decay[k], other.decay[k]);
  return larger;
}

void RadauControl::start(const StepOptions& options) {
  *this = RadauControl();
  set_options(options);
}

void RadauControl::set_options(const StepOptions& options) {
  options_ = options;
  options_.fastest_rise = std::max(options.fastest_rise, 1.0 / largest_ratio);
  options_.fastest_fall = std::min(options.fastest_fall, largest_ratio);
  stages_ = std::clamp(stages_, options.min_stages, options.max_stages);
}

double RadauControl::safety() const { return options_.safety * (1.0 - part_of_safety * caution_); }

double RadauControl::limited(double ratio) const {
  return std::clamp(ratio, 1.0 / options_.fastest_fall, 1.0 / options_.fastest_rise);
}

// Ratio of step sizes for which the error of the method with s stages would match the tolerance. Not limited: with
// steps cut short by outputs all would reach the limits, and the fewest stages would look best.
double RadauControl::step_for_stages(int s, const ErrorTerms& terms) const {
  const double error = radau_method(s).error_constant * decay_at(2 * s, terms);
  return safety() * std::pow(std::max(error, least_positive_error), -1.0 / (2 * s));
}

// Chooses the number of stages with the best progress for its work; returns its ratio of step sizes.
double RadauControl::choose_stages(const ErrorTerms& terms, const StageCosts& costs, double ratio) {
  const double present = step_for_stages(stages_, terms) / costs.work[index(stages_)];
  int best = stages_;
  double best_progress = worthwhile * present;
  for (int s : {stages_ - 2, stages_ + 2}) {
    if (s < options_.min_stages || s > options_.max_stages) continue;
    if (s < stages_ && steps_with_stages_ < 2) continue;
    const double progress = step_for_stages(s, terms) / costs.work[index(s)] / (s == 1 ? reluctance : 1.0);
    if (progress > best_progress) {
      best = s;
      best_progress = progress;
    }
  }
  if (best == stages_) return ratio;
  stages_ = best;
  steps_with_stages_ = 0;
  last_h_ = 0.0;
  return limited(step_for_stages(best, terms));
}

double RadauControl::accepted(double h, const ErrorTerms& terms, const StageCosts& costs, bool keep) {
  caution_ = std::max(caution_ - 1, 0);
  const double error = std::max(terms.error, least_stage_error), power = 1.0 / terms.exponent;
  double ratio = safety() * std::pow(error, -power);
  // Gustafsson's predictive control [HW96, IV.8].
  if (!options_.classical_control && last_h_ != 0.0)
    ratio = std::min(ratio, ratio * (h / last_h_) * std::pow(last_error_ / error, power));
  ratio = limited(ratio);
  last_h_ = h;
  last_error_ = std::max(error, least_last_error);
  steps_with_stages_ = std::min(steps_with_stages_ + 1, most_steps_with_stages);
  if (may_change_stages()) ratio = choose_stages(terms, costs, ratio);
  if (failures_ > 0) ratio = std::min(ratio, 1.0);
  failures_ = 0;
  any_accepted_ = true;
  if (keep && ratio >= options_.keep_from && ratio <= options_.keep_to) return h;
  return ratio * h;
}

double RadauControl::accepted_without_error(double h) {
  failures_ = 0;
  return h / options_.fastest_rise;
}

double RadauControl::rejected(double h, const ErrorTerms& terms) {
  ++failures_;
  if (failures_ == 1) caution_ = std::min(caution_ + caution_of_rejection, most_caution);
  last_h_ = 0.0;
  if (!std::isfinite(terms.error)) return fall_at_overflow * h;
  // The first step size was only an estimate.
  const double lowest = any_accepted_ ? std::min(1.0 / options_.fastest_fall, lowest_ratio) : lowest_first_ratio;
  return h * std::clamp(safety() * std::pow(terms.error, -1.0 / terms.exponent), lowest, highest_ratio);
}

double RadauControl::failed(double h) {
  ++failures_;
  last_h_ = 0.0;
  return fall_at_failure * h;
}

void RadauControl::archive(Archive& archive) {
  archive.small(stages_, failures_, steps_with_stages_, any_accepted_, caution_);
  archive.real(last_h_);
  archive.real(last_error_);
  const bool plausible =
      stages_ >= 1 && stages_ <= max_stages && stages_ % 2 == 1 && caution_ >= 0 && caution_ <= most_caution;
  if (archive.is_reading() && !plausible) throw DamagedArchive();
  set_options(options_);
}

}  // namespace sfdae::core
