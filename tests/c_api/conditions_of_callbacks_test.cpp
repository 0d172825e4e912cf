// SPDX-License-Identifier: BSD-3-Clause
//
// Tests of conditions that callbacks declare. The solutions are known: sums of responses to steps of a source, in a
// divider of two capacitors (strangeness index 1) with a charge counter, in unknowns that are mixed at random.
// SFDAE_TEST_SCALE scales the number of random problems.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "family_run.h"
#include "random_family.h"
#include "solver_options.h"

namespace conditions_of_callbacks {
namespace {

using sfdae::ConstMatrixRef;
using sfdae::ConstVectorRef;
using sfdae::MatrixRef;
using sfdae::VectorRef;
using sfdae_test::RandomNumbers;
using Vector = std::vector<double>;
using Matrix = std::vector<Vector>;  // rows

Matrix random_orthogonal(int n, RandomNumbers& random) {
  Matrix Q(static_cast<std::size_t>(n), Vector(static_cast<std::size_t>(n)));
  for (std::size_t i = 0; i < Q.size(); ++i) {
    for (double& entry : Q[i]) entry = random.uniform(-1.0, 1.0);
    for (std::size_t k = 0; k < i; ++k) {
      double product = 0.0;
      for (std::size_t j = 0; j < Q.size(); ++j) product += Q[i][j] * Q[k][j];
      for (std::size_t j = 0; j < Q.size(); ++j) Q[i][j] -= product * Q[k][j];
    }
    double square = 0.0;
    for (const double entry : Q[i]) square += entry * entry;
    for (double& entry : Q[i]) entry /= std::sqrt(square);
  }
  return Q;
}

// Source u = sum of jumps[k], where tau > times[k] and tau' = rate; z' = -(1 + extra b_0) z + u, as a resistor that is
// switched by the first condition. With the divider: i = vs' - vm', i = vm' + vm, vs = u, q' = i.
struct Problem {
  Vector times, jumps;
  double rate, extra, unit;
  bool has_divider;
  Matrix P, Q;
  int count() const { return static_cast<int>(times.size()); }
  int n() const { return has_divider ? 6 : 2; }
};

Problem random_problem(bool has_divider, RandomNumbers& random) {
  Problem problem{{},
                  {},
                  random.uniform(0.5, 2.0),
                  random.uniform(0.0, 2.0),
                  std::pow(10.0, random.uniform(-4.0, 4.0)),
                  has_divider,
                  {},
                  {}};
  for (int k = random.integer(1, 4); k > 0; --k) {
    problem.times.push_back(random.uniform(0.05, 1.9));
    problem.jumps.push_back(random.uniform(-2.0, 2.0));
  }
  problem.P = random_orthogonal(problem.n(), random);
  problem.Q = random_orthogonal(problem.n(), random);
  return problem;
}

// In unknowns y that are not mixed: tau, z, vs, vm, i, q.
void matrices(const Problem& of, bool is_met, Matrix& E, Matrix& A) {
  const Matrix zero(static_cast<std::size_t>(of.n()), Vector(static_cast<std::size_t>(of.n())));
  E = A = zero;
  E[0][0] = E[1][1] = 1.0;
  A[1][1] = is_met ? -1.0 - of.extra : -1.0;
  if (!of.has_divider) return;
  E[2][2] = 1.0, E[2][3] = -1.0, A[2][4] = 1.0;
  E[3][3] = 1.0, A[3][3] = -1.0, A[3][4] = 1.0;
  A[4][2] = -1.0;
  E[5][5] = 1.0, A[5][4] = 1.0;
}
Vector right_side(const Problem& of, const std::vector<int>& branches) {
  Vector f(static_cast<std::size_t>(of.n()));
  f[0] = of.rate;
  for (std::size_t k = 0; k < of.jumps.size(); ++k)
    if (branches[k] == 1) {
      f[1] += of.jumps[k];
      if (of.has_divider) f[4] += of.jumps[k];
    }
  return f;
}

// y at t: before the first condition z' = -z + u, then z' = -(1 + extra) z + u, from switch to switch.
Vector exact(const Problem& of, double t) {
  Vector y(static_cast<std::size_t>(of.n()));
  y[0] = of.rate * t;
  Vector switches;
  for (const double time : of.times) switches.push_back(time / of.rate);
  Vector ends = switches;
  ends.push_back(t);
  std::sort(ends.begin(), ends.end());
  double now = 0.0;
  for (const double end : ends) {
    if (end > t) break;
    double u = 0.0;
    for (std::size_t k = 0; k < switches.size(); ++k)
      if (now >= switches[k]) u += of.jumps[k];
    const double decay = now >= switches[0] ? 1.0 + of.extra : 1.0;
    y[1] = u / decay + (y[1] - u / decay) * std::exp(-decay * (end - now));
    now = end;
  }
  if (!of.has_divider) return y;
  for (std::size_t k = 0; k < switches.size(); ++k)
    if (t >= switches[k]) {
      y[2] += of.jumps[k];
      y[3] += 0.5 * of.jumps[k] * std::exp(-0.5 * (t - switches[k]));
    }
  y[4] = 0.5 * y[3];  // between switches: i = -vm' = vm / 2
  y[5] = y[2] - y[3];
  return y;
}

// x = unit Q y.
Vector mixed(const Problem& of, const Vector& y) {
  Vector x(y.size());
  for (std::size_t i = 0; i < y.size(); ++i)
    for (std::size_t j = 0; j < y.size(); ++j) x[i] += of.unit * of.Q[i][j] * y[j];
  return x;
}
double first_of_unmixed(const Problem& of, ConstVectorRef x) {
  double tau = 0.0;
  for (int i = 0; i < of.n(); ++i) tau += of.Q[static_cast<std::size_t>(i)][0] * x[i];
  return tau / of.unit;
}

// P M Q^T of a matrix in y.
void write_mixed(const Problem& of, const Matrix& M, MatrixRef to) {
  const int n = of.n();
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k)
        for (int l = 0; l < n; ++l) to(i, j) += of.P[at(i)][at(k)] * M[at(k)][at(l)] * of.Q[at(j)][at(l)];
}
void write_mixed(const Problem& of, const Vector& f, VectorRef to) {
  for (int i = 0; i < of.n(); ++i)
    for (std::size_t k = 0; k < f.size(); ++k) to[i] += of.unit * of.P[static_cast<std::size_t>(i)][k] * f[k];
}

sfdae::Conditions conditions_of(const Problem& of, std::vector<int>& branches) {
  const auto functions = [&of](double, ConstVectorRef x, ConstVectorRef, VectorRef g) {
    for (int k = 0; k < of.count(); ++k) g[k] = first_of_unmixed(of, x) - of.times[static_cast<std::size_t>(k)];
  };
  return {of.count(), functions, &branches};
}

sfdae::LinearProblem linear_problem(const Problem& of, std::vector<int>& branches) {
  sfdae::LinearProblem problem(of.n(), of.n());
  const auto matrix = [&of, &branches](bool is_E, int order, MatrixRef to) {
    if (order > 0) return;
    Matrix E, A;
    matrices(of, branches[0] == 1, E, A);
    write_mixed(of, is_E ? E : A, to);
  };
  problem.E = [matrix](double, int order, MatrixRef E) { matrix(true, order, E); };
  problem.A = [matrix](double, int order, MatrixRef A) { matrix(false, order, A); };
  problem.f = [&of, &branches](double, int order, VectorRef f) {
    if (order == 0) write_mixed(of, right_side(of, branches), f);
  };
  problem.conditions = conditions_of(of, branches);
  return problem;
}

// Matrices in x, as arrays.
struct Mixed {
  Vector entries_E, entries_A;
  Mixed(const Problem& of, bool is_met) : entries_E(static_cast<std::size_t>(of.n() * of.n())), entries_A(entries_E) {
    Matrix E, A;
    matrices(of, is_met, E, A);
    write_mixed(of, E, MatrixRef(entries_E.data(), of.n(), of.n(), "E"));
    write_mixed(of, A, MatrixRef(entries_A.data(), of.n(), of.n(), "A"));
  }
};

sfdae::SparsityPattern pattern_of(const Vector& entries, int n) {
  sfdae::SparsityPattern pattern{{0}, {}};
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i)
      if (entries[static_cast<std::size_t>(i + n * j)] != 0.0) pattern.row_index.push_back(i);
    pattern.col_start.push_back(static_cast<int>(pattern.row_index.size()));
  }
  return pattern;
}

