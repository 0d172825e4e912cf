// The chord iteration for nonlinear equations: residuals, changes, convergence.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "system/nonlinear_system.h"

namespace sfdae::core {

bool NonlinearSystem::factor_step_matrix(double c) {
  if (matrix_.is_valid() && matrix_.is_for(c)) return true;
  return matrix_.factor(form_, data_.time_scale, c, counts_.factorizations);
}

PointStatus NonlinearSystem::array_residuals(const Jet& jet, double* f) {
  const int mu = analysis_.values.mu, m = problem_.m();
  callback_error_ = problem_.residuals(jet.t, jet.x.data(), mu, f);
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  double power = -1.0;
  for (int k = 0; k <= mu; ++k) {
    power *= data_.time_scale;
    for (int i = 0; i < m; ++i) f[k * m + i] *= power * data_.row_scale[index(i)];
  }
  return PointStatus::ok;
}

PointStatus NonlinearSystem::differential_residuals(double t, const double* x, const double* xdot) {
  const std::size_t n = index(problem_.n());
  const Arena::Frame frame(arena_);
  double* jet = arena_.take(2 * n);
  std::copy_n(x, n, jet);
  std::copy_n(xdot, n, jet + n);
  callback_error_ = problem_.residuals(t, jet, 0, data_.f(0));
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  for (int i = 0; i < problem_.m(); ++i) data_.f(0)[i] *= -data_.time_scale * data_.row_scale[index(i)];
  return PointStatus::ok;
}

// The constraints of the form become those for changes of x at the jet; f: its residuals.
void NonlinearSystem::read_constraints(const Jet& jet, const double* f, double* transformed) {
  const Arena::Frame frame(arena_);
  elimination_.transform(f, transformed, arena_);
  double largest = 0.0;
  for (int i = 0; i < problem_.n(); ++i) largest = std::max(largest, std::fabs(jet.x[index(i)]) / units_[i]);
  data_.least_norm_f = data_.norm(analysis_.values.mu) * largest;
  const std::vector<int>& components = problem_.prescribed();
  double* missing = arena_.take(components.size() + 1);
  for (std::size_t q = 0; q < components.size(); ++q) {
    const std::size_t i = index(components[q]);
    missing[q] = (prescribed_values_[q] - jet.x[i]) / units_[i];
  }
  form_.replace_rhs(data_, transformed, {&components, missing}, arena_);
  data_.least_norm_f = 0.0;
}

// dx scaled; y_change_ := the change of y that belongs to it.
void NonlinearSystem::apply_change(const double* dx, const double* f, const double* transformed, Jet& jet) {
  elimination_.recover(data_, {f, transformed}, dx, y_change_.data(), arena_);
  const int n = problem_.n();
  double power = 1.0;
  for (int k = 0; k <= analysis_.values.mu + 1; ++k) {
    const double factor = k == 0 ? 1.0 : 1.0 / (k * (power *= data_.time_scale));
    const double* change = k == 0 ? dx : y_change_.data() + static_cast<std::ptrdiff_t>(k - 1) * n;
    double* to = jet.column(k);
    for (int i = 0; i < n; ++i) to[i] += factor * change[i] * units_[i];
  }
}

// Of the last change, in units of the tolerance, or relative to x without weights. step: the changes of y count as
// far as they act over it.
double NonlinearSystem::change_norm(const Task& task, const double* dx, const Jet& jet) const {
  const int n = problem_.n();
  // Rounding errors will not become less.
  const auto above_noise = [&](double change, std::size_t i) { return std::max(0.0, std::fabs(change) - noise_[i]); };
  double norm = 0.0;
  if (task.inverse_weights == nullptr) {
    // y has to follow, if not to the last digits: ranks are read there.
    constexpr double share_of_y = 1e-3;
    double size = 0.0, size_y = 0.0, norm_y = 0.0, power = 1.0;
    for (int i = 0; i < n; ++i) {
      norm = std::max(norm, above_noise(dx[i], index(i)));
      size = std::max(size, std::fabs(jet.x[index(i)]) / units_[i]);
    }
    for (int k = 1; k <= analysis_.values.mu + 1; ++k) {
      power *= data_.time_scale;
      for (int i = 0; i < n; ++i) {
        norm_y = std::max(norm_y, above_noise(y_change_[index((k - 1) * n + i)], index(k * n + i)));
        size_y = std::max(size_y, k * power * std::fabs(jet.column(k)[i]) / units_[i]);
      }
    }
    return std::max(size > 0.0 ? norm / size : norm,
                    size_y > 0.0 ? share_of_y * norm_y / std::max(size, size_y) : 0.0);
  }
  for (int i = 0; i < n; ++i)
    norm = std::max(norm, above_noise(dx[i], index(i)) * units_[i] * task.inverse_weights[i]);
  const double ratio = 1.0 / (std::fabs(task.c) * data_.time_scale);
  double power = 1.0;
  for (int k = 1; k <= analysis_.values.mu + 1; ++k) {
    power *= ratio;
    const double* change = y_change_.data() + static_cast<std::ptrdiff_t>(k - 1) * n;
    for (int i = 0; i < n; ++i)
      norm =
          std::max(norm, power / k * above_noise(change[i], index(k * n + i)) * units_[i] * task.inverse_weights[i]);
  }
  return norm;
}

// z of M z = b - c tau g0 and, for the free part, -tau Uz^T T2^T (c x + x_rest).
void NonlinearSystem::step_rhs(const Task& task, const Jet& jet, double* z) {
  const double tau = data_.time_scale;
  const int n = problem_.n(), d = form_.d;
  for (int i = 0; i < d; ++i) z[i] = form_.b()[i] - tau * task.c * form_.g0()[i];
  if (form_.u == 0) return;
  const Arena::Frame frame(arena_);
  double* rest = arena_.take(index(n));
  double* along = arena_.take(index(form_.unknowns()));
  for (int i = 0; i < n; ++i) rest[i] = (task.c * jet.x[index(i)] + task.x_rest[i]) / units_[i];
  multiply(1.0, Op::transposed, form_.T2(), rest, 0.0, along);
  multiply(-tau, Op::transposed, form_.Uz(), along, 0.0, z + d);
}

PointStatus NonlinearSystem::iterate(const Task& task, Jet& jet) {
  const int most = task.has_step ? 12 : 30, n = problem_.n();
  if (task.has_step && !factor_step_matrix(task.c)) return PointStatus::singular;
  double before = 0.0, earlier = 0.0, largest_residual = 0.0;
  chord_.begin();
  for (int iteration = 0; iteration < most; ++iteration) {
    PointStatus status = array_residuals(jet, array_f_.data());
    if (status == PointStatus::ok && task.has_step) {
      for (int i = 0; i < n; ++i) xdot_[index(i)] = task.c * jet.x[index(i)] + task.w_rest[i];
      status = differential_residuals(jet.t, jet.x.data(), xdot_.data());
    }
    if (status != PointStatus::ok) return status;
    const double residual = max_abs(array_f_.data(), problem_.m() * (analysis_.values.mu + 1));
    largest_residual = std::max(largest_residual, residual);
    read_constraints(jet, array_f_.data(), transformed_f_.data());
    if (task.has_step) {
      step_rhs(task, jet, z_.data());
      matrix_.solve(z_.data());
    } else {
      keep_differential_part();
    }
    std::copy_n(form_.xp(), n, change_.data());
    multiply(1.0, Op::plain, form_.T2(), z_.data(), 1.0, change_.data());
    apply_change(change_.data(), array_f_.data(), transformed_f_.data(), jet);
    const double norm = change_norm(task, change_.data(), jet);
    if (!std::isfinite(norm)) return PointStatus::not_converged;
    // Without a step, what one iteration gains the next may lose in part: linearizations are from elsewhere.
    const double reference = task.has_step ? before : std::max(before, earlier);
    if (has_converged(task, iteration, norm, reference) &&
        derivatives_follow(jet, iteration, residual, largest_residual)) {
      read_inconsistency(task, jet);
      // Known ranks may not fit the jet that was linearized.
      const bool is_doubtful = task.has_step && !linearized_judged_ && inconsistency_ > contradiction;
      return is_doubtful ? PointStatus::not_converged : PointStatus::ok;
    }
    if (ChordIteration::is_too_slow(iteration, norm, reference)) return PointStatus::not_converged;
    earlier = before;
    before = norm;
  }
  return PointStatus::not_converged;
}

// Residuals that the iteration has left look like contradictions, but vanish when it goes on.
void NonlinearSystem::read_inconsistency(const Task& task, const Jet& jet) {
  const bool is_noise = form_.inconsistency() <= 1e3 * data_.noise(analysis_.values.mu) / pivot_;
  inconsistency_ = is_noise ? 0.0 : form_.inconsistency();
  if (is_noise || task.inverse_weights == nullptr) return;
  polished_ = jet;
  const bool was_slow = chord_.is_slow();
  if (iterate(Task{}, polished_) != PointStatus::ok) inconsistency_ = std::min(inconsistency_, form_.inconsistency());
  chord_.set_slow(was_slow);
}

bool NonlinearSystem::has_converged(const Task& task, int iteration, double norm, double before) {
  if (task.inverse_weights == nullptr) {
    // To rounding: until changes stop becoming smaller.
    constexpr double negligible = 4.0 * unit_roundoff, small = 1e-13;
    return norm <= negligible || (iteration > 1 && norm <= small && norm > 0.5 * before);
  }
  constexpr double least_rate = 1e-3;
  return chord_.has_converged({task.tolerance, least_rate}, iteration, norm, before);
}

// Changes of y count little in short steps. Where they lead nowhere, so that residuals stay, the constraints for x
// are those of a wrong y.
bool NonlinearSystem::derivatives_follow(const Jet& jet, int iteration, double residual, double largest) const {
  constexpr double reduction = 0.5, negligible = 1e-10;
  if (iteration == 0 || residual <= reduction * largest) return true;
  double size = 0.0, power = 1.0;
  for (int k = 0; k <= analysis_.values.mu + 1; ++k) {
    const double factor = k == 0 ? 1.0 : k * (power *= data_.time_scale);
    for (int j = 0; j < problem_.n(); ++j) size = std::max(size, factor * std::fabs(jet.column(k)[j]) / units_[j]);
  }
  return residual <= negligible * size * data_.norm(analysis_.values.mu);
}

}  // namespace sfdae::core
