// x' of the solution of a linear problem through a consistent x.
// SPDX-License-Identifier: BSD-3-Clause
#include "linear/linear_derivatives.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "linear/linear_system.h"
#include "problem/failure.h"
#include "reduction/elimination.h"

namespace sfdae::core {

namespace {

// Points at which the derivative of the constraints is sampled, in units of the time scale or the interval: near the
// optimum of a formula of order 4, whose error h^4 equals the roundoff eps / h there (eps^(1/5) = 6e-4).
constexpr double difference_spacing = 2e-3;
// If the points cannot be reached: smaller steps by 8 each; the last one is 1 / 32768 of the first.
constexpr int difference_attempts = 6;
constexpr double difference_reduction = 8.0;

// Takes the free directions out of x': as the free part is held, x' has smallest norm.
void hold_free_directions(const NullSpaceForm& form, double* xdot, Arena& arena) {
  if (form.u == 0) return;
  const Arena::Frame frame(arena);
  double* along = arena.take(index(form.unknowns()));
  double* free_part = arena.take(index(form.u));
  multiply(1.0, Op::transposed, form.T2(), xdot, 0.0, along);
  multiply(1.0, Op::transposed, form.Uz(), along, 0.0, free_part);
  multiply(1.0, Op::plain, form.Uz(), free_part, 0.0, along);
  multiply(-1.0, Op::plain, form.T2(), along, 1.0, xdot);
}

// y_1 from the rows S y_1 = r, of which `rank` are independent, in the variables chosen by pivoting. False if they are
// not clearly independent.
bool basic_solution(View S, View r, int rank, double* y_1, Arena& arena) {
  const int rows = S.rows, n = S.cols;
  int* pivots = arena.integers(n);
  double* tau = arena.take(index(std::min(rows, n)) + 1);
  factor_qr_pivoted(S, pivots, tau, arena);
  if (rank > 0 && std::fabs(S(rank - 1, rank - 1)) <= rows * unit_roundoff * std::fabs(S(0, 0))) return false;
  apply_q(Op::transposed, S, rank, tau, r, arena);
  solve_upper(Op::plain, S.block(0, 0, rank, rank), {r.data, rank, 1, std::max(rank, 1)});
  std::fill_n(y_1, n, 0.0);
  for (int i = 0; i < rank; ++i) y_1[pivots[i]] = r(i, 0);
  return true;
}

}  // namespace

// The derivative array of level mu + 1 determines y_1 = tau x' once x is known: stages mu+2, ..., 2 of the elimination
// leave [E_0; Y] y_1 = [A_0; X] x + [f_0; g].
bool derivative_from_array(LinearProblem& problem, const AnalyzedPoint& at, const double* x, double* xdot,
                           NextLevel next) {
  if (!problem.prescribed().empty()) return false;
  const AnalysisSettings& settings = at.settings;
  const int mu = at.analysis.values.mu, level = mu + 1, m = problem.m(), n = problem.n();
  const int highest = settings.orders_up_to_mu_only ? mu : settings.max_index;
  if (level > highest && (settings.orders_up_to_mu_only || !problem.is_constant())) return false;
  TaylorData& data = next.data;
  Arena& arena = next.arena;
  const CallbackError error = problem.evaluate(at.point.t, {level, level, level}, at.point.data.time_scale, data);
  if (ends_everything(error.status)) error.raise();
  if (error.status != SFDAE_OK) return false;
  const Judge::Settings judging{settings.rank_tol, false, at.analysis.noise};
  Judge judge(data, level, judging, nullptr);
  const Arena::Frame frame(arena);
  const Carried carried = eliminate(data, level, data.f_stack(level), 2, judge, arena);
  const int rows = m + carried.rows, rank = n - at.analysis.values.u;
  if (rows < rank) return false;
  const View S = arena.matrix(rows, n);
  const View r = arena.matrix(rows, 1);
  copy(data.E(0), S.block(0, 0, m, n));
  copy(carried.y, S.block(m, 0, carried.rows, n));
  std::copy_n(data.f(0), m, r.data);
  multiply(1.0, Op::plain, data.A(0), x, 1.0, r.data);
  for (int i = 0; i < carried.rows; ++i) r(m + i, 0) = carried.rhs(i, 0);
  multiply(1.0, Op::plain, carried.constraints, x, 1.0, r.data + m);
  if (!basic_solution(S, r, rank, xdot, arena)) return false;
  for (int i = 0; i < n; ++i) xdot[i] /= data.time_scale;
  hold_free_directions(at.point.form, xdot, arena);
  return true;
}

// The constraints say (I - T2 T2^T) x = xp at every t. Along the solution, with x frozen at its present value,
// the derivative of psi(s) = xp(s) - (I - T2 T2^T)(s) x is the part of x' orthogonal to T2.
void derivative_from_differences(LinearSystem& system, const double* x, double direction, double* xdot) {
  LinearProblem& problem = system.problem();
  const int n = problem.n();
  const double t = system.t();
  // One-sided formula of order 4 on five equidistant points.
  constexpr double weights[] = {-25.0 / 12.0, 4.0, -3.0, 4.0 / 3.0, -0.25};
  const double wanted = difference_spacing * std::min(problem.span(), system.point().data.time_scale);
  if (problem.room(t, direction) < 4.0 * wanted && problem.room(t, -direction) > problem.room(t, direction))
    direction = -direction;
  double step = direction * std::min(wanted, problem.room(t, direction) / 4.0);
  std::vector<double> psi(index(n)), along(index(n) + 1), psi_here(psi);
  // xp + T2 T2^T x
  const auto evaluate_psi = [&](std::vector<double>& result) {
    const NullSpaceForm& form = system.point().form;
    multiply(1.0, Op::transposed, form.T2(), x, 0.0, along.data());
    std::copy_n(form.xp(), n, result.data());
    multiply(1.0, Op::plain, form.T2(), along.data(), 1.0, result.data());
  };
  evaluate_psi(psi_here);
  system.accept();
  for (int attempt = 0; attempt < difference_attempts; ++attempt, step /= difference_reduction) {
    for (int i = 0; i < n; ++i) xdot[i] = weights[0] / step * (psi_here[index(i)] - x[i]);
    int k = 1;
    for (; k < 5; ++k) {
      const PointStatus status = system.move_to(t + k * step);
      if (status == PointStatus::callback_error && !system.callback_error().is_recoverable())
        system.callback_error().raise();
      if (status != PointStatus::ok) break;
      evaluate_psi(psi);
      for (int i = 0; i < n; ++i) xdot[i] += weights[k] / step * (psi[index(i)] - x[i]);
    }
    if (k == 5) break;
    std::fill_n(xdot, n, 0.0);
  }
  system.return_to_accepted(t);
}

}  // namespace sfdae::core
