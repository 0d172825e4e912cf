// SPDX-License-Identifier: BSD-3-Clause
//
// Inputs with kinks in constraints that are differentiated: derivatives jump at knots, wherever outputs are.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "random.h"

namespace {

using sfdae::ConstExpressions;
using sfdae::Expression;
using sfdae::Expressions;
using Vector = std::vector<double>;

using sfdae_test::Random;

// An input of t, t shifted, t reversed, or repeated with a period.
enum class Argument { plain, scaled, reversed, periodic };

struct Input {
  Vector x, y;  // as functions of t, increasing
  int degree;
  Argument argument;
  double period;

  Expression operator()(const Expression& t) const {
    Vector places = x, values = y;
    switch (argument) {
      case Argument::scaled:
        for (double& place : places) place = 2.0 * place + 1.0;
        return sfdae::table(2.0 * t + 1.0, degree, places, values);
      case Argument::reversed:
        for (double& place : places) place = 7.3 - place;
        std::reverse(places.begin(), places.end());
        std::reverse(values.begin(), values.end());
        return sfdae::table(7.3 - t, degree, places, values);
      case Argument::periodic: return sfdae::table(modulo(t, period), degree, places, values);
      default: return sfdae::table(t, degree, places, values);
    }
  }
  double local(double t) const { return argument == Argument::periodic ? t - period * std::floor(t / period) : t; }
  double value(double t) const {
    const int count = static_cast<int>(x.size());
    return sfdae_table(sfdae_number(std::clamp(local(t), x.front(), x.back())), degree, count, x.data(), y.data())
        .value;
  }
  // Slopes of a polygon on both sides of t.
  double slope(double t, double side) const {
    const double place = local(t + side * 1e-9 * (1.0 + std::fabs(t)));
    const auto after = std::upper_bound(x.begin() + 1, x.end() - 1, place) - x.begin();
    const auto k = static_cast<std::size_t>(after);
    return (y[k] - y[k - 1]) / (x[k] - x[k - 1]);
  }
};

Input random_input(Random& random) {
  Input input{{}, {}, random.integer(0, 2) == 0 ? 2 * random.integer(1, 2) + 1 : 1, Argument::plain, 0.0};
  const int count = random.integer(input.degree + 3, 10);
  const bool is_even = input.degree > 1 || random.integer(0, 1) == 0;  // else splines swing
  double place = 0.0;
  for (int i = 0; i < count; ++i) {
    input.x.push_back(place);
    input.y.push_back(random.real(-1.0, 1.0));
    place += is_even ? 0.5 : random.real(0.1, 1.0);
  }
  input.argument = static_cast<Argument>(random.integer(0, input.degree == 1 ? 3 : 2));
  if (input.argument == Argument::periodic) {
    input.y.back() = input.y.front();
    input.period = input.x.back();
  }
  return input;
}

// u' = a q, w' = q w, p' = q, p = T(t) in turned coordinates and mixed equations, mu = 1: u = u0 + a (p - p0),
// w = w0 exp(p - p0), q = T', which jumps at the knots of a polygon.
struct Problem {
  Input input;
  double a, u0 = 0.3, w0 = 0.7, p0 = 0.0;
  Vector equations, coordinates;  // z = C x, 4 x 4

  Vector z(double t, double side) const {
    const double p = input.value(t);
    return {u0 + a * (p - p0), w0 * std::exp(p - p0), p, input.degree == 1 ? input.slope(t, side) : std::nan("")};
  }
  Vector to_z(const Vector& x) const {
    Vector z(4, 0.0);
    for (std::size_t k = 0; k < 16; ++k) z[k % 4] += coordinates[k] * x[k / 4];
    return z;
  }
  sfdae::NonlinearProblem recorded() const {
    sfdae::NonlinearProblem problem(4, 4);
    problem.equations = [*this](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
      Expression z[4] = {0.0, 0.0, 0.0, 0.0}, zdot[4] = {0.0, 0.0, 0.0, 0.0};
      for (int k = 0; k < 16; ++k) {
        z[k % 4] = z[k % 4] + coordinates[static_cast<std::size_t>(k)] * x[k / 4];
        zdot[k % 4] = zdot[k % 4] + coordinates[static_cast<std::size_t>(k)] * xdot[k / 4];
      }
      const Expression of_z[4] = {zdot[0] - a * z[3], zdot[1] - z[3] * z[1], zdot[2] - z[3], z[2] - input(t)};
      for (int i = 0; i < 4; ++i) {
        Expression sum = 0.0;
        for (int k = 0; k < 4; ++k) sum = sum + equations[static_cast<std::size_t>(i + 4 * k)] * of_z[k];
        F[i] = sum;
      }
    };
    return problem;
  }
};

// Those of the identity and a random matrix of norm below 1 / 2: condition numbers stay below 3.
Vector random_matrix(Random& random) {
  Vector matrix(16);
  for (double& entry : matrix) entry = random.real(-0.12, 0.12);
  for (std::size_t i = 0; i < 4; ++i) matrix[5 * i] += 1.0;
  return matrix;
}

Vector solve(Vector A, Vector b) {
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t i = 0; i < 4; ++i) {
      if (i == k) continue;
      const double factor = A[i + 4 * k] / A[5 * k];
      for (std::size_t j = 0; j < 4; ++j) A[i + 4 * j] -= factor * A[k + 4 * j];
      b[i] -= factor * b[k];
    }
  for (std::size_t i = 0; i < 4; ++i) b[i] /= A[5 * i];
  return b;
}

