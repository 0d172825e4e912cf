// SPDX-License-Identifier: BSD-3-Clause
// Constrained mechanical systems: hand-made derivatives of constraints, constraint forces without power, balances of
// energy, and references that satisfy the hidden constraints.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "matrix_checks.h"
#include "test_set/test_set.h"

namespace {

using namespace sfdae_test;

// A motion through a point near the start of a problem with the derivatives v, a.
template <class System>
struct Motion {
  static constexpr int np = System::positions;
  explicit Motion(const TestProblem& problem) {
    RandomNumbers numbers(7);
    for (std::size_t i = 0; i < np; ++i) {
      p[i] = Jet::zero(2);
      p[i][0] = problem.x0[i] + numbers.uniform(-0.1, 0.1);
      p[i][1] = numbers.uniform(-1.0, 1.0);
      p[i][2] = numbers.uniform(-1.0, 1.0);
      v[i] = derivative(p[i]);
      a[i] = derivative(v[i]);
      value_p[i] = p[i][0], value_v[i] = v[i][0], value_a[i] = a[i][0];
    }
  }
  std::array<Jet, np> p, v, a;
  std::array<double, np> value_p, value_v, value_a;
};

template <class System>
void expect_derivatives_of_constraints(const TestProblem& problem) {
  const Motion<System> motion(problem);
  constexpr std::size_t nl = System::multipliers;
  const double t = 0.3;
  std::array<Jet, nl> g;
  std::array<double, nl> g0{}, g1{}, g2{};
  System::constraints(Jet::variable(t, 2), motion.p.data(), g.data());
  System::constraints(t, motion.value_p.data(), g0.data());
  System::velocity_constraints(t, motion.value_p.data(), motion.value_v.data(), g1.data());
  System::acceleration_constraints(t, motion.value_p.data(), motion.value_v.data(), motion.value_a.data(), g2.data());
  for (std::size_t i = 0; i < nl; ++i) {
    const double tolerance = rounding(System::positions) * 10.0 * (1.0 + std::abs(g0[i]) + std::abs(g2[i]));
    EXPECT_NEAR(g[i][0], g0[i], tolerance) << problem.name << ", constraint " << i;
    EXPECT_NEAR(g[i][1], g1[i], tolerance) << problem.name << ", constraint " << i;
    EXPECT_NEAR(2.0 * g[i][2], g2[i], tolerance) << problem.name << ", constraint " << i;
  }
}

TEST(Mechanical, ConstraintsAreDifferentiatedCorrectly) {
  expect_derivatives_of_constraints<Pendulum>(pendulum());
  expect_derivatives_of_constraints<CarAxis>(car_axis());
  expect_derivatives_of_constraints<RigidSliderCrank>(rigid_slider_crank());
  expect_derivatives_of_constraints<SliderCrank>(slider_crank());
  expect_derivatives_of_constraints<Andrews>(andrews());
  expect_derivatives_of_constraints<Fekete>(fekete());
}

// v . G^T mu = mu . G v; factor: what the multipliers of a problem are multiplied with.
template <class System, class AddForces>
void expect_no_power(const TestProblem& problem, double factor, const AddForces& add) {
  const Motion<System> motion(problem);
  constexpr std::size_t np = System::positions, nl = System::multipliers;
  const double t = 0.3;
  std::array<double, np> force{}, rest{};
  std::array<double, nl> mu, Gv, g_t;
  RandomNumbers numbers(11);
  for (double& value : mu) value = numbers.uniform(-1.0, 1.0);
  add(t, motion.value_p.data(), mu.data(), force.data());
  System::velocity_constraints(t, motion.value_p.data(), motion.value_v.data(), Gv.data());
  System::velocity_constraints(t, motion.value_p.data(), rest.data(), g_t.data());
  double power = 0.0, expected = 0.0;
  for (std::size_t i = 0; i < np; ++i) power += motion.value_v[i] * force[i];
  for (std::size_t i = 0; i < nl; ++i) expected += factor * mu[i] * (Gv[i] - g_t[i]);
  EXPECT_NEAR(power, expected, rounding(np) * 300.0) << problem.name;
  EXPECT_GT(std::abs(expected), 1e-3) << problem.name;
}

TEST(Mechanical, ConstraintForcesAreNormalToTheConstraints) {
  const auto direct = []<class System>(System) {
    return [](double t, const double* p, const double* mu, double* f) { System::add_constraint_forces(t, p, mu, f); };
  };
  const auto accelerated = []<class System>(System) {
    return [](double, const double* p, const double* mu, double* f) { System::add_multipliers(p, mu, f); };
  };
  expect_no_power<Pendulum>(pendulum(), 0.5, direct(Pendulum{}));
  expect_no_power<CarAxis>(car_axis(), 1.0, direct(CarAxis{}));
  expect_no_power<RigidSliderCrank>(rigid_slider_crank(), 1.0, direct(RigidSliderCrank{}));
  expect_no_power<SliderCrank>(slider_crank(), 1.0, accelerated(SliderCrank{}));
  expect_no_power<Andrews>(andrews(), 1.0, accelerated(Andrews{}));
  expect_no_power<Fekete>(fekete(), -1.0, direct(Fekete{}));
}

// v . (M w - f) = d/dt (v . M v / 2 + elastic energy) - power of the drive, for any motion: only if the velocity
// dependent forces belong to the mass matrix.
template <class System, class Energy>
void expect_balance_of_energy(const TestProblem& problem, const Energy& elastic, double drive) {
  const Motion<System> motion(problem);
  constexpr std::size_t np = System::positions;
  std::array<Jet, np> Mv;
  System::apply_mass(motion.p.data(), motion.v.data(), Mv.data());
  Jet energy = elastic(motion.p.data());
  std::array<double, np> r;
  System::apply_mass(motion.value_p.data(), motion.value_a.data(), r.data());
  System::subtract_forces(motion.value_p.data(), motion.value_v.data(), r.data());
  double power = drive * motion.value_v[0], scale = 0.0;
  for (std::size_t i = 0; i < np; ++i) {
    energy = energy + 0.5 * motion.v[i] * Mv[i];
    power += motion.value_v[i] * r[i];
    scale += std::abs(motion.value_v[i] * r[i]);
  }
  EXPECT_NEAR(power, energy[1], rounding(np) * scale) << problem.name;
}

TEST(Mechanical, EnergyIsBalanced) {
  expect_balance_of_energy<Andrews>(
      andrews(),
      [](const Jet* q) {
        using A = Andrews;
        const Jet x = A::sd * cos(q[2]) + A::sc * sin(q[2]) + A::xb - A::xc;
        const Jet y = A::sd * sin(q[2]) - A::sc * cos(q[2]) + A::yb - A::yc;
        return 0.5 * A::c0 * square(sqrt(x * x + y * y) - A::l0);
      },
      Andrews::mom);
  // The stiffness is 1e9 times the rest: forces of inertia are tested without it.
  const auto elastic = [](const Jet* p) {
    Jet energy;
    for (std::size_t i = 0; i < 4; ++i)
      energy = energy + 0.5 * p[3 + i] * SliderCrank::dot(SliderCrank::KQ[i], p + 3);
    return energy;
  };
  expect_balance_of_energy<SliderCrank>(slider_crank(), elastic, 0.0);
}

// f(p, v) of the slider crank without elastic forces, which would hide the rest: q small, K q subtracted again.
TEST(SliderCrank, ForcesOfInertiaBalanceTheKineticEnergy) {
  const Motion<SliderCrank> motion(slider_crank());
  std::array<Jet, 7> Mv;
  std::array<double, 7> r;
  SliderCrank::apply_mass(motion.p.data(), motion.v.data(), Mv.data());
  std::array<double, 7> p = motion.value_p;
  Jet energy;
  for (std::size_t i = 0; i < 7; ++i) energy = energy + 0.5 * motion.v[i] * Mv[i];
  SliderCrank::apply_mass(p.data(), motion.value_a.data(), r.data());
  SliderCrank::subtract_forces(p.data(), motion.value_v.data(), r.data());
  double power = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < 7; ++i) {
    double elastic = i < 3 ? 0.0 : SliderCrank::dot(SliderCrank::KQ[i - 3], p.data() + 3);
    largest = std::max(largest, std::abs(elastic));
    power += motion.value_v[i] * (r[i] - elastic);
  }
  EXPECT_NEAR(power, energy[1], 1e3 * unit_roundoff * largest);
  EXPECT_GT(std::abs(energy[1]), 1e5 * unit_roundoff * largest);  // else the test says nothing
}