// Derivatives of F = E x' - A x - f along a jet. With SFDAE_MATRICES_DIFFERENCES F alone.
sfdae::NonlinearProblem nonlinear_problem(const Problem& of, std::vector<int>& branches, int form) {
  const int n = of.n();
  sfdae::NonlinearProblem problem(n, n);
  problem.total_derivative = [&of, &branches, n, form](double, int order, ConstMatrixRef x,
                                                       sfdae::TotalDerivatives to) {
    if (order > 0 && form == SFDAE_MATRICES_DIFFERENCES) return SFDAE_ORDER_NOT_AVAILABLE;
    const Mixed mixed(of, branches[0] == 1);
    Vector f(static_cast<std::size_t>(n));
    if (order == 0) write_mixed(of, right_side(of, branches), VectorRef(f.data(), n, "f"));
    for (int i = 0; i < n; ++i) to.F[i] = -f[static_cast<std::size_t>(i)];
    for (int j = 0, entry_of_x = 0, entry_of_xdot = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const std::size_t k = static_cast<std::size_t>(i + n * j);
        const double E = mixed.entries_E[k], A = mixed.entries_A[k];
        to.F[i] += E * x(j, order + 1) - A * x(j, order);
        if (order > 0 || !to.F_x) continue;
        const bool is_dense = form == SFDAE_MATRICES_DENSE;
        if (A != 0.0) to.F_x(is_dense ? i : entry_of_x++, is_dense ? j : 0) = -A;
        if (E != 0.0) to.F_xdot(is_dense ? i : entry_of_xdot++, is_dense ? j : 0) = E;
      }
    return SFDAE_OK;
  };
  problem.matrices = form;
  problem.conditions = conditions_of(of, branches);
  if (form != SFDAE_MATRICES_COMPRESSED) return problem;
  const Mixed mixed(of, false);
  problem.F_x_pattern = pattern_of(mixed.entries_A, n);
  problem.F_xdot_pattern = pattern_of(mixed.entries_E, n);
  return problem;
}

