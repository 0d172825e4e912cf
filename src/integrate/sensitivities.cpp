// Sensitivities computed along with the steps of x.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/sensitivities.h"

#include <algorithm>
#include <utility>

#include "integrate/radau_method.h"
#include "linalg/index.h"
#include "linalg/matrix.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Errors of all columns, mapped to the directions that constraints do not determine.
class ErrorOfS final : public ErrorMap {
 public:
  ErrorOfS(SensitivitySystem& system, const std::vector<ErrorWeights>& weights)
      : system_(system), weights_(weights) {}
  void map(const double* differences, int count, double* mapped) override {
    const std::size_t size = system_.size();
    for (std::size_t k = 0; k < index(count); ++k) system_.error_in_S(differences + k * size, mapped + k * size);
  }
  double norm(const double* mapped) const override {
    const std::size_t n = index(system_.unknowns());
    double largest = 0.0;
    for (std::size_t j = 0; j < weights_.size(); ++j) largest = std::max(largest, weights_[j].norm(mapped + j * n));
    return largest;
  }

 private:
  SensitivitySystem& system_;
  const std::vector<ErrorWeights>& weights_;
};

}  // namespace

Sensitivities::Sensitivities(std::unique_ptr<SensitivitySystem> system, SensitivityOptions options, Vector S)
    : system_(std::move(system)), options_(std::move(options)), S_(std::move(S)) {
  for (Vector* v : {&Sdot_, &tried_, &slopes_, &error_}) v->assign(size(), 0.0);
  before_ = S_;
  xdot_.assign(index(unknowns()), 0.0);
  weights_.resize(index(count()));
}

SensitivityWork Sensitivities::work() const {
  SensitivityWork work = work_;
  const SensitivityCounts counts = system_->counts();
  work.linearizations = counts.linearizations;
  work.factorizations = counts.factorizations;
  return work;
}

void Sensitivities::demand(PointStatus status, double t) const {
  if (status == PointStatus::callback_error) system_->callback_error().raise();
  if (status != PointStatus::ok)
    throw Failure(SFDAE_SINGULAR,
                  format("the equations of the sensitivities at t = %.15g are singular: the characteristic values "
                         "that are known do not hold there.",
                         t));
  if (system_->inconsistency() > contradiction_of_derivatives)
    throw Failure(
        SFDAE_INCONSISTENT_EQUATIONS,
        format("redundant equations contradict each other at t = %.15g once a parameter is changed: relative "
               "residual %.3g of their derivatives by parameters. Sensitivities do not exist.",
               t, system_->inconsistency()));
}

void Sensitivities::start(const Integrator& integrator) {
  const double t = integrator.stepper->state().t;
  Vector consistent(size());
  demand(system_->restore(S_.data(), consistent.data()), t);
  demand(system_->derivative(consistent.data(), Sdot_.data()), t);
  S_ = before_ = std::move(consistent);
  method_ = nullptr;
  const Vector none;
  history_.start({t, none, none, S_, Sdot_});
  estimate_.forget();
  if (options_.error_test && integrator.method == Method::radau) estimate_.start(t, S_, Sdot_);
  step_.resize(0, size(), false);
  if (options_.error_test && integrator.method == Method::bdf) estimate_of_bdf_.resize(size(), size(), false);
}

// ---- Checkpoints -----------------------------------------------------------------------------------------------

void Sensitivities::archive(Archive& archive, const Integrator& integrator) {
  archive.counts(work_.error_failures, work_.outputs);
  archive.real(work_.inconsistency);
  archive.reals(S_, size());
  archive.reals(Sdot_, size());
  archive_history(archive, integrator);
  system_->archive(archive);
}

