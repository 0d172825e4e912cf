// SPDX-License-Identifier: BSD-3-Clause
//
// Tests of functions that return residuals alone, without Jacobians, patterns or total derivatives: problems of index
// 0 and 1 in any units are solved as the same recorded equations are. SFDAE_TEST_SCALE scales the number of random
// problems.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "family_run.h"
#include "random_family.h"
#include "solver_options.h"

namespace residuals_alone {
namespace {

using sfdae::ConstExpressions;
using sfdae::Expression;
using sfdae::Expressions;
using sfdae_test::RandomNumbers;
using Vector = std::vector<double>;
using Residual = std::function<void(double t, const double* x, const double* xdot, double* F)>;

sfdae::NonlinearProblem problem_of(int n, const Residual& residual) {
  sfdae::NonlinearProblem problem(n, n);
  problem.matrices = SFDAE_MATRICES_DIFFERENCES;
  problem.total_derivative = [residual, n](double t, int order, sfdae::ConstMatrixRef of,
                                           sfdae::TotalDerivatives to) {
    if (order > 0) return SFDAE_ORDER_NOT_AVAILABLE;
    Vector F(static_cast<std::size_t>(n));
    residual(t, &of(0, 0), &of(0, 1), F.data());
    for (int i = 0; i < n; ++i) to.F[i] = F[static_cast<std::size_t>(i)];
    EXPECT_FALSE(to.F_x);
    return 0;
  };
  return problem;
}

Vector end_of(const sfdae::NonlinearProblem& problem, Vector guess, double end, const sfdae::Options& options) {
  sfdae::Solver solver(problem, options);
  sfdae::Point point{0.0, std::move(guess), {}};
  solver.start(point, end);
  solver.advance(end, point);
  return point.x;
}

// ---- Known problems ---------------------------------------------------------------------------------------------

constexpr int both_methods[] = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU};

TEST(ResidualsAlone, OfZeroGuessesAreEnough) {
  const Residual decay = [](double, const double* x, const double* xdot, double* F) {
    F[0] = xdot[0] + x[0];
    F[1] = x[0] + x[1] - 1.0;
  };
  for (const int method : both_methods) {
    const Vector x = end_of(problem_of(2, decay), {1.0, 0.0}, 1.0, sfdae_test::solver_options(1e-7, method));
    EXPECT_NEAR(x[0], std::exp(-1.0), 1e-5);
    EXPECT_NEAR(x[1], 1.0 - std::exp(-1.0), 1e-5);
  }
}

// H. H. Robertson's reactions; values at t = 40 from the test set of initial value problems.
TEST(ResidualsAlone, SolveRobertsonsReactions) {
  const Residual reactions = [](double, const double* y, const double* ydot, double* F) {
    F[0] = ydot[0] + 0.04 * y[0] - 1e4 * y[1] * y[2];
    F[1] = ydot[1] - 0.04 * y[0] + 1e4 * y[1] * y[2] + 3e7 * y[1] * y[1];
    F[2] = y[0] + y[1] + y[2] - 1.0;
  };
  for (const int method : both_methods)
    for (const double tolerance : {1e-4, 1e-6, 1e-7}) {
      sfdae::Options options = sfdae_test::solver_options(tolerance, method);
      options.atol = 1e-4 * tolerance;
      const Vector y = end_of(problem_of(3, reactions), {1.0, 0.0, 0.0}, 40.0, options);
      EXPECT_NEAR(y[0], 0.7158270688, 20.0 * tolerance);
      EXPECT_NEAR(y[1], 9.185534765e-6, 20.0 * tolerance * 1e-5);
    }
}

// A charge of some nanocoulombs that is guessed as 0: increments as for 1 C would overflow.
TEST(ResidualsAlone, AreNotEvaluatedFarFromSmallUnknowns) {
  const Residual junction = [](double t, const double* x, const double* xdot, double* F) {
    F[0] = xdot[0] - x[1];
    F[1] = x[0] / 1e-9 + 1e6 * x[1] + std::exp(x[0] / 1e-9) - 1.0 - std::sin(t);
  };
  Vector ends[2];
  for (const int method : both_methods) {
    sfdae::Options options = sfdae_test::solver_options(1e-6, method);
    options.atol = 1e-15;
    ends[method] = end_of(problem_of(2, junction), {0.0, 0.0}, 1.0, options);
  }
  EXPECT_NEAR(ends[0][0], 3.79580321e-10, 1e-14);
  EXPECT_NEAR(ends[1][0], 3.79580321e-10, 1e-14);
}

// Explicit equations however stiff they are: F_x' is the unit matrix, and small beside F_x.
TEST(ResidualsAlone, MayBeStiff) {
  for (const double k : {1e3, 1e6, 1e9, 1e12}) {
    const Residual reactions = [k](double, const double* x, const double* xdot, double* F) {
      F[0] = xdot[0] + k * (x[0] * x[0] - x[1]);
      F[1] = xdot[1] - k * (x[0] * x[0] - x[1]);
      F[2] = xdot[2] + x[2];
    };
    const Vector x = end_of(problem_of(3, reactions), {1.0, 0.0, 1.0}, 1.0, sfdae_test::solver_options(1e-6, 0));
    EXPECT_NEAR(x[0], 0.5 * (std::sqrt(5.0) - 1.0), 1e-3 / k + 2e-5) << k;
    EXPECT_NEAR(x[2], std::exp(-1.0), 2e-5) << k;
  }
}

// a' + a = b, b' + b = cos t in rows that both have a' and b', and c' + k (c - a) = 0, for each copy.
struct MixedAndStiff {
  int copies;
  double k, row_factor;

