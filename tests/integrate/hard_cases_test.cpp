// Small problems that lead solvers astray: tiny capacitors, stiffness beside constraints, periodic data, units of time.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "family_run.h"
#include "sfdae/sfdae.h"

namespace {

constexpr double pi = 3.14159265358979323846;

// A linear problem from closures; entries (row, column) are set by the closures in column-major arrays.
struct Problem {
  int n = 0;
  std::function<int(double, int, double*)> E, A, f;
  sfdae_linear_problem c_problem() {
    sfdae_linear_problem problem;
    sfdae_linear_problem_init(&problem, sizeof problem);
    problem.num_equations = problem.num_unknowns = n;
    problem.E = [](double t, int k, double* m, void* self) { return static_cast<Problem*>(self)->E(t, k, m); };
    problem.A = [](double t, int k, double* m, void* self) { return static_cast<Problem*>(self)->A(t, k, m); };
    problem.f = [](double t, int k, double* v, void* self) { return static_cast<Problem*>(self)->f(t, k, v); };
    problem.user = this;
    return problem;
  }
};

class Solved {
 public:
  Solved(Problem& problem, const sfdae_options& options) {
    const sfdae_linear_problem c_problem = problem.c_problem();
    EXPECT_EQ(sfdae_create_linear(&solver, &c_problem, &options), SFDAE_OK);
    sfdae_characteristics_init(&values, sizeof values);
  }
  ~Solved() { sfdae_destroy(&solver); }
  Solved(const Solved&) = delete;
  Solved& operator=(const Solved&) = delete;

