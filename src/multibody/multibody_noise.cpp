// What rounding errors of the equations of a mechanical system do to q and v.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_noise.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Signs of a sample of errors: errors that cancel each other in one of them add up in another one.
constexpr int num_samples = 4;

// Of either sign, after Walsh's functions.
double rounding(int i, int sample) {
  const int bits = i & sample;
  return ((bits ^ (bits >> 1)) & 1) == 0 ? unit_roundoff : -unit_roundoff;
}

}  // namespace

void MultibodyNoise::resize(const MultibodySizes& sizes, int differential) {
  const std::size_t size = index(sizes.positions + sizes.velocities);
  for (auto* values : {&of_steps_, &at_rest_}) values->assign(size + 1, 0.0);
  of_rates_.assign(index(num_samples) * index(differential) + 1, 0.0);
}

// A rounding of what is added up in each equation: in g, in C v + r, and in K (a; mu) = (f; -s).
void MultibodyNoise::of_residuals(const MultibodyPoint& point, const Partition& partition, int sample, double* g,
                                  double* velocity, double* forces) const {
  const MultibodyTerms& terms = point.terms;
  const int nl = terms.g_q.rows(), nq = terms.g_q.cols(), nc = terms.C.rows(), nv = terms.M.rows(),
            r = partition.rank;
  for (int j = 0; j < nq; ++j)
    for (int i = 0; i < nl; ++i) g[i] += rounding(i, sample) * std::fabs(terms.g_q(i, j) * point.q[index(j)]);
  for (int j = 0; j < nv; ++j) {
    const std::size_t column = index(j);
    for (int i = 0; i < nc; ++i) velocity[i] += rounding(i, sample) * std::fabs(terms.C(i, j) * point.v[column]);
    for (int i = 0; i < nv; ++i) forces[i] += rounding(i, sample) * std::fabs(terms.M(i, j) * point.a[column]);
    for (int i = 0; i < nc; ++i) forces[j] += rounding(j, sample) * std::fabs(terms.C(i, j) * point.mu[index(i)]);
    forces[j] += rounding(j, sample) * std::fabs(terms.f[column]);
    for (int k = 0; k < r; ++k)
      forces[nv + k] += rounding(k, sample) * std::fabs(terms.C(partition.rows[index(k)], j) * point.a[column]);
  }
  for (int k = 0; k < r; ++k)
    forces[nv + k] += rounding(k, sample) * std::fabs(terms.acceleration_rest[index(partition.rows[index(k)])]);
}

// Rounding errors go the way of residuals. Samples show their size to some factor.
void MultibodyNoise::measure(const MultibodyPoint& point, const MultibodyForm& form, Arena& arena) {
  std::fill(at_rest_.begin(), at_rest_.end(), 0.0);
  for (int sample = 0; sample < num_samples; ++sample) add_sample(point, form, sample, arena);
}

void MultibodyNoise::add_sample(const MultibodyPoint& point, const MultibodyForm& form, int sample, Arena& arena) {
  const int nq = static_cast<int>(point.q.size()), nv = static_cast<int>(point.v.size()), size = nq + nv,
            nl = point.terms.g_q.rows(), nc = point.terms.C.rows(), d = form.unknowns();
  const Arena::Frame frame(arena);
  double* g = arena.zeros(index(nl) + 1);
  double* velocity = arena.zeros(index(nc) + 1);
  double* forces = arena.zeros(index(nv + nc) + 1);
  double* rates = arena.zeros(index(size));
  of_residuals(point, form.velocities(), sample, g, velocity, forces);
  double* at_rest = arena.take(index(size) + 1);
  form.particular(form.tangents(), {g, velocity}, at_rest, arena);
  point.solve(forces);
  std::copy_n(forces, nv, rates + nq);
  form.project(rates, of_rates_.data() + index(sample) * index(d));
  // What local coordinates are rounded to.
  double* yz = arena.take(index(d) + 1);
  double* qv = arena.take(index(size));
  for (int k = 0; k < nq; ++k) rates[k] = rounding(k, sample) * std::fabs(point.q[index(k)]);
  for (int k = 0; k < nv; ++k) rates[nq + k] = rounding(k, sample) * std::fabs(point.v[index(k)]);
  form.project(rates, yz);
  form.expand(ConstView{yz, d, 1, std::max(d, 1)}, View{qv, size, 1, size});
  for (int k = 0; k < size; ++k)
    at_rest_[index(k)] = std::max(at_rest_[index(k)], std::fabs(at_rest[k]) + std::fabs(qv[k]) + std::fabs(rates[k]));
}

void MultibodyNoise::measure_steps(const MultibodyForm& form, const StepMatrix& matrix, Arena& arena) {
  // The largest error of a step may well be larger than a few samples: Andrews' squeezer (BDF, 1e-11) does not start
  // with 5, and starts with 5.5. This leaves room for a factor of three.
  constexpr double safety = 16.0;
  const int d = form.unknowns(), size = static_cast<int>(of_steps_.size()) - 1;
  const Arena::Frame frame(arena);
  double* yz = arena.take(index(d) + 1);
  double* qv = arena.take(index(size) + 1);
  std::fill(of_steps_.begin(), of_steps_.end(), 0.0);
  for (int sample = 0; sample < num_samples; ++sample) {
    std::copy_n(of_rates_.data() + index(sample) * index(d), d, yz);
    matrix.solve(yz);
    form.expand(ConstView{yz, d, 1, std::max(d, 1)}, View{qv, size, 1, std::max(size, 1)});
    for (int k = 0; k < size; ++k) of_steps_[index(k)] = std::max(of_steps_[index(k)], std::fabs(qv[k]));
  }
  for (int k = 0; k < size; ++k) of_steps_[index(k)] = safety * (of_steps_[index(k)] + at_rest_[index(k)]);
}

}  // namespace sfdae::core
