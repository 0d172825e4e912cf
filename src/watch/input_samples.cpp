// Whether the points that a step looks at show what inputs do between them.
// SPDX-License-Identifier: BSD-3-Clause
#include "watch/input_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

// Of the range of an input: what it may be away from the polynomial. (Chosen.)
constexpr double visible_part = 0.3;
// Of its range: by how much it may be above or below its values at the nodes without being expected there. (Chosen.)
constexpr double visible_excess = 0.05;
// Of its range: crests are looked at, whether they are expected or not, where a sample is that much beyond its values
// at the nodes. (Chosen.)
constexpr double crest_part = 0.001;
// From the largest sample to the crest: each parabola through points at a quarter of the last one's distances.
constexpr int parabolas = 3;
constexpr double reach_in_next = 0.25;
// Points of a step between which the largest value of a polynomial is that of a parabola.
constexpr std::size_t polynomial_points = 12;
// Of its size: changes are rounding errors.
constexpr double least_range = 1e-10;
// What follows the polynomial as closely in a few samples is not looked at any more. (Chosen.)
constexpr double smooth_part = 0.02;
constexpr int fewest = 3;
// Samples of a step for each of its nodes, in all, and in the time in which inputs are known to change. (Chosen.)
constexpr double per_node = 5.0, most = 64.0, per_change = 4.0;
// Of a step in which crests matter, so that the largest sample is at the crest, and not one of few that are all
// beside it. (Chosen.)
constexpr double fewest_for_crests = 32.0;
// Parts of a step that no period is a multiple of: those of the golden ratio, which begin elsewhere in each step.
constexpr double golden = 0.6180339887498949;

double fraction(double value) { return value - std::floor(value); }

}  // namespace

void set_lagrange_weights(std::span<const double> nodes, double t, double* weights) {
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    weights[k] = 1.0;
    for (std::size_t j = 0; j < nodes.size(); ++j)
      if (j != k) weights[k] *= (t - nodes[j]) / (nodes[k] - nodes[j]);
  }
}

void InputSamples::resize(int inputs) {
  at_nodes_.assign(index(inputs) * most_nodes, 0.0);
  for (std::vector<double>* v : {&now_, &lowest_node_, &highest_node_}) v->assign(index(inputs), 0.0);
  for (std::vector<Extreme>* v : {&lowest_, &highest_, &farthest_}) v->assign(index(inputs), {});
}

void InputSamples::take(TimeInputs& inputs, std::span<const double> nodes, double h, double fastest) {
  const QuietArithmetic quiet;
  const double t = nodes[0];
  take_nodes(inputs, nodes);
  const double changes = fastest > 0.0 ? per_change * std::fabs(h) / fastest : 0.0;
  const double of_nodes = std::fmax(per_node * static_cast<double>(nodes.size() - 1),
                                    inputs.are_with_steep_functions() ? fewest_for_crests : 0.0);
  int samples = static_cast<int>(std::fmin(most, std::fmax(of_nodes, changes)));
  const double first = fraction(t / h * golden);
  const auto sample_all = [&](int count) {
    for (int sample = 0; sample < count; ++sample)
      take_sample(inputs, nodes, t + (sample + fraction(first + sample * golden)) / count * h);
  };
  const int few = changes > fewest ? 0 : fewest;
  sample_all(few);
  if (few > 0 && are_smooth()) {
    unseen_.clear();
    samples = few;
    // Between few samples a crest may be missed.
    if (inputs.are_with_steep_functions()) take_expected_extremes(inputs, nodes, h);
  } else {
    sample_all(samples);
    find_unseen();
  }
  crests_.clear();
  if (inputs.are_with_steep_functions()) find_crests(inputs, nodes, h / samples, h);
}

void InputSamples::take_nodes(TimeInputs& inputs, std::span<const double> nodes) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    inputs.evaluate(nodes[k], now_.data());
    for (std::size_t i = 0; i < now_.size(); ++i) {
      at_nodes_[i * most_nodes + k] = now_[i];
      lowest_node_[i] = k == 0 ? now_[i] : std::fmin(lowest_node_[i], now_[i]);
      highest_node_[i] = k == 0 ? now_[i] : std::fmax(highest_node_[i], now_[i]);
    }
  }
  std::fill(lowest_.begin(), lowest_.end(), Extreme{infinity, 0.0, 0.0});
  std::fill(highest_.begin(), highest_.end(), Extreme{-infinity, 0.0, 0.0});
  std::fill(farthest_.begin(), farthest_.end(), Extreme{0.0, 0.0, 0.0});
}

void InputSamples::take_sample(TimeInputs& inputs, std::span<const double> nodes, double t) {
  std::array<double, most_nodes> weights{};
  set_lagrange_weights(nodes, t, weights.data());
  inputs.evaluate(t, now_.data());
  for (std::size_t i = 0; i < now_.size(); ++i) {
    const double distance = std::fabs(now_[i] - expected(i, nodes.size(), weights.data()));
    if (now_[i] < lowest_[i].value) lowest_[i] = {now_[i], distance, t};
    if (now_[i] > highest_[i].value) highest_[i] = {now_[i], distance, t};
    if (distance > farthest_[i].distance) farthest_[i] = {now_[i], distance, t};
  }
}

