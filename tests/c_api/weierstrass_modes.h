// SPDX-License-Identifier: BSD-3-Clause
// Random modes E x' = A x + f with constant E and A of known Weierstrass form, for tests of jumps from one to another:
//
//     P E Q = diag(I, N),  P A Q = diag(J, I),  P f = (g1, g2),  x = Q (y1, y2)
//     y1_i' = lambda_i y1_i + c_i cos(w_i t + p_i)            y2 = -sum_k N^k g2^(k),  g2_i = c_i cos(w_i t + p_i)
//
// J diagonal, N strictly upper triangular with blocks of random sizes up to mu + 1. The consistency projector is
// Q diag(I, 0) Q^-1.
#ifndef SFDAE_TESTS_WEIERSTRASS_MODES_H
#define SFDAE_TESTS_WEIERSTRASS_MODES_H

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "random.h"

namespace sfdae_test {

using Values = std::vector<double>;

// Row by row.
class Square {
 public:
  explicit Square(int n) : n_(n), entries_(static_cast<std::size_t>(n * n), 0.0) {}
  int n() const { return n_; }
  double& operator()(int i, int j) { return entries_[static_cast<std::size_t>(i * n_ + j)]; }
  double operator()(int i, int j) const { return entries_[static_cast<std::size_t>(i * n_ + j)]; }
  Square operator*(const Square& b) const {
    Square c(n_);
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j < n_; ++j)
        for (int k = 0; k < n_; ++k) c(i, j) += (*this)(i, k) * b(k, j);
    return c;
  }
  Values operator*(const Values& x) const {
    Values y(x.size(), 0.0);
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j < n_; ++j) y[static_cast<std::size_t>(i)] += (*this)(i, j) * x[static_cast<std::size_t>(j)];
    return y;
  }

 private:
  int n_;
  Values entries_;
};

// A matrix and its inverse: rotations of pairs, and factors from 1/2 to 2 in between.
struct Transformation {
  Square matrix, inverse;
  Transformation(Random& random, int n) : matrix(n), inverse(n) {
    for (int i = 0; i < n; ++i) matrix(i, i) = inverse(i, i) = 1.0;
    rotate(random);
    for (int i = 0; i < n; ++i) scale(i, std::pow(2.0, random.real(-1.0, 1.0)));
    rotate(random);
  }
  // Row i of the matrix times a factor.
  void scale(int i, double factor) {
    for (int j = 0; j < matrix.n(); ++j) {
      matrix(i, j) *= factor;
      inverse(j, i) /= factor;
    }
  }

 private:
  void rotate(Random& random) {
    for (int i = 0; i < matrix.n(); ++i)
      for (int j = 0; j < i; ++j) {
        const double angle = random.real(0.0, 6.28), c = std::cos(angle), s = std::sin(angle);
        for (int k = 0; k < matrix.n(); ++k) {
          const double mi = matrix(i, k), mj = matrix(j, k), vi = inverse(k, i), vj = inverse(k, j);
          matrix(i, k) = c * mi - s * mj;
          matrix(j, k) = s * mi + c * mj;
          inverse(k, i) = c * vi - s * vj;
          inverse(k, j) = s * vi + c * vj;
        }
      }
  }
};

struct Wave {
  double c, w, p;
  double derivative(int k, double t) const { return c * std::pow(w, k) * std::cos(w * t + p + k * std::acos(0.0)); }
};

struct Mode {
  // algebraic >= mu + 1: the largest block of N has mu + 1 rows.
  Mode(Random& random, int differential, int algebraic, int strangeness_index, double least_lambda = -3.0)
      : d(differential),
        a(algebraic),
        mu(strangeness_index),
        P(random, d + a),
        Q(random, d + a),
        N(a),
        E(d + a),
        A(d + a) {
    for (int i = 0; i < d; ++i) lambda.push_back(random.real(least_lambda, 0.5));
    for (int i = 0; i < d + a; ++i)
      waves.push_back({random.real(-1.0, 1.0), random.real(0.5, 1.5), random.real(0.0, 6.28)});
    // The first block has mu + 1 rows, the others as many or fewer.
    for (int first = 0; first < a;) {
      const int size = std::min(first == 0 ? mu + 1 : random.integer(1, mu + 1), a - first);
      for (int i = first; i + 1 < first + size; ++i) N(i, i + 1) = random.real(0.5, 1.5);
      first += size;
    }
    assemble(1.0);
  }

