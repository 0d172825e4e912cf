// The strangeness-free system of a linear problem at one point, in null-space form.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/null_space_form.h"

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

std::size_t area(int rows, int cols) { return index(rows) * index(cols) + 1; }

// G from G P = R3, d x (d + u).
void write_G(ConstView R3, const int* pivots, View G) {
  for (int j = 0; j < G.cols; ++j) {
    double* to = G.column(pivots[j]);
    const int length = std::min(j + 1, G.rows);
    std::copy_n(R3.column(j), length, to);
    std::fill_n(to + length, G.rows - length, 0.0);
  }
}

}  // namespace

void NullSpaceForm::resize(int rows, int cols, int num_prescribed, int carried) {
  resize_for_ranks(rows, cols, carried);
  prescribed_.resize(cols, num_prescribed);
  differential_.resize(cols);
  projector_.resize(cols);
  Z1_.resize(area(rows, cols));
  G_.resize(area(cols, cols));
  B_.resize(area(cols, cols + 1));
  g0_.resize(area(cols, 1));
}

void NullSpaceForm::resize_for_ranks(int rows, int cols, int carried) {
  constraints_.resize(cols, carried);
  T2_.resize(area(cols, cols + 1));
  m = rows;
  n = cols;
}

PointRanks NullSpaceForm::factor_constraints(const Carried& carried, Judge& judge, Arena& arena) {
  PointRanks ranks;
  ranks.rank_E = carried.rank_E;
  constraints_.factor(carried, judge, arena);
  a = ranks.a = constraints_.rank();
  d = 0;
  u = n - a;
  ranks.v_hat = carried.rows - ranks.a;
  constraints_.write_T2(columns_T2(n - a), arena);
  return ranks;
}

PointRanks NullSpaceForm::find_ranks(const TaylorData& data, const Carried& carried, Judge& judge, Arena& arena) {
  PointRanks ranks = factor_constraints(carried, judge, arena);
  const Arena::Frame frame(arena);
  const View ET = arena.matrix(m, n - a);
  multiply(1.0, Op::plain, data.E(0), Op::plain, columns_T2(n - a), 0.0, ET);
  ranks.d =
      factor_differential({ET, arena.integers(ET.cols), arena.take(index(std::min(m, ET.cols)) + 1)}, judge, arena);
  return ranks;
}

PointRanks NullSpaceForm::build_constraints(const TaylorData& data, const Carried& carried, Prescription prescription,
                                            Judge& judge, Arena& arena) {
  PointRanks ranks = factor_constraints(carried, judge, arena);
  if (prescription.count() > 0) {
    ranks.prescription_fits = prescribed_.split(*prescription.components, columns_T2(n - a), arena);
    if (ranks.prescription_fits) a += prescription.count();
  }
  d = 0;
  u = n - a;
  const Arena::Frame frame(arena);
  double* f_hat = arena.take(index(carried.rows) + 1);
  for (int i = 0; i < carried.rows; ++i) f_hat[i] = carried.rhs(i, 0);
  inconsistency_ = constraints_.solve(f_hat, data.norm_f(data.orders.f), particular(), arena);
  if (ranks.prescription_fits) prescribed_.apply(prescription, particular(), arena);
  return ranks;
}

PointRanks NullSpaceForm::build(const TaylorData& data, const Carried& carried, Prescription prescription,
                                LeadingTerm leading, Judge& judge, Arena& arena) {
  PointRanks ranks = build_constraints(data, carried, prescription, judge, arena);
  if (leading == LeadingTerm::projector) projector_.build(carried, arena);
  else projector_.set_identity();
  if (carried.Q1.data != nullptr) factor_within_range(carried, judge, arena);
  else factor_E_T2(data, judge, arena);
  ranks.d = d;
  const bool is_regular = m == n && d + ranks.a == n && ranks.v_hat == 0 && d == carried.rank_E;
  const int exchanges = d % 2 * (ranks.a % 2) == 0 ? 1 : -1;  // of [*, G; A2 V, 0]
  orientation_ = is_regular && carried.Q1.data != nullptr
                     ? carried.sign_of_Q * exchanges * sign_of_G() * constraints_.orientation()
                     : 0;
  build_differential_equations(data, leading, arena);
  return ranks;
}

// Factors E T2 P; returns its rank.
int NullSpaceForm::factor_differential(const PivotedFactors& ET, Judge& judge, Arena& arena) {
  const Arena::Frame frame(arena);
  ConstView original;
  if (judge.keeps_originals()) {
    const View kept = arena.matrix(ET.factors.rows, ET.factors.cols);
    copy(ET.factors, kept);
    original = kept;
  }
  factor_qr_pivoted(ET.factors, ET.pivots, ET.tau, arena);
  return ET.factors.cols > 0 && m > 0 ? judge.decide_differential(ET.factors, original) : 0;
}

// E T2 P = Z1 R3 gives Z1, G and g0.
void NullSpaceForm::factor_E_T2(const TaylorData& data, Judge& judge, Arena& arena) {
  const Arena::Frame frame(arena);
  const int columns = n - a;
  const View ET = arena.matrix(m, columns + 1);
  multiply(1.0, Op::plain, data.E(0), Op::plain, T2_xp_of(columns), 0.0, ET);
  const View factors = ET.columns(0, columns);
  double* tau = arena.take(index(std::min(m, columns)) + 1);
  int* pivots = arena.integers(columns);
  d = factor_differential({factors, pivots, tau}, judge, arena);
  u = columns - d;
  form_q(factors, d, tau, {Z1_.data(), m, d, m}, arena);
  const View G{G_.data(), d, columns, std::max(d, 1)};
  write_G(factors.top(d), pivots, G);
  differential_.factor(factors.top(d), pivots, arena);
  multiply(1.0, Op::transposed, Z1(), ET.column(columns), 0.0, g0_.data());
}

