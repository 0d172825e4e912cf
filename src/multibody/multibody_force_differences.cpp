// mu' of a mechanical system by differences of mu at neighboring points.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_force_differences.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

// Evaluates at t + s, q + s q', v + s v'.
PointStatus MultibodyForceDifferences::evaluate(const MultibodyPoint& point, double s) {
  std::vector<double>&q = neighbour_.q, &v = neighbour_.v;
  neighbour_.t = point.t + s;
  point.rates(q.data());
  for (std::size_t i = 0; i < q.size(); ++i) q[i] = point.q[i] + s * q[i];
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = point.v[i] + s * point.a[i];
  const PointStatus status = equations_.evaluate(neighbour_, partition_);
  if (status == PointStatus::ok) neighbour_.take_least_norm(partition_, arena_);
  return status;
}

double MultibodyForceDifferences::increment(const MultibodyPoint& point, double time_scale) const {
  // The error of differences of order 4 is about the fourth power of this step, 1e-12, and rounding errors are a
  // thousand times those of mu; t + s has to be known to six digits of s.
  constexpr double part_of_time_scale = 1e-3, rounding_of_time = 1e6 * unit_roundoff;
  const int nq = static_cast<int>(point.q.size()), nv = static_cast<int>(point.v.size());
  const Arena::Frame frame(arena_);
  double* rates = arena_.take(point.q.size());
  point.rates(rates);
  const double q = max_abs(point.q.data(), nq), a = max_abs(point.a.data(), nv), speed = max_abs(rates, nq);
  double tau = time_scale;
  if (q > 0.0 && speed > 0.0) tau = std::min(tau, q / speed);
  if (q > 0.0 && a > 0.0) tau = std::min(tau, std::sqrt(q / a));
  return std::max(part_of_time_scale * tau, rounding_of_time * std::fabs(point.t));
}

bool MultibodyForceDifferences::derivative(const MultibodyPoint& point, double time_scale, double* mudot) {
  const MultibodyProblem& problem = equations_.problem();
  const int nc = problem.sizes().constraints();
  double s = increment(point, time_scale);
  const double ahead = problem.room(point.t, 1.0), behind = problem.room(point.t, -1.0);
  const bool is_central = ahead >= 2.0 * s && behind >= 2.0 * s;
  if (!is_central) s = ahead >= behind ? std::min(s, 0.25 * ahead) : -std::min(s, 0.25 * behind);
  if (s == 0.0) return false;
  // Formulas of order 4: derivatives of the polynomials through five points, on both sides or on one.
  constexpr int central_places[] = {-2, -1, 1, 2}, side_places[] = {0, 1, 2, 3, 4};
  constexpr double central_weights[] = {1.0, -8.0, 8.0, -1.0}, side_weights[] = {-25.0, 48.0, -36.0, 16.0, -3.0};
  std::fill_n(mudot, nc, 0.0);
  for (int k = 0; k < (is_central ? 4 : 5); ++k) {
    const int place = is_central ? central_places[k] : side_places[k];
    const double weight = (is_central ? central_weights[k] : side_weights[k]) / (12.0 * s);
    if (place != 0 && evaluate(point, place * s) != PointStatus::ok) {
      const CallbackError& error = equations_.error();
      if (error.status != SFDAE_OK && !error.is_recoverable()) error.raise();
      return false;
    }
    const std::vector<double>& mu = place == 0 ? point.mu : neighbour_.mu;
    for (int i = 0; i < nc; ++i) mudot[i] += weight * mu[index(i)];
  }
  return all_finite(mudot, index(nc));
}

}  // namespace sfdae::core
