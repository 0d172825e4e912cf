// SPDX-License-Identifier: BSD-3-Clause
// What is left for the states of all stages, with pairs of them eliminated and without.
#include "extension/coupled_states.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "integrate/radau_method.h"
#include "linalg/random.h"

namespace sfdae::core {

namespace {

using Pair = CoupledStates::Pair;

// Entries of B_i, unit vectors in the rows of the first states of pairs.
class RandomSlopes {
 public:
  RandomSlopes(int s, int d, const std::vector<Pair>& pairs) : d_(d), entries_(index(s * d * d)) {
    std::minstd_rand generator(3);
    for (double& entry : entries_) entry = 5.0 * symmetric_random(generator);
    for (const Pair& pair : pairs)
      for (int i = 0; i < s; ++i)
        for (int b = 0; b < d; ++b) entries_[index((i * d + pair.a) * d + b)] = b == pair.b ? 1.0 : 0.0;
  }
  double operator()(int a, int b, int i) const { return entries_[index((i * d_ + a) * d_ + b)]; }

 private:
  int d_;
  std::vector<double> entries_;
};

struct Case {
  int s, d;
  std::vector<Pair> pairs;
};

// sum_k D_ik / h z_k - B_i z_i - w_i, the largest one.
double largest_residual(const Case& of, double h, const RandomSlopes& B, const std::vector<double>& z,
                        const std::vector<double>& w) {
  const StageMethod& method = radau_method(of.s).stages;
  double largest = 0.0;
  for (int i = 0; i < of.s; ++i)
    for (int a = 0; a < of.d; ++a) {
      double r = -w[index(i * of.d + a)];
      for (int k = 0; k < of.s; ++k) r += method.D_at(i, k) / h * z[index(k * of.d + a)];
      for (int b = 0; b < of.d; ++b) r -= B(a, b, i) * z[index(i * of.d + b)];
      largest = std::fmax(largest, std::fabs(r));
    }
  return largest;
}

void solve(CoupledStates& states, std::vector<double>& z) {
  std::copy(z.begin(), z.end(), states.right());
  states.solve();
  std::copy_n(states.right(), z.size(), z.begin());
}

TEST(CoupledStates, AreTheSameWithoutPairs) {
  const double h = 0.1;
  const std::vector<Case> cases = {{3, 1, {}},
                                   {3, 2, {{0, 1}}},
                                   {5, 4, {{2, 0}, {1, 3}}},
                                   {5, 5, {{4, 1}}},
                                   {7, 3, {{1, 2}}},
                                   {3, 6, {}},
                                   {5, 16, {{0, 8}, {1, 9}, {2, 10}, {15, 3}}}};
  CoupledStates of_all, condensed;
  for (const Case& of : cases) {
    SCOPED_TRACE(testing::Message() << of.s << " stages, " << of.d << " states");
    const StageMethod& method = radau_method(of.s).stages;
    const RandomSlopes B(of.s, of.d, of.pairs);
    std::minstd_rand generator(5);
    std::vector<double> w(index(of.s * of.d));
    for (double& entry : w) entry = symmetric_random(generator);
    std::vector<double> z = w, same = w;
    ASSERT_TRUE(of_all.factor(method, h, of.d, B));
    solve(of_all, z);
    EXPECT_EQ(of_all.size(), of.s * of.d);
    condensed.set_pairs(of.d, of.pairs);
    ASSERT_TRUE(condensed.factor_condensed(
        method, h, [&](int c, int b, int i) { return B(condensed.equations()[index(c)], b, i); }));
    solve(condensed, same);
    EXPECT_EQ(condensed.size(), of.s * (of.d - static_cast<int>(of.pairs.size())));
    // Terms are of the size of D / h.
    EXPECT_LE(largest_residual(of, h, B, z, w), 1e-11);
    EXPECT_LE(largest_residual(of, h, B, same, w), 1e-11);
  }
}

TEST(CoupledStates, NoteThatTheyAreSingular) {
  CoupledStates states;
  states.set_pairs(2, {{0, 1}});
  EXPECT_FALSE(states.factor_condensed(radau_method(3).stages, HUGE_VAL, [](int, int, int) { return 0.0; }));
}

}  // namespace

}  // namespace sfdae::core
