// The stages of an implicit Runge-Kutta step, solved together.
//
// With x_j = X_j [z_j; 1], X_j = [T2 xp] at t_j, and Y_j = W_j X_j the equations of stage i are
//
//     tau/h L_i sum_j D_ij (Y_j [z_j; 1] - w) = [B b]_i [z_i; 1]        L_i = Z1^T E (or Z1^T for W = E)
//     sum_j D_ij V_i (X_j [z_j; 1] - x) = 0                             V_i = (T2 Uz)^T, free components
//
// s(d+u) linear equations. Where the matrices do not depend on t, transformation by T decouples them into one real
// system and (s-1)/2 complex ones of order d + u [HW96, IV.8]; nothing has to be iterated, as the problem is linear.
//
// [HW96] E. Hairer, G. Wanner: Solving Ordinary Differential Equations II. Springer, 2nd ed. 1996.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "system/linear_system.h"

namespace sfdae::core {

namespace {

std::size_t area(int rows, int cols) { return index(rows) * index(cols); }

View view(std::vector<double>& values, int rows, int cols) { return {values.data(), rows, cols, std::max(rows, 1)}; }

}  // namespace

PointStatus LinearSystem::solve_stages(const StageEquations& equations, double* x, double* w, double& t_reached) {
  const int s = equations.method.s;
  resize_stages(s);
  for (int i = 0; i < s; ++i) {
    const double c = equations.method.c[index(i)];
    t_reached = i == s - 1 ? equations.t_end : equations.t + c * (equations.t_end - equations.t);
    const PointStatus status = move_to(t_reached);
    if (status != PointStatus::ok) return status;
    keep_stage(i, s);
    if (i < s - 1 && !problem_.is_constant()) trace(stage_traces_[index(i)]);
  }
  num_stage_traces_ = problem_.is_constant() ? 0 : s - 1;
  const Arena::Frame frame(arena_);
  const double* x_start = inward(equations.x, arena_.take(index(problem_.n())));
  if (problem_.is_constant()) {
    if (!solve_constant_stages(equations, x_start)) return PointStatus::singular;
  } else {
    assemble_stages(equations, x_start);
    const int order = s * current().form.unknowns();
    const View M{stages_.matrix.data(), order, order, padded_rows(order)};
    if (order > 0) ++counts_.factorizations;
    if (!factor_lu(M, stages_.pivots.data())) return PointStatus::singular;
    solve_lu(M, stages_.pivots.data(), stages_.z.data());
  }
  expand_stages(s, x, w);
  return PointStatus::ok;
}

void LinearSystem::resize_stages(int s) {
  const int n = problem_.n(), q = differential() + undetermined(), columns = s * (q + 1), order = s * q;
  const auto grow = [](auto& values, std::size_t size) {
    if (values.size() < size + 1) values.resize(size + 1);
  };
  grow(stages_.X, area(n, columns));
  grow(stages_.Y, area(leading_size(), columns));
  grow(stages_.B, area(differential(), columns));
  grow(stages_.tau, area(s, 1));
  grow(stages_.z, area(order, 1));
  if (problem_.is_constant()) return;
  grow(stages_.L, area(s * differential(), leading_size()));
  grow(stages_.V, area(s * undetermined(), n));
  grow(stages_.products, area(s * differential(), columns));
  grow(stages_.free_products, area(s * undetermined(), columns));
  grow(stages_.matrix, area(padded_rows(order), order));
  grow(stages_.pivots, area(order, 1));
}

// Copies what the equations of all stages need from the current point, stage i.
void LinearSystem::keep_stage(int i, int s) {
  const NullSpaceForm& form = current().form;
  const TaylorData& data = current().data;
  const int n = problem_.n(), d = form.d, q = form.unknowns(), size_w = leading_size(), first = i * (q + 1);
  copy(form.T2_xp(), view(stages_.X, n, s * (q + 1)).columns(first, q + 1));
  copy(form.B_b(), view(stages_.B, d, s * (q + 1)).columns(first, q + 1));
  stages_.tau[index(i)] = data.time_scale;
  if (problem_.is_constant()) {
    // Only the last columns differ from stage to stage; g0 takes the place of W xp.
    std::copy_n(form.g0(), d, stages_.Y.data() + static_cast<std::ptrdiff_t>(i) * d);
    return;
  }
  const View Y = view(stages_.Y, size_w, s * (q + 1)).columns(first, q + 1);
  const View L{stages_.L.data() + static_cast<std::ptrdiff_t>(i) * d, d, size_w, std::max(s * d, 1)};
  if (leading_ == LeadingTerm::matrix) {
    multiply(1.0, Op::plain, data.E(0), Op::plain, form.T2_xp(), 0.0, Y);
    for (int j = 0; j < Y.cols; ++j)
      for (int k = 0; k < size_w; ++k) Y(k, j) /= data.row_scale[index(k)];
    for (int k = 0; k < size_w; ++k)
      for (int r = 0; r < d; ++r) L(r, k) = form.Z1()(k, r) * data.row_scale[index(k)];
  } else {
    copy(form.T2_xp(), Y);
    if (leading_ == LeadingTerm::projector) form.project(Y, arena_);
    multiply(1.0, Op::transposed, form.Z1(), Op::plain, data.E(0), 0.0, L);
  }
  if (form.u == 0) return;
  const View V{stages_.V.data() + static_cast<std::ptrdiff_t>(i) * form.u, form.u, n, s * form.u};
  multiply(1.0, Op::transposed, form.Uz(), Op::transposed, form.T2(), 0.0, V);
}

void LinearSystem::trace(Trace& trace) {
  trace.t = t();
  trace.orientation_kept = orientation_kept();
  trace.kept_constraints = kept_constraints();
  trace.kept_differential = kept_differential();
  trace.row_norms.assign(row_norms().begin(), row_norms().end());
}

void LinearSystem::assemble_stages(const StageEquations& equations, const double* x_start) {
  const StageMethod& method = equations.method;
  const int s = method.s, n = problem_.n(), d = differential(), u = undetermined(), q = d + u, columns = s * (q + 1);
  const double h = equations.t_end - equations.t;
  const View M{stages_.matrix.data(), s * q, s * q, padded_rows(s * q)};
  const Arena::Frame frame(arena_);
  // rows: those of one kind of equations of all stages; at: where they go in each stage.
  const auto add_rows = [&](int rows, int at, const std::vector<double>& left, ConstView right, const double* start,
                            std::vector<double>& storage) {
    if (rows == 0) return;
    const ConstView L{left.data(), s * rows, right.rows, s * rows};
    const View products = view(storage, s * rows, columns);
    multiply(1.0, Op::plain, L, Op::plain, right, 0.0, products);
    double* from_start = arena_.take(area(s * rows, 1));
    multiply(1.0, Op::plain, L, start, 0.0, from_start);
    for (int i = 0; i < s; ++i) {
      const double factor = stages_.tau[index(i)] / h;
      double* z = stages_.z.data() + static_cast<std::ptrdiff_t>(i) * q + at;
      std::fill_n(z, rows, 0.0);
      for (int j = 0; j < s; ++j) {
        const double weight = factor * method.D_at(i, j);
        for (int k = 0; k < q; ++k) {
          const double* from = products.column(j * (q + 1) + k) + static_cast<std::ptrdiff_t>(i) * rows;
          double* to = M.column(j * q + k) + static_cast<std::ptrdiff_t>(i) * q + at;
          for (int r = 0; r < rows; ++r) to[r] = weight * from[r];
        }
        const double* particular = products.column(j * (q + 1) + q);
        for (int r = 0; r < rows; ++r) z[r] -= weight * (particular[i * rows + r] - from_start[i * rows + r]);
      }
    }
  };
  add_rows(d, 0, stages_.L, view(stages_.Y, leading_size(), columns), equations.w, stages_.products);
  add_rows(u, d, stages_.V, view(stages_.X, n, columns), x_start, stages_.free_products);
  for (int i = 0; i < s; ++i) {
    const ConstView B_b = view(stages_.B, d, columns).columns(i * (q + 1), q + 1);
    for (int k = 0; k < q; ++k)
      for (int r = 0; r < d; ++r) M(i * q + r, i * q + k) -= B_b(r, k);
    for (int r = 0; r < d; ++r) stages_.z[index(i * q + r)] += B_b(r, q);
  }
}

bool LinearSystem::solve_constant_stages(const StageEquations& equations, const double* x_start) {
  const StageMethod& method = equations.method;
  const NullSpaceForm& form = current().form;
  const int s = method.s, n = problem_.n(), d = form.d, u = form.u, q = d + u;
  const double h = equations.t_end - equations.t, factor = current().data.time_scale / h;
  const Arena::Frame frame(arena_);
  // r_i = b_i - tau/h sum_j D_ij (g0_j - Z1^T E w), and - tau/h sum_j D_ij U^T (xp_j - x) for free components.
  const View offsets = arena_.matrix(std::max(q, 1), s), r = arena_.matrix(std::max(q, 1), s);
  double* from_start = arena_.take(area(q, 1));
  differential_rows(equations.w, from_start);
  double* difference = arena_.take(area(n, 1));
  double* along = arena_.take(area(q, 1));
  for (int j = 0; j < s; ++j) {
    const double* g0 = stages_.Y.data() + static_cast<std::ptrdiff_t>(j) * d;
    for (int k = 0; k < d; ++k) offsets(k, j) = g0[k] - from_start[k];
    if (u == 0) continue;
    const double* xp = stages_.X.data() + area(n, j * (q + 1) + q);
    for (int k = 0; k < n; ++k) difference[k] = xp[k] - x_start[k];
    multiply(1.0, Op::transposed, form.T2(), difference, 0.0, along);
    multiply(1.0, Op::transposed, form.Uz(), along, 0.0, offsets.column(j) + d);
  }
  for (int i = 0; i < s; ++i) {
    const double* b = stages_.B.data() + area(d, i * (q + 1) + q);
    for (int k = 0; k < q; ++k) {
      double sum = 0.0;
      for (int j = 0; j < s; ++j) sum += method.D_at(i, j) * offsets(k, j);
      r(k, i) = (k < d ? b[k] : 0.0) - factor * sum;
    }
  }
  if (!factor_step_matrix(method.gamma / h)) return false;
  if (!matrix_.factor_stages(form, current().data.time_scale, method, counts_.factorizations)) return false;
  const View z{stages_.z.data(), q, s, std::max(q, 1)}, correction = arena_.matrix(std::max(q, 1), s);
  matrix_.solve_stages(method, r, z, arena_);
  // T is badly conditioned for many stages: the residual makes up for that.
  if (s <= 3) return true;
  const View Gz = arena_.matrix(std::max(q, 1), s);
  multiply(1.0, Op::plain, form.G(), Op::plain, z, 0.0, Gz.top(d));
  if (u > 0) multiply(1.0, Op::transposed, form.Uz(), Op::plain, z, 0.0, Gz.block(d, 0, u, s));
  multiply(-factor, Op::plain, Gz.top(q), Op::transposed, ConstView{method.D.data(), s, s, s}, 1.0, r.top(q));
  multiply(1.0, Op::plain, form.B(), Op::plain, z, 1.0, r.top(d));
  matrix_.solve_stages(method, r, correction, arena_);
  for (int i = 0; i < s; ++i)
    for (int k = 0; k < q; ++k) z(k, i) += correction(k, i);
  return true;
}

void LinearSystem::expand_stages(int s, double* x, double* w) {
  const int n = problem_.n(), q = differential() + undetermined(), size_w = leading_size();
  for (int i = 0; i < s; ++i) {
    const double* z = stages_.z.data() + static_cast<std::ptrdiff_t>(i) * q;
    const auto combine = [&](std::vector<double>& storage, int rows, double* to) {
      const ConstView C = view(storage, rows, s * (q + 1)).columns(i * (q + 1), q + 1);
      std::copy_n(C.column(q), rows, to);
      multiply(1.0, Op::plain, C.columns(0, q), z, 1.0, to);
    };
    double* x_i = x + static_cast<std::ptrdiff_t>(i) * n;
    double* w_i = w + static_cast<std::ptrdiff_t>(i) * size_w;
    combine(stages_.X, n, x_i);
    if (problem_.is_constant()) leading_of(x_i, w_i);
    else combine(stages_.Y, size_w, w_i);
    outward(x_i);
  }
}

}  // namespace sfdae::core
