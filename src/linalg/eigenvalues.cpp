// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/eigenvalues.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "linalg/lapack.h"
#include "linalg/random.h"
#include "linalg/shifted_pencil.h"

namespace sfdae::core {

namespace {

using Complex = std::complex<double>;
using Vector = std::vector<Complex>;

constexpr double roundoff = std::numeric_limits<double>::epsilon() / 2;

double norm(const Vector& x) {
  double sum = 0.0;
  for (const Complex& value : x) sum += std::norm(value);
  return std::sqrt(sum);
}

double frobenius(ConstView a) {
  double sum = 0.0;
  for (int j = 0; j < a.cols; ++j)
    for (int i = 0; i < a.rows; ++i) sum += a(i, j) * a(i, j);
  return std::sqrt(sum);
}

// y^T x, without conjugation.
Complex dot(const Vector& y, const Vector& x) {
  Complex sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += y[i] * x[i];
  return sum;
}

// Column k as LAPACK returns it: real vectors, or a column of real parts and one of imaginary parts for a pair.
Vector vector_of(ConstView columns, int k, double imaginary) {
  Vector x(index(columns.rows));
  for (int i = 0; i < columns.rows; ++i)
    x[index(i)] = imaginary == 0.0 ? Complex(columns(i, k)) : Complex(columns(i, k), columns(i, k + 1));
  return x;
}

void normalize(Vector& x) {
  const double size = norm(x);
  if (size > 0.0 && std::isfinite(size))
    for (Complex& value : x) value /= size;
}

// Output of QZ: alpha / beta, and vectors of both sides.
struct Schur {
  explicit Schur(int n) : alpha_r(index(n)), alpha_i(index(n)), beta(index(n)), left(n, n), right(n, n) {}
  std::vector<double> alpha_r, alpha_i, beta;
  Matrix left, right;
};

Schur decompose(ConstView G, ConstView B) {
  const int n = G.cols;
  Schur result(n);
  Matrix a = to_matrix(B), b = to_matrix(G);
  const int length = 16 * n + 64;
  std::vector<double> work(index(length));
  int info = 0;
  dggev_("V", "V", &n, a.data(), &n, b.data(), &n, result.alpha_r.data(), result.alpha_i.data(), result.beta.data(),
         result.left.data(), &n, result.right.data(), &n, work.data(), &length, &info);
  if (info != 0) throw std::runtime_error("the QZ iteration of eigenvalues has not converged.");
  return result;
}

// |G| and |B| in the Frobenius norm.
struct Norms {
  double G, B;
};

// Infinite if it would overflow, without a floating-point exception.
Complex quotient(Complex alpha, double beta) {
  const double size = std::max(std::fabs(alpha.real()), std::fabs(alpha.imag()));
  if (std::fabs(beta) < 1.0 && size >= std::fabs(beta) * std::numeric_limits<double>::max())
    return std::numeric_limits<double>::infinity();
  return alpha / beta;
}

// y^H (lambda G - B) = 0: the backward error of QZ is a few roundoffs of these norms; 4 by judgment.
double error_of(const Schur& schur, int k, Complex value, ConstView G, const Norms& norms) {
  const double imaginary = schur.alpha_i[index(k)];
  const Vector x = vector_of(schur.right, k, imaginary);
  Vector y = vector_of(schur.left, k, imaginary);
  for (Complex& entry : y) entry = std::conj(entry);
  const double overlap = std::abs(dot(y, product(Op::plain, G, x)));
  if (!(overlap > 0.0) || !std::isfinite(std::abs(value))) return std::numeric_limits<double>::infinity();
  return 4 * roundoff * (norms.B + std::abs(value) * norms.G) * norm(x) * norm(y) / overlap;
}

// Random start vectors in the units of the pencil: every component counts.
Vector random_vector(int n, std::minstd_rand& generator) {
  Vector x(index(n));
  for (Complex& value : x) value = 1.0 + 0.5 * symmetric_random(generator);
  return x;
}

std::vector<double> sizes_of(const Vector& x) {
  std::vector<double> result(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) result[i] = std::abs(x[i]);
  return result;
}

// |y|^T (|A| + |lambda| |E|) |x|
double size_of_terms(const ShiftedPencil& pencil, const Vector& y, const Vector& x) {
  const std::vector<double> left = sizes_of(y), right = sizes_of(x);
  const double size_of_s = std::abs(pencil.s());
  double sum = 0.0;
  for (int j = 0; j < pencil.size(); ++j)
    for (int i = 0; i < pencil.size(); ++i)
      sum +=
          left[index(i)] * (std::fabs(pencil.A()(i, j)) + size_of_s * std::fabs(pencil.E()(i, j))) * right[index(j)];
  return sum;
}

// |y|^T |(s + change) E x - A x| for vectors perturbed by errors of the factors.
double what_is_left(const ShiftedPencil& pencil, Complex change, const Vector& y, const Vector& x) {
  const Vector Ex = product(Op::plain, pencil.E(), x), Sx = pencil.product(Op::plain, x);
  double sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += std::abs(y[i]) * std::abs(Sx[i] + change * Ex[i]);
  return sum;
}

bool factor_near(ShiftedPencil& pencil, Complex& value, double distance) {
  if (pencil.factor(value)) return true;
  value += distance > 0.0 ? distance : std::numeric_limits<double>::min();
  return pencil.factor(value);
}

// Largest plausible correction of the known value number k: beyond it lies another eigenvalue, much farther away than
// the error of k, and not much nearer than the other known ones.
double largest_change(const std::vector<Eigenvalue>& known, std::size_t k) {
  constexpr double of_errors = 100, of_gap = 1e-3;  // by judgment: errors of QZ are estimates
  double gap = std::numeric_limits<double>::infinity();
  for (std::size_t l = 0; l < known.size(); ++l)
    if (l != k) gap = std::min(gap, std::abs(known[l].value - known[k].value));
  return std::max(of_errors * known[k].error, of_gap * std::min(gap, std::abs(known[k].value)));
}

// The eigenvalue nearest to a known one: y^T A x / y^T E x with vectors of inverse iterations, repeated from the
// result.
Eigenvalue refined(ShiftedPencil& pencil, const Eigenvalue& known, double largest) {
  constexpr int most_factorizations = 3, iterations = 3;
  std::minstd_rand generator(1);
  Complex value = known.value;
  Eigenvalue result = known;
  for (int k = 0; k < most_factorizations; ++k) {
    if (!factor_near(pencil, value, 2 * roundoff * std::abs(value))) return known;
    Vector x = random_vector(pencil.size(), generator), y = random_vector(pencil.size(), generator);
    for (int l = 0; l < iterations; ++l) {
      x = product(Op::plain, pencil.E(), x);
      pencil.solve(Op::plain, x);
      normalize(x);
      y = product(Op::transposed, pencil.E(), y);
      pencil.solve(Op::transposed, y);
      normalize(y);
    }
    const Complex overlap = dot(y, product(Op::plain, pencil.E(), x));
    if (overlap == 0.0) return known;
    const Complex change = -dot(y, pencil.product(Op::plain, x)) / overlap;
    const double error =
        (4 * roundoff * size_of_terms(pencil, y, x) + what_is_left(pencil, change, y, x)) / std::abs(overlap);
    if (!std::isfinite(error) || !(std::abs(value + change - known.value) <= largest)) return known;
    value += change;
    if (known.value.imag() == 0.0) value = value.real();
    result = {value, error + std::abs(change)};
    if (std::abs(change) <= error) return {value, error};
  }
  return result.error < known.error ? result : known;
}

// Two values merged into one, although they were distinct.
bool have_merged(const Eigenvalue& a, const Eigenvalue& b, const Eigenvalue& old_a, const Eigenvalue& old_b) {
  const double distance = std::abs(a.value - b.value);
  return distance <= a.error + b.error && std::abs(old_a.value - old_b.value) > 2 * distance;
}

}  // namespace

std::vector<Eigenvalue> generalized_eigenvalues(ConstView G, ConstView B) {
  const int n = G.cols;
  std::vector<Eigenvalue> result;
  if (n == 0) return result;
  const Schur schur = decompose(G, B);
  const Norms norms{frobenius(G), frobenius(B)};
  for (int k = 0; k < n; ++k) {
    const Complex value = quotient({schur.alpha_r[index(k)], schur.alpha_i[index(k)]}, schur.beta[index(k)]);
    const double error = error_of(schur, k, value, G, norms);
    result.push_back({value, error});
    if (schur.alpha_i[index(k)] == 0.0) continue;
    result.push_back({std::conj(value), error});
    ++k;
  }
  return result;
}

std::vector<Eigenvalue> refined(ConstView E, ConstView A, std::vector<Eigenvalue> known, double small_enough) {
  ShiftedPencil pencil(E, A);
  std::vector<Eigenvalue> result = known;
  for (std::size_t k = 0; k < known.size(); ++k) {
    const bool is_pair = known[k].value.imag() != 0.0;
    if (!(known[k].error <= small_enough * std::abs(known[k].value)))
      result[k] = refined(pencil, known[k], largest_change(known, k));
    if (is_pair) result[k + 1] = {std::conj(result[k].value), result[k].error};
    k += is_pair ? 1 : 0;
  }
  std::vector<char> merged(known.size(), 0);
  for (std::size_t k = 0; k < known.size(); ++k)
    for (std::size_t l = 0; l < k; ++l)
      if (have_merged(result[k], result[l], known[k], known[l])) merged[k] = merged[l] = 1;
  for (std::size_t k = 0; k < known.size(); ++k)
    if (merged[k] != 0) result[k] = known[k];
  return result;
}

void sort_by_size(std::vector<Eigenvalue>& eigenvalues) {
  // By the first of each pair: sizes of conjugate numbers are equal in every bit.
  std::stable_sort(eigenvalues.begin(), eigenvalues.end(), [](const Eigenvalue& a, const Eigenvalue& b) {
    const double size_a = std::abs(a.value), size_b = std::abs(b.value);
    if (size_a != size_b) return size_a < size_b;
    if (a.value.real() != b.value.real()) return a.value.real() < b.value.real();
    return std::fabs(a.value.imag()) < std::fabs(b.value.imag());
  });
}

}  // namespace sfdae::core
