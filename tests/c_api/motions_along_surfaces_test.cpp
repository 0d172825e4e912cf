// SPDX-License-Identifier: BSD-3-Clause
//
// Tests of motions along surfaces at which conditions switch: surfaces that move, change their slopes, meet, or are
// left and passed later; laws that use one condition several times.
// SFDAE_TEST_SCALE scales the number of random problems.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "family_run.h"
#include "motion_in_pieces.h"
#include "random_family.h"
#include "solver_options.h"

namespace motions_along_surfaces {
namespace {

using sfdae::ConstExpressions;
using sfdae::Expression;
using sfdae::Expressions;
using sfdae_test::RandomNumbers;
using Vector = std::vector<double>;

sfdae::Options with(int method, double tolerance) { return sfdae_test::solver_options(tolerance, method); }

using Equations = std::function<void(const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F)>;

// Returns x at the end; throws sfdae::Error.
Vector end_of(const Equations& equations, Vector start, double end, const sfdae::Options& options) {
  const int n = static_cast<int>(start.size());
  sfdae::NonlinearProblem problem(n, n);
  problem.equations = equations;
  sfdae::Solver solver(problem, options);
  sfdae::Point point{0.0, std::move(start), {}};
  solver.start(point, end);
  solver.advance(end, point);
  return point.x;
}

// ---- Two relays -----------------------------------------------------------------------------------------------

// x_i' = a_i sin(omega_i t + phase_i) - r_i x_i - k_i sign(s_i), s_1 = x_1 - m sin(nu t), s_2 = x_2 - c x_1.
struct TwoRelays {
  std::array<double, 2> a, omega, phase, r, k, start;
  double m, nu, c;
};

TwoRelays random_relays(RandomNumbers& random) {
  TwoRelays relays{};
  for (std::size_t i = 0; i < 2; ++i) {
    relays.a[i] = random.uniform(0.2, 2.0);
    relays.omega[i] = random.uniform(0.5, 3.0);
    relays.phase[i] = random.uniform(0.0, 6.0);
    relays.r[i] = random.uniform(0.0, 0.5);
    relays.k[i] = random.uniform(0.5, 2.0);
    relays.start[i] = random.uniform(-0.5, 0.5);
  }
  relays.m = random.uniform(0.0, 0.5);
  relays.nu = random.uniform(0.5, 2.0);
  relays.c = random.uniform(-0.6, 0.6);
  return relays;
}

Equations equations_of(const TwoRelays& of) {
  return [of](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    const std::array<Expression, 2> s = {x[0] - of.m * sin(of.nu * t), x[1] - of.c * x[0]};
    for (int i = 0; i < 2; ++i) {
      const auto k = static_cast<std::size_t>(i);
      F[i] = xdot[i] - of.a[k] * sin(of.omega[k] * t + of.phase[k]) + of.r[k] * x[i] + of.k[k] * sign(s[k]);
    }
  };
}

// Modes of both relays: 1, -1, or 0 on the surface.
class Modes {
 public:
  explicit Modes(const TwoRelays& of) : of_(of) {
    const Vector x(of.start.begin(), of.start.end());
    for (std::size_t i = 0; i < parts(); ++i) modes_[i] = s(i, 0.0, x) > 0.0 ? 1 : -1;
  }
  static std::size_t parts() { return 2; }
  Vector slopes(double t, const Vector& x) const { return {slope(0, t, x), slope(1, t, x)}; }
  bool is_over(std::size_t i, double t, const Vector& x) const {
    return modes_[i] == 0 ? std::fabs(needed(i, t, x)) > 1.0 : modes_[i] * s(i, t, x) < 0.0;
  }
  void change(std::size_t i, double t, Vector& x) {
    if (modes_[i] != 0) x[i] -= s(i, t, x);
    const double value = needed(i, t, x);
    modes_[i] = std::fabs(value) <= 1.0 ? 0 : value > 0.0 ? 1 : -1;
  }