// In tolerances: what of z is farther from the solution before the knot than from that after it does not count.
double error_of(const Problem& problem, const sfdae::Point& point, double tol) {
  const Vector found = problem.to_z(point.x);
  double least = 1e300;
  for (double side : {-1.0, 1.0}) {
    const Vector z = problem.z(point.t, side);
    double error = 0.0;
    for (std::size_t i = 0; i < 4; ++i)
      if (!std::isnan(z[i])) error = std::max(error, std::fabs(found[i] - z[i]) / (tol * (1.0 + std::fabs(z[i]))));
    least = std::min(least, error);
  }
  return least;
}

// At knots, beside them and between; forward and backward, from knots and from anywhere.
TEST(Kinks, InDifferentiatedConstraintsAreNotSmearedOut) {
  int checked = 0;
  for (unsigned seed = 0; seed < 150; ++seed) {
    Random random(seed);
    Problem problem{random_input(random),  random.real(-2.0, 2.0), 0.3, 0.7, 0.0,
                    random_matrix(random), random_matrix(random)};
    const Vector& knots = problem.input.x;
    double ends[2] = {knots[random.integer(0, 1) == 0 ? 0 : 1], knots[knots.size() - 1]};
    if (random.integer(0, 1) == 0) ends[0] += 0.3 * (knots[2] - knots[1]);
    if (random.integer(0, 1) == 0) ends[1] -= 0.3 * (knots[2] - knots[1]);
    if (random.integer(0, 1) == 0) std::swap(ends[0], ends[1]);
    Vector outputs = {ends[1]};
    const auto add = [&](double t) {
      if ((t - ends[0]) * (t - ends[1]) < 0.0) outputs.push_back(t);
    };
    for (int i = 1; i < 12; ++i) add(ends[0] + (ends[1] - ends[0]) * i / 12.0);
    for (double knot : knots) add(knot - 1e-6), add(knot), add(knot + 1e-6);
    std::sort(outputs.begin(), outputs.end());
    if (ends[1] < ends[0]) std::reverse(outputs.begin(), outputs.end());

    sfdae::Options options;
    const int methods[] = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU, SFDAE_METHOD_AUTOMATIC};
    options.method = methods[random.integer(0, 2)];
    options.output = random.integer(0, 1) == 0 ? SFDAE_OUTPUT_CONSISTENT : SFDAE_OUTPUT_INTERPOLATED;
    const double tol = std::pow(10.0, -random.real(3.0, 8.0));
    options.rtol = options.atol = tol;
    sfdae::Solver solver(problem.recorded(), options);
    problem.p0 = problem.input.value(ends[0]);
    Vector z = problem.z(ends[0], 1.0);
    if (std::isnan(z[3])) z[3] = (problem.input.value(ends[0] + 1e-6) - problem.input.value(ends[0] - 1e-6)) / 2e-6;
    sfdae::Point point{ends[0], solve(problem.coordinates, z), {}};
    solver.start(point, ends[1]);
    ASSERT_EQ(solver.characteristics().strangeness_index, 1);
    for (double t : outputs) {
      ASSERT_EQ(solver.advance(t, point), SFDAE_OK) << "seed " << seed;
      ASSERT_EQ(point.t, t);
      // T^(p) of splines of higher degree is large between points that lie at random: so are errors.
      const double allowed = problem.input.degree == 1 ? 40.0 : 400.0;
      EXPECT_LE(error_of(problem, point, tol), allowed) << "seed " << seed << ", t = " << t;
      ++checked;
    }
  }
  EXPECT_GT(checked, 3000);
}

// The solution as recorded over the whole run, and in single steps: q is T' on both sides of every knot.
TEST(Kinks, AreInRecordedSolutionsAndSteps) {
  const Input input{{0.0, 1.0, 2.0, 3.0}, {0.0, 1.0, -1.0, 0.5}, 1, Argument::plain, 0.0};
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    sfdae::NonlinearProblem problem(3, 3);
    problem.equations = [&](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
      F[0] = xdot[0] + x[0] - x[2];
      F[1] = xdot[1] - x[2];
      F[2] = x[1] - input(t);
    };
    sfdae::Options options;
    options.method = method;
    options.rtol = options.atol = 1e-7;
    sfdae::Solver solver(problem, options);
    sfdae::Solution solution;
    solver.record(solution);
    sfdae::Point point{0.0, {0.0, 0.0, 1.0}, {}};
    solver.start(point, 3.0);
    while (solver.step(3.0, point) == SFDAE_STEP_TAKEN) {
      const bool is_at_kink = std::fabs(point.t - std::round(point.t)) < 1e-12;
      if (is_at_kink) continue;
      EXPECT_NEAR(point.x[2], input.slope(point.t, 1.0), 1e-6) << point.t;
    }
    for (int i = 0; i < 300; ++i) {
      const double t = 0.01 * i + 0.003;
      const sfdae::Point here = solution(t);
      EXPECT_NEAR(here.x[2], input.slope(t, 1.0), 1e-5) << t;
      EXPECT_NEAR(here.x[1], input.value(t), 1e-6) << t;
    }
  }
}

