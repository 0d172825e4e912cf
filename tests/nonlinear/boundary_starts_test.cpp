// SPDX-License-Identifier: BSD-3-Clause
// Solutions that start at the boundary of the domain of an operation, where its derivative is infinite: a tank that is
// filled from empty, air drag from rest, an isotherm at an empty bed, arcs at their ends.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "nonlinear_run.h"
#include "sfdae/sfdae.h"

namespace sfdae_test::boundary_starts {
namespace {

using Values = std::vector<double>;
// Of one copy: equations in units of its unknowns, F(t, x, x').
using Residual = std::function<void(const Expression& t, const std::vector<Expression>& x,
                                    const std::vector<Expression>& xdot, Expression* F)>;

struct Case {
  std::string name;
  Values x0;
  double end;
  Residual write;
  std::function<Values(double)> exact;
  bool needs_structure = false;  // other equations would have to be differentiated more often than they can be
};

// h' = 1 - sqrt(h), h(0) = 0: t = -2 u - 2 log(1 - u) with u = sqrt(h).
double root_of_level(double t) {
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 100; ++i) {
    const double u = 0.5 * (low + high);
    (-2.0 * u - 2.0 * std::log1p(-u) < t ? low : high) = u;
  }
  return low;
}

// y' = f(y), y(0) = 0, by the classical Runge-Kutta method.
double smooth_solution(const std::function<double(double)>& f, double t) {
  constexpr int steps = 2000;
  const double h = t / steps;
  double y = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double a = f(y), b = f(y + h / 2 * a), c = f(y + h / 2 * b), d = f(y + h * c);
    y += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return y;
}

void add_tanks(std::vector<Case>& cases) {
  const auto level = [](double t) { return root_of_level(t) * root_of_level(t); };
  cases.push_back(
      {"tank",
       {0.0},
       3.0,
       [](const auto&, const auto& x, const auto& xdot, Expression* F) { F[0] = xdot[0] - 1 + sqrt(x[0]); },
       [level](double t) { return Values{level(t)}; }});
  cases.push_back({"tank with outflow",
                   {0.0, 0.0},
                   3.0,
                   [](const auto&, const auto& x, const auto& xdot, Expression* F) {
                     F[0] = xdot[0] - 1 + x[1];
                     F[1] = x[1] - sqrt(x[0]);
                   },
                   [level](double t) {
                     return Values{level(t), root_of_level(t)};
                   }});
  cases.push_back({"tank filled later",
                   {-0.5},
                   0.4,
                   [](const auto&, const auto& x, const auto& xdot, Expression* F) {
                     F[0] = xdot[0] - 1 + sqrt(max(x[0], Expression(0.0)));
                   },
                   [](double t) { return Values{t - 0.5}; }});
  // sqrt(h) = 1 - t / 2 until the tank is empty.
  cases.push_back({"tank emptied",
                   {1.0},
                   4.0,
                   [](const auto&, const auto& x, const auto& xdot, Expression* F) {
                     F[0] = xdot[0] + sqrt(max(x[0], Expression(0.0)));
                   },
                   [](double t) { return Values{t < 2.0 ? (1 - t / 2) * (1 - t / 2) : 0.0}; }});
  // The equations do not mention negative levels, which x has within its tolerances.
  cases.push_back({"tank emptied into another one",
                   {1.0, 0.0},
                   4.0,
                   [](const auto&, const auto& x, const auto& xdot, Expression* F) {
                     F[0] = xdot[0] + sqrt(x[0]);
                     F[1] = xdot[1] - sqrt(x[0]);
                   },
                   [](double t) {
                     const double level = t < 2.0 ? (1 - t / 2) * (1 - t / 2) : 0.0;
                     return Values{level, 1.0 - level};
                   }});
  cases.push_back({"tank that stays empty",
                   {0.0},
                   2.0,
                   [](const auto&, const auto& x, const auto& xdot, Expression* F) { F[0] = xdot[0] + sqrt(x[0]); },
                   [](double) { return Values{0.0}; }});
}

void add_drags(std::vector<Case>& cases) {
  cases.push_back(
      {"drag by abs",
       {0.0},
       2.0,
       [](const auto&, const auto& x, const auto& xdot, Expression* F) { F[0] = xdot[0] - 1 + abs(x[0]) * x[0]; },
       [](double t) { return Values{std::tanh(t)}; }});
  cases.push_back({"drag by a power",
                   {0.0},
                   2.0,
                   [](const auto&, const auto& x, const auto& xdot, Expression* F) {
                     F[0] = xdot[0] - 1 + pow(x[0] * x[0], Expression(0.5)) * x[0];
                   },
                   [](double t) { return Values{std::tanh(t)}; }});
  cases.push_back({"drag in the plane",
                   {0.0, 0.0},
                   2.0,
                   [](const auto&, const auto& x, const auto& xdot, Expression* F) {
                     const Expression speed = sqrt(x[0] * x[0] + x[1] * x[1]);
                     F[0] = xdot[0] - 0.6 + speed * x[0];
                     F[1] = xdot[1] - 0.8 + speed * x[1];
                   },
                   [](double t) {
                     return Values{0.6 * std::tanh(t), 0.8 * std::tanh(t)};
                   }});
  cases.push_back(
      {"root times cube",
       {0.0},
       2.0,
       [](const auto&, const auto& x, const auto& xdot, Expression* F) {
         F[0] = xdot[0] - 1 + sqrt(abs(x[0])) * x[0] * x[0] * x[0];
       },
       [](double t) { return Values{smooth_solution([](double y) { return 1 - std::pow(y, 3.5); }, t)}; }});
}

// A pendulum that is dropped in horizontal position, with drag by its speed: p, q, u, v and the multiplier.
void add_pendulum(std::vector<Case>& cases) {
  constexpr double g = 9.81, drag = 0.3;
  const auto exact = [](double t) {
    constexpr int steps = 4000;
    const auto turn = [](double angle, double speed) {
      return g * std::cos(angle) - drag * speed * std::fabs(speed);
    };
    double angle = 0.0, speed = 0.0;
    const double h = t / steps;
    for (int i = 0; i < steps; ++i) {
      const double a1 = speed, b1 = turn(angle, speed);
      const double a2 = speed + h / 2 * b1, b2 = turn(angle + h / 2 * a1, a2);
      const double a3 = speed + h / 2 * b2, b3 = turn(angle + h / 2 * a2, a3);
      const double a4 = speed + h * b3, b4 = turn(angle + h * a3, a4);
      angle += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
      speed += h / 6 * (b1 + 2 * b2 + 2 * b3 + b4);
    }
    const double p = std::cos(angle), q = -std::sin(angle);
    return Values{p, q, q * speed, -p * speed, speed * speed - g * q};
  };
  cases.push_back({"pendulum with drag from rest",
                   {1.0, 0.0, 0.0, 0.0, 0.0},
                   0.9,
                   [](const auto&, const auto& x, const auto& xdot, Expression* F) {
                     const Expression speed = sqrt(x[2] * x[2] + x[3] * x[3]);
                     F[0] = xdot[0] - x[2];
                     F[1] = xdot[1] - x[3];
                     F[2] = xdot[2] + x[0] * x[4] + drag * speed * x[2];
                     F[3] = xdot[3] + x[1] * x[4] + drag * speed * x[3] + g;
                     F[4] = x[0] * x[0] + x[1] * x[1] - 1;
                   },
                   exact,
                   true});
}

// The value of log(0) does not count where it is multiplied by 0.
void add_entropy(std::vector<Case>& cases) {
  cases.push_back({"x log(x)",
                   {0.0, 0.0},
                   2.0,
                   [](const auto&, const auto& x, const auto& xdot, Expression* F) {
                     F[0] = xdot[0] - 1;
                     F[1] = x[1] - x[0] * log(x[0]);
                   },
                   [](double t) {
                     return Values{t, t * std::log(t)};
                   }});
}

// x = t + t^2
void add_powers(std::vector<Case>& cases) {
  for (const double a : {0.2, 0.5, 0.7, 0.9})
    cases.push_back({"power " + std::to_string(a),
                     {0.0},
                     1.0,
                     [a](const auto& t, const auto& x, const auto& xdot, Expression* F) {
                       F[0] = xdot[0] - 1 - 2 * t + pow(x[0], Expression(a)) - pow(t + t * t, Expression(a));
                     },
                     [](double t) { return Values{t + t * t}; }});
}

// x = 1 - t - t^2 / 4
void add_arcs(std::vector<Case>& cases) {
  const auto path = [](const auto& t) { return 1 - t - t * t / 4; };
  for (const double side : {1.0, -1.0})
    cases.push_back({side > 0 ? "arc sine" : "arc cosine",
                     {1.0},
                     0.8,
                     [path, side](const auto& t, const auto& x, const auto& xdot, Expression* F) {
                       F[0] = xdot[0] + 1 + t / 2;
                       if (side > 0) F[0] = F[0] - asin(x[0]) + asin(path(t));
                       else F[0] = F[0] + acos(x[0]) - acos(path(t));
                     },
                     [path](double t) { return Values{path(t)}; }});
}

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  add_tanks(cases);
  add_drags(cases);
  add_pendulum(cases);
  add_entropy(cases);
  add_powers(cases);
  add_arcs(cases);
  return cases;
}

