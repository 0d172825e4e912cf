// Switches of hybrid systems: the equations along their surfaces, and where these hold.
// SPDX-License-Identifier: BSD-3-Clause
#include "c_api/sliding.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "c_api/expressions.h"
#include "c_api/hybrid.h"
#include "linalg/index.h"
#include "problem/sliding_equations.h"

namespace sfdae::core {

namespace {

// Of margins of a transition: what g may differ by and still be that of the surface.
constexpr double margins_of_surface = 16.0;
// Of the part of the mode above, times the largest of the others: squares of changes are below rounding. (Chosen.)
constexpr double free_weight = 1e8;

bool is_prescribed(const AnyModel& kind) {
  if (kind.linear != nullptr) return !kind.linear->problem().prescribed().empty();
  return kind.nonlinear != nullptr && !kind.nonlinear->recorded()->prescribed().empty();
}

// The equations of a mode as formulas, with the values that parameters have now.
TaylorEvaluator formulas_of(const sfdae_solver& solver, const char* which) {
  if (solver.model.evaluator() == nullptr)
    throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                  format("the equations of the mode %s are functions: sliding needs recorded ones.", which));
  if (is_prescribed(solver.kind))
    throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                  format("the mode %s has prescribed components: make them equations.", which));
  if (solver.kind.multibody != nullptr)
    return TaylorEvaluator(solver.kind.multibody->recorded_first_order_problem()->evaluator());
  return TaylorEvaluator(*solver.model.evaluator());
}

// Those of the mode below, and of the part of the mode above what the others have at best.
SolverOptions with_part(SolverOptions options, int n) {
  double tolerance = 1.0;
  for (const double rtol : options.model.tolerances.rtol.different())
    if (rtol > 0.0) tolerance = std::min(tolerance, rtol);
  if (tolerance == 1.0) tolerance = 1e-6;
  options.model.tolerances.rtol.push_back(tolerance);
  options.model.tolerances.atol.push_back(tolerance);
  if (!options.model.consistency.fixed.empty()) options.model.consistency.fixed.push_back(0);
  // Its changes, divided by their weight, count for nothing: it follows from the others.
  std::vector<double>& weights = options.model.consistency.weights;
  if (!weights.empty()) weights.push_back(free_weight * *std::max_element(weights.begin(), weights.end()));
  static_cast<Acceptance&>(options.integration) = options.model;
  options.integration.events = nullptr;
  options.integration.continuation = nullptr;
  options.integration.max_passed = 0;
  options.integration.recorded = n;
  return options;
}

CallResult no_surface(const HybridRun& run) {
  return {SFDAE_NOT_FINITE, format("the surface of a switch, or its rate, is NaN or Inf at t = %.10g.", run.t)};
}

// g and its rate with the values that a mode has at x of the run.
CallResult values_in(sfdae_hybrid& hybrid, int mode, Switch& surface, double* values) {
  HybridRun& run = hybrid.run;
  std::vector<double> x(run.x), xdot(run.xdot);
  CallResult result = with_analysis(hybrid, mode, run.x.data(), [&](sfdae_solver* solver) {
    int status = sfdae_jump(solver, run.t, toward_from(run), run.x.data(), x.data(), 0, nullptr);
    if (status >= 0) status = sfdae_make_consistent(solver, run.t, x.data(), xdot.data());
    return status;
  });
  if (result.status < 0) return result;
  return surface.evaluate(run.t, x.data(), xdot.data(), values) ? CallResult{} : no_surface(run);
}

}  // namespace

Switch::Switch(const Modes& its_modes, sfdae_solver& below, sfdae_solver& above,
               std::shared_ptr<const Record> surface)
    : modes_(its_modes), below_(below), above_(above), given_(std::move(surface)), jet_(3 * index(given_->n())) {
  update({});
}

std::vector<double> Switch::values_of_parameters() const {
  std::vector<double> values;
  for (const sfdae_solver* solver : {&below_, &above_}) {
    const TaylorEvaluator& evaluator = *solver->model.evaluator();
    for (int i = 0; i < evaluator.num_parameters(); ++i) values.push_back(evaluator.parameter(i));
  }
  return values;
}

bool Switch::is_outdated(const Names& wanted) const {
  return wanted != names_ || values_of_parameters() != parameters_;
}

void Switch::update(const Names& wanted) {
  const TaylorEvaluator below = formulas_of(below_, "below"), above = formulas_of(above_, "above");
  std::vector<double> parameters = values_of_parameters();
  Names names(wanted);
  const TaylorEvaluator given = surface_in_modes(given_, below, above);
  const KeptParameters kept(names, below, above, given);
  std::shared_ptr<const Record> surface = surface_of_modes(given, kept);
  AnyModel model = make_model(sliding_equations(below, above, *surface, kept));
  auto solver = std::make_shared<sfdae_solver>(std::move(model), with_part(below_.options, n()));
  auto evaluator = std::make_unique<TaylorEvaluator>(std::move(surface));
  std::vector<int> all(index(evaluator->num_parameters()));
  std::iota(all.begin(), all.end(), 0);
  auto by_parameters = std::make_unique<ParameterDerivatives>(*evaluator, all);
  // Nothing fails from here on.
  solver->hybrid = below_.hybrid;
  solver_ = std::move(solver);
  surface_ = std::move(evaluator);
  surface_by_parameters_ = std::move(by_parameters);
  parameters_.swap(parameters);
  names_.swap(names);
}

