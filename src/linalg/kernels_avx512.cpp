// Loops for processors with AVX-512.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/kernels.h"

#if defined(__AVX512F__) && defined(__FMA__)

#include <immintrin.h>

#include "linalg/kernel_transpose.h"

namespace sfdae::core::kernels {

namespace {

struct Lanes : FourByFour {
  using V = __m512d;
  static constexpr int width = 8;
  static constexpr const char* name = "avx512";
  static constexpr bool multiplies = true;
  static V zero() { return _mm512_setzero_pd(); }
  static V all(double x) { return _mm512_set1_pd(x); }
  static V load(const double* x) { return _mm512_load_pd(x); }
  static V load_anywhere(const double* x) { return _mm512_loadu_pd(x); }
  static void store(double* x, V v) { _mm512_store_pd(x, v); }
  static void store_anywhere(double* x, V v) { _mm512_storeu_pd(x, v); }
  static V size(V a) { return _mm512_abs_pd(a); }
  // An exponent of all ones carries into the sign bit when one is added to it.
  using Carries = __m512i;
  static Carries no_carries() { return _mm512_setzero_si512(); }
  static Carries add_carries(const double* x, Carries carries) {
    const Carries exponent = _mm512_set1_epi64(0x7ff0000000000000), one = _mm512_set1_epi64(0x0010000000000000);
    return _mm512_or_si512(carries, _mm512_add_epi64(_mm512_and_si512(_mm512_loadu_si512(x), exponent), one));
  }
  static bool has_carry(Carries carries) { return _mm512_cmplt_epi64_mask(carries, _mm512_setzero_si512()) != 0; }
  static V add_product(V a, V b, V c) { return _mm512_fmadd_pd(a, b, c); }
  static V subtract_product(V a, V b, V c) { return _mm512_fnmadd_pd(a, b, c); }
  static V product(V a, V b) { return _mm512_mul_pd(a, b); }
  static V sum(V a, V b) { return _mm512_add_pd(a, b); }
  static V larger(V a, V b) { return _mm512_max_pd(a, b); }
  static V smaller(V a, V b) { return _mm512_min_pd(a, b); }
  // Numbers of the places behind a place, up to it, and with one replaced; it may lie outside.
  static __mmask8 first_places(int count) {
    return static_cast<__mmask8>(count <= 0 ? 0 : count >= 8 ? 255 : (1 << count) - 1);
  }
  // The first `count` numbers alone are read or written; zeros behind them.
  static V load_first(const double* x, int count) { return _mm512_maskz_loadu_pd(first_places(count), x); }
  static void store_first(double* x, int count, V v) { _mm512_mask_storeu_pd(x, first_places(count), v); }
  static V behind(V a, int place) { return _mm512_maskz_mov_pd(static_cast<__mmask8>(~first_places(place + 1)), a); }
  static V up_to(V a, int place) { return _mm512_maskz_mov_pd(first_places(place + 1), a); }
  static V with(V a, int place, double x) {
    const int mask = first_places(place + 1) ^ first_places(place);
    return _mm512_mask_mov_pd(a, static_cast<__mmask8>(mask), _mm512_set1_pd(x));
  }
  // The first place that is equal, or the width.
  static int find(V a, double x) {
    const int equal = _mm512_cmp_pd_mask(a, _mm512_set1_pd(x), _CMP_EQ_OQ);
    return equal == 0 ? 8 : __builtin_ctz(static_cast<unsigned>(equal));
  }
  static double largest(V a) { return _mm512_reduce_max_pd(a); }
  static double smallest(V a) { return _mm512_reduce_min_pd(a); }
  static double total(V a) { return _mm512_reduce_add_pd(a); }
  static __m256d half(V a) { return _mm256_add_pd(_mm512_castpd512_pd256(a), _mm512_extractf64x4_pd(a, 1)); }
  static void sums(V a, V b, V c, V d, double* to) {
    const __m256d ab = _mm256_hadd_pd(half(a), half(b)), cd = _mm256_hadd_pd(half(c), half(d));
    const __m256d crossed = _mm256_permute2f128_pd(ab, cd, 0x21), kept = _mm256_blend_pd(ab, cd, 0xc);
    _mm256_storeu_pd(to, _mm256_add_pd(crossed, kept));
  }
};

}  // namespace

}  // namespace sfdae::core::kernels

#include "linalg/kernel_loops.h"

namespace sfdae::core::kernels {

const Loops* avx512_loops() { return &made; }

}  // namespace sfdae::core::kernels

#else

namespace sfdae::core::kernels {

const Loops* avx512_loops() { return nullptr; }

}  // namespace sfdae::core::kernels

#endif
