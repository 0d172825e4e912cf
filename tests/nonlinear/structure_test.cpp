// SPDX-License-Identifier: BSD-3-Clause
// What the structure proposes to differentiate: the same answers as with the whole array, also where it misleads.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "checkpoint_of.h"
#include "family_run.h"
#include "nonlinear_examples.h"
#include "nonlinear_run.h"
#include "sparse_run.h"

namespace sfdae_test {

namespace {

struct StructureFound {
  sfdae_structure summary;
  std::vector<int> differentiations, orders, assigned, block;
  int status;
};

StructureFound structure_of(NonlinearRun& run, int n) {
  const std::size_t count = static_cast<std::size_t>(n);
  StructureFound found{
      {}, std::vector<int>(count), std::vector<int>(count), std::vector<int>(count), std::vector<int>(count), 0};
  sfdae_structure_init(&found.summary, sizeof found.summary);
  found.status = sfdae_get_structure(run.solver(), &found.summary, found.differentiations.data(), found.orders.data(),
                                     found.assigned.data(), found.block.data());
  return found;
}

}  // namespace

TEST(Structure, GivesTheAnswersOfTheWholeArray) {
  const int count = scaled_count(5000);
  int followed = 0, misled = 0, plain_certified = 0;
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    const SparseSystem system(static_cast<unsigned>(trial + 1),
                              trial % 2 == 1 ? SparseSystem::Mixing::any : SparseSystem::Mixing::none);
    NonlinearRun with(equations_of(system), options_of(SFDAE_STRUCTURE_AUTOMATIC)),
        without(equations_of(system), options_of(SFDAE_STRUCTURE_OFF));
    const std::vector<double> start = system.exact(0.2);
    ASSERT_EQ(without.analyze(0.2, 1.0, start), SFDAE_OK) << without.message();
    ASSERT_EQ(with.analyze(0.2, 1.0, start), SFDAE_OK) << with.message();
    EXPECT_EQ(without.values(), system.values());
    EXPECT_EQ(with.values(), system.values());
    const StructureFound found = structure_of(with, system.n());
    ASSERT_EQ(found.status, SFDAE_OK);
    if (found.summary.verdict == SFDAE_STRUCTURE_CERTIFIED) {
      EXPECT_EQ(found.summary.freedom, system.values().d);
      EXPECT_GE(found.summary.index_bound, system.values().mu);
    } else {
      EXPECT_EQ(found.summary.is_followed, 0);
      ++misled;
    }
    followed += found.summary.is_followed;
    if (trial % 2 == 0) plain_certified += found.summary.verdict == SFDAE_STRUCTURE_CERTIFIED ? 1 : 0;
  }
  EXPECT_GT(followed, count / 8);
  EXPECT_GT(misled, count / 8);
  // Without mixing, numbers cancel only where factors vanish along the chosen solution.
  EXPECT_GT(plain_certified, 0.45 * count);
}

TEST(Structure, ItsIntegrationsAreAsAccurate) {
  const int count = scaled_count(400);
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    const SparseSystem system(static_cast<unsigned>(trial + 70001),
                              trial % 2 == 1 ? SparseSystem::Mixing::any : SparseSystem::Mixing::none);
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      NonlinearRun run(equations_of(system), options_of(SFDAE_STRUCTURE_AUTOMATIC, method));
      ASSERT_EQ(run.integrate(0.2, 1.5, system.exact(0.2)), SFDAE_OK) << run.message();
      EXPECT_LT(error_in_tolerances(run.x, system.exact(1.5)), 10.0);
    }
  }
}

