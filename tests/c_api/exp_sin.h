// A function of two arguments with its derivatives of every order.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "sfdae/sfdae.hpp"

namespace sfdae::test {

// f(a, b) = exp(a) sin(b)
inline int exp_sin(int order, ConstVectorRef a, VectorRef derivatives) {
  for (int place = 0; place < derivatives.size(); ++place) {
    int by_b = 0;
    for (int k = 0, rest = place; k < order; ++k, rest /= 2) by_b += rest % 2;
    const double turned[] = {std::sin(a[1]), std::cos(a[1]), -std::sin(a[1]), -std::cos(a[1])};
    derivatives[place] = std::exp(a[0]) * turned[by_b % 4];
  }
  return 0;
}

}  // namespace sfdae::test