 private:
  double s(std::size_t i, double t, const Vector& x) const {
    return i == 0 ? x[0] - of_.m * std::sin(of_.nu * t) : x[1] - of_.c * x[0];
  }
  double drift(std::size_t i, double t, const Vector& x) const {
    return of_.a[i] * std::sin(of_.omega[i] * t + of_.phase[i]) - of_.r[i] * x[i];
  }
  double speed_of_surface(std::size_t i, double t, const Vector& x) const {
    return i == 0 ? of_.m * of_.nu * std::cos(of_.nu * t) : of_.c * slope(0, t, x);
  }
  // Returns what the relay has to give for the motion along its surface.
  double needed(std::size_t i, double t, const Vector& x) const {
    return (drift(i, t, x) - speed_of_surface(i, t, x)) / of_.k[i];
  }
  double slope(std::size_t i, double t, const Vector& x) const {
    return modes_[i] == 0 ? speed_of_surface(i, t, x) : drift(i, t, x) - of_.k[i] * modes_[i];
  }

  const TwoRelays& of_;
  std::array<int, 2> modes_{};
};

// One may slide while the other one comes to its surface, or leaves it. None is wrong, and at most 2 % end by name.
TEST(MotionsAlongSurfaces, OfTwoRelays) {
  const int count = sfdae_test::scaled_count(200, 20);
  std::vector<std::string> named;
  for (int seed = 0; seed < count; ++seed) {
    SCOPED_TRACE("relays " + std::to_string(seed));
    RandomNumbers random(9100 + static_cast<std::uint64_t>(seed));
    const TwoRelays relays = random_relays(random);
    Modes modes(relays);
    const Vector start(relays.start.begin(), relays.start.end());
    const Vector exact = sfdae_test::move_in_pieces(modes, start, 5.0);
    const double tolerance = std::pow(10.0, -random.uniform(4.0, 7.0));
    for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      try {
        const Vector x = end_of(equations_of(relays), start, 5.0, with(method, tolerance));
        for (std::size_t i = 0; i < 2; ++i)
          EXPECT_NEAR(x[i], exact[i], 100.0 * tolerance * (1.0 + std::fabs(exact[i])))
              << "method " << method << ", tolerance " << tolerance;
      } catch (const sfdae::Error& error) {
        named.push_back("relays " + std::to_string(seed) + ": " + error.what());
      }
    }
  }
  EXPECT_LE(named.size(), static_cast<std::size_t>(count / 25)) << named.front();
}

// ---- Laws that use a surface in several ways ------------------------------------------------------------------

// x_0' = 1/2 - sign(x_0): x_0 stays at 0, with 3/4 of the branch above. x_1' is the law, x_2' = 1.
struct Law {
  const char* text;
  std::function<Expression(const Expression& t, ConstExpressions x)> of;
  double end;  // x_1 at t = 4
};

std::vector<Law> laws() {
  using T = const Expression&;
  using X = ConstExpressions;
  return {
      // Other functions with the same zeros.
      {"2 x > 0", [](T, X x) { return choose(2.0 * x[0] > 0.0, 1.0, 0.0); }, 3.0},
      {"x < 0", [](T, X x) { return choose(x[0] < 0.0, 1.0, 0.0); }, 1.0},
      {"x^3 > 0", [](T, X x) { return choose(x[0] * x[0] * x[0] > 0.0, 1.0, 0.0); }, 3.0},
      {"exp(x) > 1", [](T, X x) { return choose(exp(x[0]) > 1.0, 1.0, 0.0); }, 3.0},
      {"(1 + 0.8 sin t) x > 0", [](T t, X x) { return choose((1.0 + 0.8 * sin(t)) * x[0] > 0.0, 1.0, 0.0); }, 3.0},
      {"x exp(14 tanh(100 (t - 2))) > 0",
       [](T t, X x) { return choose(x[0] * exp(14.0 * tanh(100.0 * (t - 2.0))) > 0.0, 1.0, 0.0); }, 3.0},
      {"x / (1 + y^2) > 0", [](T, X x) { return choose(x[0] / (1.0 + x[2] * x[2]) > 0.0, 1.0, 0.0); }, 3.0},
      {"max(x, 0) > 0", [](T, X x) { return choose(max(x[0], 0.0) > 0.0, 1.0, 0.0); }, 3.0},
      // Convex combinations of what equations are on both sides.
      {"sign(x)^2", [](T, X x) { return sign(x[0]) * sign(x[0]); }, 4.0},
      {"sign(x) > 1/2", [](T, X x) { return choose(sign(x[0]) > 0.5, 1.0, 0.0); }, 3.0},
      {"exp(sign(x))", [](T, X x) { return exp(sign(x[0])); }, 3.0 * std::exp(1.0) + std::exp(-1.0)},
      {"max(sign(x), sign(-x))", [](T, X x) { return max(sign(x[0]), sign(-x[0])); }, 4.0},
      {"a product", [](T, X x) { return choose(x[0] > 0.0, 2.0, 0.5) * choose(x[0] > 0.0, 3.0, 4.0); }, 20.0},
  };
}

TEST(MotionsAlongSurfaces, UseOneSurfaceInManyWays) {
  for (const Law& law : laws())
    for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
      for (double tolerance : {1e-4, 1e-7}) {
        const Equations equations = [&law](const Expression& t, ConstExpressions x, ConstExpressions xdot,
                                           Expressions F) {
          F[0] = xdot[0] - 0.5 + sign(x[0]);
          F[1] = xdot[1] - law.of(t, x);
          F[2] = xdot[2] - 1.0;
        };
        const Vector x = end_of(equations, {0.0, 0.0, 0.0}, 4.0, with(method, tolerance));
        EXPECT_NEAR(x[0], 0.0, tolerance) << law.text;
        EXPECT_NEAR(x[1], law.end, 100.0 * tolerance) << law.text << ", method " << method;
      }
}

// Conditions that are zero on the surface, but on sides that change, or from t = 1 on alone: what they do is not known
// to the tolerances, and they end by name.
TEST(MotionsAlongSurfaces, AreNamedWhereConditionsCannotBeToldApart) {
  const std::vector<std::function<Expression(ConstExpressions)>> others = {
      [](ConstExpressions x) { return x[0] * (x[2] - 2.0) > 0.0; },
      [](ConstExpressions x) { return x[0] * (x[2] - 1.0) * (x[2] - 3.0) > 0.0; },
      [](ConstExpressions x) { return x[0] * sin(3.0 * x[2]) > 0.0; },
      [](ConstExpressions x) { return min(x[0], x[2] - 1.0) > 0.0; },
      [](ConstExpressions x) { return choose(x[2] > 1.0, x[0], -1.0) > 0.0; },
  };
  for (std::size_t k = 0; k < others.size(); ++k)
    for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
      for (double tolerance : {1e-4, 1e-8}) {
        const Equations equations = [&](const Expression&, ConstExpressions x, ConstExpressions xdot, Expressions F) {
          F[0] = xdot[0] - 0.5 + sign(x[0]);
          F[1] = xdot[1] - choose(others[k](x), 1.0, 0.0);
          F[2] = xdot[2] - 1.0;
        };
        EXPECT_THROW(end_of(equations, {0.0, 0.0, 0.0}, 4.0, with(method, tolerance)), sfdae::Error)
            << "law " << k << ", method " << method << ", tolerance " << tolerance;
      }
}

// x_1 falls from 1/2 to 1/5 until t = 2/5, and stays there, with 1/2 of both branches: x_0 does not move any more.
TEST(MotionsAlongSurfaces, HaveThresholds) {
  const Equations equations = [](const Expression&, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] - sign(x[1] - 0.2);
    F[1] = xdot[1] - 0.25 + choose(x[1] - 0.2 > 0.0, 1.0, -0.5);
  };
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (double tolerance : {1e-4, 1e-6, 1e-8, 1e-9})
      EXPECT_NEAR(end_of(equations, {0.0, 0.5}, 4.0, with(method, tolerance))[0], 0.4, 100.0 * tolerance)
          << "method " << method << ", tolerance " << tolerance;
}

