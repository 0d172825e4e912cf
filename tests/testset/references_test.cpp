// SPDX-License-Identifier: BSD-3-Clause
// Integrations that know nothing of the library end at the references, with the orders of their methods: a wrong term
// anywhere in the equations would lead elsewhere.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "fixed_step_radau.h"
#include "test_set/test_set.h"

namespace {

using namespace sfdae_test;

// Correct digits at tf after `steps` steps in each segment; residual(segment, t, x, xdot, F) of index 0 or 1.
template <class Residual>
double digits_with(const TestProblem& p, const Residual& residual, int steps) {
  std::vector<double> ends = p.restarts;
  ends.push_back(p.tf);
  int segment = 0;
  const auto current = [&](double t, const double* x, const double* xdot, double* F) {
    residual(segment, t, x, xdot, F);
  };
  FixedStepRadau radau(current, p.x0);
  double begin = p.t0;
  for (const double end : ends) {
    radau.integrate(begin, end, steps);
    begin = end;
    ++segment;
  }
  return correct_digits(p, p.references[0], radau.x().data());
}

// Doubling the steps of a method of order 3 gains 0.9 digits, of order 2 0.6, of order 1 0.3.
template <class Residual>
void expect_convergence(const TestProblem& p, const Residual& residual, int steps, double gain = 0.6) {
  const double coarse = digits_with(p, residual, steps), fine = digits_with(p, residual, 2 * steps);
  EXPECT_GE(fine, 3.0) << p.name;
  EXPECT_GE(fine - coarse, gain) << p.name;
}

template <class System>
void expect_convergence_of_reduced(const TestProblem& p, int steps) {
  const auto residual = [](int, double t, const double* x, const double* xdot, double* F) {
    direct_residual<System, ConstraintLevel::acceleration>(t, x, xdot, F);
  };
  expect_convergence(p, residual, steps);
}

TEST(References, AreReachedByReducedMechanicalSystems) {
  expect_convergence_of_reduced<Pendulum>(pendulum(), 4000);
  expect_convergence_of_reduced<CarAxis>(car_axis(), 3000);
  expect_convergence_of_reduced<RigidSliderCrank>(rigid_slider_crank(), 250);
}

TEST(References, AreReachedByTheAmplifier) {
  const auto residual = [](int, double t, const double* x, const double* xdot, double* F) {
    transistor_amplifier_residual(t, x, xdot, F);
  };
  expect_convergence(transistor_amplifier(), residual, 2000);
}

TEST(References, AreReachedByTheReaction) {
  const auto residual = [](int, double t, const double* x, const double* xdot, double* F) {
    akzo_residual(t, x, xdot, F);
  };
  expect_convergence(akzo(), residual, 2000);
}

TEST(References, AreReachedByTheGate) {
  const auto residual = [](int segment, double t, const double* x, const double* xdot, double* F) {
    nand_residual(nand_inputs(t, segment), x, xdot, F);
  };
  expect_convergence(nand(), residual, 100, 0.3);  // transistors switch within steps
}

// Index-1 form of the Fekete problem, lambda eliminated: |q|^2 + p . q' = 0. x = (p, q, lambda).
void fekete_slope(std::vector<double>& x, std::vector<double>& xdot) {
  for (std::size_t i = 120; i < 140; ++i) x[i] = 0.0;
  Fekete::forces(0.0, x.data(), xdot.data() + 60);
  for (std::size_t i = 0; i < 20; ++i) {
    const double *p = &x[3 * i], *q = &x[60 + 3 * i];
    x[120 + i] = -0.5 * (Fekete::dot(q, q) + Fekete::dot(p, static_cast<const double*>(&xdot[60 + 3 * i]))) /
                 Fekete::dot(p, p);
  }
  Fekete::forces(0.0, x.data(), xdot.data() + 60);
  std::copy(x.begin() + 60, x.begin() + 120, xdot.begin());
}

// The classical Runge-Kutta method: the motion is not stiff. Doubling the steps gains 1.2 digits.
double fekete_digits(int steps) {
  const TestProblem p = fekete_position();
  std::vector<double> x = p.x0, stage, sum, k(140);
  const double h = p.tf / steps;
  for (int step = 0; step < steps; ++step) {
    stage = sum = x;
    for (int s = 0; s < 4; ++s) {
      fekete_slope(stage, k);
      const double weight = s == 0 || s == 3 ? h / 6 : h / 3, next = s < 2 ? h / 2 : h;
      for (std::size_t i = 0; i < 120; ++i) {
        sum[i] += weight * k[i];
        stage[i] = x[i] + next * k[i];
      }
    }
    x = sum;
  }
  return correct_digits(p, p.references[0], x.data());
}

TEST(References, AreReachedByTheFeketePoints) {
  const double coarse = fekete_digits(20000), fine = fekete_digits(40000);
  EXPECT_GE(fine, 3.0);
  EXPECT_GE(fine - coarse, 0.9);
}

}  // namespace
