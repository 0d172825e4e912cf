// SPDX-License-Identifier: BSD-3-Clause
// A plane pendulum of many links: masses 1/N at the ends p_i of N rods of length 1/N, 0 = |p_i - p_{i-1}|^2 - 1/N^2.
// It starts at rest from the horizontal.
#ifndef SFDAE_TESTS_MULTIBODY_CHAIN_H
#define SFDAE_TESTS_MULTIBODY_CHAIN_H

#include "system.h"
#include "test_set/scalar.h"

namespace sfdae_test {

struct PendulumChain : MechanicalSystem {
  static constexpr double gravity = 9.81;

  explicit PendulumChain(int its_links) : MechanicalSystem({2 * its_links, its_links, 0}), links(its_links) {}
  template <class V>
  void mass(const V&, const V*, V* M) const {
    for (int i = 0; i < 2 * links; ++i) M[i * (2 * links + 1)] = V(1.0 / links);
  }
  template <class V>
  void force(const V&, const V*, const V*, V* f) const {
    for (int i = 0; i < links; ++i) f[2 * i + 1] = V(-gravity / links);
  }
  // In units of a rod.
  template <class V>
  V rod(const V* q, int i, int k) const {
    const V end = q[2 * i + k] * static_cast<double>(links);
    return i == 0 ? end : end - q[2 * i - 2 + k] * static_cast<double>(links);
  }
  template <class V>
  void constraints(const V&, const V* q, V* g) const {
    for (int i = 0; i < links; ++i) g[i] = square(rod(q, i, 0)) + square(rod(q, i, 1)) - 1.0;
  }
  template <class V>
  void gradient(const V&, const V* q, V* G) const {
    for (int i = 0; i < links; ++i)
      for (int k = 0; k < 2; ++k) {
        const V slope = rod(q, i, k) * (2.0 * links);
        G[i + links * (2 * i + k)] = slope;
        if (i > 0) G[i + links * (2 * i - 2 + k)] = -slope;
      }
  }
  std::vector<double> start() const {
    std::vector<double> x(static_cast<std::size_t>(5 * links), 0.0);
    for (int i = 0; i < links; ++i) x[static_cast<std::size_t>(2 * i)] = (i + 1.0) / links;
    return x;
  }
  double energy(const double* q, const double* v) const {
    double sum = 0.0;
    for (int i = 0; i < links; ++i)
      sum += 0.5 * (v[2 * i] * v[2 * i] + v[2 * i + 1] * v[2 * i + 1]) + gravity * q[2 * i + 1];
    return sum / links;
  }
  int links;
};

}  // namespace sfdae_test

#endif
