// Derivatives of the values after a jump by impulses.
// SPDX-License-Identifier: BSD-3-Clause
#include "starts/jump_derivatives.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "starts/jet_solver.h"
#include "starts/nonlinear_jump.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Residual relative to the terms of an equation, or to the values that move: rounding errors, and errors of these
// values, leave less if the jump moves as its equations say. (Chosen, as for factors in nonlinear_jump.cpp.)
constexpr double jump_contradiction = 1e-6;
// Changes of x after the jump, relative, that count as none.
constexpr double converged_derivative = 1e-10;
constexpr int most_corrections = 3;

void add_absolute(ConstView A, ConstView X, View sums) {
  for (int j = 0; j < X.cols; ++j)
    for (int k = 0; k < A.cols; ++k)
      for (int i = 0; i < A.rows; ++i) sums(i, j) += std::fabs(A(i, k) * X(k, j));
}

}  // namespace

struct JumpDerivatives::Solution : JumpPoint {};

// Derivatives of R_0, ..., R_mu, one below the other, with theta held.
struct JumpDerivatives::Slopes {
  Matrix by_x, by_parameters;
  Vector by_time;
};

// Columns for each direction, scaled: dx, and dtheta_0, ..., dtheta_mu one below the other.
struct JumpDerivatives::Motion {
  Matrix dx, dtheta;
  Vector sizes;
};

JumpDerivatives::JumpDerivatives(RecordedProblem& problem, std::vector<int> parameters)
    : problem_(problem),
      parameters_(std::move(parameters)),
      series_(problem, parameters_),
      formulas_(problem.evaluator(), parameters_) {}

// Solves the jump to machine precision, starting from known values after it.
bool JumpDerivatives::solve_jump(const LinearizedConstraints::Known& known, const MovingJump& moving,
                                 LinearizedConstraints& constraints, Solution& solution) {
  const int n = problem_.n(), mu = known.analysis.values.mu;
  const std::vector<int> no_components;
  const InputsAfter no_inputs{no_components, {}};
  JetSolver solver(problem_, known.units);
  for (int iteration = 0; iteration < most_corrections; ++iteration) {
    Jet longer = solution.jet;
    longer.set_order(mu + 2);
    constraints.linearize(solution.jet);
    if (!constraints.has_known_ranks()) return false;
    solution.data = coefficients_of_jump(problem_, known, longer, nullptr, {mu + 1, mu, mu});
    Vector change(moving.before, moving.before + n);
    for (int i = 0; i < n; ++i) change[index(i)] -= solution.jet.x[index(i)];
    const double size = std::max(constraints.size_of(solution.jet), known.units.largest(moving.before, n));
    const Jump jump =
        jump_by_impulses({constraints.point(), solution.data, mu, no_inputs, size}, change, &solution.theta);
    if (known.units.largest(jump.x.data(), n) <= converged_derivative * size) return true;
    constraints.move_by(jump.x, solution.jet);
    solver.solve(solution.jet, mu);
  }
  return false;
}

bool JumpDerivatives::find_slopes(const LinearizedConstraints::Known& known, const Solution& at,
                                  const MovingJump& moving, Slopes& slopes) {
  const int m = problem_.m(), n = problem_.n(), mu = known.analysis.values.mu, rows = (mu + 1) * m;
  slopes.by_x = Matrix(rows, n);
  slopes.by_parameters = Matrix(rows, moving.directions());
  slopes.by_time.assign(index(rows), 0.0);
  if (!formulas_.evaluate(problem_.evaluator(), at.data, known.units, at.theta, at.jet.x.data(), slopes.by_x,
                          slopes.by_parameters.view().columns(0, static_cast<int>(parameters_.size()))))
    return false;
  // Derivative along the jet, less the part due to x.
  const double tau = at.data.time_scale;
  for (int p = 0; p <= mu; ++p) {
    double* const to = slopes.by_time.data() + index(p * m);
    for (int j = p; j <= mu; ++j) {
      const double* const theta = at.theta.view().column(j);
      multiply((j - p + 1) / tau, Op::plain, at.data.E(j - p + 1), theta, 1.0, to);
      if (j > p) multiply((j - p) / (tau * j), Op::plain, at.data.A(j - p), theta, 1.0, to);
    }
  }
  Vector slope(index(n));
  for (int i = 0; i < n; ++i) slope[index(i)] = at.jet.column(1)[i] / known.units[i];
  multiply(-1.0, Op::plain, slopes.by_x, slope.data(), 1.0, slopes.by_time.data());
  return true;
}