  void residual(double t, const double* x, const double* xdot, double* F) const {
    for (int i = 0; i < 3 * copies; i += 3) {
      const double* const of = x + i;
      const double* const slopes = xdot + i;
      const double first = slopes[0] + of[0] - of[1], second = slopes[1] + of[1] - std::cos(t);
      F[i] = row_factor * (first + second);
      F[i + 1] = first - second;
      F[i + 2] = slopes[2] + k * (of[2] - of[0]);
    }
  }
  Vector exact(double t) const {
    const double b = 0.5 * (std::cos(t) + std::sin(t)), a = 0.5 * std::sin(t), q = 0.5 * k / (k + 1.0 / k);
    Vector x;
    for (int i = 0; i < copies; ++i) x.insert(x.end(), {a, b, q * std::sin(t) - q / k * std::cos(t)});
    return x;
  }
};

TEST(ResidualsAlone, MayMixDerivativesBesideStiffEquations) {
  for (const double k : {1e3, 1e6, 1e9, 1e12})
    for (const double factor : {1e-6, 1.0, 1e6})
      for (const int copies : {1, 5})
        for (const int method : both_methods) {
          const MixedAndStiff of{copies, k, factor};
          SCOPED_TRACE("k " + std::to_string(k) + ", factor " + std::to_string(factor) + ", copies " +
                       std::to_string(copies) + ", method " + std::to_string(method));
          const Residual residual = [&of](double t, const double* x, const double* xdot, double* F) {
            of.residual(t, x, xdot, F);
          };
          const Vector exact = of.exact(1.0), start = of.exact(0.0);
          const Vector x =
              end_of(problem_of(3 * copies, residual), start, 1.0, sfdae_test::solver_options(1e-6, method));
          for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(x[i], exact[i], 5e-5) << i;
        }
}

// Derivatives at the start may be as small as numbers can be, and nothing else tells how large they become.
TEST(ResidualsAlone, MayStartWithTinyDerivatives) {
  for (const double tiny : {1e-30, 1e-100, 1e-300})
    for (const double rate : {1.0, 1e6}) {
      const Residual equations = [rate](double t, const double* x, const double* xdot, double* F) {
        F[0] = xdot[0] + x[0] - std::sin(t);
        F[1] = xdot[1] + rate * (x[1] - x[0]);
      };
      for (const int method : both_methods) {
        const Vector x =
            end_of(problem_of(2, equations), {tiny, -tiny}, 2.0, sfdae_test::solver_options(1e-6, method));
        EXPECT_NEAR(x[0], 0.5 * (std::exp(-2.0) + std::sin(2.0) - std::cos(2.0)), 2e-5) << tiny;
      }
    }
}

// a x' = slope(y), y = b x: unknowns in units that differ by many powers of ten. Ranks must not depend on them.
TEST(ResidualsAlone, MayHaveUnknownsInAnyUnits) {
  struct Element {
    const char* name;
    double a, b;  // x' = (1 - y / full) / a, y = b x
    double full;
  };
  const Element elements[] = {{"1 nF at 1 kOhm", 1e3, 1e9, 1.0},
                              {"1 pF at 1 Ohm", 1.0, 1e12, 1.0},
                              {"10 nF at 1 MOhm", 1e6, 1e8, 1.0},
                              {"steel", 2e11 / 1e8, 2e11, 1e8},
                              {"gas", 287.0 * 300.0 / 0.3, 287.0 * 300.0 / 1e-6, 3e5},
                              {"nM", 1e9, 1e9, 1.0}};
  for (const Element& of : elements)
    for (const int method : both_methods) {
      SCOPED_TRACE(of.name + std::string(", method ") + std::to_string(method));
      const Residual residual = [of](double, const double* x, const double* xdot, double* F) {
        F[0] = xdot[0] - (1.0 - x[1] / of.full) / of.a;
        F[1] = x[0] - x[1] / of.b;
      };
      const double time = of.a * of.full / of.b;
      sfdae::Options options = sfdae_test::solver_options(1e-6, method);
      options.atol_vector = {1e-6 * of.full / of.b, 1e-6 * of.full};
      const Vector x = end_of(problem_of(2, residual), {0.0, 0.0}, 2.0 * time, options);
      EXPECT_NEAR(x[1] / of.full, 1.0 - std::exp(-2.0), 2e-5);
    }
}

// Rounding errors of terms that cancel are larger than those of F.
TEST(ResidualsAlone, MayRoundMoreThanTheirValuesSay) {
  const double big = 1e6;
  const Residual residual = [big](double t, const double* x, const double* xdot, double* F) {
    F[0] = (big + xdot[0]) - big - (std::sin(2.0 * t) - x[0]);
  };
  for (const int method : both_methods) {
    const Vector x = end_of(problem_of(1, residual), {0.0}, 3.0, sfdae_test::solver_options(1e-5, method));
    EXPECT_NEAR(x[0], -0.4200294, 1e-4);
  }
}

// x' is guessed as zero, and far smaller than any increment that one might think of: odd functions do not bend there.
TEST(ResidualsAlone, FindSizesOfDerivativesThatAreGuessedAsZero) {
  for (const double size : {1e-4, 1e-7, 1e-8, 1e-10, 1e-14})
    for (const int method : both_methods) {
      const Residual creep = [size](double, const double* x, const double* xdot, double* F) {
        F[0] = std::sinh(xdot[0] / size) + 1.5 * x[0];
      };
      SCOPED_TRACE("size " + std::to_string(std::log10(size)) + ", method " + std::to_string(method));
      sfdae::Options options = sfdae_test::solver_options(1e-6, method);
      options.atol = 1e-8;
      EXPECT_NEAR(end_of(problem_of(1, creep), {0.8}, 1.0 / size, options)[0], 0.19644734, 1e-5);
    }
  const double size = 1e-8;
  const Residual algebraic = [size](double t, const double* x, const double* xdot, double* F) {
    F[0] = xdot[0] - (0.6 * std::sin(3.0 * t) - 0.3 * std::tanh(x[0]) + 0.1 * x[1] / size);
    F[1] = std::sinh(x[1] / size) - 0.6 * std::sin(2.0 * t) * (1.0 - 0.3 * std::tanh(x[0]));
  };
  for (const int method : both_methods) {
    sfdae::Options options = sfdae_test::solver_options(1e-6, method);
    options.atol_vector = {1e-9, 1e-9 * size};
    EXPECT_NEAR(end_of(problem_of(2, algebraic), {0.0, 0.0}, 1.0, options)[0], 0.381034, 1e-5);
  }
}

// Increments as large as x' would give derivatives that are 30 percent off.
TEST(ResidualsAlone, AreNotTakenForLinearWhereTheyAreCubic) {
  const Residual cubic = [](double, const double* x, const double* xdot, double* F) {
    F[0] = xdot[0] + xdot[0] * xdot[0] * xdot[0] + x[0];
  };
  for (const int method : both_methods) {
    const Vector x = end_of(problem_of(1, cubic), {2.0}, 1.0, sfdae_test::solver_options(1e-7, method));
    // x' = -p with p + p^3 = x, and t = int (1 + 3 p^2) / p dp = log(p0 / p) + 1.5 (p0^2 - p^2).
    double p = 0.9;
    for (int k = 0; k < 50; ++k) p -= (std::log(1.0 / p) + 1.5 * (1.0 - p * p) - 1.0) / (-1.0 / p - 3.0 * p);
    EXPECT_NEAR(x[0], p + p * p * p, 1e-5);
  }
}

// Node equations with 1 pF between both nodes: E is singular, and its entries are far below currents.
TEST(ResidualsAlone, SeeSmallCapacitorsFromRest) {
  const Residual nodes = [](double t, const double* v, const double* vdot, double* F) {
    constexpr double capacitance = 1e-12, resistance = 1e3;
    const double through = capacitance * (vdot[0] - vdot[1]);
    F[0] = (std::sin(2e8 * t) - v[0]) / resistance - through;
    F[1] = through - v[1] / resistance;
  };
  for (const int method : both_methods) {
    const Vector v = end_of(problem_of(2, nodes), {0.0, 0.0}, 2e-8, sfdae_test::solver_options(1e-6, method));
    EXPECT_NEAR(v[0], -0.5919042, 1e-5);
    EXPECT_NEAR(v[1], -0.1648983, 1e-5);
  }
}

// ---- Random problems --------------------------------------------------------------------------------------------

// P (Q y' + ..., algebraic equations), y = x / units; rows have factors of their own.
struct RandomProblem {
  int n, d;
  std::vector<Vector> P, Q, A;
  Vector units, factors, frequencies;

