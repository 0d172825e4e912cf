// SPDX-License-Identifier: BSD-3-Clause
#include "expression/sliding_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Factor by which widths may differ from those for the slopes of g. (Chosen: errors of the part u, and movements within
// widths, stay within the same factor.)
constexpr double similar = 4.0;
// Number of widths at which x has left a surface. (Chosen: ten tolerances, as a rule.)
constexpr double far = 100.0;

}  // namespace

void SlidingLayers::add(std::shared_ptr<const Record> record, const TaylorEvaluator& parameters,
                        const std::vector<RegularizedCondition>& which) {
  Round& round = rounds_.emplace_back();
  if (which.empty()) return;
  std::vector<int> nodes;
  for (const RegularizedCondition& each : which) nodes.push_back(record->conditions()[each.condition].node);
  round.conditions = which;
  round.equations = std::make_unique<TaylorEvaluator>(std::move(record));
  for (int i = 0; i < round.equations->record().num_user_parameters(); ++i)
    round.equations->set_parameter(i, parameters.parameter(i));
  round.functions = std::make_unique<ConditionFunctions>(*round.equations, nodes);
  round.g.resize(nodes.size());
  round.are_entered.resize(nodes.size());
  round.gradients.resize(nodes.size() * round.functions->width());
}

bool SlidingLayers::is_left(const Round& round, std::size_t k, bool with_sensitivities) const {
  return with_sensitivities && std::fabs(round.g[k]) > far * round.conditions[k].width;
}

// Returns whether condition k and the one of its leader are met on the same sides as before.
bool SlidingLayers::is_on_side(const Round& round, std::size_t k, std::size_t leader) const {
  double sides = 0.0;
  for (std::size_t i = 0; i < round.functions->width(); ++i) sides += round.slope(k, i) * round.slope(leader, i);
  return sides != 0.0 && (sides < 0.0) == round.conditions[k].is_opposite;
}

bool SlidingLayers::turn(const LayerPoint& at) {
  for (Round& round : rounds_) {
    if (!round.is_any_entered()) continue;
    if (!round.functions->linearize(at.t, at.x, nullptr, round.g.data(), round.gradients.data())) return true;
    for (std::size_t k = 0; k < round.conditions.size(); ++k)
      if (round.are_entered[k] != 0 && !fits(round, k, at, similar * similar)) return true;
  }
  return false;
}

// Returns whether condition k fits, if x is within the layer of its surface.
bool SlidingLayers::fits(const Round& round, std::size_t k, const LayerPoint& at, double factor) const {
  const RegularizedCondition& own = round.conditions[k];
  const std::size_t leader = round.leader_of(k);
  if (k == leader) {
    const auto [best, largest] =
        round.functions->widths(round.gradients.data() + k, round.conditions.size(), at.x, at.tolerances);
    return best < factor * own.width && own.width < std::max(factor * best, largest);
  }
  return is_on_side(round, k, leader);
}

// Returns whether condition k and its surface stay the same.
bool SlidingLayers::stays(const Round& round, std::size_t k, const LayerPoint& at) const {
  if (is_left(round, round.leader_of(k), at.with_sensitivities)) return false;
  return round.are_entered[k] == 0 || fits(round, k, at, similar);
}

void SlidingLayers::find_limits(const LayerPoint& at, double part, std::vector<double>& limits) {
  std::fill(limits.begin(), limits.end(), std::numeric_limits<double>::infinity());
  fit_ = true;
  entered_ = false;
  for (Round& round : rounds_) {
    if (round.conditions.empty()) continue;
    if (!round.functions->linearize(at.t, at.x, nullptr, round.g.data(), round.gradients.data())) {
      // A layer that x was within cannot be evaluated any more.
      fit_ = fit_ && !round.is_any_entered();
      continue;
    }
    for (std::size_t k = 0; k < round.conditions.size(); ++k) {
      const double width = round.conditions[k].width;
      const std::size_t leader = round.leader_of(k);
      round.are_entered[k] = round.is_within(leader) ? 1 : 0;
      fit_ = fit_ && stays(round, k, at);
      if (k != leader || round.are_entered[k] == 0) continue;
      entered_ = true;
      for (std::size_t i = 0; i < limits.size(); ++i) {
        const double slope = std::fabs(round.slope(k, i));
        if (slope > 0.0) limits[i] = std::min(limits[i], 2.0 * width * part / slope);
      }
    }
  }
}

// Numbers of later rounds depend on the conditions of those before: if these differ, the later ones are left out.
// Conditions of surfaces that x still moves along lead back to their zeros again.
RegularizationRounds SlidingLayers::fitting(const RegularizationRounds& rounds, const LayerPoint& at) {
  RegularizationRounds fitting;
  for (std::size_t r = 0; r < rounds.size(); ++r) {
    Round& round = rounds_[r];
    bool all_stay = true;
    std::vector<std::size_t> leaders;
    for (std::size_t k = 0; k < round.conditions.size(); ++k) {
      all_stay = all_stay && stays(round, k, at);
      if (k == round.leader_of(k) && !is_left(round, k, at.with_sensitivities)) leaders.push_back(k);
    }
    if (all_stay) {
      fitting.push_back(rounds[r]);
      continue;
    }
    std::vector<RegularizedCondition> found =
        round.functions->surfaces(leaders, {at.t, at.x, nullptr}, at.tolerances);
    for (RegularizedCondition& each : found) {
      each.condition = round.conditions[each.condition].condition;
      each.leader = round.conditions[each.leader].condition;
    }
    const auto is_same = [](const RegularizedCondition& one, const RegularizedCondition& other) {
      return one.condition == other.condition && one.leader == other.leader && one.is_opposite == other.is_opposite;
    };
    const bool has_same = std::equal(found.begin(), found.end(), rounds[r].begin(), rounds[r].end(), is_same);
    if (!found.empty()) fitting.push_back(std::move(found));
    if (!has_same) break;
  }
  return fitting;
}

}  // namespace sfdae::core