TEST(Structure, OfThePendulumIsKnownBeforeAndCertifiedAfterTheStart) {
  NonlinearRun run({5, 5, pendulum_equations}, options_of(SFDAE_STRUCTURE_AUTOMATIC));
  StructureFound found = structure_of(run, 5);
  ASSERT_EQ(found.status, SFDAE_OK);
  EXPECT_EQ(found.summary.has_assignment, 1);
  EXPECT_EQ(found.differentiations, (std::vector<int>{1, 1, 0, 0, 2}));
  EXPECT_EQ(found.orders, (std::vector<int>{2, 2, 1, 1, 0}));
  EXPECT_EQ(found.summary.freedom, 2);
  EXPECT_EQ(found.summary.index_bound, 2);
  EXPECT_EQ(found.summary.num_blocks, 1);
  EXPECT_EQ(found.summary.largest_block, 5);
  EXPECT_EQ(found.summary.verdict, SFDAE_STRUCTURE_UNCHECKED);
  EXPECT_EQ(found.summary.is_followed, 0);
  ASSERT_GE(run.integrate(0.0, 1.0, {0.6, -0.8, 0.0, 0.0, 0.0}), 0) << run.message();
  found = structure_of(run, 5);
  EXPECT_EQ(found.summary.verdict, SFDAE_STRUCTURE_CERTIFIED);
  EXPECT_EQ(found.summary.is_followed, 1);
  EXPECT_GT(found.summary.smallest_pivot, 0.05);
  EXPECT_EQ(found.summary.doubtful_block, -1);
}

// Where the counts are the user's, they are followed.
TEST(Structure, IsLeftAloneWhereCountsAreGiven) {
  NonlinearEquations equations{5, 5, pendulum_equations};
  equations.differentiations = {2, 2, 2, 2, 2};
  NonlinearRun run(equations, options_of(SFDAE_STRUCTURE_AUTOMATIC));
  ASSERT_GE(run.start(0.0, 1.0, {0.6, -0.8, 0.0, 0.0, 0.0}), 0);
  EXPECT_EQ(structure_of(run, 5).summary.is_followed, 0);
}

// The counts of the structure given by the user make the same array: the same results to the last bit.
TEST(Structure, DoesWhatItsCountsDo) {
  const std::vector<double> start = {0.6, -0.8, 0.0, 0.0, 0.0};
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    NonlinearEquations counted{5, 5, pendulum_equations};
    counted.differentiations = {1, 1, 0, 0, 2};
    NonlinearRun proposed({5, 5, pendulum_equations}, options_of(SFDAE_STRUCTURE_AUTOMATIC, method)),
        given(counted, options_of(SFDAE_STRUCTURE_OFF, method));
    ASSERT_GE(proposed.integrate(0.0, 2.0, start), 0) << proposed.message();
    ASSERT_GE(given.integrate(0.0, 2.0, start), 0) << given.message();
    EXPECT_EQ(structure_of(proposed, 5).summary.is_followed, 1);
    EXPECT_EQ(proposed.x, given.x);
    EXPECT_EQ(proposed.statistics().evaluations_F, given.statistics().evaluations_F);
  }
}

// Pryce's chain of pendula: strangeness index 2 P.
TEST(Structure, ReachesIndexTen) {
  constexpr int pendula = 5, n = 5 * pendula;
  NonlinearEquations chain{
      n, n, [](sfdae_record*, const Expression&, const Expression* x, const Expression* xdot, Expression* F) {
        for (int b = 0; b < n; b += 5) {
          F[b] = xdot[b] - x[b + 2];
          F[b + 1] = xdot[b + 1] - x[b + 3];
          F[b + 2] = xdot[b + 2] + x[b + 4] * x[b];
          F[b + 3] = xdot[b + 3] + x[b + 4] * x[b + 1] + 1.0;
          const Expression length = b == 0 ? Expression(1.0) : 1.0 + 0.1 * x[b - 1];
          F[b + 4] = x[b] * x[b] + x[b + 1] * x[b + 1] - length * length;
        }
      }};
  sfdae_options options = options_of(SFDAE_STRUCTURE_AUTOMATIC);
  options.max_index = 12;
  NonlinearRun run(chain, options);
  std::vector<double> start(n);
  for (std::size_t b = 0; b < n; b += 5) start[b] = 1.0;
  ASSERT_GE(run.integrate(0.0, 1.0, start), 0) << run.message();
  EXPECT_EQ(run.values(), (CharacteristicValues{10, 10, 15, 0, 0}));
  const StructureFound found = structure_of(run, n);
  EXPECT_EQ(found.summary.is_followed, 1);
  EXPECT_EQ(found.summary.num_blocks, pendula);
  // Every pendulum needs those before it, which determine the length of its rod.
  for (std::size_t i = 5; i < n; ++i) EXPECT_GT(found.block[i], found.block[i - 5]);
  // The first one does not know of the others: its energy is kept.
  EXPECT_NEAR(0.5 * (run.x[2] * run.x[2] + run.x[3] * run.x[3]) + run.x[1], 0.0, 1e-4);
}

