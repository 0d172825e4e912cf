// The stages of an implicit Runge-Kutta step for the extension.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/extension_stages.h"

#include <algorithm>
#include <cmath>

#include "array/nonlinear_iteration.h"
#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/matrix.h"
#include "system/kept_matrix.h"
#include "system/transformed_stages.h"

namespace sfdae::core {

void ExtensionStages::predict(const StageEquations& equations, const JetHistory& history,
                              const std::vector<char>& determined) {
  const StageMethod& method = equations.method;
  const double h = equations.t_end - equations.t;
  s_ = method.s;
  const std::size_t stages = index(s_), size = index(extension_.num_rows()) * stages + 1;
  // Either may have been left out where memory was missing.
  for (std::vector<Jet>* jets : {&starts_, &jets_})
    if (jets->size() < stages) jets->resize(stages, history.accepted());
  for (auto* v : {&r_, &z_})
    if (v->size() < size) v->resize(size);
  pair_.resize(index(extension_.num_rows()) + 1);
  for (int i = 0; i < s_; ++i) {
    Jet& start = starts_[index(i)];
    start.t = i == s_ - 1 ? equations.t_end : equations.t + method.c[index(i)] * h;
    history.predict(equations.guess, i, determined, {}, start);
  }
}

void ExtensionStages::set_slopes(const StageEquations& equations, const StateChoice& choice) {
  const double h = equations.t_end - equations.t;
  for (int i = 0; i < s_; ++i)
    for (int j : choice.states()) {
      double slope = 0.0;
      for (int k = 0; k < s_; ++k)
        slope += equations.method.D_at(i, k) * (jets_[index(k)].x[index(j)] - equations.x[j]);
      jets_[index(i)].column(1)[j] = slope / h;
    }
}

void ExtensionStages::solve_transformed(const StageMethod& method, ExtensionLinearization& linearization) {
  const int q = extension_.num_rows(), s = method.s;
  const auto block = [&](std::vector<double>& entries) { return View{entries.data(), q, s, std::max(q, 1)}; };
  solve_decoupled(
      method, block(r_), block(z_), block(r_), pair_.data(), [&](double* x) { linearization.solve_step(x); },
      [&](std::size_t k, std::complex<double>* omega) { linearization.solve_pair(k, omega); });
}

PointStatus ExtensionStages::evaluate(ExtensionIteration& iteration) {
  // Eight points for one would be too many.
  constexpr int fewest_side_by_side = 3;
  if (s_ >= fewest_side_by_side && extension_.residuals_side_by_side(jets_, s_, r_.data())) {
    for (std::size_t k = 0; k < index(s_) * index(extension_.num_rows()); ++k) r_[k] = -r_[k];
    return PointStatus::ok;
  }
  for (int i = 0; i < s_; ++i) {
    const PointStatus status = iteration.evaluate(jets_[index(i)], column(r_, i));
    if (status != PointStatus::ok) return status;
  }
  return PointStatus::ok;
}

PointStatus ExtensionStages::solve(const StageEquations& equations, Linearized linearized,
                                   ExtensionLinearization& linearization, ExtensionIteration& iteration) {
  // As for other nonlinear systems: more are better saved by shorter steps.
  constexpr int most = 12;
  const double h = equations.t_end - equations.t;
  const bool is_local = linearized != Linearized::once;
  ill_served_ = -1;
  for (int i = 0; i < s_; ++i) jets_[index(i)] = starts_[index(i)];
  set_slopes(equations, linearization.choice());
  if (is_local) {
    const PointStatus status = local_.linearize(equations, jets_, linearization, iteration.callback_error());
    if (status != PointStatus::ok) return status;
    ill_served_ = local_.ill_served(linearization);
    if (ill_served_ >= 0) return PointStatus::not_converged;
  } else if (!linearization.factor_stages(equations.method, h)) {
    return PointStatus::singular;
  }
  iteration.set_weights(equations.method.gamma / h, equations.guess.inverse_weights, linearization.choice());
  const ChordTarget target{newton_tolerance, 1e-3};
  const auto is_out_of_date = [&] {
    for (int i = 0; i < s_; ++i) {
      const Jet& origin = is_local ? starts_[index(i)] : linearization.origin();
      if (have_fallen(equations.guess.steep_arguments, origin, jets_[index(i)])) return true;
    }
    return false;
  };
  double before = 0.0, earlier = 0.0;
  iteration.chord().begin();
  for (int k = 0; k < most; ++k) {
    const PointStatus status = evaluate(iteration);
    if (status != PointStatus::ok) return status;
    if (is_local) local_.solve({r_.data(), extension_.num_rows(), s_, std::max(extension_.num_rows(), 1)});
    else solve_transformed(equations.method, linearization);
    double norm = 0.0;
    for (int i = 0; i < s_; ++i) {
      const double size = iteration.apply_change(1.0, column(r_, i), linearization, jets_[index(i)]);
      if (!std::isfinite(size)) return PointStatus::not_converged;
      norm = std::max(norm, size);
    }
    set_slopes(equations, linearization.choice());
    if (iteration.chord().has_converged(target, k, norm, before, is_out_of_date)) return PointStatus::ok;
    if (ChordIteration::is_too_slow(k, norm, std::max(before, earlier))) return PointStatus::not_converged;
    earlier = before;
    before = norm;
  }
  return PointStatus::not_converged;
}

void ExtensionStages::copy_to(double* x) const {
  const int n = extension_.n();
  for (int i = 0; i < s_; ++i) std::copy_n(jets_[index(i)].x.data(), n, x + static_cast<std::ptrdiff_t>(i) * n);
}

}  // namespace sfdae::core
