// Derivatives at one point, the stages of the derivative array, strangeness index and characteristic values.
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/derivative_stages.h"

#include <algorithm>
#include <cmath>

#include "f77/orthogonal_factors.h"
#include "f77/user_functions.h"
#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/rank.h"
#include "problem/failure.h"
#include "problem/linear_problem.h"
#include "reduction/elimination.h"

namespace sfdae::f77 {

using namespace core;

namespace {

double binomial(int n, int k) {
  double result = 1.0;
  for (int i = 1; i <= k; ++i) result = result * (n - k + i) / i;
  return std::round(result);
}

// The point as a problem of the core: f = 0, ranks do not depend on it. -1 ends the analysis at once.
int copy_E(double, int order, double* out, void* user) {
  auto& point = *static_cast<PointDerivatives*>(user);
  if (point.fetch(order) != 0) return -1;
  copy(point.E(order), {out, point.n(), point.n(), point.n()});
  return 0;
}

int copy_A(double, int order, double* out, void* user) {
  auto& point = *static_cast<PointDerivatives*>(user);
  if (point.fetch(order) != 0) return -1;
  copy(point.A(order), {out, point.n(), point.n(), point.n()});
  return 0;
}

LinearFunctions as_functions(PointDerivatives& point) {
  LinearFunctions functions;
  functions.m = functions.n = point.n();
  functions.E = copy_E;
  functions.A = copy_A;
  functions.user = &point;
  return functions;
}

void store_stage(const PointDerivatives& point, int level, const StageStorage& storage) {
  const int n = point.n(), rows = (level + 1) * n;
  const View AH = storage.AH.view(rows, n), AQ = storage.AQ.view(rows, n), EQ = storage.EQ.view(rows, rows);
  for (int k = 0; k <= level; ++k) {
    copy(point.E(k), AH.block(k * n, 0, n, n));
    copy(point.A(k), AQ.block(k * n, 0, n, n));
    std::copy_n(point.f(k), n, storage.FQ + static_cast<std::ptrdiff_t>(k) * n);
    append_stage(n, k, AH, AQ, EQ);
  }
}

// Basis of the left null space of EQ, its dimension known: from the array in Taylor scaling, whose row block i is
// `factors` times that of EQ.
Matrix null_space(LinearProblem& problem, const IndexAnalysis& analysis) {
  const int mu = analysis.values.mu, rows = (mu + 1) * problem.m();
  const int rank = rows - analysis.values.a - analysis.v_hat;
  TaylorData data;
  const CallbackError error = problem.evaluate(analysis.t, {mu, mu, -1}, analysis.time_scale, data);
  if (error.status != SFDAE_OK) throw Failure(error.status, error.message());
  std::vector<double> factors;
  double factor = 1.0;
  for (int i = 0; i <= mu; ++i) {
    factor *= data.time_scale / std::max(i, 1);
    for (double row : data.row_scale) factors.push_back(factor * row);
  }
  const Matrix array = taylor_array(data, mu);
  raise_zero_rows(array, factors);
  const Svd decomposition = svd(array.view().columns(0, rows));
  return scaled_rows(factors, decomposition.U.view().columns(rank, rows - rank));
}

// Rank of a matrix of given noise; the smallest value kept relative to norm lowers `kept`.
int rank_of(const Svd& decomposition, double noise, double norm, double& kept) {
  const int count = static_cast<int>(decomposition.s.size());
  const int dimension = std::max({decomposition.U.rows(), decomposition.V.rows(), 1});
  const RankDecision decision = decide_rank(decomposition.s.data(), count, 1, {noise, norm, dimension, 0.0, 0.0});
  if (decision.rank > 0) kept = std::min(kept, decision.kept);
  return decision.rank;
}

}  // namespace

void PointDerivatives::fetch(char which, int order, int count, std::vector<std::vector<double>>& values) {
  if (code_ != 0) return;
  std::vector<double> derivative(core::index(count), 0.0);
  code_ = function_(which, order, derivative.data());
  if (code_ == 0 && !all_finite(derivative.data(), derivative.size())) code_ = function_failed;
  values.push_back(std::move(derivative));
}

int PointDerivatives::fetch(int order) {
  for (int k = static_cast<int>(f_.size()); k <= order && code_ == 0; ++k) {
    fetch('E', k, n_ * n_, E_);
    fetch('A', k, n_ * n_, A_);
    fetch('f', k, n_, f_);
  }
  return code_;
}

void append_stage(int n, int level, ConstView E, ConstView A, View EQ) {
  fill(EQ.block(0, level * n, level * n, n), 0.0);
  for (int j = 0; j <= level; ++j) {
    const View block = EQ.block(level * n, j * n, n, n);
    const ConstView of_E = E.block((level - j) * n, 0, n, n);
    const double c = binomial(level, j), c_next = j < level ? binomial(level, j + 1) : 0.0;
    for (int col = 0; col < n; ++col)
      for (int row = 0; row < n; ++row) {
        block(row, col) = c * of_E(row, col);
        if (j < level) block(row, col) -= c_next * A((level - j - 1) * n + row, col);
      }
  }
}

std::int64_t documented_work(std::int64_t rows) { return 3 * rows * rows + 6 * rows; }

int find_stage(PointDerivatives& point, double t, const SearchLimits& limits, const StageStorage& storage,
               StageValues& values) {
  const std::int64_t most_rows = (std::int64_t{limits.max_level} + 1) * point.n();
  if (limits.max_level < 0 || !is_dimension(point.n()) || !is_dimension(most_rows) || !storage.holds(most_rows) ||
      !all_finite(&t, 1))
    return argument_error;
  if (limits.lrwork < documented_work(most_rows)) return work_too_small;
  Arena arena;
  LinearProblem problem(as_functions(point));
  AnalysisSettings settings;
  settings.max_index = std::min(limits.max_level, max_strangeness_index);
  std::vector<RankDecision> decisions;
  values = {};
  try {
    // Toward t itself: no nearby point.
    const IndexAnalysis analysis = analyze_index(problem, t, t, settings, arena, decisions);
    const int mu = analysis.values.mu, rows = (mu + 1) * point.n();
    const Matrix Z = null_space(problem, analysis);
    const View EQ = storage.EQ.view(rows, rows);
    store_stage(point, mu, storage);
    if (!is_finite(EQ)) return not_converged;
    copy(left_factor(EQ, Z), storage.ZQ.view(rows, rows));
    values = {analysis.values, rows - analysis.values.a - analysis.v_hat};
  } catch (const Failure& failure) {
    if (point.code() != 0) return point.code();
    return failure.status() == SFDAE_INDEX_TOO_HIGH ? 0 : ranks_contradict;
  }
  return 0;
}

// With Z, T bases of the left and right null space of EQ, T' of the complement of T, V of the left null space of
// Z^T AQ T:  r = rank EQ,  a = rank(Z^T AQ T),  s = rank(V^T Z^T AQ T').
//
// Null vectors are known to eps / p with p the smallest value kept relative to |EQ|, and V to that over the smallest
// one kept of Z^T AQ T: so much of AQ is noise.
PairValues pair_values(ConstView EQ, ConstView AQ) {
  const int rows = EQ.rows, n = AQ.cols;
  // Factors of rows change no rank, but what is small beside what.
  const std::vector<double> factors = row_factors(EQ, AQ);
  const Matrix M = scaled_rows(factors, EQ), N = scaled_rows(factors, AQ);
  const double norm_M = max_abs(M), norm_N = max_abs(N);
  PairValues values;
  double kept_M = 1.0, kept_a = 1.0, kept_s = 1.0;
  const Svd of_M = svd(M);
  values.r = rank_of(of_M, unit_roundoff * norm_M, norm_M, kept_M);
  const int kernel = rows - values.r;
  const ConstView Z = of_M.U.view().columns(values.r, kernel);
  const Matrix ZN = transpose_product(Z, N);
  // AQ acts on the first n components alone.
  const ConstView V = of_M.V.view().top(n), T = V.columns(values.r, kernel), T_rest = V.columns(0, values.r);
  const Svd of_a = svd(product(ZN, T));
  double noise = unit_roundoff * norm_N / kept_M;
  values.a = rank_of(of_a, noise, norm_N, kept_a);
  const Matrix rest = transpose_product(of_a.U.view().columns(values.a, kernel - values.a), product(ZN, T_rest));
  noise /= kept_a;
  values.s = rank_of(svd(rest), noise, norm_N, kept_s);
  values.d = values.r - values.s;
  values.u = rows - values.r - values.a - values.s;
  values.ZQ = left_factor(EQ, scaled_rows(factors, Z));
  return values;
}

}  // namespace sfdae::f77
