// The strangeness-free system of a linear problem at one point, in null-space form.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/null_space_form.h"

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

std::size_t area(int rows, int cols) { return index(rows) * index(cols) + 1; }

}  // namespace

void NullSpaceForm::resize(int rows, int cols, int num_prescribed, int carried) {
  constraints_.resize(cols, carried);
  prescribed_.resize(cols, num_prescribed);
  differential_.resize(cols);
  projector_.resize(cols);
  T2_.resize(area(cols, cols + 1));
  Z1_.resize(area(rows, cols));
  G_.resize(area(cols, cols));
  B_.resize(area(cols, cols + 1));
  g0_.resize(area(cols, 1));
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
  build_differential_equations(data, leading, judge, arena);
  ranks.d = d;
  return ranks;
}

// Of E T2 P; its rank.
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

// E T2 P = Z1 R3, then G, B, b, g0.
void NullSpaceForm::build_differential_equations(const TaylorData& data, LeadingTerm leading, Judge& judge,
                                                 Arena& arena) {
  const Arena::Frame frame(arena);
  const int columns = n - a;
  const ConstView T2_xp{T2_.data(), n, columns + 1, n};
  const View ET = arena.matrix(m, columns + 1);
  multiply(1.0, Op::plain, data.E(0), Op::plain, T2_xp, 0.0, ET);
  const View factors = ET.columns(0, columns);
  double* tau = arena.take(index(std::min(m, columns)) + 1);
  int* pivots = arena.integers(columns);
  d = factor_differential({factors, pivots, tau}, judge, arena);
  u = columns - d;
  form_q(factors, d, tau, {Z1_.data(), m, d, m}, arena);

  const View G{G_.data(), d, columns, std::max(d, 1)};
  for (int j = 0; j < columns; ++j) {
    double* to = G.column(pivots[j]);
    const int length = std::min(j + 1, d);
    std::copy_n(factors.column(j), length, to);
    std::fill_n(to + length, d - length, 0.0);
  }
  differential_.factor(factors.top(d), pivots, arena);
  multiply(1.0, Op::transposed, Z1(), ET.column(columns), 0.0, g0_.data());

  const View CT = arena.matrix(m, columns + 1);
  apply_C(data, leading, T2_xp, CT, arena);
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

void NullSpaceForm::replace_rhs(const TaylorData& data, const double* f_hat, Prescription prescription,
                                Arena& arena) {
  double norm_f = data.least_norm_f;
  for (int k = 0; k <= data.orders.f; ++k) norm_f = std::max(norm_f, max_abs(data.f(k), m));
  inconsistency_ = constraints_.solve(f_hat, norm_f, particular(), arena);
  prescribed_.apply(prescription, particular(), arena);
  const Arena::Frame frame(arena);
  double* h = arena.take(index(m));
  multiply(1.0, Op::plain, data.E(0), xp(), 0.0, h);
  multiply(1.0, Op::transposed, Z1(), h, 0.0, g0_.data());
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
