// Common loops for AVX2 and AVX-512, compiled separately for each.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <immintrin.h>

#include <cstddef>

namespace sfdae::core::kernels {

namespace {

struct FourByFour {
  // to(p, q) := x(q, p), both 4 x 4
  static void transpose_four(const double* x, ptrdiff_t ld, double* to, ptrdiff_t ld_to) {
    const __m256d a = _mm256_loadu_pd(x), b = _mm256_loadu_pd(x + ld);
    const __m256d c = _mm256_loadu_pd(x + 2 * ld), d = _mm256_loadu_pd(x + 3 * ld);
    const __m256d even_ab = _mm256_unpacklo_pd(a, b), odd_ab = _mm256_unpackhi_pd(a, b);
    const __m256d even_cd = _mm256_unpacklo_pd(c, d), odd_cd = _mm256_unpackhi_pd(c, d);
    _mm256_storeu_pd(to, _mm256_permute2f128_pd(even_ab, even_cd, 0x20));
    _mm256_storeu_pd(to + ld_to, _mm256_permute2f128_pd(odd_ab, odd_cd, 0x20));
    _mm256_storeu_pd(to + 2 * ld_to, _mm256_permute2f128_pd(even_ab, even_cd, 0x31));
    _mm256_storeu_pd(to + 3 * ld_to, _mm256_permute2f128_pd(odd_ab, odd_cd, 0x31));
  }
};

}  // namespace

}  // namespace sfdae::core::kernels
