// Systems of any index of which the derivatives of the solution by two parameters are known.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef SFDAE_TESTS_TRANSFORMED_SYSTEM_H
#define SFDAE_TESTS_TRANSFORMED_SYSTEM_H

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "linear_family.h"
#include "random_system.h"
#include "sfdae/sfdae.hpp"

namespace sfdae_test {

// y_i = x_i + p/5 sin(x_{i-1} + 0.3 i) solves a random system in the time (1 + q) t: of x(t, p, q) everything is known.
class TransformedSystem {
 public:
  explicit TransformedSystem(unsigned seed) : system_(without_free_components(seed), 11 * seed + 5) {}
  static constexpr double p = 0.7, q = 0.2;

  int n() const { return system_.n(); }
  int mu() const { return system_.values().mu; }
  sfdae::NonlinearProblem problem() const {
    sfdae::NonlinearProblem problem(system_.m(), system_.n());
    problem.equations = [this](const sfdae::Expression& t, auto x, auto xdot, auto F) {
      const sfdae::Expression own_p = sfdae::parameter(t, "p", p), rate = 1.0 + sfdae::parameter(t, "q", q);
      std::vector<sfdae::Expression> y, ydot, residual(std::size_t(system_.m()));
      for (int i = 0; i < n(); ++i) {
        y.push_back(x[i]);
        ydot.push_back(xdot[i]);
        if (i == 0) continue;
        const sfdae::Expression angle = x[i - 1] + 0.3 * i;
        y.back() = y.back() + 0.2 * own_p * sin(angle);
        ydot.back() = ydot.back() + 0.2 * own_p * cos(angle) * xdot[i - 1];
      }
      for (sfdae::Expression& slope : ydot) slope = slope / rate;
      system_.residual(rate * t, y.data(), ydot.data(), residual.data());
      for (int i = 0; i < system_.m(); ++i) F[i] = residual[std::size_t(i)];
    };
    return problem;
  }
  // x and its derivatives by p and q.
  void exact(double t, std::vector<double>& x, sfdae::Matrix& S) const {
    std::vector<double> slopes;
    system_.exact((1.0 + q) * t, x, slopes);
    S = sfdae::Matrix(n(), 2);
    for (int i = 0; i < n(); ++i) {
      S(i, 1) = t * slopes[std::size_t(i)];
      if (i == 0) continue;
      const double angle = x[std::size_t(i - 1)] + 0.3 * i;
      x[std::size_t(i)] -= 0.2 * p * std::sin(angle);
      S(i, 0) = -0.2 * std::sin(angle) - 0.2 * p * std::cos(angle) * S(i - 1, 0);
      S(i, 1) -= 0.2 * p * std::cos(angle) * S(i - 1, 1);
    }
  }

 private:
  static RandomSystem::Shape without_free_components(unsigned seed) {
    RandomSystem::Shape shape = RandomSystem::random_shape(seed);
    shape.u = 0;
    if (shape.d == 0) shape.d = 1;
    return shape;
  }
  RandomSystem system_;
};

// A linear system of which the same is known: y_i = x_i + p/5 sin(0.3 i + t) x_{i-1}, z = R y, and for e = z - z*(t),
// in
// the time (1 + q) t,  e_i' = -b_i e_i for i < d,  e_{i+1}' = e_i, 0 = e_last  for the others. F = Q(t) times these.
class LinearTransformedSystem {
 public:
  explicit LinearTransformedSystem(unsigned seed) : d_(1 + int(seed % 3)), n_(d_ + 1 + int(seed / 3 % 4)) {
    RandomNumbers numbers(seed);
    for (int i = 0; i < n_; ++i) {
      damping_.push_back(numbers.uniform(0.2, 2.0));
      frequency_.push_back(numbers.uniform(0.4, 1.5));
      phase_.push_back(numbers.uniform(-3.0, 3.0));
      angle_.push_back(numbers.uniform(-1.5, 1.5));
    }
  }
  static constexpr double p = 0.7, q = 0.2;

