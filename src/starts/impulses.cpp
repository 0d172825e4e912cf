// Jump from values of other equations to consistent ones, by impulses.
// SPDX-License-Identifier: BSD-3-Clause
#include "starts/impulses.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "starts/least_change.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Least pivot relative to the largest one, columns of length 1: below it a direction is not determined by these data.
// Well-posed problems in balanced units have 1e-6 and more. (Chosen.)
constexpr double least_pivot = 1e-13;
// Relative to the sum of terms of an equation: rounding errors leave less. (Chosen.)
constexpr double impulse_contradiction = 1e-7;

// Least sum of terms of an equation, relative to the largest theta. (Chosen.)
constexpr double negligible_part = 1e-4;

// The unknowns: z, then those of theta_1, ..., theta_mu that are not inputs.
struct Unknowns {
  explicit Unknowns(const ImpulseEquations& of) : z(of.point.form.unknowns()) {
    const std::vector<int>& inputs = of.inputs.components;
    for (int i = 0; i < of.data.n; ++i)
      if (std::find(inputs.begin(), inputs.end(), i) == inputs.end()) components.push_back(i);
    count = z + of.mu * per_order();
  }
  int per_order() const { return static_cast<int>(components.size()); }

  int z, count;
  std::vector<int> components;
};

// Least squares problem C y = b.
struct LeastSquares {
  Matrix C;
  Vector b;
};

LeastSquares least_squares_of(const ImpulseEquations& of, const Unknowns& unknowns, const Vector& change) {
  const int m = of.data.m, n = of.data.n, rows = (of.mu + 1) * m;
  const int known = static_cast<int>(of.inputs.values.size());
  LeastSquares problem{Matrix(rows + known, unknowns.count), Vector(index(rows + known), 0.0)};
  Matrix& C = problem.C;
  multiply(1.0, Op::plain, of.data.E(0), Op::plain, of.point.form.T2(), 0.0, C.view().block(0, 0, m, unknowns.z));
  multiply(1.0, Op::plain, of.data.E(0), change.data(), 0.0, problem.b.data());
  const Matrix impulses = impulse_columns(of.data, of.mu);
  for (int j = 0; j < unknowns.count - unknowns.z; ++j) {
    const int order = j / unknowns.per_order(), i = unknowns.components[index(j % unknowns.per_order())];
    copy(impulses.view().columns(order * n + i, 1), C.view().block(0, unknowns.z + j, rows, 1));
  }
  for (int k = 0; k < known; ++k) {
    const int i = of.inputs.components[index(k)];
    for (int j = 0; j < unknowns.z; ++j) C(rows + k, j) = of.point.form.T2()(i, j);
    problem.b[index(rows + k)] = of.inputs.values[index(k)] / of.point.units[i] - of.point.form.xp()[i];
  }
  return problem;
}

[[noreturn]] void throw_undetermined(double t, const char* why) {
  throw Failure(SFDAE_NO_CONSISTENT_VALUES,
                format("the jump at t = %.15g is not determined: %s Give the values after it yourself, with "
                       "sfdae_start, and fix those that have to stay.",
                       t, why));
}

Vector solve(LeastSquares problem, double t) {
  Matrix& C = problem.C;
  Vector& b = problem.b;
  const int rows = C.rows(), cols = C.cols();
  Vector y(index(cols), 0.0);
  if (cols == 0) return y;
  if (rows < cols) throw_undetermined(t, "there are fewer equations than unknowns and impulses.");
  Arena arena;
  if (!solve_least_squares(C, {b.data(), rows, 1, rows}, {y.data(), cols, 1, cols}, arena))
    throw_undetermined(t, "impulses of the equations can lead to several consistent values.");
  return y;
}

void demand_solution(const TaylorData& data, int mu, ConstView theta, double rounding) {
  const Vector left = residuals_of_impulses(data, mu, theta, rounding);
  for (std::size_t i = 0; i < left.size(); ++i)
    if (!(left[i] <= impulse_contradiction))
      throw Failure(
          SFDAE_NO_CONSISTENT_VALUES,
          format(
              "no impulses of the equations lead from the values before t = %.15g to consistent ones: equation %d, "
              "or its derivative, cannot hold. Equations that are redundant contradict these values.",
              data.t, static_cast<int>(i) % data.m));
}

}  // namespace

bool solve_least_squares(View C, View b, View y, Arena& arena) {
  const int cols = C.cols;
  Vector factors(index(cols), 1.0), tau(index(cols) + 1);
  std::vector<int> pivots(index(cols));
  for (int j = 0; j < cols; ++j) {
    double sum = 0.0;
    for (int i = 0; i < C.rows; ++i) sum += C(i, j) * C(i, j);
    if (sum > 0.0) factors[index(j)] = 1.0 / std::sqrt(sum);
    for (int i = 0; i < C.rows; ++i) C(i, j) *= factors[index(j)];
  }
  factor_qr_pivoted(C, pivots.data(), tau.data(), arena);
  if (!(std::fabs(C(cols - 1, cols - 1)) > least_pivot * std::fabs(C(0, 0)))) return false;
  apply_q(Op::transposed, C, cols, tau.data(), b, arena);
  solve_upper(Op::plain, C.block(0, 0, cols, cols), b.top(cols));
  for (int k = 0; k < y.cols; ++k)
    for (int j = 0; j < cols; ++j) y(pivots[index(j)], k) = b(j, k) * factors[index(pivots[index(j)])];
  return true;
}

