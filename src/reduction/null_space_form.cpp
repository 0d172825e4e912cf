// The strangeness-free system of a linear problem at one point, in null-space form.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/null_space_form.h"

#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

std::size_t area(int rows, int cols) { return index(rows) * index(cols) + 1; }

}  // namespace

void NullSpaceForm::resize(int rows, int cols, int num_prescribed, int carried) {
  m = rows;
  n = cols;
  T2_.resize(area(n, n + 1));
  Z1_.resize(area(m, n));
  G_.resize(area(n, n));
  B_.resize(area(n, n + 1));
  Uz_.resize(area(n, n));
  g0_.resize(area(n, 1));
  K_.resize(area(n, n));
  R3_.resize(area(n, n));
  Qg_.resize(area(n, n));
  pivots3_.resize(area(n, 1));
  factors_.resize(area(n, carried));
  tau_.resize(area(n, 1));
  pivots_.resize(area(carried, 1));
  P1_.resize(area(n, num_prescribed));
  Rp_.resize(area(num_prescribed, num_prescribed));
}

// A^^T P = Q [R11 R12; 0 R22 ~ 0]: rank a; T2 = the last n - a columns of Q.
void NullSpaceForm::build_constraints(const Carried& carried, Judge& judge, Arena& arena, PointRanks& ranks) {
  carried_ = carried.rows;
  factors_.resize(std::max(factors_.size(), area(n, carried_)));
  pivots_.resize(std::max(pivots_.size(), area(carried_, 1)));
  const View factors{factors_.data(), n, carried_, n};
  for (int i = 0; i < carried_; ++i)
    for (int j = 0; j < n; ++j) factors(j, i) = carried.constraints(i, j);
  const Arena::Frame frame(arena);
  ConstView original;
  if (judge.keeps_originals()) {
    const View kept = arena.matrix(n, carried_);
    copy(factors, kept);
    original = kept;
  }
  factor_qr_pivoted(factors, pivots_.data(), tau_.data(), arena);
  rank_ = carried_ > 0 ? judge.decide_constraints(factors, original) : 0;
  ranks.a = rank_;
  ranks.v_hat = carried_ - rank_;

  const View T2 = columns_T2(0, n - rank_);
  fill(T2, 0.0);
  for (int j = 0; j < T2.cols; ++j) T2(rank_ + j, j) = 1.0;
  apply_q(Op::plain, factors, rank_, tau_.data(), T2, arena);
  a = rank_;
}

// xp = -A2^+ f2 = Q [y; 0] with R11^T y = -f^, and what the redundant rows say about it: R12^T y + f^ = 0.
void NullSpaceForm::solve_constraints(const double* f_hat, double norm_f, Arena& arena) {
  const View factors{factors_.data(), n, carried_, n};
  double* xp = T2_.data() + static_cast<std::ptrdiff_t>(unknowns()) * n;
  std::fill_n(xp, n, 0.0);
  // What is carried of f may be nothing but rounding errors of f.
  double scale = norm_f;
  for (int i = 0; i < carried_; ++i) scale = std::max(scale, std::fabs(f_hat[i]));
  for (int i = 0; i < rank_; ++i) xp[i] = -f_hat[pivots_[index(i)]];
  solve_upper(Op::transposed, factors.block(0, 0, rank_, rank_), {xp, rank_, 1, n});
  double worst = 0.0;
  for (int i = rank_; i < carried_; ++i) {
    double residual = f_hat[pivots_[index(i)]], size = scale;
    for (int k = 0; k < rank_; ++k) {
      residual += factors(k, i) * xp[k];
      size = std::max(size, std::fabs(factors(k, i) * xp[k]));
    }
    if (size > 0.0) worst = std::max(worst, std::fabs(residual) / size);
  }
  inconsistency_ = worst;
  apply_q(Op::plain, factors, rank_, tau_.data(), {xp, n, 1, n}, arena);
}

