// SPDX-License-Identifier: BSD-3-Clause
// Random linkages with closed chains, in SI units, and points where their constraints hold by construction: the
// configuration is drawn first, and bars, joints and anchors are made to fit it.
//
//   particles     point masses, one bar after the other from an anchor to an anchor, and some bars across
//   plane_bodies  rigid bodies (x, y, phi), pinned to each other and to the ground at both ends
//   space_bodies  rigid bodies (x, e), e a unit quaternion, v = (x', angular velocity of the body), ball joints
//   angles        a chain of bars with masses between them, given by their angles, closed by two constraints
//
// The first anchor may move, constraints may be given more than once as combinations of others, and a body of the
// plane may carry a skate, 0 = x' sin phi - y' cos phi.
#ifndef SFDAE_TESTS_MULTIBODY_LINKAGE_H
#define SFDAE_TESTS_MULTIBODY_LINKAGE_H

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "sfdae/sfdae.h"
#include "test_set/scalar.h"

namespace sfdae_test {

enum class LinkageKind { particles, plane_bodies, space_bodies, angles };

struct Linkage {
  using Point = std::array<double, 3>;
  // Bodies by number, -1: the ground; where they are joined, seen from the body.
  struct Joint {
    int a = -1, b = -1;
    Point at_a{}, at_b{};
    double length = 0.0;  // of a bar between particles
  };

  LinkageKind kind = LinkageKind::particles;
  int dimension = 2, bodies = 0;
  std::vector<Joint> joints;
  std::vector<double> masses, lengths;
  std::vector<Point> inertia;
  double drive = 0.0, frequency = 1.0;      // of the first anchor, along x
  double jump = 0.0, jump_at = 0.0;         // and how far it jumps, and when
  std::vector<std::vector<double>> copies;  // coefficients of combinations of the constraints
  int skate = -1;                           // the body that carries it
  double gravity = 9.81;
  // Where the constraints hold: q, and v without the part that moves with the anchor.
  double t0 = 0.0;
  std::vector<double> q0;

  int positions_of_body() const {
    constexpr std::array<int, 4> counts = {0, 3, 7, 1};
    return kind == LinkageKind::particles ? dimension : counts[static_cast<std::size_t>(kind)];
  }
  int positions() const { return bodies * positions_of_body(); }
  int velocities() const { return bodies * (kind == LinkageKind::space_bodies ? 6 : positions_of_body()); }
  bool has_kinematics() const { return kind == LinkageKind::space_bodies; }
  int rows_of_joint() const {
    if (kind == LinkageKind::particles) return 1;
    return kind == LinkageKind::space_bodies ? 3 : 2;
  }
  // Without copies: joints, and unit quaternions.
  int independent() const {
    if (kind == LinkageKind::angles) return 2;
    return static_cast<int>(joints.size()) * rows_of_joint() + (has_kinematics() ? bodies : 0);
  }
  int holonomic() const { return independent() + static_cast<int>(copies.size()); }
  int nonholonomic() const { return skate >= 0 ? 1 : 0; }

  // Where a body is joined, or a particle is.
  template <class V>
  std::array<V, 3> point(const V& t, const V* q, int body, const Point& at, bool moves) const {
    using std::sin, std::cos;
    std::array<V, 3> p = {V(at[0]), V(at[1]), V(at[2])};
    if (body < 0) {
      if (moves && drive != 0.0) p[0] = p[0] + drive * sin(frequency * t);
      if (moves && jump != 0.0) p[0] = p[0] + choose(V(t - jump_at), V(jump), V(0.0));
      return p;
    }
    const V* own = q + body * positions_of_body();
    if (kind == LinkageKind::plane_bodies) {
      const V c = cos(own[2]), s = sin(own[2]);
      return {own[0] + c * at[0] - s * at[1], own[1] + s * at[0] + c * at[1], V(0.0)};
    }
    if (kind == LinkageKind::space_bodies) {
      const std::array<V, 3> turned = rotated(own + 3, at);
      return {own[0] + turned[0], own[1] + turned[1], own[2] + turned[2]};
    }
    for (std::size_t k = 0; k < 3; ++k) p[k] = static_cast<int>(k) < dimension ? own[k] : V(0.0);
    return p;
  }
  // R(e) at for a unit quaternion.
  template <class V>
  static std::array<V, 3> rotated(const V* e, const Point& at) {
    const V w = e[0], x = e[1], y = e[2], z = e[3];
    const auto row = [&at](const V& a, const V& b, const V& c) { return a * at[0] + b * at[1] + c * at[2]; };
    return {row(w * w + x * x - y * y - z * z, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
            row(2.0 * (x * y + w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z - w * x)),
            row(2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z)};
  }

  template <class V>
  void constraints(const V& t, const V* q, V* g) const {
    using std::sin, std::cos;
    int row = 0;
    if (kind == LinkageKind::angles) {
      // From the first anchor along the bars to the second.
      const std::array<V, 3> from = point(t, q, -1, joints.front().at_a, true);
      g[0] = from[0] - joints.back().at_b[0];
      g[1] = from[1] - joints.back().at_b[1];
      for (int i = 0; i < bodies; ++i) {
        g[0] = g[0] + lengths[static_cast<std::size_t>(i)] * cos(q[i]);
        g[1] = g[1] + lengths[static_cast<std::size_t>(i)] * sin(q[i]);
      }
      row = 2;
    }
    for (std::size_t k = 0; k < joints.size() && kind != LinkageKind::angles; ++k) {
      const Joint& joint = joints[k];
      const std::array<V, 3> a = point(t, q, joint.a, joint.at_a, k == 0),
                             b = point(t, q, joint.b, joint.at_b, false);
      if (kind == LinkageKind::particles) {
        g[row] = V(-joint.length * joint.length);
        for (std::size_t i = 0; i < 3; ++i) g[row] = g[row] + square(b[i] - a[i]);
        ++row;
        continue;
      }
      for (int i = 0; i < rows_of_joint(); ++i, ++row)
        g[row] = b[static_cast<std::size_t>(i)] - a[static_cast<std::size_t>(i)];
    }
    for (int body = 0; body < bodies && has_kinematics(); ++body, ++row) {
      g[row] = V(-1.0);
      for (int i = 3; i < 7; ++i) g[row] = g[row] + square(q[7 * body + i]);
    }
    for (const std::vector<double>& combination : copies) {
      g[row] = V(0.0);
      for (std::size_t k = 0; k < combination.size(); ++k) g[row] = g[row] + combination[k] * g[k];
      ++row;
    }
  }

  template <class V>
  void nonholonomic(const V* q, V* H) const {
    using std::sin, std::cos;
    if (skate < 0) return;
    H[3 * skate] = sin(q[3 * skate + 2]);
    H[3 * skate + 1] = -cos(q[3 * skate + 2]);
  }

  // nq x nv: e' = e (0, omega) / 2
  template <class V>
  void kinematics(const V* q, V* S) const {
    const int rows = positions();
    for (int body = 0; body < bodies; ++body) {
      V* own = S + 7 * body + static_cast<std::ptrdiff_t>(rows) * 6 * body;
      for (int i = 0; i < 3; ++i) own[i + rows * i] = V(1.0);
      const V *e = q + 7 * body + 3, half = V(0.5);
      const V table[4][3] = {{-e[1], -e[2], -e[3]}, {e[0], -e[3], e[2]}, {e[3], e[0], -e[1]}, {-e[2], e[1], e[0]}};
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 3; ++j) own[3 + i + rows * (3 + j)] = half * table[i][j];
    }
  }