template <class AnyProblem>
void check(const Problem& of, AnyProblem problem, RandomNumbers& random) {
  constexpr double enough = 100.0, end = 1.8;
  constexpr int outputs = 6;
  const int method = random.integer(0, 1);
  const double tolerance = std::pow(10.0, -random.integer(3, 7));
  SCOPED_TRACE("conditions " + std::to_string(of.count()) + ", method " + std::to_string(method) + ", tolerance " +
               std::to_string(tolerance));
  sfdae::Options options = sfdae_test::solver_options(tolerance, method);
  options.atol = tolerance * of.unit;
  sfdae::Solver solver(std::move(problem), options);
  sfdae::Point point{0.0, mixed(of, exact(of, 0.0)), {}};
  solver.start(point, end);
  for (int k = 1; k <= outputs; ++k) {
    const double t = end * k / outputs;
    ASSERT_EQ(solver.advance(t, point), SFDAE_OK) << solver.message();
    const Vector x = mixed(of, exact(of, t));
    for (std::size_t i = 0; i < x.size(); ++i)
      ASSERT_NEAR(point.x[i] / of.unit, x[i] / of.unit, enough * tolerance) << "x[" << i << "] at t = " << t;
  }
  const auto passed = [&](double time) { return time / of.rate < end; };
  const std::ptrdiff_t expected = std::count_if(of.times.begin(), of.times.end(), passed);
  std::string times;
  for (const double time : of.times) times += std::to_string(time / of.rate) + " ";
  for (const auto& each : solver.switches()) times += "; " + std::to_string(each.t) + " " + each.condition;
  EXPECT_EQ(static_cast<std::ptrdiff_t>(solver.switches().size()), expected) << times;
}

TEST(ConditionsOfCallbacks, MakeUnknownsJumpByImpulses) {
  RandomNumbers random(36120);
  for (int trial = 0; trial < sfdae_test::scaled_count(120, 12); ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    const Problem problem = random_problem(true, random);
    std::vector<int> branches;
    check(problem, linear_problem(problem, branches), random);
  }
}

