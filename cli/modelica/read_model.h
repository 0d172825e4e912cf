// Reads flat (Base) Modelica, MCP-0031 of the Modelica Association, in the dialect that OpenModelica exports.
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
