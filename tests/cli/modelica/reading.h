// Helpers of the tests of the reader: models from short texts, values of formulas.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "modelica/read_model.h"

namespace sfdae::cli::testing {

// package 'M' with these definitions and a model 'M' of these declarations and sections.
std::string package(const std::string& definitions, const std::string& model);
FlatModel read(const std::string& definitions, const std::string& model);
FlatModel read_file(const std::string& name);

int index_of(const FlatModel& model, std::string_view name);
const Variable& variable(const FlatModel& model, std::string_view name);

// By name: x, der(x), pre(x), time.
using Values = std::map<std::string, double>;
// Parameters take the values of their bindings, else of their start values.
double value(const FlatModel& model, const Expression& e, const Values& values);

// The right side of the only equation whose left side is this variable.
Expression right_of(const FlatModel& model, const std::string& name);
// The value of that right side.
double solved(const FlatModel& model, const std::string& name, const Values& values = {});

// The message of the error; empty: none.
std::string error_of(const std::string& text);
// "line:column" at which the mark stands in a text.
std::string place(const std::string& text, const std::string& mark);

}  // namespace sfdae::cli::testing