  template <class Number>
  void residual(const Number& t, const std::vector<Number>& x, const std::vector<Number>& xdot,
                std::vector<Number>& F) const {
    using std::cos, std::sin;
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    std::vector<Number> r;
    for (int i = 0; i < n; ++i) {
      Number sum = 0.0 * t, slopes = 0.0 * t;
      for (int j = 0; j < n; ++j) {
        sum = sum + A[at(i)][at(j)] / units[at(j)] * x[at(j)];
        slopes = slopes + Q[at(i)][at(j)] / units[at(j)] * xdot[at(j)];
      }
      const Number y = x[at(i)] / units[at(i)], drive = cos(frequencies[at(i)] * t);
      r.push_back(i < d ? slopes + y + sin(sum) - drive : y + 0.3 * sin(sum) + 0.2 * y * y * y - drive);
    }
    for (int i = 0; i < n; ++i) {
      Number sum = 0.0 * t;
      for (int k = 0; k < n; ++k) sum = sum + P[at(i)][at(k)] * r[at(k)];
      F[at(i)] = factors[at(i)] * sum;
    }
  }
};

RandomProblem random_problem(RandomNumbers& random, double decades) {
  RandomProblem problem{};
  problem.n = random.integer(2, 7);
  problem.d = random.integer(1, problem.n);
  const auto matrix = [&](double diagonal, double size) {
    std::vector<Vector> result(static_cast<std::size_t>(problem.n), Vector(static_cast<std::size_t>(problem.n)));
    for (std::size_t i = 0; i < result.size(); ++i)
      for (std::size_t j = 0; j < result.size(); ++j)
        result[i][j] = (i == j ? diagonal : 0.0) + size * random.uniform(-1.0, 1.0) / problem.n;
    return result;
  };
  problem.P = matrix(1.0, 1.0);
  problem.Q = matrix(1.0, 0.8);
  problem.A = matrix(0.0, 1.0);
  for (int i = 0; i < problem.n; ++i) {
    problem.units.push_back(std::pow(10.0, decades * random.uniform(-1.0, 1.0)));
    problem.factors.push_back(std::pow(10.0, decades * random.uniform(-1.0, 1.0)));
    problem.frequencies.push_back(random.uniform(0.3, 3.0));
  }
  return problem;
}

Vector solve(const RandomProblem& of, bool is_recorded, sfdae::Options options) {
  const auto n = static_cast<std::size_t>(of.n);
  options.atol_vector.clear();
  for (const double unit : of.units) options.atol_vector.push_back(options.atol * unit);
  if (!is_recorded) {
    const Residual residual = [&of, n](double t, const double* x, const double* xdot, double* F) {
      Vector result(n);
      of.residual<double>(t, Vector(x, x + n), Vector(xdot, xdot + n), result);
      std::copy(result.begin(), result.end(), F);
    };
    return end_of(problem_of(of.n, residual), Vector(n, 0.0), 3.0, options);
  }
  sfdae::NonlinearProblem problem(of.n, of.n);
  problem.equations = [&of, n](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    std::vector<Expression> result(n, t), of_x, of_xdot;
    for (int i = 0; i < of.n; ++i) {
      of_x.push_back(x[i]);
      of_xdot.push_back(xdot[i]);
    }
    of.residual<Expression>(t, of_x, of_xdot, result);
    for (int i = 0; i < of.n; ++i) F[i] = result[static_cast<std::size_t>(i)];
  };
  return end_of(problem, Vector(n, 0.0), 3.0, options);
}

void compare_random_problems(std::uint64_t seed, int count, double decades) {
  constexpr double enough = 50.0;  // tolerances
  RandomNumbers random(seed);
  for (int k = 0; k < count; ++k) {
    const RandomProblem problem = random_problem(random, decades);
    const int method = random.integer(0, 1);
    const double tolerance = std::pow(10.0, -random.integer(3, 7));
    SCOPED_TRACE("problem " + std::to_string(k) + ", method " + std::to_string(method) + ", tolerance " +
                 std::to_string(tolerance));
    const sfdae::Options options = sfdae_test::solver_options(tolerance, method);
    try {
      sfdae::Options accurate = sfdae_test::solver_options(1e-9, SFDAE_METHOD_RADAU);
      accurate.structure = SFDAE_STRUCTURE_OFF;  // consistent values are those of the whole array, too
      const Vector exact = solve(problem, true, accurate);
      const Vector x = solve(problem, false, options);
      for (std::size_t i = 0; i < x.size(); ++i)
        EXPECT_LE(std::fabs(x[i] - exact[i]), enough * tolerance * (std::fabs(exact[i]) + problem.units[i])) << i;
    } catch (const sfdae::Error& error) {
      ADD_FAILURE() << error.what();
    }
  }
}

TEST(ResidualsAlone, OfRandomProblemsGiveWhatFormulasGive) {
  compare_random_problems(38001, sfdae_test::scaled_count(300, 30), 0.0);
}

TEST(ResidualsAlone, OfRandomProblemsInUnevenUnitsGiveWhatFormulasGive) {
  compare_random_problems(38002, sfdae_test::scaled_count(300, 30), 4.0);
}

}  // namespace
}  // namespace residuals_alone
