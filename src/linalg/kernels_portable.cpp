// Loops for any processor: vectors of two numbers that compilers map to the available registers.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/kernels.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

namespace sfdae::core::kernels {

namespace {

struct Lanes {
  struct V {
    double x, y;
  };
  static constexpr int width = 2;
  static constexpr const char* name = "portable";
  // BLAS is optimized for the processor.
  static constexpr bool multiplies = false;
  static V zero() { return {0.0, 0.0}; }
  static V all(double x) { return {x, x}; }
  static V load(const double* x) { return {x[0], x[1]}; }
  static V load_anywhere(const double* x) { return {x[0], x[1]}; }
  static void store(double* x, V v) {
    x[0] = v.x;
    x[1] = v.y;
  }
  static void store_anywhere(double* x, V v) { store(x, v); }
  // The first `count` numbers alone are read or written; zeros behind them.
  static V load_first(const double* x, int count) { return {x[0], count > 1 ? x[1] : 0.0}; }
  static void store_first(double* x, int count, V v) {
    x[0] = v.x;
    if (count > 1) x[1] = v.y;
  }
  static V size(V a) { return {fabs(a.x), fabs(a.y)}; }
  // An exponent of all ones carries into the sign bit when one is added to it.
  using Carries = uint64_t;
  static Carries no_carries() { return 0; }
  static Carries add_carries(const double* x, Carries carries) {
    constexpr uint64_t exponent = 0x7ff0000000000000u, one = 0x0010000000000000u;
    uint64_t bits[2];
    memcpy(bits, x, sizeof bits);
    return carries | ((bits[0] & exponent) + one) | ((bits[1] & exponent) + one);
  }
  static bool has_carry(Carries carries) { return carries >> 63 != 0; }
  static V add_product(V a, V b, V c) { return {c.x + a.x * b.x, c.y + a.y * b.y}; }
  static V subtract_product(V a, V b, V c) { return {c.x - a.x * b.x, c.y - a.y * b.y}; }
  static V product(V a, V b) { return {a.x * b.x, a.y * b.y}; }
  static V sum(V a, V b) { return {a.x + b.x, a.y + b.y}; }
  static V larger(V a, V b) { return {a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y}; }
  static V smaller(V a, V b) { return {a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y}; }
  // Numbers of the places behind a place, up to it, and with one replaced; it may lie outside.
  static V behind(V a, int place) { return {place < 0 ? a.x : 0.0, place < 1 ? a.y : 0.0}; }
  static V up_to(V a, int place) { return {place >= 0 ? a.x : 0.0, place >= 1 ? a.y : 0.0}; }
  static V with(V a, int place, double x) { return {place == 0 ? x : a.x, place == 1 ? x : a.y}; }
  // The first place that is equal, or the width.
  static int find(V a, double x) { return a.x == x ? 0 : a.y == x ? 1 : 2; }
  static double largest(V a) { return a.x > a.y ? a.x : a.y; }
  static double smallest(V a) { return a.x < a.y ? a.x : a.y; }
  static double total(V a) { return a.x + a.y; }
  static void sums(V a, V b, V c, V d, double* to) {
    to[0] = total(a);
    to[1] = total(b);
    to[2] = total(c);
    to[3] = total(d);
  }
  // to(p, q) := x(q, p), both 4 x 4
  static void transpose_four(const double* x, ptrdiff_t ld, double* to, ptrdiff_t ld_to) {
    for (int p = 0; p < 4; ++p)
      for (int q = 0; q < 4; ++q) to[p + q * ld_to] = x[q + p * ld];
  }
};

}  // namespace

}  // namespace sfdae::core::kernels

#include "linalg/kernel_loops.h"

namespace sfdae::core::kernels {

const Loops* portable_loops() { return &made; }

}  // namespace sfdae::core::kernels
