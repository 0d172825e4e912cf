// SPDX-License-Identifier: BSD-3-Clause
//
// Jumps from mode to mode of random linear systems with known solutions, piece by piece (weierstrass_modes.h): after a
// switch, what obeys an ODE in the new mode's coordinates goes on from x-, all else is what is consistent.

#include <sfdae/modes.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "weierstrass_solvers.h"

namespace {

using sfdae_test::Mode;
using sfdae_test::Random;
using sfdae_test::Square;
using sfdae_test::Values;
using namespace sfdae_test;

// From exact values before to exact values after, and xi_k = N^(k+1) (y2+ - y2-) in the coordinates of the mode, both
// relative to the largest of them in their units.
double error_of_jump(const Mode& mode, double t, const Values& before, const Values& after, const Values& impulses) {
  const auto n = static_cast<std::size_t>(mode.n());
  const auto in_coordinates = [&](const double* x) {
    Values y(x, x + n);
    for (std::size_t j = 0; j < mode.unit.size(); ++j) y[j] /= mode.unit[j];
    return mode.Q.inverse * y;
  };
  const Values exact = in_coordinates(mode.solution(t, t, mode.differential_part(before)).data());
  const Values found = in_coordinates(after.data()), start = in_coordinates(before.data());
  Values change(exact);
  double largest = 0.0, error = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    change[i] -= start[i];
    largest = std::max({largest, std::fabs(exact[i]), std::fabs(start[i])});
    error = std::max(error, std::fabs(found[i] - exact[i]));
  }
  for (std::size_t k = 0; k < impulses.size() / n; ++k) {
    Values next(n, 0.0);
    for (int i = 0; i < mode.a; ++i)
      for (int j = 0; j < mode.a; ++j)
        next[static_cast<std::size_t>(mode.d + i)] += mode.N(i, j) * change[static_cast<std::size_t>(mode.d + j)];
    change = next;
    const Values xi = in_coordinates(impulses.data() + k * n);
    const double unit = std::pow(mode.time, static_cast<double>(k + 1));
    for (std::size_t i = 0; i < n; ++i) error = std::max(error, std::fabs(xi[i] / unit - change[i]));
  }
  return error / largest;
}

// A start with fixed y1 cannot be asked for: the exact values at the start.
Outcome run(Mode& first, Mode& second, int method, bool is_recorded) {
  const int n = first.n();
  const double time = first.time, start = 0.0, change = 0.6 * time, end = time;
  const Tolerances tolerances(first.unit, n);
  sfdae_options options;
  tolerances.set(options, method);
  BothModes both{{&first, &second}};
  Solver recorded = is_recorded ? recorded_solver(both, options) : nullptr;
  Solver plain[2] = {is_recorded ? nullptr : solver_of(first, options, true),
                     is_recorded ? nullptr : solver_of(second, options, false)};
  sfdae_solver* solver = is_recorded ? recorded.get() : plain[0].get();

  Values y1(static_cast<std::size_t>(first.d));
  for (std::size_t i = 0; i < y1.size(); ++i) y1[i] = std::cos(1.0 + static_cast<double>(i));
  Values x = first.solution(start, start, y1);
  Outcome outcome;
  const auto failed = [&](int status) {
    if (status >= 0) return false;
    outcome.status = status;
    outcome.message = sfdae_message(solver);
    return true;
  };
  double t = start;
  if (failed(sfdae_start(solver, start, end, x.data(), nullptr)) ||
      failed(sfdae_advance(solver, change, &t, x.data(), nullptr)))
    return outcome;
  const Values before = first.solution(change, start, y1);
  outcome.error = tolerances.error(x, before);

  if (is_recorded) EXPECT_EQ(sfdae_set_parameter(solver, "s", 1.0), SFDAE_OK);
  else solver = plain[1].get();
  Values impulses(static_cast<std::size_t>(4 * n)), after(before);
  if (failed(sfdae_jump(solver, change, end, before.data(), after.data(), 4, impulses.data()))) return outcome;
  EXPECT_LE(error_of_jump(second, change, before, after, impulses), 1e-9);
  if (failed(sfdae_jump(solver, change, end, x.data(), x.data(), 0, nullptr))) return outcome;
  const Values y2 = second.differential_part(before);
  outcome.error = std::max(outcome.error, tolerances.error(x, second.solution(change, change, y2)));
  if (failed(sfdae_start(solver, change, end, x.data(), nullptr)) ||
      failed(sfdae_advance(solver, end, &t, x.data(), nullptr)))
    return outcome;
  outcome.error = std::max(outcome.error, tolerances.error(x, second.solution(end, change, y2)));
  return outcome;
}

