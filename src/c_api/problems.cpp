// Conversion of the public structs of problems to models of the core.
// SPDX-License-Identifier: BSD-3-Clause
#include "c_api/problems.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "c_api/codes.h"
#include "c_api/expressions.h"
#include "c_api/record_multibody.h"
#include "problem/linear_residuals.h"

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

// Empty if no array leaves out anything.
std::vector<int> differentiations_of(const sfdae_nonlinear_problem& problem) {
  if (problem.differentiations == nullptr) return {};
  std::vector<int> counts(problem.differentiations, problem.differentiations + problem.num_equations);
  const bool has_all = *std::min_element(counts.begin(), counts.end()) == max_strangeness_index;
  return has_all ? std::vector<int>() : counts;
}

JacobianForm form_of(int matrices) {
  return matrices == SFDAE_MATRICES_DENSE        ? JacobianForm::dense
         : matrices == SFDAE_MATRICES_COMPRESSED ? JacobianForm::compressed
                                                 : JacobianForm::differences;
}

// Null if there are no patterns.
std::shared_ptr<const JacobianPatterns> patterns_of(const GivenPattern& F_x, const GivenPattern& F_xdot, int n) {
  if (F_x.start == nullptr) return nullptr;
  return std::make_shared<const JacobianPatterns>(
      JacobianPatterns{column_pattern(F_x, n), column_pattern(F_xdot, n)});
}

}  // namespace

LinearFunctions functions_of(const sfdae_linear_problem& problem) {
  return {
      .m = problem.num_equations,
      .n = problem.num_unknowns,
      .E = problem.E,
      .A = problem.A,
      .f = problem.f,
      .user = problem.user,
      .constant_E = problem.constant_E != 0,
      .constant_A = problem.constant_A != 0,
      .inputs = inputs_of(problem),
      .names = names_of(problem.equation_names, problem.num_equations),
      .patterns = patterns_of({problem.A_entries, problem.A_col_start, problem.A_row_index},
                              {problem.E_entries, problem.E_col_start, problem.E_row_index}, problem.num_unknowns),
      .compressed = problem.matrices == SFDAE_MATRICES_COMPRESSED};
}

namespace {

template <class CallbackProblemStruct>
void add_conditions(const CallbackProblemStruct& problem, CallbackProblem& callback) {
  if (problem.num_conditions > 0)
    callback.set_conditions({problem.num_conditions, problem.conditions, problem.branches, problem.user});
}

// With branches that depend on x, equations are not linear.
std::unique_ptr<FormulatedModel> make_model_with_conditions(const sfdae_linear_problem& problem) {
  const LinearFunctions functions = functions_of(problem);
  auto residuals = std::make_shared<LinearResiduals>(functions);
  auto callback = std::make_unique<CallbackProblem>(functions.m, functions.n, LinearResiduals::evaluate,
                                                    residuals.get(), PrescribedInputs());
  callback->own_user(std::move(residuals));
  if (functions.patterns) callback->set_patterns(functions.patterns, JacobianForm::dense);
  add_conditions(problem, *callback);
  callback->set_equation_names(functions.names);
  return formulated(std::make_unique<NonlinearModel>(std::move(callback)));
}

std::unique_ptr<CallbackProblem> callback_problem(const sfdae_nonlinear_problem& problem) {
  const int m = problem.num_equations, n = problem.num_unknowns;
  if (problem.derivative_array == nullptr)
    return std::make_unique<CallbackProblem>(m, n, problem.total_derivative, problem.user, inputs_of(problem));
  return std::make_unique<CallbackProblem>(
      std::make_shared<DerivativeArrayFunction>(m, n, problem.derivative_array, problem.user), inputs_of(problem));
}

}  // namespace

std::unique_ptr<FormulatedModel> make_model(const sfdae_linear_problem& problem) {
  if (problem.num_conditions > 0) return make_model_with_conditions(problem);
  return formulated(std::make_unique<LinearModel>(functions_of(problem)));
}

std::unique_ptr<FormulatedModel> make_model(const sfdae_nonlinear_problem& problem) {
  const int m = problem.num_equations, n = problem.num_unknowns;
  const std::vector<int> counts = differentiations_of(problem);
  const EquationNames names = names_of(problem.equation_names, m);
  const auto model_of = [&](auto nonlinear) {
    if (problem.differentiations != nullptr) nonlinear->set_differentiations(counts);
    nonlinear->set_equation_names(names);
    return formulated(std::make_unique<NonlinearModel>(std::move(nonlinear)));
  };
  if (problem.total_derivative != nullptr || problem.derivative_array != nullptr) {
    auto callback = callback_problem(problem);
    const auto patterns =
        patterns_of({problem.F_x_entries, problem.F_x_col_start, problem.F_x_row_index},
                    {problem.F_xdot_entries, problem.F_xdot_col_start, problem.F_xdot_row_index}, n);
    if (patterns) callback->set_patterns(patterns, form_of(problem.matrices));
    else if (problem.matrices == SFDAE_MATRICES_DIFFERENCES) callback->take_differences();
    add_conditions(problem, *callback);
    return model_of(std::move(callback));
  }
  std::shared_ptr<const Record> record =
      problem.equations != nullptr ? record_equations(problem.equations, m, n, problem.user, names)
                                   : record_linear_equations(problem.linear_equations, m, n, problem.user, names);
  if (record->is_linear() && counts.empty())
    return formulated(std::make_unique<LinearModel>(
        std::make_unique<RecordedLinearCoefficients>(std::move(record), inputs_of(problem))));
  return model_of(std::make_unique<RecordedProblem>(std::move(record), inputs_of(problem)));
}

std::unique_ptr<FormulatedModel> make_model(const sfdae_multibody_problem& problem) {
  const Coordinates coordinates = coordinates_of(problem.coordinates);
  const auto model_of = [&](auto multibody) {
    multibody->set_equation_names(
        names_of(problem.constraint_names, problem.num_constraints + problem.num_nonholonomic));
    return formulated(std::make_unique<MultibodyModel>(std::move(multibody), coordinates));
  };
  if (problem.equations != nullptr) return model_of(record_multibody(problem));
  return model_of(std::make_unique<CallbackMultibody>(problem));
}

}  // namespace sfdae::core
