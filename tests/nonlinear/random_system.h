// SPDX-License-Identifier: BSD-3-Clause
// Random nonlinear systems F(t, x, x') = 0 of which everything is known.
//
// z = S(t, x) has the parts w (differential), c (algebraic), blocks and free components, with deviations e = z - z*(t)
// from a chosen solution:
//   w_i' = z*_i' - b_i e_i + nonlinear terms in e_w, e_c, e_free        c_i:  e_i + 0.3 sin e_i = 0.4 (sin w_j - sin
//   w*_j)
//   block of size k:  e_{i+1}' = e_i + sin(w) e_{i+1},  0 = e_k         mu = k - 1 for the longest block, else 0
// S is a composition of rotations and of triangular maps with bounded nonlinear terms: x <-> z one to one. The
// canonical equations r become F = Q(t, x) (r + strictly triangular products of r): the same zeros, other ranks
// elsewhere.
#ifndef SFDAE_TESTS_RANDOM_SYSTEM_H
#define SFDAE_TESTS_RANDOM_SYSTEM_H

#include <cmath>
#include <cstddef>
#include <vector>

#include "linear_family.h"
#include "matrix_checks.h"

namespace sfdae_test {

// A value with its derivative along a curve.
template <class V>
struct Dual {
  V value, slope;
  friend Dual operator+(const Dual& a, const Dual& b) { return {a.value + b.value, a.slope + b.slope}; }
  friend Dual operator-(const Dual& a, const Dual& b) { return {a.value - b.value, a.slope - b.slope}; }
  friend Dual operator*(const Dual& a, const Dual& b) {
    return {a.value * b.value, a.slope * b.value + a.value * b.slope};
  }
  friend Dual operator*(double a, const Dual& b) { return {a * b.value, a * b.slope}; }
  friend Dual sin(const Dual& a) {
    using std::sin, std::cos;
    return {sin(a.value), a.slope * cos(a.value)};
  }
};

class RandomSystem {
 public:
  struct Shape {
    int d = 0, coupled = 0;
    std::vector<int> blocks = {};
    int u = 0, v = 0;
  };
  RandomSystem(const Shape& shape, unsigned seed);
  static Shape random_shape(unsigned seed);

  int n() const { return n_; }
  int m() const { return values_.d + values_.a + values_.v; }
  CharacteristicValues values() const { return values_; }

  template <class V>
  void residual(const V& t, const V* x, const V* xdot, V* F) const;
  void exact(double t, std::vector<double>& x, std::vector<double>& xdot) const;
  // The largest violation of all constraints, hidden ones included, in the variables z.
  double constraint_violation(double t, const std::vector<double>& x) const;

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  struct Rotation {
    int i, j;
    double cosine, sine;
  };
  struct Bend {  // z_i += size sin(frequency z_j + rate t) (1 + z_k / 4 if k >= 0, a bounded part of it), j, k < i
    int i, j, k;
    double size, frequency, rate;
  };
  struct Layer {
    std::vector<Rotation> rotations;
    std::vector<Bend> bends;
  };
  struct Wave {
    double mean, size, frequency, phase;
  };
  struct Turn {  // rows i and j turn by angle + size sin(x_k + t)
    int i, j, k;
    double angle, size;
  };

  template <class V>
  static V bending(const Bend& bend, const std::vector<V>& z, const V& t) {
    using std::sin;
    const V s = bend.size * sin(bend.frequency * z[at(bend.j)] + bend.rate * t);
    return bend.k < 0 ? s : s + 0.5 * (s * sin(z[at(bend.k)]));
  }
  template <class V>
  void to_canonical(const V& t, std::vector<V>& z) const {
    for (const Layer& layer : layers_) {
      for (const Rotation& r : layer.rotations) {
        const V a = z[at(r.i)], b = z[at(r.j)];
        z[at(r.i)] = r.cosine * a - r.sine * b;
        z[at(r.j)] = r.sine * a + r.cosine * b;
      }
      for (const Bend& bend : layer.bends) z[at(bend.i)] = z[at(bend.i)] + bending(bend, z, t);
    }
  }
  template <class V>
  Dual<V> wave(int i, const V& t) const {
    using std::sin, std::cos;
    const Wave& w = waves_[at(i)];
    const V angle = w.frequency * t + w.phase;
    return {w.mean + w.size * sin(angle), (w.size * w.frequency) * cos(angle)};
  }
  // Canonical equations from z and z - z*.
  template <class V>
  void canonical(const std::vector<Dual<V>>& z, const std::vector<Dual<V>>& e, std::vector<V>& r) const;
  template <class V>
  void mix(const V& t, const V* x, std::vector<V>& r) const;

