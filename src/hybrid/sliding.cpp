// Switches of hybrid systems: equations along their surfaces, and the conditions for leaving them.
// SPDX-License-Identifier: BSD-3-Clause
#include "hybrid/sliding.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "expression/fingerprint.h"
#include "linalg/archive.h"
#include "linalg/index.h"
#include "problem/sliding_equations.h"

namespace sfdae::core {

namespace {

// Weight of the part of the mode above, relative to the largest other one: its squared changes are below roundoff.
// (Chosen.)
constexpr double free_weight = 1e8;

bool is_prescribed(FormulatedModel& model) {
  if (model.linear() != nullptr) return !model.linear()->problem().prescribed().empty();
  return model.nonlinear() != nullptr && !model.nonlinear()->recorded()->prescribed().empty();
}

// The equations of a mode as formulas, with the present parameter values.
TaylorEvaluator formulas_of(const Solver& solver, const char* which) {
  if (solver.model.evaluator() == nullptr)
    refuse_argument(format("the equations of the mode %s are functions: sliding needs recorded ones.", which));
  if (is_prescribed(solver.model))
    refuse_argument(format("the mode %s has prescribed components: make them equations.", which));
  if (solver.model.multibody() != nullptr)
    return TaylorEvaluator(solver.model.multibody()->recorded_first_order_problem()->evaluator());
  return TaylorEvaluator(*solver.model.evaluator());
}

// Options of the mode below; the part of the mode above gets the smallest of its relative tolerances.
SolverOptions with_part(SolverOptions options, int n) {
  double tolerance = 1.0;
  for (const double rtol : options.model.tolerances.rtol.different())
    if (rtol > 0.0) tolerance = std::min(tolerance, rtol);
  if (tolerance == 1.0) tolerance = 1e-6;
  options.model.tolerances.rtol.push_back(tolerance);
  options.model.tolerances.atol.push_back(tolerance);
  if (!options.model.consistency.fixed.empty()) options.model.consistency.fixed.push_back(0);
  // Changes are divided by their weight, so those of the part are negligible: it follows from the others.
  std::vector<double>& weights = options.model.consistency.weights;
  if (!weights.empty()) weights.push_back(free_weight * *std::max_element(weights.begin(), weights.end()));
  static_cast<Acceptance&>(options.integration) = options.model;
  options.integration.events = nullptr;
  options.integration.continuation = nullptr;
  options.integration.max_passed = 0;
  options.integration.recorded = n;
  return options;
}

}  // namespace

Switch::Switch(const Modes& its_modes, Solver& below, Solver& above, std::shared_ptr<const Record> surface)
    : modes_(its_modes), below_(below), above_(above), given_(std::move(surface)), jet_(3 * index(given_->n())) {
  update({});
}

std::vector<double> Switch::values_of_parameters() const {
  std::vector<double> values;
  for (const Solver* solver : {&below_, &above_}) {
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
  std::unique_ptr<FormulatedModel> model = make_model(sliding_equations(below, above, *surface, kept));
  auto solver = std::make_shared<Solver>(std::move(model), with_part(below_.options, n()));
  auto evaluator = std::make_unique<TaylorEvaluator>(std::move(surface));
  std::vector<int> all(index(evaluator->num_parameters()));
  std::iota(all.begin(), all.end(), 0);
  auto by_parameters = std::make_unique<ParameterDerivatives>(*evaluator, all);
  // Nothing fails after this point.
  solver_ = std::move(solver);
  surface_ = std::move(evaluator);
  surface_by_parameters_ = std::move(by_parameters);
  parameters_.swap(parameters);
  names_.swap(names);
}

double Switch::hash_of_surface() const {
  WordHash hash;
  add_equations(*given_, hash);
  const TaylorEvaluator surface =
      surface_in_modes(given_, formulas_of(below_, "below"), formulas_of(above_, "above"));
  for (int i = 0; i < surface.num_parameters(); ++i) {
    const double value = surface.parameter(i);
    hash.add(&value, 1);
  }
  return hash.value_as_real();
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
  solver_->use_breakpoints(solver_->options);
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

}  // namespace sfdae::core
