// The matrix of a step, factored: c tau G - B with the rows of the free directions below, for one point or, decoupled,
// for the stages of a Runge-Kutta step. It is reused while the linearization holds and c stays.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "linalg/archive.h"
#include "linalg/arena.h"
#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/matrix.h"
#include "system/stage_method.h"
#include "system/transformed_stages.h"

namespace sfdae::core {

class StepMatrix {
 public:
  // Room for so many unknowns of a step.
  void resize(int largest_order);
  // Another linearization holds from now on.
  void forget();

  // Steps of one size differ in their last bits, as times are rounded: the stored matrix is used for their c, too.
  bool is_for(double c) const {
    constexpr double rounding_of_steps = 1e-13;
    return std::fabs(c - c_) <= rounding_of_steps * std::fabs(c);
  }
  bool is_valid() const { return is_valid_; }
  double c() const { return c_; }

  // Factors the matrix for c. False if it is singular. count: of factorizations, raised.
  // Form: has unknowns() and step_matrix() as NullSpaceForm.
  template <class Form>
  bool factor(const Form& form, double tau, double c, long& count);
  // Factors the remaining matrices of the stages, for the c of the last factor(), gamma / h. Known factors are reused.
  template <class Form>
  bool factor_stages(const Form& form, double tau, const StageMethod& method, long& count) {
    return stages_.factor(form, tau, method, c_, count);
  }

  void solve(double* z) const { solve_lu(lu(), pivots_.data(), z); }
  void solve(View z) const { solve_lu(lu(), pivots_.data(), z); }
  // A column for each stage.
  void solve_stages(const StageMethod& method, ConstView r, View z, Arena& arena) {
    stages_.solve(method, lu(), pivots_.data(), r, z, arena);
  }

  // Pairs of stages one by one, for right-hand sides that are transformed elsewhere.
  TransformedStages& pairs() { return stages_; }

  void archive_c(Archive& archive) { archive.real(c_); }

 private:
  ConstView lu() const { return {entries_.data(), order_, order_, order_ > 0 ? order_ : 1}; }

  int order_ = 0;
  std::vector<double> entries_;
  std::vector<int> pivots_;
  double c_ = 0.0;
  bool is_valid_ = false;
  TransformedStages stages_;
};

template <class Form>
bool StepMatrix::factor(const Form& form, double tau, double c, long& count) {
  order_ = form.unknowns();
  const View M{entries_.data(), order_, order_, order_ > 0 ? order_ : 1};
  form.step_matrix(c * tau, M);
  is_valid_ = factor_lu(M, pivots_.data());
  c_ = c;
  if (order_ > 0) ++count;
  return is_valid_;
}

}  // namespace sfdae::core
