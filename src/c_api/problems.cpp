// From the public structs of problems to models of the core.
// SPDX-License-Identifier: BSD-3-Clause
#include "c_api/problems.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "c_api/codes.h"
#include "c_api/expressions.h"
#include "c_api/record_multibody.h"
#include "extension/structured_model.h"

namespace sfdae::core {

namespace {

template <class AnyProblem>
PrescribedInputs inputs_of(const AnyProblem& problem) {
  const int count = problem.prescribed != nullptr ? problem.num_prescribed : 0;
  return {{problem.prescribed, problem.prescribed + count}, problem.prescribed_values, problem.user};
}

// given: `count` names, or null.
EquationNames names_of(const char* const* given, int count) {
  if (given == nullptr) return {};
  std::vector<std::string> names;
  for (int i = 0; i < count; ++i) names.emplace_back(given[i] != nullptr ? given[i] : "");
  return EquationNames(std::move(names));
}

// Empty where nothing is left out of any array.
std::vector<int> differentiations_of(const sfdae_nonlinear_problem& problem) {
  if (problem.differentiations == nullptr) return {};
  std::vector<int> counts(problem.differentiations, problem.differentiations + problem.num_equations);
  const bool has_all = *std::min_element(counts.begin(), counts.end()) == max_strangeness_index;
  return has_all ? std::vector<int>() : counts;
}

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

// Recorded equations, as many as unknowns, all of which may be differentiated and none of the unknowns of which are
// prescribed, are solved by their structure where that is of use.
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

}  // namespace

LinearFunctions functions_of(const sfdae_linear_problem& problem) {
  return {.m = problem.num_equations,
          .n = problem.num_unknowns,
          .E = problem.E,
          .A = problem.A,
          .f = problem.f,
          .user = problem.user,
          .constant_E = problem.constant_E != 0,
          .constant_A = problem.constant_A != 0,
          .inputs = inputs_of(problem),
          .names = names_of(problem.equation_names, problem.num_equations)};
}

AnyModel clone_of(const AnyModel& model) {
  if (model.linear != nullptr) return with_structure(any(model.linear->clone()));
  if (model.nonlinear != nullptr) return with_structure(any(model.nonlinear->clone()));
  return any(model.multibody->clone());
}

AnyModel make_model(const sfdae_linear_problem& problem) {
  return any(std::make_unique<LinearModel>(functions_of(problem)));
}

AnyModel make_model(const sfdae_nonlinear_problem& problem) {
  const int m = problem.num_equations, n = problem.num_unknowns;
  const std::vector<int> counts = differentiations_of(problem);
  const EquationNames names = names_of(problem.equation_names, m);
  const auto model_of = [&](auto nonlinear) {
    if (problem.differentiations != nullptr) nonlinear->set_differentiations(counts);
    nonlinear->set_equation_names(names);
    return any(std::make_unique<NonlinearModel>(std::move(nonlinear)));
  };
  if (problem.total_derivative != nullptr)
    return model_of(
        std::make_unique<CallbackProblem>(m, n, problem.total_derivative, problem.user, inputs_of(problem)));
  std::shared_ptr<const Record> record =
      problem.equations != nullptr ? record_equations(problem.equations, m, n, problem.user, names)
                                   : record_linear_equations(problem.linear_equations, m, n, problem.user, names);
  if (record->is_linear() && counts.empty())
    return with_structure(any(std::make_unique<LinearModel>(
        std::make_unique<RecordedLinearCoefficients>(std::move(record), inputs_of(problem)))));
  return with_structure(model_of(std::make_unique<RecordedProblem>(std::move(record), inputs_of(problem))));
}

AnyModel make_model(const sfdae_multibody_problem& problem) {
  const Coordinates coordinates = coordinates_of(problem.coordinates);
  const auto model_of = [&](auto multibody) {
    multibody->set_equation_names(
        names_of(problem.constraint_names, problem.num_constraints + problem.num_nonholonomic));
    return any(
        std::make_unique<StructuredMultibody>(std::make_unique<MultibodyModel>(std::move(multibody), coordinates)));
  };
  if (problem.equations != nullptr) return model_of(record_multibody(problem));
  return model_of(std::make_unique<CallbackMultibody>(problem));
}

}  // namespace sfdae::core
