// Effect of rounding errors of the equations of a mechanical system on q and v.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_noise.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Signs of a sample of errors: errors that cancel in one sample add up in another.
constexpr int num_samples = 4;
// The largest error of a step may well be larger than a few samples: Andrews' squeezer (BDF, 1e-11) does not start with
// 5, and starts with 5.5. This leaves a margin of a factor of three.
constexpr double safety = 16.0;

// Unit roundoff with a sign by Walsh's functions.
double signed_roundoff(int i, int sample) {
  const int bits = i & sample;
  return ((bits ^ (bits >> 1)) & 1) == 0 ? unit_roundoff : -unit_roundoff;
}

}  // namespace

void MultibodyNoise::resize(const MultibodySizes& sizes, int differential) {
  const std::size_t size = index(sizes.positions + sizes.velocities);
  for (auto* values : {&of_steps_, &at_rest_}) values->assign(size + 1, 0.0);
  of_rates_.assign(index(num_samples) * index(differential) + 1, 0.0);
}

// Sizes of the sums in each equation: in g, in C v + r, and in K (a; mu) = (f; -s).
void MultibodyNoise::add_sizes(const MultibodyPoint& point, const Partition& partition, double* g, double* velocity,
                               double* forces) const {
  const MultibodyTerms& terms = point.terms;
  const int nl = terms.g_q.rows(), nq = terms.g_q.cols(), nc = terms.C.rows(), nv = terms.M.rows(),
            r = partition.rank;
  for (int j = 0; j < nq; ++j)
    for (int i = 0; i < nl; ++i) g[i] += std::fabs(terms.g_q(i, j) * point.q[index(j)]);
  for (int j = 0; j < nv; ++j) {
    const std::size_t column = index(j);
    for (int i = 0; i < nc; ++i) velocity[i] += std::fabs(terms.C(i, j) * point.v[column]);
    for (int i = 0; i < nv; ++i) forces[i] += std::fabs(terms.M(i, j) * point.a[column]);
    for (int i = 0; i < nc; ++i) forces[j] += std::fabs(terms.C(i, j) * point.mu[index(i)]);
    forces[j] += std::fabs(terms.f[column]);
    for (int k = 0; k < r; ++k) forces[nv + k] += std::fabs(terms.C(partition.rows[index(k)], j) * point.a[column]);
  }
  for (int k = 0; k < r; ++k) forces[nv + k] += std::fabs(terms.acceleration_rest[index(partition.rows[index(k)])]);
}

// Rounding errors propagate as residuals do. Samples show their size to some factor.
void MultibodyNoise::measure(const MultibodyPoint& point, const MultibodyForm& form, Arena& arena) {
  const int nq = static_cast<int>(point.q.size()), nv = static_cast<int>(point.v.size()), size = nq + nv,
            nl = point.terms.g_q.rows(), nc = point.terms.C.rows(), r = form.velocities().rank, d = form.unknowns();
  const Arena::Frame frame(arena);
  double *const g = arena.zeros(index(nl) + 1), *const velocity = arena.zeros(index(nc) + 1),
                *const forces = arena.zeros(index(nv + nc) + 1);
  add_sizes(point, form.velocities(), g, velocity, forces);
  const View in_forces = arena.matrix(nv + r, num_samples), at_rest = arena.matrix(size, num_samples);
  const View in_rates = arena.matrix(size, num_samples), of_rates{of_rates_.data(), d, num_samples, std::max(d, 1)};
  double *const in_g = arena.take(index(nl) + 1), *const in_velocity = arena.take(index(nc) + 1);
  for (int sample = 0; sample < num_samples; ++sample) {
    for (int i = 0; i < nl; ++i) in_g[i] = signed_roundoff(i, sample) * g[i];
    for (int i = 0; i < nc; ++i) in_velocity[i] = signed_roundoff(i, sample) * velocity[i];
    form.particular(form.tangents(), {in_g, in_velocity}, at_rest.column(sample), arena);
    double* const in_force = in_forces.column(sample);
    for (int i = 0; i < nv; ++i) in_force[i] = signed_roundoff(i, sample) * forces[i];
    for (int k = 0; k < r; ++k) in_force[nv + k] = signed_roundoff(k, sample) * forces[nv + k];
  }
  point.solve(in_forces);
  fill(in_rates.top(nq), 0.0);
  copy(in_forces.top(nv), in_rates.block(nq, 0, nv, num_samples));
  form.project(in_rates, of_rates);
  // Rounding errors of local coordinates.
  const View yz = arena.matrix(d, num_samples), qv = arena.matrix(size, num_samples);
  for (int sample = 0; sample < num_samples; ++sample) {
    double* const rates = in_rates.column(sample);
    for (int k = 0; k < nq; ++k) rates[k] = signed_roundoff(k, sample) * std::fabs(point.q[index(k)]);
    for (int k = 0; k < nv; ++k) rates[nq + k] = signed_roundoff(k, sample) * std::fabs(point.v[index(k)]);
  }
  form.project(in_rates, yz);
  form.expand(yz, qv);
  std::fill(at_rest_.begin(), at_rest_.end(), 0.0);
  for (int sample = 0; sample < num_samples; ++sample)
    for (int k = 0; k < size; ++k)
      at_rest_[index(k)] = std::max(at_rest_[index(k)], std::fabs(at_rest(k, sample)) + std::fabs(qv(k, sample)) +
                                                            std::fabs(in_rates(k, sample)));
}

void MultibodyNoise::measure_steps(const MultibodyForm& form, const MultibodyStepMatrix& matrix, Arena& arena) {
  const int d = form.unknowns(), size = static_cast<int>(of_steps_.size()) - 1;
  const Arena::Frame frame(arena);
  const View yz = arena.matrix(d, num_samples), qv = arena.matrix(size, num_samples);
  copy(ConstView{of_rates_.data(), d, num_samples, std::max(d, 1)}, yz);
  matrix.solve(yz);
  form.expand(yz, qv);
  std::fill(of_steps_.begin(), of_steps_.end(), 0.0);
  for (int sample = 0; sample < num_samples; ++sample)
    for (int k = 0; k < size; ++k) of_steps_[index(k)] = std::max(of_steps_[index(k)], std::fabs(qv(k, sample)));
  for (int k = 0; k < size; ++k) of_steps_[index(k)] = safety * (of_steps_[index(k)] + at_rest_[index(k)]);
}

double MultibodyNoise::sums_of_steps(int k) const { return of_steps_[index(k)] / (safety * unit_roundoff); }

}  // namespace sfdae::core
