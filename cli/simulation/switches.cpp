// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/switches.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sfdae::cli {

namespace {

// Arguments below this part of their size are zero at an event, whose location and solution have rounding errors. A
// diode with an off conductance of 1e-6 S turns rounding errors of 1e-14 in currents into arguments of 1e-8; with
// 1e-10, a bridge switched on and off endlessly. A switch held wrongly is found after the next step.
constexpr double held = 1e-7;
// Limits above which an argument is nonzero on the solution, relative to its largest value and to the nominal size.
constexpr double clear_of_largest = 1e-13, clear_of_nominal = 1e-14;

double lower_bound(const Switch& it, double k) { return it.kind == Switch::Kind::floor || k > 0.0 ? k : k - 1.0; }
double upper_bound(const Switch& it, double k) { return it.kind == Switch::Kind::floor || k >= 0.0 ? k + 1.0 : k; }

}  // namespace

Switches::Switches(const System& system, double interval)
    : system_(system), rounding_(interval), arguments_(system.formulas) {
  passed_at_.assign(system.switches.size(), std::numeric_limits<double>::quiet_NaN());
  for (const Switch& it : system.switches) arguments_.add(it.g);
  for (const Switch& it : system.switches) arguments_.add(it.is_by_time ? it.offset : it.g);
  for (int s = 0; s < static_cast<int>(system.switches.size()); ++s) {
    const Switch& it = system.switches[at(s)];
    sizes_.push_back(it.nominal);
    if (!it.has_root) continue;
    needs_derivatives_ = needs_derivatives_ || system.formulas.depends(it.g, on_derivative);
    roots_.push_back({s, 0});
    if (it.kind != Switch::Kind::relation) roots_.push_back({s, 1});
  }
}

void Switches::forget_moved(Values& before, Values& after) {
  std::vector<double> arguments_before;
  arguments_.run(before);
  for (std::size_t s = 0; s < passed_at_.size(); ++s) arguments_before.push_back(arguments_[static_cast<int>(s)]);
  arguments_.run(after);
  for (std::size_t s = 0; s < passed_at_.size(); ++s)
    if (!(std::fabs(arguments_[static_cast<int>(s)] - arguments_before[s]) <= held * sizes_[s]))
      passed_at_[s] = std::numeric_limits<double>::quiet_NaN();
}

double Switches::literal(const Switch& it, double g) const {
  switch (it.kind) {
    case Switch::Kind::floor: return std::floor(g);
    case Switch::Kind::truncate: return std::trunc(g);
    default: return applied(it.operation, g, 0.0, 0.0);
  }
}

// The time at which a time switch leaves this value. A relation that has its value after the zero does not change.
std::optional<double> Switches::time_of_change(int number, double value) const {
  const Switch& it = system_.switches[at(number)];
  if (it.kind == Switch::Kind::relation && applied(it.operation, it.slope, 0.0, 0.0) == value) return std::nullopt;
  const double target = it.kind == Switch::Kind::relation ? 0.0
                        : it.slope > 0.0                  ? upper_bound(it, value)
                                                          : lower_bound(it, value);
  const double t = (target - offset(number)) / it.slope + 0.0;  // turns -0 into 0
  return std::isfinite(t) ? std::optional(t) : std::nullopt;
}

// The value of a time switch after t, independent of its present value. A change that is due by time_of_change() has
// happened: a switch that changed neither now nor later would remain wrong.
double Switches::value_after(int number, double t) const {
  const Switch& it = system_.switches[at(number)];
  const double after = t + rounding_.of(t, offset(number) / it.slope);
  const double value = literal(it, it.slope * after + offset(number));
  const std::optional<double> change = time_of_change(number, value);
  if (!change || *change > after) return value;
  if (it.kind == Switch::Kind::relation) return applied(it.operation, it.slope, 0.0, 0.0);
  return it.slope > 0.0 ? value + 1.0 : value - 1.0;
}

// Distance of the argument from the range in which the value holds; 0: it holds.
double Switches::outside(const Switch& it, double g, double value) const {
  if (literal(it, g) == value) return 0.0;
  if (it.kind == Switch::Kind::relation) return std::fabs(g);
  return std::max({lower_bound(it, value) - g, g - upper_bound(it, value), 0.0});
}

