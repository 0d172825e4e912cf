// Error estimate of the Radau methods.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/radau_error_estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// The new node and the last ones, as many as a divided difference of order 2s needs.
ChosenNodes nodes_with_end(const RadauStep& step, const RadauHistory& history) {
  ChosenNodes chosen;
  chosen.nodes[0] = &step.end;
  for (int i = 1; i <= step.method->s(); ++i) chosen.nodes[index(i)] = &history.node(i - 1);
  chosen.count = step.method->s() + 1;
  return chosen;
}

}  // namespace

// Limit of the embedded error in units of tol^((s+1)/(2s)). Measured on 287 runs (docs/design/radau.md) with s = 3
// alone and with all s: errors are a tenth of the tolerance on average, up to 7 if the coefficients turn fast. More
// stages have smaller limits, because their order at the nodes requires smooth coefficients, which the divided
// difference of w does not show.
double embedded_limit(int s, bool beside_difference) {
  return s == 3 ? (beside_difference ? 0.4 : 0.08) : s == 5 ? 0.012 : 0.003;
}

void RadauErrorEstimate::resize(std::size_t n, std::size_t size_w, int most_stages) {
  error_.assign(n, 0.0);
  interior_.correction_w.assign(size_w, 0.0);
  interior_.correction_x.assign(n, 0.0);
  difference_.assign(n, 0.0);
  columns_.assign(size_w * index(most_stages + 2), 0.0);
  mapped_.assign(n * index(most_stages + 2), 0.0);
}

ErrorTerms RadauErrorEstimate::estimate(StrangenessFreeSystem& system, const RadauHistory& history,
                                        const RadauStep& step, const ErrorWeights& weights, HermiteTable& table) {
  ErrorTerms terms;
  interior_.w = interior_.x = std::numeric_limits<double>::infinity();
  if (system.differential() == 0) {
    std::fill(error_.begin(), error_.end(), 0.0);
    return terms;
  }
  const RadauMethod& method = *step.method;
  const RadauNode& start = history.newest();
  const int s = method.s();
  const std::size_t n = start.x.size(), size_w = start.w.size();
  // The embedded formula: gamma0 h (w' - u') at the start.
  double* embedded = columns_.data();
  slope_of_stages({s, method.slope_at_start.data(), 1, step.h}, start.w, step.stages.w, embedded);
  const double factor = step.h / method.stages.gamma;
  for (std::size_t i = 0; i < size_w; ++i) embedded[i] = factor * (start.wdot[i] - embedded[i]);
  const bool has_difference = history.count() >= s && s > 1;
  if (has_difference) {
    table.set_nodes(nodes_with_end(step, history), Interpolated::w, 2 * s + 1, step.end.t, step.h);
    std::copy_n(table.last_entry().data(), size_w, columns_.data() + size_w);
  }
  system.error_in_x(columns_.data(), has_difference ? 2 : 1, mapped_.data());
  const double* difference = mapped_.data() + n;
  std::copy_n(mapped_.data(), n, error_.data());
  if (s == 1) {
    // h (w' - u') = - h^2 w'' up to higher orders.
    terms.decay[2] = 0.5 * weights.norm(mapped_.data());
    terms.error = method.error_constant * terms.decay[2];
    terms.exponent = 2;
    return terms;
  }
  estimate_interior(start, step, weights);
  const double guard = weights.norm(mapped_.data(), (s + 1.0) / (2.0 * s)) / embedded_limit(s, has_difference);
  if (has_difference) terms.decay[index(2 * s)] = weights.norm(difference);
  const double by_difference = has_difference ? method.error_constant * terms.decay[index(2 * s)] : 0.0;
  terms.error = std::max(guard, by_difference);
  terms.exponent = guard > by_difference ? s + 1 : 2 * s;
  if (terms.exponent == 2 * s) std::copy_n(difference, n, error_.data());
  return terms;
}

// Error of w by the embedded error, in the first columns. Algebraic components are interpolated, and may vary faster
// than w: their next divided difference over the stages is extrapolated from the last ones.
void RadauErrorEstimate::estimate_interior(const RadauNode& start, const RadauStep& step,
                                           const ErrorWeights& weights) {
  const RadauMethod& method = *step.method;
  const std::size_t n = start.x.size(), size_w = start.w.size();
  const double gamma = method.stages.gamma;
  for (std::size_t i = 0; i < size_w; ++i) interior_.correction_w[i] = gamma * columns_[i];
  for (std::size_t i = 0; i < n; ++i) interior_.correction_x[i] = gamma * mapped_[i];
  interior_.w = method.largest_correction * weights.norm(interior_.correction_x.data());
  const auto norm_of_difference = [&](const std::array<double, max_stages + 1>& factors, int order) {
    for (std::size_t i = 0; i < n; ++i) difference_[i] = factors[0] * start.x[i];
    for (int j = 1; j <= order; ++j) {
      const double factor = factors[index(j)];
      const double* stage = step.stages.x.data() + n * index(j - 1);
      for (std::size_t i = 0; i < n; ++i) difference_[i] += factor * stage[i];
    }
    return weights.norm(difference_.data());
  };
  const int s = method.s();
  const double last = norm_of_difference(method.lagrange_factors, s),
               earlier = norm_of_difference(method.lower_factors, s - 2);
  const double decay = last < earlier ? std::sqrt(last / earlier) : 1.0;
  interior_.x = std::max(interior_.w, method.largest_remainder * decay * last);
}

void RadauErrorEstimate::add_decay(StrangenessFreeSystem& system, const RadauHistory& history, const RadauStep& step,
                                   const ErrorWeights& weights, ErrorTerms& terms) {
  const int s = step.method->s();
  const RadauNode& start = history.newest();
  const std::size_t n = start.x.size(), size_w = start.w.size();
  std::array<double, max_stages + 1> times{};
  std::copy_n(step.method->stages.c.data(), s, times.data() + 1);
  // In the end column k has order k.
  std::copy_n(start.w.data(), size_w, columns_.data());
  std::copy_n(step.stages.w.data(), size_w * index(s), columns_.data() + size_w);
  divided_differences(times, s + 1, size_w, [&](int i) { return columns_.data() + size_w * index(i); });
  system.error_in_x(columns_.data() + size_w, s, mapped_.data());
  for (int k = 1; k <= s; ++k) terms.decay[index(k)] = weights.norm(mapped_.data() + n * index(k - 1));
}

}  // namespace sfdae::core
