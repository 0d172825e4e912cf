// Dense linear algebra of the core: small loops or LAPACK.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/dense.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>

#include "linalg/index.h"
#include "linalg/kernels_in_use.h"
#include "linalg/lapack.h"
#include "linalg/small_kernels.h"

namespace sfdae::core {

namespace {

// Measured crossovers (OpenBLAS, one thread): loops win below these sizes.
constexpr int small_lu_order = 16;
constexpr int small_complex_order = 12;
constexpr int few_entries = 16;
constexpr int few_vector_entries = 32 * 32;  // of a matrix times a vector
constexpr double small_product_flops = 2.0 * 8 * 8 * 8;
// Above these and up to that, products in vector loops are faster if the processor has vectors
// (docs/design/kernels.md).
constexpr int most_inner = 112;
static_assert(most_inner <= kernels::most_transposed);

const double one = 1.0;
const int unit_stride = 1;

const char* letter(Op op) { return op == Op::plain ? "N" : "T"; }

void scale(View c, double beta) {
  if (beta == 1.0) return;
  for (int j = 0; j < c.cols; ++j) {
    double* column = c.column(j);
    if (beta == 0.0) std::fill_n(column, c.rows, 0.0);
    else
      for (int i = 0; i < c.rows; ++i) column[i] *= beta;
  }
}

}  // namespace

void multiply(double alpha, Op op_a, ConstView a, Op op_b, ConstView b, double beta, View c) {
  if (c.rows == 0 || c.cols == 0) return;
  const int inner = op_a == Op::plain ? a.cols : a.rows;
  const double flops = 2.0 * c.rows * static_cast<double>(c.cols) * inner;
  if (flops > small_product_flops && inner <= most_inner)
    if (const auto multiply_in_vectors = kernels::loops().multiply; multiply_in_vectors != nullptr)
      return multiply_in_vectors({alpha,
                                  {a.data, a.ld, op_a == Op::transposed},
                                  {b.data, b.ld, op_b == Op::transposed},
                                  inner,
                                  beta,
                                  c.data,
                                  c.ld,
                                  c.rows,
                                  c.cols});
  if (inner == 0 || flops <= small_product_flops) {
    scale(c, beta);
    if (inner == 0) return;
    if (op_a == Op::plain) {
      if (op_b == Op::plain) small::multiply_columns(alpha, a, c, [&](int k, int j) { return b(k, j); });
      else small::multiply_columns(alpha, a, c, [&](int k, int j) { return b(j, k); });
      return;
    }
    if (op_b == Op::plain) return small::multiply_transposed(alpha, a, b, c);
    for (int j = 0; j < c.cols; ++j)
      for (int k = 0; k < inner; ++k)
        for (int i = 0; i < c.rows; ++i) c(i, j) += alpha * a(k, i) * b(j, k);
    return;
  }
  dgemm_(letter(op_a), letter(op_b), &c.rows, &c.cols, &inner, &alpha, a.data, &a.ld, b.data, &b.ld, &beta, c.data,
         &c.ld);
}

void multiply(double alpha, Op op_a, ConstView a, const double* x, double beta, double* y) {
  const int length = op_a == Op::plain ? a.rows : a.cols;
  const View result{y, length, 1, length > 0 ? length : 1};
  if (a.rows == 0 || a.cols == 0) return scale(result, beta);
  if (op_a == Op::plain && a.rows * a.cols <= few_entries) return small::multiply_few(alpha, a, x, beta, y);
  if (static_cast<double>(a.rows) * a.cols > few_vector_entries) {
    dgemv_(letter(op_a), &a.rows, &a.cols, &alpha, a.data, &a.ld, x, &unit_stride, &beta, y, &unit_stride);
    return;
  }
  scale(result, beta);
  if (op_a == Op::plain) small::multiply_columns(alpha, a, result, [x](int k, int) { return x[k]; });
  else
    for (int i = 0; i < a.cols; ++i) y[i] += alpha * small::dot(a.rows, a.column(i), x);
}

Matrix product(ConstView a, ConstView b) {
  Matrix c(a.rows, b.cols);
  multiply(1.0, Op::plain, a, Op::plain, b, 0.0, c);
  return c;
}

Matrix transpose_product(ConstView a, ConstView b) {
  Matrix c(a.cols, b.cols);
  multiply(1.0, Op::transposed, a, Op::plain, b, 0.0, c);
  return c;
}

void solve_upper(Op op, ConstView r, View b) {
  const int order = r.cols;
  if (order == 0 || b.cols == 0) return;
  if (order <= small_lu_order || b.cols == 1) {
    for (int j = 0; j < b.cols; ++j) {
      double* x = b.column(j);
      if (op == Op::plain) {
        for (int k = order - 1; k >= 0; --k) {
          x[k] /= r(k, k);
          small::add_scaled(k, -x[k], r.column(k), x);
        }
      } else {
        for (int k = 0; k < order; ++k) x[k] = (x[k] - small::dot(k, r.column(k), x)) / r(k, k);
      }
    }
    return;
  }
  dtrsm_("L", "U", letter(op), "N", &order, &b.cols, &one, r.data, &r.ld, b.data, &b.ld);
}

void solve_upper_right(ConstView r, View b) {
  const int order = r.cols;
  if (order == 0 || b.rows == 0) return;
  if (order > small_lu_order) {
    dtrsm_("R", "U", "N", "N", &b.rows, &order, &one, r.data, &r.ld, b.data, &b.ld);
    return;
  }
  for (int k = 0; k < order; ++k) {
    double* x = b.column(k);
    for (int p = 0; p < k; ++p) small::add_scaled(b.rows, -r(p, k), b.column(p), x);
    const double inverse = 1.0 / r(k, k);
    for (int i = 0; i < b.rows; ++i) x[i] *= inverse;
  }
}

bool factor_lu(View a, int* pivots) {
  if (a.cols == 0) return true;
  if (a.cols <= small_lu_order) return small::factor_lu(a, pivots);
  int info = 0;
  dgetrf_(&a.rows, &a.cols, a.data, &a.ld, pivots, &info);
  return info == 0;
}

void solve_lu(ConstView lu, const int* pivots, double* x) {
  const int order = lu.cols;
  for (int k = 0; k < order; ++k) std::swap(x[k], x[pivots[k] - 1]);
  for (int k = 0; k < order; ++k) small::add_scaled(order - k - 1, -x[k], lu.column(k) + k + 1, x + k + 1);
  solve_upper(Op::plain, lu, {x, order, 1, std::max(order, 1)});
}

void solve_lu(ConstView lu, const int* pivots, View b) {
  if (lu.cols == 0 || b.cols == 0) return;
  if (lu.cols > small_lu_order && b.cols > 1) {
    int info = 0;
    dgetrs_("N", &lu.cols, &b.cols, lu.data, &lu.ld, pivots, b.data, &b.ld, &info);
    return;
  }
  for (int j = 0; j < b.cols; ++j) solve_lu(lu, pivots, b.column(j));
}

void solve_lu_transposed(ConstView lu, const int* pivots, View b) {
  const int order = lu.cols;
  solve_upper(Op::transposed, lu, b);
  if (order > small_lu_order && b.cols > 1)
    dtrsm_("L", "L", "T", "U", &order, &b.cols, &one, lu.data, &lu.ld, b.data, &b.ld);
  for (int j = 0; j < b.cols; ++j) {
    double* x = b.column(j);
    if (order <= small_lu_order || b.cols == 1)
      for (int k = order - 2; k >= 0; --k) x[k] -= small::dot(order - k - 1, lu.column(k) + k + 1, x + k + 1);
    for (int k = order - 1; k >= 0; --k) std::swap(x[k], x[pivots[k] - 1]);
  }
}

int permutation_sign(const int* pivots, int count) {
  // Every cycle of even length changes the sign; each is counted at its smallest number.
  int sign = 1;
  for (int i = 0; i < count; ++i) {
    int next = i, length = 0;
    do {
      next = pivots[next];
      ++length;
    } while (next > i);
    if (next == i && length % 2 == 0) sign = -sign;
  }
  return sign;
}

int reflections_sign(const double* tau, int count) {
  int sign = 1;
  for (int k = 0; k < count; ++k)
    if (tau[k] != 0.0) sign = -sign;
  return sign;
}

bool invert_small(View a, double* pivots, int& sign) {
  constexpr int most = 64;  // columns, asserted: for blocks of multibody systems
  int exchanges[most];
  assert(a.cols <= most);
  if (!small::invert(a, pivots, exchanges)) return false;
  sign = 1;
  for (int k = 0; k < a.cols; ++k)
    if ((pivots[k] < 0.0) != (exchanges[k] != k)) sign = -sign;
  return true;
}

bool factor_lu(ComplexView a, int* pivots) {
  if (a.cols == 0) return true;
  if (a.cols <= small_complex_order) return small::factor_lu(a, pivots);
  int info = 0;
  zgetrf_(&a.rows, &a.cols, a.data, &a.ld, pivots, &info);
  return info == 0;
}

void solve_lu(ComplexView lu, const int* pivots, std::complex<double>* x) {
  if (lu.cols == 0) return;
  if (lu.cols <= small_complex_order) return small::solve_lu(lu, pivots, x);
  const int columns = 1;
  int info = 0;
  zgetrs_("N", &lu.cols, &columns, lu.data, &lu.ld, pivots, x, &lu.cols, &info);
}

Svd svd(ConstView a) {
  Svd result{identity(a.rows), {}, identity(a.cols)};
  result.s.assign(index(std::min(a.rows, a.cols)), 0.0);
  if (result.s.empty()) return result;
  Matrix work = to_matrix(a);
  Matrix vt(a.cols, a.cols);
  // dgesvd needs 5 times the larger dimension, and blocks of 64 for speed.
  const int length = 10 * std::max(a.rows, a.cols) + 64 * (a.rows + a.cols);
  std::vector<double> scratch(index(length));
  const int ld_u = a.rows, ld_vt = a.cols, ld_a = a.rows;
  int info = 0;
  dgesvd_("A", "A", &a.rows, &a.cols, work.data(), &ld_a, result.s.data(), result.U.data(), &ld_u, vt.data(), &ld_vt,
          scratch.data(), &length, &info);
  if (info != 0) throw std::runtime_error("the singular value decomposition did not converge.");
  result.V = transpose(vt);
  return result;
}

// Same method as svd(), with a single vector carried along: without any LAPACK uses another algorithm (dqds), which
// probes the arithmetic by dividing by zero.
std::vector<double> singular_values(ConstView a) {
  // Squares of other sizes may over- or underflow: dgesvd scales them.
  constexpr double largest = 1e140;
  const int count = std::min(a.rows, a.cols);
  const double size = max_abs(a);
  const bool is_in_range = count > 0 && size < largest && size > 1.0 / largest;
  if (!is_in_range) return svd(a).s;
  Matrix work = to_matrix(a);
  const int length = 64 * (a.rows + a.cols), none = 0, one = 1;
  std::vector<double> d(index(count)), e(d), tau_q(d), tau_p(d), turned(index(count), 0.0), scratch(index(length));
  int info = 0;
  dgebrd_(&a.rows, &a.cols, work.data(), &a.rows, d.data(), e.data(), tau_q.data(), tau_p.data(), scratch.data(),
          &length, &info);
  double unused = 0.0;
  if (info == 0)
    dbdsqr_(a.rows >= a.cols ? "U" : "L", &count, &none, &none, &one, d.data(), e.data(), &unused, &one, &unused,
            &one, turned.data(), &count, scratch.data(), &info);
  if (info != 0) throw std::runtime_error("the singular value decomposition did not converge.");
  return d;
}

Matrix range_basis(ConstView a, int rank) {
  const Svd decomposition = svd(a);
  return to_matrix(decomposition.U.view().columns(0, rank));
}

std::vector<double> least_squares(ConstView a, const std::vector<double>& b, double threshold) {
  const Svd decomposition = svd(a);
  std::vector<double> x(index(a.cols), 0.0);
  for (int k = 0; k < static_cast<int>(decomposition.s.size()); ++k) {
    const double s = decomposition.s[index(k)];
    if (s <= threshold) break;
    const double coefficient = small::dot(a.rows, decomposition.U.view().column(k), b.data()) / s;
    small::add_scaled(a.cols, coefficient, decomposition.V.view().column(k), x.data());
  }
  return x;
}

int determinant_sign(View a, Arena& arena) {
  const Arena::Frame frame(arena);
  int* pivots = arena.integers(a.cols);
  if (!factor_lu(a, pivots)) return 0;
  int sign = 1;
  for (int k = 0; k < a.cols; ++k) {
    if (pivots[k] != k + 1) sign = -sign;
    if (a(k, k) < 0.0) sign = -sign;
  }
  return sign;
}

namespace {

// Calls visit with every eigenvalue whose imaginary part may be roundoff.
template <class Visit>
void for_each_real_eigenvalue(View a, Arena& arena, Visit visit) {
  // Rounding errors turn two equal eigenvalues into a complex pair: they split by the square root of roundoff, 1e-8;
  // two digits of safety by judgment (docs/design/singular_points.md).
  constexpr double nearly_real = 1e-6;
  const int n = a.cols, length = 8 * n + 1;  // dgeev without vectors needs 3 n
  const Arena::Frame frame(arena);
  const std::size_t size = index(n);
  double *real = arena.take(size + 1), *imaginary = arena.take(size + 1);
  double unused = 0.0;
  int info = 0;
  if (n > 0)
    dgeev_("N", "N", &n, a.data, &a.ld, real, imaginary, &unused, &unit_stride, &unused, &unit_stride,
           arena.take(index(length)), &length, &info);
  for (int k = info; k < n; ++k)
    if (std::fabs(imaginary[k]) <= nearly_real * std::fabs(real[k])) visit(real[k]);
}

}  // namespace

int count_negative_eigenvalues(View a, Arena& arena) {
  int count = 0;
  for_each_real_eigenvalue(a, arena, [&](double value) { count += value < 0.0 ? 1 : 0; });
  return count;
}

double largest_real_eigenvalue(View a, Arena& arena) {
  double largest = 0.0;
  for_each_real_eigenvalue(a, arena, [&](double value) {
    if (std::fabs(value) > std::fabs(largest)) largest = value;
  });
  return largest;
}

}  // namespace sfdae::core
