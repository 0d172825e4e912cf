// Derivatives by finite differences on equidistant points.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/differences.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "linalg/index.h"
#include "linalg/rank.h"

namespace sfdae::core {

namespace {

constexpr int equidistant_points = DifferenceFormula::points;

}  // namespace

std::vector<double> difference_weights(double at, const std::vector<double>& nodes, int highest) {
  const int count = static_cast<int>(nodes.size());
  std::vector<double> weights(nodes.size() * index(highest + 1), 0.0);
  const auto w = [&](int k, int i) -> double& { return weights[index(k) * nodes.size() + index(i)]; };
  const auto x = [&](int i) { return nodes[index(i)]; };
  w(0, 0) = 1.0;
  double previous_product = 1.0;
  for (int i = 1; i < count; ++i) {
    double product = 1.0;
    for (int j = 0; j < i; ++j) {
      const double gap = x(i) - x(j);
      product *= gap;
      if (j == i - 1)
        for (int k = std::min(i, highest); k >= 0; --k)
          w(k, i) =
              previous_product / product * ((k > 0 ? k * w(k - 1, i - 1) : 0.0) - (x(i - 1) - at) * w(k, i - 1));
      for (int k = std::min(i, highest); k >= 0; --k)
        w(k, j) = ((x(i) - at) * w(k, j) - (k > 0 ? k * w(k - 1, j) : 0.0)) / gap;
    }
    previous_product = product;
  }
  return weights;
}

DifferenceFormula::DifferenceFormula(int shift, int highest) {
  std::vector<double> nodes;
  for (int i = 0; i < equidistant_points; ++i) nodes.push_back(i - shift);
  all_ = difference_weights(0.0, nodes, highest);
  inner_ = difference_weights(0.0, {nodes.begin() + 1, nodes.end() - 1}, highest);
}

DifferenceFormula::Entry DifferenceFormula::differentiate(int k, const double* samples, int stride) const {
  // Rounding errors of samples, as a multiple of those of functions that are accurate to the last bit.
  constexpr double sample_roundings = 4.0;
  const double* all = all_.data() + static_cast<std::ptrdiff_t>(k) * equidistant_points;
  const double* inner = inner_.data() + static_cast<std::ptrdiff_t>(k) * (equidistant_points - 2);
  double value = 0.0, coarse = 0.0, magnitude = 0.0;
  for (int i = 0; i < equidistant_points; ++i) {
    const double s = samples[static_cast<std::ptrdiff_t>(i) * stride];
    value += all[i] * s;
    magnitude += std::fabs(all[i] * s);
    if (i > 0 && i < equidistant_points - 1) coarse += inner[i - 1] * s;
  }
  return {value, std::fabs(value - coarse) + sample_roundings * unit_roundoff * magnitude};
}

void DifferenceFormula::apply(int k, double step, const double* samples, int length, double* derivative,
                              double* error) const {
  const double scale = std::pow(step, -k);
  double largest = 0.0;
  for (int row = 0; row < length; ++row) {
    const Entry entry = differentiate(k, samples + row, length);
    derivative[row] = entry.value * scale;
    largest = std::max(largest, entry.error * std::fabs(scale));
  }
  *error = largest;
}

int fitting_shift(double below, double above, double& step) {
  step = std::min(step, (below + above) / equidistant_points);
  int shift = equidistant_points / 2;
  if (above < (equidistant_points - 1 - shift) * step)
    shift = equidistant_points - 1 - static_cast<int>(above / step);
  if (below < shift * step) shift = static_cast<int>(below / step);
  return shift;
}

}  // namespace sfdae::core