// Both equations contain x0' and x1', but only their sum.
TEST(Structure, MisleadsWhereNumbersCancel) {
  NonlinearRun run(
      {3, 3,
       [](sfdae_record*, const Expression& t, const Expression* x, const Expression* xdot, Expression* F) {
         F[0] = x[2] - x[0] * x[1];
         F[1] = xdot[0] + xdot[1] + x[0] - t;
         F[2] = 2.0 * xdot[0] + 2.0 * xdot[1] + x[0] * x[0] + x[1] - 2.0 * t;
       }},
      options_of(SFDAE_STRUCTURE_AUTOMATIC));
  ASSERT_GE(run.start(0.0, 1.0, {0.1, 0.19, 0.019}), 0) << run.message();
  EXPECT_EQ(run.values(), (CharacteristicValues{0, 1, 2, 0, 0}));
  const StructureFound found = structure_of(run, 3);
  EXPECT_EQ(found.summary.verdict, SFDAE_STRUCTURE_MISLEADS);
  EXPECT_EQ(found.summary.is_followed, 0);
  EXPECT_EQ(found.summary.smallest_pivot, 0.0);
  EXPECT_NE(run.message().find("Numbers cancel"), std::string::npos) << run.message();
  EXPECT_NE(run.message().find("equation 1"), std::string::npos) << run.message();
}

TEST(Structure, NamesEquationsThatAreTooMany) {
  NonlinearRun run(
      {3, 3,
       [](sfdae_record*, const Expression& t, const Expression* x, const Expression* xdot, Expression* F) {
         F[0] = xdot[0] * xdot[0] - t;
         F[1] = xdot[1] + x[2] * x[0];
         F[2] = x[0] * x[0] - 1.0;
       }},
      options_of(SFDAE_STRUCTURE_AUTOMATIC));
  const StructureFound found = structure_of(run, 3);
  ASSERT_EQ(found.status, SFDAE_OK);
  EXPECT_EQ(found.summary.has_assignment, 0);
  EXPECT_EQ(found.block, (std::vector<int>{0, -1, 0}));
  EXPECT_EQ(found.orders, (std::vector<int>{0, -1, -1}));
  EXPECT_EQ(found.assigned, (std::vector<int>{-1, -1, -1}));
  EXPECT_NE(run.message().find("2 equations contain x[0] only: equation 0, equation 2"), std::string::npos)
      << run.message();
}

// Also after a failure, which they explain better than its own words do.
TEST(Structure, NamesThemAfterAFailureToo) {
  NonlinearRun run(
      {3, 3,
       [](sfdae_record*, const Expression& t, const Expression* x, const Expression* xdot, Expression* F) {
         F[0] = xdot[0] + x[0] - t;
         F[1] = xdot[1] + x[2] * x[0];
         F[2] = x[0] * x[0] - 1.0;
       }},
      options_of(SFDAE_STRUCTURE_AUTOMATIC));
  ASSERT_LT(run.start(0.0, 1.0, {0.5, 0.0, 0.0}), 0);
  const StructureFound found = structure_of(run, 3);
  ASSERT_EQ(found.status, SFDAE_OK);
  EXPECT_EQ(found.summary.has_assignment, 0);
  EXPECT_NE(run.message().find("2 equations contain x[0] only: equation 0, equation 2"), std::string::npos)
      << run.message();
}