bool Switch::has_parameter(const std::string& name) const {
  const std::vector<Parameter>& list = given_->parameters();
  return std::any_of(list.begin(), list.end(), [&](const Parameter& parameter) { return parameter.name == name; });
}

std::vector<double> Switch::change_by(const Names& parameters, sfdae_event_function function, double t,
                                      const double* x) {
  std::vector<double> changes(parameters.size(), 0.0);
  const bool is_above = function == leaves_above;
  if (!is_above && function != leaves_below) return changes;
  std::fill(jet_.begin(), jet_.end(), 0.0);
  std::copy_n(x, index(n()), jet_.begin());
  const Matrix g_p = surface_by_parameters_->at(t, jet_.data());
  for (std::size_t j = 0; j < parameters.size(); ++j)
    if (const auto k = surface_->find_parameter(parameters[j])) changes[j] = is_above ? -g_p(0, *k) : g_p(0, *k);
  return changes;
}

void Switch::take_options() {
  SolverOptions options = with_part(below_.options, n());
  options.integration.events = solver_->options.integration.events;
  solver_->options = std::move(options);
  solver_->breakpoints->take_times(*below_.breakpoints);
  solver_->breakpoints->add_times(*above_.breakpoints);
  solver_->use_breakpoints(solver_->options.integration);
}

bool Switch::evaluate(double t, const double* x, const double* xdot, double* values) {
  const std::size_t count = index(n());
  std::fill(jet_.begin(), jet_.end(), 0.0);
  std::copy_n(x, count, jet_.begin());
  if (xdot != nullptr) std::copy_n(xdot, count, jet_.begin() + n());
  const int order = xdot != nullptr ? 1 : 0;
  if (!surface_->values(t, jet_.data(), order, values)) return false;
  return std::isfinite(values[0]) && (order == 0 || std::isfinite(values[1]));
}

int Switch::leaves_below(double t, const double* x, const double*, double* g, void* user) {
  return static_cast<Switch*>(user)->evaluate(t, x, nullptr, g) ? 0 : 1;
}

int Switch::leaves_above(double t, const double* x, const double*, double* g, void* user) {
  const bool is_there = static_cast<Switch*>(user)->evaluate(t, x, nullptr, g);
  *g = -*g;
  return is_there ? 0 : 1;
}

int Switch::part_is_negative(double, const double* x, const double*, double* g, void* user) {
  *g = -x[static_cast<const Switch*>(user)->n()];
  return 0;
}

int Switch::part_exceeds_one(double, const double* x, const double*, double* g, void* user) {
  *g = x[static_cast<const Switch*>(user)->n()] - 1.0;
  return 0;
}

sfdae_event_function Switch::condition(int k) {
  constexpr sfdae_event_function conditions[] = {leaves_below, leaves_above, part_is_negative, part_exceeds_one};
  return conditions[k];
}

CallResult choose_mode(sfdae_hybrid& hybrid, const HybridTransition& transition, int& to) {
  Switch& surface = *transition.surface;
  HybridRun& run = hybrid.run;
  if (transition.given.from == surface.modes().sliding) return {};
  double here[2] = {}, beyond[2] = {};
  if (!surface.evaluate(run.t, run.x.data(), run.xdot.data(), here)) return no_surface(run);
  const double near = margins_of_surface * transition.margin;
  if (std::fabs(here[0]) > near) return {};
  CallResult result = values_in(hybrid, to, surface, beyond);
  if (result.status < 0 || std::fabs(beyond[0] - here[0]) > near) return result;
  const double onward = transition.given.from == surface.modes().below ? run.direction() : -run.direction();
  if (!(here[1] * onward > 0.0 && beyond[1] * onward < 0.0)) return {};
  to = surface.modes().sliding;
  run.x.back() = onward * run.direction() > 0.0 ? here[1] / (here[1] - beyond[1]) : beyond[1] / (beyond[1] - here[1]);
  return {};
}

CallResult prepare_sliding(sfdae_hybrid& hybrid, int mode) {
  Switch* surface = hybrid.modes[index(mode)].surface;
  if (surface == nullptr) return {};
  HybridRun& run = hybrid.run;
  const Switch::Modes& modes = surface->modes();
  double below[2] = {}, above[2] = {};
  CallResult result = values_in(hybrid, modes.below, *surface, below);
  if (result.status >= 0) result = values_in(hybrid, modes.above, *surface, above);
  if (result.status < 0) return result;
  const double a = below[1] * run.direction(), b = above[1] * run.direction();
  if (!(a > 0.0 && b < 0.0))
    return {
        SFDAE_NO_CONSISTENT_VALUES,
        format(
            "%s: the modes do not lead to the surface from both sides: its function changes by %g per unit of time "
            "in %s, by %g in %s, in the direction of integration. Start in one of them.",
            hybrid.name_of(mode).c_str(), a, hybrid.name_of(modes.below).c_str(), b,
            hybrid.name_of(modes.above).c_str())};
  run.x.back() = a / (a - b);
  return {};
}

