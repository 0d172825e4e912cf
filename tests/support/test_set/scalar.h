// SPDX-License-Identifier: BSD-3-Clause
// What the equations of the test set need of a scalar type and plain numbers lack. Taylor series as scalars.
#ifndef SFDAE_TESTS_SCALAR_H
#define SFDAE_TESTS_SCALAR_H

#include <cassert>
#include <cmath>

#include "jet.h"
#include "sfdae/expression.hpp"

namespace sfdae_test {

template <class V>
V square(const V& a) {
  return a * a;
}

using sfdae::choose;  // a if c > 0, else b: of numbers and of recorded expressions

// A branch of a function of a series is that of its first coefficient.
inline Jet choose(const Jet& c, const Jet& a, const Jet& b) { return c[0] > 0.0 ? a : b; }
inline Jet min(const Jet& a, const Jet& b) { return b[0] < a[0] ? b : a; }
inline Jet max(const Jet& a, const Jet& b) { return a[0] < b[0] ? b : a; }
inline Jet abs(const Jet& a) { return a[0] < 0.0 ? -a : a; }

// y y = a, solved for one coefficient after the other; a(0) > 0.
inline Jet sqrt(const Jet& a) {
  Jet y = Jet::zero(a.order());
  y[0] = std::sqrt(a[0]);
  for (int k = 1; k <= a.order(); ++k) {
    double rest = a[k];
    for (int j = 1; j < k; ++j) rest -= y[j] * y[k - j];
    y[k] = rest / (2.0 * y[0]);
  }
  return y;
}

// Integer powers only.
inline Jet pow(const Jet& a, double exponent) {
  assert(exponent == std::floor(exponent) && exponent >= 0.0);
  Jet product(1.0);
  for (double k = 0.0; k < exponent; k += 1.0) product = product * a;
  return product;
}

}  // namespace sfdae_test

#endif
