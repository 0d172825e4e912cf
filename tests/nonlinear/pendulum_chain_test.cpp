// SPDX-License-Identifier: BSD-3-Clause
// Chains of pendula of any index: what is known of them, or a failure with a name.
#include "pendulum_chain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sparse_run.h"

namespace sfdae_test {

namespace {

using Series = std::vector<long double>;

sfdae_options required(int method = SFDAE_METHOD_BDF) { return options_of(SFDAE_STRUCTURE_REQUIRED, method); }

// The Taylor series of x, y and l of one pendulum, given that of its length, by the equations of motion: order by
// order, with more digits. Of x and y the smaller one is taken as given, of u and v that of the larger one.
class PendulumSeries {
 public:
  // values: x, y, u, v
  PendulumSeries(const Series& radius, const double* values, int order) : order_(order), length_(radius.size()) {
    square(radius);
    for (Series* series : {&x_, &y_, &l_}) series->assign(length_, 0.0L);
    const bool is_steep = std::fabs(values[1]) > std::fabs(values[0]);
    Series &given = is_steep ? x_ : y_, &found = is_steep ? y_ : x_;
    given[0] = values[is_steep ? 0 : 1];
    found[0] = std::copysign(std::sqrt(square_[0] - given[0] * given[0]), values[is_steep ? 1 : 0]);
    given[1] = values[is_steep ? 2 : 3];
    found[1] = (square_[1] / 2.0L - given[0] * given[1]) / found[0];
    for (std::size_t m = 0; m + 2 <= static_cast<std::size_t>(order_); ++m) advance(m);
  }
  const Series& x() const { return x_; }
  const Series& y() const { return y_; }
  const Series& l() const { return l_; }

 private:
  void square(const Series& radius) {
    square_.assign(length_, 0.0L);
    for (std::size_t m = 0; m < length_; ++m)
      for (std::size_t i = 0; i <= m; ++i) square_[m] += radius[i] * radius[m - i];
  }
  // Coefficients m + 2 of x and y, and m of l.
  void advance(std::size_t m) {
    const long double f = static_cast<long double>((m + 1) * (m + 2));
    long double of_x = 0.0L, of_y = m == 0 ? -1.0L : 0.0L, rest = square_[m + 2];
    for (std::size_t i = 0; i < m; ++i) {
      of_x -= l_[i] * x_[m - i];
      of_y -= l_[i] * y_[m - i];
    }
    for (std::size_t i = 1; i < m + 2; ++i) rest -= x_[i] * x_[m + 2 - i] + y_[i] * y_[m + 2 - i];
    l_[m] = (2.0L * (x_[0] * of_x + y_[0] * of_y) - rest * f) / (2.0L * (x_[0] * x_[0] + y_[0] * y_[0]));
    x_[m + 2] = (of_x - l_[m] * x_[0]) / f;
    y_[m + 2] = (of_y - l_[m] * y_[0]) / f;
  }

  int order_;
  std::size_t length_;
  Series square_, x_, y_, l_;
};

// The largest error of the values of a chain, relative to x and y, to u and v, or to l of the same pendulum, all
// following from two values of each.
double error_of_values(const std::vector<double>& x) {
  const int pendula = static_cast<int>(x.size()) / 5;
  Series radius(static_cast<std::size_t>(2 * pendula + 3), 0.0L);
  radius[0] = 1.0L;
  double largest = 0.0;
  for (int k = 0; k < pendula; ++k) {
    const double* const values = x.data() + 5 * k;
    const PendulumSeries series(radius, values, 2 * (pendula - k));
    const long double exact[] = {series.x()[0], series.y()[0], series.x()[1], series.y()[1], series.l()[0]};
    for (int i = 0; i < 5; ++i) {
      const long double size = i < 2   ? std::hypot(exact[0], exact[1])
                               : i < 4 ? std::hypot(exact[2], exact[3]) + 1e-6L * std::hypot(exact[0], exact[1])
                                       : std::fabs(exact[4]) + 1e-3L;
      largest = std::max(largest, static_cast<double>(std::fabs(values[i] - exact[i]) / size));
    }
    for (std::size_t m = 0; m < radius.size(); ++m) radius[m] = (m == 0 ? 1.0L : 0.0L) + 0.1L * series.l()[m];
  }
  return largest;
}

}  // namespace

// Derivatives reach 1e40, and every value has six digits nevertheless, as each order follows from those below.
TEST(PendulumChain, StartsWithTheRightValuesUpToIndex46) {
  for (const int pendula : {1, 2, 5, 8, 11, 13, 14, 17, 20, 23}) {
    SCOPED_TRACE(pendula);
    NonlinearRun run(pendulum_chain(pendula), required());
    ASSERT_TRUE(is_known(run.start(0.0, 1.0, chain_at_rest(pendula, 0.0, 0.0)))) << run.message();
    EXPECT_EQ(run.values(), (CharacteristicValues{2 * pendula, 2 * pendula, 3 * pendula, 0, 0}));
    EXPECT_LT(error_of_values(run.x), 1e-6);
    EXPECT_LT(error_of_lengths(run.x), 1e-9);
  }
}

// From guesses that are far from what the constraints allow, multipliers among them.
TEST(PendulumChain, StartsFromOtherPositions) {
  for (const int pendula : {9, 14, 18, 23})
    for (const double angle : {0.3, 1.0, 2.0, 3.0, -0.5, -1.27}) {
      SCOPED_TRACE(std::to_string(pendula) + " at " + std::to_string(angle));
      NonlinearRun run(pendulum_chain(pendula), required());
      ASSERT_TRUE(is_known(run.start(0.0, 1.0, chain_at_rest(pendula, angle, 0.7)))) << run.message();
      EXPECT_EQ(run.values(), (CharacteristicValues{2 * pendula, 2 * pendula, 3 * pendula, 0, 0}));
      EXPECT_LT(error_of_values(run.x), 1e-5);
    }
}

// The last level moves the last multiplier by 1e-15 of what others do, or less: for all that, it does.
TEST(PendulumChain, CountsLevelsThatMatterLittle) {
  NonlinearRun run(pendulum_chain(27), required());
  ASSERT_TRUE(is_known(run.start(0.0, 1.0, chain_at_rest(27, -0.5, 0.7)))) << run.message();
  EXPECT_EQ(run.values(), (CharacteristicValues{54, 54, 81, 0, 0}));
}

// A tighter run is the reference; the values that it starts from are consistent for all.
TEST(PendulumChain, SwingsALittleUpToIndexTwenty) {
  constexpr int pendula = 10;
  sfdae_options tight = required(SFDAE_METHOD_RADAU);
  tight.rtol = tight.atol = 1e-9;
  NonlinearRun reference(pendulum_chain(pendula), tight);
  ASSERT_TRUE(is_known(reference.start(0.0, 10.0, chain_at_rest(pendula, -1.27, 1.0)))) << reference.message();
  const std::vector<double> start = reference.x;
  ASSERT_EQ(reference.advance(10.0), SFDAE_OK) << reference.message();
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    NonlinearRun run(pendulum_chain(pendula), required(method));
    ASSERT_EQ(run.integrate(0.0, 10.0, start), SFDAE_OK) << run.message();
    EXPECT_NEAR(energy(run.x), energy(start), 1e-5);
    EXPECT_LT(error_of_lengths(run.x), 1e-12);
    EXPECT_LT(error_in_tolerances(run.x, reference.x), 100.0);
  }
}

