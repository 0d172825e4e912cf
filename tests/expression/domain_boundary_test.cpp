// SPDX-License-Identifier: BSD-3-Clause
// Derivatives at the boundary of a domain: limits of products with 0, slopes of a nearby point where they are infinite,
// zeros of what is constant. Taylor coefficients that do not exist are refused.
#include "expression/domain_boundary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "linalg/index.h"
#include "random_family.h"
#include "recorded.h"

namespace sfdae::core::domain_boundary {

namespace {

using namespace sfdae_test;
using Formula = std::function<Term(const Recording&)>;

constexpr double tolerance = 1e-8;

// One equation f(t, x) = 0 in n unknowns; x(s) = x0 + s.
struct Trial {
  Trial(const Formula& f, std::vector<double> x0, double atol = tolerance)
      : recording(static_cast<int>(x0.size())), evaluator(recording.finish({f(recording)})), jet(x0) {
    evaluator.set_movement({{tolerance}, {atol}});
    jet.resize(x0.size() * 5, 0.0);
    for (std::size_t j = 0; j < x0.size(); ++j) jet[x0.size() + j] = 1.0;
    F.assign(4, NAN);
    F_x.assign(4 * x0.size(), NAN);
    F_xdot = F_x;
  }
  bool evaluate(int order) {
    return evaluator.gradients(0.0, jet.data(), {order, order, order}, F.data(), F_xdot.data(), F_x.data());
  }
  Recording recording;
  TaylorEvaluator evaluator;
  std::vector<double> jet, F, F_xdot, F_x;
};

}  // namespace

TEST(DomainBoundary, ProductsHaveTheirLimit) {
  struct Case {
    Formula f;
    std::vector<double> x0, F_x;
  };
  const std::vector<Case> cases = {
      {[](const Recording& r) { return sqrt(r.x[0] * r.x[0]) * r.x[0]; }, {0.0}, {0.0}},
      {[](const Recording& r) { return pow(r.x[0] * r.x[0], 0.5) * r.x[0] + r.x[0]; }, {0.0}, {1.0}},
      {[](const Recording& r) { return sqrt(r.x[0] * r.x[0] + r.x[1] * r.x[1]) * r.x[0]; }, {0.0, 0.0}, {0.0, 0.0}},
      {[](const Recording& r) { return sqrt(abs(r.x[0])) * pow(r.x[0], 3.0); }, {0.0}, {0.0}},
      {[](const Recording& r) { return sqrt(r.x[0]) * r.x[0]; }, {0.0}, {0.0}},
      {[](const Recording& r) { return pow(r.x[0], 0.2) * r.x[0]; }, {0.0}, {0.0}},
      {[](const Recording& r) { return asin(r.x[0]) * (1.0 - r.x[0]); }, {1.0}, {-std::asin(1.0)}},
      {[](const Recording& r) { return acos(r.x[0]) * (1.0 - r.x[0]); }, {1.0}, {0.0}},
      {[](const Recording& r) { return sqrt(max(r.x[0], 0.0)); }, {0.0}, {0.0}},
      {[](const Recording& r) { return choose(r.x[1], sqrt(r.x[0]), 2.0 * r.x[0]); }, {0.0, -1.0}, {2.0, 0.0}},
  };
  for (std::size_t i = 0; i < cases.size(); ++i) {
    Trial trial(cases[i].f, cases[i].x0);
    ASSERT_TRUE(trial.evaluate(0)) << "case " << i << ": " << trial.evaluator.failure().message;
    for (std::size_t j = 0; j < cases[i].x0.size(); ++j)
      EXPECT_EQ(trial.F_x[j], cases[i].F_x[j]) << "case " << i << ", unknown " << j;
  }
}

// The unknown is moved by half its tolerance to all of it.
TEST(DomainBoundary, InfiniteSlopesAreThoseOneToleranceInside) {
  for (double unit : {1e-6, 1.0, 1e6})
    for (double exponent : {0.2, 0.3, 0.5, 0.7, 0.9}) {
      Trial trial([&](const Recording& r) { return unit * pow(r.x[0] / unit, exponent); }, {0.0}, unit * tolerance);
      ASSERT_TRUE(trial.evaluate(0)) << trial.evaluator.failure().message;
      EXPECT_EQ(trial.F[0], 0.0);
      const double slope = exponent * std::pow(tolerance, exponent - 1.0);
      EXPECT_GE(trial.F_x[0], slope * 0.99);
      EXPECT_LE(trial.F_x[0], slope * std::pow(0.5, exponent - 1.0) * 1.01);
    }
}

TEST(DomainBoundary, AnglesHaveTheSlopeInside) {
  for (double side : {1.0, -1.0}) {
    Trial sine([](const Recording& r) { return asin(r.x[0]); }, {side});
    Trial cosine([](const Recording& r) { return acos(r.x[0]); }, {side});
    ASSERT_TRUE(sine.evaluate(0) && cosine.evaluate(0));
    // At 1 - d: 1 / sqrt(2 d), d between 1 and 2 tolerances (rtol |x| + atol).
    EXPECT_GE(sine.F_x[0], 0.99 / std::sqrt(4.0 * tolerance));
    EXPECT_LE(sine.F_x[0], 1.01 / std::sqrt(2.0 * tolerance));
    EXPECT_EQ(cosine.F_x[0], -sine.F_x[0]);
  }
}

TEST(DomainBoundary, ConstantOperandsHaveCoefficientsZero) {
  const std::vector<Formula> constants = {
      [](const Recording& r) { return sqrt(max(r.x[0], 0.0)); },
      [](const Recording& r) { return pow(max(r.x[0], 0.0), 0.3); },
      [](const Recording& r) { return sqrt(max(r.t - 1.0, 0.0)); },
      [](const Recording& r) { return acos(min(r.x[0] + 3.0, 1.0)); },
  };
  for (std::size_t i = 0; i < constants.size(); ++i) {
    Trial trial([&](const Recording& r) { return constants[i](r) + r.x[0]; }, {-1.0});
    ASSERT_TRUE(trial.evaluate(3)) << "case " << i << ": " << trial.evaluator.failure().message;
    EXPECT_EQ(trial.F, std::vector({-1.0, 1.0, 0.0, 0.0})) << "case " << i;
    EXPECT_EQ(trial.F_x, std::vector({1.0, 0.0, 0.0, 0.0})) << "case " << i;
  }
}

TEST(DomainBoundary, CoefficientsThatDoNotExistAreRefusedWithARemedy) {
  Trial root([](const Recording& r) { return r.x[0] + sqrt(r.x[1]); }, {0.0, 0.0});
  ASSERT_FALSE(root.evaluate(1));
  EXPECT_EQ(root.evaluator.failure().message,
            "sqrt of 0 has no finite derivative of order 1 in equation 0. It depends on x[1] and has to be "
            "differentiated to find hidden constraints: start at a small positive argument, or add a small number to "
            "it, as in sqrt(h + 1e-12)");
  Trial angle([](const Recording& r) { return asin(r.x[0]); }, {1.0});
  ASSERT_FALSE(angle.evaluate(1));
  EXPECT_EQ(angle.evaluator.failure().message,
            "asin of 1 has no finite derivative of order 1 in equation 0. It depends on x[0] and has to be "
            "differentiated to find hidden constraints: start at an argument between -1 and 1");
  // |v| has a kink at 0: neither a constant nor smooth, though the first coefficients of v^2 are 0.
  Trial kink([](const Recording& r) { return sqrt(r.x[0] * r.x[0]); }, {0.0});
  EXPECT_FALSE(kink.evaluate(1));
}

// The first coefficient of u |(u, v)| is 0 where both are; that of |(u, v)| depends on the side.
TEST(DomainBoundary, CoefficientsThatNothingDependsOnAreUnknown) {
  const auto speed = [](const Recording& r) { return sqrt(r.x[0] * r.x[0] + r.x[1] * r.x[1]); };
  Trial drag([&](const Recording& r) { return r.x[0] + speed(r) * r.x[0]; }, {0.0, 0.0});
  ASSERT_TRUE(drag.evaluate(1)) << drag.evaluator.failure().message;
  EXPECT_EQ(drag.F[0], 0.0);
  EXPECT_EQ(drag.F[1], 1.0);
  for (const double gradient : drag.F_x) EXPECT_TRUE(std::isnan(gradient) || std::fabs(gradient) <= 1.0) << gradient;
  EXPECT_FALSE(drag.evaluate(2));  // |s| s has a second derivative of either sign
  // A product of roots is no root: sqrt(s) sqrt(s) = s.
  Trial square([](const Recording& r) { return sqrt(r.x[0]) * sqrt(r.x[0]); }, {0.0});
  EXPECT_FALSE(square.evaluate(1));
  Trial third([](const Recording& r) { return pow(r.x[0], 1.5); }, {0.0});
  ASSERT_TRUE(third.evaluator.values(0.0, third.jet.data(), 1, third.F.data()));
  EXPECT_EQ(third.F[1], 0.0);
  EXPECT_FALSE(third.evaluator.values(0.0, third.jet.data(), 2, third.F.data()));
}

TEST(DomainBoundary, SeriesExistAsFarAsFactorsVanish) {
  for (std::uint64_t number = 0; number < 300; ++number) {
    RandomNumbers random(3500 + number);
    const int power = random.integer(0, 3), order = random.integer(1, 3), root = random.integer(1, 2);
    // |s|^root s^power at s = 0: coefficients below root + power are 0. The next one may depend on the side.
    Trial trial(
        [&](const Recording& r) {
          Term product = random.uniform(0.5, 2.0) * pow(r.x[0] * r.x[0], 0.5);
          if (root == 2) product = product * sqrt(4.0 * r.x[0] * r.x[0]);
          for (int k = 0; k < power; ++k) product = product * r.x[0];
          return product + r.x[0];
        },
        {0.0});
    const bool exists = trial.evaluator.values(0.0, trial.jet.data(), order, trial.F.data());
    EXPECT_EQ(exists, order < root + power) << "root " << root << ", power " << power << ", order " << order;
    EXPECT_EQ(exists ? trial.F[1] : 1.0, 1.0);
  }
}

// Within what x is known to, an operand outside of the domain counts as at its boundary.
TEST(DomainBoundary, TolerancesReachBeyondIt) {
  for (const double part : {0.3, 3.0}) {
    const double x = -part * tolerance;
    Trial root([](const Recording& r) { return sqrt(r.x[0]); }, {x});
    Trial angle([](const Recording& r) { return acos(1.0 - r.x[0]); }, {x});
    EXPECT_EQ(root.evaluate(0), part < 1.0);
    EXPECT_EQ(angle.evaluate(0), part < 1.0);
    if (part > 1.0) continue;
    EXPECT_EQ(root.F[0], 0.0);
    EXPECT_EQ(angle.F[0], 0.0);
    EXPECT_GT(root.F_x[0], 0.0);
    EXPECT_TRUE(std::isfinite(root.F_x[0]));
  }
  Trial constant([](const Recording& r) { return sqrt(min(r.x[0], 0.0) * 0.0 - 1e-12) + r.x[0]; }, {1.0});
  EXPECT_FALSE(constant.evaluate(0));
}

TEST(DomainBoundary, LogarithmsOfZeroCountOnlyTimesZero) {
  Trial entropy([](const Recording& r) { return r.x[0] * log(r.x[0]); }, {0.0});
  ASSERT_TRUE(entropy.evaluate(0)) << entropy.evaluator.failure().message;
  EXPECT_EQ(entropy.F[0], 0.0);
  for (const Formula& f : std::vector<Formula>{[](const Recording& r) { return log(r.x[0]); },
                                               [](const Recording& r) { return 1.0 / log(r.x[0]); },
                                               [](const Recording& r) { return exp(2.0 * log(r.x[0])); },
                                               [](const Recording& r) { return tanh(log10(r.x[0])); }}) {
    Trial trial(f, {0.0});
    EXPECT_FALSE(trial.evaluate(0));
  }
}

// Sums of products c s^a u, s and u linear functions that vanish at the point, plus a smooth function with gradient g.
TEST(DomainBoundary, RandomProductsAddNothing) {
  constexpr int n = 4;
  for (std::uint64_t number = 0; number < 200; ++number) {
    RandomNumbers random(3100 + number);
    std::vector<double> x0(n), g(n);
    for (int j = 0; j < n; ++j) x0[index(j)] = random.integer(-3, 3), g[index(j)] = random.uniform(-1.0, 1.0);
    const Formula f = [&](const Recording& r) {
      const auto vanishing = [&] {
        Term sum = 0.0 * r.x[0];
        for (int j = 0; j < n; ++j) sum = sum + random.integer(1, 3) * (r.x[j] - x0[index(j)]);
        return sum;
      };
      Term sum = 0.0 * r.x[0];
      for (int j = 0; j < n; ++j) sum = sum + g[index(j)] * r.x[j];
      for (int k = random.integer(1, 4); k > 0; --k) {
        const Term s = vanishing(), u = vanishing();
        const Term base = random.integer(0, 1) == 0 ? s * s : random.integer(0, 1) == 0 ? abs(s) : s;
        sum = sum + random.uniform(-2.0, 2.0) * pow(base, random.integer(2, 9) / 10.0) * u;
      }
      return sum;
    };
    Trial trial(f, x0);
    ASSERT_TRUE(trial.evaluate(0)) << number << ": " << trial.evaluator.failure().message;
    for (int j = 0; j < n; ++j) EXPECT_EQ(trial.F_x[index(j)], g[index(j)]) << number;
  }
}

}  // namespace sfdae::core::domain_boundary
