// The leading term W x of a linear problem at a point.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/linear_leading_term.h"

#include <algorithm>
#include <vector>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/small_kernels.h"

namespace sfdae::core {

namespace {

// (E x)' = E x' + E' x
void add_derivative_of_E(const TaylorData& data, const double* x, double* wdot) {
  const double per_tau = 1.0 / data.time_scale;
  std::vector<double> h(index(data.m));
  multiply(per_tau, Op::plain, data.E(1), x, 0.0, h.data());
  for (int i = 0; i < data.m; ++i) wdot[i] += h[index(i)] / data.row_scale[index(i)];
}

// to := E^+ from, or E^+^T from. E = U diag(s) V^T of known rank.
void apply_pseudo_inverse(Op op, const Svd& E, int rank, const std::vector<double>& from, std::vector<double>& to) {
  const ConstView left = op == Op::plain ? E.U.view() : E.V.view();
  const ConstView right = op == Op::plain ? E.V.view() : E.U.view();
  std::fill_n(to.data(), right.rows, 0.0);
  for (int k = 0; k < rank; ++k) {
    const double c = small::dot(left.rows, left.column(k), from.data()) / E.s[index(k)];
    small::add_scaled(right.rows, c, right.column(k), to.data());
  }
}

// P' = S + S^T with S = E^+ E' (I - P), for constant rank.
void add_derivative_of_projector(const LinearPoint& point, int rank_E, const double* x, double* wdot, Arena& arena) {
  const TaylorData& data = point.data;
  const int n = data.n, m = data.m;
  const double per_tau = 1.0 / data.time_scale;
  const Svd decomposition = svd(data.E(0));
  const std::vector<double> whole(x, x + n);
  std::vector<double> kernel_part(whole), Px(whole), h(index(m)), s(index(n));
  point.form.project(Px.data(), arena);
  for (int i = 0; i < n; ++i) kernel_part[index(i)] -= Px[index(i)];
  multiply(per_tau, Op::plain, data.E(1), kernel_part.data(), 0.0, h.data());
  apply_pseudo_inverse(Op::plain, decomposition, rank_E, h, s);
  for (int i = 0; i < n; ++i) wdot[i] += s[index(i)];
  // S^T x = (I - P) E'^T E^+^T x
  std::vector<double> e(index(m)), back(index(n));
  apply_pseudo_inverse(Op::transposed, decomposition, rank_E, whole, e);
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