// dx for z = 0. Along t the jet of the solution is shifted, and the residual of the derivative array corrected.
bool JumpDerivatives::find_particular(const Solution& at, const MovingJump& moving,
                                      LinearizedConstraints& constraints, View dx) {
  const int m = problem_.m(), n = problem_.n(), count = moving.directions(), mu = at.theta.cols() - 1;
  const TaylorData& data = constraints.point().data;
  const Units& units = constraints.point().units;
  Matrix f((mu + 1) * m, count);
  const CallbackError error =
      series_.evaluate(data, at.jet.x.data(), mu, f.view().columns(0, static_cast<int>(parameters_.size())));
  if (error.status != SFDAE_OK) error.raise();
  Jet longer = at.jet;
  longer.set_order(mu + 2);
  Matrix F(m, mu + 2);
  if (!problem_.evaluator().values(at.jet.t, longer.x.data(), mu + 1, F.data())) return false;
  Vector sizes(index(count), 0.0);
  for (int j = 0; j < count; ++j) {
    const double dt = moving.shifts[j];
    sizes[index(j)] = units.largest(at.jet.column(1), n) * std::fabs(dt);
    double power = dt;
    for (int k = 0; k <= mu; ++k) {
      power *= data.time_scale;
      for (int i = 0; i < m && dt != 0.0; ++i)
        if (data.has_row(i, k)) f(i + k * m, j) -= power * data.row_scale[index(i)] * (k + 1) * F(i, k + 1);
    }
  }
  if (!constraints.find_particular(f, sizes.data(), dx)) return false;
  for (int j = 0; j < count; ++j)
    for (int i = 0; i < n; ++i) dx(i, j) += at.jet.column(1)[i] / units[i] * moving.shifts[j];
  return true;
}

namespace {

// Differentiated equations of impulses; worst_of() gives their worst relative residual.
struct Left {
  const TaylorData& data;
  const Matrix& by_x;
  const Matrix& by_parameters;
  const Vector& by_time;
  const double* shifts;
};
double worst_of(const Left& equations, int mu, ConstView dx, ConstView dtheta, const Vector& sizes) {
  const TaylorData& data = equations.data;
  const int m = data.m, n = data.n, count = dx.cols;
  double worst = 0.0;
  for (int p = 0; p <= mu; ++p) {
    Matrix left(m, count), size(m, count);
    const auto add = [&](ConstView A, ConstView X) {
      multiply(1.0, Op::plain, A, Op::plain, X, 1.0, left);
      add_absolute(A, X, size);
    };
    for (int j = p; j <= mu; ++j) {
      Matrix block(m, n);
      add_impulse_block(data, p, j, block);
      add(block, dtheta.block(j * n, 0, n, count));
    }
    add(equations.by_x.view().block(p * m, 0, m, n), dx);
    for (int j = 0; j < count; ++j)
      for (int i = 0; i < m; ++i) {
        const double by_time = equations.by_time[index(p * m + i)] * equations.shifts[j];
        const double by_parameter = equations.by_parameters(p * m + i, j);
        const double sum = size(i, j) + std::fabs(by_time) + std::fabs(by_parameter);
        const double scale = std::max(sum, sizes[index(j)]);
        if (sum > 0.0) worst = std::max(worst, std::fabs(left(i, j) + by_time + by_parameter) / scale);
        if (!std::isfinite(sum)) return sum;
      }
  }
  return worst;
}

}  // namespace

