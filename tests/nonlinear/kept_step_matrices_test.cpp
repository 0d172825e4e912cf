// SPDX-License-Identifier: BSD-3-Clause
// Steps of large recorded problems: step matrices that are kept, few iterations, and what errors these leave.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "checkpoint_of.h"
#include "sparse_run.h"
#include "system/kept_matrix.h"

namespace sfdae_test {

namespace {

constexpr int n = 120;
constexpr double stiffness = 100.0;

// x_i = 2 + sin(t + i / 10) is a solution by construction.
template <class T>
T exact(const T& t, int i) {
  using std::sin;
  return 2.0 + sin(t + 0.1 * i);
}
template <class T>
T exact_slope(const T& t, int i) {
  using std::cos;
  return cos(t + 0.1 * i);
}

// x_i' = k (x_(i-1) - 2 x_i + x_(i+1)) - x_i^3 + ..., its ends algebraic.
void diffusion(sfdae_record*, const Expression& t, const Expression* x, const Expression* xdot, Expression* F) {
  const auto cube = [](const Expression& a) { return a * a * a; };
  for (int i = 0; i < n; ++i) {
    if (i == 0 || i == n - 1) {
      F[i] = x[i] - exact(t, i);
      continue;
    }
    const Expression of_exact =
        stiffness * (exact(t, i - 1) - 2.0 * exact(t, i) + exact(t, i + 1)) - cube(exact(t, i));
    const Expression of_x = stiffness * (x[i - 1] - 2.0 * x[i] + x[i + 1]) - cube(x[i]);
    F[i] = xdot[i] - exact_slope(t, i) - (of_x - of_exact);
  }
}

std::vector<double> exact_at(double t) {
  std::vector<double> x;
  for (int i = 0; i < n; ++i) x.push_back(exact(t, i));
  return x;
}

}  // namespace

// With matrices that are kept too long iterations become many, with ones that are kept too short factorizations do.
TEST(KeptStepMatrices, TakeFewIterationsAndLeaveNoError) {
  for (const double tol : {1e-4, 1e-6, 1e-8}) {
    SCOPED_TRACE(tol);
    sfdae_options options = options_with(tol, SFDAE_METHOD_BDF);
    options.structure = SFDAE_STRUCTURE_REQUIRED;
    NonlinearRun run({n, n, diffusion}, options);
    ASSERT_TRUE(is_known(run.integrate(0.0, 20.0, exact_at(0.0)))) << run.message();
    const std::vector<double> x = exact_at(run.t);
    for (int i = 0; i < n; ++i) EXPECT_LE(std::fabs(run.x[i] - x[i]), 10.0 * tol * (1.0 + std::fabs(x[i])));
    const sfdae_statistics counts = run.statistics();
    // One of these in each step confirms the last change.
    EXPECT_LE(10 * counts.evaluations_F, 34 * counts.steps);
    EXPECT_LE(counts.factorizations, counts.steps / 3);
  }
}

// What a matrix has cost is a part of a checkpoint.
TEST(KeptStepMatrices, GoOnFromCheckpointsInEveryBit) {
  NonlinearRun first({n, n, diffusion}, options_of(SFDAE_STRUCTURE_REQUIRED)),
      second({n, n, diffusion}, options_of(SFDAE_STRUCTURE_REQUIRED));
  ASSERT_GE(first.start(0.0, 1.0, exact_at(0.0)), 0);
  second.x.resize(n);
  for (const double t : {0.3, 1.0, 2.1, 3.4, 5.0}) {
    ASSERT_GE(first.advance(t), 0) << first.message();
    const std::vector<double> checkpoint = checkpoint_of(first.solver());
    ASSERT_EQ(sfdae_restore_checkpoint(second.solver(), checkpoint.data(), checkpoint.size()), SFDAE_OK)
        << second.message();
    ASSERT_GE(first.advance(t + 5.0), 0);
    ASSERT_GE(second.advance(t + 5.0), 0) << second.message();
    EXPECT_EQ(std::memcmp(first.x.data(), second.x.data(), n * sizeof(double)), 0) << t;
    ASSERT_EQ(sfdae_restore_checkpoint(first.solver(), checkpoint.data(), checkpoint.size()), SFDAE_OK)
        << first.message();
  }
}

// The contraction with the matrix for another c is its deviation, at best: from the gain that is usual follows what
// it takes more.
TEST(KeptStepMatrices, WasteMoreIterationsTheMoreTheyDeviate) {
  using sfdae::core::deviation_of;
  using sfdae::core::iterations_wasted;
  EXPECT_DOUBLE_EQ(deviation_of(3.0, 5.0), 0.25);
  EXPECT_EQ(deviation_of(7.0, 7.0), 0.0);
  EXPECT_EQ(iterations_wasted(0.0), 0.0);
  double before = 0.0;
  for (const double deviation : {0.05, 0.1, 0.15, 0.2, 0.25}) {
    EXPECT_GT(iterations_wasted(deviation), before);
    before = iterations_wasted(deviation);
  }
  EXPECT_LT(before, 4.0);
}

}  // namespace sfdae_test
