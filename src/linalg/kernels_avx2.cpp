// Loops for processors with AVX2 and FMA.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/kernels.h"

#if defined(__AVX2__) && defined(__FMA__)

#include <immintrin.h>

#include "linalg/kernel_transpose.h"

namespace sfdae::core::kernels {

namespace {

struct Lanes : FourByFour {
  using V = __m256d;
  static constexpr int width = 4;
  static constexpr const char* name = "avx2";
  static constexpr bool multiplies = true;
  static V zero() { return _mm256_setzero_pd(); }
  static V all(double x) { return _mm256_set1_pd(x); }
  static V load(const double* x) { return _mm256_load_pd(x); }
  static V load_anywhere(const double* x) { return _mm256_loadu_pd(x); }
  static void store(double* x, V v) { _mm256_store_pd(x, v); }
  // The first `count` numbers alone are read or written; zeros behind them.
  static __m256i first_places(int count) {
    return _mm256_cmpgt_epi64(_mm256_set1_epi64x(count), _mm256_set_epi64x(3, 2, 1, 0));
  }
  static V load_first(const double* x, int count) { return _mm256_maskload_pd(x, first_places(count)); }
  static void store_first(double* x, int count, V v) { _mm256_maskstore_pd(x, first_places(count), v); }
  static void store_anywhere(double* x, V v) { _mm256_storeu_pd(x, v); }
  static V size(V a) { return _mm256_andnot_pd(all(-0.0), a); }
  // An exponent of all ones carries into the sign bit when one is added to it.
  using Carries = __m256i;
  static Carries no_carries() { return _mm256_setzero_si256(); }
  static Carries add_carries(const double* x, Carries carries) {
    const Carries exponent = _mm256_set1_epi64x(0x7ff0000000000000), one = _mm256_set1_epi64x(0x0010000000000000);
    const Carries bits = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(x));
    return _mm256_or_si256(carries, _mm256_add_epi64(_mm256_and_si256(bits, exponent), one));
  }
  static bool has_carry(Carries carries) { return _mm256_movemask_pd(_mm256_castsi256_pd(carries)) != 0; }
  static V add_product(V a, V b, V c) { return _mm256_fmadd_pd(a, b, c); }
  static V subtract_product(V a, V b, V c) { return _mm256_fnmadd_pd(a, b, c); }
  static V product(V a, V b) { return _mm256_mul_pd(a, b); }
  static V sum(V a, V b) { return _mm256_add_pd(a, b); }
  static V larger(V a, V b) { return _mm256_max_pd(a, b); }
  static V smaller(V a, V b) { return _mm256_min_pd(a, b); }
  // Numbers of the places behind a place, up to it, and with one replaced; it may lie outside.
  static V places() { return _mm256_set_pd(3.0, 2.0, 1.0, 0.0); }
  static V behind(V a, int place) { return _mm256_and_pd(a, _mm256_cmp_pd(places(), all(place), _CMP_GT_OQ)); }
  static V up_to(V a, int place) { return _mm256_and_pd(a, _mm256_cmp_pd(places(), all(place), _CMP_LE_OQ)); }
  static V with(V a, int place, double x) {
    return _mm256_blendv_pd(a, all(x), _mm256_cmp_pd(places(), all(place), _CMP_EQ_OQ));
  }
  // The first place that is equal, or the width.
  static int find(V a, double x) {
    const int equal = _mm256_movemask_pd(_mm256_cmp_pd(a, all(x), _CMP_EQ_OQ));
    return equal == 0 ? 4 : __builtin_ctz(static_cast<unsigned>(equal));
  }
  static __m128d upper(V a) { return _mm256_extractf128_pd(a, 1); }
  static __m128d lower(V a) { return _mm256_castpd256_pd128(a); }
  static double largest(V a) {
    const __m128d two = _mm_max_pd(lower(a), upper(a));
    return _mm_cvtsd_f64(_mm_max_sd(two, _mm_unpackhi_pd(two, two)));
  }
  static double smallest(V a) {
    const __m128d two = _mm_min_pd(lower(a), upper(a));
    return _mm_cvtsd_f64(_mm_min_sd(two, _mm_unpackhi_pd(two, two)));
  }
  static double total(V a) {
    const __m128d two = _mm_add_pd(lower(a), upper(a));
    return _mm_cvtsd_f64(_mm_add_sd(two, _mm_unpackhi_pd(two, two)));
  }
  static void sums(V a, V b, V c, V d, double* to) {
    const V ab = _mm256_hadd_pd(a, b), cd = _mm256_hadd_pd(c, d);
    const V crossed = _mm256_permute2f128_pd(ab, cd, 0x21), kept = _mm256_blend_pd(ab, cd, 0xc);
    _mm256_storeu_pd(to, _mm256_add_pd(crossed, kept));
  }
};

}  // namespace

}  // namespace sfdae::core::kernels

#include "linalg/kernel_loops.h"

namespace sfdae::core::kernels {

const Loops* avx2_loops() { return &made; }

}  // namespace sfdae::core::kernels

#else

namespace sfdae::core::kernels {

const Loops* avx2_loops() { return nullptr; }

}  // namespace sfdae::core::kernels

#endif
