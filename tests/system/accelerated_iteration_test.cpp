// SPDX-License-Identifier: BSD-3-Clause
// Anderson's acceleration of linear iterations: what it has to be by its definition.
#include "system/accelerated_iteration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// u := u + f(u); |u - solution| after so many changes.
double error_after(int changes, const std::function<Vector(const Vector&)>& f, Vector u, const Vector& solution,
                   bool accelerated) {
  AcceleratedIteration iteration;
  iteration.resize(u.size());
  iteration.begin();
  for (int k = 0; k < changes; ++k) {
    Vector change = f(u);
    if (accelerated) iteration.accelerate(change.size(), change.data());
    for (std::size_t i = 0; i < u.size(); ++i) u[i] += change[i];
  }
  double error = 0.0;
  for (std::size_t i = 0; i < u.size(); ++i) error = std::max(error, std::fabs(u[i] - solution[i]));
  return error;
}

// f(u) = (L - I) (u - solution) with eigenvalues of L on the diagonal.
std::function<Vector(const Vector&)> linear(const Vector& eigenvalues, const Vector& solution) {
  return [=](const Vector& u) {
    Vector f(u.size());
    for (std::size_t i = 0; i < u.size(); ++i) f[i] = (eigenvalues[i] - 1.0) * (u[i] - solution[i]);
    return f;
  };
}

// With three eigenvalues the minimal polynomial of L - I is of degree 3: combinations of three differences make f zero,
// the fourth change ends at the solution. The plain iteration has gained 0.5^4 by then.
TEST(AcceleratedIteration, EndsAfterFourChangesWhereThereAreThreeEigenvalues) {
  const Vector eigenvalues{0.5, -0.4, 0.2, 0.5, -0.4, 0.2}, solution{1, 2, 3, 4, 5, 6}, start(6, 0.0);
  const auto f = linear(eigenvalues, solution);
  EXPECT_LE(error_after(4, f, start, solution, true), 1e-12);
  EXPECT_GE(error_after(4, f, start, solution, false), 0.2);
}

// x and y that correct each other in turn, e_x := K e_y, e_y := L e_x: eigenvalues +- sqrt(K L) take two differences.
TEST(AcceleratedIteration, EndsAfterThreeChangesOfTwoThatCorrectEachOther) {
  const Vector solution{1.0, -2.0};
  const auto f = [&](const Vector& u) {
    const double x = u[0] - solution[0], y = u[1] - solution[1];
    return Vector{0.6 * y - x, 0.3 * x - y};
  };
  EXPECT_LE(error_after(3, f, {0.0, 0.0}, solution, true), 1e-13);
}

// Differences that depend on each other are left out, and nothing is divided by zero.
TEST(AcceleratedIteration, TakesChangesThatSayNothingNew) {
  const Vector solution{1.0, 1.0};
  const auto f = linear({0.5, 0.5}, solution);
  EXPECT_LE(error_after(6, f, {0.0, 3.0}, solution, true), 1e-13);
  const auto none = [](const Vector& u) { return Vector(u.size(), 0.0); };
  EXPECT_EQ(error_after(5, none, solution, solution, true), 0.0);
}

// A new iteration knows nothing of the last one.
TEST(AcceleratedIteration, BeginsAnew) {
  AcceleratedIteration iteration;
  iteration.resize(2);
  iteration.begin();
  Vector first{1.0, 2.0}, second{0.5, -1.0}, third{0.25, 0.5};
  iteration.accelerate(2, first.data());
  iteration.accelerate(2, second.data());
  iteration.begin();
  iteration.accelerate(2, third.data());
  EXPECT_EQ(third, (Vector{0.25, 0.5}));
}

}  // namespace

}  // namespace sfdae::core
