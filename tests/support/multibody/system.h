// SPDX-License-Identifier: BSD-3-Clause
// Mechanical systems with constraints, each written once:
//
//   q' = v,   M v' = f - G^T lambda - H^T kappa,   0 = g(t, q),   0 = H v + h,   G = g_q
//
// A system is an object with
//   sizes                              of q = v, g and H v + h
//   mass(t, q, M)                      nv x nv, column-major
//   force(t, q, v, f)
//   constraints(t, q, g)
//   gradient(t, q, G)                  nl x nq
//   nonholonomic(t, q, H, h)           nk x nv, nk
// all templates over the scalar type of t, that write the entries that are not zero.
#ifndef SFDAE_TESTS_MULTIBODY_SYSTEM_H
#define SFDAE_TESTS_MULTIBODY_SYSTEM_H

#include <cstddef>
#include <vector>

namespace sfdae_test {

struct SystemSizes {
  int positions = 0, holonomic = 0, nonholonomic = 0;
  int unknowns() const { return 2 * positions + holonomic + nonholonomic; }
};

struct MechanicalSystem {
  explicit MechanicalSystem(SystemSizes its_sizes) : sizes(its_sizes) {}
  template <class V>
  void nonholonomic(const V&, const V*, V*, V*) const {}
  SystemSizes sizes;
};

template <class V>
std::vector<V> zeros(int count) {
  return std::vector<V>(static_cast<std::size_t>(count), V(0.0));
}

// The columns of G from dg/dt = G v + g_t.
template <class System, class V>
void gradient_from_rates(int positions, int constraints, const V& t, const V* q, V* G) {
  std::vector<V> v = zeros<V>(positions), at_rest = zeros<V>(constraints), moving = zeros<V>(constraints);
  System::velocity_constraints(t, q, v.data(), at_rest.data());
  for (int j = 0; j < positions; ++j) {
    const auto column = static_cast<std::size_t>(j);
    v[column] = V(1.0);
    System::velocity_constraints(t, q, v.data(), moving.data());
    v[column] = V(0.0);
    for (int i = 0; i < constraints; ++i)
      G[i + j * constraints] = moving[static_cast<std::size_t>(i)] - at_rest[static_cast<std::size_t>(i)];
  }
}

// A system of mechanical.h with a diagonal mass matrix.
template <class System>
struct DirectSystem : MechanicalSystem {
  DirectSystem() : MechanicalSystem({System::positions, System::multipliers, 0}) {}
  template <class V>
  void mass(const V&, const V*, V* M) const {
    for (int i = 0; i < System::positions; ++i) M[i * (System::positions + 1)] = V(System::mass(i));
  }
  template <class V>
  void force(const V& t, const V* q, const V* v, V* f) const {
    std::vector<V> x(q, q + System::positions);  // the multipliers are zero
    x.insert(x.end(), v, v + System::positions);
    x.resize(static_cast<std::size_t>(sizes.unknowns()), V(0.0));
    System::forces(t, x.data(), f);
  }
  template <class V>
  void constraints(const V& t, const V* q, V* g) const {
    System::constraints(t, q, g);
  }
  template <class V>
  void gradient(const V& t, const V* q, V* G) const {
    gradient_from_rates<System>(System::positions, System::multipliers, t, q, G);
  }
};

// One with any mass matrix.
template <class System>
struct AcceleratedSystem : MechanicalSystem {
  AcceleratedSystem() : MechanicalSystem({System::positions, System::multipliers, 0}) {}
  template <class V>
  void mass(const V&, const V* q, V* M) const {
    std::vector<V> unit = zeros<V>(System::positions);
    for (int j = 0; j < System::positions; ++j) {
      unit[static_cast<std::size_t>(j)] = V(1.0);
      System::apply_mass(q, unit.data(), M + j * System::positions);
      unit[static_cast<std::size_t>(j)] = V(0.0);
    }
  }
  template <class V>
  void force(const V&, const V* q, const V* v, V* f) const {
    for (int i = 0; i < System::positions; ++i) f[i] = V(0.0);
    System::subtract_forces(q, v, f);
    for (int i = 0; i < System::positions; ++i) f[i] = -f[i];
  }
  template <class V>
  void constraints(const V& t, const V* q, V* g) const {
    System::constraints(t, q, g);
  }
  template <class V>
  void gradient(const V& t, const V* q, V* G) const {
    gradient_from_rates<System>(System::positions, System::multipliers, t, q, G);
  }
};

// Rows of the constraints on velocities and their multipliers: r += C^T mu, C = [G; H], x = (q, v, mu).
template <class System, class V>
void add_constraint_forces(const System& system, const V& t, const V* x, V* r) {
  const SystemSizes& s = system.sizes;
  std::vector<V> G = zeros<V>(s.holonomic * s.positions), H = zeros<V>(s.nonholonomic * s.positions),
                 h = zeros<V>(s.nonholonomic);
  system.gradient(t, x, G.data());
  system.nonholonomic(t, x, H.data(), h.data());
  const V *lambda = x + 2 * s.positions, *kappa = lambda + s.holonomic;
  for (int j = 0; j < s.positions; ++j) {
    for (int i = 0; i < s.holonomic; ++i) r[j] = r[j] + G[static_cast<std::size_t>(i + j * s.holonomic)] * lambda[i];
    for (int i = 0; i < s.nonholonomic; ++i)
      r[j] = r[j] + H[static_cast<std::size_t>(i + j * s.nonholonomic)] * kappa[i];
  }
}

// The system as F(t, x, x') = 0 with x = (q, v, lambda, kappa).
template <class System, class V>
void general_residual(const System& system, const V& t, const V* x, const V* xdot, V* F) {
  const SystemSizes& s = system.sizes;
  const int n = s.positions, nk = s.nonholonomic;
  std::vector<V> M = zeros<V>(n * n), f = zeros<V>(n), H = zeros<V>(nk * n), h = zeros<V>(nk);
  system.mass(t, x, M.data());
  system.force(t, x, x + n, f.data());
  system.nonholonomic(t, x, H.data(), h.data());
  for (int i = 0; i < n; ++i) {
    F[i] = xdot[i] - x[n + i];
    F[n + i] = -f[static_cast<std::size_t>(i)];
    for (int j = 0; j < n; ++j) F[n + i] = F[n + i] + M[static_cast<std::size_t>(i + j * n)] * xdot[n + j];
  }
  add_constraint_forces(system, t, x, F + n);
  system.constraints(t, x, F + 2 * n);
  for (int i = 0; i < nk; ++i) {
    V* row = F + 2 * n + s.holonomic + i;
    *row = h[static_cast<std::size_t>(i)];
    for (int j = 0; j < n; ++j) *row = *row + H[static_cast<std::size_t>(i + j * nk)] * x[n + j];
  }
}

// How often the equations of general_residual have to be differentiated.
inline std::vector<int> differentiations(const SystemSizes& s) {
  std::vector<int> counts(static_cast<std::size_t>(s.positions), s.holonomic > 0 ? 1 : 0);
  counts.insert(counts.end(), static_cast<std::size_t>(s.positions), 0);
  counts.insert(counts.end(), static_cast<std::size_t>(s.holonomic), 2);
  counts.insert(counts.end(), static_cast<std::size_t>(s.nonholonomic), 1);
  return counts;
}

}  // namespace sfdae_test

#endif