// Tests with the coefficients of a jet with other derivatives, between the values before and after the jump.
bool JumpDerivatives::holds_aside(const LinearizedConstraints::Known& known, const Solution& at,
                                  const MovingJump& moving, const Motion& motion) {
  constexpr double part = 0.37, weakest = 1e-7, weaker = 1e-3;
  const int mu = known.analysis.values.mu;
  for (double strength = 1.0; strength > weakest; strength *= weaker) {
    Solution aside;
    aside.theta = at.theta;
    aside.jet = jet_aside(known, at, part, strength);
    Jet longer = aside.jet;
    longer.set_order(mu + 2);
    try {
      aside.data = coefficients_of_jump(problem_, known, longer, &at.data.row_scale, {mu + 1, mu, mu});
    } catch (const Failure& failure) {
      if (failure.status() != SFDAE_NOT_FINITE && failure.status() != SFDAE_CALLBACK_FAILED) throw;
      continue;
    }
    Slopes slopes;
    if (!find_slopes(known, aside, moving, slopes)) continue;
    const Left left{aside.data, slopes.by_x, slopes.by_parameters, slopes.by_time, moving.shifts};
    return worst_of(left, mu, motion.dx, motion.dtheta, motion.sizes) <= jump_contradiction;
  }
  return false;
}

bool JumpDerivatives::find(const LinearizedConstraints::Known& known, const Jet& start, const MovingJump& moving,
                           View after) {
  const int m = problem_.m(), n = problem_.n(), mu = known.analysis.values.mu, count = moving.directions();
  const bool moves_in_time = std::any_of(moving.shifts, moving.shifts + count, [](double dt) { return dt != 0.0; });
  // Some orders required for derivatives by t are not available then.
  if (moves_in_time && problem_.counts_are_given()) return false;
  series_.take_parameters();
  Solution solution;
  solution.jet = start;
  solution.jet.set_order(mu + 1);
  LinearizedConstraints constraints(problem_, known);
  if (!solve_jump(known, moving, constraints, solution)) return false;
  Slopes slopes;
  if (!find_slopes(known, solution, moving, slopes)) return false;
  const ConstView T2 = constraints.point().form.T2();
  const int z = T2.cols, rows = (mu + 1) * m, unknowns = z + mu * n;
  if (rows < unknowns) return false;
  Motion motion{Matrix(n, count), Matrix((mu + 1) * n, count), Vector(index(count), 0.0)};
  if (!find_particular(solution, moving, constraints, motion.dx)) return false;
  const View dtheta_0 = motion.dtheta.view().block(0, 0, n, count);
  for (int j = 0; j < count; ++j) {
    motion.sizes[index(j)] =
        std::max(max_abs(motion.dx.view().column(j), n), known.units.largest(moving.moved.column(j), n));
    for (int i = 0; i < n; ++i) dtheta_0(i, j) = motion.dx(i, j) - moving.moved(i, j) / known.units[i];
  }

  // The equations of z, dtheta_1, ..., dtheta_mu.
  Matrix C(rows, unknowns), b(rows, count);
  const View of_z = C.view().columns(0, z);
  multiply(1.0, Op::plain, slopes.by_x, Op::plain, T2, 0.0, of_z);
  multiply(1.0, Op::plain, solution.data.E(0), Op::plain, T2, 1.0, of_z.top(m));
  copy(impulse_columns(solution.data, mu), C.view().columns(z, mu * n));
  multiply(-1.0, Op::plain, slopes.by_x, Op::plain, motion.dx, 0.0, b);
  multiply(-1.0, Op::plain, solution.data.E(0), Op::plain, dtheta_0, 1.0, b.view().top(m));
  for (int j = 0; j < count; ++j)
    for (int i = 0; i < rows; ++i)
      b(i, j) -= slopes.by_parameters(i, j) + slopes.by_time[index(i)] * moving.shifts[j];
  Matrix y(unknowns, count);
  if (unknowns > 0 && !solve_least_squares(C, b, y, arena_)) return false;

  multiply(1.0, Op::plain, T2, Op::plain, y.view().top(z), 1.0, motion.dx);
  multiply(1.0, Op::plain, T2, Op::plain, y.view().top(z), 1.0, dtheta_0);
  copy(y.view().block(z, 0, mu * n, count), motion.dtheta.view().block(n, 0, mu * n, count));
  const Left left{solution.data, slopes.by_x, slopes.by_parameters, slopes.by_time, moving.shifts};
  if (!(worst_of(left, mu, motion.dx, motion.dtheta, motion.sizes) <= jump_contradiction)) return false;
  if (!holds_aside(known, solution, moving, motion)) return false;
  for (int j = 0; j < count; ++j) {
    for (int i = 0; i < n; ++i) after(i, j) = motion.dx(i, j) * known.units[i];
    if (!all_finite(after.column(j), index(n))) return false;
  }
  return true;
}

}  // namespace sfdae::core
