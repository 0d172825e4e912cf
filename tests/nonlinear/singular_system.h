// SPDX-License-Identifier: BSD-3-Clause
// Random nonlinear systems with a singular point at a known time, and systems that look like it but have none.
//
// z = S(t, x) follows chosen curves z*(s), s = (t - start) / unit: differential ones (z0 rises), one that is algebraic,
// a chain of length k = mu + 1, and a pair (p, q). With deviations e = z - z*,
//
//     e_i' = -b_i e_i + c sin e_j         0 = e + 0.3 sin e - 0.4 e_0         e_{i+1}' = e_i + sin(z_0) e_{i+1}, 0 =
//     e_k
//     fold:     p' = theta' q, p^2 + q^2 = 1:  p = sin theta, q = cos theta, singular at theta = pi/2
//     impasse:  p' = -r, q^2 = p:  the solution ends where p = 0
//
// One of these equations is multiplied by phi, which vanishes at one point s* (or is near zero, but not zero, there).
// Then x is bent and rotated, and equations are mixed by regular matrices that depend on x.
#ifndef SFDAE_TESTS_SINGULAR_SYSTEM_H
#define SFDAE_TESTS_SINGULAR_SYSTEM_H

#include <cmath>
#include <cstddef>
#include <vector>

#include "linear_family.h"
#include "random_family.h"
#include "random_system.h"

namespace sfdae_test {

enum class Singularity { factor, square, fold, impasse };
enum class Factored { differential, algebraic };

class SingularSystem {
 public:
  SingularSystem(unsigned seed, bool is_singular);

  int n() const { return n_; }
  Singularity kind() const { return kind_; }
  int mu() const { return chain_ > 0 ? chain_ - 1 : 0; }
  double start() const { return start_; }
  double end() const { return start_ + 2.2 * unit_; }
  double unit() const { return unit_; }
  // Where it is singular.
  double time() const { return start_ + unit_ * s_; }
  template <class V>
  void residual(const V& t, const V* x, const V* xdot, V* F) const;
  std::vector<double> exact(double t) const;
  // How long after t the solution through x would be singular, to first order; x near the singular point.
  double time_left(double t, const std::vector<double>& x) const;

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  struct Curve {
    double rise, mean, size, frequency, phase;
  };
  struct Bend {
    int i, j;
    double size, frequency, rate;
  };
  struct Turn {
    int i, j, k;
    double angle, size;
  };
  template <class V>
  V scaled(const V& t) const {
    return (t - start_) * (1.0 / unit_);
  }
  template <class V>
  V angle(const V& s) const {
    using std::sin;
    return is_singular_ ? theta_ + rate_ * (s - s_) + 0.05 * sin(3.0 * (s - s_)) : 1.25 * sin(rate_ * s + theta_);
  }
  template <class V>
  V curve(int i, const V& s) const {
    using std::sin;
    const Curve& c = curves_[at(i)];
    return c.mean + c.rise * s + c.size * sin(c.frequency * s + c.phase);
  }
  template <class V>
  std::vector<Dual<V>> to_canonical(const Dual<V>& t, const V* x, const V* xdot) const;
  template <class V>
  V factor(const V& s, const V& z0) const;

