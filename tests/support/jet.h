// SPDX-License-Identifier: BSD-3-Clause
// Truncated Taylor series of one scalar function at a point: coefficient k is the k-th derivative over k!.
#ifndef SFDAE_TESTS_JET_H
#define SFDAE_TESTS_JET_H

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace sfdae_test {

inline constexpr int max_jet_order = 19;

// k!, 0 <= k <= 21: exact in double precision.
constexpr double factorial(int k) {
  double product = 1.0;
  for (int j = 2; j <= k; ++j) product *= j;
  return product;
}

// A constant has order 0. Coefficients above the order are zero, so constants mix with any jet.
class Jet {
 public:
  Jet(double constant = 0.0) { c_[0] = constant; }  // NOLINT: implicit, so that formulas read like formulas

  // The identity t -> t with room for `order` coefficients above the first.
  static Jet variable(double t, int order) {
    assert(0 <= order && order <= max_jet_order);
    Jet x(t);
    x.order_ = order;
    if (order > 0) x.c_[1] = 1.0;
    return x;
  }
  static Jet zero(int order) {
    Jet x;
    x.order_ = order;
    return x;
  }

  int order() const { return order_; }
  double operator[](int k) const { return c_[static_cast<std::size_t>(k)]; }
  double& operator[](int k) { return c_[static_cast<std::size_t>(k)]; }

 private:
  std::array<double, max_jet_order + 1> c_{};
  int order_ = 0;
};

inline Jet operator+(const Jet& a, const Jet& b) {
  Jet sum = Jet::zero(std::max(a.order(), b.order()));
  for (int k = 0; k <= sum.order(); ++k) sum[k] = a[k] + b[k];
  return sum;
}

inline Jet operator-(const Jet& a) {
  Jet negative = Jet::zero(a.order());
  for (int k = 0; k <= a.order(); ++k) negative[k] = -a[k];
  return negative;
}

inline Jet operator-(const Jet& a, const Jet& b) { return a + (-b); }

inline Jet operator*(const Jet& a, const Jet& b) {
  Jet product = Jet::zero(std::max(a.order(), b.order()));
  for (int k = 0; k <= product.order(); ++k)
    for (int j = 0; j <= k; ++j) product[k] += a[j] * b[k - j];
  return product;
}

// q b = a, solved for one coefficient after the other.
inline Jet operator/(const Jet& a, const Jet& b) {
  Jet q = Jet::zero(std::max(a.order(), b.order()));
  for (int k = 0; k <= q.order(); ++k) {
    double rest = a[k];
    for (int j = 1; j <= k; ++j) rest -= b[j] * q[k - j];
    q[k] = rest / b[0];
  }
  return q;
}

// y = exp(a) satisfies y' = a' y.
inline Jet exp(const Jet& a) {
  Jet y = Jet::zero(a.order());
  y[0] = std::exp(a[0]);
  for (int k = 1; k <= a.order(); ++k) {
    double sum = 0.0;
    for (int j = 1; j <= k; ++j) sum += j * a[j] * y[k - j];
    y[k] = sum / k;
  }
  return y;
}

struct SineCosine {
  Jet sine, cosine;
};

// s' = a' c, c' = -a' s.
inline SineCosine sine_cosine(const Jet& a) {
  SineCosine y{Jet::zero(a.order()), Jet::zero(a.order())};
  y.sine[0] = std::sin(a[0]);
  y.cosine[0] = std::cos(a[0]);
  for (int k = 1; k <= a.order(); ++k) {
    double s = 0.0, c = 0.0;
    for (int j = 1; j <= k; ++j) {
      s += j * a[j] * y.cosine[k - j];
      c -= j * a[j] * y.sine[k - j];
    }
    y.sine[k] = s / k;
    y.cosine[k] = c / k;
  }
  return y;
}

// The same for a = phase + speed t, without the sums: the derivatives of sine and cosine go round in a circle.
inline SineCosine sine_cosine(double phase, double speed, double t, int order) {
  SineCosine y{Jet::zero(order), Jet::zero(order)};
  const double angle = phase + speed * t;
  double s = std::sin(angle), c = std::cos(angle);
  for (int k = 0; k <= order; ++k) {
    y.sine[k] = s;
    y.cosine[k] = c;
    const double factor = speed / (k + 1);
    const double next_sine = factor * c;
    c = -factor * s;
    s = next_sine;
  }
  return y;
}

inline Jet sin(const Jet& a) { return sine_cosine(a).sine; }
inline Jet cos(const Jet& a) { return sine_cosine(a).cosine; }

// The jet of the derivative; its order is one less.
inline Jet derivative(const Jet& a) {
  Jet y = Jet::zero(std::max(a.order() - 1, 0));
  for (int k = 0; k < a.order(); ++k) y[k] = (k + 1) * a[k + 1];
  return y;
}

}  // namespace sfdae_test

#endif
