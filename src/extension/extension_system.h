// The strangeness-free system of the minimal extension: d of the unknowns x_j are states,
//
//     x_j' = ... for the states j (d equations, F1),   f_i^(k) = 0, k = 0, ..., c_i (the rest, F2 among it)
//
// in all unknowns x_j^(l) of the extension. BDF and Radau discretize x_j' of the states; all other derivatives follow
// from the equations. As histories are those of all x_j (W = I), other states may be chosen at any point [MS93: the
// choice of dummy derivatives]. All equations are solved by chord iterations with sparse matrices.
//
// [MS93] S. E. Mattsson, G. Soederlind: Index Reduction in Differential-Algebraic Equations Using Dummy Derivatives.
//        SIAM J. Sci. Comput. 14 (1993), 677-692.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "array/jet_history.h"
#include "extension/confirmed_structure.h"
#include "extension/extension_iteration.h"
#include "extension/extension_linearization.h"
#include "extension/extension_stages.h"
#include "extension/minimal_extension.h"
#include "system/dae_system.h"

namespace sfdae::core {

class ExtensionSystem final : public DaeSystem {
 public:
  // base: its requests to stop apply; it has to outlive this object, as the problem of the extension has. jet:
  // consistent. scales: negligible changes of the unknowns, n values: tolerances, for example. Throws Failure if the
  // structure is not confirmed there.
  ExtensionSystem(MinimalExtension extension, Problem& base, const AnalysisSettings& settings,
                  std::vector<double> scales, const Jet& jet);
  // Restores an archived system. Throws DamagedArchive.
  ExtensionSystem(RecordedProblem& problem, Problem& base, const AnalysisSettings& settings, Archive& archive);

  double t() const override { return jet_.t; }
  SystemForm form() const override { return SystemForm::extension; }
  bool differentiates() const override;
  // Makes a consistent point the current and accepted one.
  PointStatus set_point(const Jet& jet) { return set_point(jet, ConfirmedStructure::Certificates::not_kept); }
  const Jet& jet() const { return jet_; }
  // The jet of a stage of the step whose stages were solved last.
  const Jet& jet_of_stage(int i) const { return stages_.jet(i); }
  // The matrices that these were solved with, refactored if necessary; null if each stage had its own, or there are
  // none. Valid until the next step.
  ExtensionLinearization* factors_of_stages(const StageMethod& method, double h);
  // The matrices of stages that had their own; null otherwise, or if other states have been chosen since.
  LocalStages* local_factors_of_stages() { return are_stages_local_ ? stages_.local(linearization_) : nullptr; }
  // The jet with known derivatives of one order above those of the extension; false if it was not found.
  bool find_longer_jet(Jet& longer);
  const Jet* point_of_equations() const override { return &history_.accepted(); }
  const Jet& accepted_jet() const { return history_.accepted(); }
  const AnalysisSettings& settings() const { return settings_; }
  const std::vector<double>& scales() const { return scales_; }
  MinimalExtension& extension() { return extension_; }
  const ExtensionLinearization& linearization() const { return linearization_; }
  ConfirmedStructure& structure() { return structure_; }

  PointStatus move_to(double t) override;
  void accept() override {
    history_.accept(jet_);
    has_end_tangents_ = false;
  }
  void leading(const double* x, double* w) override { std::copy_n(x, unknowns(), w); }
  PointStatus solve(const StepEquations& equations, double* x) override;
  PointStatus solve_stages(const StageEquations& equations, double* x, double* w, double& t_reached) override;
  void correct_slopes(double* wdot, double* xdot) override;
  double stage_cost(int s) const override;
  using StrangenessFreeSystem::error_in_x;
  void error_in_x(const double* dw, int count, double* dx) override;
  // Throws Failure if no consistent x is found near x_free.
  using StrangenessFreeSystem::restore;
  void restore(const double* w, const double* x_free, const Guess& guess, double* x) override;
  void correct_derivative(double, const double* x, double* xdot) override { exact_derivative(x, xdot); }
  bool estimate_derivative(const double* x, double* xdot) override { return exact_derivative(x, xdot); }

  PointQuality quality() const override;
  // The known values, or none if the structure is no longer confirmed: others are not found here.
  CharacteristicValues values_at(double t) override;
  std::string about_change() const override {
    const std::string& about = structure_.about_change().empty() ? about_later_point_ : structure_.about_change();
    if (about.empty()) return about;
    const Jet& accepted = history_.accepted();
    return " There " + about + problem_base().about_singular_point(accepted.t, accepted.x.data());
  }
  // Notes that a block of the system Jacobian is singular at a later point.
  void note_singular_block(int block) { about_later_point_ = structure_.describe_block(block) + " is singular."; }
  // Checks on request: this does not affect when later points are judged and linearized.
  PointStatus check_ranks() override {
    return structure_.certify_aside(jet_, linearization_.noise_of_jet(), callback_error_);
  }
  bool find_differentiated(char* flags) override;
  double change_of_differentiated(const double* dx, const double* tolerances) const override;
  const double* rounding_errors() const override { return rounding_errors_.data(); }
  bool consistent_derivative(const double* x, double direction, double* xdot) override;
  bool exact_derivative(const double* x, double* xdot) override;
  void leading_derivative(const double*, const double* xdot, double* wdot) override {
    std::copy_n(xdot, unknowns(), wdot);
  }
  void archive(Archive& archive) override;

 private:
  std::string what_is_unclear(PointStatus status) const;
  void resize();
  void find_values();
  PointStatus set_point(const Jet& jet, ConfirmedStructure::Certificates certificates);
  PointStatus certify_if_due();
  void add_distance(std::vector<double>& noise);
  PointStatus renew(const Jet& jet);
  PointStatus renew_at_accepted();
  PointStatus note_renewal(PointStatus status);
  void take_rounding_errors();
  bool is_drowned(const double* inverse_weights) const;
  void leave_drowned_point(const double* inverse_weights);
  PointStatus judge_rounding_errors(const double* inverse_weights);
  // guess: the jet to start from.
  template <class Start, class Iterate>
  PointStatus iterate_with_renewal(const double* inverse_weights, Start guess, Iterate iterate);
  void take_stages(double* x, double* w);
  void add_tangents(ConstView T, const double* dw, double* dx) const;
  PointStatus review();
  PointStatus review_local();
  PointStatus solve_local_stages(const StageEquations& equations);
  // start: sets the jet to start from, once or twice.
  template <class Start>
  PointStatus solve_held(Start start, Jet& jet, double* xdot);

  AnalysisSettings settings_;
  MinimalExtension extension_;
  ExtensionLinearization linearization_;
  ExtensionIteration iteration_;
  ExtensionStages stages_;
  ConfirmedStructure structure_;
  std::string about_later_point_;
  JetHistory history_;
  Jet jet_;
  std::vector<char> determined_;
  std::vector<double> scales_, rounding_errors_, work_;
  int failures_in_row_ = 0;  // stages linearized one by one that did not converge
  // The stages that have been solved were linearized one by one, and the last one is the current point.
  bool has_end_tangents_ = false;
  bool are_stages_local_ = false;  // these were linearized one by one
};

}  // namespace sfdae::core
