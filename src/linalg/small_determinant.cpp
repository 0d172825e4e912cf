// Determinants of small full matrices: Gaussian elimination with partial pivoting.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/small_determinant.h"

#include <algorithm>
#include <cmath>

namespace sfdae::core {

namespace {

// Scales rows so that their largest entry is in [1/2, 1); exponent: the sum of their powers of two. False: a row
// vanishes, or is not finite.
bool scale_rows(double* a, int size, int& exponent) {
  for (int i = 0; i < size; ++i) {
    double largest = 0.0;
    for (int j = 0; j < size; ++j) {
      const double value = std::fabs(a[i + j * size]);
      if (!std::isfinite(value)) return false;
      largest = std::max(largest, value);
    }
    if (largest == 0.0) return false;
    int power = 0;
    std::frexp(largest, &power);
    for (int j = 0; j < size; ++j) a[i + j * size] = std::ldexp(a[i + j * size], -power);
    exponent += power;
  }
  return true;
}

// Moves the largest entry of column k from row k on to the diagonal. True if rows have been exchanged.
bool bring_pivot(double* a, int size, int k) {
  int pivot = k;
  for (int i = k + 1; i < size; ++i)
    if (std::fabs(a[i + k * size]) > std::fabs(a[pivot + k * size])) pivot = i;
  if (pivot == k) return false;
  for (int j = k; j < size; ++j) std::swap(a[k + j * size], a[pivot + j * size]);
  return true;
}

}  // namespace

bool small_determinant(double* a, int size, Determinant<double>& determinant) {
  int exponent = 0;
  if (!scale_rows(a, size, exponent)) return false;
  double product = 1.0;  // of as many numbers in [1/2, 1) as there are pivots
  for (int k = 0; k < size; ++k) {
    if (bring_pivot(a, size, k)) product = -product;
    const double pivot = a[k + k * size];
    if (pivot == 0.0) return false;
    int power = 0;
    product *= std::frexp(pivot, &power);
    exponent += power;
    for (int j = k + 1; j < size; ++j) {
      const double factor = a[k + j * size];
      if (factor == 0.0) continue;
      for (int i = k + 1; i < size; ++i) a[i + j * size] -= a[i + k * size] / pivot * factor;
    }
  }
  determinant.direction = product > 0.0 ? 1.0 : -1.0;
  determinant.log2 = std::log2(std::fabs(product)) + exponent;
  return true;
}

}  // namespace sfdae::core
