// SPDX-License-Identifier: BSD-3-Clause
// A constant pencil (E^, A^) of known structure, hidden by smooth invertible transformations P(t), Q(t):
//   E = S P E^ Q,   A = S P (A^ Q - E^ Q'),   f = S P f^,   x = Q^-1 y,   S constant and diagonal,
// which leaves mu, d, a, u, v as they are. The derivatives of Q x are lower triangular in those of x, and so are
// those of P (...): M = Pi M^ Theta, N = Pi (N^ Q - M^ Psi), Pi and Theta block lower triangular and nonsingular.
// So the ranks of M and [N M] do not change, A2 becomes A2^ Q, T2 = Q^-1 T2^, and rank(E T2) = rank(E^ T2^).
#ifndef SFDAE_TESTS_TRANSFORMED_PENCIL_H
#define SFDAE_TESTS_TRANSFORMED_PENCIL_H

#include <string>
#include <vector>

#include "linear_family.h"

namespace sfdae_test {

// A matrix of jets stored by columns, and in a column coefficient by coefficient: what acts on columns runs along
// contiguous memory.
class JetColumns {
 public:
  JetColumns(int rows, int columns, int order);
  int rows() const { return rows_; }
  int columns() const { return columns_; }
  int order() const { return order_; }
  double* at(int column, int k) { return data_.data() + offset(column, k); }
  const double* at(int column, int k) const { return data_.data() + offset(column, k); }

 private:
  std::size_t offset(int column, int k) const {
    return (static_cast<std::size_t>(column) * static_cast<std::size_t>(order_ + 1) + static_cast<std::size_t>(k)) *
           static_cast<std::size_t>(rows_);
  }
  int rows_, columns_, order_;
  std::vector<double> data_;
};

// T(t) = G_1 ... G_M D. G_l turns the plane (i, j) by the angle phase + speed t: [cos -sin; sin cos].
// D is diagonal with the entries 1 + amplitude sin(phase + speed t), or the identity if there are none.
struct Rotation {
  int i, j;
  double phase, speed;
};
struct Scaling {
  double amplitude, phase, speed;
};
struct SmoothTransformation {
  std::vector<Rotation> rotations;
  std::vector<Scaling> scalings;
  bool constant() const;
};

enum class Factor { direct, transposed, inverse_transposed };  // T, T^T, T^-T

// W <- W T(t), W T(t)^T or W T(t)^-T, Taylor coefficients of all orders that W has.
// O(rows M K^2) operations for M rotations and order K.
void multiply(JetColumns& W, const SmoothTransformation& T, Factor factor, double t);

struct CanonicalPencil {
  CharacteristicValues values;
  std::vector<double> E, A;  // m x n, column-major
  int m() const { return values.d + values.a + values.v; }
  int n() const { return values.d + values.a + values.u; }
};

// y_i = sin(nu_i t + 0.7 i), nu_i = 1 + sin(i)/2, i = 1..n, and f^ = E^ y' - A^ y + c with the contradiction
// c_i = contradiction_i cos(t + i): for rows that are redundant, no solution exists where it is not zero.
class TransformedPencil : public LinearFamily {
 public:
  TransformedPencil(std::string name, CanonicalPencil pencil, SmoothTransformation P, SmoothTransformation Q,
                    std::vector<double> row_scale, std::vector<double> contradiction);

  void matrix_coefficients(double t, int order, double* E, double* A) const override;
  void vector_coefficients(double t, int order, double* f) const override;
  bool constant_E() const override { return P_.constant() && Q_.constant(); }
  bool constant_A() const override { return constant_E(); }
  bool has_exact() const override;
  void exact(double t, double* x, double* xdot) const override;

  const SmoothTransformation& P() const { return P_; }
  const SmoothTransformation& Q() const { return Q_; }

 private:
  CanonicalPencil pencil_;
  SmoothTransformation P_, Q_;
  std::vector<double> row_scale_;      // m
  std::vector<double> contradiction_;  // m
};

// The component y_i of the solution above.
Jet smooth_component(int i, double t, int order);

}  // namespace sfdae_test

#endif
