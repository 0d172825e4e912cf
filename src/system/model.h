// A problem with its system: analysis, consistent values, and further requests to problems of any kind.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "expression/fingerprint.h"
#include "expression/taylor_evaluator.h"
#include "linalg/archive.h"
#include "problem/differences.h"
#include "problem/problem.h"
#include "reduction/derivative_array.h"
#include "reduction/index_analysis.h"
#include "structure/structure.h"
#include "system/change_watch.h"
#include "system/consistency_request.h"
#include "system/dae_system.h"
#include "system/jet.h"
#include "system/jump.h"
#include "system/sensitivity_system.h"
#include "system/value_change.h"

namespace sfdae::core {

// Structural analysis of recorded equations: off: the full derivative array; automatic: the rows selected by it, if
// confirmed numerically; required: failure if not confirmed.
enum class StructureUse { off, automatic, required };

struct ModelOptions : Acceptance {
  AnalysisSettings analysis;
  DifferenceOptions differences;
  LeadingTerm leading = LeadingTerm::automatic;
  ConsistencyRequest consistency;
  Precedent precedent;  // of analyses to come
  StructureUse structure = StructureUse::off;
  bool for_sensitivities = false;  // the system has to be one that sensitivities can be asked of,
  bool for_adjoint = false;        // or their adjoint

  // The request for consistent values near x.
  ConsistencyRequest request_at(const double* x) const {
    ConsistencyRequest request = consistency;
    request.set_tolerances(tolerances, x);
    return request;
  }
  AnalysisSettings analysis_by_precedent() const {
    AnalysisSettings settings = analysis;
    settings.precedent = precedent;
    return settings;
  }
};

// x: n values, or null if none are known. toward: in the direction of integration. xdot: initial guess or null; for
// nonlinear problems it selects among the derivatives that F(t, x, x') = 0 allows.
struct PointOfInterest {
  double t, toward;
  const double* x;
  const double* xdot = nullptr;
  double direction() const { return toward < t ? -1.0 : 1.0; }
};

// Default for toward: one unit of time away, or far from 0 a millionth of t, which rounding of t does not disturb.
inline double time_beside(double t, double direction) { return t + direction * std::max(1.0, 1e-6 * std::fabs(t)); }

struct ConsistentPoint {
  double t = 0.0;
  std::vector<double> x, xdot;
  std::vector<double> difference_errors;  // of x, see DaeSystem; empty: not asked for, or none
  ConsistencyResult change;
  ValueChange value_change;  // of the values that were to stay; none if the request did not ask for it
  bool derivative_exact = false;
  bool has_contradiction = false;  // of redundant equations; it is to be ignored
};

// Calls of user-supplied functions.
struct EvaluationCounts {
  long E = 0, A = 0, f = 0;
  long F = 0, linearizations = 0;
};

class Model {
 public:
  virtual ~Model() = default;
  virtual Problem& problem() = 0;
  virtual int m() const = 0;
  virtual int n() const = 0;
  // Points do not matter to the analysis.
  virtual bool is_constant() const = 0;
  // The analysis is that of a solution, and needs x.
  virtual bool needs_x() const = 0;
  virtual EvaluationCounts evaluations() const = 0;
  // Recorded equations, else null; call parameters_changed() after a change there.
  virtual TaylorEvaluator* evaluator() = 0;
  virtual void parameters_changed() {}
  // Recorded equations: all evaluators that contain their inputs.
  virtual std::vector<const TaylorEvaluator*> evaluators_of_inputs() {
    const TaylorEvaluator* const only = evaluator();
    return only != nullptr ? std::vector<const TaylorEvaluator*>{only} : std::vector<const TaylorEvaluator*>{};
  }

  // Adds known properties of the equations that distinguish them: recorded equations, patterns, prescribed components;
  // not the values of parameters.
  virtual void add_equations(WordHash& hash) {
    if (const TaylorEvaluator* known = evaluator()) core::add_equations(known->record(), hash);
  }

  // Index analysis: creates the system. decisions: all that were made, also on Failure; then there is no system.
  virtual void analyze(const PointOfInterest& point, const ModelOptions& options,
                       std::vector<RankDecision>& decisions) = 0;
  // Compares derivatives that callbacks supply with their functions, after an analysis or after one that failed. Throws
  // SFDAE_WRONG_DERIVATIVES.
  virtual void demand_derivatives(const PointOfInterest&, const ModelOptions&) {}
  // Restores the system as it was when it was archived; the replaced one is stored until one of the other two functions
  // is called. Throws DamagedArchive or Failure, and nothing has changed then.
  virtual void restore(const ModelOptions& options, Archive& archive) = 0;
  // Sets the form of the system to be restored, which may have to support sensitivities; false if this model does not
  // have that form.
  virtual bool expect(SystemForm form, bool /*for_sensitivities*/) { return form == SystemForm::reduced; }
  virtual void undo_restore() = 0;
  virtual void finish_restore() = 0;
  // Null before an analysis.
  virtual DaeSystem* system() = 0;
  virtual void forget_system() = 0;
  // The same for users that outlive the analysis, such as stored steps.
  virtual std::shared_ptr<const DaeSystem> shared_system() = 0;
  // A certificate for the ranks of the analysis: approximate smallest relative change of the data that changes them.
  // Throws Failure: SFDAE_RANK_UNCLEAR if it does not confirm them.
  virtual double certify() = 0;
  // Null if x is needed, which is known at points of an integration only.
  virtual std::unique_ptr<ChangeWatch> change_watch() { return nullptr; }

