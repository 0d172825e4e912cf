// SPDX-License-Identifier: BSD-3-Clause
//
// Breakpoints: kinks and jumps of data in linear systems with known solutions, piece by piece.

#include <sfdae/modes.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "weierstrass_modes.h"

namespace {

using sfdae_test::Mode;
using sfdae_test::Random;
using sfdae_test::Square;
using sfdae_test::Values;

struct Deleter {
  void operator()(sfdae_solver* solver) const { sfdae_destroy(&solver); }
};
using Solver = std::unique_ptr<sfdae_solver, Deleter>;

// One E and A, other data in each piece; where `times` separate them the function has the data after it.
struct Pieces {
  Mode mode;
  std::vector<std::vector<sfdae_test::Wave>> waves;
  Values times;
  bool has_derivatives = true, is_constant = true;
  // What the callback sees.
  double nearest = HUGE_VAL;

  Values f(double t, int order) {
    std::size_t piece = 0;
    while (piece < times.size() && t >= times[piece]) ++piece;
    for (double time : times) nearest = std::min(nearest, std::fabs(t - time));
    mode.waves = waves[piece];
    return mode.f(t, order);
  }
  // y1 at the start of each piece, continuous, from that at times 0.
  Values solution(double t, Values y1) {
    double from = 0.0;
    for (std::size_t piece = 0;; ++piece) {
      mode.waves = waves[piece];
      const bool is_here = piece == times.size() || t < times[piece];
      const Values x = mode.solution(is_here ? t : times[piece], from, y1);
      if (is_here) return x;
      y1 = mode.differential_part(x);
      from = times[piece];
    }
  }
};

int write_matrix(const Square& from, int order, double* to) {
  for (int j = 0; j < from.n() && order == 0; ++j)
    for (int i = 0; i < from.n(); ++i) to[i + j * from.n()] = from(i, j);
  return 0;
}
int write_E(double, int order, double* to, void* user) {
  return write_matrix(static_cast<Pieces*>(user)->mode.E, order, to);
}
int write_A(double, int order, double* to, void* user) {
  return write_matrix(static_cast<Pieces*>(user)->mode.A, order, to);
}
int write_f(double t, int order, double* to, void* user) {
  Pieces& pieces = *static_cast<Pieces*>(user);
  if (order > 0 && !pieces.has_derivatives) return SFDAE_ORDER_NOT_AVAILABLE;
  const Values f = pieces.f(t, order);
  std::copy(f.begin(), f.end(), to);
  return 0;
}

Solver solver_of(Pieces& pieces, int method) {
  sfdae_linear_problem problem;
  sfdae_options options;
  sfdae_linear_problem_init(&problem, sizeof problem);
  sfdae_options_init(&options, sizeof options);
  problem.num_equations = problem.num_unknowns = pieces.mode.n();
  problem.E = write_E;
  problem.A = write_A;
  problem.f = write_f;
  problem.constant_E = problem.constant_A = pieces.is_constant ? 1 : 0;
  problem.user = &pieces;
  options.method = method;
  options.difference_derivatives = pieces.has_derivatives ? 0 : 1;
  sfdae_solver* solver = nullptr;
  EXPECT_EQ(sfdae_create_linear(&solver, &problem, &options), SFDAE_OK);
  return Solver(solver);
}

Pieces random_pieces(Random& random, int largest_mu) {
  const int mu = random.integer(0, largest_mu), a = random.integer(mu + 1, mu + 3), d = random.integer(0, 3);
  Pieces pieces{Mode(random, d, a, mu, -0.5), {}, {0.31, 0.5, 0.83}};
  for (int piece = 0; piece < 4; ++piece) {
    for (auto& wave : pieces.mode.waves)
      wave = {random.real(-1.0, 1.0), random.real(0.5, 1.5), random.real(0.0, 6.28)};
    pieces.waves.push_back(pieces.mode.waves);
  }
  return pieces;
}

double error(const Values& x, const Values& exact) {
  double largest = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
    largest = std::max(largest, std::fabs(x[i] - exact[i]) / (1e-6 * (1.0 + std::fabs(exact[i]))));
  return largest;
}

// Outputs at, beside and between breakpoints; the largest error in tolerances.
double error_of_run(Pieces& pieces, int method, double from, double to) {
  const int n = pieces.mode.n();
  const Solver solver = solver_of(pieces, method);
  const std::vector<int> kinds(pieces.times.size(), SFDAE_BREAKPOINT_JUMP);
  EXPECT_EQ(sfdae_set_breakpoints(solver.get(), static_cast<int>(kinds.size()), pieces.times.data(), kinds.data()),
            0);
  Values y1(static_cast<std::size_t>(pieces.mode.d));
  for (std::size_t i = 0; i < y1.size(); ++i) y1[i] = std::cos(1.0 + static_cast<double>(i));
  Values x = pieces.solution(from, y1);
  EXPECT_EQ(sfdae_start(solver.get(), from, to, x.data(), nullptr), SFDAE_OK) << sfdae_message(solver.get());
  double largest = 0.0, t = from;
  Values outputs = {0.2, 0.31, 0.45, 0.5, 0.6, 0.83, 0.9, 1.0};
  if (to < from) outputs = {0.9, 0.83, 0.6, 0.5, 0.45, 0.31, 0.2, 0.0};
  Values xdot(static_cast<std::size_t>(n));
  for (double tout : outputs) {
    const int status = sfdae_advance(solver.get(), tout, &t, x.data(), xdot.data());
    EXPECT_EQ(status, SFDAE_OK) << sfdae_message(solver.get());
    if (status < 0) return HUGE_VAL;
    EXPECT_EQ(t, tout);
    largest = std::max(largest, error(x, pieces.solution(tout, y1)));
  }
  return largest;
}

TEST(Breakpoints, JumpsOfDataAreThoseOfTheSolution) {
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (bool is_backward : {false, true}) {
      Random random(17);
      double largest = 0.0, nearest = HUGE_VAL;
      for (int k = 0; k < 100; ++k) {
        Pieces pieces = random_pieces(random, 3);
        pieces.is_constant = k % 2 == 0;
        const double found = error_of_run(pieces, method, is_backward ? 1.0 : 0.0, is_backward ? 0.0 : 1.0);
        EXPECT_LE(found, 10.0) << k;
        largest = std::max(largest, found);
        nearest = std::min(nearest, pieces.nearest);
      }
      std::printf("method %d, %s: %.3g tolerances; calls at least %.3g from breakpoints\n", method,
                  is_backward ? "backward" : "forward", largest, nearest);
      // 64 roundings of the largest, but for those of t.
      EXPECT_GE(nearest, 0.99 * 64 * 2.22e-16 * 0.83);
    }
}

TEST(Breakpoints, DifferencesStayOnTheirSide) {
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    Random random(19);
    double largest = 0.0;
    for (int k = 0; k < 50; ++k) {
      Pieces pieces = random_pieces(random, 1);
      pieces.has_derivatives = false;
      const double found = error_of_run(pieces, method, 0.0, 1.0);
      EXPECT_LE(found, 10.0) << k;
      largest = std::max(largest, found);
    }
    std::printf("method %d, differences: %.3g tolerances\n", method, largest);
  }
}

}  // namespace