// With J the prescribed components: (J T2)^T = Q [R; 0]. T2 Q1 =: P1 moves them, T2 Q2 leaves them alone.
bool NullSpaceForm::build_prescription(const std::vector<int>& components, Arena& arena) {
  const int count = static_cast<int>(components.size());
  const int columns = n - rank_;
  if (count > columns) return false;
  const Arena::Frame frame(arena);
  const View factors = arena.matrix(columns, count);
  const View T2 = columns_T2(0, columns);
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < columns; ++j) factors(j, i) = T2(components[index(i)], j);
  double* tau = arena.take(index(count));
  factor_qr(factors, tau, arena);
  // T2 has orthonormal columns: values are sines of angles, and 1e-8 is the square root of rounding.
  for (int i = 0; i < count; ++i)
    if (std::fabs(factors(i, i)) < 1e-8) return false;
  copy(factors.block(0, 0, count, count), {Rp_.data(), count, count, count});
  const View Q = arena.matrix(columns, columns), moved = arena.matrix(n, columns);
  form_q(factors, count, tau, Q, arena);
  multiply(1.0, Op::plain, T2, Op::plain, Q, 0.0, moved);
  copy(moved.columns(0, count), {P1_.data(), n, count, n});
  copy(moved.columns(count, columns - count), columns_T2(0, columns - count));
  a = rank_ + count;
  return true;
}

// xp += P1 R^-T (values - xp_J).
void NullSpaceForm::apply_prescription(Prescription prescription) {
  const int count = prescription.count();
  if (count == 0) return;
  double* xp = T2_.data() + static_cast<std::ptrdiff_t>(unknowns()) * n;
  double* missing = g0_.data();  // free until the differential equations are built; count <= n
  for (int i = 0; i < count; ++i) missing[i] = prescription.values[i] - xp[(*prescription.components)[index(i)]];
  solve_upper(Op::transposed, {Rp_.data(), count, count, count}, {missing, count, 1, count});
  multiply(1.0, Op::plain, ConstView{P1_.data(), n, count, n}, missing, 1.0, xp);
}

// ker E = range of P [-R11^-1 R12; I], orthonormalized.
void NullSpaceForm::build_kernel(const Carried& carried, Arena& arena) {
  const int r = carried.rank_E;
  kernel_ = leading_ == LeadingTerm::projector ? n - r : 0;
  if (kernel_ == 0) return;
  const Arena::Frame frame(arena);
  const View top = arena.matrix(r, kernel_);
  copy(carried.R.block(0, r, r, kernel_), top);
  solve_upper(Op::plain, carried.R.block(0, 0, r, r), top);
  const View basis = arena.matrix(n, kernel_);
  fill(basis, 0.0);
  for (int j = 0; j < kernel_; ++j) {
    for (int i = 0; i < r; ++i) basis(carried.pivots[i], j) = -top(i, j);
    basis(carried.pivots[r + j], j) = 1.0;
  }
  double* tau = arena.take(index(kernel_));
  factor_qr(basis, tau, arena);
  form_q(basis, kernel_, tau, {K_.data(), n, kernel_, n}, arena);
}

