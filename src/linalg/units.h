// Units of the unknowns: x_j = unit_j times the value in the core.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "linalg/index.h"

namespace sfdae::core {

class Units {
 public:
  // All of them 1.
  Units() = default;
  // One for each unknown, powers of two; none: all are 1.
  Units(std::vector<double> values) : values_(std::move(values)) {}

  bool are_one() const { return values_.empty(); }
  double operator[](std::size_t j) const { return values_.empty() ? 1.0 : values_[j]; }
  double operator[](int j) const { return (*this)[index(j)]; }
  // Empty where all are 1.
  const std::vector<double>& values() const { return values_; }
  std::vector<double>& values() { return values_; }

  // The user's x in these units: x itself if all are 1, else written to `buffer`.
  const double* inward(const double* x, double* buffer) const {
    if (are_one()) return x;
    for (std::size_t j = 0; j < values_.size(); ++j) buffer[j] = x[j] / values_[j];
    return buffer;
  }
  // The largest component of the user's x, of n, in these units.
  double largest(const double* x, int n) const {
    double result = 0.0;
    for (int j = 0; j < n; ++j) result = std::max(result, std::fabs(x[j]) / (*this)[j]);
    return result;
  }
  // Converts x in these units to the user's.
  void outward(double* x) const {
    for (std::size_t j = 0; j < values_.size(); ++j) x[j] *= values_[j];
  }

 private:
  std::vector<double> values_;
};

}  // namespace sfdae::core
