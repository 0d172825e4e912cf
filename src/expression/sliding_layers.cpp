// SPDX-License-Identifier: BSD-3-Clause
#include "expression/sliding_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "linalg/index.h"

namespace sfdae::core {

void SlidingLayers::add(std::shared_ptr<const Record> record, const TaylorEvaluator& parameters,
                        const std::vector<RegularizedCondition>& which) {
  if (which.empty()) return;
  Round round;
  std::vector<int> nodes;
  for (const RegularizedCondition& each : which) {
    nodes.push_back(record->conditions()[each.condition].node);
    round.widths.push_back(each.width);
  }
  round.equations = std::make_unique<TaylorEvaluator>(std::move(record));
  for (int i = 0; i < round.equations->record().num_user_parameters(); ++i)
    round.equations->set_parameter(i, parameters.parameter(i));
  round.functions = std::make_unique<ConditionFunctions>(*round.equations, nodes);
  round.g.resize(nodes.size());
  round.gradients.resize(nodes.size() * round.functions->width());
  rounds_.push_back(std::move(round));
}

void SlidingLayers::find_limits(double t, const double* x, double part, std::vector<double>& limits) {
  std::fill(limits.begin(), limits.end(), std::numeric_limits<double>::infinity());
  for (Round& round : rounds_) {
    const std::size_t count = round.widths.size();
    if (!round.functions->linearize(t, x, nullptr, round.g.data(), round.gradients.data())) continue;
    for (std::size_t k = 0; k < count; ++k) {
      if (!(std::fabs(round.g[k]) < round.widths[k])) continue;
      for (std::size_t i = 0; i < limits.size(); ++i) {
        const double slope = std::fabs(round.gradients[i * count + k]);
        if (slope > 0.0) limits[i] = std::min(limits[i], 2.0 * round.widths[k] * part / slope);
      }
    }
  }
}

}  // namespace sfdae::core
