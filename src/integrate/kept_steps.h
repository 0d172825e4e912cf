// Steps that are kept for the adjoint of an integration (discrete_adjoint.h).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "integrate/step_control.h"
#include "integrate/stepper.h"
#include "system/adjoint_system.h"

namespace sfdae::core {

// What leads to a point from those before.
struct KeptStep {
  double t = 0.0, h = 0.0;  // its end; its size
  int order = 0;            // of BDF; 0: none, or Radau
  double c = 0.0;           // D_h S = c S + sum_i rest_i S_i, the newest point before first
  std::array<double, max_bdf_order + 1> rest{};
  const StageMethod* method = nullptr;  // of Radau
  // A point within the last step, at the end of all: of BDF S = sum_i rest_i S_i over order + 1 points, its
  // differential part at least; of Radau a step from where the last one began.
  bool is_within = false;
  std::size_t first_kept = 0;  // of its points

  bool is_interpolated() const { return is_within && method == nullptr; }
  int num_points() const { return method != nullptr ? method->s : is_within ? 0 : 1; }
  // How many points before it says something about, and those that are newer than these.
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
  // Of all that the points are: steps that are made again have to agree in every bit.
  std::uint64_t fingerprint() const { return hash_.value(); }

  // For one more; nothing fails in add() then.
  void make_room();
  void add(const KeptStep& step, std::vector<KeptPoint>& points);
  void drop();

 private:
  std::vector<KeptStep> steps_;
  std::vector<KeptPoint> points_;
  std::size_t bytes_ = 0;
  WordHash hash_;
};

// Of a step that was tried: `newest`: the time of the point before, those of earlier ones in front of it, as many as
// the history has. Throws Failure.
KeptStep formula_of(const TriedStep& tried, const double* newest, std::size_t points);
// Of a point at t within the last step of BDF; newest: the time of its end.
KeptStep interpolation_at(double t, int degree, const double* newest);
// A point with x alone.
KeptPoint with_values_alone(const KeptPoint& point);
std::size_t bytes_of(const KeptPoint& point);
// Its points, one or all stages. xdot: n values, changed.
void keep_points(const PointKeeper& keeper, const TriedStep& tried, std::vector<double>& xdot,
                 std::vector<KeptPoint>& points);

}  // namespace sfdae::core