// `copies` of them side by side, unknowns in this unit.
NonlinearEquations copies_of(const Case& one, int copies, double unit) {
  const int size = static_cast<int>(one.x0.size()), n = copies * size;
  return equations_of(n, n, [=](const Expression& t, const Expression* x, const Expression* xdot, Expression* F) {
    for (int copy = 0; copy < copies; ++copy) {
      std::vector<Expression> own_x, own_xdot;
      for (int j = copy * size; j < (copy + 1) * size; ++j) {
        own_x.push_back(x[j] / unit);
        own_xdot.push_back(xdot[j] / unit);
      }
      one.write(t, own_x, own_xdot, F + copy * size);
    }
  });
}

struct Variant {
  int copies, structure;
  double unit;
};

void expect_right(const Case& one, const Variant& variant, double tolerance, int method) {
  SCOPED_TRACE(one.name + ", unit " + std::to_string(variant.unit) + ", tolerance " + std::to_string(tolerance) +
               (method == SFDAE_METHOD_BDF ? ", BDF" : ", Radau"));
  sfdae_options options = options_with(tolerance, method);
  options.atol = tolerance * variant.unit;
  options.structure = variant.structure;
  options.max_steps = 5000;
  NonlinearRun run(copies_of(one, variant.copies, variant.unit), options);
  Values x0;
  for (int copy = 0; copy < variant.copies; ++copy)
    for (double value : one.x0) x0.push_back(value * variant.unit);
  const bool is_refused = one.needs_structure && variant.structure == SFDAE_STRUCTURE_OFF;
  ASSERT_EQ(run.start(0.0, one.end, x0), is_refused ? SFDAE_NOT_FINITE : SFDAE_OK) << run.message();
  if (is_refused) return;
  for (double part : {0.1, 0.5, 1.0}) {
    ASSERT_EQ(run.advance(part * one.end), SFDAE_OK) << run.message();
    const Values exact = one.exact(part * one.end);
    for (std::size_t j = 0; j < x0.size(); ++j) {
      const double wanted = exact[j % exact.size()], error = std::fabs(run.x[j] / variant.unit - wanted);
      EXPECT_LE(error, 30.0 * tolerance * (1.0 + std::fabs(wanted))) << "x[" << j << "] at " << part;
    }
  }
}

}  // namespace