// Entries of linear problems beyond their patterns are found.
TEST(ConditionsOfCallbacks, LeavePatternsOfLinearProblemsAsTheyAre) {
  RandomNumbers random(36127);
  for (const bool has_all : {true, false}) {
    Problem of = random_problem(true, random);
    for (std::size_t i = 0; i < of.P.size(); ++i)
      for (std::size_t j = 0; j < of.P.size(); ++j) of.P[i][j] = of.Q[i][j] = i == j ? 1.0 : 0.0;
    std::vector<int> branches;
    sfdae::LinearProblem problem = linear_problem(of, branches);
    const Mixed mixed_matrices(of, false);
    Vector entries_A = mixed_matrices.entries_A;
    if (!has_all) entries_A[static_cast<std::size_t>(3 + 6 * 3)] = 0.0;
    problem.A_pattern = pattern_of(entries_A, of.n());
    problem.E_pattern = pattern_of(mixed_matrices.entries_E, of.n());
    if (has_all) {
      check(of, problem, random);
      continue;
    }
    sfdae::Solver solver(problem, sfdae::Options());
    sfdae::Point point{0.0, mixed(of, exact(of, 0.0)), {}};
    try {
      solver.start(point, 1.0);
      ADD_FAILURE() << "no error";
    } catch (const sfdae::Error& error) {
      EXPECT_EQ(error.status(), SFDAE_WRONG_PATTERN) << error.what();
    }
  }
}

TEST(ConditionsOfCallbacks, AreKnownWithoutJacobians) {
  RandomNumbers random(36121);
  for (int trial = 0; trial < sfdae_test::scaled_count(120, 12); ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    const Problem problem = random_problem(false, random);
    std::vector<int> branches;
    check(problem, nonlinear_problem(problem, branches, SFDAE_MATRICES_DIFFERENCES), random);
  }
}

// Unknowns are not mixed: the structure is followed, with sparse matrices.
TEST(ConditionsOfCallbacks, MakeUnknownsJumpInEquationsWithPatterns) {
  RandomNumbers random(36124);
  for (int trial = 0; trial < sfdae_test::scaled_count(120, 12); ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    Problem problem = random_problem(true, random);
    const bool is_dense = random.integer(0, 1) == 1;
    for (std::size_t i = 0; i < problem.P.size(); ++i)
      for (std::size_t j = 0; j < problem.P.size() && !is_dense; ++j)
        problem.P[i][j] = problem.Q[i][j] = i == j ? 1.0 : 0.0;
    std::vector<int> branches;
    check(problem, nonlinear_problem(problem, branches, is_dense ? SFDAE_MATRICES_DENSE : SFDAE_MATRICES_COMPRESSED),
          random);
  }
}

// Both branches of the friction lead back to rest: motion along the zero is for recorded equations.
TEST(ConditionsOfCallbacks, AreNamedWhereBothBranchesLeadBack) {
  std::vector<int> branches;
  sfdae::NonlinearProblem block(1, 1);
  block.total_derivative = [&branches](double, int order, ConstMatrixRef x, sfdae::TotalDerivatives to) {
    if (order > 0) return SFDAE_ORDER_NOT_AVAILABLE;
    to.F[0] = x(0, 1) + (branches[0] == 1 ? 1.0 : -1.0) - 0.3;
    return SFDAE_OK;
  };
  block.matrices = SFDAE_MATRICES_DIFFERENCES;
  block.conditions = {1, [](double, ConstVectorRef x, ConstVectorRef, VectorRef g) { g[0] = x[0]; }, &branches};
  sfdae::Options options;
  options.max_steps = 2000;
  sfdae::Solver solver(block, options);
  sfdae::Point point{0.0, {1.0}, {}};
  solver.start(point, 3.0);
  int status = SFDAE_OK;
  try {
    status = solver.advance(3.0, point);
  } catch (const sfdae::Error& error) {
    status = error.status();
  }
  if (status == SFDAE_OK) EXPECT_NEAR(point.x[0], 0.0, 1e-3);
  else EXPECT_TRUE(status == SFDAE_ZENO || status == SFDAE_MAX_STEPS) << solver.message();
}

