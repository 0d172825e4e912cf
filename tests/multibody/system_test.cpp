// The strangeness-free system of a mechanical system by itself: orders of fixed steps, maps of errors.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "integrate/radau_method.h"
#include "multibody/multibody_system.h"
#include "multibody/problem_of.h"
#include "pendulum.h"

namespace sfdae::test {
namespace {

using namespace sfdae::core;

class SystemOfPendulum : public testing::Test {
 protected:
  SystemOfPendulum() : callbacks(model.problem()), problem(sfdae_test::problem_of(callbacks)) {}

  MultibodySystem system_at(double t, const std::vector<double>& x) {
    IndexAnalysis analysis;
    analysis.t = t;
    analysis.values = characteristic_values(problem->sizes(), {1, 1});
    return {*problem, {{1, 1}, Coordinates::orthogonal}, analysis, x.data(), x.data() + 2};
  }
  // Fixed steps of a Radau method up to t = 1.
  std::vector<double> integrate(int stages, int steps) {
    std::vector<double> x = start;
    MultibodySystem system = system_at(0.0, x);
    const StageMethod& method = radau_method(stages).stages;
    std::vector<double> all(5 * static_cast<std::size_t>(stages)), w(all), guess(all);
    const std::vector<double> exacting(5, 1e13);
    for (int k = 0; k < steps; ++k) {
      for (std::size_t i = 0; i < guess.size(); ++i) guess[i] = x[i % 5];
      double reached = 0.0;
      const StageEquations equations{method,   static_cast<double>(k) / steps,           (k + 1.0) / steps, x.data(),
                                     x.data(), {guess.data(), x.data(), exacting.data()}};
      EXPECT_EQ(system.solve_stages(equations, all.data(), w.data(), reached), PointStatus::ok);
      system.accept();
      std::copy_n(all.end() - 5, 5, x.begin());
    }
    return x;
  }

  Pendulum model;
  sfdae_multibody_problem callbacks;
  std::unique_ptr<MultibodyProblem> problem;
  const std::vector<double> start = Pendulum::state(0.9, 2.0);
};

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::fabs(a[i] - b[i]));
  return largest;
}

// Order 2 s - 1 in all components: multipliers, too, as they follow from positions and velocities.
TEST_F(SystemOfPendulum, RadauHasItsOrder) {
  const std::vector<double> exact = integrate(7, 40);
  for (const auto& [stages, steps] : {std::pair{1, 160}, std::pair{3, 20}, std::pair{5, 6}}) {
    const double coarse = distance(integrate(stages, steps), exact),
                 fine = distance(integrate(stages, 2 * steps), exact);
    EXPECT_NEAR(std::log2(coarse / fine), 2.0 * stages - 1.0, 0.7) << stages << " stages";
  }
}

// dx of a change along the solution's tangent space is that change, with that of lambda = |v|^2 - q_2; changes across
// vanish.
TEST_F(SystemOfPendulum, ErrorsAreMappedToAllComponents) {
  MultibodySystem system = system_at(0.0, start);
  const double q1 = start[0], q2 = start[1], v1 = start[2], v2 = start[3];
  // Columns: velocity along the circle; position across it.
  const std::vector<double> dw = {0.0, 0.0, -q2, q1, q1, q2, 0.0, 0.0};
  std::vector<double> dx(10);
  system.error_in_x(dw.data(), 2, dx.data());
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(dx[i], dw[i], 1e-9);
  EXPECT_NEAR(dx[4], 2.0 * (-v1 * q2 + v2 * q1), 1e-6);
  for (std::size_t i = 5; i < 10; ++i) EXPECT_NEAR(dx[i], 0.0, 1e-9);
}

TEST_F(SystemOfPendulum, RestoreProjectsFromFarAway) {
  MultibodySystem system = system_at(0.0, start);
  std::vector<double> rough = start, x(5);
  rough[0] += 0.1;
  rough[1] -= 0.1;
  rough[2] += 0.3;
  system.restore(nullptr, rough.data(), x.data());
  EXPECT_LE(std::fabs(x[0] * x[0] + x[1] * x[1] - 1.0), 4e-16);
  EXPECT_LE(std::fabs(x[0] * x[2] + x[1] * x[3]), 1e-15);
  EXPECT_NEAR(x[4], x[2] * x[2] + x[3] * x[3] - x[1], 1e-13);
}

// A constraint in units that underflow at the times of one stage: N = 1 / 1e-310 overflows there, and N g is NaN. The
// iteration ends there, whichever stage it is, and callbacks are not called with it.
struct Underflow {
  double from = 0.0, to = 0.0;
  bool has_seen_nan = false;
  double unit(double t) const { return t > from && t < to ? 1e-310 : 1.0; }
  static Underflow& of(void* user) { return *static_cast<Underflow*>(user); }
  static int forces(double, const double* q, const double*, double* f, void* user) {
    of(user).has_seen_nan = of(user).has_seen_nan || std::isnan(q[0]) || std::isnan(q[1]);
    f[1] = -1.0;
    return 0;
  }
  static int constraints(double t, const double* q, double* g, void* user) {
    of(user).has_seen_nan = of(user).has_seen_nan || std::isnan(q[0]) || std::isnan(q[1]);
    g[0] = of(user).unit(t) * (q[0] + q[1]);
    return 0;
  }
  static int jacobian(double t, const double*, double* g_q, void* user) {
    g_q[0] = g_q[1] = of(user).unit(t);
    return 0;
  }
  static int curvature(double, const double*, const double*, double*, void*) { return 0; }
};

TEST(StagesOfMultibodySystems, NoNaNOfAnyStageIsDropped) {
  const StageMethod& method = radau_method(3).stages;
  for (std::size_t bad = 0; bad < 3; ++bad) {
    const double h = 0.1, near = 1e-3;
    Underflow model{h * method.c[bad] - near, h * method.c[bad] + near};
    sfdae_multibody_problem callbacks = multibody_problem_of(2, 1);
    callbacks.forces = Underflow::forces;
    callbacks.constraints = Underflow::constraints;
    callbacks.constraint_jacobian = Underflow::jacobian;
    callbacks.constraint_curvature = Underflow::curvature;
    callbacks.user = &model;
    const auto problem = sfdae_test::problem_of(callbacks);
    IndexAnalysis analysis;
    analysis.values = characteristic_values(problem->sizes(), {1, 1});
    const std::vector<double> x = {0.0, 0.0, 0.0, 0.0, 0.0}, exacting(5, 1e6);
    MultibodySystem system(*problem, {{1, 1}, Coordinates::orthogonal}, analysis, x.data(), x.data() + 2);
    std::vector<double> all(15), w(15), guess(15);
    double reached = 0.0;
    const StageEquations equations{method, 0.0, h, x.data(), x.data(), {guess.data(), x.data(), exacting.data()}};
    EXPECT_NE(system.solve_stages(equations, all.data(), w.data(), reached), PointStatus::ok) << bad;
    EXPECT_FALSE(model.has_seen_nan) << bad;
  }
}

}  // namespace
}  // namespace sfdae::test
