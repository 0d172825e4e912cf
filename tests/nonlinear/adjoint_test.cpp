// SPDX-License-Identifier: BSD-3-Clause
// Gradients by the adjoint of recorded equations of any index, against exact ones and forward sensitivities.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "sfdae/sfdae.hpp"
#include "transformed_system.h"

namespace {

using sfdae::Expression;
using sfdae::Matrix;
using sfdae::Point;
using sfdae_test::largest_error;
using sfdae_test::TransformedSystem;

sfdae::Options options_with(double tolerance, int method) {
  sfdae::Options options;
  options.rtol = options.atol = tolerance;
  options.method = method;
  // Forward sensitivities take the whole array as well then.
  options.structure = SFDAE_STRUCTURE_OFF;
  return options;
}

using Times = std::vector<double>;

// Two functionals.
Matrix weights_for(int n, const Times& times, unsigned seed) {
  Matrix weights(n, 2 * int(times.size()));
  for (int j = 0; j < weights.columns(); ++j)
    for (int i = 0; i < n; ++i) weights(i, j) = std::sin(1.0 + 2.3 * i + 1.7 * j + seed);
  return weights;
}

// sum_k S_k^T w_k.
Matrix gradient_of(const std::vector<Matrix>& S, const Matrix& weights) {
  const int points = int(S.size());
  Matrix gradient(S[0].columns(), 2);
  for (int q = 0; q < 2; ++q)
    for (int k = 0; k < points; ++k)
      for (int j = 0; j < gradient.rows(); ++j)
        for (int i = 0; i < weights.rows(); ++i)
          gradient(j, q) += S[std::size_t(k)](i, j) * weights(i, k + q * points);
  return gradient;
}

// A run through these times, the first of which is the start.
struct Journey {
  sfdae::Sensitivities wanted;
  Point point;
  Times times;
};

template <class Problem>
Matrix adjoint_gradient(const Problem& problem, const sfdae::Options& options, Journey journey,
                        const Matrix& weights) {
  sfdae::Solver solver(problem, options);
  journey.wanted.adjoint = true;
  solver.set_sensitivities(journey.wanted);
  solver.start(journey.point, journey.times.back());
  for (double t : journey.times)
    if (t != journey.times.front()) solver.advance(t, journey.point);
  return solver.gradient(journey.times, weights);
}

// The same steps, as there is one time only, at which they end.
template <class Problem>
Matrix forward_gradient(const Problem& problem, sfdae::Options options, Journey journey, const Matrix& weights) {
  options.use_stop_time = 1;
  options.stop_time = journey.times.back();
  sfdae::Solver solver(problem, options);
  solver.set_sensitivities(journey.wanted);
  solver.start(journey.point, journey.times.back());
  const Matrix S = solver.sensitivities(journey.times.front(), false).S;
  solver.advance(journey.times.back(), journey.point);
  return gradient_of({S, solver.sensitivities(journey.times.back(), false).S}, weights);
}

// ---- Random systems --------------------------------------------------------------------------------------------

class RandomGradients : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, RandomGradients, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

TEST_P(RandomGradients, AreExactForAnyIndex) {
  int solved[4] = {0, 0, 0, 0};
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const TransformedSystem system(seed);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", mu = " + std::to_string(system.mu()));
    Journey journey{{}, {}, {0.0, 0.7, 1.3, 2.0}};
    journey.wanted.parameters = {"p", "q"};
    std::vector<Matrix> S(4);
    std::vector<double> x;
    for (std::size_t k = 0; k < 4; ++k) system.exact(journey.times[k], k == 0 ? journey.point.x : x, S[k]);
    journey.wanted.directions = S[0];
    const Matrix weights = weights_for(system.n(), journey.times, seed);
    const Matrix gradient = adjoint_gradient(system.problem(), options_with(1e-9, GetParam()), journey, weights);
    EXPECT_LE(largest_error(gradient, gradient_of(S, weights)), 1e-6);
    ++solved[std::min(system.mu(), 3)];
  }
  for (int count : solved) EXPECT_GE(count, 2);
}

// To rounding, whatever the tolerance, as it is the adjoint of the steps.
TEST_P(RandomGradients, AreThoseOfForwardSensitivities) {
  for (double tolerance : {1e-4, 1e-8}) {
    for (unsigned seed = 1; seed <= 40; ++seed) {
      const TransformedSystem system(seed);
      SCOPED_TRACE("seed " + std::to_string(seed) + ", mu = " + std::to_string(system.mu()));
      Journey journey{{}, {}, {0.0, 2.0}};
      journey.wanted.parameters = {"", "q", "p"};
      journey.wanted.directions = Matrix(system.n(), 3);
      for (int i = 0; i < system.n(); ++i) journey.wanted.directions(i, 0) = std::cos(2.0 * i + seed);
      Matrix unused;
      system.exact(0.0, journey.point.x, unused);
      for (std::size_t i = 0; i < journey.point.x.size(); ++i)
        journey.point.x[i] += 0.1 * std::sin(3.0 * double(i) + seed);
      const Matrix weights = weights_for(system.n(), journey.times, seed);
      const sfdae::Options options = options_with(tolerance, GetParam());
      const Matrix gradient = adjoint_gradient(system.problem(), options, journey, weights);
      EXPECT_LE(largest_error(gradient, forward_gradient(system.problem(), options, journey, weights)), 1e-11);
    }
  }
}

}  // namespace
