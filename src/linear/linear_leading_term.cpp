// The leading term W x of a linear problem at a point.
// SPDX-License-Identifier: BSD-3-Clause
#include "linear/linear_leading_term.h"

#include <algorithm>
#include <vector>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// (E x)' = E x' + E' x
void add_derivative_of_E(const TaylorData& data, const double* x, double* wdot) {
  const double per_tau = 1.0 / data.time_scale;
  std::vector<double> h(index(data.m));
  multiply(per_tau, Op::plain, data.E(1), x, 0.0, h.data());
  for (int i = 0; i < data.m; ++i) wdot[i] += h[index(i)] / data.row_scale[index(i)];
}

// The pseudo-inverse of E_0 of the rank known, which rests on E P = Q [R11 R12; 0 0] and on the projector of the point:
// E^+ = (I - K K^T) P [R11^-1; 0] Q1^T.
class PseudoInverse {
 public:
  PseudoInverse(const LinearPoint& point, int rank, Arena& arena)
      : point_(point),
        rank_(rank),
        arena_(arena),
        factors_(to_matrix(point.data.E(0))),
        pivots_(index(factors_.cols()) + 1),
        tau_(index(std::min(factors_.rows(), factors_.cols())) + 1) {
    const KeptFactorizations* kept = point.data.kept_factorizations();
    if (kept == nullptr || !kept->find_first(point.data.E(0), rank, factors_, pivots_.data(), tau_.data()))
      factor_qr_pivoted(factors_, pivots_.data(), tau_.data(), arena);
  }
  // E^+ h; h is destroyed.
  std::vector<double> apply(std::vector<double>& h) {
    std::vector<double> result(index(factors_.cols()), 0.0);
    apply_q(Op::transposed, factors_, rank_, tau_.data(), column(h), arena_);
    solve_upper(Op::plain, R11(), column(h).top(rank_));
    for (int k = 0; k < rank_; ++k) result[index(pivots_[index(k)])] = h[index(k)];
    point_.form.project(result.data(), arena_);
    return result;
  }
  // E^+^T x
  std::vector<double> apply_transposed(std::vector<double> x) {
    std::vector<double> result(index(factors_.rows()), 0.0);
    point_.form.project(x.data(), arena_);
    for (int k = 0; k < rank_; ++k) result[index(k)] = x[index(pivots_[index(k)])];
    solve_upper(Op::transposed, R11(), column(result).top(rank_));
    apply_q(Op::plain, factors_, rank_, tau_.data(), column(result), arena_);
    return result;
  }

 private:
  static View column(std::vector<double>& v) {
    const int rows = static_cast<int>(v.size());
    return {v.data(), rows, 1, std::max(rows, 1)};
  }
  ConstView R11() const { return factors_.view().block(0, 0, rank_, rank_); }

  const LinearPoint& point_;
  int rank_;
  Arena& arena_;
  Matrix factors_;
  std::vector<int> pivots_;
  std::vector<double> tau_;
};

// P' = S + S^T with S = E^+ E' (I - P), for constant rank.
void add_derivative_of_projector(const LinearPoint& point, int rank_E, const double* x, double* wdot, Arena& arena) {
  const TaylorData& data = point.data;
  const int n = data.n, m = data.m;
  const double per_tau = 1.0 / data.time_scale;
  PseudoInverse inverse(point, rank_E, arena);
  const std::vector<double> whole(x, x + n);
  std::vector<double> kernel_part(whole), Px(whole), h(index(m));
  point.form.project(Px.data(), arena);
  for (int i = 0; i < n; ++i) kernel_part[index(i)] -= Px[index(i)];
  multiply(per_tau, Op::plain, data.E(1), kernel_part.data(), 0.0, h.data());
  const std::vector<double> s = inverse.apply(h);
  for (int i = 0; i < n; ++i) wdot[i] += s[index(i)];
  // S^T x = (I - P) E'^T E^+^T x
  const std::vector<double> e = inverse.apply_transposed(whole);
  std::vector<double> back(index(n));
  multiply(per_tau, Op::transposed, data.E(1), e.data(), 0.0, back.data());
  std::vector<double> projected = back;
  point.form.project(projected.data(), arena);
  for (int i = 0; i < n; ++i) wdot[i] += back[index(i)] - projected[index(i)];
}

}  // namespace

void apply_leading(LeadingTerm leading, const LinearPoint& point, const double* x, double* w, Arena& arena) {
  const TaylorData& data = point.data;
  if (leading == LeadingTerm::matrix) {
    multiply(1.0, Op::plain, data.E(0), x, 0.0, w);
    for (int i = 0; i < data.m; ++i) w[i] /= data.row_scale[index(i)];
    return;
  }
  std::copy_n(x, data.n, w);
  if (leading == LeadingTerm::projector) point.form.project(w, arena);
}

void differential_rows(LeadingTerm leading, const LinearPoint& point, const double* w, double* q, Arena& arena) {
  const TaylorData& data = point.data;
  const Arena::Frame frame(arena);
  double* Ew = arena.take(index(data.m));
  if (leading == LeadingTerm::matrix)
    for (int i = 0; i < data.m; ++i) Ew[i] = w[i] * data.row_scale[index(i)];
  else multiply(1.0, Op::plain, data.E(0), w, 0.0, Ew);
  multiply(1.0, Op::transposed, point.form.Z1(), Ew, 0.0, q);
}

void differential_rows(LeadingTerm leading, const LinearPoint& point, ConstView w, View q, Arena& arena) {
  const TaylorData& data = point.data;
  const Arena::Frame frame(arena);
  const View Ew = arena.matrix(data.m, w.cols);
  if (leading == LeadingTerm::matrix) {
    for (int k = 0; k < w.cols; ++k)
      for (int i = 0; i < data.m; ++i) Ew(i, k) = w(i, k) * data.row_scale[index(i)];
  } else {
    multiply(1.0, Op::plain, data.E(0), Op::plain, w, 0.0, Ew);
  }
  multiply(1.0, Op::transposed, point.form.Z1(), Op::plain, Ew, 0.0, q);
}

void add_derivative_of_leading(const KnownForm& known, const LinearPoint& point, const double* x, double* wdot,
                               Arena& arena) {
  if (!known.needs_E1 || point.data.is_zero_E(1)) return;
  if (known.leading == LeadingTerm::matrix) add_derivative_of_E(point.data, x, wdot);
  if (known.leading == LeadingTerm::projector)
    add_derivative_of_projector(point, known.analysis.rank_E, x, wdot, arena);
}

}  // namespace sfdae::core
