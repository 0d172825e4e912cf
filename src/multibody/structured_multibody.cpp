// Mechanical systems with constraints: sparse or with local coordinates.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/structured_multibody.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "multibody/multibody_consistency.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Unknowns (q, v, mu) from which on sparse matrices are faster (docs/decisions/54-sparse-multibody-systems.md).
constexpr int least_unknowns = 200;
// Equations that contain more of all unknowns than this leave no use for sparse matrices: forces between all bodies.
constexpr double largest_density = 0.1;
// Positions and velocities that are consistent stay, but for errors so large, relative to the largest of them.
constexpr double largest_move = 1e-13;

double density(const Record& record) {
  double entries = 0.0;
  for (int i = 0; i < record.m(); ++i) entries += static_cast<double>(record.entries(i).size());
  return entries / (static_cast<double>(record.m()) * record.n());
}

bool stays(const double* from, const double* to, int count) {
  const double bound = largest_move * max_abs(from, count);
  for (int i = 0; i < count; ++i)
    if (!(std::fabs(to[i] - from[i]) <= bound)) return false;
  return true;
}

bool motion_stays(const MultibodySizes& sizes, const double* from, const double* to) {
  const int nq = sizes.positions;
  return stays(from, to, nq) && stays(from + nq, to + nq, sizes.velocities);
}

}  // namespace

std::unique_ptr<StructuredMultibody> StructuredMultibody::clone() const {
  std::unique_ptr<MultibodyModel> other = local_.clone();
  return other ? std::make_unique<StructuredMultibody>(std::move(other)) : nullptr;
}

// ---- Which formulation serves ----------------------------------------------------------------------------------

bool StructuredMultibody::requires_extension(const ModelOptions& options) {
  if (options.for_sensitivities) demand_array_for_sensitivities(options);
  return options.structure == StructureUse::required;
}

bool StructuredMultibody::may_extend(const ModelOptions& options) {
  const InitialValues kind = options.consistency.kind;
  return !options.for_sensitivities && options.structure == StructureUse::automatic && n() >= least_unknowns &&
         (kind == InitialValues::nearest || kind == InitialValues::accept) && make_sparse() &&
         density(equations()->evaluator().record()) <= largest_density;
}

// False where the equations have no structure.
bool StructuredMultibody::make_sparse() {
  if (!local_.is_recorded()) return false;
  if (equations() == nullptr) {
    std::unique_ptr<RecordedProblem> owned = local_.recorded_first_order_problem();
    owned->follow_structure(false);
    RecordedProblem& first_order = *owned;
    set_equations(first_order, std::move(owned));
  }
  return equations()->structure() != nullptr;
}

// For all but local coordinates positions and velocities are made consistent as ever. The extension has to agree:
// where it is badly conditioned, local coordinates are better.
void StructuredMultibody::analyze_as(Formulation formulation, const PointOfInterest& point,
                                     const ModelOptions& options, std::vector<RankDecision>& decisions) {
  if (formulation == Formulation::own) return local_.analyze(point, options, decisions);
  const bool is_array = formulation == Formulation::array;
  if (is_array) {
    demand_dense(n());
    make_array();
  } else if (!make_sparse()) {
    throw Failure(SFDAE_RANK_UNCLEAR,
                  "the option structure requires what these equations do not have: some constraints contain too few "
                  "coordinates.");
  }
  problem().check_rates(point.t, point.x);
  const std::vector<double> x = with_consistent_motion(point, options);
  const PointOfInterest consistent{point.t, point.toward, x.data()};
  if (is_array) return array().analyze(consistent, options, decisions);
  extended().analyze(consistent, options, decisions);
  if (motion_stays(problem().sizes(), x.data(), extended().accepted_point().x.data())) return;
  extended().forget_system();
  throw Failure(SFDAE_RANK_UNCLEAR,
                format("the equations with their derivatives are too badly conditioned at t = %.15g: values that are "
                       "consistent do not stay as they are.",
                       point.t));
}

// Forces are unknowns of the first-order equations, and have to be unique.
std::unique_ptr<SensitivitySystem> StructuredMultibody::sensitivities(std::vector<int> parameters) {
  const int redundant = system()->analysis().values.u;
  if (redundant > 0)
    throw Failure(
        SFDAE_ILLEGAL_ARGUMENT,
        format("there are no sensitivities with redundant constraints, whose forces are not unique: %d of them "
               "depend on others. Leave these out.",
               redundant));
  return active().sensitivities(std::move(parameters));
}