// x_0 = 0 and x_1 = 0, with 7/8 and 5/8 of the branches above: max(sign(x_0), sign(x_1)) is -1 in 3/64 of the cases.
TEST(MotionsAlongSurfaces, MeetInLawsOfBoth) {
  const Equations equations = [](const Expression&, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] - 0.75 + sign(x[0]);
    F[1] = xdot[1] - 0.25 + sign(x[1]);
    F[2] = xdot[2] - max(sign(x[0]), sign(x[1]));
  };
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (double tolerance : {1e-4, 1e-7})
      EXPECT_NEAR(end_of(equations, {0.0, 0.0, 0.0}, 2.0, with(method, tolerance))[2], 2.0 * (1.0 - 6.0 / 64.0),
                  100.0 * tolerance);
}

// Slopes of the surface, or the size of x, change by 1e9 while x moves along it.
TEST(MotionsAlongSurfaces, WhoseSlopesChange) {
  const Equations flatter = [](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] - 0.5 + choose(exp(-5.0 * t) * x[0] > 0.0, 1.0, -1.0);
  };
  const Equations smaller = [](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    const Expression belt = 1e4 * exp(-5.0 * t);
    F[0] = xdot[0] + 2.0 * x[0] - 0.5 + sign(x[0] - belt) * (5.0 * belt + 2.0);
  };
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (double tolerance : {1e-4, 1e-7}) {
      EXPECT_NEAR(end_of(flatter, {0.3}, 4.0, with(method, tolerance))[0], 0.0, 10.0 * tolerance);
      EXPECT_NEAR(end_of(smaller, {1e4}, 4.0, with(method, tolerance))[0], 1e4 * std::exp(-20.0), 10.0 * tolerance);
    }
}

