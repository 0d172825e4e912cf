// The unit of time of equations.
// SPDX-License-Identifier: BSD-3-Clause
#include "structure/time_unit.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"

namespace sfdae::core {

double time_unit(TaylorEvaluator& evaluator, const PointOfUnits& point, int highest_order) {
  const Tape& tape = evaluator.tape();
  const std::size_t m = index(evaluator.record().m());
  std::vector<double> derivatives(tape.targets.size(), 0.0);
  if (!evaluator.entries(point.t, point.jet, 0, std::vector<int>(m, 0), derivatives.data())) return 1.0;
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < m; ++i) {
    double of_x = 0.0, of_slopes = 0.0;
    for (std::size_t e = tape.first_target[i]; e < tape.first_target[i + 1]; ++e) {
      double& largest = tape.targets[e].derivative ? of_slopes : of_x;
      largest = std::max(largest, std::fabs(derivatives[e]) * point.sizes[index(tape.targets[e].unknown)]);
    }
    if (!(of_x > 0.0 && of_slopes > 0.0)) continue;
    sum += std::log2(of_slopes) - std::log2(of_x);
    ++count;
  }
  const double largest_exponent = 400.0 / std::max(highest_order, 1);
  return count > 0 && std::isfinite(sum) ? std::exp2(std::clamp(sum / count, -largest_exponent, largest_exponent))
                                         : 1.0;
}

}  // namespace sfdae::core
