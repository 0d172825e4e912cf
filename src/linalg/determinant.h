// Determinants as products of pivots, in logarithms: of large matrices they overflow.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "linalg/index.h"

namespace sfdae::core {

// direction 2^log2, |direction| = 1: 1 or -1 for double.
template <class Number>
struct Determinant {
  Number direction = Number(1);
  double log2 = 0.0;

  // factor: not zero.
  void multiply(Number factor) {
    const double size = std::abs(factor);
    direction *= factor / size;
    log2 += std::log2(size);
  }
  void change_sign_if(bool changes) {
    if (changes) direction = -direction;
  }
};

// True if a permutation of 0, ..., size - 1 takes an odd number of exchanges.
inline bool is_odd(const int* permutation, int size) {
  std::vector<char> is_done(index(size), 0);
  bool odd = false;
  for (int i = 0; i < size; ++i)
    for (int j = permutation[i]; is_done[index(i)] == 0 && j != i; j = permutation[j]) {
      is_done[index(j)] = 1;
      odd = !odd;
    }
  return odd;
}

}  // namespace sfdae::core