// E T2 P = Z1 R3, then G, B, b, g0.
void NullSpaceForm::build_differential_equations(const TaylorData& data, Judge& judge, Arena& arena,
                                                 PointRanks& ranks) {
  const Arena::Frame frame(arena);
  const int columns = n - a;
  const ConstView T2_xp{T2_.data(), n, columns + 1, n};
  const View ET = arena.matrix(m, columns + 1);
  multiply(1.0, Op::plain, data.E(0), Op::plain, T2_xp, 0.0, ET);
  ConstView original;
  const View factors = ET.columns(0, columns);
  if (judge.keeps_originals()) {
    const View kept = arena.matrix(m, columns);
    copy(factors, kept);
    original = kept;
  }
  double* tau = arena.take(index(std::min(m, columns)) + 1);
  int* pivots = arena.integers(columns);
  factor_qr_pivoted(factors, pivots, tau, arena);
  d = columns > 0 && m > 0 ? judge.decide_differential(factors, original) : 0;
  u = columns - d;
  ranks.d = d;
  form_q(factors, d, tau, {Z1_.data(), m, d, m}, arena);

  const View G{G_.data(), d, columns, std::max(d, 1)};
  for (int j = 0; j < columns; ++j) {
    double* to = G.column(pivots[j]);
    const int length = std::min(j + 1, d);
    std::copy_n(factors.column(j), length, to);
    std::fill_n(to + length, d - length, 0.0);
  }
  factor_G(factors, pivots, arena);
  multiply(1.0, Op::transposed, Z1(), ET.column(columns), 0.0, g0_.data());

  const View CT = arena.matrix(m, columns + 1);  // C [T2 | xp] + [0 | f]
  multiply(1.0, Op::plain, data.A(0), Op::plain, T2_xp, 0.0, CT);
  const bool E_varies = data.orders.E >= 1 && !data.is_zero_E(1);
  if (leading_ == LeadingTerm::matrix && E_varies) {
    multiply(1.0, Op::plain, data.E(1), Op::plain, T2_xp, 1.0, CT);
  } else if (leading_ == LeadingTerm::projector && kernel_ > 0 && E_varies) {
    const View EK = arena.matrix(m, kernel_), KT = arena.matrix(kernel_, columns + 1);
    multiply(1.0, Op::plain, data.E(1), Op::plain, kernel(), 0.0, EK);
    multiply(1.0, Op::transposed, kernel(), Op::plain, T2_xp, 0.0, KT);
    multiply(1.0, Op::plain, EK, Op::plain, KT, 1.0, CT);
  }
  const double* f = data.f(0);
  for (int i = 0; i < m; ++i) CT(i, columns) += f[i];
  multiply(1.0, Op::transposed, Z1(), Op::plain, CT, 0.0, {B_.data(), d, columns + 1, std::max(d, 1)});
}

void NullSpaceForm::factor_G(ConstView R3, const int* pivots, Arena& arena) {
  const int columns = unknowns();
  std::copy_n(pivots, columns, pivots3_.data());
  if (u == 0) {
    copy(R3.block(0, 0, d, d), {R3_.data(), d, d, std::max(d, 1)});
    return;
  }
  // R3^T = Q R, so that the row space of G is range Q1 and its kernel range Q2.
  const Arena::Frame frame(arena);
  const View rows = arena.matrix(columns, d), Q = arena.matrix(columns, columns);
  for (int i = 0; i < d; ++i)
    for (int j = 0; j < columns; ++j) rows(j, i) = j >= i ? R3(i, j) : 0.0;
  double* tau = arena.take(index(d) + 1);
  factor_qr(rows, tau, arena);
  form_q(rows, d, tau, Q, arena);
  copy(rows.block(0, 0, d, d), {R3_.data(), d, d, std::max(d, 1)});
  for (int i = 0; i < columns; ++i) {
    const int row = pivots[i];
    for (int j = 0; j < d; ++j) Qg_[index(j * columns + row)] = Q(i, j);
    for (int j = 0; j < u; ++j) Uz_[index(j * columns + row)] = Q(i, d + j);
  }
}

void NullSpaceForm::solve_G(const double* q, double* z, Arena& arena) const {
  const Arena::Frame frame(arena);
  double* y = arena.take(index(d) + 1);
  std::copy_n(q, d, y);
  const ConstView R{R3_.data(), d, d, std::max(d, 1)};
  if (u == 0) {
    solve_upper(Op::plain, R, {y, d, 1, std::max(d, 1)});
    for (int i = 0; i < d; ++i) z[pivots3_[index(i)]] = y[i];
    return;
  }
  solve_upper(Op::transposed, R, {y, d, 1, std::max(d, 1)});
  multiply(1.0, Op::plain, ConstView{Qg_.data(), unknowns(), d, unknowns()}, y, 0.0, z);
}