// x0' = cos t x1: where cos t = 0 the derivative of row 0 determines x1, which the chain of index 3 makes part of the
// array, and which structure leaves out.
TEST(Structure, IsNamedWhereRowsLeftOutAreNeeded) {
  for (int structure : {SFDAE_STRUCTURE_OFF, SFDAE_STRUCTURE_AUTOMATIC}) {
    NonlinearRun run(
        {5, 5,
         [](sfdae_record*, const Expression& t, const Expression* x, const Expression* xdot, Expression* F) {
           F[0] = xdot[0] - cos(t) * x[1];
           F[1] = x[0] - sin(t);
           F[2] = xdot[2] - x[3];
           F[3] = xdot[3] - x[4];
           F[4] = x[2] + 0.1 * x[2] * x[2] * x[2] - sin(t);
         }},
        options_of(structure));
    ASSERT_GE(run.start(0.2, 4.0, {0.2, 1.0, 0.2, 1.0, 0.0}), SFDAE_OK);
    const bool is_followed = structure_of(run, 5).summary.is_followed == 1;
    EXPECT_EQ(is_followed, structure == SFDAE_STRUCTURE_AUTOMATIC);
    const int status = run.advance(std::acos(0.0));
    EXPECT_EQ(status, is_followed ? SFDAE_CHARACTERISTICS_CHANGED : SFDAE_OK);
    EXPECT_EQ(run.message().find("structure = SFDAE_STRUCTURE_OFF") != std::string::npos, is_followed);
  }
}

// 1 / 1e-310 is infinite.
TEST(Structure, IsCertifiedWhereEntriesAreTiny) {
  NonlinearRun run({3, 3,
                    [](sfdae_record*, const Expression&, const Expression* x, const Expression* xdot, Expression* F) {
                      F[0] = xdot[0] - sin(x[1]);
                      F[1] = 1e-310 * (x[0] - 0.5 * x[1] + 0.3 * x[2]);
                      F[2] = 1e-310 * (x[1] + x[2]);
                    }},
                   options_of(SFDAE_STRUCTURE_AUTOMATIC));
  ASSERT_EQ(run.start(0.0, 1.0, {0.0, 0.0, 0.0}), SFDAE_OK);
  EXPECT_EQ(structure_of(run, 3).summary.verdict, SFDAE_STRUCTURE_CERTIFIED);
}

