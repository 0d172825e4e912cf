// The chord iteration for nonlinear equations: residuals, changes, convergence.
// SPDX-License-Identifier: BSD-3-Clause
#include "array/nonlinear_iteration.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Relative residuals of redundant equations that count as a contradiction: the default of the option consistency_tol.
// Loosely converged points may leave larger ones, which is why they are iterated further.
constexpr double largest_inconsistency = 1e-8;
// A rate that is measured once may be small by chance. Chosen, not measured.
constexpr double least_rate_of_steps = 1e-3;

// The part of a change that exceeds the rounding errors of F, which iterations cannot reduce. NaN becomes infinity,
// since std::max would drop it.
double above_noise(double change, double noise) {
  const double rest = std::fabs(change) - noise;
  return std::isnan(rest) ? std::numeric_limits<double>::infinity() : std::max(0.0, rest);
}

// Sets z to the right-hand side of M z = b - c tau g0 and, for the free part, -tau Uz^T T2^T (c x + x_rest).
void step_rhs(const IterationTask& task, const ArrayLinearization& linearization, const Jet& jet, double* z,
              Arena& arena) {
  const NullSpaceForm& form = linearization.form();
  const double tau = linearization.data().time_scale;
  for (int i = 0; i < form.d; ++i) z[i] = form.b()[i] - tau * task.c * form.g0()[i];
  if (form.u == 0) return;
  const Arena::Frame frame(arena);
  double* rest = arena.take(index(jet.n));
  for (int i = 0; i < jet.n; ++i) rest[i] = task.c * jet.x[index(i)] + task.x_rest[i];
  linearization.free_part(-tau, rest, z + form.d);
}

}  // namespace

void NonlinearIteration::resize() {
  for (auto* v : {&array_f_, &transformed_f_}) v->assign(index(problem_.array_rows()) + 1, 0.0);
  for (auto* v : {&dx_, &xdot_, &z_}) v->assign(index(problem_.n()) + 1, 0.0);
  dy_.assign(index(problem_.n()) * index(problem_.jet_order()) + 1, 0.0);
  const std::size_t size = index(problem_.n()) * index(problem_.jet_order() + 1);
  for (auto* v : {&change_, &correction_}) v->assign(size, 0.0);
  mixing_.resize(size);
}

bool NonlinearIteration::has_contradiction() const { return inconsistency_ > largest_inconsistency; }

void take_sizes(RowSums kind, const StepValues& values, Jet& sizes) {
  const Jet &now = values.now, &before = values.before;
  sizes = now;
  if (kind == RowSums::of_values) return;
  double power = 1.0;
  for (int k = 0; k <= now.order; ++k) {
    for (int j = 0; j < now.n; ++j)
      sizes.column(k)[j] =
          kind == RowSums::of_change ? now.column(k)[j] - before.column(k)[j] : power / values.inverse_weights[j];
    power *= std::fabs(values.c);
  }
}

// The equations of a step at one point for the chord iteration: those of the strangeness-free system,
// Z1^T F(t, x, c x + w_rest) = 0 and Z2^T F_mu = 0.
class NonlinearIteration::StepEquations {
 public:
  StepEquations(NonlinearIteration& iteration, const IterationTask& task, ArrayLinearization& linearization, Jet& jet)
      : iteration_(iteration), task_(task), linearization_(linearization), jet_(jet) {}

