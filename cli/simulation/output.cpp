// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/output.h"

#include <algorithm>
#include <cmath>

#include "simulation/text.h"

namespace sfdae::cli {

namespace {

// Violations of bounds by less than this, relative to the variable's size, are rounding and error of integration.
constexpr double bound_tolerance = 1e-6;

}  // namespace

Output::Output(const System& system, bool keeps_aliases, Discrete& discrete, Result& result)
    : system_(system),
      discrete_(discrete),
      result_(result),
      bounds_(system.formulas),
      is_outside_(system.checked.size(), 0) {
  for (const CheckedVariable& it : system.checked) {
    bounds_.add(it.min);
    bounds_.add(it.max);
  }
  for (int v = 0; v < static_cast<int>(system.model.variables.size()); ++v) {
    const Variable& variable = system.model.variables[at(v)];
    const bool is_parameter =
        variable.variability == Variability::constant || variable.variability == Variability::parameter;
    const bool is_discrete = variable.type != Type::real || variable.variability == Variability::discrete;
    const bool is_value = system.formulas.is_number(system.values[at(v)]);
    if ((is_parameter && is_value) || (variable.is_input && !is_value)) continue;
    if (!keeps_aliases && !is_parameter && !is_discrete && !system.is_unknown(v)) continue;
    columns_.push_back(v);
    Trajectory& trajectory = result.trajectory;
    trajectory.names.push_back(variable.name);
    trajectory.units.push_back(variable.unit);
    trajectory.descriptions.push_back(variable.description);
    trajectory.is_discrete.push_back(is_discrete || is_parameter);
  }
}

void Output::add(Values& values) {
  discrete_.complete(values);
  Trajectory& trajectory = result_.trajectory;
  trajectory.t.push_back(values.t);
  for (int v : columns_) trajectory.values.push_back(values.variable[at(v)] + 0.0);  // -0 becomes 0
  check_bounds(values);
}

void Output::check_bounds(const Values& values) {
  bounds_.evaluate(values);
  for (std::size_t i = 0; i < system_.checked.size(); ++i) {
    const CheckedVariable& it = system_.checked[i];
    const double value = values.variable[at(it.variable)];
    const double tolerance = bound_tolerance * (system_.nominal[at(it.variable)] + std::fabs(value));
    const double min = bounds_[2 * static_cast<int>(i)], max = bounds_[2 * static_cast<int>(i) + 1];
    if (is_outside_[i] != 0 || (value >= min - tolerance && value <= max + tolerance)) continue;
    is_outside_[i] = 1;
    const Variable& variable = system_.model.variables[at(it.variable)];
    const bool is_low = value < min;
    const bool is_parameter = variable.variability == Variability::parameter;
    result_.warnings.push_back(place(system_.model, variable.at) + (is_parameter ? ": parameter " : ": ") +
                               variable.name + " is " + to_text(value) + " at t = " + to_text(values.t) +
                               (is_low ? ", below min = " : ", above max = ") + to_text(is_low ? min : max));
  }
}

}  // namespace sfdae::cli