  int n() const { return d + a; }
  // Other units: equation i times rows[i], x_j in units of columns[j], t in units of `time`.
  void change_units(const Values& rows, const Values& columns, double its_time) {
    for (int i = 0; i < n(); ++i) row_factor.push_back(rows[static_cast<std::size_t>(i)]);
    unit = columns;
    time = its_time;
    assemble(time);
  }

  // f^(order) at t in the user's units.
  Values f(double t, int order) const {
    Values g(waves.size());
    for (std::size_t i = 0; i < g.size(); ++i) g[i] = waves[i].derivative(order, t / time) / std::pow(time, order);
    Values result = P.inverse * g;
    for (std::size_t i = 0; i < row_factor.size(); ++i) result[i] *= row_factor[i];
    return result;
  }
  // What of x obeys an ODE, y1.
  Values differential_part(const Values& x) const {
    Values y = Q.inverse * in_units(x, false);
    y.resize(static_cast<std::size_t>(d));
    return y;
  }
  // The solution at t with y1 given at `start`.
  Values solution(double t, double start, const Values& y1) const {
    Values y(static_cast<std::size_t>(n()));
    for (std::size_t i = 0; i < y1.size(); ++i) {
      const double growth = std::exp(lambda[i] * (t - start) / time);
      y[i] = (y1[i] - particular(i, start / time)) * growth + particular(i, t / time);
    }
    Square power(a);
    for (int i = 0; i < a; ++i) power(i, i) = 1.0;
    for (int k = 0; k <= mu; ++k) {
      Values g(static_cast<std::size_t>(a));
      for (int i = 0; i < a; ++i)
        g[static_cast<std::size_t>(i)] = waves[static_cast<std::size_t>(d + i)].derivative(k, t / time);
      const Values part = power * g;
      for (int i = 0; i < a; ++i) y[static_cast<std::size_t>(d + i)] -= part[static_cast<std::size_t>(i)];
      power = power * N;
    }
    return in_units(Q.matrix * y, true);
  }

  int d, a, mu;
  Transformation P, Q;
  Square N, E, A;  // E = P^-1 diag(I, N) Q^-1, A = P^-1 diag(J, I) Q^-1
  Values lambda, unit, row_factor;
  double time = 1.0;
  std::vector<Wave> waves;

 private:
  double particular(std::size_t i, double t) const {
    const Wave& g = waves[i];
    // Re c e^(i(wt+p)) / (i w - lambda)
    const double size = g.w * g.w + lambda[i] * lambda[i], angle = g.w * t + g.p;
    return g.c * (g.w * std::sin(angle) - lambda[i] * std::cos(angle)) / size;
  }
  Values in_units(Values x, bool outward) const {
    for (std::size_t j = 0; j < unit.size(); ++j) x[j] *= outward ? unit[j] : 1.0 / unit[j];
    return x;
  }
  void assemble(double time_unit) {
    Square I(n()), J(n());
    for (int i = 0; i < d; ++i) I(i, i) = 1.0, J(i, i) = lambda[static_cast<std::size_t>(i)];
    for (int i = 0; i < a; ++i) {
      J(d + i, d + i) = 1.0;
      for (int j = 0; j < a; ++j) I(d + i, d + j) = N(i, j);
    }
    E = P.inverse * I * Q.inverse;
    A = P.inverse * J * Q.inverse;
    for (int i = 0; i < n(); ++i)
      for (int j = 0; j < n(); ++j) {
        const double factor = (row_factor.empty() ? 1.0 : row_factor[static_cast<std::size_t>(i)]) /
                              (unit.empty() ? 1.0 : unit[static_cast<std::size_t>(j)]);
        E(i, j) *= factor * time_unit;
        A(i, j) *= factor;
      }
  }
};

}  // namespace sfdae_test

#endif
