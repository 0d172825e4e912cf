// Continuation of a solver when both branches of a condition lead back to its zero.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "linalg/index.h"
#include "solver/solver.h"

namespace sfdae::core {

std::unique_ptr<RegularizedEquations> Solver::regularize(Regularization parts) {
  if (parts.is_empty()) return nullptr;
  if (equations_with_conditions() == nullptr) throw DamagedArchive();
  auto equations = std::make_unique<RegularizedEquations>(*equations_with_conditions(), std::move(parts), [this] {
    regularized->model().parameters_changed();
    if (integration) integration->parameters_changed();
  });
  return equations;
}

std::unique_ptr<RegularizedEquations> Solver::use(std::unique_ptr<RegularizedEquations> equations) {
  std::swap(regularized, equations);
  model.use_instead(regularized ? &regularized->model() : nullptr);
  use_breakpoints(options);
  return equations;
}

namespace {

// Statuses of integrations that end because branches cannot be held, or lead back to their zeros.
bool may_be_of_branches(int status) {
  return status == SFDAE_ZENO || status == SFDAE_STEP_TOO_SMALL || status == SFDAE_SINGULAR;
}

// Statuses of integrations that end at points where ranks of the equations differ from those nearby.
bool may_be_of_flat_equations(int status) {
  return may_be_of_branches(status) || status == SFDAE_CHARACTERISTICS_CHANGED || status == SFDAE_RANK_UNCLEAR;
}

// The shortest time in which slopes cross the width of a condition.
double time_across(const std::vector<RegularizedCondition>& sliding, HeldConditions& conditions, double t,
                   const ConsistentPoint& at) {
  std::vector<double> speeds(at.xdot);
  for (double& speed : speeds) speed = std::fabs(speed);
  const std::vector<double> rates = conditions.functions().resolution(t, at.x.data(), at.xdot.data(), speeds.data());
  double shortest = std::numeric_limits<double>::infinity();
  for (const RegularizedCondition& each : sliding)
    if (rates[each.condition] > 0.0) shortest = std::min(shortest, each.width / rates[each.condition]);
  return shortest;
}

}  // namespace

// Continues with additional terms in equations that are flat in an unknown.
bool Solver::goes_on_with_terms(double tout, const CallResult& result) {
  if (!may_be_of_flat_equations(result.status) || integration->adjoint() != nullptr) return false;
  TaylorEvaluator* const equations = regularized ? regularized->model().evaluator() : equations_with_conditions();
  if (equations == nullptr || equations->has_source()) return false;
  const LayerPoint at = integration->layer_point();
  const std::vector<FlatEquation> found = flat_equations(*equations, at.t, at.x, at.tolerances);
  if (found.empty()) return false;
  Regularization parts = regularized ? regularized->parts() : Regularization();
  parts.terms.insert(parts.terms.end(), found.begin(), found.end());
  try {
    start_regularized(tout, std::move(parts), {});
    return true;
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
    return false;
  }
}

bool Solver::goes_on_with_branches(double tout, CallResult& result) {
  // The last step may have led beyond tout, where the solution could not be evaluated.
  if ((tout - integration->stepper().state().t) * integration->direction() <= 0.0) return false;
  if (!integration->layers_fit()) return goes_on_with_layers(tout, result);
  const bool is_idle = integration->is_idle();
  if (goes_on_with_terms(tout, result)) return true;
  if (is_idle) {
    integration->go_on_idle();
    return true;
  }
  if (!may_be_of_branches(result.status) || integration->adjoint() != nullptr) return false;
  const bool can_be_held = regularized || !conditions || conditions->can_be_held();
  const bool lacks_branches = integration->lacks_branches();
  std::vector<RegularizedCondition> sliding;
  if (can_be_held) sliding = integration->sliding();
  const auto has_width = [](const RegularizedCondition& each) {
    return std::isfinite(each.width) && each.width > 0.0;
  };
  if (can_be_held && (sliding.empty() || !std::all_of(sliding.begin(), sliding.end(), has_width))) return false;
  try {
    Regularization parts = regularized ? regularized->parts() : Regularization();
    parts.rounds.push_back(sliding);
    // Each round adds a surface.
    if (parts.rounds.size() > conditions->count() + 1)
      throw Failure(SFDAE_ZENO, "conditions that are continuous by now still lead back to their zeros.");
    start_regularized(tout, std::move(parts), sliding);
    return true;
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
    if (lacks_branches) integration->go_on_without_branches();
    else if (result.status == SFDAE_ZENO)
      result.message +=
          std::string(" The motion along the surface between them has not been found: ") + failure.what();
    return lacks_branches;
  }
}

// Updates the surfaces along which x moves, or removes those that it has left.
bool Solver::goes_on_with_layers(double tout, CallResult& result) {
  try {
    Regularization parts = regularized->parts();
    parts.rounds = regularized->layers().fitting(parts.rounds, integration->layer_point());
    if (parts == regularized->parts()) return false;
    start_regularized(tout, std::move(parts), {});
    return true;
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
    result.message += std::string(" The motion along it has not been found: ") + failure.what();
    return false;
  }
}

// An exception leaves the integration unchanged.
void Solver::start_regularized(double tout, Regularization parts, const std::vector<RegularizedCondition>& sliding) {
  const Stepper& stepper = integration->stepper();
  const double t = stepper.state().t;
  const std::vector<double>& x = stepper.x();
  HeldConditions* const those_before = options.integration.conditions;
  const PointOfInterest point{t, tout, x.data()};
  std::vector<RankDecision> found_decisions;
  std::unique_ptr<RegularizedEquations> before = use(regularize(std::move(parts)));
  std::unique_ptr<Integration> ended;
  try {
    set_limits(integration->start(), integration->direction());
    (regularized ? regularized->model() : model).analyze(point, options.model, found_decisions);
    const ConsistentPoint found = jumps.values_near(point);
    auto next = std::make_unique<Integration>(*model.system(), model.change_watch(), options.integration,
                                              InitialPoint{t, tout, found.x, found.xdot});
    ended = std::exchange(integration, std::move(next));
    if (const Sensitivities* const carried = ended->sensitivities()) {
      SensitivityRequest request = *sensitivities;
      const std::vector<double>& S = carried->last();
      request.directions.assign(S.begin(), S.end());
      request.shifts.clear();
      carry_sensitivities(request, found, true);
    }
    const double last = std::fabs(ended->stepper().state().last.h);
    integration->continue_from(*ended, sliding.empty() ? last : time_across(sliding, *those_before, t, found));
  } catch (...) {
    if (ended) integration = std::move(ended);
    use(std::move(before));
    throw;
  }
  if (conditions) conditions->release();
  breakpoints->set_differentiations(system()->analysis().values.mu);
  decisions = KeptDecisions(found_decisions);
}

}  // namespace sfdae::core