  bool is_singular_;
  Singularity kind_;
  Factored factored_;
  bool by_time_ = false;  // the factor is one of t, not of z0
  int n_ = 0, d_ = 0, coupled_ = 0, chain_ = 0, pair_ = 0;
  double start_ = 0.0, unit_ = 1.0, s_ = 0.0, margin_ = 0.0, theta_ = 0.0, rate_ = 0.0, stiffness_ = 1.0,
         growth_ = 0.0;
  std::vector<Curve> curves_;
  std::vector<double> damping_;
  std::vector<Bend> bends_[2];
  std::vector<Turn> rotations_[2], turns_;
};

inline SingularSystem::SingularSystem(unsigned seed, bool is_singular) : is_singular_(is_singular) {
  RandomNumbers numbers(1000003u * seed + 17u);
  const auto pick = [&](int count) { return numbers.integer(0, count - 1); };
  const int kind = is_singular ? pick(8) : pick(6);
  kind_ = kind < 4    ? Singularity::factor
          : kind == 4 ? Singularity::square
          : kind < 7  ? Singularity::fold
                      : Singularity::impasse;
  if (!is_singular && kind == 4) kind_ = Singularity::factor;
  const bool has_pair = kind_ == Singularity::fold || kind_ == Singularity::impasse;
  d_ = 1 + pick(has_pair ? 2 : 3);
  coupled_ = pick(2);
  const int mu = pick(3);
  chain_ = mu > 0 ? mu + 1 : 0;
  pair_ = has_pair ? 2 : 0;
  n_ = d_ + coupled_ + chain_ + pair_;
  factored_ = pick(2) == 0 || (coupled_ == 0 && chain_ == 0) ? Factored::differential : Factored::algebraic;
  by_time_ = pick(3) == 0;
  start_ = numbers.uniform(-2.0, 2.0);
  unit_ = std::pow(10.0, numbers.uniform(-3.0, 3.0));
  start_ *= unit_;
  s_ = numbers.uniform(0.5, 1.9);
  margin_ = is_singular ? 0.0 : numbers.uniform(0.1, 0.5) + (mu > 0 ? 0.4 : 0.0);
  theta_ = is_singular ? std::acos(0.0) : numbers.uniform(-1.5, 1.5);
  rate_ = numbers.uniform(0.4, 0.65);
  stiffness_ = pick(4) == 0 ? 1e4 : 1.0;
  growth_ = pick(3) == 0 ? numbers.uniform(-4.0, 4.0) : 0.0;
  for (int i = 0; i < n_; ++i) {
    curves_.push_back({0.0, numbers.uniform(-1.0, 1.0), numbers.uniform(0.3, 1.0), numbers.uniform(0.4, 2.5),
                       numbers.uniform(-3.0, 3.0)});
    damping_.push_back(numbers.uniform(0.2, 2.0));
  }
  curves_[0].rise = numbers.uniform(0.7, 1.2);
  curves_[0].size = 0.15;
  if (d_ > 1) damping_[1] *= stiffness_;
  for (int layer = 0; layer < 2 && n_ > 1; ++layer) {
    for (int q = 0; q < n_; ++q) {
      const int i = pick(n_);
      rotations_[layer].push_back({i, (i + 1 + pick(n_ - 1)) % n_, 0, numbers.uniform(-1.5, 1.5), 0.0});
    }
    for (int i = n_ - 1; i > 0; --i)
      bends_[layer].push_back(
          {i, pick(i), numbers.uniform(-0.4, 0.4), numbers.uniform(0.4, 1.2), numbers.uniform(-0.5, 0.5)});
  }
  for (int q = 0; q < n_ && n_ > 1; ++q) {
    const int i = pick(n_);
    turns_.push_back(
        {i, (i + 1 + pick(n_ - 1)) % n_, pick(n_), numbers.uniform(-1.5, 1.5), numbers.uniform(-0.4, 0.4)});
  }
}

template <class V>
std::vector<Dual<V>> SingularSystem::to_canonical(const Dual<V>& s, const V* x, const V* xdot) const {
  using std::sin;
  std::vector<Dual<V>> z;
  for (int i = 0; i < n_; ++i) z.push_back({x[i], xdot[i]});
  for (int layer = 0; layer < 2; ++layer) {
    for (const Turn& r : rotations_[layer]) {
      const Dual<V> a = z[at(r.i)], b = z[at(r.j)];
      z[at(r.i)] = std::cos(r.angle) * a - std::sin(r.angle) * b;
      z[at(r.j)] = std::sin(r.angle) * a + std::cos(r.angle) * b;
    }
    for (const Bend& b : bends_[layer]) z[at(b.i)] = z[at(b.i)] + b.size * sin(b.frequency * z[at(b.j)] + b.rate * s);
  }
  return z;
}

template <class V>
V SingularSystem::factor(const V& s, const V& z0) const {
  V phi = by_time_ ? s - s_ : z0 - curve(0, s_);
  if (!is_singular_) return phi * phi + margin_ * margin_;
  return kind_ == Singularity::square ? phi * phi : phi;
}

template <class V>
void SingularSystem::residual(const V& t, const V* x, const V* xdot, V* F) const {
  using std::sin, std::cos, std::exp;
  const V s = scaled(t);
  std::vector<V> slopes;
  for (int i = 0; i < n_; ++i) slopes.push_back(unit_ * xdot[i]);
  const std::vector<Dual<V>> z = to_canonical(Dual<V>{s, V(1.0)}, x, slopes.data());
  std::vector<Dual<V>> e;
  for (int i = 0; i < n_; ++i) {
    const Curve& c = curves_[at(i)];
    e.push_back({z[at(i)].value - curve(i, s),
                 z[at(i)].slope - (c.rise + (c.size * c.frequency) * cos(c.frequency * s + c.phase))});
  }
  std::vector<V> r;
  for (int i = 0; i < d_; ++i)
    r.push_back(e[at(i)].slope + damping_[at(i)] * e[at(i)].value - 0.3 * sin(e[at((i + 1) % d_)].value));
  for (int i = d_; i < d_ + coupled_; ++i) r.push_back(e[at(i)].value + 0.3 * sin(e[at(i)].value) - 0.4 * e[0].value);
  const int first = d_ + coupled_, pair = first + chain_;
  for (int i = first; i + 1 < pair; ++i)
    r.push_back(e[at(i + 1)].slope - e[at(i)].value - sin(z[0].value) * e[at(i + 1)].value);
  if (chain_ > 0) r.push_back(e[at(pair - 1)].value);
  if (kind_ == Singularity::fold) {
    const V theta_slope =
        is_singular_ ? rate_ + 0.15 * cos(3.0 * (s - s_)) : (1.25 * rate_) * cos(rate_ * s + theta_);
    r.push_back(z[at(pair)].slope - theta_slope * z[at(pair + 1)].value);
    r.push_back(z[at(pair)].value * z[at(pair)].value + z[at(pair + 1)].value * z[at(pair + 1)].value - 1.0);
  } else if (kind_ == Singularity::impasse) {
    r.push_back(z[at(pair)].slope + rate_);
    r.push_back(z[at(pair + 1)].value * z[at(pair + 1)].value - z[at(pair)].value);
  } else {
    V& factored = r[at(factored_ == Factored::differential ? 0 : chain_ > 0 ? pair - 1 : d_)];
    factored = factored * factor(s, z[0].value);
  }
  if (growth_ != 0.0) r[0] = r[0] * exp(growth_ * s);
  for (const Turn& turn : turns_) {
    const V bend = turn.angle + turn.size * sin(x[turn.k] + s);
    const V c = cos(bend), si = sin(bend), a = r[at(turn.i)], b = r[at(turn.j)];
    r[at(turn.i)] = (c * a - si * b) * exp(turn.size * sin(x[turn.k]));
    r[at(turn.j)] = si * a + c * b;
  }
  for (int i = 0; i < n_; ++i) F[i] = r[at(i)];
}

inline std::vector<double> SingularSystem::exact(double t) const {
  const double s = scaled(t);
  std::vector<double> z;
  for (int i = 0; i < n_; ++i) z.push_back(curve(i, s));
  const int pair = d_ + coupled_ + chain_;
  if (kind_ == Singularity::fold) z[at(pair)] = std::sin(angle(s)), z[at(pair + 1)] = std::cos(angle(s));
  if (kind_ == Singularity::impasse) z[at(pair)] = rate_ * (s_ - s), z[at(pair + 1)] = std::sqrt(rate_ * (s_ - s));
  for (int layer = 1; layer >= 0; --layer) {
    for (auto b = bends_[layer].rbegin(); b != bends_[layer].rend(); ++b)
      z[at(b->i)] -= b->size * std::sin(b->frequency * z[at(b->j)] + b->rate * s);
    for (auto r = rotations_[layer].rbegin(); r != rotations_[layer].rend(); ++r) {
      const double a = z[at(r->i)], b = z[at(r->j)];
      z[at(r->i)] = std::cos(r->angle) * a + std::sin(r->angle) * b;
      z[at(r->j)] = std::cos(r->angle) * b - std::sin(r->angle) * a;
    }
  }
  return z;
}

inline double SingularSystem::time_left(double t, const std::vector<double>& x) const {
  const double s = scaled(t);
  const std::vector<double> zero(at(n_), 0.0);
  const std::vector<Dual<double>> z = to_canonical(Dual<double>{s, 1.0}, x.data(), zero.data());
  const int pair = d_ + coupled_ + chain_;
  if (kind_ == Singularity::fold) return unit_ * z[at(pair + 1)].value / (rate_ + 0.15);
  if (kind_ == Singularity::impasse) return unit_ * z[at(pair)].value / rate_;
  if (by_time_) return time() - t;
  const Curve& c = curves_[0];
  return unit_ * (curve(0, s_) - z[0].value) / (c.rise + c.size * c.frequency * std::cos(c.frequency * s_ + c.phase));
}

}  // namespace sfdae_test

#endif