  std::size_t num_rows() const { return linearization_.num_step_rows(); }
  PointStatus evaluate(double* rows) {
    const PointStatus status = iteration_.evaluate(task_, linearization_, jet_);
    if (status != PointStatus::ok) return status;
    linearization_.set_constraints(jet_, iteration_.residuals(), RightHandSides::all);
    step_rhs(task_, linearization_, jet_, iteration_.z_.data(), iteration_.arena_);
    linearization_.copy_step_rows(iteration_.transformed_f_.data(), rows);
    return PointStatus::ok;
  }
  void add(RowSums kind, double* rows) const {
    const std::size_t n = index(jet_.n);
    const Arena::Frame frame(iteration_.arena_);
    double* xdot = iteration_.arena_.take(n);
    Jet& sizes = iteration_.sizes_;
    take_sizes(kind, {jet_, iteration_.before_, task_.c, task_.inverse_weights}, sizes);
    for (std::size_t j = 0; j < n; ++j)
      xdot[j] = std::fabs(task_.c * sizes.x[j]) + (kind == RowSums::of_values ? std::fabs(task_.w_rest[j]) : 0.0);
    linearization_.add_step_terms(sizes, xdot, rows);
  }
  double change(const double*) {
    residual_ = max_abs(iteration_.array_f_.data(), iteration_.problem_.array_rows());
    largest_residual_ = std::max(largest_residual_, residual_);
    iteration_.before_ = jet_;
    linearization_.matrix().solve(iteration_.z_.data());
    linearization_.change_of_x(iteration_.z_.data(), iteration_.dx_.data());
    return iteration_.apply_change(task_, linearization_, iteration_.residuals(), iteration_.dx_.data(), jet_);
  }
  bool may_end(int k) const {
    return k == 0 || iteration_.derivatives_follow(linearization_.data(), jet_, residual_, largest_residual_);
  }

 private:
  NonlinearIteration& iteration_;
  const IterationTask& task_;
  ArrayLinearization& linearization_;
  Jet& jet_;
  double residual_ = 0.0, largest_residual_ = 0.0;
};

PointStatus NonlinearIteration::solve(const IterationTask& task, ArrayLinearization& linearization, Jet& jet) {
  const PointStatus status =
      task.has_step ? solve_step(task, linearization, jet) : solve_without_step(task, linearization, jet);
  if (status != PointStatus::ok) return status;
  measure_inconsistency(task, linearization, jet);
  // The known ranks may not fit the jet that was linearized.
  const bool is_doubtful = task.has_step && !linearization.origin().is_judged && has_contradiction();
  return is_doubtful ? PointStatus::not_converged : PointStatus::ok;
}

PointStatus NonlinearIteration::solve_step(const IterationTask& task, ArrayLinearization& linearization, Jet& jet) {
  if (!linearization.factor_step_matrix(task.c)) return PointStatus::singular;
  StepEquations equations(*this, task, linearization, jet);
  return chord_.solve({.tolerance = task.tolerance, .least_rate = least_rate_of_steps}, equations);
}

PointStatus NonlinearIteration::solve_without_step(const IterationTask& task, ArrayLinearization& linearization,
                                                   Jet& jet) {
  // Large, as there is no alternative such as a shorter step. Chosen, not measured.
  constexpr int most = 30;
  double before = 0.0, earlier = 0.0, largest_residual = 0.0;
  chord_.begin();
  mixing_.begin();
  for (int iteration = 0; iteration < most; ++iteration) {
    const PointStatus status = evaluate(task, linearization, jet);
    if (status != PointStatus::ok) return status;
    const double residual = max_abs(array_f_.data(), problem_.array_rows());
    largest_residual = std::max(largest_residual, residual);
    if (task.map == nullptr) solve_linearized(linearization, jet);
    const double norm = task.map != nullptr ? apply_map(task, linearization, jet)
                                            : apply_change(task, linearization, residuals(), dx_.data(), jet);
    if (!std::isfinite(norm)) return PointStatus::not_converged;
    // The next iteration may lose part of the gain, as the linearization is from another point.
    const double reference = std::max(before, earlier);
    const bool has_ended = is_rounding_error(task, iteration, norm, reference);
    if (task.is_mixed) mix(linearization, jet);
    if (has_ended && (iteration == 0 || derivatives_follow(linearization.data(), jet, residual, largest_residual)))
      return PointStatus::ok;
    if (ChordIteration::is_too_slow(iteration, norm, reference)) return PointStatus::not_converged;
    earlier = before;
    before = norm;
  }
  return PointStatus::not_converged;
}

PointStatus NonlinearIteration::solve_to_rounding(const IterationTask& task, ArrayLinearization& linearization,
                                                  Jet& jet) {
  const bool was_slow = chord_.is_slow();
  const PointStatus status = solve(task, linearization, jet);
  chord_.set_slow(was_slow);
  return status;
}

PointStatus NonlinearIteration::solve_to_rounding(ArrayLinearization& linearization, Jet& jet,
                                                  const ResidualMap* map) {
  return solve_to_rounding({.is_mixed = true, .map = map}, linearization, jet);
}

