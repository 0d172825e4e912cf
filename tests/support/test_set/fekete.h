// SPDX-License-Identifier: BSD-3-Clause
// Fekete points [TS]: 20 points on the unit sphere repel each other and come to rest,
//
//   p_i' = q_i + 2 mu_i p_i,  q_i' = -alpha q_i + 2 lambda_i p_i + sum_j D_ij,  0 = |p_i|^2 - 1,  0 = 2 p_i . q_i
//
// with D_ij = (p_i - p_j) / |p_i - p_j|^2; x = (p, q, lambda, mu), 160 unknowns, mu = 1. Without the multipliers mu_i
// and the last equations: x = (p, q, lambda), 140 unknowns, mu = 2.
//
// Reference: quadruple precision; the published values are good to 11 digits.
#ifndef SFDAE_TESTS_FEKETE_H
#define SFDAE_TESTS_FEKETE_H

#include <array>

#include "mechanical.h"
#include "scalar.h"
#include "test_problem.h"

namespace sfdae_test {

struct Fekete {
  static constexpr int points = 20, positions = 60, multipliers = 20;
  static constexpr double alpha = 0.5;

  static double mass(int) { return 1.0; }

  template <class V>
  static void forces(const V&, const V* x, V* f) {
    const V *p = x, *q = x + 60, *lambda = x + 120;
    for (int i = 0; i < positions; ++i) f[i] = -alpha * q[i] + 2.0 * lambda[i / 3] * p[i];
    for (int i = 0; i < points; ++i)
      for (int j = 0; j < i; ++j) {
        const V D[] = {p[3 * i] - p[3 * j], p[3 * i + 1] - p[3 * j + 1], p[3 * i + 2] - p[3 * j + 2]};
        const V scale = 1.0 / (square(D[0]) + square(D[1]) + square(D[2]));
        for (int k = 0; k < 3; ++k) {
          const V push = scale * D[k];
          f[3 * i + k] = f[3 * i + k] + push;
          f[3 * j + k] = f[3 * j + k] - push;
        }
      }
  }
  template <class V>
  static void add_constraint_forces(const V&, const V* p, const V* mu, V* f) {
    for (int i = 0; i < positions; ++i) f[i] = f[i] - 2.0 * mu[i / 3] * p[i];
  }
  template <class V>
  static V dot(const V* a, const V* b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }
  template <class V>
  static void constraints(const V&, const V* p, V* g) {
    for (int i = 0; i < points; ++i) g[i] = dot(p + 3 * i, p + 3 * i) - 1.0;
  }
  template <class V>
  static void velocity_constraints(const V&, const V* p, const V* v, V* g) {
    for (int i = 0; i < points; ++i) g[i] = 2.0 * dot(p + 3 * i, v + 3 * i);
  }
  template <class V>
  static void acceleration_constraints(const V&, const V* p, const V* v, const V* a, V* g) {
    for (int i = 0; i < points; ++i) g[i] = 2.0 * (dot(v + 3 * i, v + 3 * i) + dot(p + 3 * i, a + 3 * i));
  }
};

template <class V>
void fekete_residual(const V& t, const V* x, const V* xdot, V* F) {
  stabilized_residual<Fekete>(t, x, xdot, F);
}

template <class V>
void fekete_position_residual(const V& t, const V* x, const V* xdot, V* F) {
  direct_residual<Fekete, ConstraintLevel::position>(t, x, xdot, F);
}

// Positions at t = 1000.
inline constexpr double fekete_reference[60] = {
    -4.07026338033128690274836667e-01, 3.46375877281720292055381063e-01,  8.45194245002094120086068689e-01,
    7.75293475246382173481707277e-02,  -2.62866271994994338040312089e-01, 9.61712287183572137455183730e-01,
    7.10057783334315181247527210e-01,  1.21294805559435274643877927e-01,  6.93617700517120243162787125e-01,
    2.34826774456494638720995657e-01,  7.44927797693560918711340358e-01,  6.24450928593896618180467503e-01,
    -4.34111473877280247635513273e-01, 8.78543044227295277468401920e-01,  1.99272044421519706556263406e-01,
    -9.51505960031050656080251196e-01, 2.20350876280371456161692393e-01,  2.14666949826611789342925625e-01,
    -6.38519164361679973196697559e-01, -4.31083325936753227766448274e-01, 6.37542502773084845166714589e-01,
    -1.46417508792651693150958857e-01, -9.38087163521949337966525899e-01, 3.13933729876700645502935260e-01,
    5.66697406506051559750591569e-01,  -6.73922188507190421216797516e-01, 4.74007313548001968233772199e-01,
    9.84325953843837307141645771e-01,  -1.69699535783305435803108127e-01, -4.80050429054126060213763051e-02,
    1.46417508792651693150935858e-01,  9.38087163521949337966530873e-01,  -3.13933729876700645502931125e-01,
    -7.09275754997138725647278054e-01, 5.26406263713682772239317713e-01,  -4.68854293886959627938791810e-01,
    -8.66573181928995147020201021e-01, -4.81387805974872484512319959e-01, -1.31592935297284108664089275e-01,
    -2.34789777870971174895639711e-01, -8.59434040802129108869035147e-01, -4.54144128793739105484808151e-01,
    5.53097694006572297612643013e-01,  -7.67437026562966062574847038e-01, -3.24227314001774749879050488e-01,
    7.71105096990451285311745522e-01,  6.35704181656858084018061949e-01,  3.57368551964368296233666761e-02,
    7.10395120938428718985640664e-01,  2.40357043125589194176853770e-01,  -6.61488672591450269153711021e-01,
    -3.03820873865714493344824356e-02, 4.50192329361919396365813492e-01,  -8.92414587145304244095279139e-01,
    -5.77299615810708616866810128e-01, -1.76676341498414856252389594e-01, -7.97189202096681514064697866e-01,
    2.41448176696735474832773020e-01,  -3.41645681839806730805487879e-01, -9.08284650343732032505751117e-01};

// Rings of points around the axis: first point, number of points, fraction of the circle by which the ring is turned
// (pi / turn), latitude in units of pi, and the number with which a ring begins to count.
inline std::vector<double> fekete_start_positions() {
  struct Ring {
    int first, count, turn, offset;
    double latitude;
  };
  constexpr Ring rings[] = {
      {0, 3, 13, 1, 3.0 / 8}, {3, 7, 29, 1, 1.0 / 8}, {10, 6, 7, 1, -2.0 / 15}, {16, 4, 17, 0, -3.0 / 10}};
  const double pi = 4.0 * std::atan(1.0);
  std::vector<double> p;
  for (const Ring& ring : rings)
    for (int i = 0; i < ring.count; ++i) {
      const double a = 2.0 * pi * (i + ring.offset) / ring.count + pi / ring.turn, b = ring.latitude * pi;
      p.insert(p.end(), {std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)});
    }
  return p;
}