  Shape shape_;
  CharacteristicValues values_{};
  int n_ = 0;
  std::vector<Layer> layers_;
  std::vector<Wave> waves_;
  std::vector<double> damping_, coupling_;
  std::vector<int> order_;  // equation i of the mixed system is canonical equation order_[i]
  std::vector<Turn> turns_;
  std::vector<double> quadratic_;
};

inline RandomSystem::Shape RandomSystem::random_shape(unsigned seed) {
  RandomNumbers numbers(seed);
  const auto upto = [&numbers](int most) { return static_cast<int>(numbers.uniform(0.0, most + 0.999)); };
  Shape shape;
  shape.d = upto(3);
  shape.coupled = upto(1);
  if (numbers.uniform(0.0, 1.0) < 0.85) shape.blocks.push_back(1 + upto(3));
  if (numbers.uniform(0.0, 1.0) < 0.3) shape.blocks.push_back(1 + upto(1));
  if (numbers.uniform(0.0, 1.0) < 0.2) shape.u = 1;
  if (shape.d + shape.coupled + static_cast<int>(shape.blocks.size()) == 0) shape.d = 2;
  if (numbers.uniform(0.0, 1.0) < 0.2) shape.v = 1;
  return shape;
}

inline RandomSystem::RandomSystem(const Shape& shape, unsigned seed) : shape_(shape) {
  RandomNumbers numbers(seed);
  const auto below = [&numbers](int bound) { return static_cast<int>(numbers.uniform(0.0, bound - 1e-9)); };
  int longest = 1, block_sizes = 0;
  for (const int k : shape.blocks) longest = std::max(longest, k), block_sizes += k;
  values_ = {longest - 1, shape.d, shape.coupled + block_sizes, shape.u, shape.v};
  n_ = values_.d + values_.a + values_.u;
  const int m = values_.d + values_.a;
  for (int i = 0; i < n_; ++i) {
    waves_.push_back({numbers.uniform(-1.0, 1.0), numbers.uniform(0.3, 1.0), numbers.uniform(0.4, 1.5),
                      numbers.uniform(-3.0, 3.0)});
    damping_.push_back(numbers.uniform(0.2, 2.0));
    coupling_.push_back(numbers.uniform(-0.5, 0.5));
  }
  for (int layer = 0; layer < 2 && n_ > 1; ++layer) {
    Layer next;
    for (int q = 0; q < n_; ++q) {
      const int i = below(n_), j = (i + 1 + below(n_ - 1)) % n_;
      const double angle = numbers.uniform(-1.5, 1.5);
      next.rotations.push_back({i, j, std::cos(angle), std::sin(angle)});
    }
    for (int i = n_ - 1; i > 0; --i)
      next.bends.push_back({i, below(i), i > 1 && below(2) == 0 ? below(i) : -1, numbers.uniform(-0.4, 0.4),
                            numbers.uniform(0.4, 1.2), numbers.uniform(-0.5, 0.5)});
    layers_.push_back(next);
  }
  for (int i = 0; i < m; ++i) {
    order_.push_back(i);
    quadratic_.push_back(numbers.uniform(-0.3, 0.3));
  }
  for (int i = m - 1; i > 0; --i) std::swap(order_[at(i)], order_[at(below(i + 1))]);
  for (int q = 0; q < m && m > 1; ++q) {
    const int i = below(m), j = (i + 1 + below(m - 1)) % m;
    turns_.push_back({i, j, below(n_), numbers.uniform(-1.5, 1.5), numbers.uniform(-0.4, 0.4)});
  }
}

template <class V>
void RandomSystem::canonical(const std::vector<Dual<V>>& z, const std::vector<Dual<V>>& e, std::vector<V>& r) const {
  using std::sin;
  const int d = shape_.d, first_block = d + shape_.coupled;
  for (int i = 0; i < d; ++i) {
    const int next = (i + 1) % d;
    V slope = damping_[at(i)] * e[at(i)].value + coupling_[at(i)] * sin(2.0 * e[at(next)].value);
    if (shape_.coupled > 0) slope = slope + 0.3 * e[at(d)].value * e[at(i)].value;
    if (shape_.u > 0) slope = slope + 0.3 * sin(e[at(n_ - 1)].value);
    r.push_back(e[at(i)].slope + slope);
  }
  for (int i = d; i < first_block; ++i) {
    const V& own = e[at(i)].value;
    V equation = own + 0.3 * sin(own);
    if (d > 0) equation = equation - 0.4 * (sin(z[0].value) - sin(z[0].value - e[0].value));
    r.push_back(equation);
  }
  int first = first_block;
  for (const int k : shape_.blocks) {
    for (int i = first; i + 1 < first + k; ++i) {
      const V factor = d > 0 ? sin(z[0].value) : sin(z[at(i + 1)].value);
      r.push_back(e[at(i + 1)].slope - e[at(i)].value - factor * e[at(i + 1)].value);
    }
    r.push_back(e[at(first + k - 1)].value);
    first += k;
  }
}

template <class V>
void RandomSystem::mix(const V& t, const V* x, std::vector<V>& r) const {
  using std::sin, std::cos, std::exp;
  std::vector<V> mixed;
  for (std::size_t i = 0; i < order_.size(); ++i) {
    V equation = r[at(order_[i])];
    if (i > 0)
      equation =
          equation + quadratic_[i] * (mixed[i - 1] * r[at(order_[i])]) + quadratic_[i] * mixed[i / 2] * mixed[0];
    mixed.push_back(equation);
  }
  for (const Turn& turn : turns_) {
    const V angle = turn.angle + turn.size * sin(x[turn.k] + t);
    const V c = cos(angle), s = sin(angle), a = mixed[at(turn.i)], b = mixed[at(turn.j)];
    mixed[at(turn.i)] = (c * a - s * b) * exp(turn.size * sin(x[turn.k]));
    mixed[at(turn.j)] = s * a + c * b;
  }
  for (int q = 0; q < shape_.v; ++q) {
    V sum = 0.0 * t;
    for (std::size_t i = 0; i < order_.size(); ++i) sum = sum + (0.3 + 0.2 * cos(x[0] + 1.0 * double(i))) * mixed[i];
    mixed.push_back(sum + mixed[0] * mixed[0]);
  }
  r = mixed;
}

template <class V>
void RandomSystem::residual(const V& t, const V* x, const V* xdot, V* F) const {
  std::vector<Dual<V>> z, e;
  for (int i = 0; i < n_; ++i) z.push_back({x[i], xdot[i]});
  to_canonical(Dual<V>{t, V(1.0)}, z);
  for (int i = 0; i < n_; ++i) e.push_back(z[at(i)] - wave(i, t));
  std::vector<V> r;
  canonical(z, e, r);
  mix(t, x, r);
  for (std::size_t i = 0; i < r.size(); ++i) F[i] = r[i];
}

inline void RandomSystem::exact(double t, std::vector<double>& x, std::vector<double>& xdot) const {
  std::vector<Dual<double>> z;
  const Dual<double> time{t, 1.0};
  for (int i = 0; i < n_; ++i) z.push_back(wave(i, t));
  for (auto layer = layers_.rbegin(); layer != layers_.rend(); ++layer) {
    for (auto bend = layer->bends.rbegin(); bend != layer->bends.rend(); ++bend)
      z[at(bend->i)] = z[at(bend->i)] - bending(*bend, z, time);
    for (auto r = layer->rotations.rbegin(); r != layer->rotations.rend(); ++r) {
      const Dual<double> a = z[at(r->i)], b = z[at(r->j)];
      z[at(r->i)] = r->cosine * a + r->sine * b;
      z[at(r->j)] = r->cosine * b - r->sine * a;
    }
  }
  x.clear(), xdot.clear();
  for (const Dual<double>& component : z) x.push_back(component.value), xdot.push_back(component.slope);
}

inline double RandomSystem::constraint_violation(double t, const std::vector<double>& x) const {
  std::vector<double> z = x;
  to_canonical(t, z);
  double worst = 0.0;
  const auto deviation = [&](int i) { return z[at(i)] - wave(i, t).value; };
  for (int i = shape_.d; i < shape_.d + values_.a; ++i) {
    double violation = deviation(i);
    if (i < shape_.d + shape_.coupled) {
      violation += 0.3 * std::sin(violation);
      if (shape_.d > 0) violation -= 0.4 * (std::sin(z[0]) - std::sin(wave(0, t).value));
    }
    worst = std::max(worst, std::abs(violation));
  }
  return worst;
}

}  // namespace sfdae_test

#endif
