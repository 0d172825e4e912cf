// Equation sections, when clauses and algorithm sections of a model become scalar equations and actions.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "modelica/elaboration.h"

namespace sfdae::cli {

void expand_equations(Elaboration& e, const Environment& in, const std::vector<syntax::Statement>& body,
                      std::vector<Equation>& equations);

// An algorithm section: one equation for each scalar that it assigns.
void expand_algorithm(Elaboration& e, const Environment& in, const std::vector<syntax::Statement>& body,
                      std::vector<Equation>& equations);

// left = right, scalar by scalar.
void append_equalities(Elaboration& e, const Value& left, const Value& right, Location at,
                       std::vector<Equation>& equations);

// When clauses.
std::vector<Expression> evaluate_when_conditions(Elaboration& e, const Environment& in, const syntax::Expression& x);
When expand_when(Elaboration& e, const Environment& in, const syntax::Statement& statement);
// reinit(x, value), if the guards of `in` hold.
void append_reinit(Elaboration& e, const Environment& in, const syntax::Expression& call,
                   std::vector<Action>& actions);
Action evaluate_terminate(Elaboration& e, const Environment& in, const syntax::Expression& call);
// Turns assertions from functions called in actions into actions.
void append_assertions(const std::vector<Assertion>& assertions, std::vector<Action>& actions);
// Fails unless x is a variable that equations may determine.
int assigned_variable(const Elaboration& e, const Expression& x, Location at);

// Checks that need the whole model, and the direction of discrete equations.
void finish_model(Elaboration& e);

}  // namespace sfdae::cli
