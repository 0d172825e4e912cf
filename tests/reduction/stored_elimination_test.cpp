// SPDX-License-Identifier: BSD-3-Clause
// A stored elimination does to new right-hand sides what the elimination did to its own, and recovers y.
#include "reduction/stored_elimination.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "matrix_checks.h"
#include "random_taylor_data.h"
#include "reduction/elimination.h"

namespace sfdae::core {

namespace {

using sfdae_test::column;
using sfdae_test::distance;
using sfdae_test::largest;
using sfdae_test::random_taylor_data;
using sfdae_test::random_vector;
using sfdae_test::rounding;
using sfdae_test::size;
using sfdae_test::times;

struct Stored {
  Arena arena;
  Judge::Settings settings{0.0, false, NoiseModel::pivots, nullptr};
  Judge judge;
  StoredElimination store;
  Carried carried;

  Stored(const TaylorData& data, int level)
      : judge(data, level, settings, nullptr),
        carried(eliminate(data, level, data.f_stack(level), 1, judge, arena, &store)) {}
  // Multipliers up to 100, and errors eps |data| / p of null vectors.
  double tolerance(const TaylorData& data, int level) const {
    return rounding((level + 1) * (data.m + data.n)) * 100.0 * std::max(1.0, data.norm(level)) /
           judge.smallest_pivot();
  }
};

// Row `to` of all coefficients becomes twice row `from`: v = 1.
void repeat_row(int from, int to, TaylorData& data) {
  for (int k = 0; k <= data.orders.E; ++k)
    for (int j = 0; j < data.n; ++j) {
      data.E(k)(to, j) = 2.0 * data.E(k)(from, j);
      data.A(k)(to, j) = 2.0 * data.A(k)(from, j);
    }
  data.measure();
}

// E_0 = diag(1, ..., 1, p, 0, ..., 0): multipliers are about 1 / p, beyond 100 reflections take their place.
TaylorData data_with_small_pivot(int n, int level, double p, std::uint64_t seed) {
  TaylorData data = random_taylor_data(n, n, level, n, seed);
  fill(data.E(0), 0.0);
  for (int i = 0; i < n - n / 3; ++i) data.E(0)(i, i) = 1.0;
  data.E(0)(n - n / 3 - 1, n - n / 3 - 1) = p;
  data.measure();
  return data;
}

struct StoredCase {
  std::string name;
  TaylorData data;
  int level;
};

std::vector<StoredCase> stored_cases() {
  struct Shape {
    int m, n, rank;
  };
  std::vector<StoredCase> all;
  // 12 unknowns are the most whose equations are solved for y beforehand.
  for (const Shape s : {Shape{1, 1, 0},
                        {1, 1, 1},
                        {3, 5, 2},
                        {5, 3, 2},
                        {4, 4, 0},
                        {4, 4, 4},
                        {6, 6, 3},
                        {12, 12, 7},
                        {13, 13, 7},
                        {20, 20, 20},
                        {10, 16, 6},
                        {16, 11, 6},
                        {17, 14, 0}})
    for (int level : {0, 1, 2, 4})
      for (std::uint64_t seed : {1u, 2u}) {
        const std::string name = std::to_string(s.m) + " x " + std::to_string(s.n) + ", rank " +
                                 std::to_string(s.rank) + ", level " + std::to_string(level);
        all.push_back({name, random_taylor_data(s.m, s.n, level, s.rank, seed), level});
        if (s.m < 3) continue;
        all.push_back({name + ", redundant", all.back().data, level});
        repeat_row(0, s.m - 1, all.back().data);
      }
  for (int n : {6, 12, 13, 18})
    for (double p : {0.5, 1e-3, 1e-5})
      for (int level : {1, 2, 3})
        all.push_back(
            {"n = " + std::to_string(n) + ", pivot " + std::to_string(p) + ", level " + std::to_string(level),
             data_with_small_pivot(n, level, p, 7), level});
  return all;
}

}  // namespace

TEST(StoredElimination, TransformsAsTheEliminationDoes) {
  for (const StoredCase& c : stored_cases()) {
    SCOPED_TRACE(c.name);
    Stored stored(c.data, c.level);
    const int rows = (c.level + 1) * c.data.m;
    ASSERT_EQ(stored.store.carried_rows(), stored.carried.rows);
    ASSERT_EQ(stored.store.level(), c.level);
    const std::vector<double> other = random_vector(rows, 99);
    std::vector<double> own_hat(size(rows)), other_hat(size(rows));
    stored.store.transform(c.data.f(0), own_hat.data(), stored.arena);
    stored.store.transform(other.data(), other_hat.data(), stored.arena);
    Judge judge(c.data, c.level, stored.settings, nullptr);
    Arena arena;
    const Matrix rhs = column(other);
    const Carried again = eliminate(c.data, c.level, rhs, 1, judge, arena);
    ASSERT_EQ(again.rows, stored.carried.rows);
    const double tolerance = stored.tolerance(c.data, c.level);
    for (int i = 0; i < again.rows; ++i) {
      EXPECT_NEAR(own_hat[size(i)], stored.carried.rhs(i, 0), tolerance) << i;
      EXPECT_NEAR(other_hat[size(i)], again.rhs(i, 0), tolerance) << i;
    }
  }
}

// f := M y - N x for any x and y: then A^ x + f^ = 0, and what is recovered for x solves M y = N x + f.
TEST(StoredElimination, RecoversDerivativesOfEveryConsistentX) {
  for (const StoredCase& c : stored_cases()) {
    SCOPED_TRACE(c.name);
    Stored stored(c.data, c.level);
    const int n = c.data.n, rows = (c.level + 1) * c.data.m, last = (c.level + 1) * n;
    const Matrix array = taylor_array(c.data, c.level);
    const ConstView M = array.view().columns(0, last), N = array.view().columns(last, n);
    const std::vector<double> x = random_vector(n, 5), some_y = random_vector(last, 6);
    const Matrix f = sfdae_test::sum(1.0, times(M, column(some_y)), -1.0, times(N, column(x)));
    std::vector<double> f_hat(size(rows)), y(size(last), 7.0);
    stored.store.transform(f.data(), f_hat.data(), stored.arena);
    const Matrix left = times(stored.carried.constraints, column(x));
    for (int i = 0; i < stored.carried.rows; ++i)
      EXPECT_NEAR(left(i, 0) + f_hat[size(i)], 0.0, n * stored.tolerance(c.data, c.level)) << i;
    stored.store.recover(c.data, {f.data(), f_hat.data()}, x.data(), y.data(), stored.arena);
    const Matrix right = sfdae_test::sum(1.0, times(N, column(x)), 1.0, f);
    EXPECT_LE(distance(times(M, column(y)), right),
              n * stored.tolerance(c.data, c.level) * std::max(1.0, largest(y)));
  }
}

// As many components as the kernel of M has dimensions stay 0; those determined by random data do not vanish.
TEST(StoredElimination, LeavesComponentsZeroThatNothingDetermines) {
  for (const StoredCase& c : stored_cases()) {
    SCOPED_TRACE(c.name);
    Stored stored(c.data, c.level);
    const int rows = (c.level + 1) * c.data.m, unknowns = (c.level + 1) * c.data.n;
    const std::vector<double> f = random_vector(rows, 3), x = random_vector(c.data.n, 4);
    std::vector<double> f_hat(size(rows)), y(size(unknowns), 7.0);
    stored.store.transform(f.data(), f_hat.data(), stored.arena);
    stored.store.recover(c.data, {f.data(), f_hat.data()}, x.data(), y.data(), stored.arena);
    EXPECT_EQ(std::count(y.begin(), y.end(), 0.0), unknowns - (rows - stored.carried.rows));
  }
}

// One object serves eliminations of other sizes, levels and branches one after the other.
TEST(StoredElimination, KeepsNothingOfAnEarlierElimination) {
  Arena arena;
  StoredElimination used;
  const Judge::Settings settings{0.0, false, NoiseModel::pivots, nullptr};
  std::vector<TaylorData> sequence;
  sequence.push_back(data_with_small_pivot(9, 2, 1e-4, 3));
  sequence.push_back(random_taylor_data(4, 5, 1, 2, 8));
  sequence.push_back(random_taylor_data(20, 20, 2, 9, 8));
  sequence.push_back(random_taylor_data(6, 6, 2, 6, 8));
  for (const TaylorData& data : sequence) {
    const int level = data.orders.E, rows = (level + 1) * data.m;
    Stored fresh(data, level);
    Judge judge(data, level, settings, nullptr);
    eliminate(data, level, data.f_stack(level), 1, judge, arena, &used);
    const std::vector<double> f = random_vector(rows, 3), x = random_vector(data.n, 4);
    std::vector<double> y[2];
    StoredElimination* stores[] = {&fresh.store, &used};
    for (int i = 0; i < 2; ++i) {
      std::vector<double> f_hat(size(rows));
      y[i].resize(size((level + 1) * data.n));
      stores[i]->transform(f.data(), f_hat.data(), arena);
      stores[i]->recover(data, {f.data(), f_hat.data()}, x.data(), y[i].data(), arena);
    }
    EXPECT_EQ(y[0], y[1]) << data.n;
  }
}

}  // namespace sfdae::core
