// Recorded equations by their minimal extension, or by the derivative array.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/structured_model.h"

#include <algorithm>
#include <utility>

#include "expression/series.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "reduction/usual_units.h"
#include "system/jet_coefficients.h"

namespace sfdae::core {

namespace {

// Columns of the derivative array from which on the extension is taken (docs/decisions/47-minimal-extension.md).
// Where nothing has to be differentiated it is the equations as they are
// (docs/decisions/90-small-problems-of-index-zero.md).
constexpr double least_array = 100.0, least_array_as_recorded = 20.0;
// Units of unknowns that are so far apart lead arrays astray, or may have done so
// (docs/decisions/84-units-of-blocks.md). By judgement.
constexpr double far_apart = 65536.0, apart = 1024.0;

// Of unknowns at the guess, the largest over the smallest (docs/decisions/06-units-of-unknowns.md).
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

}  // namespace

bool StructuredModel::is_array_large() const {
  const int bound = problem_.structure()->offsets.index_bound();
  const double columns = static_cast<double>(n()) * (bound + 1);
  return columns >= (bound == 0 ? least_array_as_recorded : least_array);
}

// Who has some values stay, or move less, wants those near the guess, or none: the extension may find others.
bool StructuredModel::units_are_apart(const PointOfInterest& point, const ModelOptions& options, double distance) {
  return options.consistency.kind == InitialValues::nearest && options.consistency.weights.empty() &&
         distance_of_units(problem_, point) > distance;
}

bool StructuredModel::requires_extension(const ModelOptions& options) {
  const bool is_required = options.structure == StructureUse::required || has_differences();
  if (is_required) demand_structure(options);
  return is_required;
}

bool StructuredModel::may_extend(const ModelOptions& options) {
  return options.structure == StructureUse::automatic && !options.for_adjoint && !options.analysis.by_svd &&
         options.leading == LeadingTerm::automatic && options.consistency.kind != InitialValues::keep_differential &&
         problem_.structure() != nullptr && orders_are_possible();
}

bool StructuredModel::is_extended_first(const PointOfInterest& point, const ModelOptions& options) {
  return is_array_large() || units_are_apart(point, options, far_apart);
}

bool StructuredModel::is_in_doubt(const Failure& failure, const PointOfInterest& point, const ModelOptions& options) {
  return failure.status() == SFDAE_RANK_UNCLEAR ||
         (failure.status() == SFDAE_NO_CONSISTENT_VALUES && units_are_apart(point, options, apart));
}

bool StructuredModel::are_others_possible() const { return n() <= most_dense_unknowns; }

// Of Taylor series of the equations, and of those of their derivatives by t.
bool StructuredModel::orders_are_possible() const {
  const std::vector<int>& c = problem_.structure()->offsets.c;
  return *std::max_element(c.begin(), c.end()) + 1 <= series::highest_order;
}

// Where it has to be used.
void StructuredModel::demand_structure(const ModelOptions& options) const {
  if (has_differences() && options.structure == StructureUse::off)
    throw Failure(
        SFDAE_ILLEGAL_ARGUMENT,
        "structure = SFDAE_STRUCTURE_OFF and SFDAE_MATRICES_DIFFERENCES exclude each other: the whole array "
        "needs Jacobians.");
  if (problem_.shared_structure() == nullptr)
    throw Failure(SFDAE_RANK_UNCLEAR,
                  "the option structure, or Jacobians by differences, require what these equations do not have: some "
                  "contain too few unknowns, as sfdae_get_structure tells.");
  if (options.for_adjoint) demand_array_for_sensitivities(options);
  if (!orders_are_possible())
    throw Failure(SFDAE_INDEX_TOO_HIGH,
                  format("structure asks for more than %d derivatives of an equation.", series::highest_order - 1));
}

void StructuredModel::analyze_as(Formulation formulation, const PointOfInterest& point, const ModelOptions& options,
                                 std::vector<RankDecision>& decisions) {
  if (formulation != Formulation::extension) demand_dense(n());
  if (formulation == Formulation::own) return own().analyze(point, options, decisions);
  if (formulation == Formulation::array) {
    if (point.x == nullptr)
      throw Failure(
          SFDAE_ILLEGAL_ARGUMENT,
          "with sensitivities linear equations are analyzed as nonlinear ones, at values: call sfdae_analyze_at.");
    make_array();
    return array().analyze(point, options, decisions);
  }
  problem_.follow_structure(false);
  problem_.allow_differences_in_time(options.differences.allowed);
  extended().analyze(point, options, decisions);
  if (!options.for_sensitivities || extended().has_sensitivities()) return;
  // Equations that are replaced have them by the whole array alone.
  extended().forget_system();
  throw Failure(
      SFDAE_ILLEGAL_ARGUMENT,
      "structure = SFDAE_STRUCTURE_REQUIRED and sensitivities exclude each other where structure misleads and "
      "equations are replaced: these are computed with the whole derivative array.");
}

std::unique_ptr<RecordedProblem> StructuredModel::equations_of_array() {
  auto equations = std::make_unique<RecordedProblem>(problem_.evaluator());
  equations->set_equation_names(problem().equation_names());
  return equations;
}

void StructuredModel::demand_derivatives(const PointOfInterest& point, const ModelOptions& options) {
  // Comparisons take matrices of all derivatives; by judgement.
  constexpr int most_compared = 1000;
  if (formulation() == Formulation::array || (problem_.source() != nullptr && n() > most_compared)) return;
  if (formulation() == Formulation::own) own().demand_derivatives(point, options);
  else if (problem_.source() != nullptr) own().demand_derivatives_along(extended().accepted_jet(), point, options);
}

void StructuredModel::restore(const ModelOptions& options, Archive& archive) {
  problem_.allow_differences_in_time(options.differences.allowed);
  FormulatedModel::restore(options, archive);
}

Model& StructuredModel::whole() {
  if (formulation() == Formulation::own || own().system() != nullptr) return own();
  if (n() > most_dense_unknowns)
    throw Failure(
        SFDAE_ILLEGAL_ARGUMENT,
        format("objects of the theory are those of the whole derivative array: there are none of more than %d "
               "unknowns.",
               most_dense_unknowns));
  if (has_differences())
    throw Failure(
        SFDAE_ILLEGAL_ARGUMENT,
        "objects of the theory are those of the whole derivative array, which needs Jacobians: there are none "
        "with SFDAE_MATRICES_DIFFERENCES.");
  return analyze_own();
}

// Linear equations as nonlinear ones.
bool StructuredModel::differentiate_jump(const MovingJump& moving, const ModelOptions& options, View after) {
  if (!owns_equations()) return whole().differentiate_jump(moving, options, after);
  make_array();
  if (array().system() == nullptr) {
    ModelOptions plain = this->options();
    plain.structure = StructureUse::off;
    plain.for_sensitivities = true;
    std::vector<RankDecision> decisions;
    array().analyze({moving.t, moving.toward, moving.after}, plain, decisions);
  }
  return array().differentiate_jump(moving, options, after);
}

Model& StructuredModel::same_whole() {
  Model& model = whole();
  const CharacteristicValues &of_array = model.system()->analysis().values, &own = system()->analysis().values;
  if (of_array == own) return model;
  throw Failure(SFDAE_RANK_UNCLEAR,
                "the whole derivative array has other characteristic values, (" + describe(of_array) +
                    "), than those in use, (" + describe(own) +
                    "), which follow from structure: its objects do not fit. Set structure = SFDAE_STRUCTURE_OFF.");
}

Jet StructuredModel::accepted_point() const {
  return formulation() == Formulation::extension && needs_x() ? extended().accepted_point() : own().accepted_point();
}

}  // namespace sfdae::core