// Samples at those of some points of the step where a polynomial through the nodes is largest or smallest.
void InputSamples::take_expected_extremes(TimeInputs& inputs, std::span<const double> nodes, double h) {
  const auto time = [&](std::size_t point) { return nodes[0] + static_cast<double>(point) * h / polynomial_points; };
  std::array<std::array<double, most_nodes>, polynomial_points> weights{};
  for (std::size_t point = 1; point < polynomial_points; ++point)
    set_lagrange_weights(nodes, time(point), weights[point].data());
  std::array<bool, polynomial_points> is_extreme{};
  for (std::size_t i = 0; i < now_.size(); ++i) {
    std::array<double, polynomial_points> values{};
    for (std::size_t point = 1; point < polynomial_points; ++point)
      values[point] = expected(i, nodes.size(), weights[point].data());
    const auto [low, high] = std::minmax_element(values.begin() + 1, values.end());
    is_extreme[static_cast<std::size_t>(low - values.begin())] = true;
    is_extreme[static_cast<std::size_t>(high - values.begin())] = true;
  }
  for (std::size_t point = 1; point < polynomial_points; ++point)
    if (is_extreme[point]) take_sample(inputs, nodes, time(point));
}

// Of input i: the value of the polynomial through those at the nodes.
double InputSamples::expected(std::size_t i, std::size_t nodes, const double* weights) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < nodes; ++k) sum += weights[k] * at_nodes_[i * most_nodes + k];
  return sum;
}

// 0: but for rounding errors it is constant.
double InputSamples::range_of(std::size_t i) const {
  const double low = std::fmin(lowest_[i].value, lowest_node_[i]),
               high = std::fmax(highest_[i].value, highest_node_[i]);
  const double range = high - low;
  return range > least_range * std::fmax(std::fabs(low), std::fabs(high)) ? range : 0.0;
}

// All follow their polynomials so far. What is constant may be so between pulses.
bool InputSamples::are_smooth() const {
  for (std::size_t i = 0; i < now_.size(); ++i) {
    const double range = range_of(i);
    if (range == 0.0 || !(farthest_[i].distance <= smooth_part * range)) return false;
  }
  return true;
}

void InputSamples::find_unseen() {
  unseen_.clear();
  for (std::size_t i = 0; i < now_.size(); ++i) {
    const double range = range_of(i);
    if (range == 0.0) continue;
    const Extreme &low = lowest_[i], &high = highest_[i];
    const double below = std::fmin(lowest_node_[i] - low.value, low.distance);
    const double above = std::fmin(high.value - highest_node_[i], high.distance);
    unseen_.add(above / (visible_excess * range), high.t);
    unseen_.add(below / (visible_excess * range), low.t);
    unseen_.add(farthest_[i].distance / (visible_part * range), farthest_[i].t);
  }
}

// What the nodes before the step say of w there is of the past.
void InputSamples::find_crests(TimeInputs& inputs, std::span<const double> nodes, double spacing, double h) {
  const double t = nodes[0];
  const Interval step{t, t + h};
  for (std::size_t i = 0; i < now_.size(); ++i) {
    if (range_of(i) == 0.0) continue;
    const double* const at_nodes = at_nodes_.data() + i * most_nodes;
    double low_node = at_nodes[0], high_node = low_node;
    for (std::size_t k = 1; k < nodes.size(); ++k) {
      if ((nodes[k] - t) * h < 0.0) continue;
      low_node = std::fmin(low_node, at_nodes[k]);
      high_node = std::fmax(high_node, at_nodes[k]);
    }
    const Extreme &low = lowest_[i], &high = highest_[i];
    const double least = crest_part * (std::fmax(high.value, high_node) - std::fmin(low.value, low_node));
    if (high.value - high_node > least)
      crests_.add((high.value - high_node) / least, crest(inputs, i, 1.0, spacing, high.t, step));
    if (low_node - low.value > least)
      crests_.add((low_node - low.value) / least, crest(inputs, i, -1.0, spacing, low.t, step));
  }
}

// Near the sample that is the largest one, of those times sign, by parabolas within the step.
double InputSamples::crest(TimeInputs& inputs, std::size_t i, double sign, double spacing, double at,
                           const Interval& step) {
  const auto room = [&](double time) { return std::fmin(std::fabs(time - step.start), std::fabs(step.end - time)); };
  const auto value = [&](double time) {
    inputs.evaluate(time, now_.data());
    return sign * now_[i];
  };
  double reach = std::fmin(std::fabs(spacing), room(at)), middle = value(at);
  for (int round = 0; round < parabolas; ++round) {
    const double before = value(at - reach), after = value(at + reach), bend = before - 2.0 * middle + after;
    if (!std::isfinite(bend)) break;
    const double shift = 0.5 * (before - after) / bend;
    const bool is_inside = bend < 0.0 && std::fabs(shift) <= 1.0;
    if (!is_inside && !(std::fmax(before, after) > middle)) break;
    at += is_inside ? shift * reach : after > before ? reach : -reach;
    reach = std::fmin(is_inside ? reach_in_next * reach : reach, room(at));
    middle = value(at);
  }
  return at;
}

void InputSamples::Places::add(double score, double t) {
  if (!(score > 1.0)) return;
  std::size_t at = count_;
  while (at > 0 && score > scores_[at - 1]) --at;
  if (at == most) return;
  count_ = std::min(count_ + 1, most);
  for (std::size_t k = count_ - 1; k > at; --k) {
    t_[k] = t_[k - 1];
    scores_[k] = scores_[k - 1];
  }
  t_[at] = t;
  scores_[at] = score;
}

}  // namespace sfdae::core
