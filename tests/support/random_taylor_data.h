// SPDX-License-Identifier: BSD-3-Clause
// Taylor data that come from no problem: random coefficients of the shape and rank asked for.
#ifndef SFDAE_TESTS_RANDOM_TAYLOR_DATA_H
#define SFDAE_TESTS_RANDOM_TAYLOR_DATA_H

#include <cstdint>

#include "matrix_checks.h"
#include "problem/taylor_data.h"

namespace sfdae_test {

// m x n, levels 0..level, E_0 of the rank given.
inline sfdae::core::TaylorData random_taylor_data(int m, int n, int level, int rank_E0, std::uint64_t seed) {
  using namespace sfdae::core;
  TaylorData data;
  data.resize(m, n, {level, level, level});
  for (int k = 0; k <= level; ++k) {
    const std::uint64_t at = seed + static_cast<std::uint64_t>(10 * k);
    copy(random_matrix(m, n, at), data.E(k));
    copy(random_matrix(m, n, at + 1), data.A(k));
    copy(random_matrix(m, 1, at + 2), {data.f(k), m, 1, m});
  }
  copy(times(random_matrix(m, rank_E0, seed + 3), random_matrix(rank_E0, n, seed + 4)), data.E(0));
  data.measure();
  return data;
}

}  // namespace sfdae_test

#endif