// With E P = Q1 [R11 R12] available, and rank(E T2) = rank E: Z1 = Q1, and G has only as many rows. If the rank is
// smaller, Z1 = Q1 Q3 of the factorization of Q1^T E T2.
void NullSpaceForm::factor_within_range(const Carried& carried, Judge& judge, Arena& arena) {
  const Arena::Frame frame(arena);
  const int columns = n - a, r = carried.rank_E;
  const View R = arena.matrix(r, n), GT = arena.matrix(r, columns + 1);
  for (int j = 0; j < n; ++j) {
    double* to = R.column(carried.pivots[j]);
    const int length = std::min(j + 1, r);
    std::copy_n(carried.R.column(j), length, to);
    std::fill_n(to + length, r - length, 0.0);
  }
  multiply(1.0, Op::plain, R, Op::plain, T2_xp_of(columns), 0.0, GT);
  const View factors = GT.columns(0, columns);
  std::copy_n(GT.column(columns), r, g0_.data());
  copy(factors, {G_.data(), r, columns, std::max(r, 1)});
  double* tau = arena.take(index(std::min(r, columns)) + 1);
  int* pivots = arena.integers(columns);
  d = factor_differential({factors, pivots, tau}, judge, arena);
  u = columns - d;
  if (d == r && u == 0) {
    copy(carried.Q1, {Z1_.data(), m, d, m});
    return differential_.keep(factors, pivots, tau);
  }
  const View Q3 = arena.matrix(r, d);
  form_q(factors, d, tau, Q3, arena);
  multiply(1.0, Op::plain, carried.Q1, Op::plain, Q3, 0.0, {Z1_.data(), m, d, m});
  multiply(1.0, Op::transposed, Q3, GT.column(columns), 0.0, g0_.data());
  write_G(factors.top(d), pivots, {G_.data(), d, columns, std::max(d, 1)});
  differential_.factor(factors.top(d), pivots, arena);
}

// B and b, for the known Z1 and T2.
void NullSpaceForm::build_differential_equations(const TaylorData& data, LeadingTerm leading, Arena& arena) {
  const Arena::Frame frame(arena);
  const int columns = unknowns();
  const View CT = arena.matrix(m, columns + 1);
  apply_C(data, leading, T2_xp_of(columns), CT, arena);
  const double* f = data.f(0);
  for (int i = 0; i < m; ++i) CT(i, columns) += f[i];
  multiply(1.0, Op::transposed, Z1(), Op::plain, CT, 0.0, {B_.data(), d, columns + 1, std::max(d, 1)});
}

// CX := C X; C = A + E'(I - P), A + E' or A.
void NullSpaceForm::apply_C(const TaylorData& data, LeadingTerm leading, ConstView X, View CX, Arena& arena) const {
  multiply(1.0, Op::plain, data.A(0), Op::plain, X, 0.0, CX);
  const bool E_varies = data.orders.E >= 1 && !data.is_zero_E(1);
  if (leading == LeadingTerm::matrix && E_varies) {
    multiply(1.0, Op::plain, data.E(1), Op::plain, X, 1.0, CX);
  } else if (kernel().cols > 0 && E_varies) {
    const int count = kernel().cols;
    const View EK = arena.matrix(m, count), KX = arena.matrix(count, X.cols);
    multiply(1.0, Op::plain, data.E(1), Op::plain, kernel(), 0.0, EK);
    multiply(1.0, Op::transposed, kernel(), Op::plain, X, 0.0, KX);
    multiply(1.0, Op::plain, EK, Op::plain, KX, 1.0, CX);
  }
}

void NullSpaceForm::replace_rhs(const TaylorData& data, const double* f_hat, Prescription prescription, Arena& arena,
                                RightHandSides rhs) {
  double norm_f = data.least_norm_f;
  for (int k = 0; k <= data.orders.f; ++k) norm_f = std::max(norm_f, max_abs(data.f(k), m));
  inconsistency_ = constraints_.solve(f_hat, norm_f, particular(), arena);
  prescribed_.apply(prescription, particular(), arena);
  const Arena::Frame frame(arena);
  double* h = arena.take(index(m));
  multiply(1.0, Op::plain, data.E(0), xp(), 0.0, h);
  multiply(1.0, Op::transposed, Z1(), h, 0.0, g0_.data());
  if (rhs == RightHandSides::constraints) return;
  std::copy_n(data.f(0), m, h);
  multiply(1.0, Op::plain, data.A(0), xp(), 1.0, h);
  multiply(1.0, Op::transposed, Z1(), h, 0.0, B_.data() + static_cast<std::ptrdiff_t>(unknowns()) * d);
}

void NullSpaceForm::archive_bases(Archive& archive) {
  archive.small(a, d, u);
  if (archive.is_reading() && (d < 0 || u < 0 || unknowns() > n || d > m)) throw DamagedArchive();
  archive.reals(T2_.data(), index(n) * index(unknowns()));
  archive.reals(Z1_.data(), index(m) * index(d));
}

}  // namespace sfdae::core
