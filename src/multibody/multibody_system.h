// The strangeness-free system of a mechanical system with constraints, by minimal extension:
//
//     Q_q1^T (q' - S v) = 0,  Q_v1^T (v' - a(t, q, v)) = 0,  g(t, q) = 0,  C v + r = 0
//
// with accelerations a and forces of constraints mu of multibody_point.h. Q_q1 and Q_v1 are constant until the
// constraints have turned too far from them; as the integrators discretize q' and v' as they are, W = I, a new choice
// does not touch what they know. Stages are solved by a chord iteration in local coordinates (multibody_form.h); a is
// exact in every iteration, and constraints hold to rounding at the points that are handed out.
//
// [KM06] P. Kunkel, V. Mehrmann: Differential-Algebraic Equations: Analysis and Numerical Solution. EMS, 2006, sec.
// 6.4.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "multibody/multibody_form.h"
#include "multibody/multibody_point.h"
#include "multibody/multibody_problem.h"
#include "system/chord_iteration.h"
#include "system/dae_system.h"
#include "system/step_matrix.h"

namespace sfdae::core {

// What characterizes a mechanical system at a point.
struct MultibodyRanks {
  int positions = 0;   // rank g_q
  int velocities = 0;  // rank C
  bool operator==(const MultibodyRanks&) const = default;
};
CharacteristicValues characteristic_values(const MultibodySizes& sizes, const MultibodyRanks& ranks);

class MultibodySystem final : public DaeSystem {
 public:
  struct Settings {
    MultibodyRanks ranks;
    Coordinates coordinates = Coordinates::orthogonal;
    double rank_tol = 0.0;  // by which the ranks were decided; 0: by rounding errors
  };
  // At consistent q and v. Throws Failure.
  MultibodySystem(MultibodyProblem& problem, const Settings& settings, IndexAnalysis analysis, const double* q,
                  const double* v);
  // As it was when it was archived, ranks included. Throws DamagedArchive.
  MultibodySystem(MultibodyProblem& problem, const Settings& settings, Archive& archive);

  MultibodyProblem& problem() { return problem_; }
  double t() const override { return t_; }
  const Settings& settings() const { return settings_; }
  const MultibodySizes& sizes() const { return sizes_; }

  // A consistent point becomes the current and accepted one.
  PointStatus set_point(double t, const double* q, const double* v);
  // The point accepted last.
  const MultibodyPoint& accepted_point() const { return accepted_; }
  long partitions() const { return partitions_; }
  // |C| |(C Q2)^-1| at the point accepted last, rows in units of their lengths; infinite if singular.
  double condition() const;
  // Largest residuals there, likewise.
  double position_residual() const;
  double velocity_residual() const;

  PointStatus move_to(double t) override;
  void accept() override;
  void leading(const double* x, double* w) override { std::copy_n(x, leading_size(), w); }
  PointStatus solve(const StepEquations& equations, double* x) override;
  double stage_cost(int s) const override;
  void correct_slopes(double* wdot, double* xdot) override;
  PointStatus solve_stages(const StageEquations& equations, double* x, double* w, double& t_reached) override;
  using StrangenessFreeSystem::error_in_x;
  void error_in_x(const double* dw, int count, double* dx) override;
  // Throws Failure where no consistent x is found near x_free.
  void restore(const double* w, const double* x_free, double* x) override;
  void correct_derivative(double c, const double* x, double* xdot) override;

  PointQuality quality() const override { return {inconsistency_, kept_, 1.0, kept_}; }
  // q and v are known at points of the integration only, so that a change is located by its steps becoming short:
  // the values where it was met last, whatever t is.
  CharacteristicValues values_at(double t) override;
  std::string inconsistency_message() const override;
  std::string about_change() const override;
  // False where mu' is a difference of mu along the solution.
  bool consistent_derivative(const double* x, double direction, double* xdot) override;
  // mu' along the solution by differences of high order, too: nearly as accurate as if it came from more derivatives.
  bool exact_derivative(const double* x, double* xdot) override;
  void leading_derivative(const double*, const double* xdot, double* wdot) override {
    std::copy_n(xdot, leading_size(), wdot);
  }
  void archive(Archive& archive) override;

 private:
  // Errors of the iteration in units of the tolerance, of BDF and of stages. The longer steps of the latter reach
  // more digits than the tolerance asks for: with 0.02 up to 1.5 of them are lost, and 0.003 costs 5 percent.
  static constexpr double step_tolerance = 0.02, stage_tolerance = 0.003;