int NullSpaceForm::sign_of_G() const {
  // G is R3 with permuted columns: signs of the diagonal, and one for every cycle of even length.
  int sign = 1;
  for (int i = 0; i < d; ++i) {
    const double r = R3_[index(i) * index(d + 1)];
    if (r == 0.0) return 0;
    if (r < 0.0) sign = -sign;
    int next = i, length = 0;
    do {
      next = pivots3_[index(next)];
      ++length;
    } while (next > i);
    if (next == i && length % 2 == 0) sign = -sign;
  }
  return sign;
}

void NullSpaceForm::project(double* y, Arena& arena) const {
  if (kernel_ == 0) return;
  const Arena::Frame frame(arena);
  double* coefficients = arena.take(index(kernel_));
  multiply(1.0, Op::transposed, kernel(), y, 0.0, coefficients);
  multiply(-1.0, Op::plain, kernel(), coefficients, 1.0, y);
}

PointRanks NullSpaceForm::build(const TaylorData& data, const Carried& carried, Prescription prescription,
                                LeadingTerm leading, Judge& judge, Arena& arena) {
  PointRanks ranks;
  ranks.rank_E = carried.rank_E;
  leading_ = leading;
  build_constraints(carried, judge, arena, ranks);
  if (prescription.count() > 0) ranks.prescription_fits = build_prescription(*prescription.components, arena);
  d = 0;
  u = n - a;
  const Arena::Frame frame(arena);
  double* f_hat = arena.take(index(carried.rows) + 1);
  for (int i = 0; i < carried.rows; ++i) f_hat[i] = carried.rhs(i, 0);
  solve_constraints(f_hat, data.norm_f(data.orders.f), arena);
  if (prescription.count() > 0 && ranks.prescription_fits) apply_prescription(prescription);
  build_kernel(carried, arena);
  build_differential_equations(data, judge, arena, ranks);
  return ranks;
}

void NullSpaceForm::replace_rhs(const TaylorData& data, const double* f_hat, Prescription prescription,
                                Arena& arena) {
  double norm_f = data.least_norm_f;
  for (int k = 0; k <= data.orders.f; ++k) norm_f = std::max(norm_f, max_abs(data.f(k), m));
  solve_constraints(f_hat, norm_f, arena);
  apply_prescription(prescription);
  const Arena::Frame frame(arena);
  double* h = arena.take(index(m));
  multiply(1.0, Op::plain, data.E(0), xp(), 0.0, h);
  multiply(1.0, Op::transposed, Z1(), h, 0.0, g0_.data());
  std::copy_n(data.f(0), m, h);
  multiply(1.0, Op::plain, data.A(0), xp(), 1.0, h);
  multiply(1.0, Op::transposed, Z1(), h, 0.0, B_.data() + static_cast<std::ptrdiff_t>(unknowns()) * d);
}

void NullSpaceForm::project(View Y, Arena& arena) const {
  if (kernel_ == 0) return;
  const Arena::Frame frame(arena);
  const View coefficients = arena.matrix(kernel_, Y.cols);
  multiply(1.0, Op::transposed, kernel(), Op::plain, Y, 0.0, coefficients);
  multiply(-1.0, Op::plain, kernel(), Op::plain, coefficients, 1.0, Y);
}

void NullSpaceForm::archive_bases(Archive& archive) {
  archive.small(a, d, u);
  if (archive.is_reading() && (d < 0 || u < 0 || unknowns() > n || d > m)) throw DamagedArchive();
  archive.reals(T2_.data(), index(n) * index(unknowns()));
  archive.reals(Z1_.data(), index(m) * index(d));
}

}  // namespace sfdae::core
