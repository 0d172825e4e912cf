// Resolution of event functions by steps.
// SPDX-License-Identifier: BSD-3-Clause
#include "watch/event_resolution.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Deviation allowed, as part of the distance of g from zero. (Chosen: 0.01 is typical of resolved steps.)
constexpr double unexpected_part = 0.25;
// Points of a search in the time in which g changes by its size at the largest rate seen: fifteen in a period of a
// sine, or ten if the sampled rates reach two thirds of the largest one. (Chosen; more follow where g bends.)
constexpr double points_per_change = 2.4;
// Steps from this part of a misleading one on are examined. (Chosen.)
constexpr double suspicious_part = 0.25;
// Steps whose rates need no more points than this allow longer steps to be trusted. (Chosen.)
constexpr double points_of_slow_step = 4.0;
constexpr int least_search_halvings = 4, most_search_halvings = 12;

}  // namespace

void EventResolution::resize(std::size_t functions) {
  for (std::vector<double>& g : g_) g.resize(functions);
  looks_at_.resize(functions, true);
  sizes_.resize(functions);
  rates_.resize(functions);
}

void EventResolution::begin_step(double t, const std::vector<double>& g) {
  halvings_ = 0;
  if (num_points_ > 0 && t == t_[0]) return;  // repeated after a failure
  std::rotate(g_.begin(), g_.end() - 1, g_.end());
  std::rotate(t_.begin(), t_.end() - 1, t_.end());
  std::copy(g.begin(), g.end(), g_[0].begin());
  t_[0] = t;
  num_points_ = std::min(num_points_ + 1, most_points);
}

bool EventResolution::expects(double t, const std::vector<double>& g) const {
  std::array<double, most_points> weights{};
  for (std::size_t k = 0; k < num_points_; ++k) {
    weights[k] = 1.0;
    for (std::size_t j = 0; j < num_points_; ++j)
      if (j != k) weights[k] *= (t - t_[j]) / (t_[k] - t_[j]);
  }
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!looks_at_[i]) continue;
    double expected = 0.0;
    for (std::size_t k = 0; k < num_points_; ++k) expected += weights[k] * g_[k][i];
    const double way = std::min(std::fabs(g[i]), std::fabs(g_[0][i]));
    if (!(std::fabs(expected - g[i]) <= unexpected_part * way)) return false;
  }
  return true;
}

bool EventResolution::is_suspicious(double h) const {
  return misleading_ > 0.0 && std::fabs(h) >= suspicious_part * misleading_;
}

void EventResolution::start_rates() {
  std::fill(sizes_.begin(), sizes_.end(), 0.0);
  std::fill(rates_.begin(), rates_.end(), 0.0);
}

void EventResolution::add_rate(double delta, const std::vector<double>& g, const std::vector<double>& g_after_delta) {
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!looks_at_[i]) continue;
    sizes_[i] = std::max(sizes_[i], std::fabs(g[i]));
    rates_[i] = std::max(rates_[i], std::fabs((g_after_delta[i] - g[i]) / delta));
  }
}

void EventResolution::take_rates(double h) {
  double points = 1.0;
  bool is_seen = false;
  for (std::size_t i = 0; i < sizes_.size(); ++i) {
    if (!(sizes_[i] > 0.0)) continue;
    is_seen = true;
    points = std::max(points, points_per_change * std::fabs(h) * rates_[i] / sizes_[i]);
  }
  // A slowly varying step does not restrict following steps up to twice its length.
  if (points > points_of_slow_step)
    misleading_ = misleading_ > 0.0 ? std::min(misleading_, std::fabs(h)) : std::fabs(h);
  else if (is_seen) misleading_ = 2.0 * std::fabs(h);
  const double halvings = std::min<double>(most_search_halvings, std::ceil(std::log2(points)));
  halvings_ = std::max(least_search_halvings, static_cast<int>(halvings));
}

void EventResolution::archive(Archive& archive) {
  int points = static_cast<int>(num_points_);
  archive.small(points, halvings_);
  num_points_ = std::min(index(std::max(points, 0)), most_points);
  halvings_ = std::clamp(halvings_, 0, most_search_halvings);
  archive.real(misleading_);
  archive.reals(t_.data(), most_points);
  for (std::vector<double>& g : g_) archive.reals(g.data(), g.size());
}

}  // namespace sfdae::core
