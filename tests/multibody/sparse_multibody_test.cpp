// SPDX-License-Identifier: BSD-3-Clause
// Large recorded multibody systems with sparse matrices, beside local coordinates with dense ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "multibody/chain.h"
#include "multibody/multibody_run.h"

namespace {

using sfdae_test::MultibodyForm;
using sfdae_test::MultibodyRun;
using sfdae_test::PendulumChain;
using Vector = std::vector<double>;

constexpr int large = 50;  // links, 250 unknowns: sparse matrices are taken

sfdae_options options_of(int method, double tolerance, int structure = SFDAE_STRUCTURE_AUTOMATIC) {
  sfdae_options options = sfdae_test::multibody_options(tolerance, method);
  options.structure = structure;
  return options;
}

// Every rod has an angle of its own.
Vector bent(int links) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> angle(-1.0, 1.0);
  Vector x(static_cast<std::size_t>(5 * links), 0.0);
  double end[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < static_cast<std::size_t>(links); ++i) {
    const double phi = angle(engine);
    end[0] += std::cos(phi) / links;
    end[1] += std::sin(phi) / links;
    std::copy_n(end, 2, x.begin() + static_cast<std::ptrdiff_t>(2 * i));
  }
  return x;
}

double distance(const Vector& a, const Vector& b, int count) {
  double largest = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
    largest = std::max(largest, std::fabs(a[i] - b[i]));
  return largest;
}

// Errors of each run are some tolerances, and grow with velocities of up to 5.
TEST(SparseMultibody, AgreesWithDenseMatricesWithinTolerances) {
  constexpr double tolerance = 1e-8, end = 0.1;
  const PendulumChain system(large);
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    SCOPED_TRACE(method);
    MultibodyRun dense(system, MultibodyForm::recorded, options_of(method, tolerance, SFDAE_STRUCTURE_OFF)),
        sparse(system, MultibodyForm::recorded, options_of(method, tolerance));
    int status = dense.integrate(0.0, end, bent(large));
    ASSERT_GE(status, 0) << dense.text(status);
    status = sparse.integrate(0.0, end, bent(large));
    ASSERT_GE(status, 0) << sparse.text(status);
    EXPECT_GT(dense.report().partitions, 0);
    EXPECT_EQ(sparse.report().partitions, 0);
    EXPECT_EQ(sparse.values(), dense.values());
    EXPECT_EQ(sparse.report().degrees_of_freedom, large);
    EXPECT_EQ(sparse.report().position_freedom, large);
    EXPECT_EQ(sparse.report().redundant, 0);
    EXPECT_LE(distance(sparse.x, dense.x, 4 * large), 1000.0 * tolerance);
    Vector g(large);
    system.constraints(end, sparse.x.data(), g.data());
    for (const double residual : g) EXPECT_NEAR(residual, 0.0, 1e-10);
  }
}

TEST(SparseMultibody, StartsFromConsistentValuesAsTheyAre) {
  const PendulumChain system(large);
  const Vector given = bent(large);
  MultibodyRun dense(system, MultibodyForm::recorded, options_of(SFDAE_METHOD_BDF, 1e-6, SFDAE_STRUCTURE_OFF)),
      sparse(system, MultibodyForm::recorded, options_of(SFDAE_METHOD_BDF, 1e-6));
  ASSERT_EQ(dense.start(0.0, 1.0, given), SFDAE_OK);
  ASSERT_EQ(sparse.start(0.0, 1.0, given), SFDAE_OK);
  EXPECT_EQ(sparse.report().partitions, 0);
  EXPECT_LE(distance(sparse.x, given, 4 * large), 1e-13);
  // Forces and accelerations are those of the same point.
  const double size = distance(dense.xdot, Vector(dense.xdot.size(), 0.0), 4 * large);
  EXPECT_GT(size, 1.0);
  EXPECT_LE(distance(sparse.x, dense.x, 5 * large), 1e-9 * size);
  EXPECT_LE(distance(sparse.xdot, dense.xdot, 4 * large), 1e-9 * size);
}

// The nearest positions in the metric of the kinetic energy, as with dense matrices.
TEST(SparseMultibody, CorrectsInconsistentValuesAsDenseMatricesDo) {
  const PendulumChain system(large);
  Vector given = bent(large);
  given[7] += 1e-4;
  MultibodyRun dense(system, MultibodyForm::recorded, options_of(SFDAE_METHOD_BDF, 1e-6, SFDAE_STRUCTURE_OFF)),
      sparse(system, MultibodyForm::recorded, options_of(SFDAE_METHOD_BDF, 1e-6));
  EXPECT_EQ(dense.start(0.0, 1.0, given), SFDAE_VALUES_CHANGED);
  EXPECT_EQ(sparse.start(0.0, 1.0, given), SFDAE_VALUES_CHANGED);
  EXPECT_EQ(sparse.report().partitions, 0);
  EXPECT_LE(distance(sparse.x, dense.x, 4 * large), 1e-12);
}