// A tank y is filled while its level is below a source, and leaks otherwise, so that y follows the source for a while.
// No step may lead across that.
TEST(ConditionsOfCallbacks, AreNamedOrRightWhereMotionAlongTheirZeroIsShort) {
  RandomNumbers random(36128);
  int right = 0;
  for (int trial = 0; trial < sfdae_test::scaled_count(100, 20); ++trial) {
    const double gain = std::pow(10.0, random.uniform(-1.0, 2.0)), level = random.uniform(0.1, 0.6),
                 leak = random.uniform(0.1, 1.0), unit = std::pow(10.0, random.uniform(-8.0, 4.0));
    const double tolerance = std::pow(10.0, -random.integer(4, 7));
    SCOPED_TRACE("trial " + std::to_string(trial) + ", gain " + std::to_string(gain) + ", tolerance " +
                 std::to_string(tolerance));
    const auto slope = [=](bool is_filled, double t, double y) {
      return is_filled ? gain * (std::sin(2.0 * t) - level - y) : -leak * y;
    };
    std::vector<int> branches;
    sfdae::NonlinearProblem tank(1, 1);
    tank.total_derivative = [&](double t, int order, ConstMatrixRef x, sfdae::TotalDerivatives to) {
      if (order > 0) return SFDAE_ORDER_NOT_AVAILABLE;
      to.F[0] = x(0, 1) - unit * slope(branches[0] == 1, t, x(0, 0) / unit);
      return SFDAE_OK;
    };
    tank.matrices = SFDAE_MATRICES_DIFFERENCES;
    const auto g = [=](double t, ConstVectorRef x, ConstVectorRef, VectorRef to) {
      to[0] = std::sin(2.0 * t) - level - x[0] / unit;
    };
    tank.conditions = {1, g, &branches};
    sfdae::Options options = sfdae_test::solver_options(tolerance, random.integer(0, 1));
    options.atol = tolerance * unit;
    sfdae::Solver solver(tank, options);
    sfdae::Point point{0.0, {0.0}, {}};
    solver.start(point, 3.0);
    try {
      solver.advance(3.0, point);
    } catch (const sfdae::Error& error) {
      EXPECT_EQ(error.status(), SFDAE_ZENO) << error.what();
      continue;
    }
    constexpr int steps = 300000;
    double y = 0.0;
    for (int k = 0; k < steps; ++k) {
      const double t = 3.0 * k / steps;
      y += 3.0 / steps * slope(std::sin(2.0 * t) - level - y > 0.0, t, y);
    }
    EXPECT_NEAR(point.x[0] / unit, y, 100.0 * tolerance + 1e-4);
    ++right;
  }
  EXPECT_GT(right, 0);
}

// Recorded equations have the same option: the divider is wrong without a warning where its step counts as smooth.
TEST(ConditionsOfCallbacks, CountAsSmoothIfAskedTo) {
  const auto end_of = [](int conditions) {
    sfdae::NonlinearProblem divider(3, 3);
    divider.equations = [](const sfdae::Expression& t, sfdae::ConstExpressions x, sfdae::ConstExpressions xdot,
                           sfdae::Expressions F) {
      F[0] = x[2] - (xdot[0] - xdot[1]);
      F[1] = xdot[0] - xdot[1] - xdot[1] - x[1];
      F[2] = x[0] - choose(t > 1.0, 1.0, 0.0);
    };
    sfdae::Options options;
    options.conditions = conditions;
    sfdae::Solver solver(divider, options);
    sfdae::Point point{0.0, Vector(3), {}};
    solver.start(point, 2.0);
    EXPECT_EQ(solver.advance(2.0, point), SFDAE_OK) << solver.message();
    return point.x[1];
  };
  const double exact = 0.5 * std::exp(-0.5);
  EXPECT_NEAR(end_of(SFDAE_CONDITIONS_EVENTS), exact, 1e-5);
  EXPECT_GT(std::fabs(end_of(SFDAE_CONDITIONS_SMOOTH) - exact), 0.05);
}

// Failures of the function g are those of any callback.
TEST(ConditionsOfCallbacks, MayFail) {
  RandomNumbers random(36122);
  const Problem problem = random_problem(false, random);
  for (const int code : {-3, 2}) {
    std::vector<int> branches;
    sfdae::NonlinearProblem failing = nonlinear_problem(problem, branches, SFDAE_MATRICES_DIFFERENCES);
    int calls = 0;
    failing.conditions.functions = [&](double, ConstVectorRef, ConstVectorRef, VectorRef g) {
      g[0] = -1.0;
      return ++calls > 40 ? code : 0;
    };
    sfdae::Solver solver(failing, sfdae::Options());
    sfdae::Point point{0.0, mixed(problem, exact(problem, 0.0)), {}};
    const auto run = [&] {
      solver.start(point, 1.8);
      solver.advance(1.8, point);
    };
    EXPECT_THROW(run(), sfdae::Error);
    EXPECT_NE(std::string(solver.message()).find("conditions"), std::string::npos) << solver.message();
  }
}

