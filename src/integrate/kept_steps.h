// Stored steps for the adjoint of an integration (discrete_adjoint.h).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "integrate/step_control.h"
#include "integrate/stepper.h"
#include "system/adjoint_system.h"

namespace sfdae::core {

// Formula for a point from earlier points.
struct KeptStep {
  double t = 0.0, h = 0.0;  // its end; its size
  int order = 0;            // of BDF; 0: at a start, or Radau
  double c = 0.0;           // D_h S = c S + sum_i rest_i S_i, the newest point before first
  std::array<double, max_bdf_order + 1> rest{};
  const StageMethod* method = nullptr;  // of Radau
  // A point within the last step, after all steps. BDF: S = sum_i rest_i S_i over order + 1 points, at least for its
  // differential part; Radau: a step from the start of the last one.
  bool is_within = false;
  std::size_t first_kept = 0;  // index of the first of its points

  bool is_interpolated() const { return is_within && method == nullptr; }
  int num_points() const { return method != nullptr ? method->s : is_within ? 0 : 1; }
  // Number of earlier points in its formula, and of newer points that the formula skips.
  int num_before() const { return is_interpolated() ? order + 1 : order > 0 ? order : 1; }
  int num_skipped() const { return is_within && method != nullptr ? 1 : 0; }
};

class KeptSteps {
 public:
  std::size_t count() const { return steps_.size(); }
  const KeptStep& step(std::size_t i) const { return steps_[i]; }
  const KeptPoint* points(std::size_t i) const { return points_.data() + steps_[i].first_kept; }
  const KeptPoint& end(std::size_t i) const { return points(i)[steps_[i].num_points() - 1]; }
  std::size_t bytes() const { return bytes_; }
  // Hash of the points: repeated steps must agree bitwise.
  std::uint64_t fingerprint() const { return hash_.value(); }

  // Reserves memory for one more step; then add() cannot fail.
  void make_room();
  void add(const KeptStep& step, std::vector<KeptPoint>& points);
  void drop();

 private:
  std::vector<KeptStep> steps_;
  std::vector<KeptPoint> points_;
  std::size_t bytes_ = 0;
  WordHash hash_;
};

// Formula of a step that was tried. newest: the time of the point before, preceded in memory by the times of earlier
// points, as many as the history has. Throws Failure.
KeptStep formula_of(const TriedStep& tried, const double* newest, std::size_t points);
// Formula of a point at t within the last step of BDF; newest: time of the end of the step.
KeptStep interpolation_at(double t, int degree, const double* newest);
// A copy with x only.
KeptPoint with_values_alone(const KeptPoint& point);
std::size_t bytes_of(const KeptPoint& point);
// Stores the points of a step, one or all stages. xdot: work array, n values.
void keep_points(const PointKeeper& keeper, const TriedStep& tried, std::vector<double>& xdot,
                 std::vector<KeptPoint>& points);

}  // namespace sfdae::core