// x' = 2 p sin t - sign(x), p = 1, from rest: it leaves 0 at t = pi / 6, and passes it later without a stop.
TEST(MotionsAlongSurfaces, HaveSensitivitiesWhereSurfacesArePassedLater) {
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (double tolerance : {1e-4, 1e-6, 1e-8}) {
      sfdae::NonlinearProblem problem(1, 1);
      problem.equations = [](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
        F[0] = xdot[0] - parameter(t, "p", 1.0) * 2.0 * sin(t) + sign(x[0]);
      };
      sfdae::Solver solver(problem, with(method, tolerance));
      sfdae::Sensitivities wanted;
      wanted.parameters = {"p"};
      solver.set_sensitivities(wanted);
      sfdae::Point point{0.0, {0.0}, {}};
      solver.start(point, 4.9);
      solver.advance(4.9, point);
      // Until t1, where x comes back to 0: x = 2 (cos t0 - cos t) - (t - t0), and afterwards x' = 2 p sin t + 1.
      const double t0 = std::asin(0.5);
      double low = 2.0, high = 4.9;
      for (int k = 0; k < 60; ++k) {
        const double t = 0.5 * (low + high);
        (2.0 * (std::cos(t0) - std::cos(t)) - (t - t0) > 0.0 ? low : high) = t;
      }
      const double before = 2.0 * (std::cos(t0) - std::cos(low)), slope = 2.0 * std::sin(low);
      const double S = before * (slope + 1.0) / (slope - 1.0) + 2.0 * (std::cos(low) - std::cos(4.9));
      EXPECT_NEAR(solver.sensitivities(4.9).S(0, 0), S, 1e-2 * std::sqrt(tolerance / 1e-4))
          << "method " << method << ", tolerance " << tolerance;
    }
}

}  // namespace
}  // namespace motions_along_surfaces
