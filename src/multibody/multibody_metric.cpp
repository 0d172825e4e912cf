// Metric of changes of positions and velocities of a mechanical system.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_metric.h"

#include <cmath>
#include <vector>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Symmetric except for rounding errors of its formulas; 1e-12 leaves room for thousands of them. (Chosen.)
bool is_symmetric(const Matrix& A) {
  const double small = 1e-12 * max_abs(A);
  for (int j = 0; j < A.cols(); ++j)
    for (int i = 0; i < j; ++i)
      if (std::fabs(A(i, j) - A(j, i)) > small) return false;
  return true;
}

// R with A = R^T R; false unless A is positive definite by a margin for rounding errors.
bool factor_cholesky(Matrix& A) {
  constexpr double margin = 1e-12;
  const int n = A.rows();
  for (int j = 0; j < n; ++j) {
    const double diagonal = A(j, j);
    for (int i = 0; i <= j; ++i) {
      double sum = A(i, j);
      for (int k = 0; k < i; ++k) sum -= A(k, i) * A(k, j);
      if (i < j) A(i, j) = sum / A(i, i);
      else if (!(sum > margin * diagonal)) return false;
      else A(j, j) = std::sqrt(sum);
    }
  }
  return true;
}

// W of positions with q' = S v; empty if S has not full column rank.
Matrix metric_along(const Matrix& S, const Matrix& M) {
  // Relative to the largest singular value; between rounding errors and any kinematics in use. (Chosen.)
  constexpr double least = 1e-8;
  const Svd A = svd(S);
  const int nq = S.rows(), nv = S.cols();
  if (nv > nq || !(A.s.back() > least * A.s.front())) return {};
  Matrix B(nv, nq);
  for (int j = 0; j < nq; ++j)
    for (int i = 0; i < nv; ++i)
      for (int k = 0; k < nv; ++k) B(i, j) += A.V(i, k) * A.U(j, k) / A.s[index(k)];
  Matrix W = transpose_product(B, product(M, B)), rest = identity(nq), weighted(nq, nq);
  multiply(-1.0, Op::plain, S, Op::plain, B, 1.0, rest);
  for (int j = 0; j < nq; ++j)
    for (int i = 0; i < nq; ++i) weighted(i, j) = W(i, i) * rest(i, j);
  multiply(1.0, Op::transposed, rest, Op::plain, weighted, 1.0, W);
  return W;
}

std::vector<int> open_components(const ConsistencyRequest& request, int first, int count) {
  std::vector<int> open;
  for (int i = 0; i < count; ++i)
    if (request.kind != InitialValues::fixed || request.fixed[index(first + i)] == 0) open.push_back(i);
  return open;
}

// W of `count` unknowns from the first one on.
Metric metric_of(const Matrix& W, const ConsistencyRequest& request, int first, int count) {
  const std::vector<int> open = open_components(request, first, count);
  const int size = static_cast<int>(open.size());
  Metric metric{Matrix(count, size), Matrix(size, count)};
  if (request.weights.empty() && W.rows() == count) {
    Matrix root(size, size);
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i) root(i, j) = W(open[index(i)], open[index(j)]);
    if (is_symmetric(root) && factor_cholesky(root)) {
      Matrix inverse = identity(size);
      solve_upper(Op::plain, root, inverse);
      for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i) {
          metric.P(open[index(i)], j) = inverse(i, j);
          metric.R(i, open[index(j)]) = i <= j ? root(i, j) : 0.0;
        }
      return metric;
    }
  }
  for (int i = 0; i < size; ++i) {
    const int k = open[index(i)];
    const double weight = request.weights.empty() ? 1.0 : request.weights[index(first + k)];
    metric.P(k, i) = weight;
    metric.R(i, k) = 1.0 / weight;
  }
  return metric;
}

}  // namespace

PositionMetric position_metric(const MultibodyTerms& terms, const ConsistencyRequest& request) {
  const int nq = terms.g_q.cols();
  const std::vector<int> open = open_components(request, 0, nq);
  const Matrix W = terms.S.rows() == 0 ? terms.M : metric_along(terms.S, terms.M);
  PositionMetric metric{metric_of(W, request, 0, nq), Matrix(nq, static_cast<int>(open.size()))};
  for (int j = 0; j < metric.open.cols(); ++j) metric.open(open[index(j)], j) = 1.0;
  return metric;
}

Metric velocity_metric(const MultibodyTerms& terms, const ConsistencyRequest& request) {
  return metric_of(terms.M, request, terms.g_q.cols(), terms.M.rows());
}

}  // namespace sfdae::core
