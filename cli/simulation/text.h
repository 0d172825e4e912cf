// Expressions and positions of a model as text for messages.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "model/flat_model.h"
#include "simulation/formulas.h"

namespace sfdae::cli {

// In the syntax of the model; long texts are truncated.
std::string to_text(const Expression& expression, const FlatModel& model);

std::string to_text(const Formulas& formulas, Formula formula, const FlatModel& model);

// "file:line", or "file" if the line is unknown.
std::string place(const FlatModel& model, Location at);

std::string to_text(double number);  // 6 digits

}  // namespace sfdae::cli