PointStatus NonlinearIteration::solve_at_last(ArrayLinearization& linearization, Jet& jet) {
  // As for the minimal extension.
  constexpr double stagnant = 1e-10;
  return solve_to_rounding({.is_mixed = true, .stagnant = stagnant}, linearization, jet);
}

PointStatus NonlinearIteration::improve(ArrayLinearization& linearization, Jet& jet, Improvement& made) {
  const IterationTask task;
  const PointStatus status = evaluate(task, linearization, jet);
  if (status != PointStatus::ok) return status;
  made.residual = max_abs(array_f_.data(), problem_.array_rows());
  solve_linearized(linearization, jet);
  made.change = apply_change(task, linearization, residuals(), dx_.data(), jet);
  return std::isfinite(made.change) ? PointStatus::ok : PointStatus::not_converged;
}

PointStatus NonlinearIteration::evaluate(const IterationTask& task, ArrayLinearization& linearization,
                                         const Jet& jet) {
  const PointStatus status = linearization.evaluate_array(jet, residuals());
  if (status != PointStatus::ok || !task.has_step) return status;
  for (std::size_t i = 0; i < index(jet.n); ++i) xdot_[i] = task.c * jet.x[i] + task.w_rest[i];
  return linearization.evaluate_differential(jet.t, jet.x.data(), xdot_.data());
}

// Sets dx_ by the linearized equations at the jet, without a step.
void NonlinearIteration::solve_linearized(ArrayLinearization& linearization, const Jet& jet) {
  linearization.set_constraints(jet, residuals(), RightHandSides::constraints);
  linearization.keep_differential_part(z_.data());
  linearization.change_of_x(z_.data(), dx_.data());
}

double NonlinearIteration::apply_change(const IterationTask& task, const ArrayLinearization& linearization,
                                        const ArrayResiduals& residuals, const double* dx, Jet& jet) {
  linearization.apply_change(residuals, dx, dy_.data(), jet);
  return task.inverse_weights == nullptr ? relative_norm(linearization, dx, jet)
                                         : weighted_norm(task, linearization, dx);
}

double NonlinearIteration::apply_map(const IterationTask& task, const ArrayLinearization& linearization, Jet& jet) {
  const std::size_t n = index(problem_.n());
  task.map->apply(array_f_.data(), change_.data());
  std::copy_n(change_.data(), n, dx_.data());
  std::copy_n(change_.data() + n, change_.size() - n, dy_.data());
  jet.add_scaled(dx_.data(), dy_.data(), problem_.jet_order(), linearization.data().time_scale, problem_.units());
  return relative_norm(linearization, dx_.data(), jet);
}

// Anderson mixing after a change by dx_ and dy_. Such changes keep Z1^T E x, and so do their differences.
void NonlinearIteration::mix(const ArrayLinearization& linearization, Jet& jet) {
  const std::size_t n = index(problem_.n());
  std::copy_n(dx_.data(), n, change_.data());
  std::copy_n(dy_.data(), change_.size() - n, change_.data() + n);
  if (!mixing_.correct(change_.data(), correction_.data())) return;
  jet.add_scaled(correction_.data(), correction_.data() + n, problem_.jet_order(), linearization.data().time_scale,
                 problem_.units());
}

double NonlinearIteration::relative_norm(const ArrayLinearization& linearization, const double* dx,
                                         const Jet& jet) const {
  // y has to converge, too, though not to the last digits: ranks are decided there. Chosen, not measured.
  constexpr double share_of_y = 1e-3;
  const int n = problem_.n();
  const Units& units = problem_.units();
  const std::vector<double>& noise = linearization.noise();
  double norm = 0.0, size = 0.0, size_y = 0.0, norm_y = 0.0, power = 1.0;
  for (int i = 0; i < n; ++i) {
    norm = std::max(norm, above_noise(dx[i], noise[index(i)]));
    size = std::max(size, std::fabs(jet.x[index(i)]) / units[i]);
  }
  for (int k = 1; k <= problem_.jet_order(); ++k) {
    power *= linearization.data().time_scale;
    for (int i = 0; i < n; ++i) {
      norm_y = std::max(norm_y, above_noise(dy_[index((k - 1) * n + i)], noise[index(k * n + i)]));
      size_y = std::max(size_y, k * power * std::fabs(jet.column(k)[i]) / units[i]);
    }
  }
  return std::max(size > 0.0 ? norm / size : norm, size_y > 0.0 ? share_of_y * norm_y / std::max(size, size_y) : 0.0);
}

