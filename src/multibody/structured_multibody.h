// Mechanical systems with constraints: large recorded ones by the minimal extension of their first-order equations,
// with sparse matrices, where numbers confirm their structure; those that sensitivities are asked of by the
// derivative array of these equations; all others by local coordinates, with dense matrices.
//
// K = [M C^T; C 0] of chains and trees has few entries in a row, and what follows from it, as projections and
// tangents, has many (docs/decisions/54-sparse-multibody-systems.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "extension/formulated_model.h"
#include "multibody/multibody_model.h"

namespace sfdae::core {

class StructuredMultibody final : public FormulatedModel {
 public:
  explicit StructuredMultibody(std::unique_ptr<MultibodyModel> local) : StructuredMultibody(local.release()) {}

  // Another one of the same recorded formulas; null for functions.
  std::unique_ptr<StructuredMultibody> clone() const;

  MultibodyProblem& problem() override { return local_.problem(); }
  bool has_structure() const override { return local_.is_recorded(); }
  void add_equations(WordHash& hash) override { local_.add_equations(hash); }
  void demand_derivatives(const PointOfInterest& point, const ModelOptions& options) override;
  double certify() override { return local_.certify(); }
  std::unique_ptr<SensitivitySystem> sensitivities(std::vector<int> parameters) override;
  ConsistentPoint consistent_point(const PointOfInterest& point, const ModelOptions& options) override;
  ConsistentPoint consistent_point_beside(const PointOfInterest& point, const ModelOptions& options) override;
  // None of systems whose structure is used as that of recorded equations.
  std::optional<Extension> extension() override { return std::nullopt; }

  // As of MultibodyModel; what needs a system has local coordinates at the point accepted last.

  CallbackMultibody* callbacks() { return local_.callbacks(); }
  std::unique_ptr<RecordedProblem> recorded_first_order_problem() { return local_.recorded_first_order_problem(); }
  ConstraintsReport constraints();
  Jump impact(const PointOfInterest& point, const ModelOptions& options, const std::vector<double>& restitution) {
    return analyzed_local().impact(point, options, restitution);
  }
  ExtendedSystem extended_system(double t, const double* x) { return analyzed_local().extended_system(t, x); }

 private:
  explicit StructuredMultibody(MultibodyModel* local)
      : FormulatedModel(std::unique_ptr<Model>(local)), local_(*local) {}

  bool requires_extension(const ModelOptions& options) override;
  bool may_extend(const ModelOptions& options) override;
  bool is_extended_first(const PointOfInterest&, const ModelOptions&) override { return true; }
  bool has_array_for_sensitivities() const override { return true; }
  bool has_archived_extension(bool for_sensitivities) override { return !for_sensitivities && make_sparse(); }
  std::unique_ptr<RecordedProblem> equations_of_array() override { return local_.recorded_first_order_problem(); }
  void analyze_as(Formulation formulation, const PointOfInterest& point, const ModelOptions& options,
                  std::vector<RankDecision>& decisions) override;
  Model& whole() override { return analyzed_local(); }

  bool make_sparse();
  MultibodyModel& analyzed_local();
  // The given x with consistent positions and velocities.
  std::vector<double> with_consistent_motion(const PointOfInterest& point, const ModelOptions& options);
  template <class Find>
  ConsistentPoint consistent(const PointOfInterest& point, const ModelOptions& options, Find find);

  MultibodyModel& local_;
};

}  // namespace sfdae::core
