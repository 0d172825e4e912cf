// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulation/text.h"

namespace sfdae::cli {

namespace {

// Relative rounding error of computed values.
constexpr double rounding_of_values = 1e-12;

// Warns of a constant, a parameter or a constant input outside of its limits.
void check_bounds(const FlatModel& model, const Variable& variable, double value, double min, double max,
                  std::vector<std::string>& warnings) {
  const auto tolerance = [&](double bound) {
    return std::isfinite(bound) ? rounding_of_values * std::max(std::fabs(value), std::fabs(bound)) : 0.0;
  };
  const bool is_low = value<min - tolerance(min), is_high = value> max + tolerance(max);
  if (!is_low && !is_high) return;
  const std::string kind = variable.variability == Variability::constant    ? "constant "
                           : variable.variability == Variability::parameter ? "parameter "
                                                                            : "";
  warnings.push_back(place(model, variable.at) + ": " + kind + variable.name + " is " + to_text(value) +
                     (is_low ? ", below min = " : ", above max = ") + to_text(is_low ? min : max));
}

}  // namespace

void add_bounds(System& system, const Parameters& parameters, Import& import, int variable,
                std::vector<std::string>& warnings) {
  const Variable& it = system.model.variables[at(variable)];
  if (it.type == Type::boolean || it.type == Type::enumeration || (!it.min && !it.max)) return;
  Formulas& formulas = system.formulas;
  const double inf = std::numeric_limits<double>::infinity();
  const Formula min = it.min ? import(it.min, Context::literal) : formulas.number(-inf),
                max = it.max ? import(it.max, Context::literal) : formulas.number(inf);
  if (parameters.is_known(variable) && formulas.is_number(min) && formulas.is_number(max))
    check_bounds(system.model, it, parameters.value(variable), formulas[min].value, formulas[max].value, warnings);
  else system.checked.push_back({variable, min, max});
}

}  // namespace sfdae::cli
