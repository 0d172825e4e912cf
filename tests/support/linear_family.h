// SPDX-License-Identifier: BSD-3-Clause
// Linear DAEs E(t) x' = A(t) x + f(t) of which everything is known: exact derivatives, characteristic values,
// solutions. Families of any size.
#ifndef SFDAE_TESTS_LINEAR_FAMILY_H
#define SFDAE_TESTS_LINEAR_FAMILY_H

#include <memory>
#include <string>
#include <utility>

#include "jet.h"

namespace sfdae_test {

// Formulas for A and f contain derivatives of transformations and solutions, hence the distance.
inline constexpr int max_family_order = max_jet_order - 3;

// d + a + v = m, d + a + u = n.
struct CharacteristicValues {
  int mu, d, a, u, v;
  bool operator==(const CharacteristicValues&) const = default;
};

// Has no state that changes: may be used by several threads. Matrices are column-major without padding.
class LinearFamily {
 public:
  virtual ~LinearFamily();
  LinearFamily(const LinearFamily&) = delete;
  LinearFamily& operator=(const LinearFamily&) = delete;

  int m() const { return values_.d + values_.a + values_.v; }
  int n() const { return values_.d + values_.a + values_.u; }
  // Where they change with t: those at the beginning.
  CharacteristicValues values() const { return values_; }
  std::string name() const { return name_; }

  // k-th derivatives at t, 0 <= k <= max_family_order.
  // Every entry is written. Nothing is kept: FamilyProblem is the one to use where speed matters.
  void E(double t, int k, double* out) const;  // m x n
  void A(double t, int k, double* out) const;  // m x n
  void f(double t, int k, double* out) const;  // m

  // Taylor coefficients of order 0..order, entry (i, j) of coefficient k at i + j m + k m n. All are written.
  virtual void matrix_coefficients(double t, int order, double* E, double* A) const = 0;
  // Entry i of coefficient k at i + k m.
  virtual void vector_coefficients(double t, int order, double* f) const = 0;

  virtual bool constant_E() const { return false; }
  virtual bool constant_A() const { return false; }

  // One solution and its derivative (n entries each, xdot may be null); the only one through its values if u = 0.
  virtual bool has_exact() const { return false; }
  virtual void exact(double t, double* x, double* xdot) const;

 protected:
  LinearFamily(std::string name, CharacteristicValues values) : name_(std::move(name)), values_(values) {}

 private:
  std::string name_;
  CharacteristicValues values_;
};

// n x n, a Kronecker normal form with d = min((n-u)/2, n-u-mu-1), a = n-u-d, v = u, mixed by the rotations
// P(t) and Q(t), which are products of 2(n-1) Givens rotations: E = scale P E^ Q, A = scale P (A^ Q - E^ Q').
// w: speed of both; sigma multiplies the eigenvalues of the dynamics, real parts -0.2 sigma ... -sigma.
std::unique_ptr<LinearFamily> kron(int n, int mu, double w = 0.5, int u = 0, int seed = 0, double sigma = 1.0,
                                   double scale = 1.0);

// m masses in a row between springs (stiffness sigma(10 + 5 cos i)) and dampers, held by c constraints that turn
// with the speed omega; x = (q, v, lambda), n = 2m + c, mu = 2. 1 <= c <= m/2.
std::unique_ptr<LinearFamily> chain(int m, int c, double omega = 0.5, double sigma = 1.0);

// E = [delta-1, delta t; 0, 0], A = [-eta(delta-1), -eta delta t; delta-1, delta t - 1], f = 0. The kernel of E
// turns: x2 = e^((delta-eta) t), x1 = x2 (1 - delta t)/(delta-1). Discretizing E x' is unstable. delta != 1.
std::unique_ptr<LinearFamily> spin(double delta, double eta);

// x' = J x, J = [-0.2 1; -1 -0.2], x(0) = (1, 1/2), with its rows
//   unchanged, multiplied by diag(e^(-rate t), e^(rate t)), or turned by [cos -sin; sin cos](rate t).
enum class RowOperation { none, scaling, rotation };
std::unique_ptr<LinearFamily> rotated_ode(RowOperation rows, double rate = 50.0);

}  // namespace sfdae_test

#endif