// l_8 = -19.98 makes the ninth rod as long as -0.998, and grows: where it is -10, at 0.0998, the rod has no length.
TEST(PendulumChain, EndsWhereARodHasNoLength) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    NonlinearRun run(pendulum_chain(9), required(method));
    ASSERT_TRUE(is_known(run.start(0.0, 10.0, chain_at_rest(9, 0.0, 0.0)))) << run.message();
    EXPECT_EQ(run.advance(10.0), SFDAE_STEP_TOO_SMALL);
    EXPECT_NEAR(run.t, 0.0998, 2e-4);
    EXPECT_LT(std::fabs(1.0 + 0.1 * run.x[39]), 0.02);
    EXPECT_NE(run.message().find("singularity"), std::string::npos) << run.message();
  }
}

// z_1 + (z_0 - sin t) z_1' = 0, z_0 = sin t beside a chain: z_1' has a factor that is zero at all solutions, and z_1
// is no state.
TEST(PendulumChain, IsNotConfirmedWhereStructureMisleadsBesideIt) {
  for (const int pendula : {2, 8, 14}) {
    const NonlinearEquations chain = pendulum_chain(pendula);
    const int n = 5 * pendula;
    const NonlinearEquations both{n + 2, n + 2,
                                  [&chain, n](sfdae_record* record, const Expression& t, const Expression* x,
                                              const Expression* xdot, Expression* F) {
                                    chain.write(record, t, x, xdot, F);
                                    F[n] = x[n] - sin(t);
                                    F[n + 1] = x[n + 1] + (x[n] - sin(t)) * xdot[n + 1];
                                  }};
    for (const double off : {0.0, 1e-3, 0.3}) {
      SCOPED_TRACE(std::to_string(pendula) + " pendula, " + std::to_string(off));
      std::vector<double> guess = chain_at_rest(pendula, -1.27, 1.0);
      guess.push_back(off);
      guess.push_back(off);
      NonlinearRun run(both, required());
      const int status = run.start(0.0, 1.0, guess);
      EXPECT_TRUE(status == SFDAE_RANK_UNCLEAR || status == SFDAE_NO_CONSISTENT_VALUES) << status;
      EXPECT_NE(run.message(), "");
    }
  }
}

// Jets of order 17 are guessed from polynomials of degree 8.
TEST(PendulumChain, HasOutputsWithinStepsOfRadau) {
  constexpr int pendula = 8;
  NonlinearRun run(pendulum_chain(pendula), required(SFDAE_METHOD_RADAU));
  ASSERT_TRUE(is_known(run.start(0.0, 3.0, chain_at_rest(pendula, -1.27, 1.0)))) << run.message();
  const double at_start = energy(run.x);
  for (int k = 1; k <= 30; ++k) {
    ASSERT_TRUE(is_known(run.advance(0.1 * k))) << run.message();
    EXPECT_LT(error_of_lengths(run.x), 1e-13) << k;
    EXPECT_NEAR(energy(run.x), at_start, 1e-6) << k;
  }
  EXPECT_LT(run.statistics().steps, 25);
}

}  // namespace sfdae_test
