// SPDX-License-Identifier: BSD-3-Clause
// A listed elimination of several matrices at once: residuals of each, the same bits with every instruction set, and
// pivots that do not serve for one of them.
#include "linalg/planned_lanes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "instruction_sets.h"
#include "linalg/index.h"
#include "linalg/random.h"
#include "sparse_matrices.h"

namespace sfdae::core {

namespace {

using sfdae_test::SparseMatrix;

struct Named {
  std::string name;
  SparseMatrix matrix;
};

std::vector<Named> matrices() {
  return {{"line", sfdae_test::reaction_diffusion(20)},
          {"saddle point", sfdae_test::flow(4)},
          {"arrow", sfdae_test::arrow(30, 2)},
          {"random", sfdae_test::random_sparse(40, 2, 6)},
          {"two", sfdae_test::sparse_matrix(2, {{0, 1, 3.0}, {1, 0, -2.0}})}};
}

// The entries of the matrix, differently changed by up to two percent in each lane.
LaneArray changed(const SparseMatrix& matrix) {
  std::minstd_rand generator(3);
  LaneArray values(matrix.values.size());
  for (std::size_t e = 0; e < values.size(); ++e)
    for (double& value : values[e].lane) value = matrix.values[e] * (1.0 + 0.02 * symmetric_random(generator));
  return values;
}

LaneArray random_columns(std::size_t length) {
  std::minstd_rand generator(5);
  LaneArray columns(length);
  for (LaneBlock& block : columns)
    for (double& value : block.lane) value = symmetric_random(generator);
  return columns;
}

// max |B - A X| relative to max (|B| + |A| |X|) in a lane.
double relative_residual(const SparsePattern& pattern, const LaneArray& values, const LaneArray& b,
                         const LaneArray& x, int lane) {
  const std::size_t n = index(pattern.size);
  double largest = 0.0, size = 0.0;
  for (std::size_t first = 0; first < b.size(); first += n) {
    std::vector<double> r(n), sums(n);
    for (std::size_t i = 0; i < n; ++i) sums[i] = std::fabs(r[i] = b[first + i].lane[lane]);
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t e = index(pattern.first[j]); e < index(pattern.first[j + 1]); ++e) {
        const double term = values[e].lane[lane] * x[first + j].lane[lane];
        r[index(pattern.row[e])] -= term;
        sums[index(pattern.row[e])] += std::fabs(term);
      }
    for (std::size_t i = 0; i < n; ++i) {
      largest = std::max(largest, std::fabs(r[i]));
      size = std::max(size, sums[i]);
    }
  }
  return largest / size;
}

TEST(PlannedLanes, SolveEachSystem) {
  for (const Named& named : matrices())
    for (int count : {1, 2, 3, 4, 7}) {
      const SparsePattern& pattern = named.matrix.pattern;
      const std::size_t length = index(pattern.size) * index(count);
      PlannedLu lu;
      lu.analyze(pattern);
      ASSERT_TRUE(lu.plan(named.matrix.values.data()));
      const LaneArray values = changed(named.matrix), b = random_columns(length);
      LaneArray first;
      sfdae_test::for_each_instruction_set([&](InstructionSet) {
        PlannedLanes lanes;
        LaneArray x(length);
        ASSERT_TRUE(lanes.solve(*lu.list(), values.data(), b.data(), count, x.data())) << named.name;
        // After a refinement rounding errors of the residual are left, times the distance of scaled equations from
        // these.
        for (int l = 0; l < lane_count; ++l)
          EXPECT_LE(relative_residual(pattern, values, b, x, l), 2e-15) << named.name << ", " << count;
        if (first.empty()) first = x;
        for (std::size_t k = 0; k < length; ++k)
          for (int l = 0; l < lane_count; ++l) ASSERT_EQ(x[k].lane[l], first[k].lane[l]) << named.name;
      });
    }
}

TEST(PlannedLanes, RefusePivotsThatVanishForOneOfThem) {
  const SparseMatrix matrix = sfdae_test::sparse_matrix(2, {{0, 0, 1.0}, {0, 1, 0.5}, {1, 0, 0.5}, {1, 1, 1.0}});
  PlannedLu lu;
  lu.analyze(matrix.pattern);
  ASSERT_TRUE(lu.plan(matrix.values.data()));
  const LaneArray b = random_columns(2);
  sfdae_test::for_each_instruction_set([&](InstructionSet) {
    for (double none : {0.0, std::numeric_limits<double>::quiet_NaN()})
      for (int bad = 0; bad < lane_count; ++bad) {
        LaneArray values = changed(matrix), x(2);
        PlannedLanes lanes;
        EXPECT_TRUE(lanes.solve(*lu.list(), values.data(), b.data(), 1, x.data()));
        for (std::size_t e : {0u, 3u}) values[e].lane[bad] = none;
        EXPECT_FALSE(lanes.solve(*lu.list(), values.data(), b.data(), 1, x.data())) << none << ", " << bad;
      }
  });
}

// Tiny pivots lose the rest to rounding, 1e-20 + 1 = 1, which a refinement sometimes finds again: what is not refused
// is right.
TEST(PlannedLanes, RefuseSolutionsOfLargeResiduals) {
  SparseMatrix matrix = sfdae_test::arrow(9, 9);
  std::minstd_rand generator(1);
  const auto entry = [&](std::size_t i, std::size_t j, std::size_t shift, double tiny) {
    return ((i + j) % 9 == shift ? 1.0 : tiny) * (1.0 + 0.3 * symmetric_random(generator));
  };
  int refused = 0;
  for (double tiny : {1e-20, 1e-12, 1e-8}) {
    for (std::size_t e = 0; e < 81; ++e) matrix.values[e] = entry(e % 9, e / 9, 0, tiny);
    PlannedLu lu;
    lu.analyze(matrix.pattern);
    ASSERT_TRUE(lu.plan(matrix.values.data()));
    for (std::size_t shift = 1; shift < 9; ++shift) {
      LaneArray values = changed(matrix), x(18);
      for (std::size_t e = 0; e < 81; ++e) values[e].lane[5] = entry(e % 9, e / 9, shift, tiny);
      const LaneArray b = random_columns(18);
      PlannedLanes lanes;
      if (lanes.solve(*lu.list(), values.data(), b.data(), 2, x.data())) {
        EXPECT_LE(relative_residual(matrix.pattern, values, b, x, 5), refused_residuals) << tiny << ", " << shift;
      } else {
        ++refused;
      }
    }
  }
  EXPECT_GE(refused, 8);
}

}  // namespace

}  // namespace sfdae::core
