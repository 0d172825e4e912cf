// SPDX-License-Identifier: BSD-3-Clause
// The last points of BDF: divided differences of x where x = w at all points, at some, and at none.
#include "integrate/bdf_history.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "integrate/bdf_step.h"

namespace sfdae::core {

namespace {

constexpr int points = 6;

double time_at(int k) { return 0.1 * k + 0.01 * k * k; }
std::vector<double> w_at(int k) { return {std::sin(time_at(k)), std::exp(-time_at(k))}; }
// Point k differs where its bit is set.
std::vector<double> x_at(int k, int differing) {
  std::vector<double> x = w_at(k);
  if ((differing >> k & 1) != 0) x[1] += 0.25 + 0.125 * k;
  return x;
}

// x[t_n, ..., t_(n - i)] by its definition.
double divided_difference(int n, int i, int component, int differing) {
  if (i == 0) return x_at(n, differing)[static_cast<std::size_t>(component)];
  return (divided_difference(n, i - 1, component, differing) -
          divided_difference(n - 1, i - 1, component, differing)) /
         (time_at(n) - time_at(n - i));
}

BdfHistory history_of(int differing) {
  BdfHistory history;
  const std::vector<double> w = w_at(0), x = x_at(0, differing), slope = {1.0, -1.0};
  history.start({time_at(0), x, slope, w, slope});
  history.place_fictitious_point(0.1);
  for (int k = 1; k < points; ++k) history.append(time_at(k), w_at(k), x_at(k, differing));
  return history;
}

}  // namespace

TEST(BdfHistory, HasDifferencesOfXWhereverItDiffersFromW) {
  for (const int differing : {0, 1, 0b000100, 0b100000, 0b010101, 0b111111}) {
    SCOPED_TRACE(differing);
    BdfHistory history = history_of(differing);
    EXPECT_EQ(history.size_x(), 2u);
    EXPECT_EQ(history.x(), x_at(points - 1, differing));
    history.compute_differences(points, true);
    for (int i = 0; i < points; ++i)
      for (int component = 0; component < 2; ++component) {
        const double expected = divided_difference(points - 1, i, component, differing);
        EXPECT_NEAR(history.difference_x(i)[static_cast<std::size_t>(component)], expected,
                    1e-10 * (1.0 + std::fabs(expected)))
            << i;
      }
  }
}

// The formula of a step with differences and without.
TEST(BdfHistory, HasFormulasByPoints) {
  BdfHistory history = history_of(0);
  for (int order = 1; order <= 5; ++order) {
    SCOPED_TRACE(order);
    BdfStep step;
    step.resize(0, 2, false);
    step.t = time_at(points - 1) + 0.17;
    step.h = 0.17;
    step.order = order;
    history.compute_differences(order, false);
    step.set_formula(history, false, false);
    std::vector<double> predicted(2), rest(2);
    EXPECT_EQ(history.formula_by_points(step.t, order, predicted.data(), rest.data()), step.c);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(predicted[i], step.w[i], 1e-13);
      EXPECT_NEAR(rest[i], step.w_rest[i], 1e-13 * (1.0 + std::fabs(step.w_rest[i])));
    }
  }
}

TEST(BdfHistory, HasAFictitiousPointOnBothTangents) {
  BdfHistory history;
  const std::vector<double> w = {1.0, 2.0}, wdot = {3.0, 4.0}, xdot = {3.0, 5.0};
  history.start({0.0, w, xdot, w, wdot});
  history.place_fictitious_point(0.5);
  history.compute_differences(2, true);
  EXPECT_EQ(history.difference(1), wdot);
  EXPECT_EQ(history.difference_x(1), xdot);
}

}  // namespace sfdae::core