// Positions, velocities and accelerations from the forces satisfy the constraints on all levels.
template <class System>
void expect_hidden_constraints(const TestProblem& problem) {
  const std::vector<double>& x = problem.references[0].x;
  constexpr std::size_t np = System::positions, nl = System::multipliers;
  std::array<double, np> a;
  std::array<double, nl> g{};
  System::forces(problem.tf, x.data(), a.data());
  for (std::size_t i = 0; i < np; ++i) a[i] /= System::mass(static_cast<int>(i));
  const double scale = 10.0 * (1.0 + max_abs(column(x)) + max_abs(column(std::vector<double>(a.begin(), a.end()))));
  for (const auto level : {ConstraintLevel::position, ConstraintLevel::velocity, ConstraintLevel::acceleration}) {
    constraints_at<System>(level, problem.tf, x.data(), a.data(), g.data());
    for (const double value : g)
      EXPECT_LE(std::abs(value), scale * std::pow(10.0, -problem.reference_digits)) << problem.name;
  }
}

TEST(Mechanical, ReferencesSatisfyTheHiddenConstraints) {
  expect_hidden_constraints<Pendulum>(pendulum());
  expect_hidden_constraints<CarAxis>(car_axis());
  expect_hidden_constraints<RigidSliderCrank>(rigid_slider_crank());
}

