// SPDX-License-Identifier: BSD-3-Clause
// Memory that large recorded problems hold in steps (docs/design/memory.md).
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "nonlinear_run.h"
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace {

using namespace sfdae_test;

// Of the heap of this program, in bytes. 0 where the C library does not tell: sanitizers have a heap of their own.
double in_use() {
#if defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 33)
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
#else
  return 0.0;
#endif
}

bool is_told() {
  const double before = in_use();
  static const std::vector<double> some(100000);
  return in_use() - before >= 8.0 * static_cast<double>(some.size());
}

// Reaction and diffusion of two substances on a line; u, v of each cell follow each other.
NonlinearEquations brusselator(int cells) {
  return equations_of(2 * cells, 2 * cells, [cells](const auto&, const auto* x, const auto* xdot, auto* F) {
    const double diffusion = 0.02 * (cells + 1) * (cells + 1);
    for (int i = 0; i < 2 * cells; i += 2) {
      const auto product = x[i] * x[i] * x[i + 1];
      const auto before = [&](int k) { return i == 0 ? sfdae::Expression(k == 0 ? 1.0 : 3.0) : x[i + k - 2]; };
      const auto after = [&](int k) {
        return i + 2 == 2 * cells ? sfdae::Expression(k == 0 ? 1.0 : 3.0) : x[i + k + 2];
      };
      F[i] = xdot[i] - (1.0 + product - 4.0 * x[i] + diffusion * (before(0) - 2.0 * x[i] + after(0)));
      F[i + 1] = xdot[i + 1] - (3.0 * x[i] - product + diffusion * (before(1) - 2.0 * x[i + 1] + after(1)));
    }
  });
}

// In steps of BDF, bytes for each unknown: some 1250 of them. What would be noticed: a decision of the report for
// each of them (80), tolerances one by one (88), second copies of two patterns with their values (44 each).
TEST(Memory, OfLargeRecordedProblemsIsBounded) {
  constexpr int cells = 1500, n = 2 * cells;
  if (!is_told()) GTEST_SKIP() << "the C library does not tell what is in use";
  const double before = in_use();
  sfdae_options options = options_with(1e-6);
  options.structure = SFDAE_STRUCTURE_REQUIRED;
  NonlinearRun run(brusselator(cells), options);
  std::vector<double> guess;
  for (int i = 0; i < cells; ++i) {
    guess.push_back(1.0 + std::sin(2.0 * std::numbers::pi * (i + 1) / (cells + 1)));
    guess.push_back(3.0);
  }
  ASSERT_EQ(run.start(0.0, 1.0, guess), SFDAE_OK) << run.message();
  for (int step = 0; step < 12; ++step)
    ASSERT_EQ(sfdae_step(run.solver(), 1.0, &run.t, run.x.data(), run.xdot.data()), SFDAE_STEP_TAKEN)
        << run.message();
  EXPECT_LT((in_use() - before) / n, 1300.0);
}

}  // namespace