// q = T'(t) passes through zero at a knot: the event is there.
TEST(Kinks, MayBeEvents) {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [&](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] - x[1];
    F[1] = x[0] - sfdae::table(t, 1, {0.0, 1.0, 2.0}, {0.0, 1.0, -1.0});
  };
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    sfdae::Options options;
    options.method = method;
    sfdae::Solver solver(problem, options);
    solver.set_events(1, [](double, const auto& x, const auto&, auto g) { g[0] = x[1]; });
    sfdae::Point point{0.0, {0.0, 1.0}, {}};
    solver.start(point, 2.0);
    ASSERT_EQ(solver.advance(1.5, point), SFDAE_EVENT);
    EXPECT_NEAR(point.t, 1.0, 1e-12);
    ASSERT_EQ(solver.advance(1.5, point), SFDAE_OK);
    EXPECT_NEAR(point.x[1], -2.0, 1e-6);
  }
}

// Seconds since 1970: within the rounding errors of t, 5e-5 s here, unknowns change by many tolerances. That is no
// jump, and what is asked of a knot is the solution there.
TEST(Kinks, AreCrossedWhereTimesAreLarge) {
  const double day = 1.7e9;
  Input input{{0.0, 1.0, 2.0, 3.0, 10.0}, {0.0, 2.0, -1.0, 4.0, 4.0}, 1, Argument::plain, 0.0};
  for (double& place : input.x) place += day;
  const Vector integrals = {0.0, 1.0, 1.5, 3.0}, slopes = {2.0, -3.0, 5.0, 0.0};  // at knots, and after them
  sfdae::NonlinearProblem problem(3, 3);
  problem.equations = [&](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] - x[1];
    F[1] = x[1] - input(t);
    F[2] = xdot[1] - x[2];
  };
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (bool is_forward : {true, false}) {
      sfdae::Options options;
      options.method = method;
      sfdae::Solver solver(problem, options);
      const int first = is_forward ? 0 : 3, last = is_forward ? 3 : 0, step = is_forward ? 1 : -1;
      const auto at = [](const Vector& values, int k) { return values[static_cast<std::size_t>(k)]; };
      sfdae::Point point{at(input.x, first), {at(integrals, first), at(input.y, first), 0.0}, {}};
      solver.start(point, at(input.x, last));
      for (int k = first + step; k != last + step; k += step) {
        ASSERT_EQ(solver.advance(at(input.x, k), point), SFDAE_OK);
        EXPECT_NEAR(point.x[0], at(integrals, k), 2e-5);
        EXPECT_NEAR(point.x[1], at(input.y, k), 2e-5);
        EXPECT_NEAR(point.x[2], at(slopes, k), 1e-4);
      }
    }
}

// Conditions whose terms are equal on whole intervals: max(s, min(s, c)) is s, whatever rounding errors decide, and so
// is the larger one of two equal unknowns.
TEST(Kinks, OfEqualTermsStopNothing) {
  Random random(3917);
  for (int trial = 0; trial < 20; ++trial) {
    const double start = random.real(-1.0, 1.0), level = random.real(-1.0, 1.0), slope = random.real(-2.0, 2.0);
    const int form = trial % 5;
    sfdae::NonlinearProblem problem(3, 3);
    problem.equations = [&](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
      const Expression& s = x[0];
      const Expression c = level + slope * t;
      F[0] = xdot[0] - cos(3.0 * t);
      F[1] = xdot[1] - (form == 0   ? max(s, min(s, c))
                        : form == 1 ? min(s, max(s, c))
                        : form == 2 ? max(s, min(s, x[2]))
                        : form == 4 ? max(s, x[2])
                                    : min(max(s, c), max(s, c)) - max(c - s, 0.0));
      F[2] = xdot[2] - (form == 4 ? cos(3.0 * t) : Expression(slope));
    };
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      sfdae::Options options;
      options.method = method;
      options.max_steps = 500;
      sfdae::Solver solver(problem, options);
      sfdae::Point point{0.0, {start, 0.0, form == 4 ? start : level}, {}};
      solver.start(point, 2.0);
      ASSERT_EQ(solver.advance(2.0, point), SFDAE_OK) << "form " << form << ": " << solver.message();
      EXPECT_NEAR(point.x[1], 2.0 * start + (1.0 - std::cos(6.0)) / 9.0, 1e-4) << "form " << form;
    }
  }
}

}  // namespace