TEST(ConditionsOfCallbacks, MustBeNumbers) {
  RandomNumbers random(36125);
  const Problem problem = random_problem(false, random);
  std::vector<int> branches;
  sfdae::NonlinearProblem failing = nonlinear_problem(problem, branches, SFDAE_MATRICES_DIFFERENCES);
  int calls = 0;
  failing.conditions.functions = [&](double, ConstVectorRef, ConstVectorRef, VectorRef g) {
    g[0] = ++calls > 40 ? std::nan("") : -1.0;
  };
  sfdae::Solver solver(failing, sfdae::Options());
  sfdae::Point point{0.0, mixed(problem, exact(problem, 0.0)), {}};
  int status = SFDAE_OK;
  try {
    solver.start(point, 1.8);
    solver.advance(1.8, point);
  } catch (const sfdae::Error& error) {
    status = error.status();
  }
  EXPECT_EQ(status, SFDAE_NOT_FINITE) << solver.message();
  for (const double value : point.x) EXPECT_TRUE(std::isfinite(value));
}

// Nothing is evaluated beyond the stop time, where the functions may not exist.
TEST(ConditionsOfCallbacks, AreNotAskedBeyondTheStopTime) {
  RandomNumbers random(36126);
  for (int trial = 0; trial < 10; ++trial) {
    const Problem of = random_problem(trial % 2 == 0, random);
    std::vector<int> branches;
    sfdae::NonlinearProblem problem =
        nonlinear_problem(of, branches, of.has_divider ? SFDAE_MATRICES_DENSE : SFDAE_MATRICES_DIFFERENCES);
    const auto functions = conditions_of(of, branches).functions;
    double latest = 0.0;
    problem.conditions.functions = [&latest, functions](double t, ConstVectorRef x, ConstVectorRef xdot,
                                                        VectorRef g) {
      latest = std::max(latest, t);
      return functions.call(t, x, xdot, g);
    };
    sfdae::Options options = sfdae_test::solver_options(1e-6, trial % 4 / 2);
    options.atol = 1e-6 * of.unit;
    const double stop = of.times[0] / of.rate + 1e-7;  // just after a switch
    options.use_stop_time = 1;
    options.stop_time = stop;
    sfdae::Solver solver(problem, options);
    sfdae::Point point{0.0, mixed(of, exact(of, 0.0)), {}};
    solver.start(point, stop);
    ASSERT_EQ(solver.advance(stop, point), SFDAE_OK) << solver.message();
    EXPECT_LE(latest, stop);
  }
}

TEST(ConditionsOfCallbacks, AreRefusedWhereIncomplete) {
  RandomNumbers random(36123);
  const Problem of = random_problem(false, random);
  std::vector<int> branches;
  const auto refuses = [](const sfdae::NonlinearProblem& problem) {
    try {
      const sfdae::Solver solver(problem, sfdae::Options());
    } catch (const sfdae::Error& error) {
      return error.status() == SFDAE_ILLEGAL_ARGUMENT;
    }
    return false;
  };
  sfdae::NonlinearProblem problem = nonlinear_problem(of, branches, SFDAE_MATRICES_DIFFERENCES);
  EXPECT_FALSE(refuses(problem));
  problem.conditions.functions = {};
  EXPECT_TRUE(refuses(problem));
  problem = nonlinear_problem(of, branches, SFDAE_MATRICES_DIFFERENCES);
  problem.conditions.branches = nullptr;
  EXPECT_TRUE(refuses(problem));
  problem = nonlinear_problem(of, branches, SFDAE_MATRICES_DIFFERENCES);
  problem.conditions.count = 1001;
  EXPECT_TRUE(refuses(problem));
  problem = nonlinear_problem(of, branches, SFDAE_MATRICES_DIFFERENCES);
  problem.total_derivative = {};
  problem.equations = [](const auto&, auto x, auto xdot, auto F) {
    for (int i = 0; i < 2; ++i) F[i] = xdot[i] + x[i];
  };
  EXPECT_TRUE(refuses(problem));
}

}  // namespace
}  // namespace conditions_of_callbacks
