// SPDX-License-Identifier: BSD-3-Clause
//
// Random piecewise linear systems with a surface, and Runge and Kutta's method of order 4 with small steps for the
// differential equations that they hide, with Filippov's field along the surface.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace sfdae_test::sliding {

using Vector = std::array<double, 3>;
constexpr int n = 6;

inline double product(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// x' = A x + b + k u with u = p x + r on either side of c x + h = 0; besides w = q x and v = w'.
struct Sample {
  std::array<Vector, 3> A;
  std::array<Vector, 2> p;
  Vector b, k, c, q, start;
  std::array<double, 2> r;
  double h, time;
  std::array<std::array<double, n>, n> rows, columns;  // of the equations, of the unknowns

  Vector field(int side, const Vector& x) const {
    const double u = product(p[static_cast<std::size_t>(side)], x) + r[static_cast<std::size_t>(side)];
    Vector f;
    for (std::size_t i = 0; i < 3; ++i) f[i] = product(A[i], x) + b[i] + k[i] * u;
    return f;
  }
  double rate(int side, const Vector& x) const { return product(c, field(side, x)); }
  double surface(const Vector& x) const { return product(c, x) + h; }
};

template <class Random>
Sample random_sample(Random& random) {
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Vector{normal(random), normal(random), normal(random)}; };
  Sample sample;
  for (std::size_t i = 0; i < 3; ++i) {
    sample.A[i] = vector();
    sample.A[i][i] -= 1.5;
  }
  for (std::size_t k = 0; k < 2; ++k) {
    sample.p[k] = vector();
    sample.r[k] = (k == 0 ? 1.5 : -1.5) + normal(random);
  }
  sample.b = vector(), sample.k = vector(), sample.c = vector(), sample.q = vector(), sample.start = vector();
  // Most of them attract.
  if (product(sample.c, sample.k) < 0 && normal(random) < 1.0)
    for (double& c : sample.c) c = -c;
  sample.h = 0.3 * normal(random);
  sample.time = 2.0;
  for (auto* matrix : {&sample.rows, &sample.columns})
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) (*matrix)[i][j] = (i == j ? 2.0 : 0.0) + 0.5 * normal(random);
  return sample;
}

// The motion in a mode: 0, 1, or 2 along the surface.
class Reference {
 public:
  explicit Reference(const Sample& sample, double longest_step = 2e-4)
      : sample_(sample),
        longest_step_(longest_step),
        x_(sample.start),
        mode_(sample.surface(sample.start) > 0 ? 1 : 0) {}
  // False where modes cannot be told apart, or a surface is left and met at once.
  bool advance(double t) {
    while (t_ < t) {
      const double h = std::min(longest_step_, t - t_);
      if (is_over(step(h)) && !change(h)) return false;
      else if (!has_changed_) x_ = step(h), t_ = h < longest_step_ ? t : t_ + h;
      has_changed_ = false;
    }
    return true;
  }
  // Moves x by a tolerance; along the surface only.
  template <class Random>
  void disturb(double tolerance, Random& random) {
    std::uniform_real_distribution<double> direction(-1.0, 1.0);
    Vector change;
    for (std::size_t i = 0; i < 3; ++i) change[i] = tolerance * (1.0 + std::fabs(x_[i])) * direction(random);
    const Vector& c = sample_.c;
    const double part = mode_ == 2 ? product(c, change) / product(c, c) : 0.0;
    for (std::size_t i = 0; i < 3; ++i) x_[i] += change[i] - part * c[i];
  }
  bool has_changed_near(double t) const {
    return std::any_of(changes_.begin(), changes_.end(), [&](double at) { return std::fabs(at - t) < 1e-3; });
  }
  const std::vector<double>& changes() const { return changes_; }
  int visits_to_surface() const { return visits_; }
  int mode() const { return mode_; }
  // x, u, w, v.
  std::array<double, n> values() const {
    double part = mode_ == 1 ? 1.0 : 0.0;
    if (mode_ == 2) part = part_of_above(x_);
    double u = 0.0;
    for (std::size_t k = 0; k < 2; ++k)
      u += (k == 1 ? part : 1.0 - part) * (product(sample_.p[k], x_) + sample_.r[k]);
    return {x_[0], x_[1], x_[2], u, product(sample_.q, x_), product(sample_.q, slope(x_))};
  }

 private:
  double part_of_above(const Vector& x) const {
    const double below = sample_.rate(0, x), above = sample_.rate(1, x);
    return below / (below - above);
  }
  Vector slope(const Vector& x) const {
    if (mode_ < 2) return sample_.field(mode_, x);
    const Vector below = sample_.field(0, x), above = sample_.field(1, x);
    const double s = part_of_above(x);
    Vector f;
    for (std::size_t i = 0; i < 3; ++i) f[i] = (1 - s) * below[i] + s * above[i];
    return f;
  }
  Vector step(double h) const {
    const auto moved = [&](const Vector& k, double part) {
      Vector x = x_;
      for (std::size_t i = 0; i < 3; ++i) x[i] += part * h * k[i];
      return x;
    };
    const Vector a = slope(x_), b = slope(moved(a, 0.5)), c = slope(moved(b, 0.5)), d = slope(moved(c, 1.0));
    Vector x = x_;
    for (std::size_t i = 0; i < 3; ++i) x[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
    return x;
  }
  // Where the mode does not hold any more.
  bool is_over(const Vector& x) const {
    if (mode_ == 2) return !(part_of_above(x) >= 0 && part_of_above(x) <= 1);
    return mode_ == 0 ? sample_.surface(x) > 0 : sample_.surface(x) < 0;
  }
  bool change(double h) {
    double first = 0, last = h;
    for (int k = 0; k < 60; ++k) (is_over(step(0.5 * (first + last))) ? last : first) = 0.5 * (first + last);
    const Vector x = step(last);
    const double below = sample_.rate(0, x), above = sample_.rate(1, x);
    int to = below > 0 ? 1 : 0;
    if (mode_ == 2) to = part_of_above(step(h)) > 1 ? 1 : 0;
    else if (below > 0 && above < 0) to = 2;
    else if (to == mode_) return false;
    x_ = x, t_ += last, mode_ = to;
    if (to == 2) ++visits_;
    changes_.push_back(t_);
    has_changed_ = true;
    return true;
  }

  const Sample& sample_;
  double longest_step_;
  Vector x_;
  int mode_;
  double t_ = 0.0;
  bool has_changed_ = false;
  int visits_ = 0;
  std::vector<double> changes_;
};

// y with columns y = x.
inline std::vector<double> mixed(const Sample& sample, const std::array<double, n>& x) {
  std::array<std::array<double, n + 1>, n> a;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) a[i][j] = sample.columns[i][j];
    a[i][n] = x[i];
  }
  for (std::size_t j = 0; j < n; ++j) {
    std::size_t pivot = j;
    for (std::size_t i = j; i < n; ++i)
      if (std::fabs(a[i][j]) > std::fabs(a[pivot][j])) pivot = i;
    std::swap(a[j], a[pivot]);
    for (std::size_t i = 0; i < n; ++i)
      if (i != j) {
        const double factor = a[i][j] / a[j][j];
        for (std::size_t k = j; k <= n; ++k) a[i][k] -= factor * a[j][k];
      }
  }
  std::vector<double> y(n);
  for (std::size_t j = 0; j < n; ++j) y[j] = a[j][n] / a[j][j];
  return y;
}

}  // namespace sfdae_test::sliding
