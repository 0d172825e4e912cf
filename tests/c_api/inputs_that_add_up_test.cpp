// SPDX-License-Identifier: BSD-3-Clause
//
// Tests of inputs that change hundreds of times in a run, each time so little that no step needs to notice it: what
// steps pass over must not add up. SFDAE_TEST_SCALE scales the number of random problems.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "family_run.h"
#include "random_family.h"
#include "solver_options.h"

namespace inputs_that_add_up {
namespace {

using sfdae::ConstExpressions;
using sfdae::Expression;
using sfdae::Expressions;
using sfdae_test::RandomNumbers;

constexpr double pi = 3.14159265358979323846;

enum class Law { pulses, saw, square_of_sine, exponential, corners, clipped, peaks, count };

// A function of phase = periods t + shift.
struct Input {
  Law law;
  double periods, shift, shape, height;
};

Input random_input(RandomNumbers& random) {
  Input input{};
  input.law = static_cast<Law>(random.integer(0, static_cast<int>(Law::count) - 1));
  input.periods = std::pow(10.0, random.uniform(2.0, 3.5));
  input.shift = random.uniform(0.0, 1.0);
  input.shape = random.uniform(0.1, 0.9);
  input.height = random.uniform(0.3, 3.0);
  return input;
}

double maximum(double a, double b) { return std::fmax(a, b); }
Expression maximum(const Expression& a, double b) { return max(a, Expression(b)); }
double size(double a) { return std::fabs(a); }
Expression size(const Expression& a) { return abs(a); }

// Number: double or Expression.
template <class Number>
Number value(const Input& input, const Number& phase) {
  using std::exp, std::floor, std::sin;
  const Number sine = sin(2.0 * pi * phase);
  switch (input.law) {
    case Law::pulses: return 1.0 + floor(phase) - floor(phase + (1.0 - input.shape));
    case Law::saw: return phase - floor(phase);
    case Law::square_of_sine: return sine * sine;
    case Law::exponential: return exp(3.0 * input.shape * sine);
    case Law::corners: return size(sine);
    case Law::clipped: return maximum(sine - input.shape, 0.0);
    default: return exp(-(sine * sine) / (0.04 + 0.2 * input.shape));
  }
}

// Returns the integral of height u(t) exp(-rate (1 - t)) over 0 ... 1, by Gauss's rule with three points between kinks.
double response(const Input& input, double rate) {
  constexpr int parts = 12;
  const double corner = std::asin(input.shape) / (2.0 * pi);
  std::vector<double> ends = {0.0, corner, 0.5 - corner, 0.25, 0.5, 0.75, input.shape, 1.0};
  std::sort(ends.begin(), ends.end());
  double sum = 0.0;
  for (double first = std::floor(input.shift); first < input.shift + input.periods; first += 1.0)
    for (std::size_t k = 1; k < ends.size(); ++k) {
      const double from = std::fmax(first + ends[k - 1], input.shift);
      const double width = (std::fmin(first + ends[k], input.shift + input.periods) - from) / parts;
      for (int part = 0; width > 0.0 && part < parts; ++part)
        for (const double node : {-std::sqrt(0.6), 0.0, std::sqrt(0.6)}) {
          const double phase = from + (part + 0.5 + 0.5 * node) * width, weight = node == 0.0 ? 8.0 : 5.0;
          const double t = (phase - input.shift) / input.periods;
          sum += weight / 18.0 * width * value(input, phase) * std::exp(-rate * (1.0 - t));
        }
    }
  return input.height * sum / input.periods;
}

// x' = height u - rate x; or with the input, or x' itself, as an unknown.
enum class Form { explicit_equation, input_unknown, slope_unknown, count };

struct Case {
  Input input;
  Form form;
  double rate, tolerance;
  int method;
};

double solve(const Case& of) {
  const int n = of.form == Form::explicit_equation ? 1 : 2;
  sfdae::NonlinearProblem problem(n, n);
  problem.equations = [&of](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    const Expression u = of.input.height * value(of.input, of.input.periods * t + of.input.shift);
    switch (of.form) {
      case Form::explicit_equation: F[0] = xdot[0] + of.rate * x[0] - u; break;
      case Form::input_unknown:
        F[0] = xdot[0] + of.rate * x[0] - x[1];
        F[1] = x[1] - u;
        break;
      default: F[0] = xdot[0] - x[1]; F[1] = x[1] + of.rate * x[0] - u;
    }
  };
  sfdae::Options options = sfdae_test::solver_options(of.tolerance, of.method);
  options.max_steps = 10000000;
  sfdae::Solver solver(problem, options);
  sfdae::Point point{0.0, std::vector<double>(static_cast<std::size_t>(n), 0.0), {}};
  solver.start(point, 1.0);
  solver.advance(1.0, point);
  return point.x[0];
}

TEST(InputsThatAddUp, AreNotPassedOver) {
  constexpr double enough = 50.0;  // tolerances
  RandomNumbers random(36008);
  const int count = sfdae_test::scaled_count(200, 24);
  for (int i = 0; i < count; ++i) {
    Case of{random_input(random), static_cast<Form>(random.integer(0, 2)), random.uniform(0.0, 2.0),
            std::pow(10.0, -random.integer(3, 5)), random.integer(0, 1)};
    const double exact = response(of.input, of.rate), x = solve(of);
    EXPECT_LE(std::fabs(x - exact), enough * of.tolerance * (1.0 + std::fabs(exact)))
        << "run " << i << ": law " << static_cast<int>(of.input.law) << ", " << of.input.periods << " periods, form "
        << static_cast<int>(of.form) << ", tolerance " << of.tolerance << ", method " << of.method << ": " << x
        << " for " << exact;
  }
}

// ---- Inputs that are differentiated, or nearly constant ----------------------------------------------------------

double end_of(int n, const sfdae::EquationsFunction& equations, std::vector<double> start, double end,
              const sfdae::Options& options) {
  sfdae::NonlinearProblem problem(n, n);
  problem.equations = equations;
  sfdae::Solver solver(problem, options);
  sfdae::Point point{0.0, std::move(start), {}};
  solver.start(point, end);
  solver.advance(end, point);
  return point.x.back();
}

// x0 = u, x1 = x0', x2' = g x1^2 with peaks u = c exp(k (cos(omega t) - 1)): u' is large beside the peaks and zero at
// them. Over a period the mean of sin^2 exp(2 k (cos - 1)) is exp(-2 k) I_1(2 k) / (2 k).
TEST(InputsThatAddUp, AreNotPassedOverWhereTheirDerivativesCount) {
  constexpr double omega = 2.0 * pi * 1000.0, k = 30.0, g = 100.0, end = 0.3;
  const double c = 1.0 / (omega * std::sqrt(k) * 0.6);
  double mean = 0.0;
  constexpr int nodes = 4000;  // of the trapezoidal rule, which is exact to rounding for periodic functions
  for (int i = 0; i < nodes; ++i) {
    const double angle = 2.0 * pi * i / nodes;
    mean += std::sin(angle) * std::sin(angle) * std::exp(2.0 * k * (std::cos(angle) - 1.0)) / nodes;
  }
  const double exact = g * std::pow(c * k * omega, 2) * mean * end;
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (const double tolerance : {1e-4, 1e-6}) {
      sfdae::Options options = sfdae_test::solver_options(tolerance, method);
      options.max_steps = 1000000;
      const auto equations = [&](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
        F[0] = xdot[0] - x[1];
        F[1] = x[0] - c * exp(k * (cos(omega * t) - 1.0));
        F[2] = xdot[2] - g * x[1] * x[1];
      };
      const double x = end_of(3, equations, {c, 0.0, 0.0}, end, options);
      EXPECT_NEAR(x, exact, 50.0 * tolerance * (1.0 + exact)) << method << ", " << tolerance;
    }
}

// Near their ends these consist of rounding errors, which are no changes of an input.
TEST(InputsThatAddUp, AreNotRoundingErrors) {
  using Input = Expression (*)(const Expression&);
  const std::vector<Input> inputs = {[](const Expression& t) -> Expression { return 1.0 + tanh(100.0 * (t - 0.8)); },
                                     [](const Expression& t) -> Expression { return 1.0 - tanh(50.0 * t); },
                                     [](const Expression& t) -> Expression { return 1.0 - cos(1e-6 * t); },
                                     [](const Expression& t) -> Expression { return 1.0 - sqrt(1.0 - 1e-14 * t); }};
  const std::vector<double> exact = {1.0 + std::log(std::cosh(20.0) / std::cosh(80.0)) / 100.0,
                                     1.0 - std::log(std::cosh(50.0)) / 50.0, 0.0, 0.0};
  for (std::size_t i = 0; i < inputs.size(); ++i)
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
      for (const double tolerance : {1e-3, 1e-6}) {
        sfdae::Options options = sfdae_test::solver_options(tolerance, method);
        options.max_steps = 500;
        const auto equations = [&](const Expression& t, ConstExpressions, ConstExpressions xdot, Expressions F) {
          F[0] = xdot[0] - inputs[i](t);
        };
        EXPECT_NEAR(end_of(1, equations, {0.0}, 1.0, options), exact[i], 20.0 * tolerance) << i << ", " << method;
      }
}

}  // namespace
}  // namespace inputs_that_add_up
