// The stages of an implicit Runge-Kutta step for the extension.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/extension_stages.h"

#include <algorithm>
#include <cmath>

#include "array/nonlinear_iteration.h"
#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/matrix.h"
#include "system/transformed_stages.h"

namespace sfdae::core {

void ExtensionStages::predict(const StageEquations& equations, const JetHistory& history,
                              const std::vector<char>& determined) {
  const StageMethod& method = equations.method;
  const double h = equations.t_end - equations.t;
  s_ = method.s;
  const std::size_t stages = index(s_), size = index(extension_.num_rows()) * stages + 1;
  // Either may be incomplete if memory was missing.
  for (std::vector<Jet>* jets : {&starts_, &jets_})
    if (jets->size() < stages) jets->resize(stages, history.accepted());
  for (auto* v : {&r_, &z_})
    if (v->size() < size) v->resize(size);
  terms_.resize(index(extension_.n()) * stages + 1);
  sizes_.resize(index(extension_.num_columns()));
  pair_.resize(index(extension_.num_rows()) + 1);
  for (int i = 0; i < s_; ++i) {
    Jet& start = starts_[index(i)];
    start.t = i == s_ - 1 ? equations.t_end : equations.t + method.c[index(i)] * h;
    history.predict(equations.guess, i, determined, {}, start);
  }
}

void ExtensionStages::set_slopes(const StageEquations& equations, const StateChoice& choice) {
  const double h = equations.t_end - equations.t;
  const std::ptrdiff_t n = extension_.n();
  std::array<double*, max_stages> x{};
  for (int i = 0; i < s_; ++i) x[index(i)] = jets_[index(i)].x.data();
  with_stages(s_, [&](auto s) {
    for (int j : choice.states()) {
      std::array<double, max_stages> change{};
      for (int k = 0; k < s; ++k) change[index(k)] = x[index(k)][j] - equations.x[j];
      const std::array<double, max_stages> slope = product(equations.method.D, s, change);
      for (int i = 0; i < s; ++i) x[index(i)][n + j] = slope[index(i)] / h;
    }
  });
}

// terms_: for each state, the sums of the terms of x_j' at the stages, or of their changes.
void ExtensionStages::sum_slope_terms(const StageEquations& equations, RowSums kind, const StateChoice& choice) {
  const double h = std::fabs(equations.t_end - equations.t);
  StageMatrix D;
  for (std::size_t k = 0; k < D.size(); ++k) D[k] = std::fabs(equations.method.D[k]);
  with_stages(s_, [&](auto s) {
    for (int j : choice.states()) {
      const int slot = choice.slot(extension_.column_of(j, 0));
      std::array<double, max_stages> size{};
      for (int k = 0; k < s; ++k)
        size[index(k)] = kind == RowSums::of_change
                             ? std::fabs(column(r_, k)[slot])
                             : std::fabs(jets_[index(k)].x[index(j)]) + std::fabs(equations.x[j]);
      const std::array<double, max_stages> sum = product(D, s, size);
      for (int i = 0; i < s; ++i) terms_[index(i + j * s)] = sum[index(i)] / h;
    }
  });
}

void ExtensionStages::solve_transformed(const StageMethod& method, ExtensionLinearization& linearization) {
  const int q = extension_.num_rows(), s = method.s;
  const auto block = [&](std::vector<double>& entries) { return View{entries.data(), q, s, std::max(q, 1)}; };
  solve_decoupled(
      method, block(r_), block(z_), block(r_), pair_.data(), [&](double* x) { linearization.solve_step(x); },
      [&](std::size_t k, std::complex<double>* omega) { linearization.solve_pair(k, omega); });
}

PointStatus ExtensionStages::evaluate(ExtensionIteration& iteration, double* r) {
  // With fewer stages, too many lanes would be idle.
  constexpr int fewest_side_by_side = 3;
  if (s_ >= fewest_side_by_side && extension_.residuals_side_by_side(jets_, s_, r)) {
    for (std::size_t k = 0; k < index(s_) * index(extension_.num_rows()); ++k) r[k] = -r[k];
    return PointStatus::ok;
  }
  for (int i = 0; i < s_; ++i) {
    const PointStatus status = iteration.evaluate(jets_[index(i)], r + index(i) * index(extension_.num_rows()));
    if (status != PointStatus::ok) return status;
  }
  return PointStatus::ok;
}

// The equations of all stages for the chord iteration.
class ExtensionStages::Equations {
 public:
  Equations(ExtensionStages& stages, const StageEquations& step, bool is_local, ExtensionLinearization& linearization,
            ExtensionIteration& iteration)
      : stages_(stages), step_(step), is_local_(is_local), linearization_(linearization), iteration_(iteration) {}