  // What is solved for s points together: D_h w_i = sum_j D_ij (w_j - w) / h, or c w + w_rest where there is no
  // method.
  struct Task {
    int s = 1;
    const StageMethod* method = nullptr;
    double h = 0.0, c = 0.0;
    const double* w = nullptr;  // or w_rest
    const double* inverse_weights = nullptr;
  };
  // Which way the constraints look as seen from the partition.
  struct Orientation {
    int positions = 1, velocities = 1;
    bool operator==(const Orientation&) const = default;
  };

  // Of the constraints on both levels.
  struct Passage {
    Tangent::Passage positions, velocities;
  };

  static Orientation orientation_of(const Tangents& tangents) {
    return {tangents.positions.sign(), tangents.of_velocities().sign()};
  }
  void update_traits();
  void resize();
  void resize_stages(int s);
  double* stage(int i) { return stage_qv_.data() + static_cast<std::ptrdiff_t>(i) * leading_size(); }
  PointStatus evaluate(MultibodyPoint& point);
  // The same where terms and tangents are known.
  PointStatus accelerate(MultibodyPoint& point, Tangents& tangents);
  PointStatus linearize(double t, const double* qv);
  PointStatus choose_partition();
  void measure_noise();
  void measure_noise_of_step();
  bool factor_step_matrices(const Task& task);
  PointStatus read_stage(const Task& task, int i, bool is_first);
  void complete_residuals(const Task& task);
  PointStatus iterate(const Task& task);
  bool has_converged(const Task& task, int iteration, double norm, double before);
  void judge_linearization(int s, int iterations);
  double change_norm(const Task& task, const double* change) const;
  void error_of_forces(View yz, View dmu);
  void change_of_forces(ConstView dqv, View dmu);
  PointStatus solve_points(const Task& task, const double* guess);
  PointStatus project_positions(MultibodyPoint& point);
  PointStatus project(MultibodyPoint& point);
  PointStatus check_ranks(const MultibodyPoint& point);
  void read_inconsistency(const MultibodyPoint& point);
  const MultibodyPoint& point_at(const double* x);
  double largest_rotation() const;
  Passage passage_of_step();
  void note_change(const MultibodyPoint& point, const Passage& passage);
  void rebuild(bool has_linearization, double c, double rate);
  bool difference_of_forces(const MultibodyPoint& point, double* mudot);
  PointStatus forces_beside(const MultibodyPoint& point, double distance, double* mu);

  MultibodyProblem& problem_;
  MultibodySizes sizes_;
  Settings settings_;
  Arena arena_;
  double t_ = 0.0;

  MultibodyForm form_;
  MultibodyJacobian jacobian_;
  MultibodyPoint linearized_, work_, end_, accepted_;
  MultibodyPoint chosen_;    // where the partition is from: its t, q and v
  bool is_end_new_ = false;  // end_ is that of a step, or a start, not accepted yet
  bool is_linearized_ = false;
  ChordIteration chord_;
  bool is_fresh_ = false;  // no step has been solved with the linearization
  // Of the last steps: with new linearizations, and with those of steps before.
  int fresh_iterations_ = 0, kept_iterations_ = 0;
  int fresh_in_a_row_ = 0;
  Tangents end_tangents_;
  std::vector<Tangents> stage_tangents_;
  Orientation orientation_, end_orientation_;
  long partitions_ = 0;
  bool along_tangents_ = false;  // how accelerations are determined

  StepMatrix matrix_;

  std::vector<double> times_;
  std::vector<double> stage_qv_, stage_particular_, stage_changes_, stage_mu_, stage_moves_, stage_r_, stage_z_;
  std::vector<double> stage_rates_, stage_a_;
  std::vector<double> change_, residuals_;
  std::vector<double> inverse_weights_;  // those of the last step, 0 before the first
  // What rounding errors do to changes of q and v: apart from those of accelerations, with them; and those, in (y,
  // z).
  std::vector<double> noise_at_rest_, noise_, noise_of_rates_;

  double kept_ = 1.0, inconsistency_ = 0.0;
  int inconsistent_row_ = -1;
  MultibodyRanks decided_;  // when the partition was chosen
  // Where a change was met last, those of the constraints that vanish relative to others taken for zero.
  MultibodyRanks changed_ranks_;
  int vanishing_row_ = -1;
  double vanishing_value_ = 0.0;
  bool has_changed_ = false;
};

}  // namespace sfdae::core
