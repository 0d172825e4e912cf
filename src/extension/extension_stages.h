// The stages of an implicit Runge-Kutta step for the extension: simplified Newton with one linearization.
//
// For the states j, stage i: x_j' = sum_k D_ik (x_j,k - x_j) / h. With all unknowns of all stages multiplied by T^-1
// one real system and (s - 1) / 2 complex ones remain, of the matrices of steps with c = gamma / h and lambda_k / h
// [HW96, IV.8].
//
// [HW96] E. Hairer, G. Wanner: Solving Ordinary Differential Equations II. Springer, 2nd ed. 1996.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <vector>

#include "array/jet_history.h"
#include "extension/extension_iteration.h"
#include "extension/local_stages.h"
#include "system/jet.h"
#include "system/strangeness_free_system.h"

namespace sfdae::core {

class ExtensionStages {
 public:
  explicit ExtensionStages(MinimalExtension& extension) : extension_(extension), local_(extension) {}

  // Predicts the starting jets. determined: flags of the derivatives.
  void predict(const StageEquations& equations, const JetHistory& history, const std::vector<char>& determined);
  void hold_derivatives(const JetHistory& history) {
    for (int i = 0; i < s_; ++i) history.hold_derivatives(starts_[index(i)]);
  }
  // Solves with one linearization for all stages or, where that is useful, with one for each: not converged if the
  // states are unsuitable at one of them.
  enum class Linearized { once, at_each_stage };
  PointStatus solve(const StageEquations& step, Linearized linearized, ExtensionLinearization& linearization,
                    ExtensionIteration& iteration);
  // The predicted jet at which the states were unsuitable; else null.
  const Jet* ill_served() const { return ill_served_ < 0 ? nullptr : &starts_[index(ill_served_)]; }
  bool may_linearize_each(int s) const { return local_.is_of_use(s); }
  // Archives the data besides the linearization that stages depend on; see LocalStages.
  void archive(Archive& archive, const ExtensionLinearization& linearization) {
    local_.archive(archive, linearization);
  }
  LocalStages* local(const ExtensionLinearization& linearization) {
    return local_.is_of(linearization) ? &local_ : nullptr;
  }
  // Tangents at the end of the step, from stages linearized one by one: see LocalStages.
  ConstView end_tangents() const { return local_.end_tangents(); }
  const Jet& middle() const { return starts_[index(s_ / 2)]; }
  const Jet& jet(int i) const { return jets_[index(i)]; }
  const Jet& last() const { return jets_[index(s_ - 1)]; }
  // x: n x s.
  void copy_to(double* x) const;

 private:
  class Equations;
  PointStatus evaluate(ExtensionIteration& iteration, double* r);
  void set_slopes(const StageEquations& equations, const StateChoice& choice);
  void sum_slope_terms(const StageEquations& equations, RowSums kind, const StateChoice& choice);
  void solve_transformed(const StageMethod& method, ExtensionLinearization& linearization);
  double* column(std::vector<double>& entries, int i) const {
    return entries.data() + static_cast<std::ptrdiff_t>(i) * extension_.num_rows();
  }

  MinimalExtension& extension_;
  LocalStages local_;
  int s_ = 0, ill_served_ = -1;
  std::vector<Jet> starts_, jets_;
  std::vector<double> r_, z_;  // a column for each stage
  std::vector<double> terms_;  // of x_j' at the stages, s for each unknown j; states alone
  std::vector<double> sizes_;  // of the unknowns of a stage, or of their changes, by columns of the extension
  std::vector<std::complex<double>> pair_;
};

}  // namespace sfdae::core
