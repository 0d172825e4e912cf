// The chord iteration for all equations of the extension at one point.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/extension_iteration.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"
#include "linalg/rank.h"
#include "system/kept_matrix.h"

namespace sfdae::core {

namespace {

// Without a step there is no alternative to more iterations. As for other nonlinear systems.
constexpr int most_iterations_held = 30, most_iterations_of_slopes = 12;
// A rate that is measured once may be small by chance. Chosen, not measured.
constexpr double least_rate = 1e-3;

double above_noise(double change, double noise) { return std::max(0.0, std::fabs(change) - noise); }

}  // namespace

PointStatus ExtensionIteration::evaluate(const Jet& jet, double* r) {
  callback_error_ = extension_.residuals(jet, r);
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  for (int i = 0; i < extension_.num_rows(); ++i) r[i] = -r[i];
  return PointStatus::ok;
}

void ExtensionIteration::set_slopes(const StateChoice& choice, double c, const double* w_rest, Jet& jet) {
  for (int j : choice.states()) jet.column(1)[j] = c * jet.x[index(j)] + w_rest[j];
}

// Changes of derivatives count by their effect over the step.
void ExtensionIteration::set_weights(double c, const double* inverse_weights, const StateChoice& choice) {
  weights_.resize(choice.changed().size());
  double* to = weights_.data();
  for (int column : choice.changed()) {
    const auto [unknown, order] = extension_.columns()[index(column)];
    double weight = inverse_weights[unknown];
    for (int k = 0; k < order; ++k) weight /= std::fabs(c);
    *to++ = weight;
  }
  c_ = c;
  inverse_weights_ = inverse_weights;
}

double ExtensionIteration::apply_change(double factor, const double* z, const ExtensionLinearization& linearization,
                                        Jet& jet) {
  const double* const noise = linearization.noise().data();
  const double* weight = weights_.data();
  double* const x = jet.x.data();
  double norm = 0.0;
  const StateChoice& choice = linearization.choice();
  for (int column : choice.changed()) {
    const auto [unknown, order] = extension_.columns()[index(column)];
    const double dx = factor * z[choice.slot(column)];
    x[unknown + order * extension_.n()] += dx;
    if (!std::isfinite(dx)) return dx;
    norm = std::max(norm, above_noise(dx, noise[column]) * *weight++);
  }
  return norm;
}

// A matrix for another c is reused while it contracts; changes are then multiplied by 2 / (1 + c / c of the matrix)
// (docs/design/iteration_matrices.md).
bool ExtensionIteration::prepare_matrix(double c, ExtensionLinearization& linearization) {
  deviation_ = 0.0;
  if (linearization.has_step_matrix()) {
    deviation_ = deviation_of(c, linearization.c());
    waste_ += iterations_wasted(deviation_);
    if (deviation_ <= largest_deviation && waste_ <= linearization.cost_of_step_matrix()) {
      chord_.set_rate(std::max(chord_.rate(), deviation_));
      return true;
    }
  }
  deviation_ = waste_ = 0.0;
  return linearization.factor_step(c);
}

bool ExtensionIteration::blames_matrix() const { return deviation_ > harmless_deviation; }

// The equations of a step at one point for the chord iteration.
class ExtensionIteration::StepEquations {
 public:
  StepEquations(ExtensionIteration& iteration, const StepTask& task, ExtensionLinearization& linearization, Jet& jet)
      : iteration_(iteration),
        task_(task),
        linearization_(linearization),
        factor_(2.0 / (1.0 + task.c / linearization.c())),
        jet_(jet) {}

  void set_slopes() { ExtensionIteration::set_slopes(linearization_.choice(), task_.c, task_.w_rest, jet_); }
  std::size_t num_rows() const { return index(iteration_.extension_.num_rows()); }
  PointStatus evaluate(double* rows) {
    set_slopes();
    return iteration_.evaluate(jet_, rows);
  }
  void add(RowSums kind, double* rows) const {
    const std::vector<double>& values = linearization_.derivatives().values;
    const double* z = iteration_.r_.data();
    const StateChoice& choice = linearization_.choice();
    const auto slope = [&](int j) {
      return kind == RowSums::of_change ? std::fabs(task_.c * z[choice.slot(iteration_.extension_.column_of(j, 0))])
                                        : std::fabs(task_.c * jet_.x[index(j)]) + std::fabs(task_.w_rest[j]);
    };
    const Place place{jet_, z, choice};
    iteration_.add_terms([&](std::size_t e) { return values[e]; },
                         [&](int column) { return iteration_.size_of(kind, place, column, slope); }, rows);
  }
  double change(const double* rows) {
    std::copy_n(rows, num_rows(), iteration_.r_.data());
    linearization_.solve_step(iteration_.r_.data());
    return iteration_.apply_change(factor_, iteration_.r_.data(), linearization_, jet_);
  }
  bool may_end(int) const { return true; }

