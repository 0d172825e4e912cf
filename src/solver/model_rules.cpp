// SPDX-License-Identifier: BSD-3-Clause
#include "solver/model_rules.h"

#include <algorithm>
#include <utility>

#include "linalg/index.h"
#include "solver/solver.h"

namespace sfdae::core {

namespace {

// Options for initial values do not apply here.
ModelOptions plain(const ModelOptions& given) {
  ModelOptions options = given;
  options.consistency = ConsistencyRequest();
  return options;
}

ModelOptions keeping_differentiated(const ModelOptions& given) {
  ModelOptions options = plain(given);
  options.consistency.keeps_differentiated = true;
  return options;
}

}  // namespace

ConsistentPoint JumpsOfModel::values_after(const PointOfInterest& before) {
  FormulatedModel& model = solver_.model;
  const ModelOptions& options = solver_.options.model;
  Jump jump = model.whole().jump(before, options);
  ConsistentPoint after = model.consistent_point({before.t, before.toward, jump.x.data()}, options);
  const std::size_t n = index(model.n());
  Crossed crossed{before.t, {before.x, before.x + n}, after.x, std::vector<double>(n, 0.0)};
  if (jump.impulses.cols() > 0) std::copy_n(jump.impulses.data(), n, crossed.impulse.begin());
  last_ = std::move(crossed);
  return after;
}

ConsistentPoint JumpsOfModel::values_near(const PointOfInterest& before) {
  return solver_.model.consistent_point(before, keeping_differentiated(solver_.options.model));
}

bool JumpsOfModel::differentiate(const MovingJump& jump, View after) {
  return solver_.model.differentiate_jump(jump, solver_.options.model, after);
}

ConsistentPoint JumpsOfModel::values_before(const PointOfInterest& before) {
  return solver_.model.consistent_point_beside(before, keeping_differentiated(solver_.options.model));
}

ModelOptions ContinuationOfModel::options() const { return plain(solver_.options.model); }

ConsistentPoint ContinuationOfModel::look_at(const PointOfInterest& point) {
  return solver_.model.consistent_point_beside(point, options());
}

ConsistentPoint ContinuationOfModel::move_to(const PointOfInterest& point) {
  return solver_.model.consistent_point(point, options());
}

}  // namespace sfdae::core
