// SPDX-License-Identifier: BSD-3-Clause
// Random sparse systems F(t, x, x') = 0 of which everything is known, with a structure that is right or misleads.
//
// With the deviation e = z - z*(t) from a chosen solution:
//   w_i' = z*_i' - b_i e_i + terms in two other e          c_i:  e_i + 0.3 sin e_i = 0.4 sin e_w
//   block of size k:  e_{i+1}' = e_i + sin(e_w) e_{i+1} / 2,  0 = e_k + 0.3 sin(e_w)     mu = k - 1 for the longest one
// Unknowns and equations are permuted. Where the structure is to mislead, multiples of equations are added to others,
// and derivatives that cancel: the solutions stay, but not what the equations contain.
#ifndef SFDAE_TESTS_SPARSE_SYSTEM_H
#define SFDAE_TESTS_SPARSE_SYSTEM_H

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "linear_family.h"
#include "random_system.h"

namespace sfdae_test {

class SparseSystem {
 public:
  // How structure is to mislead: not at all, by sums with constant factors, or with factors that vary, too.
  enum class Mixing { none, constant, any };
  SparseSystem(unsigned seed, Mixing mixing);

  int n() const { return n_; }
  CharacteristicValues values() const { return values_; }
  std::vector<double> exact(double t) const;

  template <class V>
  void residual(const V& t, const V* x, const V* xdot, V* F) const;

 private:
  struct Wave {
    double mean, size, frequency, phase;
  };
  struct Mix {  // F_to += (factor + size sin x_k) F_from + slope (x'_k - x'_k)
    int to, from, k;
    double factor, size, slope;
  };
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  template <class V>
  std::vector<V> canonical(const std::vector<V>& e, const std::vector<V>& slope) const;
  std::vector<int> permutation(RandomNumbers& numbers) const;

  int d_ = 0, coupled_ = 0, n_ = 0;
  bool ends_know_w_ = false;  // w do not contain the chains then
  std::vector<int> blocks_;
  CharacteristicValues values_{};
  std::vector<Wave> waves_;
  std::vector<double> damping_;
  std::vector<int> neighbour_;
  std::vector<int> unknown_, equation_;  // places of z_i and of canonical equation i
  std::vector<Mix> mixes_;
};

inline std::vector<int> SparseSystem::permutation(RandomNumbers& numbers) const {
  std::vector<int> places(at(n_));
  for (int i = 0; i < n_; ++i) places[at(i)] = i;
  for (int i = n_ - 1; i > 0; --i)
    std::swap(places[at(i)], places[at(static_cast<int>(numbers.uniform(0.0, i + 0.999)))]);
  return places;
}

inline SparseSystem::SparseSystem(unsigned seed, Mixing mixing) {
  RandomNumbers numbers(seed);
  const auto below = [&numbers](int bound) { return static_cast<int>(numbers.uniform(0.0, bound - 1e-9)); };
  d_ = 1 + below(4);
  coupled_ = below(3);
  for (int count = 1 + below(2); count > 0; --count) blocks_.push_back(1 + below(4));
  ends_know_w_ = below(2) == 1;
  int longest = 1, block_sizes = 0;
  for (const int k : blocks_) longest = std::max(longest, k), block_sizes += k;
  n_ = d_ + coupled_ + block_sizes;
  values_ = {longest - 1, d_, coupled_ + block_sizes, 0, 0};
  for (int i = 0; i < n_; ++i) {
    waves_.push_back({numbers.uniform(-1.0, 1.0), numbers.uniform(0.3, 1.0), numbers.uniform(0.5, 2.0),
                      numbers.uniform(0.0, 6.0)});
    damping_.push_back(numbers.uniform(0.2, 2.0));
    neighbour_.push_back(below(ends_know_w_ ? d_ : n_));
  }
  unknown_ = permutation(numbers);
  equation_ = permutation(numbers);
  for (int count = mixing != Mixing::none ? 1 + below(2 * n_) : 0; count > 0; --count) {
    const int to = below(n_), from = below(n_);
    if (to != from)
      mixes_.push_back({to, from, below(n_), numbers.uniform(-1.5, 1.5), below(2) * 0.5, below(3) == 0 ? 1.0 : 0.0});
    if (mixing == Mixing::constant && to != from) mixes_.back().size = 0.0;
  }
}

inline std::vector<double> SparseSystem::exact(double t) const {
  std::vector<double> x(at(n_));
  for (int i = 0; i < n_; ++i) {
    const Wave& w = waves_[at(i)];
    x[at(unknown_[at(i)])] = w.mean + w.size * std::sin(w.frequency * t + w.phase);
  }
  return x;
}

// slope: e'.
template <class V>
std::vector<V> SparseSystem::canonical(const std::vector<V>& e, const std::vector<V>& slope) const {
  using std::sin;
  std::vector<V> r;
  for (int i = 0; i < d_; ++i)
    r.push_back(slope[at(i)] + damping_[at(i)] * e[at(i)] + 0.5 * sin(e[at(neighbour_[at(i)])]) -
                0.3 * (e[at((i + 1) % d_)] * e[at(i)]));
  for (int i = d_; i < d_ + coupled_; ++i) r.push_back(e[at(i)] + 0.3 * sin(e[at(i)]) - 0.4 * sin(e[at(i % d_)]));
  int first = d_ + coupled_;
  for (const int k : blocks_) {
    for (int i = first; i + 1 < first + k; ++i)
      r.push_back(slope[at(i + 1)] - e[at(i)] - 0.5 * (sin(e[at(i % d_)]) * e[at(i + 1)]));
    const int last = first + k - 1;
    r.push_back(ends_know_w_ ? e[at(last)] + 0.3 * sin(e[at(last % d_)]) : e[at(last)] + 0.0);
    first += k;
  }
  return r;
}

template <class V>
void SparseSystem::residual(const V& t, const V* x, const V* xdot, V* F) const {
  using std::cos, std::sin;
  std::vector<V> e, slope;
  for (int i = 0; i < n_; ++i) {
    const Wave& w = waves_[at(i)];
    const V angle = w.frequency * t + w.phase;
    e.push_back(x[unknown_[at(i)]] - (w.mean + w.size * sin(angle)));
    slope.push_back(xdot[unknown_[at(i)]] - (w.size * w.frequency) * cos(angle));
  }
  const std::vector<V> r = canonical(e, slope);
  for (int i = 0; i < n_; ++i) F[equation_[at(i)]] = r[at(i)];
  for (const Mix& mix : mixes_) {
    F[mix.to] = F[mix.to] + (mix.factor + mix.size * sin(x[mix.k])) * F[mix.from];
    if (mix.slope != 0.0) F[mix.to] = F[mix.to] + (mix.slope * xdot[mix.k] - mix.slope * xdot[mix.k]);
  }
}

}  // namespace sfdae_test

#endif