namespace {

const Switch::Names& names_wanted(const sfdae_hybrid& hybrid) {
  static const Switch::Names none;
  return hybrid.sensitivities ? hybrid.sensitivities->names : none;
}

}  // namespace

bool is_outdated(const sfdae_hybrid& hybrid, const Switch& surface) {
  return surface.is_outdated(names_wanted(hybrid));
}

CallResult update_switches(sfdae_hybrid& hybrid) {
  for (const std::unique_ptr<Switch>& each : hybrid.switches) {
    if (!is_outdated(hybrid, *each)) continue;
    const int mode = each->modes().sliding;
    try {
      each->update(names_wanted(hybrid));
    } catch (const Failure& failure) {
      return {failure.status(), hybrid.name_of(mode) + ": " + failure.what()};
    }
    hybrid.modes[index(mode)].solver = each->solver();
    // Until the new solver has its events nothing can go on.
    const bool were_set = std::exchange(hybrid.events_are_set, false);
    const int present = std::exchange(hybrid.run.mode, -1);
    CallResult result = set_events_of(hybrid, mode);
    if (result.status < 0) return result;
    hybrid.events_are_set = were_set;
    hybrid.run.mode = present;
  }
  const auto has_to_be_asked = [&](const std::unique_ptr<Switch>& each) {
    return each->solver()->sensitivities.has_value() != hybrid.sensitivities.has_value();
  };
  const bool is_any = std::any_of(hybrid.switches.begin(), hybrid.switches.end(), has_to_be_asked);
  return is_any ? ask_for_sensitivities(hybrid) : CallResult{};
}

void take_options_of_modes(sfdae_hybrid& hybrid, int mode) {
  if (Switch* surface = hybrid.modes[index(mode)].surface) surface->take_options();
}

}  // namespace sfdae::core

using namespace sfdae::core;

namespace {

CallResult check_switch(const sfdae_hybrid& hybrid, int below, int above, const char* name) {
  CallResult checked = check_mode(hybrid, "below", below);
  if (checked.status == SFDAE_OK) checked = check_mode(hybrid, "above", above);
  if (checked.status == SFDAE_OK) checked = check_name(hybrid, name);
  if (checked.status != SFDAE_OK) return checked;
  if (below == above) return illegal_argument(format("below = above = %d: they must be two modes.", below));
  for (const int mode : {below, above})
    if (hybrid.modes[index(mode)].surface != nullptr)
      return illegal_argument(hybrid.name_of(mode) + " is a sliding mode; switches are between modes of solvers.");
  return {};
}

// Nothing has changed if memory is missing.
void add_sliding(sfdae_hybrid& hybrid, std::unique_ptr<Switch> added, const char* name) {
  const Switch::Modes modes = added->modes();
  const std::size_t count = hybrid.transitions.size();
  hybrid.switches.reserve(hybrid.switches.size() + 1);
  hybrid.modes.push_back(
      {added->solver(), name != nullptr ? name : "", {}, {}, false, &hybrid.transitions, {}, 0, added.get()});
  try {
    const int from[] = {modes.below, modes.above, modes.sliding, modes.sliding};
    const int to[] = {modes.above, modes.below, modes.below, modes.above};
    for (int k = 0; k < 4; ++k) {
      sfdae_transition transition{};
      transition.size = sizeof transition;
      transition.from = from[k];
      transition.to = to[k];
      transition.kind = SFDAE_TRANSITION_CONDITION;
      transition.function = Switch::condition(k);
      transition.user = added.get();
      hybrid.transitions.push_back({transition, {}, 0.0, added.get()});
    }
  } catch (...) {
    while (hybrid.transitions.size() > count) hybrid.transitions.pop_back();
    hybrid.modes.pop_back();
    throw;
  }
  // Nothing fails from here on.
  hybrid.switches.push_back(std::move(added));
  hybrid.events_are_set = false;
  hybrid.run.mode = -1;
}

}  // namespace

extern "C" int sfdae_add_switch(sfdae_hybrid* hybrid, int below, int above, sfdae_equations_function surface,
                                void* user, const char* name, int* mode) {
  return guarded(hybrid, [&]() -> CallResult {
    const CallResult checked = check_switch(*hybrid, below, above, name);
    if (checked.status != SFDAE_OK) return checked;
    if (surface == nullptr) return illegal_argument("surface is NULL.");
    const int added = static_cast<int>(hybrid->modes.size());
    try {
      sfdae_solver &first = *hybrid->modes[index(below)].solver, &second = *hybrid->modes[index(above)].solver;
      std::shared_ptr<const Record> record =
          record_equations(surface, 1, hybrid->n(), user, EquationNames({"the surface of a switch"}));
      add_sliding(*hybrid,
                  std::make_unique<Switch>(Switch::Modes{below, above, added}, first, second, std::move(record)),
                  name);
    } catch (const Failure& failure) {
      return {failure.status(), failure.what()};
    }
    if (mode != nullptr) *mode = added;
    return {};
  });
}
