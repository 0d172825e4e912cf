// Spacings of the points of differences, chosen for every entry of a function.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/difference_spacings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "linalg/index.h"
#include "linalg/rank.h"
#include "problem/differences.h"

namespace sfdae::core {

namespace {

constexpr int points = DifferenceFormula::points;
// Of a spacing beyond the point in the middle: no simple fraction, so that no period fits the points and the probe.
constexpr double beside_middle = 0.3719;
// A spacing whose errors are larger by less than this does for an entry. Each further spacing costs nine evaluations
// at every point, and a digit is not worth them. Chosen.
constexpr float nearly_best = 16.0F;
constexpr std::size_t most_spacings = 4;
// Values of a function that is computed to the last bit, interpolated.
constexpr double sample_roundings = 4.0;

using Coefficients = std::array<double, points + 1>;

// Of prod (x - node) over the nodes -shift ... points - 1 - shift.
Coefficients node_polynomial(int shift) {
  Coefficients e{};
  e[0] = 1.0;
  for (int i = 0; i < points; ++i) {
    const double node = i - shift;
    for (std::size_t j = points; j > 0; --j) e[j] = e[j - 1] - node * e[j];
    e[0] *= -node;
  }
  return e;
}

// What an error of 1 at the probe says of the error of the k-th derivative, spacing 1: both are those of the same
// multiple of the node polynomial, and of terms of about its size.
double derivative_error_per_probe(const Coefficients& e, double position, int k) {
  double at_probe = 0.0;
  for (std::size_t j = e.size(); j-- > 0;) at_probe = at_probe * position + e[j];
  double largest = 0.0, factorial = 1.0;
  for (std::size_t j = index(k); j < e.size(); ++j) largest = std::max(largest, std::fabs(e[j]));
  for (int j = 2; j <= k; ++j) factorial *= j;
  return factorial * largest / std::fabs(at_probe);
}

}  // namespace

double SpacingSearch::probe_position(int shift) { return points / 2 - shift + beside_middle; }

void SpacingSearch::add(const DifferencePoints& at) {
  const double position = probe_position(at.shift);
  std::vector<double> nodes;
  for (int i = 0; i < points; ++i) nodes.push_back(i - at.shift);
  const std::vector<double> interpolation = difference_weights(position, nodes, 0);
  const Coefficients node_product = node_polynomial(at.shift);
  const DifferenceFormula formula(at.shift, highest_);
  std::vector<double> missed(index(entries_)), unit(index(entries_), span_);
  // That of the widest spacing, so that errors are not measured by an entry that happens to vanish here.
  std::vector<double>& size = sizes_;
  size.resize(index(entries_), 0.0);
  for (int e = 0; e < entries_; ++e) {
    double value = 0.0, magnitude = 0.0;
    for (int i = 0; i < points; ++i) {
      const double s = at.samples[static_cast<std::ptrdiff_t>(i) * entries_ + e];
      size[index(e)] = std::max(size[index(e)], std::fabs(s));
      value += interpolation[index(i)] * s;
      magnitude += std::fabs(interpolation[index(i)] * s);
    }
    const double error = std::fabs(value - at.probe[e]) - sample_roundings * unit_roundoff * magnitude;
    missed[index(e)] = std::max(error, 0.0);
  }
  std::vector<double> derivative(index(entries_)), error(index(entries_));
  std::vector<float> worst(index(entries_), 0.0F);
  for (int k = 1; k <= highest_; ++k) {
    formula.apply_by_entry(k, at.step, at.samples, entries_, derivative.data(), error.data());
    const double per_probe = derivative_error_per_probe(node_product, position, k) * std::pow(at.step, -k);
    for (std::size_t e = 0; e < worst.size(); ++e) {
      const double all = error[e] + per_probe * missed[e], s = size[e] > 0.0 ? size[e] : 1.0;
      // Errors of different orders are compared in the time in which the entry changes by its own size.
      if (k == 1) unit[e] = std::min(span_, s / std::max(std::fabs(derivative[e]), s / span_));
      worst[e] = std::max(worst[e], static_cast<float>(std::min(all * std::pow(unit[e], k) / s, 1e30)));
    }
  }
  steps_.push_back(at.step);
  if (best_.empty()) best_ = worst;
  for (std::size_t e = 0; e < worst.size(); ++e) best_[e] = std::min(best_[e], worst[e]);
  errors_.push_back(std::move(worst));
}

bool SpacingSearch::serves(std::size_t candidate, std::size_t entry) const {
  return errors_[candidate][entry] <= nearly_best * best_[entry];
}

// How many entries it serves that no other one does yet, each counted up to twice as it is closer to the best one.
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