// 500 pairs of modes with both methods.
TEST(Jumps, FollowTheConsistencyProjector) {
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    Random random(41);
    Tally tally;
    const int count = scaled(500);
    for (int k = 0; k < count; ++k) {
      std::vector<Mode> modes = random_modes(random);
      tally.add(run(modes[0], modes[1], method, k % 2 == 1), 10.0);
    }
    tally.print(method == SFDAE_METHOD_BDF ? "BDF" : "Radau");
    EXPECT_EQ(tally.wrong, 0);
    EXPECT_GE(tally.right, count - count / 50);
  }
}

// Values that are consistent already, or but for rounding errors, or nearly, of any size.
TEST(Jumps, LeaveConsistentValues) {
  Random random(3);
  double largest = 0.0;
  for (int k = 0; k < 300; ++k) {
    const int mu = random.integer(0, 3), a = random.integer(mu + 1, mu + 3), d = random.integer(0, 3);
    Mode mode(random, d, a, mu);
    const double size = std::pow(10.0, random.integer(0, 8)),
                 error = k % 2 == 0 ? 0.0 : std::pow(10.0, random.real(-16, -6));
    for (auto& wave : mode.waves) wave.c *= size;
    Values y1 = random.reals(d, -size, size), before = mode.solution(0.3, 0.3, y1);
    for (double& value : before) value += error * size * random.real(-1.0, 1.0);
    sfdae_options options;
    sfdae_options_init(&options, sizeof options);
    const Solver solver = solver_of(mode, options, true);
    Values after(before), impulses(static_cast<std::size_t>(mode.n()));
    ASSERT_EQ(sfdae_jump(solver.get(), 0.3, 1.0, before.data(), after.data(), 1, impulses.data()), SFDAE_OK)
        << sfdae_message(solver.get());
    largest = std::max(largest, error_of_jump(mode, 0.3, before, after, impulses));
  }
  std::printf("values that are consistent: relative error %.2g\n", largest);
  EXPECT_LE(largest, 1e-11);
}

// pF beside nH, nanoseconds or hours.
TEST(Jumps, DoNotDependOnUnits) {
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    Random random(43);
    Tally tally;
    const int count = scaled(500);
    for (int k = 0; k < count; ++k) {
      std::vector<Mode> modes = random_modes(random);
      const int n = modes[0].n();
      Values columns, rows;
      for (int j = 0; j < n; ++j) columns.push_back(std::pow(10.0, random.integer(-12, 6)));
      const double time = std::pow(10.0, random.integer(-9, 3));
      for (Mode& mode : modes) {
        rows.clear();
        for (int i = 0; i < n; ++i) rows.push_back(std::pow(10.0, random.integer(-9, 9)));
        mode.change_units(rows, columns, time);
      }
      tally.add(run(modes[0], modes[1], method, k % 2 == 1), 10.0);
    }
    tally.print(method == SFDAE_METHOD_BDF ? "BDF, other units" : "Radau, other units");
    EXPECT_EQ(tally.wrong, 0);
    EXPECT_GE(tally.right, count - count / 50);
  }
}

}  // namespace