// At rest; lambda_i = -p_i . (sum_j D_ij) / 2 keeps the velocities tangential.
inline TestProblem fekete() {
  TestProblem p{.name = "fekete", .m = 160, .n = 160, .values = {1, 80, 80, 0, 0}, .t0 = 0.0, .tf = 1000.0};
  p.x0 = fekete_start_positions();
  p.x0.resize(160, 0.0);
  p.xdot0.assign(160, 0.0);
  double* velocity = p.xdot0.data() + Fekete::positions;
  Fekete::forces(0.0, p.x0.data(), velocity);
  for (int i = 0; i < Fekete::points; ++i)
    p.x0[static_cast<std::size_t>(120 + i)] = -0.5 * Fekete::dot(p.x0.data() + 3 * i, velocity + 3 * i);
  Fekete::forces(0.0, p.x0.data(), velocity);
  p.references = {{1000.0, {std::begin(fekete_reference), std::end(fekete_reference)}}};
  p.counted = first_components(60);
  return p;
}

inline TestProblem fekete_position() {
  TestProblem p = fekete();
  p.name = "fekete_position";
  p.m = p.n = 140;
  p.values = {2, 80, 60, 0, 0};
  p.x0.resize(140);
  p.xdot0.resize(140);
  return p;
}

}  // namespace sfdae_test

#endif
