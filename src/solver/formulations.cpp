// All models that can solve one problem.
// SPDX-License-Identifier: BSD-3-Clause
#include "solver/formulations.h"

#include <utility>

#include "problem/callback_equations.h"

namespace sfdae::core {

Formulations::Formulations(std::unique_ptr<LinearModel> model) : linear(model.get()) {
  own = std::move(model);
  LinearProblem& problem = linear->problem();
  if (own->m() != own->n() || !problem.prescribed().empty()) return;
  if (TaylorEvaluator* const evaluator = own->evaluator()) {
    auto recorded = std::make_unique<RecordedProblem>(*evaluator);
    recorded->set_equation_names(problem.equation_names());
    set_equations(std::move(recorded));
  } else if (problem.patterns()) {
    set_equations(opaque_problem(std::make_shared<LinearEquations>(problem), own->m(), *problem.patterns(),
                                 problem.equation_names()));
  }
}

Formulations::Formulations(std::unique_ptr<NonlinearModel> model) : nonlinear(model.get()) {
  own = std::move(model);
  const NonlinearProblem& problem = nonlinear->problem();
  if (own->m() != own->n() || problem.counts_are_given() || !problem.prescribed().empty()) return;
  if (RecordedProblem* const recorded = nonlinear->recorded()) {
    set_equations(*recorded);
  } else if (CallbackProblem& callback = *nonlinear->callback(); callback.patterns()) {
    set_equations(opaque_problem(std::make_shared<NonlinearEquations>(callback), own->m(), *callback.patterns(),
                                 callback.equation_names()));
    callback.follow(equations);
  }
}

Formulations::Formulations(std::unique_ptr<MultibodyModel> model) : multibody(model.get()) { own = std::move(model); }

void Formulations::set_equations(RecordedProblem& its_equations) {
  equations = &its_equations;
  extension = std::make_unique<ExtensionModel>(its_equations, own->problem());
}

void Formulations::set_equations(std::unique_ptr<RecordedProblem> its_equations) {
  owned_equations = std::move(its_equations);
  set_equations(*owned_equations);
  owned_equations->stop_with(own->problem());
}

bool Formulations::make_extension() {
  if (equations == nullptr && has_structure()) set_equations(multibody->recorded_first_order_problem());
  return equations != nullptr && equations->structure() != nullptr;
}

void Formulations::make_array() {
  if (array) return;
  std::unique_ptr<RecordedProblem> its_equations;
  if (multibody != nullptr) {
    its_equations = multibody->recorded_first_order_problem();
  } else {
    its_equations = std::make_unique<RecordedProblem>(equations->evaluator());
    its_equations->set_equation_names(own->problem().equation_names());
  }
  auto model = std::make_unique<NonlinearModel>(std::move(its_equations));
  model->problem().stop_with(own->problem());
  array = std::move(model);
}

}  // namespace sfdae::core
