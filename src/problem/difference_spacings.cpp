// Spacings of finite differences, chosen for every entry of a function.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/difference_spacings.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"
#include "problem/chebyshev_differences.h"

namespace sfdae::core {

namespace {

// A spacing is good enough for an entry if its errors exceed the smallest ones by less than this factor. Each further
// spacing costs as many evaluations at every point as it has points, and a digit is not worth them. Chosen.
constexpr float nearly_best = 16.0F;
constexpr std::size_t most_spacings = 4;

}  // namespace

void SpacingSearch::add(double step, const DifferencePoints& at) {
  const ChebyshevDifferences differences(at.position, highest_), interpolation(ChebyshevDifferences::probe(), 0);
  std::vector<double> missed(index(entries_)), unit(index(entries_), span_);
  // Size at the widest spacing, so that an entry that happens to vanish here does not scale the errors.
  std::vector<double>& size = sizes_;
  size.resize(index(entries_), 0.0);
  for (int e = 0; e < entries_; ++e) {
    for (int i = 0; i < ChebyshevDifferences::points; ++i)
      size[index(e)] = std::max(size[index(e)], std::fabs(at.samples[static_cast<std::ptrdiff_t>(i) * entries_ + e]));
    double rounding = 0.0;
    const double value = interpolation.value(at.samples + e, entries_, rounding);
    missed[index(e)] = std::max(std::fabs(value - at.probe[e]) - rounding, 0.0);
  }
  std::vector<double> derivative(index(entries_)), error(index(entries_));
  std::vector<float> worst(index(entries_), 0.0F);
  for (int k = 1; k <= highest_; ++k) {
    differences.apply(k, at.half_width, at.samples, entries_, derivative.data(), error.data());
    const double per_probe = differences.error_per_probe(k) * std::pow(at.half_width, -k);
    for (std::size_t e = 0; e < worst.size(); ++e) {
      const double all = error[e] + per_probe * missed[e], s = size[e] > 0.0 ? size[e] : 1.0;
      // Errors of different orders are compared in the time in which the entry changes by its own size.
      if (k == 1) unit[e] = std::min(span_, s / std::max(std::fabs(derivative[e]), s / span_));
      worst[e] = std::max(worst[e], static_cast<float>(std::min(all * std::pow(unit[e], k) / s, 1e30)));
    }
  }
  steps_.push_back(step);
  if (best_.empty()) best_ = worst;
  for (std::size_t e = 0; e < worst.size(); ++e) best_[e] = std::min(best_[e], worst[e]);
  errors_.push_back(std::move(worst));
}

bool SpacingSearch::serves(std::size_t candidate, std::size_t entry) const {
  return errors_[candidate][entry] <= nearly_best * best_[entry];
}

// Number of entries that this spacing newly covers, each counted up to twice as it is closer to the best one.
double SpacingSearch::merit(std::size_t candidate, const std::vector<char>& done) const {
  double sum = 0.0;
  for (std::size_t e = 0; e < done.size(); ++e) {
    if (done[e] != 0 || !serves(candidate, e)) continue;
    const double worst = nearly_best * best_[e];
    sum += 2.0 - (worst > 0.0 ? errors_[candidate][e] / worst : 0.0);
  }
  return sum;
}

Spacings SpacingSearch::choose() const {
  std::vector<char> done(index(entries_), 0);
  std::vector<std::size_t> chosen;
  while (chosen.size() < most_spacings) {
    std::size_t best = 0;
    double most = 0.0;
    for (std::size_t candidate = 0; candidate < steps_.size(); ++candidate) {
      const double now = merit(candidate, done);
      if (now <= most) continue;
      most = now;
      best = candidate;
    }
    if (most == 0.0) break;
    for (std::size_t e = 0; e < done.size(); ++e)
      if (serves(best, e)) done[e] = 1;
    chosen.push_back(best);
  }
  Spacings result;
  result.highest = highest_;
  for (const std::size_t candidate : chosen) result.steps.push_back(steps_[candidate]);
  if (chosen.size() < 2) return result;
  for (std::size_t e = 0; e < done.size(); ++e) {
    int number = 0;
    for (int i = 1; i < static_cast<int>(chosen.size()); ++i)
      if (errors_[chosen[index(i)]][e] < errors_[chosen[index(number)]][e]) number = i;
    result.of_entry.push_back(number);
  }
  return result;
}

}  // namespace sfdae::core
