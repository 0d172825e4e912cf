// Jets.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/jet.h"

#include "linalg/index.h"

namespace sfdae::core {

void Jet::set_order(int new_order) {
  x.resize(index(n) * index(new_order + 1), 0.0);
  order = new_order;
}

void Jet::shift(double h) {
  // Horner's scheme, repeated.
  for (int low = 0; low < order; ++low)
    for (int k = order - 1; k >= low; --k)
      for (int i = 0; i < n; ++i) column(k)[i] += h * column(k + 1)[i];
  t += h;
}

void Jet::add_scaled(const double* dx, const double* dy, int highest, double tau, const Units& units) {
  double power = 1.0;
  for (int k = 0; k <= highest; ++k) {
    const double factor = k == 0 ? 1.0 : 1.0 / (k * (power *= tau));
    const double* change = k == 0 ? dx : dy + static_cast<std::ptrdiff_t>(k - 1) * n;
    double* to = column(k);
    for (int i = 0; i < n; ++i) to[i] += factor * change[i] * units[i];
  }
}

}  // namespace sfdae::core