// Norm in units of the tolerance; changes of y count by their effect over the step.
double NonlinearIteration::weighted_norm(const IterationTask& task, const ArrayLinearization& linearization,
                                         const double* dx) const {
  const int n = problem_.n();
  const Units& units = problem_.units();
  const std::vector<double>& noise = linearization.noise();
  double norm = 0.0;
  for (int i = 0; i < n; ++i)
    norm = std::max(norm, above_noise(dx[i], noise[index(i)]) * units[i] * task.inverse_weights[i]);
  const double ratio = 1.0 / (std::fabs(task.c) * linearization.data().time_scale);
  double power = 1.0;
  for (int k = 1; k <= problem_.jet_order(); ++k) {
    power *= ratio;
    const double* change = dy_.data() + static_cast<std::ptrdiff_t>(k - 1) * n;
    for (int i = 0; i < n; ++i)
      norm = std::max(
          norm, power / k * above_noise(change[i], noise[index(k * n + i)]) * units[i] * task.inverse_weights[i]);
  }
  return norm;
}

// True if the change is roundoff: negligible or, after the first iterations, small and no longer decreasing.
bool NonlinearIteration::is_rounding_error(const IterationTask& task, int iteration, double norm, double before) {
  constexpr double negligible = 4.0 * unit_roundoff;
  return norm <= negligible || (iteration > 1 && norm <= task.stagnant && norm > 0.5 * before);
}

// Changes of y count little in short steps. If they do not reduce the residuals, the constraints for x are those of a
// wrong y (docs/design/derivative_array.md).
bool NonlinearIteration::derivatives_follow(const TaylorData& data, const Jet& jet, double residual,
                                            double largest) const {
  // y has converged if the residual is at most half of the largest one, or negligible relative to its terms. Chosen,
  // not measured.
  constexpr double reduction = 0.5, negligible = 1e-10;
  if (residual <= reduction * largest) return true;
  double size = 0.0, power = 1.0;
  for (int k = 0; k <= problem_.jet_order(); ++k) {
    const double factor = k == 0 ? 1.0 : k * (power *= data.time_scale);
    for (int j = 0; j < problem_.n(); ++j)
      size = std::max(size, factor * std::fabs(jet.column(k)[j]) / problem_.units()[j]);
  }
  return residual <= negligible * size * data.norm(problem_.mu());
}

// Residuals left by the iteration look like contradictions, but vanish when it continues.
void NonlinearIteration::measure_inconsistency(const IterationTask& task, ArrayLinearization& linearization,
                                               const Jet& jet) {
  // Rounding errors of the data are amplified by at most 1 / smallest pivot, times a factor for long sums. Chosen, not
  // measured.
  constexpr double sums = 1e3;
  const NullSpaceForm& form = linearization.form();
  const double noise = sums * linearization.data().noise_A(problem_.mu()) / linearization.quality().smallest_pivot;
  const bool is_noise = form.inconsistency() <= noise;
  inconsistency_ = is_noise ? 0.0 : form.inconsistency();
  if (is_noise || task.inverse_weights == nullptr) return;
  refined_ = jet;
  if (solve_to_rounding(linearization, refined_) != PointStatus::ok)
    inconsistency_ = std::min(inconsistency_, form.inconsistency());
}

PointStatus NonlinearIteration::check_redundant(const IterationTask& task, ArrayLinearization& linearization,
                                                const Jet& jet) {
  inconsistency_ = 0.0;
  if (problem_.analysis().v_hat == 0) return PointStatus::ok;
  const PointStatus status = linearization.evaluate_array(jet, residuals());
  if (status != PointStatus::ok) return status;
  linearization.set_constraints(jet, residuals());
  measure_inconsistency(task, linearization, jet);
  return has_contradiction() && !linearization.origin().is_judged ? PointStatus::not_converged : PointStatus::ok;
}

}  // namespace sfdae::core