// Terms of the balances: M w, f and G^T lambda. Rounding of the accelerations, which are up to 6e5 for Andrews.
TEST(AndrewsReference, SatisfiesBalancesAndHiddenConstraints) {
  const TestProblem problem = andrews();
  const std::vector<double>& x = problem.references[0].x;
  double r[7], g[6];
  Andrews::balance(x.data(), r);
  for (const double value : r) EXPECT_LE(std::abs(value), rounding(7) * 33.0);
  Andrews::constraints(problem.tf, x.data(), g);
  for (const double value : g) EXPECT_LE(std::abs(value), rounding(7));
  Andrews::velocity_constraints(problem.tf, x.data(), x.data() + 7, g);
  for (const double value : g) EXPECT_LE(std::abs(value), rounding(7) * 0.03 * 1500.0);
  Andrews::acceleration_constraints(problem.tf, x.data(), x.data() + 7, x.data() + 14, g);
  for (const double value : g) EXPECT_LE(std::abs(value), rounding(7) * 0.03 * 6e5);
}

// The start values satisfy the constraints to 1e-8, which a code that differentiates them keeps; velocities are up to
// 150. The forces that are balanced reach the stiffness 2.3e8 times modes of 2.4e-5.
TEST(SliderCrankReference, SatisfiesBalancesAndConstraints) {
  const TestProblem problem = slider_crank();
  const std::vector<double>& x = problem.references[0].x;
  double r[7], g[3];
  SliderCrank::balance(x.data(), r);
  for (const double value : r) EXPECT_LE(std::abs(value), rounding(7) * 2.3e8 * 2.4e-5);
  SliderCrank::constraints(problem.tf, x.data(), g);
  for (const double value : g) EXPECT_LE(std::abs(value), 1e-8);
  SliderCrank::velocity_constraints(problem.tf, x.data(), x.data() + 7, g);
  for (const double value : g) EXPECT_LE(std::abs(value), rounding(7) * 150.0);
}

}  // namespace
