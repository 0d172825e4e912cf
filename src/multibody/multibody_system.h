// The strangeness-free system of a mechanical system with constraints, by minimal extension:
//
//     Q_q1^T (q' - S v) = 0,  Q_v1^T (v' - a(t, q, v)) = 0,  g(t, q) = 0,  C v + r = 0
//
// with accelerations a and forces of constraints mu of multibody_point.h. Q_q1 and Q_v1 are constant until the
// constraints have turned too far from them; as the integrators discretize q' and v' directly, W = I, a new choice does
// not affect their history. Stages are solved by a chord iteration in local coordinates (multibody_iteration.h), after
// which output points fulfil the constraints to machine precision (multibody_projection.h).
//
// [KM06] P. Kunkel, V. Mehrmann: Differential-Algebraic Equations: Analysis and Numerical Solution. EMS, 2006, sec.
// 6.4.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "multibody/multibody_equations.h"
#include "multibody/multibody_lanes.h"
#include "multibody/multibody_linearization.h"
#include "multibody/multibody_noise.h"
#include "multibody/multibody_partition_monitor.h"
#include "multibody/multibody_projection.h"
#include "multibody/multibody_ranks.h"
#include "multibody/multibody_stages.h"
#include "system/dae_system.h"

namespace sfdae::core {

class MultibodySystem final : public DaeSystem {
 public:
  // q and v are consistent. Throws Failure.
  MultibodySystem(MultibodyProblem& problem, const MultibodySettings& settings, IndexAnalysis analysis,
                  const double* q, const double* v);
  // Restores an archived system, ranks included. Throws DamagedArchive.
  MultibodySystem(MultibodyProblem& problem, const MultibodySettings& settings, Archive& archive);

  double t() const override { return t_; }
  const MultibodySettings& settings() const { return settings_; }

  // A consistent point becomes the current and accepted one.
  PointStatus set_point(double t, const double* q, const double* v);
  // The point accepted last.
  const MultibodyPoint& accepted_point() const { return accepted_; }
  // The partition of velocities, and how many have been chosen since set_point.
  const Partition& partition() const { return linearization_.form().velocities(); }
  const Partition& position_partition() const { return linearization_.form().positions(); }
  long partitions() const { return monitor_.count(); }

  PointStatus move_to(double t) override;
  void accept() override;
  void leading(const double* x, double* w) override { std::copy_n(x, leading_size(), w); }
  PointStatus solve(const StepEquations& equations, double* x) override;
  double stage_cost(int s) const override;
  void correct_slopes(double* wdot, double* xdot) override;
  PointStatus solve_stages(const StageEquations& equations, double* x, double* w, double& t_reached) override;
  using StrangenessFreeSystem::error_in_x;
  void error_in_x(const double* dw, int count, double* dx) override;
  // Throws Failure if no consistent x is found near x_free.
  using StrangenessFreeSystem::restore;
  void restore(const double* w, const double* x_free, const Guess& guess, double* x) override;
  void correct_derivative(double c, const double* x, double* xdot) override;

  PointQuality quality() const override {
    const double kept = projection_.smallest_pivot();
    return {projection_.inconsistency(), kept, 1.0, kept};
  }
  // q and v are known at points of the integration only, so that a change is located by steps that become short:
  // returns the values of the last change, whatever t is.
  CharacteristicValues values_at(double t) override;
  // Constraints that become singular within the longest step so far.
  std::optional<double> change_nearby() override;
  std::string inconsistency_message() const override {
    return projection_.inconsistency_message(equations_.problem(), t_);
  }
  std::string about_change() const override;
  // False if mu' is a difference of mu along the solution.
  bool consistent_derivative(const double* x, double direction, double* xdot) override;
  // Includes mu' along the solution by high-order differences, nearly as accurate as from additional derivatives.
  bool exact_derivative(const double* x, double* xdot) override;
  void leading_derivative(const double*, const double* xdot, double* wdot) override {
    std::copy_n(xdot, leading_size(), wdot);
  }
  // Flags positions and velocities.
  bool find_differentiated(char* flags) override {
    std::fill_n(flags, leading_size(), char{1});
    return true;
  }
  double change_of_differentiated(const double* dx, const double* tolerances) const override;
  SingularPart vanishing_part() const override { return SingularPart::constraints; }
  void archive(Archive& archive) override;

 private:
  void resize();
  PointStatus linearize(double t, const double* q, const double* v);
  PointStatus project(MultibodyPoint& point) {
    return projection_.project(point, equations_, linearization_.form(), arena_);
  }
  PointStatus solve_points(const MultibodyDiscretization& discretization, const Guess& guess);
  PointStatus iterate_from(const MultibodyDiscretization& discretization, const Guess& guess, bool linearizes);
  const MultibodyPoint& point_at(const double* x);
  void rebuild(const MultibodyPhasePoint& linearized, double c);

  MultibodySizes sizes_;
  MultibodySettings settings_;
  Arena arena_;
  double t_ = 0.0;

  MultibodyEquations equations_;
  MultibodyLinearization linearization_;
  MultibodyNoise noise_;
  MultibodyStages stages_;
  MultibodyLanes lanes_;
  MultibodyProjection projection_;
  PartitionMonitor monitor_;

  MultibodyPoint accepted_, end_;
  double longest_step_ = 0.0;
  bool is_end_new_ = false;  // end_ is that of a step, or a start, not accepted yet
};

}  // namespace sfdae::core