  // Sensitivities to parameters of these numbers, see ParameterSeries, along x of the system, which was analyzed for
  // that; null if this kind of model has none. Throws Failure if these equations have none.
  virtual std::unique_ptr<SensitivitySystem> sensitivities(std::vector<int>) { return nullptr; }

  // Consistent values near x, x' in the direction toward `toward`; the system is at that point afterwards. Throws
  // Failure.
  virtual ConsistentPoint consistent_point(const PointOfInterest& point, const ModelOptions& options) = 0;
  // Uses a copy of the system, so that an integration is not disturbed.
  virtual ConsistentPoint consistent_point_beside(const PointOfInterest& point, const ModelOptions& options) = 0;

  // Dimensions of the minimal extension that recorded equations are solved by.
  struct Extension {
    const Structure* structure;  // lives as long as the system
    int rows, columns;
    std::size_t entries, fill;  // of derivatives, of the factors of one matrix
    std::vector<int> states;
  };
  virtual std::optional<Extension> extension() { return std::nullopt; }

  // The point accepted last, or that of the analysis, order 0; of linear problems none (n = 0).
  virtual Jet accepted_point() const { return {}; }
};

// A model with the full theory: by the derivative array, or local coordinates of a mechanical system.
class WholeModel : public Model {
 public:
  // demand_derivatives() along the jet found by the analysis of another model of these equations.
  virtual void demand_derivatives_along(const Jet&, const PointOfInterest& point, const ModelOptions& options) {
    demand_derivatives(point, options);
  }

  // From values of other equations before t to consistent ones, by impulses of these equations. Needs an analysis;
  // nothing of an integration is disturbed. Throws Failure.
  virtual Jump jump(const PointOfInterest& point, const ModelOptions& options) = 0;
  // Derivatives of the values after such a jump, n x directions, by its equations. False if the equations do not
  // determine them: jumps with shifted data are needed then. Throws Failure.
  virtual bool differentiate_jump(const MovingJump&, const ModelOptions&, View /*after*/) { return false; }

  // True if some x' fulfills the equations at these values of x, or if that is not known.
  virtual bool fulfils_equations(const PointOfInterest&) { return true; }

  // The theory's objects, of the equations linearized at a jet (derivative_array.h); no integration is disturbed. All
  // throw Failure, and all but the array need an analysis.
  // The jet with F_level = 0, order level + 1, through x.
  virtual Jet jet_through(double t, const double* x, int level) = 0;
  virtual DerivativeArray derivative_array(const Jet& jet, int level) = 0;
  // With Z2 and Z3, or without.
  virtual Projectors projectors(const Jet& jet, bool of_array) = 0;
  virtual StrangenessFreeEquations strangeness_free(const Jet& jet) = 0;
  // The level of the jets that projectors and the strangeness-free system need.
  virtual int level_of_jets(bool) { return system()->analysis().values.mu; }
};

// Common parts of all kinds of models.
template <class System, class Base = WholeModel>
class ModelOf : public Base {
 public:
  System* system() override { return system_.get(); }
  void forget_system() override { system_.reset(); }
  std::shared_ptr<const DaeSystem> shared_system() override { return system_; }
  void restore(const ModelOptions& options, Archive& archive) override {
    replaced_ = archived_system(options, archive);
    std::swap(system_, replaced_);
  }
  void undo_restore() override {
    std::swap(system_, replaced_);
    replaced_.reset();
  }
  void finish_restore() override { replaced_.reset(); }
  ConsistentPoint consistent_point(const PointOfInterest& point, const ModelOptions& options) override {
    return make_consistent(*system_, point, options);
  }
  ConsistentPoint consistent_point_beside(const PointOfInterest& point, const ModelOptions& options) override {
    const std::unique_ptr<System> copy = copy_of_system();
    ConsistentPoint found = make_consistent(*copy, point, options);
    if (copy->has_difference_errors()) {
      found.difference_errors.resize(found.x.size());
      copy->difference_errors(found.x.data(), found.difference_errors.data());
    }
    return found;
  }

 protected:
  virtual std::unique_ptr<System> copy_of_system() = 0;
  virtual std::unique_ptr<System> archived_system(const ModelOptions& options, Archive& archive) = 0;
  virtual ConsistentPoint make_consistent(System& system, const PointOfInterest& point,
                                          const ModelOptions& options) = 0;

  std::shared_ptr<System> system_, replaced_;
};

// Writes x' of the point; `system` stands there. Throws Failure if it is not finite.
void add_derivative(DaeSystem& system, double direction, ConsistentPoint& point);
// Throws Failure if the system could not be moved to t.
void demand_point(const DaeSystem& system, PointStatus status, double t, const char* advice);

}  // namespace sfdae::core
