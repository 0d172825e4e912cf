// SPDX-License-Identifier: BSD-3-Clause
//
// Solvers of random linear modes (weierstrass_modes.h): given by functions, or both modes of a pair recorded in one
// problem.
#pragma once

#include <sfdae/modes.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "weierstrass_modes.h"

namespace sfdae_test {

inline int scaled(int count) {
  const char* scale = std::getenv("SFDAE_TEST_SCALE");
  return scale != nullptr && std::atof(scale) < 1 ? count / 10 : count;
}

struct Deleter {
  void operator()(sfdae_solver* solver) const { sfdae_destroy(&solver); }
};
using Solver = std::unique_ptr<sfdae_solver, Deleter>;

inline int write_matrix(const Square& from, int order, double* to) {
  for (int j = 0; j < from.n() && order == 0; ++j)
    for (int i = 0; i < from.n(); ++i) to[i + j * from.n()] = from(i, j);
  return 0;
}
inline int write_E(double, int order, double* to, void* user) {
  return write_matrix(static_cast<const Mode*>(user)->E, order, to);
}
inline int write_A(double, int order, double* to, void* user) {
  return write_matrix(static_cast<const Mode*>(user)->A, order, to);
}
inline int write_f(double t, int order, double* to, void* user) {
  const Values f = static_cast<const Mode*>(user)->f(t, order);
  std::copy(f.begin(), f.end(), to);
  return 0;
}

// Tolerances of 1e-6 in these units.
struct Tolerances {
  Tolerances(const Values& units, int n) : atol(units.empty() ? Values(static_cast<std::size_t>(n), 1.0) : units) {
    for (double& value : atol) value *= 1e-6;
    rtol.assign(atol.size(), 1e-6);
  }
  void set(sfdae_options& options, int method) const {
    sfdae_options_init(&options, sizeof options);
    options.method = method;
    options.rtol_vector = rtol.data();
    options.atol_vector = atol.data();
    options.check_derivatives = 0;
  }
  double error(const Values& x, const Values& exact) const {
    double largest = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i)
      largest = std::max(largest, std::fabs(x[i] - exact[i]) / (rtol[i] * std::fabs(exact[i]) + atol[i]));
    return largest;
  }
  Values rtol, atol;
};

inline Solver solver_of(Mode& mode, const sfdae_options& options, bool constant) {
  sfdae_linear_problem problem;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = mode.n();
  problem.E = write_E;
  problem.A = write_A;
  problem.f = write_f;
  problem.constant_E = problem.constant_A = constant ? 1 : 0;
  problem.user = &mode;
  sfdae_solver* solver = nullptr;
  EXPECT_EQ(sfdae_create_linear(&solver, &problem, &options), SFDAE_OK);
  return Solver(solver);
}

// Both modes in one recorded problem: s of the second, 1 - s of the first.
struct BothModes {
  const Mode* modes[2];
};
inline int record_both(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                       const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  const auto& both = *static_cast<const BothModes*>(user);
  const int n = both.modes[0]->n();
  const auto number = [&](double value) { return sfdae_number(value); };
  const auto add = [&](sfdae_expression a, sfdae_expression b) { return sfdae_add(a, b); };
  const auto times = [&](sfdae_expression a, sfdae_expression b) { return sfdae_multiply(a, b); };
  const sfdae_expression s = sfdae_parameter(record, "s", 0.0);
  const sfdae_expression weights[2] = {sfdae_subtract(number(1.0), s), s};
  for (int i = 0; i < n; ++i) {
    F[i] = number(0.0);
    for (int k = 0; k < 2; ++k) {
      const Mode& mode = *both.modes[k];
      sfdae_expression row = number(0.0);
      for (int j = 0; j < n; ++j) {
        row = add(row, times(number(mode.E(i, j)), xdot[j]));
        row = add(row, times(number(-mode.A(i, j)), x[j]));
        const auto& wave = mode.waves[static_cast<std::size_t>(j)];
        const double factor = mode.row_factor.empty() ? 1.0 : mode.row_factor[static_cast<std::size_t>(i)];
        const sfdae_expression angle = add(times(number(wave.w / mode.time), t), number(wave.p));
        row = add(row, times(number(-factor * mode.P.inverse(i, j) * wave.c), sfdae_cos(angle)));
      }
      F[i] = add(F[i], times(weights[k], row));
    }
  }
  return 0;
}

inline Solver recorded_solver(BothModes& both, const sfdae_options& options) {
  sfdae_nonlinear_problem problem;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = both.modes[0]->n();
  problem.equations = record_both;
  problem.user = &both;
  sfdae_solver* solver = nullptr;
  EXPECT_EQ(sfdae_create_nonlinear(&solver, &problem, &options), SFDAE_OK);
  return Solver(solver);
}

// Both with as many unknowns.
inline std::vector<Mode> random_modes(Random& random) {
  const int n = random.integer(5, 8);
  std::vector<Mode> modes;
  for (int k = 0; k < 2; ++k) {
    const int mu = random.integer(0, 3), a = random.integer(mu + 1, std::min(n, mu + 3));
    modes.emplace_back(random, n - a, a, mu);
  }
  return modes;
}

struct Outcome {
  int status = SFDAE_OK;
  std::string message;
  double error = 0.0;
};

struct Tally {
  int right = 0, named = 0, wrong = 0;
  double largest = 0.0;
  void add(const Outcome& outcome, double allowed) {
    if (outcome.status < 0) {
      ++named;
      EXPECT_NE(outcome.message, "");
    } else if (outcome.error <= allowed) {
      ++right;
    } else {
      ++wrong;
    }
    if (outcome.status >= 0) largest = std::max(largest, outcome.error);
  }
  void print(const char* what) const {
    std::printf("%s: %d right, %d named, %d wrong; largest error %.3g tolerances\n", what, right, named, wrong,
                largest);
  }
};

}  // namespace sfdae_test
