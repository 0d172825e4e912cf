// Collocation polynomial of the last step of a Radau method.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/radau_polynomial.h"

#include <algorithm>
#include <array>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Degree of Q; higher Taylor coefficients, which systems request up to the orders of their jets, are 0.
constexpr int degree(int stages) { return stages + 1; }
constexpr int max_degree = degree(max_stages);
constexpr int max_columns = max_stages + 2;

// Taylor coefficients k = 0, ..., order at tau, up to the degree, of the weight functions of the columns: the Lagrange
// polynomials for 0, c_1, ..., c_s, and Q.
struct ColumnWeights {
  ColumnWeights(const RadauMethod& method, double tau, int its_order);
  void set_values(const RadauMethod& method, double tau);
  const double* of(int k) const { return weights[index(k)].data(); }

  int order;
  std::array<std::array<double, max_columns>, max_degree + 1> weights;
};

// Coefficients 0 only, for outputs, bitwise equal to those of the constructor.
void ColumnWeights::set_values(const RadauMethod& method, double tau) {
  const int s = method.s();
  double* l = weights[0].data();
  const auto gap = [&](int j) { return j == 0 ? tau : tau - method.stages.c[index(j - 1)]; };
  double before = 1.0, after = 1.0, q = 0.0;
  for (int j = 0; j <= s; ++j) {
    l[j] = before;
    before *= gap(j);
  }
  for (int j = s; j >= 0; --j) {
    l[j] = method.lagrange_factors[index(j)] * (l[j] * after);
    after *= gap(j);
  }
  for (int i = s + 1; i >= 0; --i) q = q * tau + method.correction[index(i)];
  l[s + 1] = q;
}

// l_j = factor_j prod_{k<j} (tau - c_k) prod_{k>j} (tau - c_k), so that nothing cancels.
ColumnWeights::ColumnWeights(const RadauMethod& method, double tau, int its_order)
    : order(std::min(its_order, degree(method.s()))) {
  if (order == 0) {
    set_values(method, tau);
    return;
  }
  const int s = method.s();
  using Taylor = std::array<double, max_degree + 1>;
  std::array<Taylor, max_columns> before, after;
  const auto gap = [&](int j) { return j == 0 ? tau : tau - method.stages.c[index(j - 1)]; };
  const auto times_linear = [&](const Taylor& p, double value, Taylor& product) {
    for (int k = order; k > 0; --k) product[index(k)] = p[index(k)] * value + p[index(k - 1)];
    product[0] = p[0] * value;
  };
  std::fill_n(before[0].data(), order + 1, 0.0);
  std::fill_n(after[index(s)].data(), order + 1, 0.0);
  before[0][0] = after[index(s)][0] = 1.0;
  for (int j = 0; j < s; ++j) times_linear(before[index(j)], gap(j), before[index(j + 1)]);
  for (int j = s; j > 0; --j) times_linear(after[index(j)], gap(j), after[index(j - 1)]);
  for (int k = 0; k <= order; ++k)
    for (int j = 0; j <= s; ++j) {
      double sum = 0.0;
      for (int i = 0; i <= k; ++i) sum += before[index(j)][index(i)] * after[index(j)][index(k - i)];
      weights[index(k)][index(j)] = method.lagrange_factors[index(j)] * sum;
    }
  // Horner's scheme for Q and its derivatives.
  Taylor q{};
  for (int i = s + 1; i >= 0; --i) {
    times_linear(q, tau, q);
    q[0] += method.correction[index(i)];
  }
  for (int k = 0; k <= order; ++k) weights[index(k)][index(s + 1)] = q[index(k)];
}

