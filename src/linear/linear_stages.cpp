// The stages of an implicit Runge-Kutta step of a linear problem, solved together.
// SPDX-License-Identifier: BSD-3-Clause
#include "linear/linear_stages.h"

#include <algorithm>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "linear/linear_leading_term.h"

namespace sfdae::core {

namespace {

std::size_t area(int rows, int cols) { return index(rows) * index(cols); }

View view(std::vector<double>& values, int rows, int cols) { return {values.data(), rows, cols, std::max(rows, 1)}; }
ConstView view(const std::vector<double>& values, int rows, int cols) {
  return {values.data(), rows, cols, std::max(rows, 1)};
}

}  // namespace

void LinearStages::resize(int s, const SystemTraits& traits) {
  s_ = s;
  traits_ = traits;
  const int n = traits.unknowns, d = traits.differential, u = traits.undetermined, order = s * unknowns();
  const auto grow = [](auto& values, std::size_t size) {
    if (values.size() < size + 1) values.resize(size + 1);
  };
  grow(X_, area(n, columns()));
  grow(Y_, area(traits.leading_size, columns()));
  grow(B_, area(d, columns()));
  grow(tau_, area(s, 1));
  grow(z_, area(order, 1));
  if (traits.is_constant) return;
  grow(L_, area(s * d, traits.leading_size));
  grow(V_, area(s * u, n));
  grow(products_, area(s * d, columns()));
  grow(free_products_, area(s * u, columns()));
  grow(matrix_, area(padded_rows(order), order));
  grow(pivots_, area(order, 1));
}

void LinearStages::keep(int i, const LinearPoint& point, LeadingTerm leading, Arena& arena) {
  const NullSpaceForm& form = point.form;
  const TaylorData& data = point.data;
  const int n = traits_.unknowns, d = form.d, size_w = traits_.leading_size;
  const int own = form.unknowns() + 1, first = i * own;  // columns of the stage
  copy(form.T2_xp(), view(X_, n, columns()).columns(first, own));
  copy(form.B_b(), view(B_, d, columns()).columns(first, own));
  tau_[index(i)] = data.time_scale;
  if (traits_.is_constant) {
    // Only the last columns differ from stage to stage; g0 takes the place of W xp.
    std::copy_n(form.g0(), d, Y_.data() + static_cast<std::ptrdiff_t>(i) * d);
    return;
  }
  const View Y = view(Y_, size_w, columns()).columns(first, own);
  const View L{L_.data() + static_cast<std::ptrdiff_t>(i) * d, d, size_w, std::max(s_ * d, 1)};
  if (leading == LeadingTerm::matrix) {
    multiply(1.0, Op::plain, data.E(0), Op::plain, form.T2_xp(), 0.0, Y);
    for (int j = 0; j < Y.cols; ++j)
      for (int k = 0; k < size_w; ++k) Y(k, j) /= data.row_scale[index(k)];
    for (int k = 0; k < size_w; ++k)
      for (int r = 0; r < d; ++r) L(r, k) = form.Z1()(k, r) * data.row_scale[index(k)];
  } else {
    copy(form.T2_xp(), Y);
    if (leading == LeadingTerm::projector) form.project(Y, arena);
    multiply(1.0, Op::transposed, form.Z1(), Op::plain, data.E(0), 0.0, L);
  }
  if (form.u == 0) return;
  const View V{V_.data() + static_cast<std::ptrdiff_t>(i) * form.u, form.u, n, s_ * form.u};
  multiply(1.0, Op::transposed, form.Uz(), Op::transposed, form.T2(), 0.0, V);
}

bool LinearStages::solve_coupled(const StageEquations& equations, const double* x, Arena& arena, long& count) {
  assemble(equations, x, arena);
  const int order = s_ * unknowns();
  const View M{matrix_.data(), order, order, padded_rows(order)};
  if (order > 0) ++count;
  if (!factor_lu(M, pivots_.data())) return false;
  solve_lu(M, pivots_.data(), z_.data());
  return true;
}

void LinearStages::assemble(const StageEquations& equations, const double* x, Arena& arena) {
  const int d = traits_.differential, u = traits_.undetermined, q = unknowns();
  const View M{matrix_.data(), s_ * q, s_ * q, padded_rows(s_ * q)};
  const Arena::Frame frame(arena);
  add_rows({d, 0, L_, view(Y_, traits_.leading_size, columns()), equations.w}, equations, products_, arena);
  add_rows({u, d, V_, view(X_, traits_.unknowns, columns()), x}, equations, free_products_, arena);
  for (int i = 0; i < s_; ++i) {
    const ConstView B_b = view(B_, d, columns()).columns(i * (q + 1), q + 1);
    for (int k = 0; k < q; ++k)
      for (int r = 0; r < d; ++r) M(i * q + r, i * q + k) -= B_b(r, k);
    for (int r = 0; r < d; ++r) z_[index(i * q + r)] += B_b(r, q);
  }
}

void LinearStages::add_rows(const Rows& of, const StageEquations& equations, std::vector<double>& storage,
                            Arena& arena) {
  if (of.rows == 0) return;
  const StageMethod& method = equations.method;
  const int s = s_, q = unknowns(), rows = of.rows;
  const double h = equations.t_end - equations.t;
  const View M{matrix_.data(), s * q, s * q, padded_rows(s * q)};
  const ConstView L{of.left.data(), s * rows, of.right.rows, s * rows};
  const View products = view(storage, s * rows, columns());
  multiply(1.0, Op::plain, L, Op::plain, of.right, 0.0, products);
  double* from_start = arena.take(area(s * rows, 1));
  multiply(1.0, Op::plain, L, of.start, 0.0, from_start);
  for (int i = 0; i < s; ++i) {
    const double factor = tau_[index(i)] / h;
    double* z = z_.data() + static_cast<std::ptrdiff_t>(i) * q + of.at;
    std::fill_n(z, rows, 0.0);
    for (int j = 0; j < s; ++j) {
      const double weight = factor * method.D_at(i, j);
      for (int k = 0; k < q; ++k) {
        const double* from = products.column(j * (q + 1) + k) + static_cast<std::ptrdiff_t>(i) * rows;
        double* to = M.column(j * q + k) + static_cast<std::ptrdiff_t>(i) * q + of.at;
        for (int r = 0; r < rows; ++r) to[r] = weight * from[r];
      }
      const double* particular = products.column(j * (q + 1) + q);
      for (int r = 0; r < rows; ++r) z[r] -= weight * (particular[i * rows + r] - from_start[i * rows + r]);
    }
  }
}

// r_i = b_i - tau/h sum_j D_ij (g0_j - Z1^T E w), and - tau/h sum_j D_ij U^T (xp_j - x) for free components;
// offsets: terms that are differenced.
void LinearStages::fill_residuals(const StageEquations& equations, double factor, ConstView offsets, View r) const {
  const int d = traits_.differential, q = unknowns();
  for (int i = 0; i < s_; ++i) {
    const double* b = B_.data() + area(d, i * (q + 1) + q);
    for (int k = 0; k < q; ++k) {
      double sum = 0.0;
      for (int j = 0; j < s_; ++j) sum += equations.method.D_at(i, j) * offsets(k, j);
      r(k, i) = (k < d ? b[k] : 0.0) - factor * sum;
    }
  }
}

void LinearStages::solve_decoupled(const StageEquations& equations, const double* x, const ConstantMatrices& constant,
                                   Arena& arena) {
  const StageMethod& method = equations.method;
  const NullSpaceForm& form = constant.point.form;
  const int s = s_, n = traits_.unknowns, d = form.d, u = form.u, q = d + u;
  const double h = equations.t_end - equations.t, factor = constant.point.data.time_scale / h;
  const Arena::Frame frame(arena);
  const View offsets = arena.matrix(std::max(q, 1), s), r = arena.matrix(std::max(q, 1), s);
  double* from_start = arena.take(area(q, 1));
  differential_rows(constant.leading, constant.point, equations.w, from_start, arena);
  double* difference = arena.take(area(n, 1));
  double* along = arena.take(area(q, 1));
  for (int j = 0; j < s; ++j) {
    const double* g0 = Y_.data() + static_cast<std::ptrdiff_t>(j) * d;
    for (int k = 0; k < d; ++k) offsets(k, j) = g0[k] - from_start[k];
    if (u == 0) continue;
    const double* xp = X_.data() + area(n, j * (q + 1) + q);
    for (int k = 0; k < n; ++k) difference[k] = xp[k] - x[k];
    multiply(1.0, Op::transposed, form.T2(), difference, 0.0, along);
    multiply(1.0, Op::transposed, form.Uz(), along, 0.0, offsets.column(j) + d);
  }
  fill_residuals(equations, factor, offsets, r);
  const View z{z_.data(), q, s, std::max(q, 1)}, correction = arena.matrix(std::max(q, 1), s);
  constant.matrix.solve_stages(method, r, z, arena);
  // T is badly conditioned for many stages (1e2 for seven: transformed_stages_test.cpp): iterating with the residual
  // compensates for that, and three stages do not need it.
  if (s <= 3) return;
  const View Gz = arena.matrix(std::max(q, 1), s);
  multiply(1.0, Op::plain, form.G(), Op::plain, z, 0.0, Gz.top(d));
  if (u > 0) multiply(1.0, Op::transposed, form.Uz(), Op::plain, z, 0.0, Gz.block(d, 0, u, s));
  multiply(-factor, Op::plain, Gz.top(q), Op::transposed, ConstView{method.D.data(), s, s, s}, 1.0, r.top(q));
  multiply(1.0, Op::plain, form.B(), Op::plain, z, 1.0, r.top(d));
  constant.matrix.solve_stages(method, r, correction, arena);
  for (int i = 0; i < s; ++i)
    for (int k = 0; k < q; ++k) z(k, i) += correction(k, i);
}

void LinearStages::combine(int i, const std::vector<double>& storage, int rows, double* to) const {
  const int q = unknowns();
  const ConstView C = view(storage, rows, columns()).columns(i * (q + 1), q + 1);
  std::copy_n(C.column(q), rows, to);
  multiply(1.0, Op::plain, C.columns(0, q), z_.data() + static_cast<std::ptrdiff_t>(i) * q, 1.0, to);
}

}  // namespace sfdae::core
