// Anderson's method with two differences.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/anderson_mixing.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sfdae::core {

namespace {

// A second difference is left out if less than this part of its squared length remains after the first is projected
// out: it is nearly parallel. Larger factors would extrapolate instead of interpolating. Chosen, not measured.
constexpr double least_share = 1e-6, largest_factor = 4.0;

double dot(const std::vector<double>& a, const double* b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

// gamma of the least |d - gamma_0 first - gamma_1 second|.
std::pair<double, double> least_squares(const std::vector<double>& first, const std::vector<double>* second,
                                        const double* d) {
  const double aa = dot(first, first.data());
  if (!(aa > 0.0)) return {0.0, 0.0};
  const double along = dot(first, d) / aa;
  if (second == nullptr) return {along, 0.0};
  const double ratio = dot(first, second->data()) / aa, bb = dot(*second, second->data());
  const double rest = bb - ratio * ratio * aa;
  if (!(rest > least_share * bb)) return {along, 0.0};
  const double gamma = (dot(*second, d) - ratio * along * aa) / rest;
  return {along - gamma * ratio, gamma};
}

}  // namespace

void AndersonMixing::resize(std::size_t size) {
  for (Difference& difference : differences_) {
    difference.z.assign(size, 0.0);
    difference.d.assign(size, 0.0);
  }
  d_.assign(size, 0.0);
  step_.assign(size, 0.0);
  count_ = 0;
}

bool AndersonMixing::correct(const double* d, double* correction) {
  const std::size_t size = d_.size();
  auto& [newest, older] = differences_;
  bool has_correction = false;
  if (count_ > 0) {
    std::swap(newest, older);
    std::swap(newest.z, step_);
    for (std::size_t i = 0; i < size; ++i) newest.d[i] = d[i] - d_[i];
    const auto [first, second] = least_squares(newest.d, count_ > 1 ? &older.d : nullptr, d);
    has_correction = std::fabs(first) <= largest_factor && std::fabs(second) <= largest_factor;
    if (has_correction)
      for (std::size_t i = 0; i < size; ++i)
        correction[i] = -first * (newest.z[i] + newest.d[i]) - second * (older.z[i] + older.d[i]);
  }
  ++count_;
  for (std::size_t i = 0; i < size; ++i) {
    d_[i] = d[i];
    step_[i] = d[i] + (has_correction ? correction[i] : 0.0);
  }
  return has_correction;
}

}  // namespace sfdae::core