// `rows` rows of sum_j weights_j column_j; an odd number of columns.
template <std::size_t rows>
void combine_rows(const double* weights, int count, const double* column, std::size_t size, double* to) {
  double sum[rows];
  for (std::size_t r = 0; r < rows; ++r) sum[r] = weights[0] * column[r];
  for (int j = 1; j < count; j += 2) {
    const double first = weights[j], second = weights[j + 1];
    const double* a = column + size * index(j);
    const double* b = a + size;
    for (std::size_t r = 0; r < rows; ++r) sum[r] += first * a[r] + second * b[r];
  }
  std::copy_n(sum, rows, to);
}

// to := sum_j weights_j column_j; sums of so many rows stay in registers.
void combine(const double* weights, int count, const std::vector<double>& columns, std::size_t size, double* to) {
  constexpr std::size_t many = 8, few = 2;
  std::size_t r = 0;
  for (; r + many <= size; r += many) combine_rows<many>(weights, count, columns.data() + r, size, to + r);
  for (; r + few <= size; r += few) combine_rows<few>(weights, count, columns.data() + r, size, to + r);
  if (r < size) combine_rows<1>(weights, count, columns.data() + r, size, to + r);
}

void take_columns(const std::vector<double>& start, const std::vector<double>& stages,
                  const std::vector<double>& correction, int s, std::vector<double>& columns) {
  const std::size_t size = start.size();
  std::copy_n(start.data(), size, columns.data());
  std::copy_n(stages.data(), size * index(s), columns.data() + size);
  std::copy_n(correction.data(), size, columns.data() + size * index(s + 1));
}

}  // namespace

void RadauPolynomial::resize(std::size_t n, std::size_t size_w, int most_stages) {
  size_x_ = n;
  size_w_ = size_w;
  x_.assign(n * index(most_stages + 2), 0.0);
  w_.assign(size_w * index(most_stages + 2), 0.0);
  forget();
}

void RadauPolynomial::set(const RadauNode& start, const RadauStep& step, const InteriorErrors& errors) {
  const int s = step.method->s();
  forget();
  s_ = s;
  t_ = start.t;
  h_ = step.h;
  error_w_ = errors.w;
  error_x_ = errors.x;
  is_tested_ = false;
  take_columns(start.x, step.stages.x, errors.correction_x, s, x_);
  take_columns(start.w, step.stages.w, errors.correction_w, s, w_);
}

void RadauPolynomial::evaluate_x(double t, double* x, double* xdot) const {
  const ColumnWeights weights(radau_method(s_), scaled(t), xdot != nullptr ? 1 : 0);
  combine(weights.of(0), s_ + 2, x_, size_x_, x);
  if (xdot == nullptr) return;
  combine(weights.of(1), s_ + 2, x_, size_x_, xdot);
  for (std::size_t r = 0; r < size_x_; ++r) xdot[r] /= h_;
}

void RadauPolynomial::evaluate_w(double t, double* w) const {
  const ColumnWeights weights(radau_method(s_), scaled(t), 0);
  combine(weights.of(0), s_ + 2, w_, size_w_, w);
}

void RadauPolynomial::taylor(double t, int order, double* coefficients) const {
  const ColumnWeights weights(radau_method(s_), scaled(t), order);
  double power = 1.0;
  for (int k = 0; k <= weights.order; ++k, power *= h_) {
    double* column = coefficients + size_x_ * index(k);
    combine(weights.of(k), s_ + 2, x_, size_x_, column);
    for (std::size_t r = 0; r < size_x_; ++r) column[r] /= power;
  }
  std::fill_n(coefficients + size_x_ * index(weights.order + 1), size_x_ * index(order - weights.order), 0.0);
}

void RadauPolynomial::archive(Archive& archive, int s, bool with_w) {
  if (archive.is_reading()) s_ = s;
  for (double* value : {&t_, &h_, &error_w_, &error_x_}) archive.real(*value);
  archive.small(is_tested_);
  archive.reals(x_.data(), size_x_ * index(s + 2));
  if (with_w) archive.reals(w_.data(), size_w_ * index(s + 2));
}

}  // namespace sfdae::core
