// The matrix of a step of a mechanical system, factored.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_step_matrix.h"

#include <algorithm>

#include "linalg/dense.h"

namespace sfdae::core {

namespace {

// Explicit inverses cost a third of the factors more. They are used for small matrices, where calls cost more than
// arithmetic. (Chosen.)
constexpr int largest_inverse = 6;

// a + i b in the lanes of a pair, 0 being that of the real stage.
void set_pair(std::size_t k, std::complex<double> value, LaneBlock& A, LaneBlock& B) {
  A.lane[2 * k + 1] = A.lane[2 * k + 2] = value.real();
  B.lane[2 * k + 1] = value.imag();
  B.lane[2 * k + 2] = -value.imag();
}

// y := (z + y) / c
template <class Scalar>
void complete(int count, Scalar c, const Scalar* z, Scalar* y) {
  const Scalar inverse = 1.0 / c;
  for (int i = 0; i < count; ++i) y[i] = (z[i] + y[i]) * inverse;
}

// The reduced form with half of the unknowns.
struct ReducedForm {
  const MultibodyForm& form;
  int order;
  int unknowns() const { return order; }
  template <class Scalar>
  void step_matrix(Scalar c, BasicView<Scalar> M) const {
    if (form.has_velocities_as_rates()) form.reduced_step_matrix(c, M);
    else form.step_matrix(c, M);
  }
};

}  // namespace

void MultibodyStepMatrix::resize(int unknowns) {
  const std::size_t area = index(unknowns) * index(unknowns) + 1;
  unknowns_ = unknowns;
  reduced_.resize(unknowns);
  K_.assign(area, 0.0);
  omega_.assign(index(unknowns) + 1, 0.0);
  const std::size_t entries = index(largest_inverse) * index(largest_inverse);
  for (auto* blocks : {&inverse_A_, &inverse_B_}) blocks->assign(entries, {});
  for (auto* blocks : {&T_, &T_inverse_}) blocks->assign(max_stages, {});
}

void MultibodyStepMatrix::forget() {
  reduced_.forget();
  stages_of_inverses_ = 0;
}

bool MultibodyStepMatrix::factor(const MultibodyForm& form, double c, long& count) {
  eliminated_ = form.has_velocities_as_rates() ? unknowns_ / 2 : 0;
  const int q = order();
  if (eliminated_ > 0) copy(form.stiffness(), View{K_.data(), q, q, std::max(q, 1)});
  stages_of_inverses_ = 0;
  return reduced_.factor(ReducedForm{form, q}, 1.0, c, count);
}

bool MultibodyStepMatrix::factor_stages(const MultibodyForm& form, const StageMethod& method, long& count) {
  const int q = order();
  const long before = count;
  const bool is_regular = reduced_.factor_stages(ReducedForm{form, q}, 1.0, method, count);
  if (count != before) stages_of_inverses_ = 0;
  if (is_regular && stages_of_inverses_ != method.s && eliminated_ > 0 && q <= largest_inverse) invert(method);
  return is_regular;
}

void MultibodyStepMatrix::invert(const StageMethod& method) {
  const int q = order(), s = method.s;
  std::fill(inverse_A_.begin(), inverse_A_.end(), LaneBlock());
  std::fill(inverse_B_.begin(), inverse_B_.end(), LaneBlock());
  c_A_ = c_B_ = LaneBlock();
  c_A_.lane[0] = 1.0 / c();
  for (int j = 0; j < q; ++j) {
    double column[largest_inverse] = {};
    column[j] = 1.0;
    reduced_.solve(column);
    for (int i = 0; i < q; ++i) inverse_A_[index(i * q + j)].lane[0] = column[i];
  }
  for (std::size_t k = 0; 2 * static_cast<int>(k) + 2 < s; ++k) {
    set_pair(k, 1.0 / reduced_.pairs().c_of_pair(k), c_A_, c_B_);
    for (int j = 0; j < q; ++j) {
      std::complex<double> column[largest_inverse] = {};
      column[j] = 1.0;
      reduced_.pairs().solve_pair(k, column);
      for (int i = 0; i < q; ++i) set_pair(k, column[i], inverse_A_[index(i * q + j)], inverse_B_[index(i * q + j)]);
    }
  }
  // Lanes beyond the stages repeat the last one of them, and transformed ones are zero.
  for (int j = 0; j < s; ++j)
    for (int l = 0; l < lane_count; ++l) {
      T_[index(j)].lane[l] = method.T[index(std::min(l, s - 1) + j * s)];
      T_inverse_[index(j)].lane[l] = l < s ? method.T_inverse[index(l + j * s)] : 0.0;
    }
  stages_of_inverses_ = s;
}

MultibodyStepMatrix::LaneInverses MultibodyStepMatrix::lane_inverses() const {
  return {order(), K(), inverse_A_.data(), inverse_B_.data(), &c_A_, &c_B_, T_.data(), T_inverse_.data()};
}

// Ky: K r_y
void MultibodyStepMatrix::solve_real(double* yz, const double* Ky) const {
  const int q = order();
  double* const z = yz + eliminated_;
  if (eliminated_ > 0)
    for (int i = 0; i < q; ++i) z[i] += Ky[i] / c();
  reduced_.solve(z);
  complete(eliminated_, c(), z, yz);
}

void MultibodyStepMatrix::solve(View yz) const {
  const int q = order(), count = yz.cols;
  if (q == 0) return;
  const View z = yz.block(eliminated_, 0, q, count);
  if (eliminated_ > 0) multiply(1.0 / c(), Op::plain, K(), Op::plain, yz.top(eliminated_), 1.0, z);
  reduced_.solve(z);
  for (int j = 0; j < count; ++j) complete(eliminated_, c(), z.column(j), yz.column(j));
}

// The complex system for omega = first - i second; Ky: two columns, K r_y of both.
void MultibodyStepMatrix::solve_pair(std::size_t k, double* first, double* second, ConstView Ky) {
  const int q = order();
  const std::complex<double> c = reduced_.pairs().c_of_pair(k), inverse = 1.0 / c;
  std::complex<double>* const z = omega_.data() + eliminated_;
  for (int i = 0; i < unknowns_; ++i) omega_[index(i)] = {first[i], -second[i]};
  if (eliminated_ > 0)
    for (int i = 0; i < q; ++i) z[i] += inverse * std::complex<double>(Ky(i, 0), -Ky(i, 1));
  reduced_.pairs().solve_pair(k, z);
  complete(eliminated_, c, z, omega_.data());
  for (int i = 0; i < unknowns_; ++i) {
    first[i] = omega_[index(i)].real();
    second[i] = -omega_[index(i)].imag();
  }
}

// rho = T^-1 r; one real and (s-1)/2 complex systems for zeta; yz = T zeta.
void MultibodyStepMatrix::solve_stages(const StageMethod& method, ConstView r, View yz, Arena& arena) {
  const int s = method.s;
  if (unknowns_ == 0) return;
  const Arena::Frame frame(arena);
  const View rho = arena.matrix(unknowns_, s), Ky = arena.matrix(order(), s);
  multiply(1.0, Op::plain, r, Op::transposed, ConstView{method.T_inverse.data(), s, s, s}, 0.0, rho);
  if (eliminated_ > 0) multiply(1.0, Op::plain, K(), Op::plain, rho.top(eliminated_), 0.0, Ky);
  solve_real(rho.column(0), Ky.column(0));
  for (int k = 0; 2 * k + 2 < s; ++k)
    solve_pair(index(k), rho.column(2 * k + 1), rho.column(2 * k + 2), Ky.columns(2 * k + 1, 2));
  multiply(1.0, Op::plain, rho, Op::transposed, ConstView{method.T.data(), s, s, s}, 0.0, yz);
}

}  // namespace sfdae::core