 private:
  ExtensionIteration& iteration_;
  const StepTask& task_;
  ExtensionLinearization& linearization_;
  double factor_;
  Jet& jet_;
};

PointStatus ExtensionIteration::solve_step(const StepTask& task, ExtensionLinearization& linearization, Jet& jet) {
  if (!prepare_matrix(task.c, linearization)) return PointStatus::singular;
  set_weights(task.c, task.inverse_weights, linearization.choice());
  r_.resize(index(extension_.num_rows()) + 1);
  StepEquations equations(*this, task, linearization, jet);
  const PointStatus status =
      chord_.solve({.tolerance = task.tolerance, .least_rate = std::max(least_rate, deviation_)}, equations);
  if (status == PointStatus::ok) equations.set_slopes();
  return status;
}

// r_: changes by slots.
ExtensionIteration::Norms ExtensionIteration::apply_held(const Yardsticks& yardsticks, const StateChoice& choice,
                                                         Jet& jet) {
  Norms norms;
  for (int column = 0; column < extension_.num_columns(); ++column) {
    if (choice.is_held(column)) continue;
    const auto [unknown, order] = extension_.columns()[index(column)];
    const double dx = r_[index(choice.slot(column))];
    double& value = jet.column(order)[unknown];
    value += dx;
    double& norm = order == 0 ? norms.of_x : norms.of_derivatives;
    if (!std::isfinite(value)) norms.of_x = value;
    const double scale =
        order == 0 ? std::max(std::fabs(value), yardsticks.scales[index(unknown)]) : std::fabs(value);
    const double excess = above_noise(dx, yardsticks.noise[index(column)]);
    if (excess > 0.0) norm = std::max(norm, scale > 0.0 ? excess / scale : 1.0);
  }
  return norms;
}

PointStatus ExtensionIteration::solve_held(ExtensionLinearization& linearization, const std::vector<double>& scales,
                                           Hope hope, Jet& jet) {
  // Ends when changes stop decreasing, after the first ones at some hundred units of roundoff of x; derivatives of high
  // order may lose more.
  constexpr double negligible = 4.0 * unit_roundoff, small_derivatives = 1e-8;
  const double small = hope == Hope::none ? 1e-10 : 1e-13;
  r_.resize(index(extension_.num_rows()) + 1);
  std::vector<double> larger_noise;
  const std::vector<double>* noise = &linearization.noise();
  Norms before, earlier;
  for (int iteration = 0; iteration < most_iterations_held; ++iteration) {
    const PointStatus status = evaluate(jet, r_.data());
    if (status != PointStatus::ok) return status;
    linearization.solve_held(r_.data());
    // At the point of the linearization the unknowns may have been much smaller, as at a start from rest.
    if (iteration == 2) {
      larger_noise = linearization.noise_at(jet);
      for (std::size_t k = 0; k < larger_noise.size(); ++k)
        larger_noise[k] = std::max(linearization.noise()[k], larger_noise[k]);
      noise = &larger_noise;
    }
    const Norms norms = apply_held({scales, *noise}, linearization.choice(), jet);
    if (!std::isfinite(norms.of_x) || !std::isfinite(norms.of_derivatives)) return PointStatus::not_converged;
    const bool is_x_there =
        norms.of_x <= negligible || (iteration > 1 && norms.of_x <= small && norms.of_x > 0.5 * before.of_x);
    const bool are_derivatives_there =
        norms.of_derivatives <= small || (iteration > 1 && norms.of_derivatives > 0.5 * before.of_derivatives);
    if (is_x_there && (norms.of_derivatives <= small_derivatives || are_derivatives_there)) return PointStatus::ok;
    // The next iteration may lose part of the gain, as the linearization is from another point.
    if (ChordIteration::is_too_slow(iteration, norms.of_x, std::max(before.of_x, earlier.of_x)) && norms.of_x > small)
      return PointStatus::not_converged;
    earlier = before;
    before = norms;
  }
  return PointStatus::not_converged;
}

// All rows differentiated once more determine x_j^(d_j + 1). The jet has the x' that the extension determines; the
// other x' are those of unknowns with d_j = 0.
PointStatus ExtensionIteration::derivative(ExtensionLinearization& linearization, Hope hope, const Jet& jet,
                                           double* xdot) {
  // Linearizations from another point may contract slowly: only small changes may then be roundoff.
  constexpr double small = 1e-10, small_where_slow = 1e-8;
  const int n = extension_.n();
  const std::vector<int>& d = extension_.offsets().d;
  if (std::find(d.begin(), d.end(), 0) == d.end()) {
    std::copy_n(jet.column(1), n, xdot);
    return PointStatus::ok;
  }
  longer_ = jet;
  longer_.set_order(jet.order + 1);
  r_.resize(index(extension_.num_rows()) + 1);
  double before = 0.0;
  bool is_there = false;
  for (int iteration = 0; !is_there && iteration < most_iterations_of_slopes; ++iteration) {
    callback_error_ = extension_.slopes(longer_, r_.data());
    if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
    for (int i = 0; i < extension_.num_rows(); ++i) r_[index(i)] = -r_[index(i)];
    linearization.solve_held(r_.data());
    double change = 0.0, size = 0.0;
    for (int j = 0; j < n; ++j) {
      const int order = d[index(j)] + 1;
      const int slot = linearization.choice().slot(extension_.column_of(j, order - 1));
      double& value = longer_.column(order)[j];
      const double dx = r_[index(slot)] / order;
      value += dx;
      change = std::max(change, std::fabs(dx));
      size = std::max(size, std::fabs(value));
    }
    if (!std::isfinite(change)) return PointStatus::not_converged;
    const bool is_slow = iteration > 0 && change > slowest_contraction * before;
    is_there = change <= (is_slow ? small_where_slow : small) * size || (is_slow && hope == Hope::none);
    if (is_slow && !is_there) return PointStatus::not_converged;
    before = change;
  }
  if (!is_there && hope != Hope::none) return PointStatus::not_converged;
  std::copy_n(longer_.column(1), n, xdot);
  return PointStatus::ok;
}

}  // namespace sfdae::core
