// SPDX-License-Identifier: BSD-3-Clause
//
// Tests of jumps that lead across the edge of a diode: finite currents change nothing, whatever the units of the
// unknowns. SFDAE_TEST_SCALE scales the number of random problems.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "family_run.h"
#include "random_family.h"
#include "solver_options.h"

namespace jumps_into_diodes {
namespace {

using sfdae::ConstExpressions;
using sfdae::Expression;
using sfdae::Expressions;
using sfdae_test::RandomNumbers;

// c1 v' + c2 (v' - u') + i = 0 with the current i of a diode that conducts for v > 0, and a source u that steps at
// t = 1: v jumps by c2 / (c1 + c2) of the step.
struct Circuit {
  double c1, c2, r_on, r_off, step, v0, unit_v, unit_u, unit_i;
  int form;
};

Circuit random_circuit(RandomNumbers& random) {
  const auto power = [&random](double from, double to) { return std::pow(10.0, random.uniform(from, to)); };
  return {power(-1.0, 1.0),           power(-1.0, 1.0), power(-6.0, 0.0), power(2.0, 5.0),  random.uniform(1.0, 6.0),
          random.uniform(-2.0, -0.5), power(-4.0, 4.0), power(-4.0, 4.0), power(-4.0, 4.0), random.integer(0, 2)};
}

sfdae::NonlinearProblem equations_of(const Circuit& of) {
  sfdae::NonlinearProblem problem(4, 4);
  problem.equations = [&of](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    const Expression v = x[0] / of.unit_v, u = x[1] / of.unit_u, i = x[2] / of.unit_i, q = x[3];
    const Expression v_rate = xdot[0] / of.unit_v, u_rate = xdot[1] / of.unit_u;
    F[0] = u - choose(t > 1.0, of.step, 0.0);
    F[1] = of.c1 * v_rate + of.c2 * q + i;
    F[2] = i;
    if (of.form == 0) F[2] = F[2] - choose(v > 0.0, v / of.r_on, v / of.r_off);
    if (of.form == 1) F[2] = F[2] - max(v, 0.0) / of.r_on - min(v, 0.0) / of.r_off;
    if (of.form == 2) F[2] = F[2] - (abs(v) + v) / (2.0 * of.r_on) + (abs(v) - v) / (2.0 * of.r_off);
    F[3] = q - v_rate + u_rate;
  };
  return problem;
}

TEST(JumpsIntoDiodes, DoNotDependOnUnits) {
  RandomNumbers random(36220);
  int named = 0;
  const int trials = sfdae_test::scaled_count(400, 60);
  for (int trial = 0; trial < trials; ++trial) {
    const Circuit circuit = random_circuit(random);
    SCOPED_TRACE("trial " + std::to_string(trial) + ", form " + std::to_string(circuit.form));
    sfdae::Options options = sfdae_test::solver_options(1e-6, random.integer(0, 1));
    options.atol_vector = {1e-6 * circuit.unit_v, 1e-6 * circuit.unit_u, 1e-6 * circuit.unit_i, 1e-6};
    sfdae::Solver solver(equations_of(circuit), options);
    sfdae::Point point{0.999, {circuit.v0 * circuit.unit_v, 0.0, 0.0, 0.0}, {}};
    try {
      solver.start(point, 1.1);
      solver.advance(1.0 + 1e-12, point);
    } catch (const sfdae::Error&) {
      ++named;
      continue;
    }
    const double expected = circuit.c2 / (circuit.c1 + circuit.c2) * circuit.step;
    const sfdae::Jump jump = solver.last_jump();
    EXPECT_NEAR((jump.after[0] - jump.before[0]) / circuit.unit_v, expected, 1e-5);
  }
  EXPECT_LE(named, trials / 10);
}

}  // namespace
}  // namespace jumps_into_diodes