// BDF: the points that the highest order needs; Radau: the stages of the last step.
void Sensitivities::archive_history(Archive& archive, const Integrator& integrator) {
  int s = method_ != nullptr ? method_->s : 0;
  archive.small(s);
  if (archive.is_reading()) {
    const bool is_radau = integrator.method == Method::radau;
    if (s != 0 && (!is_radau || s < 0 || s > max_stages || s % 2 == 0)) throw DamagedArchive();
    method_ = s != 0 ? &radau_method(s).stages : nullptr;
    step_.resize(0, size(), false);
    if (options_.error_test && !is_radau) estimate_of_bdf_.resize(size(), size(), false);
  }
  if (integrator.method == Method::bdf) {
    int order = 0;
    const int points = history_.archive_size(archive, {0, size()}, max_bdf_order + 3, order);
    history_.archive_points(archive, points);
    return;
  }
  if (s != 0) {
    archive.reals(before_, size());
    archive.reals(stages_, size() * index(s));
  }
  // If the error test is only requested after restoring, it begins with the next step.
  bool has_estimate = estimate_.has_started();
  archive.small(has_estimate);
  if (has_estimate) estimate_.archive(archive, size());
  if (!has_estimate || !options_.error_test) estimate_.forget();
}

// ---- Steps -----------------------------------------------------------------------------------------------------

StepOutcome Sensitivities::attempt(Integrator& integrator, const Tolerances& tolerances) {
  Stepper& stepper = *integrator.stepper;
  step_tried_ = stepper.tried();
  StepOutcome outcome;
  try {
    outcome = solve_tried();
    if (outcome == StepOutcome::accepted && options_.error_test) outcome = test_error(integrator, tolerances);
  } catch (...) {
    // The next call repeats this step.
    stepper.withdraw();
    stepper.set_next_step(step_tried_.h);
    throw;
  }
  // The stepper has already handled errors of S like those of x.
  const bool is_judged = outcome == StepOutcome::accepted || outcome == StepOutcome::error_too_large;
  if (!is_judged) stepper.withdraw();
  return outcome;
}

StepOutcome Sensitivities::solve_tried() {
  const PointStatus status = step_tried_.method != nullptr ? solve_radau(step_tried_) : solve_bdf(step_tried_);
  if (status == PointStatus::callback_error && !system_->callback_error().is_recoverable())
    system_->callback_error().raise();
  if (const auto failure = failed_outcome(status)) return *failure;
  return all_finite(tried_.data(), tried_.size()) ? StepOutcome::accepted : StepOutcome::not_finite;
}

// Usually these are those of the last step.
void Sensitivities::set_weights(const Tolerances& tolerances, Tightening tightening) {
  if (tolerances == tolerances_ && tightening == tightening_) return;
  tolerances_ = {};  // in case memory is missing
  for (std::size_t j = 0; j < weights_.size(); ++j) {
    Tolerances scaled = tolerances;
    scaled.atol = tolerances.atol.mapped([scale = options_.scales[j]](double atol) { return atol / scale; });
    weights_[j].set(scaled, tightening);
  }
  tightening_ = tightening;
  tolerances_ = tolerances;
}

StepOutcome Sensitivities::test_error(Integrator& integrator, const Tolerances& tolerances) {
  set_weights(tolerances, integrator.stepper->tightening());
  const StepOutcome outcome =
      step_tried_.method != nullptr ? test_error_of_radau(integrator) : test_error_of_bdf(integrator);
  if (outcome != StepOutcome::accepted) ++work_.error_failures;
  return outcome;
}

// As if x had these errors, for the next step as well; without differential equations there are none.
StepOutcome Sensitivities::test_error_of_radau(Integrator& integrator) {
  if (integrator.system.differential() == 0) return StepOutcome::accepted;
  const RadauMethod& method = radau_method(step_tried_.method->s);
  const SensitivityErrorEstimate::Step step{method, step_tried_.h, step_tried_.forgets_past, stages_};
  if (!estimate_.has_started()) estimate_.start_within(step, integrator.stepper->state().t, S_);
  const ErrorTerms terms = estimate_.estimate(*system_, step, weights_);
  return integrator.stepper->test_beside(integrator.system, terms);
}

// The larger local terms determine the order, too.
StepOutcome Sensitivities::test_error_of_bdf(Integrator& integrator) {
  if (integrator.system.differential() == 0) return StepOutcome::accepted;
  const std::size_t n = index(unknowns());
  for (std::size_t j = 0; j < weights_.size(); ++j) weights_[j].update(tried_.data() + j * n);
  step_.w = tried_;
  Stepper& stepper = *integrator.stepper;
  ErrorOfS errors(*system_, weights_);
  LocalTerms terms;
  const double error = estimate_of_bdf_.estimate(errors, history_, {step_, stepper.judges_higher_order()}, terms);
  return stepper.test_beside(terms, error);
}

