// Reads flat (Base) Modelica, MCP-0031 of the Modelica Association, in the dialect that OpenModelica exports.
//
// Arrays and records become scalars with names such as a[1].b; for-equations, functions (with loops, conditions,
// recursion and several outputs) and algorithm sections are expanded. A branch of an if-equation is selected if its
// conditions depend only on constants and parameters, which then become structural; otherwise the branches are joined.
// Tables whose data are in the model become piecewise formulas. Clocks, delay and other external functions are not
// supported and are refused with their position.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "model/flat_model.h"

namespace sfdae::cli {

// Throws ModelError. file: its name, for messages.
FlatModel read_model(const std::string& text, const std::string& file);

// Throws ModelError, also if the file cannot be read.
FlatModel read_model_file(const std::string& path);

}  // namespace sfdae::cli
