// SPDX-License-Identifier: BSD-3-Clause
#include "solver/any_model.h"

#include <utility>

#include "extension/structured_model.h"
#include "problem/callback_equations.h"
#include "solver/status_of.h"

namespace sfdae::core {

AnyModel any(std::unique_ptr<LinearModel> model) {
  LinearModel* linear = model.get();
  return {.model = std::move(model), .linear = linear};
}

AnyModel any(std::unique_ptr<NonlinearModel> model) {
  NonlinearModel* nonlinear = model.get();
  return {.model = std::move(model), .nonlinear = nonlinear};
}

AnyModel any(std::unique_ptr<StructuredMultibody> model) {
  StructuredMultibody* multibody = model.get();
  return {.model = std::move(model), .multibody = multibody};
}

AnyModel with_structure(AnyModel any) {
  if (!any.model || any.model->evaluator() == nullptr || any.model->m() != any.model->n()) return any;
  RecordedProblem* problem = any.nonlinear != nullptr ? any.nonlinear->recorded() : nullptr;
  std::unique_ptr<RecordedProblem> owned;
  if (any.linear != nullptr) {
    if (!any.linear->problem().prescribed().empty()) return any;
    owned = std::make_unique<RecordedProblem>(*any.linear->evaluator());
    owned->set_equation_names(any.linear->problem().equation_names());
    problem = owned.get();
  }
  if (problem == nullptr || problem->counts_are_given() || !problem->prescribed().empty()) return any;
  any.model = std::make_unique<StructuredModel>(std::move(any.model), *problem, std::move(owned));
  return any;
}

namespace {

// Functions with patterns, the same way; they evaluate what the model of them does.
AnyModel with_opaque_structure(AnyModel any, std::shared_ptr<PatternedEquations> equations,
                               const JacobianPatterns& patterns) {
  const int m = any.model->m();
  const EquationNames names = any.model->problem().equation_names();
  std::unique_ptr<RecordedProblem> opaque = opaque_problem(std::move(equations), m, patterns, names);
  RecordedProblem& problem = *opaque;
  if (any.nonlinear != nullptr) any.nonlinear->callback()->follow(&problem);
  any.model = std::make_unique<StructuredModel>(std::move(any.model), problem, std::move(opaque));
  return any;
}

}  // namespace

AnyModel with_patterns(AnyModel any) {
  if (any.model->m() != any.model->n()) return any;
  if (any.linear != nullptr) {
    LinearProblem& problem = any.linear->problem();
    if (!problem.patterns() || !problem.prescribed().empty()) return any;
    const auto patterns = problem.patterns();
    return with_opaque_structure(std::move(any), std::make_shared<LinearEquations>(problem), *patterns);
  }
  CallbackProblem& problem = *any.nonlinear->callback();
  if (!problem.patterns() || problem.counts_are_given() || !problem.prescribed().empty()) return any;
  const auto patterns = problem.patterns();
  return with_opaque_structure(std::move(any), std::make_shared<NonlinearEquations>(problem), *patterns);
}

AnyModel clone_of(const AnyModel& model) {
  if (model.linear != nullptr) return with_structure(any(model.linear->clone()));
  if (model.nonlinear != nullptr) return with_structure(any(model.nonlinear->clone()));
  return any(model.multibody->clone());
}

AnyModel make_model(std::shared_ptr<const Record> record) {
  const EquationNames names = record->equation_names();
  if (record->is_linear())
    return with_structure(any(std::make_unique<LinearModel>(
        std::make_unique<RecordedLinearCoefficients>(std::move(record), PrescribedInputs{}))));
  auto problem = std::make_unique<RecordedProblem>(std::move(record), PrescribedInputs{});
  problem->set_equation_names(names);
  return with_structure(any(std::make_unique<NonlinearModel>(std::move(problem))));
}

void demand_structure(const Model& model, StructureUse wanted) {
  if (wanted != StructureUse::required || model.has_structure()) return;
  refuse_argument(
      "structure = SFDAE_STRUCTURE_REQUIRED is for recorded equations, as many as unknowns, without prescribed "
      "components and differentiations.");
}

}  // namespace sfdae::core