PointStatus Sensitivities::solve_bdf(const TriedStep& tried) {
  if (history_.is_at_start()) history_.place_fictitious_point(tried.h);
  step_.t = tried.t;
  step_.h = tried.h;
  step_.order = tried.order;
  if (options_.error_test) {
    history_.compute_differences(std::min(history_.points(), tried.order + 3), false);
    step_.set_formula(history_, false, false);
  } else {
    step_.c = history_.formula_by_points(tried.t, tried.order, step_.w.data(), step_.w_rest.data());
  }
  discretized_slope(tried, 0, xdot_);
  std::copy_n(step_.w.data(), size(), tried_.data());
  return system_->solve_step(step_.c, step_.w_rest.data(), xdot_.data(), tried_.data());
}

PointStatus Sensitivities::solve_radau(const TriedStep& tried) {
  const StageMethod& method = *tried.method;
  stages_.resize(size() * index(method.s));
  PointStatus status = PointStatus::ok;
  for (int i = 0; i < method.s && status == PointStatus::ok; ++i) {
    discretized_slope(tried, i, xdot_);
    status = system_->keep_stage_of_step(method, i, xdot_.data());
  }
  if (status == PointStatus::ok) status = system_->solve_kept_stages(method, tried.h, S_.data(), stages_.data());
  if (status == PointStatus::ok) std::copy_n(stages_.data() + size() * index(method.s - 1), size(), tried_.data());
  return status;
}

void Sensitivities::commit(Integrator& integrator) {
  work_.inconsistency = std::max(work_.inconsistency, system_->inconsistency());
  before_ = S_;
  S_ = tried_;
  method_ = step_tried_.method;
  if (method_ == nullptr) history_.append(step_tried_.t, tried_, {});
  else if (options_.error_test && integrator.system.differential() > 0) estimate_.append();
}

// ---- Points ----------------------------------------------------------------------------------------------------

void Sensitivities::copy_last(double* S) {
  ++work_.outputs;
  std::copy(S_.begin(), S_.end(), S);
}

bool Sensitivities::needs_stages(const Integrator& integrator, double t) const {
  return method_ != nullptr && t != integrator.stepper->state().t;
}

void Sensitivities::evaluate(const Integrator& integrator, double t, double* S, double* Sdot) {
  const StepState state = integrator.stepper->state();
  ++work_.outputs;
  tried_ = S_;
  slopes_ = Sdot_;
  if (method_ == nullptr && state.last.order > 0) {
    const int degree = std::min(state.last.order, history_.points() - 1);
    history_.compute_differences(degree + 1, false);
    history_.polynomial_w(degree).evaluate(t, tried_.data(), slopes_.data());
  } else if (method_ != nullptr) {
    // The slope of the collocation polynomial at the end of the step.
    const int s = method_->s;
    std::fill(slopes_.begin(), slopes_.end(), 0.0);
    for (int j = 0; j < s; ++j)
      for (std::size_t i = 0; i < size(); ++i)
        slopes_[i] += method_->D_at(s - 1, j) / state.last.h * (stages_[size() * index(j) + i] - before_[i]);
  }
  demand(system_->restore(tried_.data(), error_.data()), t);
  if (Sdot != nullptr) {
    demand(system_->derivative(error_.data(), slopes_.data()), t);
    std::copy(slopes_.begin(), slopes_.end(), Sdot);
  }
  std::copy(error_.begin(), error_.end(), S);
}

void Sensitivities::finish_stages(double t, double h, double* S, double* Sdot) {
  ++work_.outputs;
  const StageMethod& method = *method_;
  Vector within(size() * index(method.s));
  demand(system_->solve_kept_stages(method, h, before_.data(), within.data()), t);
  const double* const end = within.data() + size() * index(method.s - 1);
  if (Sdot != nullptr) {
    std::fill(slopes_.begin(), slopes_.end(), 0.0);
    for (int j = 0; j < method.s; ++j)
      for (std::size_t i = 0; i < size(); ++i)
        slopes_[i] += method.D_at(method.s - 1, j) / h * (within[size() * index(j) + i] - before_[i]);
    demand(system_->derivative(end, slopes_.data()), t);
    std::copy(slopes_.begin(), slopes_.end(), Sdot);
  }
  std::copy_n(end, size(), S);
}

}  // namespace sfdae::core