  template <class V>
  void mass(const V* q, V* M) const {
    using std::cos;
    const int nv = velocities();
    for (int body = 0; body < bodies; ++body) {
      const auto k = static_cast<std::size_t>(body);
      const int per_body = nv / bodies, translations = kind == LinkageKind::plane_bodies ? 2 : std::min(per_body, 3);
      if (kind == LinkageKind::angles) {
        for (int j = 0; j < bodies; ++j)
          M[body + nv * j] = coupling(body, j) * cos(q[body] - q[j]) + (body == j ? inertia[k][0] : 0.0);
        continue;
      }
      for (int i = 0; i < per_body; ++i) {
        const double value = i < translations ? masses[k] : inertia[k][static_cast<std::size_t>(i - translations)];
        M[(body * per_body + i) * (nv + 1)] = V(value);
      }
    }
  }
  // L_i L_j times the masses that bars i and j both carry.
  double coupling(int i, int j) const {
    double sum = 0.0;
    for (int k = std::max(i, j); k < bodies - 1; ++k) sum += masses[static_cast<std::size_t>(k)];
    return sum * lengths[static_cast<std::size_t>(i)] * lengths[static_cast<std::size_t>(j)];
  }

  template <class V>
  void force(const V* q, const V* v, V* f) const {
    using std::sin, std::cos;
    const int per_body = velocities() / bodies;
    for (int body = 0; body < bodies; ++body) {
      const auto k = static_cast<std::size_t>(body);
      if (kind == LinkageKind::angles) {
        f[body] = -gravity * coupling(body, body) / lengths[k] * cos(q[body]);
        for (int j = 0; j < bodies; ++j) f[body] = f[body] - coupling(body, j) * sin(q[body] - q[j]) * square(v[j]);
        continue;
      }
      V* own = f + body * per_body;
      const int vertical = kind == LinkageKind::plane_bodies ? 1 : std::min(per_body, 3) - 1;
      own[vertical] = V(-masses[k] * gravity);
      if (kind != LinkageKind::space_bodies) continue;
      const V* w = v + 6 * body + 3;
      const Point& J = inertia[k];
      own[3] = (J[1] - J[2]) * w[1] * w[2];
      own[4] = (J[2] - J[0]) * w[2] * w[0];
      own[5] = (J[0] - J[1]) * w[0] * w[1];
    }
  }

  // The struct that users fill, with recorded formulas; the linkage has to live as long.
  sfdae_multibody_problem problem() const;
};

// A chain in the plane through the points p, by any kind but space_bodies: anchors at the first and the last one.
Linkage plane_chain(LinkageKind kind, const std::vector<Linkage::Point>& p, std::mt19937& engine);

// Off symmetric and singular configurations. masses: 10^-3 to 10^3 kg, lengths: 10^-2 to 10 m.
Linkage random_linkage(std::mt19937& engine);

// What a test needs of a linkage at a point, column-major.
struct LinkageTerms {
  LinkageTerms(const Linkage& linkage, double t, const double* q);
  std::vector<double> g, g_t, g_q;  // nl, nl, nl x nq
  std::vector<double> S, M, C, r;   // nq x nv, nv x nv, (nl + nk) x nv, nl + nk
  // What rounding q, t and the terms of g does to g, at most some times that.
  std::vector<double> rounding;
};

}  // namespace sfdae_test

#endif