void StructuredMultibody::demand_derivatives(const PointOfInterest& point, const ModelOptions& options) {
  if (formulation() == Formulation::own) local_.demand_derivatives(point, options);
}

// Local coordinates at the point accepted last, for what has no sparse form.
MultibodyModel& StructuredMultibody::analyzed_local() {
  if (formulation() == Formulation::own) return local_;
  const Jet jet = accepted_point();
  const MultibodySystem* known = local_.system();
  if (known == nullptr || known->accepted_point().t != jet.t ||
      !std::equal(known->accepted_point().q.begin(), known->accepted_point().q.end(), jet.x.begin()))
    analyze_own();
  return local_;
}

// ---- Points ----------------------------------------------------------------------------------------------------

// What holds to rounding stays; what does not moves in the metric of the kinetic energy, with dense matrices.
std::vector<double> StructuredMultibody::with_consistent_motion(const PointOfInterest& point,
                                                                const ModelOptions& options) {
  const MultibodySizes& sizes = problem().sizes();
  const ConsistencyRequest request = options.request_at(point.x);
  MultibodyConsistency consistency(problem(), point.t, request, options.ignore_inconsistency);
  const std::vector<double> q = consistency.positions(point.x);
  const std::vector<double> v = consistency.velocities(q, point.x + sizes.positions, sizes.constraints());
  std::vector<double> x(point.x, point.x + n());
  std::copy(q.begin(), q.end(), x.begin());
  std::copy(v.begin(), v.end(), x.begin() + sizes.positions);
  return x;
}

// Where the extension has been analyzed is no need to search again.
template <class Find>
ConsistentPoint StructuredMultibody::consistent(const PointOfInterest& point, const ModelOptions& options,
                                                Find find) {
  const std::vector<double> given(point.x, point.x + n());
  std::vector<double> x = with_consistent_motion(point, options);
  const Jet known = accepted_point();
  if (known.t == point.t && motion_stays(problem().sizes(), x.data(), known.x.data())) x = known.x;
  ModelOptions plain = options;
  plain.consistency.kind = InitialValues::nearest;
  plain.consistency.weights.clear();
  plain.consistency.fixed.clear();
  ConsistentPoint found = find(PointOfInterest{point.t, point.toward, x.data()}, plain);
  const ConsistencyRequest request = options.request_at(given.data());
  report_change_of_motion(problem().sizes(), {request, point.t, given}, found);
  return found;
}

ConsistentPoint StructuredMultibody::consistent_point(const PointOfInterest& point, const ModelOptions& options) {
  if (formulation() == Formulation::own) return local_.consistent_point(point, options);
  return consistent(point, options, [this](const PointOfInterest& near, const ModelOptions& plain) {
    return active().consistent_point(near, plain);
  });
}

ConsistentPoint StructuredMultibody::consistent_point_beside(const PointOfInterest& point,
                                                             const ModelOptions& options) {
  if (formulation() == Formulation::own) return local_.consistent_point_beside(point, options);
  return consistent(point, options, [this](const PointOfInterest& near, const ModelOptions& plain) {
    return active().consistent_point_beside(near, plain);
  });
}

// A structure that is confirmed leaves no constraint that depends on others.
ConstraintsReport StructuredMultibody::constraints() {
  if (formulation() != Formulation::extension) return analyzed_local().constraints();
  const MultibodySizes& sizes = problem().sizes();
  const Jet jet = extended().accepted_point();
  MultibodyPoint point;
  point.resize(sizes);
  point.set(jet.t, jet.x.data(), jet.x.data() + sizes.positions);
  const CallbackError error = problem().at_velocity(point.t, point.q.data(), point.v.data(), point.terms);
  if (error.status != SFDAE_OK) error.raise();
  point.measure_rows();
  return {.t = point.t,
          .holonomic = sizes.holonomic,
          .nonholonomic = sizes.nonholonomic,
          .redundant = 0,
          .degrees_of_freedom = sizes.velocities - sizes.constraints(),
          .position_freedom = sizes.positions - sizes.holonomic,
          .condition = condition_of_constraints(point),
          .partitions = 0,
          .position_residual = position_residual(point),
          .velocity_residual = velocity_residual(point)};
}

}  // namespace sfdae::core