  sfdae_solver* solver = nullptr;
  sfdae_characteristics values;
};

// Nodes 1, 2: source, conductance G between them, capacitor C at node 2, coil L from there; x = (v1, v2, i_source,
// i_L). C v2' = G (v1 - v2) - i_L, L i_L' = v2, v1 = 1, current balance at node 1: mu = 0, d = 2, a = 2 for all C, L
// > 0. For t << L / R the capacitor charges like 1 - e^(-t G / C).
TEST(HardCases, ATinyCapacitorStaysACapacitor) {
  for (double C : {1e-15, 1e-12, 1e-9})
    for (double L : {1e-7, 1e-6}) {
      const double G = 0.02;
      Problem problem;
      problem.n = 4;
      problem.E = [=](double, int k, double* m) { return k == 0 ? (m[1 + 4 * 1] = C, m[2 + 4 * 3] = L, 0) : 0; };
      problem.A = [=](double, int k, double* m) {
        if (k > 0) return 0;
        m[0] = -G, m[0 + 4 * 1] = G, m[0 + 4 * 2] = -1;
        m[1] = G, m[1 + 4 * 1] = -G, m[1 + 4 * 3] = -1;
        m[2 + 4 * 1] = 1, m[3] = 1;
        return 0;
      };
      problem.f = [](double, int k, double* v) { return k == 0 ? (v[3] = -1, 0) : 0; };
      Solved s(problem, sfdae_test::options_with_tolerance(1e-6));
      const double t1 = C / G;
      ASSERT_EQ(sfdae_analyze(s.solver, 0.0, t1, &s.values), SFDAE_OK) << sfdae_message(s.solver);
      EXPECT_EQ(s.values.strangeness_index, 0);
      EXPECT_EQ(s.values.differential, 2);
      EXPECT_EQ(s.values.algebraic, 2);
      double x[] = {1, 0, -G, 0}, t = 0;
      ASSERT_EQ(sfdae_start(s.solver, 0.0, t1, x, nullptr), SFDAE_OK);
      EXPECT_NEAR(x[1], 0.0, 1e-12);
      ASSERT_EQ(sfdae_advance(s.solver, t1, &t, x, nullptr), SFDAE_OK);
      // The coil takes a current of order t / L, which lowers v2 by about t / (G L).
      EXPECT_NEAR(x[1], 1.0 - std::exp(-1.0), 2e-5 + t1 / (G * L));
    }
}

// x1' = -lambda x1, x2' = -x2, 0 = x3 - 1: an algebraic equation beside a stiff one does not make it algebraic.
TEST(HardCases, StiffnessBesideAConstraintIsNoConstraint) {
  for (int reduction : {SFDAE_REDUCTION_STAGED, SFDAE_REDUCTION_SVD})
    for (double lambda : {1e3, 1e6, 3e7, 1e9, 1e11}) {
      Problem problem;
      problem.n = 3;
      problem.E = [](double, int k, double* m) { return k == 0 ? (m[0] = m[4] = 1, 0) : 0; };
      problem.A = [=](double, int k, double* m) { return k == 0 ? (m[0] = -lambda, m[4] = -1, m[8] = -1, 0) : 0; };
      problem.f = [](double, int k, double* v) { return k == 0 ? (v[2] = 1, 0) : 0; };
      sfdae_options options = sfdae_test::options_with_tolerance(1e-6);
      options.reduction = reduction;
      Solved s(problem, options);
      double x[] = {0.5, 1.0, 1.0}, t = 0.0;
      ASSERT_EQ(sfdae_start(s.solver, 0.0, 1.0, x, nullptr), SFDAE_OK) << lambda << ": " << sfdae_message(s.solver);
      EXPECT_EQ(x[0], 0.5);
      ASSERT_EQ(sfdae_advance(s.solver, 2.0 / lambda, &t, x, nullptr), SFDAE_OK);
      EXPECT_NEAR(x[0], 0.5 * std::exp(-2.0), 1e-4);
      ASSERT_EQ(sfdae_advance(s.solver, 1.0, &t, x, nullptr), SFDAE_OK);
      EXPECT_NEAR(x[1], std::exp(-1.0), 2e-5);
    }
}

// x' = -x + 5 sin(2 pi t) over a whole number of periods, such that simple fractions of the interval are periods.
TEST(HardCases, PeriodicDataAreSeenWhateverTheInterval) {
  for (double periods : {500.0, 1000.0, 200.0}) {
    Problem problem;
    problem.n = 1;
    const double w = 2.0 * pi;
    problem.E = [](double, int k, double* m) { return k == 0 ? (m[0] = 1, 0) : 0; };
    problem.A = [](double, int k, double* m) { return k == 0 ? (m[0] = -1, 0) : 0; };
    problem.f = [=](double t, int k, double* v) {
      return v[0] = 5.0 * std::pow(w, k) * std::sin(w * t + k * pi / 2), 0;
    };
    Solved s(problem, sfdae_test::options_with_tolerance(1e-4));
    double x = 0.0, t = 0.0;
    ASSERT_EQ(sfdae_start(s.solver, 0.0, periods, &x, nullptr), SFDAE_OK);
    const double tout = 20.25;
    ASSERT_EQ(sfdae_advance(s.solver, tout, &t, &x, nullptr), SFDAE_OK);
    const double scale = 5.0 / (1.0 + w * w);
    EXPECT_NEAR(x, scale * (std::sin(w * tout) - w * std::cos(w * tout)), 20 * 1e-4 * 2.0);
  }
}

// x' = -lambda (x - sin t) + cos t, x = sin t: the slope must not be that of the error of x times lambda.
TEST(HardCases, SlopesOfStiffComponentsAreThoseOfTheSolution) {
  for (double lambda : {1.0, 1e3, 1e6, 1e8}) {
    Problem problem;
    problem.n = 1;
    problem.E = [](double, int k, double* m) { return k == 0 ? (m[0] = 1, 0) : 0; };
    problem.A = [=](double, int k, double* m) { return k == 0 ? (m[0] = -lambda, 0) : 0; };
    problem.f = [=](double t, int k, double* v) {
      return v[0] = lambda * std::sin(t + k * pi / 2) + std::cos(t + k * pi / 2), 0;
    };
    Solved s(problem, sfdae_test::options_with_tolerance(1e-6));
    double x = 0.0, xdot = 0.0, t = 0.0;
    ASSERT_EQ(sfdae_start(s.solver, 0.0, 10.0, &x, &xdot), SFDAE_OK);
    EXPECT_NEAR(xdot, 1.0, 1e-6);
    for (int i = 1; i <= 50; ++i) {
      ASSERT_EQ(sfdae_advance(s.solver, 0.2 * i, &t, &x, &xdot), SFDAE_OK);
      EXPECT_NEAR(x, std::sin(t), 20 * 1e-6);
      EXPECT_NEAR(xdot, std::cos(t), 1e-4) << lambda << " " << t;
    }
  }
}

// tau x1' w = x0 + f0, tau x2' = x1 + f1, 0 = x2 + f2, tau x3' = -x3: mu = 2, d = 1, a = 3, derivatives by
// differences, in units of time from picoseconds to days. Exact: x_i = sin(s + i), i < 3, x3 = e^-s with s = t / tau.
TEST(HardCases, DifferenceDerivativesDoNotDependOnTheUnitOfTime) {
  for (double unit : {1e-12, 1e-6, 1.0, 1e5})
    for (double variation : {0.0, 0.3}) {
      Problem problem;
      problem.n = 4;
      const auto weight = [=](double t) { return 1.0 + variation * std::sin(t / unit); };
      problem.E = [=](double t, int k, double* m) {
        if (k > 0) return SFDAE_ORDER_NOT_AVAILABLE;
        m[0 + 4 * 1] = unit * weight(t), m[1 + 4 * 2] = unit, m[3 + 4 * 3] = unit;
        return 0;
      };
      problem.A = [](double, int k, double* m) {
        if (k > 0) return SFDAE_ORDER_NOT_AVAILABLE;
        m[0] = m[5] = m[10] = 1, m[15] = -1;
        return 0;
      };
      problem.f = [=](double t, int k, double* v) {
        if (k > 0) return SFDAE_ORDER_NOT_AVAILABLE;
        const double s = t / unit;
        v[0] = weight(t) * std::cos(s + 1) - std::sin(s), v[1] = std::cos(s + 2) - std::sin(s + 1),
        v[2] = -std::sin(s + 2);
        return 0;
      };
      sfdae_options options = sfdae_test::options_with_tolerance(1e-6);
      options.difference_derivatives = 1;
      Solved s(problem, options);
      double x[] = {0.0, std::sin(1.0), std::sin(2.0), 1.0}, t = 0.0;
      ASSERT_EQ(sfdae_start(s.solver, 0.0, 3.0 * unit, x, nullptr), SFDAE_OK)
          << unit << ": " << sfdae_message(s.solver);
      sfdae_get_characteristics(s.solver, &s.values);
      EXPECT_EQ(s.values.strangeness_index, 2);
      EXPECT_EQ(s.values.differential, 1);
      ASSERT_EQ(sfdae_advance(s.solver, 3.0 * unit, &t, x, nullptr), SFDAE_OK) << sfdae_message(s.solver);
      for (int i = 0; i < 3; ++i) EXPECT_NEAR(x[i], std::sin(3.0 + i), 10 * 2e-6);
      EXPECT_NEAR(x[3], std::exp(-3.0), 10 * 2e-6);
    }
}

// Unknowns in units of 10^q and 10^-q in turn: the same values, the same solution in those units, initial values and
// derivatives included.
TEST(HardCases, UnitsOfTheUnknownsDoNotMatter) {
  for (int mu : {0, 1, 2, 3})
    for (int q : {0, 2, 4, 5}) {
      const auto family = sfdae_test::kron(8, mu, 0.5);
      const int n = family->n();
      std::vector<double> unit;
      for (int j = 0; j < n; ++j) unit.push_back(std::pow(10.0, j % 2 == 0 ? q : -q));
      const auto scale_columns = [&](double* m) {
        for (int j = 0; j < n; ++j)
          for (int i = 0; i < n; ++i) m[i + n * j] *= unit[static_cast<std::size_t>(j)];
        return 0;
      };
      Problem problem;
      problem.n = n;
      problem.E = [&](double t, int k, double* m) { return family->E(t, k, m), scale_columns(m); };
      problem.A = [&](double t, int k, double* m) { return family->A(t, k, m), scale_columns(m); };
      problem.f = [&](double t, int k, double* v) { return family->f(t, k, v), 0; };
      const double tol = 1e-6;
      std::vector<double> atol;
      for (double u : unit) atol.push_back(tol / u);
      sfdae_options options = sfdae_test::options_with_tolerance(tol);
      options.atol_vector = atol.data();
      Solved s(problem, options);
      std::vector<double> x(unit.size()), xdot(x), exact(x), exact_dot(x);
      family->exact(0.0, x.data(), exact_dot.data());
      for (std::size_t j = 0; j < x.size(); ++j) x[j] /= unit[j];
      const std::vector<double> start = x;
      ASSERT_EQ(sfdae_start(s.solver, 0.0, 1.0, x.data(), xdot.data()), SFDAE_OK) << sfdae_message(s.solver);
      sfdae_get_characteristics(s.solver, &s.values);
      EXPECT_EQ(s.values.strangeness_index, mu);
      EXPECT_EQ(s.values.differential, family->values().d);
      for (std::size_t j = 0; j < x.size(); ++j) {
        // The nearest point in the user's norm is a least squares problem with weights 10^-q ... 10^q.
        const double rounding = 1e-15 * std::pow(10.0, 2 * q);
        EXPECT_NEAR(x[j] * unit[j], start[j] * unit[j], 10 * rounding + 1e-13) << mu << " " << q;
        EXPECT_NEAR(xdot[j] * unit[j], exact_dot[j], 100 * rounding + 1e-11) << mu << " " << q;
      }
      for (double tout : {0.3, 0.7, 1.0}) {
        double t = 0.0;
        ASSERT_EQ(sfdae_advance(s.solver, tout, &t, x.data(), xdot.data()), SFDAE_OK) << sfdae_message(s.solver);
        family->exact(tout, exact.data(), exact_dot.data());
        for (std::size_t j = 0; j < x.size(); ++j)
          EXPECT_NEAR(x[j] * unit[j], exact[j], 10 * tol * (1 + std::fabs(exact[j]))) << mu << " " << q;
      }
    }
}

// x1' = x1 + cos t, 0 = x2, 0 = x2 again, rows mixed by a constant orthogonal matrix: the redundant row carries
// nothing but rounding errors of f, which are no contradiction.
TEST(HardCases, RoundingErrorsOfRedundantRowsAreNoContradiction) {
  for (double angle = 0.1; angle < 3.0; angle += 0.37) {
    const double c = std::cos(angle), d = std::sin(angle);
    const double Q[3][3] = {{c, -d, 0}, {d * c, c * c, -d}, {d * d, c * d, c}};
    sfdae_linear_problem problem;
    sfdae_linear_problem_init(&problem, sizeof problem);
    problem.num_equations = 3;
    problem.num_unknowns = 2;
    problem.E = [](double, int k, double* m, void* q) {
      for (int i = 0; i < 3 && k == 0; ++i) m[i] = static_cast<const double*>(q)[3 * i];
      return 0;
    };
    problem.A = [](double, int k, double* m, void* q) {
      const double* Q0 = static_cast<const double*>(q);
      for (int i = 0; i < 3 && k == 0; ++i) m[i] = Q0[3 * i], m[i + 3] = Q0[3 * i + 1] + Q0[3 * i + 2];
      return 0;
    };
    problem.f = [](double t, int k, double* v, void* q) {
      for (int i = 0; i < 3; ++i) v[i] = static_cast<const double*>(q)[3 * i] * std::cos(t + k * pi / 2);
      return 0;
    };
    problem.user = const_cast<double*>(&Q[0][0]);
    sfdae_solver* solver = nullptr;
    ASSERT_EQ(sfdae_create_linear(&solver, &problem, nullptr), SFDAE_OK);
    double x[] = {-0.5, 0.0}, t = 0.0;  // x1 = (sin t - cos t) / 2
    ASSERT_EQ(sfdae_start(solver, 0.0, 1.0, x, nullptr), SFDAE_OK) << sfdae_message(solver);
    ASSERT_EQ(sfdae_advance(solver, 1.0, &t, x, nullptr), SFDAE_OK) << sfdae_message(solver);
    EXPECT_NEAR(x[0], (std::sin(1.0) - std::cos(1.0)) / 2.0, 2e-5);
    sfdae_destroy(&solver);
  }
}

// Nothing is evaluated beyond the stop time, not by a bit, whatever start and stop.
TEST(HardCases, NothingIsEvaluatedBeyondTheStopTime) {
  unsigned state = 7;
  const auto random = [&] { return static_cast<double>((state = state * 1664525u + 1013904223u) >> 8) / 16777216.0; };
  for (int i = 0; i < 200; ++i) {
    const double t0 = 10.0 * random(), stop = t0 + random();
    Problem problem;
    problem.n = 1;
    double latest = t0;
    problem.E = [&](double t, int k, double* m) {
      return latest = std::max(latest, t), k == 0 ? (m[0] = 1.0 + 0.1 * t, 0) : (m[0] = k == 1 ? 0.1 : 0.0, 0);
    };
    problem.A = [&](double t, int k, double* m) { return latest = std::max(latest, t), k == 0 ? (m[0] = -1, 0) : 0; };
    problem.f = [&](double t, int, double*) { return latest = std::max(latest, t), 0; };
    sfdae_options options = sfdae_test::options_with_tolerance(1e-5);
    options.use_stop_time = 1;
    options.stop_time = stop;
    Solved s(problem, options);
    double x = 1.0, t = 0.0;
    ASSERT_EQ(sfdae_start(s.solver, t0, stop, &x, nullptr), SFDAE_OK);
    ASSERT_EQ(sfdae_advance(s.solver, stop, &t, &x, nullptr), SFDAE_OK);
    EXPECT_EQ(t, stop);
    EXPECT_LE(latest, stop);
  }
}

// Index 3 in seconds, gigaseconds, nanoseconds: a rotated nilpotent pencil T N x' = x + f.
TEST(HardCases, TheUnitOfTimeDoesNotChangeTheIndex) {
  for (double T : {1e-12, 1e-6, 1.0, 1e6, 1e12}) {
    Problem problem;
    problem.n = 3;
    const double c = std::cos(0.7), d = std::sin(0.7);
    const double Q[3][3] = {{c, -d, 0}, {d * c, c * c, -d}, {d * d, c * d, c}};
    const auto conjugated = [Q](const double(&N)[3][3], double* m) {
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l) m[i + 3 * j] += Q[i][k] * N[k][l] * Q[j][l];
    };
    problem.E = [=](double, int k, double* m) {
      const double N[3][3] = {{0, T, 0}, {0, 0, T}, {0, 0, 0}};
      if (k == 0) conjugated(N, m);
      return 0;
    };
    problem.A = [=](double, int k, double* m) {
      const double I[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
      if (k == 0) conjugated(I, m);
      return 0;
    };
    problem.f = [](double, int, double*) { return 0; };
    Solved s(problem, sfdae_test::options_with_tolerance(1e-6));
    ASSERT_EQ(sfdae_analyze(s.solver, 0.0, T, &s.values), SFDAE_OK) << T << sfdae_message(s.solver);
    EXPECT_EQ(s.values.strangeness_index, 2) << T;
    EXPECT_EQ(s.values.algebraic, 3) << T;
  }
}

// T2 T2^T, the projector onto the kernel of the constraints, does not depend on row scales.
TEST(HardCases, ProjectorsKeepTheirAccuracyUnderRowScaling) {
  const auto family = sfdae_test::kron(6, 1, 0.5);
  const int n = family->n(), a = family->values().a, free = n - a;
  std::vector<double> projector[2];
  for (int scaled = 0; scaled < 2; ++scaled) {
    const auto scale_rows = [&](double* m, int columns) {
      for (int j = 0; j < columns && scaled == 1; ++j)
        for (int i = 0; i < n; ++i) m[i + n * j] *= i % 2 == 0 ? 1e8 : 1e-8;
      return 0;
    };
    Problem problem;
    problem.n = n;
    problem.E = [&](double t, int k, double* m) { return family->E(t, k, m), scale_rows(m, n); };
    problem.A = [&](double t, int k, double* m) { return family->A(t, k, m), scale_rows(m, n); };
    problem.f = [&](double t, int k, double* v) { return family->f(t, k, v), scale_rows(v, 1); };
    Solved s(problem, sfdae_test::options_with_tolerance(1e-6));
    ASSERT_EQ(sfdae_analyze(s.solver, 0.2, 1.0, &s.values), SFDAE_OK) << sfdae_message(s.solver);
    std::vector<double> T2(static_cast<std::size_t>(n * free));
    ASSERT_EQ(sfdae_get_projectors(s.solver, 0.2, nullptr, nullptr, nullptr, T2.data(), nullptr), SFDAE_OK);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        double sum = 0.0;
        for (int k = 0; k < free; ++k)
          sum += T2[static_cast<std::size_t>(i + n * k)] * T2[static_cast<std::size_t>(j + n * k)];
        projector[scaled].push_back(sum);
      }
  }
  for (std::size_t i = 0; i < projector[0].size(); ++i) EXPECT_NEAR(projector[0][i], projector[1][i], 1e-12);
}

}  // namespace