bool Switches::set_literally(Values& values) {
  if (system_.switches.empty()) return false;
  arguments_.run(values);
  bool has_changed = false;
  for (int s = 0; s < static_cast<int>(system_.switches.size()); ++s) {
    const Switch& it = system_.switches[at(s)];
    const double g = arguments_[s];
    if (std::isnan(g) && it.has_root) continue;
    const double value = std::isnan(g) ? g : literal(it, g);
    if (are_same(values.switches[at(s)], value)) continue;
    values.switches[at(s)] = value;
    has_changed = true;
  }
  return has_changed;
}

bool Switches::update(Values& values, bool only_first) {
  if (system_.switches.empty()) return false;
  arguments_.run(values);
  const int count = static_cast<int>(system_.switches.size());
  bool has_changed = false;
  for (int s = 0; s < count; ++s) {
    const Switch& it = system_.switches[at(s)];
    const double g = arguments_[s], value = values.switches[at(s)];
    const bool is_undefined = std::isnan(it.is_by_time ? offset(s) : g);
    if (is_undefined && it.has_root) continue;  // the integration ends there
    const double defined = it.is_by_time ? value_after(s, values.t) : literal(it, g);
    const double wanted = is_undefined ? std::numeric_limits<double>::quiet_NaN() : defined;
    const bool has_passed = passed_at_[at(s)] == values.t;
    // Arguments that are constant between events have no location errors.
    const double tolerance = has_passed && it.has_root ? held * sizes_[at(s)] : 0.0;
    if (are_same(wanted, value) || (!it.is_by_time && outside(it, g, value) < tolerance)) continue;
    set(s, wanted, values);
    has_changed = true;
    if (only_first) return true;
  }
  return has_changed;
}

void Switches::evaluate_roots(Values& values, double* g) {
  arguments_.run(values);
  for (std::size_t i = 0; i < roots_.size(); ++i) {
    const Switch& it = system_.switches[at(roots_[i].number)];
    g[i] = arguments_[roots_[i].number];
    if (it.kind == Switch::Kind::relation) continue;
    const double value = values.switches[at(roots_[i].number)];
    g[i] -= roots_[i].bound == 0 ? lower_bound(it, value) : upper_bound(it, value);
  }
}

void Switches::set(int number, double value, Values& values) {
  values.switches[at(number)] = value;
  passed_at_[at(number)] = values.t;
}

void Switches::pass(int root, int direction, Values& values) {
  const int number = roots_[at(root)].number;
  const Switch& it = system_.switches[at(number)];
  double value = values.switches[at(number)];
  if (it.kind == Switch::Kind::relation) value = applied(it.operation, direction, 0.0, 0.0);
  else if (roots_[at(root)].bound == 0 && direction < 0) value -= 1.0;
  else if (roots_[at(root)].bound == 1 && direction > 0) value += 1.0;
  set(number, value, values);
}

int Switches::contradiction(Values& values, bool is_solution, const std::vector<double>& at_start) {
  if (roots_.empty()) return -1;
  arguments_.run(values);
  for (const Root& root : roots_) {
    const int number = root.number;
    const Switch& it = system_.switches[at(number)];
    const double g = arguments_[number];
    if (std::isnan(g)) continue;
    double& size = sizes_[at(number)];
    if (is_solution && std::isfinite(g)) size = std::max(size, std::fabs(g));
    const double distance = outside(it, g, values.switches[at(number)]);
    const bool was_there = it.kind == Switch::Kind::relation && distance <= 2.0 * at_start[at(number)];
    if (!was_there && distance > clear_of_largest * size + clear_of_nominal * it.nominal) return number;
  }
  return -1;
}

std::vector<double> Switches::distances(Values& values) {
  std::vector<double> result(system_.switches.size(), 0.0);
  arguments_.run(values);
  for (std::size_t s = 0; s < result.size(); ++s)
    result[s] = outside(system_.switches[s], arguments_[static_cast<int>(s)], values.switches[s]);
  return result;
}

double Switches::wanted(Values& values, int number) {
  arguments_.run(values);
  return literal(system_.switches[at(number)], arguments_[number]);
}

std::optional<double> Switches::next_time(Values& values) {
  std::optional<double> next;
  if (system_.switches.empty()) return next;
  arguments_.run(values);
  for (int s = 0; s < static_cast<int>(system_.switches.size()); ++s) {
    if (!system_.switches[at(s)].is_by_time) continue;
    const std::optional<double> t = time_of_change(s, values.switches[at(s)]);
    if (t && (!next || *t < *next)) next = t;
  }
  return next;
}

}  // namespace sfdae::cli
