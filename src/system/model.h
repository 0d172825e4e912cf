// A problem with its system: analysis, consistent values, and what else is asked of a problem of any kind.
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

// Of recorded equations: the whole derivative array, the rows that their structure asks for where numbers agree, or a
// failure where they do not.
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

  // What is asked of values near x.
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

// x: n values, or null where none are known. toward: in the direction of integration. xdot: a guess, or null; of
// nonlinear problems it chooses among the derivatives that F(t, x, x') = 0 allows.
struct PointOfInterest {
  double t, toward;
  const double* x;
  const double* xdot = nullptr;
  double direction() const { return toward < t ? -1.0 : 1.0; }
};

// Toward where nobody says where to: one unit of time away, or far from 0 a millionth of t, which rounding of t does
// not disturb.
inline double time_beside(double t, double direction) { return t + direction * std::max(1.0, 1e-6 * std::fabs(t)); }

struct ConsistentPoint {
  double t = 0.0;
  std::vector<double> x, xdot;
  std::vector<double> difference_errors;  // of x, see DaeSystem; empty: not asked for, or none
  ConsistencyResult change;
  ValueChange value_change;  // of what was to stay; none where the request did not ask for that
  bool derivative_exact = false;
  bool has_contradiction = false;  // of redundant equations, and is to be ignored
};

// Calls of the user's functions.
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
  // Of recorded equations, else null; parameters_changed() is due after a change there.
  virtual TaylorEvaluator* evaluator() = 0;
  virtual void parameters_changed() {}
  // Of recorded equations: all that their inputs are in.
  virtual std::vector<const TaylorEvaluator*> evaluators_of_inputs() {
    const TaylorEvaluator* const only = evaluator();
    return only != nullptr ? std::vector<const TaylorEvaluator*>{only} : std::vector<const TaylorEvaluator*>{};
  }

  // Adds what is known of the equations and tells them apart: recorded ones, patterns, what is prescribed; not the
  // values of parameters.
  virtual void add_equations(WordHash& hash) {
    if (const TaylorEvaluator* known = evaluator()) core::add_equations(known->record(), hash);
  }

  // Index analysis: makes the system. decisions: all that were made, also when it throws Failure; then there is none.
  virtual void analyze(const PointOfInterest& point, const ModelOptions& options,
                       std::vector<RankDecision>& decisions) = 0;
  // Compares derivatives that callbacks supply with their functions, after an analysis or after one that failed. Throws
  // SFDAE_WRONG_DERIVATIVES.
  virtual void demand_derivatives(const PointOfInterest&, const ModelOptions&) {}
  // The system as it was when it was archived; the one that it replaces is kept until one of the other two is called.
  // Throws DamagedArchive or Failure, and nothing has changed then.
  virtual void restore(const ModelOptions& options, Archive& archive) = 0;
  // Of the system that is to be restored, which may be one that sensitivities can be asked of; false where there are
  // none of that form.
  virtual bool expect(SystemForm form, bool /*for_sensitivities*/) { return form == SystemForm::reduced; }
  virtual void undo_restore() = 0;
  virtual void finish_restore() = 0;
  // Null before an analysis.
  virtual DaeSystem* system() = 0;
  virtual void forget_system() = 0;
  // The same, for what outlives the analysis: steps that are kept.
  virtual std::shared_ptr<const DaeSystem> shared_system() = 0;
  // A certificate for the ranks of the analysis: the smallest relative change of the data that gives others, about.
  // Throws Failure: SFDAE_RANK_UNCLEAR where it does not confirm them.
  virtual double certify() = 0;
  // Null where x is needed, which is known at points of an integration only.
  virtual std::unique_ptr<ChangeWatch> change_watch() { return nullptr; }

  // By parameters of these numbers, see ParameterSeries, along x of the system, which was analyzed for that; null
  // where this kind of model has none. Throws Failure where these equations have none.
  virtual std::unique_ptr<SensitivitySystem> sensitivities(std::vector<int>) { return nullptr; }

  // Consistent values near x, x' in the direction toward `toward`; the system is at that point afterwards. Throws
  // Failure.
  virtual ConsistentPoint consistent_point(const PointOfInterest& point, const ModelOptions& options) = 0;
  // With a copy of the system, so that an integration is not disturbed.
  virtual ConsistentPoint consistent_point_beside(const PointOfInterest& point, const ModelOptions& options) = 0;

  // Of recorded equations that are solved by their minimal extension: what it looks like.
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

// A model that knows the whole theory: by the derivative array, or local coordinates of a mechanical system.
class WholeModel : public Model {
 public:
  // demand_derivatives() where another model of these equations has been analyzed, along the jet that it has found.
  virtual void demand_derivatives_along(const Jet&, const PointOfInterest& point, const ModelOptions& options) {
    demand_derivatives(point, options);
  }

  // From values of other equations before t to consistent ones, by impulses of these equations. Needs an analysis;
  // nothing of an integration is disturbed. Throws Failure.
  virtual Jump jump(const PointOfInterest& point, const ModelOptions& options) = 0;
  // How the values after such a jump move, n x directions, by its equations. False where they do not say it: then
  // jumps that are moved have to. Throws Failure.
  virtual bool differentiate_jump(const MovingJump&, const ModelOptions&, View /*after*/) { return false; }

  // Returns whether some x' fulfils the equations at these values of x; true where that is not known.
  virtual bool fulfils_equations(const PointOfInterest&) { return true; }

  // The theory's objects, of the equations linearized at a jet (derivative_array.h); nothing of an integration is
  // disturbed. All throw Failure, and all but the array need an analysis.
  // The jet with F_level = 0, order level + 1, through x.
  virtual Jet jet_through(double t, const double* x, int level) = 0;
  virtual DerivativeArray derivative_array(const Jet& jet, int level) = 0;
  // With Z2 and Z3, or without.
  virtual Projectors projectors(const Jet& jet, bool of_array) = 0;
  virtual StrangenessFreeEquations strangeness_free(const Jet& jet) = 0;
  // The level of the jets that projectors and the strangeness-free system need.
  virtual int level_of_jets(bool) { return system()->analysis().values.mu; }
};

// What all kinds of models have in common.
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

// x' of the point into it; `system` is there. Throws Failure if it is not finite.
void add_derivative(DaeSystem& system, double direction, ConsistentPoint& point);
// Throws Failure if the system could not be moved to t.
void demand_point(const DaeSystem& system, PointStatus status, double t, const char* advice);

}  // namespace sfdae::core
