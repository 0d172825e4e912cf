// The classical derivative array and its projectors.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/derivative_array.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "reduction/elimination.h"

namespace sfdae::core {

namespace {

void add_multiple(double s, ConstView from, View to) {
  for (int j = 0; j < from.cols; ++j)
    for (int i = 0; i < from.rows; ++i) to(i, j) += s * from(i, j);
}

double binomial(int n, int k) {
  double result = 1.0;
  for (int i = 1; i <= k; ++i) result = result * (n - k + i) / i;
  return std::round(result);
}

}  // namespace

Matrix orthonormalized(Matrix a) {
  Arena arena;
  for (int j = 0; j < a.cols(); ++j) {
    const double size = max_abs(a.view().columns(j, 1));
    for (int i = 0; i < a.rows() && size > 0.0; ++i) a(i, j) /= size;
  }
  std::vector<double> tau(index(a.cols()) + 1);
  factor_qr(a, tau.data(), arena);
  Matrix q(a.rows(), a.cols());
  form_q(a, std::min(a.rows(), a.cols()), tau.data(), q, arena);
  return q;
}

DerivativeArray derivative_array(LinearProblem& problem, double t, int level) {
  TaylorData data;
  const CallbackError error = problem.evaluate_plain(t, {level, level, level}, data);
  if (error.status != SFDAE_OK) error.raise();
  const int m = problem.m(), n = problem.n();
  DerivativeArray array{Matrix((level + 1) * m, (level + 1) * n), Matrix((level + 1) * m, n), {}};
  for (int i = 0; i <= level; ++i) {
    for (int j = 0; j <= i; ++j) {
      const View block = array.M.view().block(i * m, j * n, m, n);
      add_multiple(binomial(i, j), data.E(i - j), block);
      if (j < i) add_multiple(-binomial(i, j + 1), data.A(i - j - 1), block);
    }
    copy(data.A(i), array.N.view().block(i * m, 0, m, n));
    array.g.insert(array.g.end(), data.f(i), data.f(i) + m);
  }
  return array;
}

DerivativeArray derivative_array(const TaylorData& data, int level, const Units& units) {
  const int m = data.m, n = data.n;
  DerivativeArray array{Matrix((level + 1) * m, (level + 1) * n), Matrix((level + 1) * m, n),
                        std::vector<double>(index(level + 1) * index(m), 0.0)};
  // Plain derivatives: without the powers of two and the factorials of the scaling.
  double factor = 1.0;
  std::vector<double> unscaled(index(level + 1));
  for (int k = 0; k <= level; ++k) unscaled[index(k)] = (factor *= k > 0 ? k / data.time_scale : 1.0);
  const auto add = [&](double s, ConstView from, int i, View to) {
    for (int row = 0; row < m; ++row)
      for (int j = 0; j < n && data.has_row(row, i); ++j)
        to(row, j) += s * from(row, j) / (units[j] * data.row_scale[index(row)]);
  };
  for (int i = 0; i <= level; ++i) {
    for (int j = 0; j <= i; ++j) {
      const View block = array.M.view().block(i * m, j * n, m, n);
      add(binomial(i, j) * unscaled[index(i - j)], data.E(i - j), i, block);
      if (j < i) add(-binomial(i, j + 1) * unscaled[index(i - j - 1)] / data.time_scale, data.A(i - j - 1), i, block);
    }
    add(unscaled[index(i)] / data.time_scale, data.A(i), i, array.N.view().block(i * m, 0, m, n));
    for (int row = 0; row < m; ++row)
      if (data.has_row(row, i))
        array.g[index(i * m + row)] =
            data.f(i)[row] * unscaled[index(i)] / (data.time_scale * data.row_scale[index(row)]);
  }
  return array;
}

Projectors projectors(LinearProblem& problem, const IndexAnalysis& known, const AnalysisSettings& settings,
                      double t) {
  const int mu = known.values.mu;
  TaylorData data;
  const CallbackError error = problem.evaluate(t, {mu, mu, 0}, known.time_scale, data);
  if (error.status != SFDAE_OK) error.raise();
  return projectors(data, problem.units(), known, {settings.rank_tol, settings.by_svd, known.noise});
}

Projectors projectors(const TaylorData& data, const Units& units, const IndexAnalysis& known,
                      const Judge::Settings& judging) {
  const int mu = known.values.mu, a = known.values.a, d = known.values.d;
  const int m = data.m, rows = (mu + 1) * m;
  // Carrying the identity along gives Z^T, the transformation itself, for the scaled array.
  Judge judge(data, mu, judging, nullptr);
  Arena arena;
  const Arena::Frame frame(arena);
  const Matrix unit = identity(rows);
  const Carried carried = judging.by_singular_values ? eliminate_by_svd(data, mu, unit, judge, arena)
                                                     : eliminate(data, mu, unit, 1, judge, arena);
  // Within the left null space, Z2 is the part on which N has rank a, Z3 the rest; decided with scaled data, as for the
  // ranks.
  const Svd split = svd(carried.constraints);
  const int v_hat = carried.rows - a;
  if (v_hat != known.v_hat)
    throw Failure(SFDAE_CHARACTERISTICS_CHANGED,
                  format("the characteristic values known do not hold at t = %.15g.", data.t));
  Matrix Z(rows, carried.rows);  // [Z3 Z2]
  multiply(1.0, Op::transposed, carried.rhs, Op::plain, split.U.view().columns(a, v_hat), 0.0,
           Z.view().columns(0, v_hat));
  multiply(1.0, Op::transposed, carried.rhs, Op::plain, split.U.view().columns(0, a), 0.0,
           Z.view().columns(v_hat, a));
  // Row block i of the scaled array is D tau^(i+1) / i! times that of the classical one.
  double factor = 1.0;
  for (int i = 0; i <= mu; ++i) {
    factor *= data.time_scale / std::max(i, 1);
    for (int row = 0; row < m; ++row)
      for (int j = 0; j < Z.cols(); ++j) Z(i * m + row, j) *= factor * data.row_scale[index(row)];
  }
  Z = orthonormalized(std::move(Z));

  const int n = data.n;
  const Matrix kernel = to_matrix(split.V.view().columns(a, n - a));
  Matrix range = range_basis(product(data.E(0), kernel), d), T2 = kernel;
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < d; ++j) range(i, j) /= data.row_scale[index(i)];
  for (int i = 0; i < n && !units.are_one(); ++i)
    for (int j = 0; j < T2.cols(); ++j) T2(i, j) *= units[i];
  Projectors result;
  result.Z3 = to_matrix(Z.view().columns(0, v_hat));
  result.Z2 = to_matrix(Z.view().columns(v_hat, a));
  result.T2 = orthonormalized(std::move(T2));
  result.Z1 = orthonormalized(std::move(range));
  return result;
}

StrangenessFreeEquations strangeness_free_equations(const DerivativeArray& array, const Projectors& projectors) {
  const int m = projectors.Z1.rows(), n = array.N.cols(), rows = array.M.rows();
  const ConstView g{array.g.data(), rows, 1, rows};
  const ConstView E = array.M.view().block(0, 0, m, n), A = array.N.view().block(0, 0, m, n);
  return {transpose_product(projectors.Z1, E),
          transpose_product(projectors.Z1, A),
          transpose_product(projectors.Z1, g.block(0, 0, m, 1)),
          transpose_product(projectors.Z2, array.N),
          transpose_product(projectors.Z2, g),
          max_abs(transpose_product(projectors.Z3, g))};
}

}  // namespace sfdae::core