TEST(SparseMultibody, GoesOnFromCheckpointsInEveryBit) {
  const PendulumChain system(large);
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    SCOPED_TRACE(method);
    MultibodyRun first(system, MultibodyForm::recorded, options_of(method, 1e-6)),
        second(system, MultibodyForm::recorded, options_of(method, 1e-6));
    ASSERT_GE(first.integrate(0.0, 0.05, bent(large)), 0);
    std::size_t length = 0;
    ASSERT_EQ(sfdae_get_checkpoint_length(first.solver(), &length), SFDAE_OK);
    Vector checkpoint(length);
    ASSERT_EQ(sfdae_save_checkpoint(first.solver(), checkpoint.data(), length), SFDAE_OK);
    const int status = sfdae_restore_checkpoint(second.solver(), checkpoint.data(), length);
    ASSERT_EQ(status, SFDAE_OK) << second.text(status);
    second.t = first.t;
    ASSERT_GE(first.advance(0.1), 0);
    ASSERT_GE(second.advance(0.1), 0);
    EXPECT_EQ(second.report().partitions, 0);
    EXPECT_EQ(std::memcmp(first.x.data(), second.x.data(), first.x.size() * sizeof(double)), 0);
  }
}

TEST(SparseMultibody, IsForLargeRecordedSystemsOrWhereItIsRequired) {
  const PendulumChain small(5);
  MultibodyRun automatic(small, MultibodyForm::recorded, options_of(SFDAE_METHOD_BDF, 1e-6)),
      required(small, MultibodyForm::recorded, options_of(SFDAE_METHOD_BDF, 1e-6, SFDAE_STRUCTURE_REQUIRED));
  ASSERT_GE(automatic.integrate(0.0, 0.1, bent(5)), 0);
  EXPECT_GT(automatic.report().partitions, 0);
  ASSERT_GE(required.integrate(0.0, 0.1, bent(5)), 0);
  EXPECT_EQ(required.report().partitions, 0);
  const MultibodyRun callbacks(small, MultibodyForm::callbacks,
                               options_of(SFDAE_METHOD_BDF, 1e-6, SFDAE_STRUCTURE_REQUIRED));
  EXPECT_EQ(callbacks.created, SFDAE_ILLEGAL_ARGUMENT);
}

// Forces between all masses.
struct AttractingChain : PendulumChain {
  using PendulumChain::PendulumChain;
  template <class V>
  void force(const V& t, const V* q, const V* v, V* f) const {
    PendulumChain::force(t, q, v, f);
    for (int i = 0; i < links; ++i)
      for (int j = 0; j < links; ++j) {
        if (i == j) continue;
        const V dx = q[2 * j] - q[2 * i], dy = q[2 * j + 1] - q[2 * i + 1];
        const V strength = 1.0 / (dx * dx + dy * dy + 1.0);
        f[2 * i] = f[2 * i] + dx * strength;
        f[2 * i + 1] = f[2 * i + 1] + dy * strength;
      }
  }
};

TEST(SparseMultibody, IsNotForFullMatrices) {
  const AttractingChain system(large);
  MultibodyRun run(system, MultibodyForm::recorded, options_of(SFDAE_METHOD_BDF, 1e-6));
  ASSERT_EQ(run.start(0.0, 1.0, bent(large)), SFDAE_OK);
  EXPECT_GT(run.report().partitions, 0);
}

// The first constraint is there twice: only dense matrices know what to do.
struct ChainWithRedundantRod : PendulumChain {
  explicit ChainWithRedundantRod(int its_links) : PendulumChain(its_links) { ++sizes.holonomic; }
  template <class V>
  void constraints(const V& t, const V* q, V* g) const {
    PendulumChain::constraints(t, q, g);
    g[links] = g[0] * 2.0;
  }
};

TEST(SparseMultibody, LeavesRedundantConstraintsToDenseMatrices) {
  const ChainWithRedundantRod system(large);
  MultibodyRun run(system, MultibodyForm::recorded, options_of(SFDAE_METHOD_BDF, 1e-6));
  const int status = run.start(0.0, 1.0, bent(large));
  ASSERT_GE(status, 0) << run.text(status);
  EXPECT_EQ(run.report().redundant, 1);
  EXPECT_GT(run.report().partitions, 0);
}

}  // namespace
