// The matrix c I - B of a step of a mechanical system, factored, for one point or, decoupled, for the stages of a
// Runge-Kutta step. The factors are reused while the linearization is valid and c does not change.
//
// If y' = z, as S is the identity, B = [0 I; K D], and half of the unknowns are eliminated beforehand, as RADAU5 does
// for such problems [HW96, IV.8]:
//
//     (c I - D - K / c) z = r_z + K r_y / c,   y = (z + r_y) / c
//
// [HW96] E. Hairer, G. Wanner: Solving Ordinary Differential Equations II. Springer, 2nd ed. 1996.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <vector>

#include "linalg/archive.h"
#include "linalg/arena.h"
#include "linalg/index.h"
#include "linalg/lanes.h"
#include "linalg/matrix.h"
#include "multibody/multibody_form.h"
#include "system/stage_method.h"
#include "system/step_matrix.h"

namespace sfdae::core {

class MultibodyStepMatrix {
 public:
  // Allocates memory for so many local coordinates.
  void resize(int unknowns);
  // Call when the linearization changes.
  void forget();

  // Same as for a StepMatrix.
  bool is_for(double c) const { return reduced_.is_for(c); }
  bool is_valid() const { return reduced_.is_valid(); }
  double c() const { return reduced_.c(); }
  bool factor(const MultibodyForm& form, double c, long& count);
  bool factor_stages(const MultibodyForm& form, const StageMethod& method, long& count);

  // Inverses for all stages at once, available for few unknowns after the factorization: stages transformed by T are in
  // lanes, the real one in the first, pairs first and second in the next ones. A number a + i b times omega = first - i
  // second is first a + second b, second a - first b: A has the lanes a, B those of b and -b.
  struct LaneInverses {
    int order;
    ConstView K;
    const LaneBlock *A, *B;          // of c I - D - K / c, by rows
    const LaneBlock *c_A, *c_B;      // 1 / c
    const LaneBlock *T, *T_inverse;  // of the method, a block for each column
  };
  bool has_lane_inverses() const { return stages_of_inverses_ > 0; }
  LaneInverses lane_inverses() const;

  void solve(View yz) const;
  // A column for each stage.
  void solve_stages(const StageMethod& method, ConstView r, View yz, Arena& arena);

  void archive_c(Archive& archive) { reduced_.archive_c(archive); }

 private:
  int order() const { return unknowns_ - eliminated_; }
  ConstView K() const { return {K_.data(), order(), eliminated_, order() > 0 ? order() : 1}; }
  void invert(const StageMethod& method);
  void solve_real(double* yz, const double* Ky) const;
  void solve_pair(std::size_t k, double* first, double* second, ConstView Ky);

  int unknowns_ = 0, eliminated_ = 0;
  StepMatrix reduced_;  // of z where y is eliminated
  std::vector<double> K_;
  std::vector<std::complex<double>> omega_;
  int stages_of_inverses_ = 0;  // that the inverses in lanes were made for; 0: none
  LaneArray inverse_A_, inverse_B_, T_, T_inverse_;
  LaneBlock c_A_, c_B_;
};

}  // namespace sfdae::core