void add_impulse_block(const TaylorData& data, int p, int j, View C) {
  const auto add = [&](double s, ConstView from) {
    for (int col = 0; col < from.cols; ++col)
      for (int row = 0; row < from.rows; ++row) C(row, col) += s * from(row, col);
  };
  if (j - p <= data.orders.E) add(1.0, data.E(j - p));
  if (j > p && j - p - 1 <= data.orders.A) add(1.0 / j, data.A(j - p - 1));
}

Matrix impulse_columns(const TaylorData& data, int mu) {
  const int m = data.m, n = data.n;
  Matrix C((mu + 1) * m, mu * n);
  for (int p = 0; p <= mu; ++p)
    for (int j = std::max(p, 1); j <= mu; ++j)
      add_impulse_block(data, p, j, C.view().block(p * m, (j - 1) * n, m, n));
  return C;
}

double rounding_of_impulses(const ConstrainedPoint& point, double size) {
  // Two digits of room for errors of the directions; never more than that. (Chosen.)
  constexpr double room = 1e2, least = 1e-12, most = 1e-8;
  return std::clamp(room * error_of_directions(point.form.n, point.kept), least, most) * size;
}

Vector residuals_of_impulses(const TaylorData& data, int mu, ConstView theta, double rounding) {
  const int m = data.m, n = data.n;
  Vector result(index((mu + 1) * m), 0.0);
  const double largest = max_abs(theta);
  for (int p = 0; p <= mu; ++p) {
    Vector left(index(m), 0.0), size(index(m), 0.0);
    for (int j = p; j <= mu; ++j) {
      Matrix block(m, n);
      add_impulse_block(data, p, j, block);
      for (int col = 0; col < n; ++col)
        for (int row = 0; row < m; ++row) {
          left[index(row)] += block(row, col) * theta(col, j);
          size[index(row)] += std::fabs(block(row, col) * theta(col, j));
        }
    }
    for (int row = 0; row < m; ++row) {
      const double scale = std::max(size[index(row)], negligible_part * largest);
      const double beyond = std::max(std::fabs(left[index(row)]) - rounding, 0.0);
      if (scale > 0.0) result[index(p * m + row)] = beyond / scale;
    }
  }
  return result;
}

Jump jump_by_impulses(const ImpulseEquations& of, const Vector& before, Matrix* theta) {
  const NullSpaceForm& form = of.point.form;
  const Units& units = of.point.units;
  const int n = form.n, mu = of.mu;
  const double t = of.data.t;
  const int open = form.u - static_cast<int>(of.inputs.values.size());
  if (open > 0) throw_undetermined(t, format("%d components are free: prescribe them.", open).c_str());
  Vector change(index(n));  // from xp to x-
  for (int i = 0; i < n; ++i) change[index(i)] = before[index(i)] / units[i] - form.xp()[i];
  const Unknowns unknowns(of);
  const Vector y = solve(least_squares_of(of, unknowns, change), t);

  Jump jump{Vector(form.xp(), form.xp() + n), Matrix(n, mu)};
  if (unknowns.z > 0) multiply(1.0, Op::plain, form.T2(), y.data(), 1.0, jump.x.data());
  Matrix found(n, mu + 1);
  for (int i = 0; i < n; ++i) found(i, 0) = jump.x[index(i)] - before[index(i)] / units[i];
  double factor = 1.0;
  for (int j = 1; j <= mu; ++j) {
    factor *= -of.data.time_scale / j;
    for (int k = 0; k < unknowns.per_order(); ++k) {
      const int i = unknowns.components[index(k)];
      found(i, j) = y[index(unknowns.z + (j - 1) * unknowns.per_order() + k)];
      jump.impulses(i, j - 1) = units[i] * factor * found(i, j);
    }
  }
  double size = of.size;
  for (int i = 0; i < n; ++i)
    size = std::max({size, std::fabs(before[index(i)] / units[i]), std::fabs(jump.x[index(i)])});
  demand_solution(of.data, mu, found, rounding_of_impulses(of.point, size));
  units.outward(jump.x.data());
  if (!all_finite(jump.x.data(), index(n)) || !all_finite(jump.impulses.data(), index(n * mu)))
    throw Failure(SFDAE_NOT_FINITE, format("values after the jump at t = %.15g overflow: rescale.", t));
  if (theta != nullptr) *theta = std::move(found);
  return jump;
}

}  // namespace sfdae::core
