// SPDX-License-Identifier: BSD-3-Clause
// A system as callbacks of sfdae_multibody_problem; derivatives by Taylor series along t + s, q + s w.
#ifndef SFDAE_TESTS_MULTIBODY_CALLBACKS_H
#define SFDAE_TESTS_MULTIBODY_CALLBACKS_H

#include <algorithm>

#include "sfdae/sfdae.h"
#include "system.h"
#include "test_set/scalar.h"

namespace sfdae_test {

inline Jet along(double value, double slope, int order) {
  Jet path = Jet::zero(order);
  path[0] = value;
  if (order > 0) path[1] = slope;
  return path;
}

// `user` is the system.
template <class System>
struct MultibodyCallbacks {
  static const System& of(void* user) { return *static_cast<const System*>(user); }

  static int mass(double t, const double* q, double* M, void* user) {
    of(user).mass(t, q, M);
    return 0;
  }
  static int force(double t, const double* q, const double* v, double* f, void* user) {
    of(user).force(t, q, v, f);
    return 0;
  }
  static int constraints(double t, const double* q, double* g, void* user) {
    of(user).constraints(t, q, g);
    return 0;
  }
  static int gradient(double t, const double* q, double* G, void* user) {
    of(user).gradient(t, q, G);
    return 0;
  }
  // g_t
  static int rate(double t, const double* q, double* result, void* user) {
    const std::vector<double> none(static_cast<std::size_t>(of(user).sizes.positions), 0.0);
    return series(of(user), t, q, none.data(), 1, result);
  }
  // The second derivative of g(t + s, q + s v).
  static int curvature(double t, const double* q, const double* v, double* result, void* user) {
    return series(of(user), t, q, v, 2, result);
  }
  static int nonholonomic_matrix(double t, const double* q, double* H, void* user) {
    std::vector<double> h(static_cast<std::size_t>(of(user).sizes.nonholonomic));
    of(user).nonholonomic(t, q, H, h.data());
    return 0;
  }
  static int nonholonomic_offset(double t, const double* q, double* h, void* user) {
    const SystemSizes& s = of(user).sizes;
    std::vector<double> H(static_cast<std::size_t>(s.nonholonomic * s.positions));
    of(user).nonholonomic(t, q, H.data(), h);
    return 0;
  }

  static void fill(const System& system, sfdae_multibody_problem& problem) {
    problem.mass = mass;
    problem.forces = force;
    if (system.sizes.holonomic > 0) {
      problem.constraints = constraints;
      problem.constraint_jacobian = gradient;
      problem.constraint_rate = rate;
      problem.constraint_curvature = curvature;
    }
    if (system.sizes.nonholonomic > 0) {
      problem.nonholonomic_matrix = nonholonomic_matrix;
      problem.nonholonomic_offset = nonholonomic_offset;
    }
  }

 private:
  // The derivative of the given order of g along (1, w).
  static int series(const System& system, double t, const double* q, const double* w, int order, double* result) {
    std::vector<Jet> path, g(static_cast<std::size_t>(system.sizes.holonomic));
    for (int i = 0; i < system.sizes.positions; ++i) path.push_back(along(q[i], w[i], order));
    system.constraints(along(t, 1.0, order), path.data(), g.data());
    std::transform(g.begin(), g.end(), result, [order](const Jet& a) { return factorial(order) * a[order]; });
    return 0;
  }
};

}  // namespace sfdae_test

#endif
