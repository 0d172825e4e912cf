// x' of the solution: from the derivative array of level mu + 1, or by differences of the constraints.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/small_kernels.h"
#include "problem/failure.h"
#include "reduction/elimination.h"
#include "system/linear_system.h"

namespace sfdae::core {

namespace {

// Points at which the derivative of the constraints is sampled, in units of the time scale or the interval.
constexpr double difference_spacing = 2e-3;

}  // namespace

bool LinearSystem::consistent_derivative(const double* x, double direction, double* xdot) {
  std::vector<double> buffer(index(problem_.n()));
  const bool exact = consistent_scaled_derivative(inward(x, buffer.data()), direction, xdot);
  outward(xdot);
  return exact;
}

bool LinearSystem::exact_derivative(const double* x, double* xdot) {
  std::vector<double> buffer(index(problem_.n()));
  if (!exact_scaled_derivative(inward(x, buffer.data()), xdot)) return false;
  outward(xdot);
  return true;
}

bool LinearSystem::exact_scaled_derivative(const double* x, double* xdot) {
  if (!problem_.prescribed().empty() || !derivative_from_array(x, xdot)) return false;
  // Free directions: x' of smallest norm, as the free part is held.
  const NullSpaceForm& form = current().form;
  if (form.u == 0) return true;
  const Arena::Frame frame(arena_);
  double* along = arena_.take(index(form.unknowns()));
  double* free_part = arena_.take(index(form.u));
  multiply(1.0, Op::transposed, form.T2(), xdot, 0.0, along);
  multiply(1.0, Op::transposed, form.Uz(), along, 0.0, free_part);
  multiply(1.0, Op::plain, form.Uz(), free_part, 0.0, along);
  multiply(-1.0, Op::plain, form.T2(), along, 1.0, xdot);
  return true;
}

bool LinearSystem::consistent_scaled_derivative(const double* x, double direction, double* xdot) {
  if (exact_scaled_derivative(x, xdot)) return true;
  std::fill_n(xdot, problem_.n(), 0.0);
  derivative_from_differences(x, direction, xdot);
  correct_scaled_derivative(std::numeric_limits<double>::infinity(), x, xdot);
  return false;
}

// The array of level mu + 1 determines y_1 = x' once x is known: stages mu+2, ..., 2 of the elimination leave
// [E_0; Y] y_1 = [A_0; X] x + [f_0; g].
bool LinearSystem::derivative_from_array(const double* x, double* xdot) {
  const int level = analysis_.values.mu + 1, m = problem_.m(), n = problem_.n();
  const int highest = settings_.orders_up_to_mu_only ? analysis_.values.mu : settings_.max_index;
  if (level > highest && (settings_.orders_up_to_mu_only || !problem_.is_constant())) return false;
  TaylorData data;
  const double t = current().t;
  const CallbackError error = problem_.evaluate(t, {level, level, level}, current().data.time_scale, data);
  if (error.status == SFDAE_STOPPED || error.status == SFDAE_CALLBACK_STOPPED)
    throw Failure(error.status, error.message());
  if (error.status != SFDAE_OK) return false;
  const Judge::Settings judging{settings_.rank_tol, false, analysis_.noise};
  Judge judge(data, level, judging, nullptr);
  const Arena::Frame frame(arena_);
  const Carried carried = eliminate(data, level, data.f_stack(level), 2, judge, arena_);
  const int rows = m + carried.rows, rank = n - analysis_.values.u;
  if (rows < rank) return false;
  const View S = arena_.matrix(rows, n);
  const View r = arena_.matrix(rows, 1);
  copy(data.E(0), S.block(0, 0, m, n));
  copy(carried.y, S.block(m, 0, carried.rows, n));
  std::copy_n(data.f(0), m, r.data);
  multiply(1.0, Op::plain, data.A(0), x, 1.0, r.data);
  for (int i = 0; i < carried.rows; ++i) r(m + i, 0) = carried.rhs(i, 0);
  multiply(1.0, Op::plain, carried.constraints, x, 1.0, r.data + m);
  // Basic solution of the given rank, in the variables that pivoting picks.
  int* pivots = arena_.integers(n);
  double* tau = arena_.take(index(std::min(rows, n)) + 1);
  factor_qr_pivoted(S, pivots, tau, arena_);
  if (rank > 0 && std::fabs(S(rank - 1, rank - 1)) <= rows * unit_roundoff * std::fabs(S(0, 0))) return false;
  apply_q(Op::transposed, S, rank, tau, r, arena_);
  solve_upper(Op::plain, S.block(0, 0, rank, rank), {r.data, rank, 1, std::max(rank, 1)});
  std::fill_n(xdot, n, 0.0);
  for (int i = 0; i < rank; ++i) xdot[pivots[i]] = r(i, 0) / data.time_scale;
  return true;
}

// The constraints say (I - T2 T2^T) x = xp at every t. Along the solution, with x frozen at its present value,
// the derivative of psi(s) = xp(s) - (I - T2 T2^T)(s) x is the part of x' orthogonal to T2.
void LinearSystem::derivative_from_differences(const double* x, double direction, double* xdot) {
  const int n = problem_.n();
  const double t = current().t;
  // One-sided formula of order 4; a smaller step where the points cannot be reached.
  constexpr double weights[] = {-25.0 / 12.0, 4.0, -3.0, 4.0 / 3.0, -0.25};
  const double wanted = difference_spacing * std::min(problem_.span(), current().data.time_scale);
  if (problem_.room(t, direction) < 4.0 * wanted && problem_.room(t, -direction) > problem_.room(t, direction))
    direction = -direction;
  double step = direction * std::min(wanted, problem_.room(t, direction) / 4.0);
  std::vector<double> psi(index(n)), along(index(n) + 1), psi_here(psi);
  const auto evaluate_psi = [&](std::vector<double>& result) {
    const NullSpaceForm& form = current().form;
    multiply(1.0, Op::transposed, form.T2(), x, 0.0, along.data());
    std::copy_n(form.xp(), n, result.data());
    multiply(1.0, Op::plain, form.T2(), along.data(), 1.0, result.data());
  };
  evaluate_psi(psi_here);
  accept();
  for (int attempt = 0; attempt < 6; ++attempt, step /= 8.0) {
    for (int i = 0; i < n; ++i) xdot[i] = weights[0] / step * (psi_here[index(i)] - x[i]);
    int k = 1;
    for (; k < 5; ++k) {
      const PointStatus status = move_to(t + k * step);
      if (status == PointStatus::callback_error && !callback_error_.is_recoverable())
        throw Failure(callback_error_.status, callback_error_.message());
      if (status != PointStatus::ok) break;
      evaluate_psi(psi);
      for (int i = 0; i < n; ++i) xdot[i] += weights[k] / step * (psi[index(i)] - x[i]);
    }
    if (k == 5) break;
    std::fill_n(xdot, n, 0.0);
  }
  if (constant_ready_) {
    // It was fine before: a failure that has passed is none.
    if (move_to(t) != PointStatus::ok && (!callback_error_.is_recoverable() || move_to(t) != PointStatus::ok))
      throw Failure(callback_error_.status, callback_error_.message());
  } else {
    current_ = 1 - current_;
    accepted_ = true;
  }
}

void LinearSystem::leading_derivative(const double* x, const double* xdot, double* wdot) {
  std::vector<double> x_buffer(index(problem_.n())), xdot_buffer(x_buffer);
  x = inward(x, x_buffer.data());
  xdot = inward(xdot, xdot_buffer.data());
  const Point& point = current();
  const int n = problem_.n(), m = problem_.m();
  const double per_tau = 1.0 / point.data.time_scale;
  const bool E_varies = needs_E1_ && !point.data.is_zero_E(1);
  if (leading_ == LeadingTerm::matrix) {
    // (E x)' = E x' + E' x
    leading_of(xdot, wdot);
    if (!E_varies) return;
    std::vector<double> h(index(m));
    multiply(per_tau, Op::plain, point.data.E(1), x, 0.0, h.data());
    for (int i = 0; i < m; ++i) wdot[i] += h[index(i)] / point.data.row_scale[index(i)];
    return;
  }
  leading_of(xdot, wdot);
  if (leading_ == LeadingTerm::identity || !E_varies) return;
  // P' = S + S^T with S = E^+ E' (I - P), for constant rank.
  const Svd decomposition = svd(point.data.E(0));
  std::vector<double> kernel_part(x, x + n), h(index(std::max(m, n))), s(index(n), 0.0);
  std::vector<double> Px(x, x + n);
  point.form.project(Px.data(), arena_);
  for (int i = 0; i < n; ++i) kernel_part[index(i)] -= Px[index(i)];
  multiply(per_tau, Op::plain, point.data.E(1), kernel_part.data(), 0.0, h.data());
  const auto apply_pseudo_inverse = [&](bool transposed, const double* from, double* to, int from_size, int to_size) {
    const ConstView left = transposed ? decomposition.V.view() : decomposition.U.view();
    const ConstView right = transposed ? decomposition.U.view() : decomposition.V.view();
    std::fill_n(to, to_size, 0.0);
    for (int k = 0; k < analysis_.rank_E; ++k) {
      const double c = small::dot(from_size, left.column(k), from) / decomposition.s[index(k)];
      small::add_scaled(to_size, c, right.column(k), to);
    }
  };
  apply_pseudo_inverse(false, h.data(), s.data(), m, n);
  for (int i = 0; i < n; ++i) wdot[i] += s[index(i)];
  // S^T x = (I - P) E'^T E^+^T x
  std::vector<double> e(index(m)), back(index(n));
  apply_pseudo_inverse(true, x, e.data(), n, m);
  multiply(per_tau, Op::transposed, point.data.E(1), e.data(), 0.0, back.data());
  std::vector<double> projected = back;
  point.form.project(projected.data(), arena_);
  for (int i = 0; i < n; ++i) wdot[i] += back[index(i)] - projected[index(i)];
}

}  // namespace sfdae::core