// Where there is nothing to say of the structure, words that explain a failure stay.
TEST(Structure, LeavesWordsOfFailuresWhereItHasNone) {
  NonlinearRun run({1, 1,
                    [](sfdae_record*, const Expression&, const Expression* x, const Expression* xdot, Expression* F) {
                      F[0] = xdot[0] - log(x[0]);
                    }},
                   options_of(SFDAE_STRUCTURE_AUTOMATIC));
  ASSERT_EQ(run.start(0.0, 1.0, {-1.0}), SFDAE_NOT_FINITE);
  const std::string words = run.message();
  const StructureFound found = structure_of(run, 1);
  ASSERT_EQ(found.status, SFDAE_OK);
  EXPECT_EQ(found.summary.has_assignment, 1);
  EXPECT_EQ(run.message(), words);
  ASSERT_EQ(sfdae_get_structure(run.solver(), nullptr, nullptr, nullptr, nullptr, nullptr), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(run.message(), words);
}

TEST(Structure, NamesASingleEquationWithoutUnknowns) {
  NonlinearRun run(
      {2, 2,
       [](sfdae_record*, const Expression& t, const Expression* x, const Expression* xdot, Expression* F) {
         F[0] = xdot[0] - x[1];
         F[1] = t;
       }},
      options_of(SFDAE_STRUCTURE_AUTOMATIC));
  ASSERT_EQ(structure_of(run, 2).status, SFDAE_OK);
  EXPECT_EQ(
      run.message(),
      "equation 1 contains no unknown. It is contradictory or redundant, and other unknowns are not determined.");
}

// The rows of arrays that users see are all there, and projectors fit them: Z2^T M = 0, Z2^T N T2 = 0.
TEST(Structure, LeavesArraysOfTheTheoryAsTheyAre) {
  constexpr int rows = 15, n = 5, a = 3, d = 2;
  NonlinearRun run({n, n, pendulum_equations}, options_of(SFDAE_STRUCTURE_AUTOMATIC));
  ASSERT_GE(run.start(0.0, 1.0, {0.6, -0.8, 0.0, 0.0, 0.0}), 0);
  ASSERT_EQ(structure_of(run, n).summary.is_followed, 1);
  std::vector<double> jet(n * 4), M(rows * rows), N(rows * n), g(rows), Z1(n * d), Z2(rows * a), T2(n * d);
  ASSERT_EQ(sfdae_get_jet(run.solver(), 0.0, run.x.data(), 2, jet.data()), SFDAE_OK) << run.message();
  ASSERT_EQ(sfdae_get_derivative_array_at(run.solver(), 0.0, jet.data(), 2, M.data(), N.data(), g.data()), SFDAE_OK);
  ASSERT_EQ(sfdae_get_projectors_at(run.solver(), 0.0, jet.data(), Z1.data(), Z2.data(), nullptr, T2.data(), nullptr),
            SFDAE_OK)
      << run.message();
  const auto at = [](const std::vector<double>& matrix, int i, int j, int ld) {
    return matrix[static_cast<std::size_t>(i + j * ld)];
  };
  for (int i = 0; i < rows; ++i) {
    double largest = 0.0;
    for (int j = 0; j < rows; ++j) largest = std::max(largest, std::fabs(at(M, i, j, rows)));
    for (int j = 0; j < n; ++j) largest = std::max(largest, std::fabs(at(N, i, j, rows)));
    EXPECT_GT(largest, 0.1) << i;
  }
  for (int k = 0; k < a; ++k) {
    std::vector<double> of_N(n);
    for (int j = 0; j < rows; ++j) {
      double sum = 0.0;
      for (int i = 0; i < rows; ++i) sum += at(Z2, i, k, rows) * at(M, i, j, rows);
      EXPECT_NEAR(sum, 0.0, 1e-10);
    }
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < rows; ++i) of_N[static_cast<std::size_t>(j)] += at(Z2, i, k, rows) * at(N, i, j, rows);
    for (int c = 0; c < d; ++c) {
      double sum = 0.0;
      for (int j = 0; j < n; ++j) sum += of_N[static_cast<std::size_t>(j)] * at(T2, j, c, n);
      EXPECT_NEAR(sum, 0.0, 1e-10);
    }
  }
}

TEST(Structure, GoesOnFromCheckpointsInEveryBit) {
  const sfdae_options options = options_of(SFDAE_STRUCTURE_AUTOMATIC);
  NonlinearRun first({5, 5, pendulum_equations}, options), second({5, 5, pendulum_equations}, options);
  ASSERT_GE(first.integrate(0.0, 0.5, {0.6, -0.8, 0.0, 0.0, 0.0}), 0);
  const std::vector<double> checkpoint = checkpoint_of(first.solver());
  ASSERT_EQ(sfdae_restore_checkpoint(second.solver(), checkpoint.data(), checkpoint.size()), SFDAE_OK)
      << second.message();
  EXPECT_EQ(structure_of(second, 5).summary.is_followed, 1);
  second.x.resize(5);
  ASSERT_GE(first.advance(2.0), 0);
  ASSERT_GE(second.advance(2.0), 0) << second.message();
  EXPECT_EQ(std::memcmp(first.x.data(), second.x.data(), 5 * sizeof(double)), 0);
}

}  // namespace sfdae_test
