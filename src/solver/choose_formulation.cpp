// Choice of the formulation that solves a problem from a point on.
// SPDX-License-Identifier: BSD-3-Clause
#include "solver/choose_formulation.h"

#include <algorithm>

#include "expression/series.h"
#include "linalg/index.h"
#include "multibody/consistent_motion.h"
#include "problem/failure.h"
#include "reduction/usual_units.h"
#include "system/jet_coefficients.h"

namespace sfdae::core {

namespace {

// Number of columns of the derivative array above which the minimal extension is used
// (docs/design/minimal_extension.md). If no equation is differentiated it consists of the original equations
// (docs/design/derivative_array.md).
constexpr double least_array = 100.0, least_array_as_recorded = 20.0;
// Ratios of units of unknowns at which derivative arrays fail, or may have failed (docs/design/scaling_and_units.md).
// By judgement.
constexpr double far_apart = 65536.0, apart = 1024.0;
// Number of unknowns (q, v, mu) of mechanical systems above which sparse matrices are faster
// (docs/design/multibody.md).
constexpr int least_unknowns = 200;
// Density of the equations above which sparse matrices do not pay off: forces between all bodies.
constexpr double largest_density = 0.1;

// Formulations permitted by options, kind and size of a problem.
struct Choice {
  bool requires_extension = false;  // no other formulation is permitted
  bool may_extend = false;
  bool extends_first = false;
  bool has_others = true;  // if the extension fails
};

double density(const Record& record) {
  double entries = 0.0;
  for (int i = 0; i < record.m(); ++i) entries += static_cast<double>(record.entries(i).size());
  return entries / (static_cast<double>(record.m()) * record.n());
}

// Ratio of the largest to the smallest unit of the unknowns at the guess (docs/design/scaling_and_units.md).
double distance_of_units(RecordedProblem& problem, const PointOfInterest& point) {
  Jet jet;
  jet.t = point.t;
  jet.n = problem.n();
  jet.set_order(1);
  if (point.x != nullptr) std::copy_n(point.x, problem.n(), jet.column(0));
  if (point.xdot != nullptr) std::copy_n(point.xdot, problem.n(), jet.column(1));
  JetCoefficients source(problem, jet, {});
  try {
    const UsualUnits usual = usual_units(source, point.t);
    const std::vector<double>& units = usual.units.values();
    const auto [smallest, largest] = std::minmax_element(units.begin(), units.end());
    return units.empty() ? 1.0 : *largest / *smallest;
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
    return 1.0;
  }
}

// If some values are fixed or weighted, only values near the guess are useful: the extension may find others.
bool units_are_apart(RecordedProblem& equations, const PointOfInterest& point, const ModelOptions& options,
                     double distance) {
  return options.consistency.kind == InitialValues::nearest && options.consistency.weights.empty() &&
         distance_of_units(equations, point) > distance;
}

// Upper bound on the number of columns of the array.
bool is_array_large(RecordedProblem& equations) {
  const int bound = equations.structure()->offsets.index_bound();
  const double columns = static_cast<double>(equations.n()) * (bound + 1);
  return columns >= (bound == 0 ? least_array_as_recorded : least_array);
}

// Tests whether Taylor series of the equations can have the orders that the structural analysis requires.
bool orders_are_possible(RecordedProblem& equations) {
  const std::vector<int>& c = equations.structure()->offsets.c;
  return *std::max_element(c.begin(), c.end()) + 1 <= series::highest_order;
}

void demand_array_for_sensitivities(const ModelOptions& options) {
  if (options.for_sensitivities && options.structure == StructureUse::required)
    throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                  format("structure = SFDAE_STRUCTURE_REQUIRED and %s exclude each other: they are computed with the "
                         "whole derivative array.",
                         options.for_adjoint ? "the adjoint" : "sensitivities of mechanical systems"));
}

void demand_dense(int n) {
  if (n > most_dense_unknowns)
    throw Failure(
        SFDAE_ILLEGAL_ARGUMENT,
        format("%d unknowns are too many for the whole derivative array, which the options or the equations ask "
               "for: more than %d need their structure.",
               n, most_dense_unknowns));
}

// Throws Failure if the structural analysis is required but not possible.
void demand_structure(Formulations& all, const ModelOptions& options) {
  if (all.equations->shared_structure() == nullptr)
    throw Failure(SFDAE_RANK_UNCLEAR,
                  "the option structure requires what these equations do not have: some contain"
                  " too few unknowns, as sfdae_get_structure tells.");
  if (options.for_adjoint) demand_array_for_sensitivities(options);
  if (!orders_are_possible(*all.equations))
    throw Failure(SFDAE_INDEX_TOO_HIGH,
                  format("structure asks for more than %d derivatives of an equation.", series::highest_order - 1));
}

Choice choice_for_equations(Formulations& all, const PointOfInterest& point, const ModelOptions& options) {
  RecordedProblem& equations = *all.equations;
  Choice choice{.has_others = equations.n() <= most_dense_unknowns};
  choice.requires_extension = options.structure == StructureUse::required;
  if (choice.requires_extension) demand_structure(all, options);
  choice.may_extend =
      choice.requires_extension ||
      (options.structure == StructureUse::automatic && !options.for_adjoint && !options.analysis.by_svd &&
       options.leading == LeadingTerm::automatic && options.consistency.kind != InitialValues::keep_differential &&
       equations.structure() != nullptr && orders_are_possible(equations));
  choice.extends_first =
      choice.requires_extension || (choice.may_extend && (all.has_differences() || is_array_large(equations) ||
                                                          units_are_apart(equations, point, options, far_apart)));
  return choice;
}

Choice choice_for_mechanical(Formulations& all, const ModelOptions& options) {
  demand_array_for_sensitivities(options);
  const InitialValues kind = options.consistency.kind;
  Choice choice{.requires_extension = options.structure == StructureUse::required};
  choice.may_extend = choice.extends_first =
      choice.requires_extension ||
      (!options.for_sensitivities && options.structure == StructureUse::automatic && all.own->n() >= least_unknowns &&
       (kind == InitialValues::nearest || kind == InitialValues::accept) && all.make_extension() &&
       density(all.equations->evaluator().record()) <= largest_density);
  return choice;
}

Choice choice_for(Formulations& all, const PointOfInterest& point, const ModelOptions& options) {
  if (all.multibody != nullptr) return choice_for_mechanical(all, options);
  return all.equations != nullptr ? choice_for_equations(all, point, options) : Choice();
}

// ---- Analyses --------------------------------------------------------------------------------------------------

// Analyzes the model at the point; positions and velocities of mechanical systems are made consistent first.
void analyze(Formulations& all, Model& model, const PointOfInterest& point, const ModelOptions& options,
             std::vector<RankDecision>& decisions) {
  if (all.multibody == nullptr) return model.analyze(point, options, decisions);
  all.multibody->problem().check_rates(point.t, point.x);
  const std::vector<double> x = with_consistent_motion(all.multibody->problem(), point, options);
  model.analyze({point.t, point.toward, x.data()}, options, decisions);
  if (&model != all.extension.get() ||
      motion_stays(all.multibody->problem().sizes(), x, all.extension->accepted_point().x))
    return;
  // Local coordinates are better in this case.
  model.forget_system();
  throw Failure(SFDAE_RANK_UNCLEAR,
                format("the equations with their derivatives are too badly conditioned at t = %.15g: values that are "
                       "consistent do not stay as they are.",
                       point.t));
}

Model& analyze_extension(Formulations& all, const PointOfInterest& point, const ModelOptions& options,
                         std::vector<RankDecision>& decisions) {
  if (!all.make_extension())
    throw Failure(SFDAE_RANK_UNCLEAR,
                  "the option structure requires what these equations do not have: some constraints contain too few "
                  "coordinates.");
  all.equations->follow_structure(false);
  all.equations->allow_differences_in_time(options.differences.allowed);
  ExtensionModel& extension = *all.extension;
  analyze(all, extension, point, options, decisions);
  if (!options.for_sensitivities || extension.has_sensitivities()) return extension;
  // Sensitivities of replaced equations require the complete derivative array.
  extension.forget_system();
  throw Failure(
      SFDAE_ILLEGAL_ARGUMENT,
      "structure = SFDAE_STRUCTURE_REQUIRED and sensitivities exclude each other where structure misleads and "
      "equations are replaced: these are computed with the whole derivative array.");
}

// Analyzes the complete derivative array, or local coordinates.
Model& analyze_other(Formulations& all, const PointOfInterest& point, const ModelOptions& options,
                     std::vector<RankDecision>& decisions) {
  const bool is_array = options.for_sensitivities && all.has_array();
  if (is_array || (all.multibody == nullptr && all.equations != nullptr)) demand_dense(all.own->n());
  if (!is_array) {
    all.own->analyze(point, options, decisions);
    return *all.own;
  }
  if (point.x == nullptr)
    throw Failure(
        SFDAE_ILLEGAL_ARGUMENT,
        "with sensitivities linear equations are analyzed as nonlinear ones, at values: call sfdae_analyze_at.");
  all.make_array();
  analyze(all, *all.array, point, options, decisions);
  return *all.array;
}

// Large arrays with very different units may exceed double precision, unlike the few equations that the structural
// analysis requires. The extension has its own certificates; without one the array's failure is reported, with its
// decisions.
Model* settle_doubt(Formulations& all, const PointOfInterest& point, const ModelOptions& options,
                    std::vector<RankDecision>& decisions) {
  std::vector<RankDecision> of_extension;
  try {
    Model& extension = analyze_extension(all, point, options, of_extension);
    decisions = std::move(of_extension);
    return &extension;
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
    return nullptr;
  }
}

}  // namespace

Model& choose_formulation(Formulations& formulations, const PointOfInterest& point, const ModelOptions& options,
                          std::vector<RankDecision>& decisions) {
  const Choice choice = choice_for(formulations, point, options);
  if (choice.extends_first) {
    try {
      return analyze_extension(formulations, point, options, decisions);
    } catch (const Failure& failure) {
      if (choice.requires_extension || ends_everything(failure.status()) || !choice.has_others) throw;
    }
    decisions.clear();
  }
  try {
    return analyze_other(formulations, point, options, decisions);
  } catch (const Failure& failure) {
    const bool is_in_doubt = failure.status() == SFDAE_RANK_UNCLEAR || failure.status() == SFDAE_NO_CONSISTENT_VALUES;
    if (!choice.may_extend || choice.extends_first || !is_in_doubt) throw;
    if (failure.status() == SFDAE_NO_CONSISTENT_VALUES &&
        !units_are_apart(*formulations.equations, point, options, apart))
      throw;
    if (Model* const extension = settle_doubt(formulations, point, options, decisions)) return *extension;
    throw;
  }
}

}  // namespace sfdae::core
