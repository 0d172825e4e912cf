// SPDX-License-Identifier: BSD-3-Clause

// Descriptor systems: poles, zeros and transfer functions, for C++17 and later. Included by sfdae.hpp.
#ifndef SFDAE_LINEARIZATION_HPP
#define SFDAE_LINEARIZATION_HPP

#include <sfdae/linearization.h>
#include <sfdae/results.hpp>

#include <complex>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace sfdae {

/// The point of linearization, inputs and outputs, see sfdae_linearization. Empty vectors stand for NULL.
struct Linearization {
  double t = 0;
  std::vector<double> x, xdot;                ///< n values each, or empty
  std::vector<std::string> input_parameters;  ///< names
  std::vector<int> input_unknowns;
  Matrix input_columns;  ///< m rows
  std::vector<int> output_unknowns;
  Matrix output_rows;  ///< n columns
};

/// Eigenvalues of a pencil, see sfdae_get_poles and sfdae_get_zeros.
struct Spectrum {
  sfdae_spectrum summary;
  std::vector<std::complex<double>> values;  ///< the finite ones
  std::vector<double> errors;                ///< estimates, absolute
};

/// E x' = A x + B u, y = C x + D u, see sfdae_descriptor. Movable; one moved from can only be assigned to or destroyed.
class Descriptor {
 public:
  /// Creates it from matrices; B, C and D may be left out. Error if sizes do not match, or numbers are not finite.
  Descriptor(const Matrix& E, const Matrix& A, const Matrix& B = {}, const Matrix& C = {}, const Matrix& D = {},
             double rank_tol = 0) {
    const int m = E.rows(), n = E.columns(), q = B.columns(), p = C.rows();
    const bool fits = A.rows() == m && A.columns() == n && (q == 0 || B.rows() == m) &&
                      (p == 0 || C.columns() == n) && (D.columns() == 0 || (D.rows() == p && D.columns() == q));
    sfdae_descriptor_matrices matrices;
    sfdae_descriptor_matrices_init(&matrices, sizeof matrices);
    matrices.num_equations = m;
    matrices.num_unknowns = n;
    matrices.num_inputs = q;
    matrices.num_outputs = p;
    matrices.E = E.data();
    matrices.A = A.data();
    matrices.B = q > 0 ? B.data() : nullptr;
    matrices.C = p > 0 ? C.data() : nullptr;
    matrices.D = D.columns() > 0 ? D.data() : nullptr;
    matrices.rank_tol = rank_tol;
    if (!fits) throw Error(SFDAE_ILLEGAL_ARGUMENT, "sizes of E, A, B, C, D do not fit");
    const int status = sfdae_create_descriptor(&matrices, &descriptor_);
    if (status < 0) throw Error(status, sfdae_message(nullptr));
  }
  /// Takes ownership of a C handle.
  explicit Descriptor(sfdae_descriptor* descriptor) noexcept : descriptor_(descriptor) {}
  Descriptor(Descriptor&& other) noexcept : descriptor_(std::exchange(other.descriptor_, nullptr)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  ~Descriptor() { sfdae_destroy_descriptor(&descriptor_); }

  /// m, n, q, p
  int num_equations() const { return sizes().m; }
  int num_unknowns() const { return sizes().n; }
  int num_inputs() const { return sizes().q; }
  int num_outputs() const { return sizes().p; }

  /// The matrices, see sfdae_get_descriptor_matrices.
  Matrix E() const { return matrix(sizes().m, sizes().n, 0); }
  Matrix A() const { return matrix(sizes().m, sizes().n, 1); }
  Matrix B() const { return matrix(sizes().m, sizes().q, 2); }
  Matrix C() const { return matrix(sizes().p, sizes().n, 3); }
  Matrix D() const { return matrix(sizes().p, sizes().q, 4); }

  /// The finite eigenvalues of lambda E - A.
  Spectrum poles() { return spectrum(sfdae_get_poles); }
  /// Invariant zeros.
  Spectrum zeros() { return spectrum(sfdae_get_zeros); }

  /// H(s), p x q, entry (i, k) at [i + k p].
  std::vector<std::complex<double>> transfer(std::complex<double> s) {
    const std::size_t size = count(num_outputs()) * count(num_inputs());
    std::vector<double> real(size + 1), imaginary(size + 1);
    const double s_real = s.real(), s_imaginary = s.imag();
    checked(sfdae_get_transfer(descriptor_, 1, &s_real, &s_imaginary, real.data(), imaginary.data()));
    std::vector<std::complex<double>> H(size);
    for (std::size_t i = 0; i < size; ++i) H[i] = {real[i], imaginary[i]};
    return H;
  }

  /// The C handle.
  sfdae_descriptor* get() const noexcept { return descriptor_; }

 private:
  struct Sizes {
    int m, n, q, p;
  };
  static std::size_t count(int value) { return static_cast<std::size_t>(value); }
  Sizes sizes() const {
    Sizes sizes{};
    checked(sfdae_get_descriptor_sizes(descriptor_, &sizes.m, &sizes.n, &sizes.q, &sizes.p));
    return sizes;
  }
  Matrix matrix(int rows, int columns, int which) const {
    Matrix result(rows, columns);
    double* to[5] = {nullptr, nullptr, nullptr, nullptr, nullptr};
    to[which] = result.data();
    checked(sfdae_get_descriptor_matrices(descriptor_, to[0], to[1], to[2], to[3], to[4]));
    return result;
  }
  Spectrum spectrum(int (*get_values)(sfdae_descriptor*, sfdae_spectrum*, double*, double*, double*)) {
    const std::size_t n = count(num_unknowns());
    std::vector<double> real(n), imaginary(n);
    Spectrum result{{}, {}, std::vector<double>(n)};
    sfdae_spectrum_init(&result.summary, sizeof result.summary);
    checked(get_values(descriptor_, &result.summary, real.data(), imaginary.data(), result.errors.data()));
    result.errors.resize(count(result.summary.num_finite));
    for (std::size_t k = 0; k < result.errors.size(); ++k) result.values.emplace_back(real[k], imaginary[k]);
    return result;
  }
  void checked(int status) const {
    if (status < 0) throw Error(status, sfdae_descriptor_message(descriptor_));
  }

  sfdae_descriptor* descriptor_ = nullptr;
};

}  // namespace sfdae

#endif
