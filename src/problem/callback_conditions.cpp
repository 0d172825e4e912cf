// Conditions that a user declares for functions.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/callback_conditions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "expression/condition_functions.h"
#include "expression/opaque_record.h"
#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::core {

namespace {

// Increments of central differences, relative: near eps^(1/3), where the errors of truncation and rounding are equal.
const double increment = std::cbrt(std::numeric_limits<double>::epsilon());

double increment_of(double value) { return increment * std::max(std::fabs(value), 1.0); }

ColumnPattern full_columns(int rows, int columns) {
  ColumnPattern pattern;
  pattern.start.clear();
  for (int j = 0; j <= columns; ++j) pattern.start.push_back(rows * j);
  for (int j = 0; j < columns; ++j)
    for (int i = 0; i < rows; ++i) pattern.row.push_back(i);
  return pattern;
}

std::shared_ptr<const Record> record_of(int count, int n) {
  const ColumnPattern all = full_columns(count, n);
  std::vector<std::string> names;
  for (int k = 0; k < count; ++k) names.push_back("condition " + std::to_string(k) + " of the callbacks");
  return std::make_shared<const Record>(opaque_conditions(count, {all, all}, names));
}

}  // namespace

ConditionSource::ConditionSource(const DeclaredConditions& declared, int num_unknowns)
    : declared_(declared), n_(index(num_unknowns)) {}

void ConditionSource::set_targets(const Tape& tape) {
  for (std::size_t k = 0; k < index(declared_.count); ++k)
    for (std::size_t e = tape.first_target[k]; e < tape.first_target[k + 1]; ++e) {
      const Tape::Variable& leaf = tape.targets[e];
      targets_.push_back({k, index(leaf.unknown) + (leaf.derivative ? n_ : 0)});
    }
}

CallbackError ConditionSource::call(double t, const double* x, const double* xdot, double* g) {
  std::fill_n(g, declared_.count, 0.0);
  CallbackError error;
  error.function = "conditions";
  error.t = t;
  error.code = declared_.function(t, x, xdot, g, declared_.user);
  if (error.code != 0) error.status = error.code < 0 ? SFDAE_CALLBACK_STOPPED : SFDAE_CALLBACK_FAILED;
  else if (!all_finite(g, index(declared_.count))) error.status = SFDAE_NOT_FINITE;
  return error;
}

bool ConditionSource::values(double t, const double* jet, int order, double* g) {
  if (order > 1 || call(t, jet, jet + n_, g).status != SFDAE_OK) return false;
  return order < 1 || find_derivative(t, jet, g + declared_.count);
}

// Derivative of g along the jet.
bool ConditionSource::find_derivative(double t, const double* jet, double* g_1) {
  double step = increment_of(t);
  for (std::size_t j = 0; j < n_; ++j)
    if (jet[n_ + j] != 0.0) step = std::min(step, increment_of(jet[j]) / std::fabs(jet[n_ + j]));
  std::vector<double> moved(2 * n_), below(index(declared_.count));
  const auto call_at = [&](double s, double* g) {
    for (std::size_t j = 0; j < n_; ++j) {
      moved[j] = jet[j] + s * (jet[n_ + j] + s * jet[2 * n_ + j]);
      moved[n_ + j] = jet[n_ + j] + 2.0 * s * jet[2 * n_ + j];
    }
    return call(t + s, moved.data(), moved.data() + n_, g).status == SFDAE_OK;
  };
  if (!call_at(-step, below.data()) || !call_at(step, g_1)) return false;
  for (std::size_t k = 0; k < below.size(); ++k) g_1[k] = (g_1[k] - below[k]) / (2.0 * step);
  return true;
}

bool ConditionSource::entries(double t, const double* jet, int order, const std::vector<int>& limits,
                              double* values) {
  if (order > 0) return false;
  const std::size_t count = index(declared_.count);
  std::vector<double> point(jet, jet + 2 * n_), below(count), above(count), columns(count * 2 * n_);
  for (std::size_t j = 0; j < 2 * n_; ++j) {
    const double step = increment_of(jet[j]);
    point[j] = jet[j] - step;
    if (call(t, point.data(), point.data() + n_, below.data()).status != SFDAE_OK) return false;
    point[j] = jet[j] + step;
    if (call(t, point.data(), point.data() + n_, above.data()).status != SFDAE_OK) return false;
    point[j] = jet[j];
    for (std::size_t k = 0; k < count; ++k) columns[j * count + k] = (above[k] - below[k]) / (2.0 * step);
  }
  for (std::size_t e = 0; e < targets_.size(); ++e)
    if (limits[targets_[e].condition] >= 0) values[e] = columns[targets_[e].column * count + targets_[e].condition];
  return true;
}

CallbackConditions::CallbackConditions(const DeclaredConditions& declared, int num_unknowns)
    : declared_(declared),
      n_(index(num_unknowns)),
      source_(std::make_shared<ConditionSource>(declared, num_unknowns)),
      evaluator_(record_of(declared.count, num_unknowns), source_),
      g_(index(declared.count)) {
  source_->set_targets(evaluator_.tape());
}

CallbackError CallbackConditions::choose(double t, const double* point) {
  if (kept_ > 0) return {};
  const auto held = [this](int k) { return evaluator_.parameter(k); };
  if (held(0) == 0.0) {
    CallbackError error = source_->call(t, point, point + n_, g_.data());
    if (error.status != SFDAE_OK) return error;
    for (int k = 0; k < declared_.count; ++k) declared_.branches[k] = is_met(g_[index(k)]) ? 1 : 0;
    return {};
  }
  for (int k = 0; k < declared_.count; ++k) declared_.branches[k] = is_met(held(k)) ? 1 : 0;
  return {};
}

}  // namespace sfdae::core
