// Powers of two that scale the rows and columns of a sparse matrix so that the largest entry of each is about 1. In
// exponents, so that nothing overflows or vanishes on the way.
//
// The largest entries are used, never means: these are distorted by entries that are rounding errors of zeros
// (docs/design/sparse_algebra.md).
//
// [R01] D. Ruiz: A scaling algorithm to equilibrate both rows and columns norms in matrices. RAL-TR-2001-034,
// Rutherford
//       Appleton Laboratory, 2001.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <cstdint>
#include <vector>

#include "linalg/index.h"

namespace sfdae::core {

constexpr int exponent_of_zero = -100000;
constexpr int exponent_of_infinity = 1024;  // and of NaN

// floor(log2 |value|); raises no floating-point exception.
inline int binary_exponent(double value) {
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(value) & ~(std::uint64_t{1} << 63);
  const int biased = static_cast<int>(bits >> 52);
  if (biased > 0) return biased - 1023;
  return bits == 0 ? exponent_of_zero : 63 - std::countl_zero(bits) - 1074;
}
// Exponent of the larger part.
inline int binary_exponent(std::complex<double> value) {
  return std::max(binary_exponent(value.real()), binary_exponent(value.imag()));
}

// value 2^exponent
inline double times_power_of_two(double value, int exponent) {
  if (exponent < -1022 || exponent > 1023) return std::ldexp(value, exponent);
  return value * std::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52);
}
inline std::complex<double> times_power_of_two(std::complex<double> value, int exponent) {
  return {times_power_of_two(value.real(), exponent), times_power_of_two(value.imag(), exponent)};
}

template <class Number>
bool all_finite_numbers(const Number* values, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k)
    if (binary_exponent(values[k]) == exponent_of_infinity) return false;
  return true;
}

// A matrix in compressed lines: columns, `crossing` numbers the row of each entry, or rows, where it numbers the
// column.
struct CompressedLines {
  int lines = 0, crossings = 0;
  const int* first = nullptr;
  const int* crossing = nullptr;
};

class Equilibration {
 public:
  // From finite values; false if a row or column is zero. Allocates for the first matrix of a size only.
  template <class Number>
  bool compute(const CompressedLines& matrix, const Number* values);

  // S = 2^crossing A 2^line: all sizes are below 2, and each nonzero line has one that is at least 1.
  const std::vector<int>& of_lines() const { return line_; }
  const std::vector<int>& of_crossings() const { return crossing_; }

 private:
  template <class Number>
  void find_largest(const CompressedLines& matrix, const Number* values);
  bool halve_distances();

  std::vector<int> line_, crossing_;
  std::vector<int> largest_in_line_, largest_crossing_;  // exponents after scaling
};

}  // namespace sfdae::core
