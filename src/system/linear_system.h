// The strangeness-free system of a linear problem, reduced anew at every point.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "linalg/archive.h"
#include "linalg/index.h"
#include "problem/linear_problem.h"
#include "reduction/index_analysis.h"
#include "reduction/null_space_form.h"
#include "system/dae_system.h"
#include "system/step_matrix.h"

namespace sfdae::core {

class LinearSystem final : public DaeSystem {
 public:
  // The analysis holds from here on. Settles the leading term; throws Failure if the prescribed components do not fit
  // or E'(t) is needed and missing.
  LinearSystem(LinearProblem& problem, const AnalysisSettings& settings, IndexAnalysis analysis, LeadingTerm leading);
  // As it was when it was archived, except that it stands at no point until moved to one. Throws DamagedArchive.
  LinearSystem(LinearProblem& problem, const AnalysisSettings& settings, Archive& archive);

  PointStatus move_to(double t) override;
  void accept() override;
  void leading(const double* x, double* w) override;
  PointStatus solve(const StepEquations& equations, double* x) override;
  PointStatus solve_stages(const StageEquations& equations, double* x, double* w, double& t_reached) override;
  using StrangenessFreeSystem::error_in_x;
  void error_in_x(const double* dw, int count, double* dx) override;
  void restore(const double* w, const double* x_free, double* x) override;
  void correct_derivative(double c, const double* x, double* xdot) override;

  // W = E (or I where E' is missing) from now on, as rank E has turned out not to be constant.
  void give_up_projector() override;
  LinearProblem& problem() { return problem_; }
  const AnalysisSettings& settings() const { return settings_; }
  Arena& arena() { return arena_; }

  // The point moved to last.
  const NullSpaceForm& form() const { return current().form; }
  const TaylorData& data() const { return current().data; }
  double t() const override { return current().t; }
  PointQuality quality() const override;
  CharacteristicValues values_at(double t) override;
  // Largest entries of the rows of [E A], unscaled.
  const std::vector<double>& row_norms() const { return current().data.row_norm; }
  // The largest row over the smallest, at this point or at the one accepted last, whichever is less: it diverges
  // where a row vanishes.
  double row_ratio() const;
  // How rows are scaled from now on; RowScaling::each unless set.
  void set_row_scaling(RowScaling rows) { rows_ = rows; }
  double kept_constraints() const { return current().kept_constraints; }
  double kept_differential() const { return current().kept_differential; }

  // What a change of the characteristic values would show in, at the points that the last step went through: at the
  // stages of a Runge-Kutta step, or at the current point alone.
  struct Trace {
    double t = 0.0;
    bool orientation_kept = true;
    double kept_constraints = 1.0, kept_differential = 1.0;
    std::vector<double> row_norms;
  };
  // That of the current point.
  void trace(Trace& trace);
  int num_stage_traces() const { return num_stage_traces_; }
  const Trace& stage_trace(int i) const { return stage_traces_[index(i)]; }

  // False if the sign of det[E1; A2] changed from the point accepted last to the current one, bases aligned: a
  // singular point lies between (or the bases turned too far to tell). Meaningful for u = 0 only, else true.
  bool orientation_kept();
  void archive(Archive& archive) override;

  // The derivative of the constraints is computed by differences where it is not available.
  bool consistent_derivative(const double* x, double direction, double* xdot) override;
  bool exact_derivative(const double* x, double* xdot) override;
  void leading_derivative(const double* x, const double* xdot, double* wdot) override;

 private:
  struct Point {
    TaylorData data;
    NullSpaceForm form;
    double t = std::numeric_limits<double>::quiet_NaN();  // until it is complete
    double kept_constraints = 1.0, kept_differential = 1.0, pivot = 1.0;
    int det_sign = 1;
  };

  // What the stages of a step leave behind, side by side; q = d + u unknowns each, X_i = [T2 xp] at stage i.
  struct Stages {
    std::vector<double> X, Y;                     // n x s(q+1): X_i; leading_size() x s(q+1): W_i X_i
    std::vector<double> L;                        // s d x leading_size(): Z1^T E, without the E for W = E
    std::vector<double> B, tau;                   // d x s(q+1): [B b]; time scales
    std::vector<double> V;                        // s u x n: (T2 Uz)^T
    std::vector<double> products, free_products;  // L Y, V X
    std::vector<double> matrix, z;
    std::vector<int> pivots;
  };

  void update_traits();
  void resize();
  // 0 also where errors of difference derivatives explain it.
  double inconsistency() const;
  void resize_stages(int s);
  void keep_stage(int i, int s);
  void assemble_stages(const StageEquations& equations, const double* x_start);
  bool solve_constant_stages(const StageEquations& equations, const double* x_start);
  void expand_stages(int s, double* x, double* w);
  Point& current() { return points_[current_]; }
  const Point& current() const { return points_[current_]; }
  Point& reference() { return points_[1 - current_]; }
  const double* inward(const double* x, double* buffer) const { return problem_.units().inward(x, buffer); }
  void outward(double* x) const { problem_.units().outward(x); }
  void scale_prescribed_values();
  // The functions of the same purpose for scaled x.
  void leading_of(const double* x, double* w);
  void correct_scaled_derivative(double c, const double* x, double* xdot);
  bool consistent_scaled_derivative(const double* x, double direction, double* xdot);
  Orders orders() const;
  PointStatus reduce(double t, double time_scale, Point& point, RowScaling rows);
  PointStatus reduce_constant(double t, Point& point);
  // q := Z1^T E w; E is in w already if W = E.
  void differential_rows(const double* w, double* q);
  bool factor_step_matrix(double c);
  bool derivative_from_array(const double* x, double* xdot);
  bool exact_scaled_derivative(const double* x, double* xdot);
  void derivative_from_differences(const double* x, double direction, double* xdot);
  void choose_leading_term();

  LinearProblem& problem_;
  AnalysisSettings settings_;
  RowScaling rows_ = RowScaling::each;
  // Factors of the rows at the point accepted last, which are preferred: superconvergence needs equations that depend
  // smoothly on t, and jumps of kept values would look like changes.
  std::vector<double> preferred_rows_;
  bool needs_E1_ = false;
  NoiseModel noise_ = NoiseModel::pivots;  // of the next reduction
  Arena arena_;
  Point points_[2];
  int current_ = 0;
  bool accepted_ = false;  // the current point is: move_to has to fill the other one
  std::vector<double> prescribed_values_;
  StepMatrix matrix_;  // for constant problems it is kept as long as c stays
  // Constant problems: f^ = Z^T (f_0, ..., f_mu).
  Matrix Zt_;
  TaylorData rhs_;
  bool constant_ready_ = false;
  Stages stages_;
  // Of all stages but the last, which is the current point.
  std::array<Trace, max_stages - 1> stage_traces_;
  int num_stage_traces_ = 0;
};

}  // namespace sfdae::core
