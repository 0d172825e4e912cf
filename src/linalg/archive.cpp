// State as a sequence of doubles.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/archive.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace sfdae::core {

namespace {

// Whole numbers up to 2^53 are exact in a double: three of 16 bits, or two of 26.
constexpr std::size_t per_double = 3;
constexpr double radix = 65536.0;
constexpr double count_radix = 67108864.0;

// NaN compares as false, and raises no floating-point exception.
bool is_whole_below(double limit, double number) {
  return std::isfinite(number) && number >= 0.0 && number < limit && number == std::floor(number);
}

}  // namespace

void Archive::reals(double* values, std::size_t count) {
  if (to_ != nullptr) {
    assert(count <= length_ - size_);
    std::copy_n(values, count, to_ + size_);
  } else if (from_ != nullptr) {
    // Infinity may have been written, NaN never is.
    for (std::size_t i = 0; i < checked(count); ++i)
      if (std::isnan(from_[size_ + i])) throw DamagedArchive();
    std::copy_n(from_ + size_, count, values);
  }
  size_ += count;
}

void Archive::reals(std::vector<double>& values, std::size_t count) {
  if (is_reading()) values.resize(checked(count));
  const std::size_t present = std::min(count, values.size());
  reals(values.data(), present);
  double zero = 0.0;
  for (std::size_t i = present; i < count; ++i) real(zero);
}

void Archive::counts(long& first, long& second) {
  const auto cut = [](long value) {
    return static_cast<double>(std::clamp(value, 0L, static_cast<long>(count_radix) - 1));
  };
  double number = cut(first) * count_radix + cut(second);
  real(number);
  if (!is_reading()) return;
  if (!is_whole_below(count_radix * count_radix, number)) throw DamagedArchive();
  first = static_cast<long>(std::floor(number / count_radix));
  second = static_cast<long>(number - static_cast<double>(first) * count_radix);
}

void Archive::pack(int* values, std::size_t count) {
  for (std::size_t first = 0; first < count; first += per_double) {
    const std::size_t last = std::min(first + per_double, count);
    double number = 0.0;
    for (std::size_t i = last; i-- > first;) {
      assert(-1 <= values[i] && values[i] < radix - 1.0);
      number = number * radix + (values[i] + 1);
    }
    real(number);
    if (!is_reading()) continue;
    if (!is_whole_below(radix * radix * radix, number)) throw DamagedArchive();
    for (std::size_t i = first; i < last; ++i) {
      const double rest = std::floor(number / radix);
      values[i] = static_cast<int>(number - rest * radix) - 1;
      number = rest;
    }
  }
}

}  // namespace sfdae::core