  int n() const { return n_; }
  int mu() const { return n_ - d_ - 1; }
  sfdae::NonlinearProblem problem() const {
    sfdae::NonlinearProblem problem(n_, n_);
    problem.equations = [this](const sfdae::Expression& t, auto x, auto xdot, auto F) {
      const sfdae::Expression own_p = sfdae::parameter(t, "p", p), rate = 1.0 + sfdae::parameter(t, "q", q);
      std::vector<sfdae::Expression> e, slope, r;
      for (int i = 0; i < n_; ++i) {
        e.push_back(x[i] + 0.0 * t);
        slope.push_back(xdot[i] + 0.0 * t);
        if (i == 0) continue;
        const sfdae::Expression angle = t + 0.3 * i;
        e.back() = e.back() + 0.2 * own_p * sin(angle) * x[i - 1];
        slope.back() = slope.back() + 0.2 * own_p * (sin(angle) * xdot[i - 1] + cos(angle) * x[i - 1]);
      }
      turn(e), turn(slope);
      for (int i = 0; i < n_; ++i) {
        const sfdae::Expression wave = frequency_[at(i)] * (rate * t) + phase_[at(i)];
        e[at(i)] = e[at(i)] - sin(wave);
        slope[at(i)] = slope[at(i)] / rate - frequency_[at(i)] * cos(wave);
      }
      for (int i = 0; i < d_; ++i) r.push_back(slope[at(i)] + damping_[at(i)] * e[at(i)]);
      for (int i = d_; i + 1 < n_; ++i) r.push_back(slope[at(i + 1)] - e[at(i)]);
      r.push_back(e.back());
      for (int i = 0; i + 1 < n_; ++i) {
        const sfdae::Expression c = cos(angle_[at(i)] + 0.5 * t), s = sin(angle_[at(i)] + 0.5 * t), first = r[at(i)];
        r[at(i)] = c * first - s * r[at(i + 1)];
        r[at(i + 1)] = s * first + c * r[at(i + 1)];
      }
      for (int i = 0; i < n_; ++i) F[i] = r[at(i)];
    };
    return problem;
  }
  void exact(double t, std::vector<double>& x, sfdae::Matrix& S) const {
    std::vector<double> slope;
    x.clear();
    for (int i = 0; i < n_; ++i) {
      const double wave = frequency_[at(i)] * (1.0 + q) * t + phase_[at(i)];
      x.push_back(std::sin(wave));
      slope.push_back(frequency_[at(i)] * std::cos(wave));
    }
    turn_back(x), turn_back(slope);
    S = sfdae::Matrix(n_, 2);
    S(0, 1) = t * slope[0];
    for (int i = 1; i < n_; ++i) {
      const double factor = 0.2 * std::sin(t + 0.3 * i);
      x[at(i)] -= p * factor * x[at(i - 1)];
      S(i, 0) = -factor * x[at(i - 1)] - p * factor * S(i - 1, 0);
      S(i, 1) = t * slope[at(i)] - p * factor * S(i - 1, 1);
    }
  }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  template <class V>
  void turn(std::vector<V>& z) const {
    for (int i = 0; i + 1 < n_; ++i) {
      const double c = std::cos(angle_[at(i)]), s = std::sin(angle_[at(i)]);
      const V first = z[at(i)], second = z[at(i + 1)];
      z[at(i)] = c * first - s * second;
      z[at(i + 1)] = s * first + c * second;
    }
  }
  void turn_back(std::vector<double>& z) const {
    for (int i = n_ - 2; i >= 0; --i) {
      const double c = std::cos(angle_[at(i)]), s = std::sin(angle_[at(i)]), first = z[at(i)], second = z[at(i + 1)];
      z[at(i)] = c * first + s * second;
      z[at(i + 1)] = c * second - s * first;
    }
  }

  int d_, n_;
  std::vector<double> damping_, frequency_, phase_, angle_;
};

// Of the largest entry, or of 1.
inline double largest_error(const sfdae::Matrix& S, const sfdae::Matrix& exact) {
  double size = 1.0, error = 0.0;
  for (int j = 0; j < S.columns(); ++j)
    for (int i = 0; i < S.rows(); ++i) {
      size = std::max(size, std::abs(exact(i, j)));
      error = std::max(error, std::abs(S(i, j) - exact(i, j)));
    }
  return error / size;
}

}  // namespace sfdae_test

#endif
