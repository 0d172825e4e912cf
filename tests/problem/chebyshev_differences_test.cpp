// SPDX-License-Identifier: BSD-3-Clause
// Derivatives of samples in Chebyshev points: exact for polynomials, honest about their errors, accurate at the ends.
#include "problem/chebyshev_differences.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "jet.h"
#include "matrix_checks.h"

namespace sfdae::core {

namespace {

using sfdae_test::factorial;
using sfdae_test::unit_roundoff;

constexpr int points = ChebyshevDifferences::points;
constexpr double positions[] = {-1.0, -0.97, -0.3, 0.0, 0.6, 1.0};

// f at the points of the interval about `middle`.
template <class Function>
std::vector<double> samples_of(Function f, double middle, double half_width) {
  std::vector<double> samples;
  for (int i = 0; i < points; ++i) samples.push_back(f(middle + half_width * ChebyshevDifferences::node(i)));
  return samples;
}

// k-th derivative of x^p.
double power_derivative(double x, int p, int k) {
  return k > p ? 0.0 : factorial(p) / factorial(p - k) * std::pow(x, p - k);
}

// k-th derivative of sin(speed t).
double sine_derivative(double t, double speed, int k) {
  return factorial(k) * sfdae_test::sine_cosine(0.0, speed, t, k).sine[k];
}

}  // namespace

// The extrema of T_12, odd about the middle to the last bit.
TEST(ChebyshevDifferences, PointsAreExtrema) {
  for (int i = 0; i < points; ++i) {
    EXPECT_NEAR(std::fabs(std::cos(12.0 * std::acos(ChebyshevDifferences::node(i)))), 1.0, 1e-12);
    EXPECT_EQ(ChebyshevDifferences::node(i), -ChebyshevDifferences::node(points - 1 - i));
  }
  EXPECT_EQ(ChebyshevDifferences::node(points / 2), 0.0);
}

// 13 points determine polynomials of degree 12. Weights of derivative k are at most 12^(2 k), by Markov.
TEST(ChebyshevDifferences, AreExactForPolynomials) {
  for (const double at : positions) {
    const ChebyshevDifferences differences(at, 6);
    for (int p = 0; p < points; ++p)
      for (int k = 1; k <= 6; ++k) {
        const std::vector<double> samples = samples_of([&](double x) { return std::pow(x, p); }, 0.0, 1.0);
        double derivative = 0.0, error = 0.0;
        differences.apply(k, 1.0, samples.data(), 1, &derivative, &error);
        EXPECT_NEAR(derivative, power_derivative(at, p, k), 100.0 * unit_roundoff * std::pow(12.0, 2 * k));
      }
  }
}

TEST(ChebyshevDifferences, ErrorIsAboveTheTrueErrorAndNotFarAbove) {
  const double speed = 1.3;
  for (const double at : positions)
    for (const double half_width : {0.8, 0.2, 0.05})
      for (int k = 1; k <= 4; ++k) {
        const double t = 0.7 + half_width * at;
        const std::vector<double> samples =
            samples_of([&](double s) { return std::sin(speed * s); }, 0.7, half_width);
        double derivative = 0.0, error = 0.0;
        ChebyshevDifferences(at, k).apply(k, half_width, samples.data(), 1, &derivative, &error);
        EXPECT_LE(std::fabs(derivative - sine_derivative(t, speed, k)), 2.0 * error) << at << half_width << k;
        // The coefficient of T_11 is at most 2 (speed half_width / 2)^11 / 11!, derivatives of T_12 12^(2 k).
        const double truncation = 4.0 * std::pow(speed * half_width / 2.0, 11) / factorial(11);
        const double allowed = (truncation + 100.0 * unit_roundoff) * std::pow(12.0, 2 * k) / std::pow(half_width, k);
        EXPECT_LE(error, allowed) << at << half_width << k;
      }
}

// Where integrations start: of a sine the third derivative with nine equidistant points is good to 1e-9 at best, here
// to 1e-10.
TEST(ChebyshevDifferences, AreAccurateAtTheEnds) {
  double best = 1.0, best_estimate = 1.0;
  for (double half_width = 1.0; half_width > 0.1; half_width /= 1.5) {
    double worst = 0.0, estimate = 0.0;
    for (double t = 0.0; t < 6.0; t += 0.3) {
      const std::vector<double> samples =
          samples_of([](double s) { return std::sin(s); }, t + half_width, half_width);
      double derivative = 0.0, error = 0.0;
      ChebyshevDifferences(-1.0, 3).apply(3, half_width, samples.data(), 1, &derivative, &error);
      worst = std::max(worst, std::fabs(derivative + std::cos(t)));
      estimate = std::max(estimate, error);
    }
    best = std::min(best, worst);
    best_estimate = std::min(best_estimate, estimate);
  }
  EXPECT_LE(best, 3e-10);
  EXPECT_LE(best_estimate, 1e-8);
}

// What interpolation misses first shows at the probe with the size that error_per_probe says: T_13, which looks like
// T_11.
TEST(ChebyshevDifferences, ProbeShowsWhatIsMissed) {
  const auto missed = [](double x) { return std::cos(13.0 * std::acos(x)); };
  const std::vector<double> samples = samples_of(missed, 0.0, 1.0);
  const double probe = ChebyshevDifferences::probe();
  double rounding = 0.0;
  const double error = std::fabs(ChebyshevDifferences(probe, 0).value(samples.data(), 1, rounding) - missed(probe));
  EXPECT_GT(error, 1.0);
  for (const double at : {-1.0, 0.0, 1.0}) {
    const ChebyshevDifferences differences(at, 1);
    double derivative = 0.0, estimate = 0.0;
    differences.apply(1, 1.0, samples.data(), 1, &derivative, &estimate);
    // T_13' = 13 U_12: 169 at the ends, 13 in the middle.
    const double exact = at == 0.0 ? 13.0 : 169.0;
    EXPECT_LE(std::fabs(derivative - exact), 1.01 * differences.error_per_probe(1) * error);
  }
}

// What is not smooth has errors of its own size, what is constant none, whatever other entries do.
TEST(ChebyshevDifferences, JudgeEveryEntryByItsOwnSamples) {
  std::minstd_rand random(7);
  std::uniform_real_distribution<double> rough(-1e-9, 1e-9);
  const int trials = 200;
  const double half_width = 0.2;
  int underestimated = 0;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<double> samples;
    for (int i = 0; i < points; ++i) {  // 1e9 t^2, noise, a constant
      samples.push_back(1e9 * std::pow(0.3 + half_width * ChebyshevDifferences::node(i), 2));
      samples.push_back(rough(random));
      samples.push_back(7.0);
    }
    for (int k = 1; k <= 3; ++k) {
      double derivative[3], errors[3];
      ChebyshevDifferences(0.0, k).apply(k, half_width, samples.data(), 3, derivative, errors);
      EXPECT_LE(std::fabs(derivative[0] - 1e9 * power_derivative(0.3, 2, k)), errors[0]);
      if (std::fabs(derivative[1]) > 10.0 * errors[1]) ++underestimated;
      EXPECT_EQ(derivative[2], 0.0);
      EXPECT_EQ(errors[2], 0.0);
    }
  }
  // Two estimates are both small by chance as often as two normal variables are below a tenth of their size: 1 %.
  EXPECT_LE(underestimated, trials * 3 / 30);
}

}  // namespace sfdae::core
