// SPDX-License-Identifier: BSD-3-Clause
// The systems that multibody tests are made of: gradients, solutions, and what the general path makes of them.
#include <gtest/gtest.h>

#include <cmath>

#include "multibody/callbacks.h"
#include "multibody/chain.h"
#include "multibody/four_bar.h"
#include "multibody/knife_edge.h"
#include "multibody/system.h"
#include "test_set/andrews.h"
#include "test_set/car_axis.h"
#include "test_set/fekete.h"
#include "test_set/rigid_slider_crank.h"
#include "test_set/slider_crank.h"

namespace {

using namespace sfdae_test;

// visit(name, system, t, q)
template <class Visitor>
void for_each_system(Visitor&& visit) {
  const auto positions_of = [](const TestProblem& p, int count) {
    return std::vector<double>(p.x0.begin(), p.x0.begin() + count);
  };
  visit("car_axis", DirectSystem<CarAxis>(), 0.3, positions_of(car_axis(), 4));
  visit("rigid_slider_crank", DirectSystem<RigidSliderCrank>(), 0.0, positions_of(rigid_slider_crank(), 3));
  visit("fekete", DirectSystem<Fekete>(), 0.0, positions_of(fekete(), 60));
  visit("slider_crank", AcceleratedSystem<SliderCrank>(), 0.01, positions_of(slider_crank(), 7));
  visit("andrews", AcceleratedSystem<Andrews>(), 0.0, positions_of(andrews(), 7));
  visit("four_bar", FourBar(), 0.0, four_bar_start(true));
  visit("plane_four_bar", PlaneFourBar(), 0.0, four_bar_start(false));
  visit("chain", PendulumChain(10), 0.0, PendulumChain(10).start());
}

TEST(SystemsOfBodies, HaveTheGradientsOfTheirConstraints) {
  for_each_system([](const char* name, const auto& system, double t, const std::vector<double>& q) {
    const int nq = system.sizes.positions, nl = system.sizes.holonomic;
    std::vector<double> G = zeros<double>(nl * nq);
    system.gradient(t, q.data(), G.data());
    for (int j = 0; j < nq; ++j) {
      std::vector<Jet> path, g(static_cast<std::size_t>(nl));
      for (int i = 0; i < nq; ++i) path.push_back(along(q[static_cast<std::size_t>(i)], i == j ? 1.0 : 0.0, 1));
      system.constraints(Jet(t), path.data(), g.data());
      for (int i = 0; i < nl; ++i)
        EXPECT_NEAR(G[static_cast<std::size_t>(i + j * nl)], g[static_cast<std::size_t>(i)][1], 1e-12 * (1 + nl * nl))
            << name << i << j;
    }
  });
}

TEST(SystemsOfBodies, StartWhereTheirConstraintsHold) {
  for_each_system([](const char* name, const auto& system, double t, const std::vector<double>& q) {
    std::vector<double> g = zeros<double>(system.sizes.holonomic);
    system.constraints(t, q.data(), g.data());
    if (t > 0.0) return;
    for (const double value : g) EXPECT_NEAR(value, 0.0, 1e-13) << name;
  });
}

// As general equations they are those of the test set, but for the sign and size of multipliers, which are zero here.
TEST(SystemsOfBodies, AreThoseOfTheTestSet) {
  const DirectSystem<CarAxis> system;
  std::vector<double> x = car_axis().x0, xdot = car_axis().xdot0, expected(10), found(10);
  for (std::size_t i = 0; i < 8; ++i) x[i] += 0.01 * static_cast<double>(i), xdot[i] += 0.02 * static_cast<double>(i);
  car_axis_residual(0.3, x.data(), xdot.data(), expected.data());
  general_residual(system, 0.3, x.data(), xdot.data(), found.data());
  for (std::size_t i = 0; i < 10; ++i) EXPECT_NEAR(found[i], expected[i], 1e-14) << i;

  const AcceleratedSystem<Andrews> squeezer;
  const TestProblem p = andrews();
  std::vector<double> y(p.x0.begin(), p.x0.begin() + 14), slope(p.x0.begin() + 7, p.x0.begin() + 21), F(20), r(27);
  y.insert(y.end(), p.x0.begin() + 21, p.x0.end());
  slope.resize(20);
  general_residual(squeezer, 0.0, y.data(), slope.data(), F.data());
  Andrews::balance(p.x0.data(), r.data());
  for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(F[7 + i], r[i], 1e-10) << i;
}

TEST(KnifeEdge, FulfilsItsEquations) {
  const KnifeEdge system;
  for (const double t : {0.0, 0.4, 1.7}) {
    const std::vector<double> x = KnifeEdge::exact(t);
    constexpr double h = 1e-5;
    const std::vector<double> after = KnifeEdge::exact(t + h), before = KnifeEdge::exact(t - h);
    std::vector<double> xdot(7), F(7);
    for (std::size_t i = 0; i < 7; ++i) xdot[i] = (after[i] - before[i]) / (2.0 * h);
    general_residual(system, t, x.data(), xdot.data(), F.data());
    for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(F[i], 0.0, 10.0 * h * h + 1e-15 / h * 20.0) << i << " at " << t;
  }
}

}  // namespace
