// SPDX-License-Identifier: BSD-3-Clause
// A mechanical system with everything in it: constraints on positions and velocities that depend on t, q' = S v. Not
// meant to move; what is known of it exactly comes from Taylor series of its formulas.
#ifndef SFDAE_TESTS_MULTIBODY_EXAMPLE_H
#define SFDAE_TESTS_MULTIBODY_EXAMPLE_H

#include <cmath>
#include <vector>

#include "jet.h"
#include "matrix_checks.h"
#include "sfdae/expression.hpp"
#include "sfdae/sfdae.h"

namespace sfdae_test {

inline constexpr int nq = 3, nv = 3, nl = 2, nk = 1;

// Formulas for numbers, series and expressions; matrices column by column.
template <class V>
struct Formulas {
  const V& t;
  const V* q;

  void M(V* to, const V& mass) const {
    using std::cos, std::exp;
    const V coupling = 0.3 * cos(q[0] - q[1]);
    to[0] = mass + q[2] * q[2], to[1] = coupling, to[3] = coupling, to[4] = V(2.0), to[8] = exp(0.5 * q[1]);
  }
  void f(const V* v, V* to) const {
    using std::sin;
    to[0] = -9.81 * sin(q[0]) - 0.1 * v[0] * v[1] + t, to[1] = q[0] * q[1] * v[2] * v[2], to[2] = V(1.0);
  }
  void g(V* to) const {
    using std::cos, std::sin;
    to[0] = q[0] * q[0] * q[1] + sin(q[1] * q[2]) - 0.5 * t * q[2], to[1] = q[0] + 2.0 * q[1] + cos(2.0 * t);
  }
  void S(V* to) const {
    using std::cos, std::exp, std::sin;
    to[0] = cos(q[2]), to[1] = sin(q[2]), to[4] = 1.0 + 0.2 * q[0] * q[0], to[6] = 0.3 * t, to[8] = exp(0.1 * q[1]);
  }
  void H(V* to) const {
    using std::sin;
    to[0] = q[1], to[1] = V(1.0) + t * q[0], to[2] = sin(q[2]);
  }
  void h(V* to) const {
    using std::sin;
    to[0] = 0.2 * q[0] * q[2] + sin(3.0 * t);
  }
};

// As C callbacks; user: the mass.
template <void (Formulas<double>::*formulas)(double*) const>
int position_callback(double t, const double* q, double* result, void*) {
  (Formulas<double>{t, q}.*formulas)(result);
  return 0;
}
inline int mass_callback(double t, const double* q, double* M, void* user) {
  Formulas<double>{t, q}.M(M, *static_cast<const double*>(user));
  return 0;
}
inline int force_callback(double t, const double* q, const double* v, double* f, void*) {
  Formulas<double>{t, q}.f(v, f);
  return 0;
}

// Series of g and H v + h along t + t_rate s and series of q.
inline std::vector<Jet> g_along(double t, double t_rate, const std::vector<Jet>& q) {
  Jet time = Jet::variable(t, 2);
  time[1] = t_rate;
  std::vector<Jet> g(size(nl));
  Formulas<Jet>{time, q.data()}.g(g.data());
  return g;
}
// The line through q in direction w, and what is added to its second coefficient.
inline std::vector<Jet> line(const double* q, const double* w) {
  std::vector<Jet> jets;
  for (int j = 0; j < nq; ++j) {
    jets.push_back(Jet::variable(q[j], 2));
    jets.back()[1] = w[j];
  }
  return jets;
}

inline int jacobian_callback(double t, const double* q, double* g_q, void*) {
  for (int j = 0; j < nq; ++j) {
    double direction[nq] = {};
    direction[j] = 1.0;
    const std::vector<Jet> g = g_along(t, 0.0, line(q, direction));
    for (int i = 0; i < nl; ++i) g_q[i + j * nl] = g[size(i)][1];
  }
  return 0;
}
inline int rate_callback(double t, const double* q, double* g_t, void*) {
  const double direction[nq] = {};
  const std::vector<Jet> g = g_along(t, 1.0, line(q, direction));
  for (int i = 0; i < nl; ++i) g_t[i] = g[size(i)][1];
  return 0;
}

// q(t + s) = q + s S v + s^2/2 (dS/dt) v.
inline std::vector<Jet> motion(double t, const double* q, const double* v, bool with_S) {
  std::vector<double> S(size(nq * nv)), velocity(v, v + nv);
  if (!with_S) return line(q, v);
  Formulas<double>{t, q}.S(S.data());
  for (int i = 0; i < nq; ++i)
    velocity[size(i)] = S[size(i)] * v[0] + S[size(i + nq)] * v[1] + S[size(i + 2 * nq)] * v[2];
  std::vector<Jet> jets = line(q, velocity.data()), S_jets(size(nq * nv));
  Formulas<Jet>{Jet::variable(t, 2), jets.data()}.S(S_jets.data());
  for (int i = 0; i < nq; ++i)
    for (int j = 0; j < nv; ++j) jets[size(i)][2] += 0.5 * S_jets[size(i + j * nq)][1] * v[j];
  return jets;
}
template <bool with_S>
int curvature_callback(double t, const double* q, const double* v, double* gamma, void*) {
  const std::vector<Jet> g = g_along(t, 1.0, motion(t, q, v, with_S));
  for (int i = 0; i < nl; ++i) gamma[i] = 2.0 * g[size(i)][2];
  return 0;
}
template <bool with_S>
int nonholonomic_curvature_callback(double t, const double* q, const double* v, double* eta, void*) {
  const std::vector<Jet> jets = motion(t, q, v, with_S);
  const Jet time = Jet::variable(t, 2);
  std::vector<Jet> H(size(nv));
  Jet h;
  Formulas<Jet>{time, jets.data()}.H(H.data());
  Formulas<Jet>{time, jets.data()}.h(&h);
  eta[0] = h[1];
  for (int j = 0; j < nv; ++j) eta[0] += H[size(j)][1] * v[j];
  return 0;
}

template <bool with_S>
int recorded_example(sfdae_record* record, sfdae_expression t, const sfdae_expression* q, const sfdae_expression* v,
                     const sfdae_multibody_formulas* to, void* user) {
  using sfdae::Expression;
  const Expression time(t);
  const std::vector<Expression> positions(q, q + nq), velocities(v, v + nv);
  const Formulas<Expression> formulas{time, positions.data()};
  const auto write = [](sfdae_expression* place, int count, auto fill) {
    std::vector<Expression> values(place, place + count);
    fill(values.data());
    for (int i = 0; i < count; ++i) place[i] = values[size(i)].c();
  };
  const Expression mass = sfdae_parameter(record, "mass", *static_cast<const double*>(user));
  write(to->M, nv * nv, [&](Expression* M) { formulas.M(M, mass); });
  write(to->f, nv, [&](Expression* f) { formulas.f(velocities.data(), f); });
  write(to->g, nl, [&](Expression* g) { formulas.g(g); });
  if (with_S)
    write(to->S, nq * nv, [&](Expression* S) {
      for (int i = 0; i < nq * nv; ++i) S[i] = 0.0;
      formulas.S(S);
    });
  write(to->H, nk * nv, [&](Expression* H) { formulas.H(H); });
  write(to->h, nk, [&](Expression* h) { formulas.h(h); });
  return 0;
}

enum class Source { recorded, callbacks, callbacks_with_curvature };

// mass has to live as long as the problem.
template <bool with_S>
sfdae_multibody_problem example(Source source, double& mass) {
  sfdae_multibody_problem p{};
  p.size = sizeof p;
  p.num_positions = nq, p.num_velocities = nv, p.num_constraints = nl, p.num_nonholonomic = nk;
  p.user = &mass;
  if (source == Source::recorded) {
    p.equations = recorded_example<with_S>;
    return p;
  }
  p.mass = mass_callback, p.forces = force_callback;
  p.constraints = position_callback<&Formulas<double>::g>;
  p.constraint_jacobian = jacobian_callback, p.constraint_rate = rate_callback;
  if (with_S) p.kinematics = position_callback<&Formulas<double>::S>;
  p.nonholonomic_matrix = position_callback<&Formulas<double>::H>;
  p.nonholonomic_offset = position_callback<&Formulas<double>::h>;
  if (source == Source::callbacks) return p;
  p.constraint_curvature = curvature_callback<with_S>;
  p.nonholonomic_curvature = nonholonomic_curvature_callback<with_S>;
  return p;
}

}  // namespace sfdae_test

#endif