TEST(BoundaryStarts, SolutionsStartThere) {
  for (const Case& one : all_cases())
    for (const Variant& variant :
         {Variant{1, SFDAE_STRUCTURE_AUTOMATIC, 1.0}, Variant{1, SFDAE_STRUCTURE_OFF, 1.0},
          Variant{1, SFDAE_STRUCTURE_AUTOMATIC, 1e-6}, Variant{1, SFDAE_STRUCTURE_AUTOMATIC, 1e6},
          Variant{3, SFDAE_STRUCTURE_AUTOMATIC, 1.0}})
      for (double tolerance : {1e-4, 1e-8})
        for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) expect_right(one, variant, tolerance, method);
}

// h = t^2 from sqrt(h) = t: the derivative of the root at 0 is needed, and does not exist.
TEST(BoundaryStarts, MissingCoefficientsAreNamedWithARemedy) {
  const NonlinearEquations equations =
      equations_of(2, 2, [](const Expression& t, const Expression* x, const Expression* xdot, Expression* F) {
        F[0] = xdot[0] - x[1];
        F[1] = sqrt(x[0]) - t;
      });
  NonlinearRun run(equations, options_with(1e-6));
  EXPECT_EQ(run.start(0.0, 1.0, {0.0, 0.0}), SFDAE_NOT_FINITE);
  for (const char* part : {"sqrt of 0", "equation 1", "x[0]", "sqrt(h + 1e-12)"})
    EXPECT_NE(run.message().find(part), std::string::npos) << run.message();
}

// x' = sqrt(x) - 1 leads out of the domain, and log(0) is no number.
TEST(BoundaryStarts, WhatLeavesTheDomainIsNamed) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    NonlinearRun leaving(equations_of(1, 1,
                                      [](const Expression&, const Expression* x, const Expression* xdot,
                                         Expression* F) { F[0] = xdot[0] - sqrt(x[0]) + 1; }),
                         options_with(1e-6, method));
    ASSERT_EQ(leaving.start(0.0, 1.0, {0.01}), SFDAE_OK);
    EXPECT_EQ(leaving.advance(1.0), SFDAE_NOT_FINITE);
    EXPECT_NE(leaving.message().find("sqrt of -"), std::string::npos) << leaving.message();
    EXPECT_LE(std::fabs(leaving.x[0]), 3e-6);
    NonlinearRun logarithm(
        equations_of(2, 2,
                     [](const Expression&, const Expression* x, const Expression* xdot, Expression* F) {
                       F[0] = xdot[0] - 1;
                       F[1] = x[1] - log(x[0]);
                     }),
        options_with(1e-6, method));
    EXPECT_EQ(logarithm.start(0.0, 1.0, {0.0, 0.0}), SFDAE_NOT_FINITE);
    EXPECT_NE(logarithm.message().find("log of 0"), std::string::npos) << logarithm.message();
  }
}

}  // namespace sfdae_test::boundary_starts