  std::size_t num_rows() const { return index(stages_.s_) * index(stages_.extension_.num_rows()); }
  PointStatus evaluate(double* rows) { return stages_.evaluate(iteration_, rows); }
  void add(RowSums kind, double* rows) const {
    const std::vector<double>& once = linearization_.derivatives().values;
    stages_.sum_slope_terms(step_, kind, linearization_.choice());
    std::vector<double>& sizes = stages_.sizes_;
    for (int i = 0; i < stages_.s_; ++i, rows += stages_.extension_.num_rows()) {
      const ExtensionIteration::Place place{stages_.jets_[index(i)], stages_.column(stages_.r_, i),
                                            linearization_.choice()};
      const auto slope = [&](int j) { return stages_.terms_[index(i + j * stages_.s_)]; };
      for (std::size_t column = 0; column < sizes.size(); ++column)
        sizes[column] = iteration_.size_of(kind, place, static_cast<int>(column), slope);
      iteration_.add_terms([&](std::size_t e) { return is_local_ ? stages_.local_.derivative(e, i) : once[e]; },
                           [&](int column) { return sizes[index(column)]; }, rows);
    }
  }
  double change(const double* rows) {
    std::copy_n(rows, num_rows(), stages_.r_.data());
    const int q = stages_.extension_.num_rows();
    if (is_local_) stages_.local_.solve({stages_.r_.data(), q, stages_.s_, std::max(q, 1)});
    else stages_.solve_transformed(step_.method, linearization_);
    double norm = 0.0;
    for (int i = 0; i < stages_.s_; ++i) {
      const double size =
          iteration_.apply_change(1.0, stages_.column(stages_.r_, i), linearization_, stages_.jets_[index(i)]);
      if (!std::isfinite(size)) return size;
      norm = std::max(norm, size);
    }
    stages_.set_slopes(step_, linearization_.choice());
    return norm;
  }
  bool may_end(int) const { return true; }

 private:
  ExtensionStages& stages_;
  const StageEquations& step_;
  bool is_local_;
  ExtensionLinearization& linearization_;
  ExtensionIteration& iteration_;
};

PointStatus ExtensionStages::solve(const StageEquations& step, Linearized linearized,
                                   ExtensionLinearization& linearization, ExtensionIteration& iteration) {
  const double h = step.t_end - step.t;
  const bool is_local = linearized != Linearized::once;
  ill_served_ = -1;
  for (int i = 0; i < s_; ++i) jets_[index(i)] = starts_[index(i)];
  set_slopes(step, linearization.choice());
  if (is_local) {
    const PointStatus status = local_.linearize(step, jets_, linearization, iteration.callback_error());
    if (status != PointStatus::ok) return status;
    ill_served_ = local_.ill_served(linearization);
    if (ill_served_ >= 0) return PointStatus::not_converged;
  } else if (!linearization.factor_stages(step.method, h)) {
    return PointStatus::singular;
  }
  iteration.set_weights(step.method.gamma / h, step.guess.inverse_weights, linearization.choice());
  Equations equations(*this, step, is_local, linearization, iteration);
  const ChordTarget target{.tolerance = newton_tolerance,
                           .least_rate = 1e-3,
                           .most_iterations = 20,
                           .alternates = true,
                           .largest_ratio = is_local ? largest_ratio_from_guess : slowest_contraction};
  return iteration.chord().solve(target, equations);
}

void ExtensionStages::copy_to(double* x) const {
  const int n = extension_.n();
  for (int i = 0; i < s_; ++i) std::copy_n(jets_[index(i)].x.data(), n, x + static_cast<std::ptrdiff_t>(i) * n);
}

}  // namespace sfdae::core
