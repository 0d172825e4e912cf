// SPDX-License-Identifier: BSD-3-Clause
#include "solver/solver_source.h"

#include <algorithm>
#include <vector>

#include "extension/extension_model.h"
#include "linalg/format.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

void demand_exportable(const Solver& solver) {
  if (solver.model.multibody() != nullptr)
    refuse_argument(
        "multibody systems have no source: record q' = S v, M v' = f - G^T lambda, 0 = g as equations F(t, x, x') = "
        "0 "
        "and export these.");
  if (solver.model.evaluator() == nullptr || !solver.model.has_structure())
    refuse_argument("only recorded equations, as many as unknowns and without callbacks, have a source.");
  if (solver.system() == nullptr)
    throw Failure(SFDAE_NOT_STARTED, "call sfdae_analyze, sfdae_analyze_at or sfdae_start first.");
}

// The current point of the solver; x: zero for linear equations before a start. xdot: if known, because F = 0 may
// permit several values.
PointOfInterest present_point(Solver& solver, std::vector<double>& x, std::vector<double>& xdot) {
  double t = solver.system()->t();
  x.assign(index(solver.model.n()), 0.0);
  if (const Jet* const jet = solver.system()->point_of_equations(); jet != nullptr) {
    t = jet->t;
    std::copy_n(jet->column(0), x.size(), x.begin());
    if (jet->order > 0) xdot.assign(jet->column(1), jet->column(1) + jet->n);
  } else if (solver.integration) {
    x = solver.solution_at(t);
  }
  return {t, time_beside(t, solver.direction), x.data(), xdot.empty() ? nullptr : xdot.data()};
}

}  // namespace

std::string source_of(Solver& solver, Language language, const char* name) {
  demand_exportable(solver);
  RecordedProblem problem(*solver.model.evaluator());
  problem.set_equation_names(solver.problem().equation_names());
  problem.stop_with(solver.problem());
  if (problem.structure() == nullptr)
    refuse_argument(
        "some equations contain too few unknowns for a structure, as sfdae_get_structure tells: there is no source.");
  std::vector<double> x, xdot;
  const PointOfInterest point = present_point(solver, x, xdot);
  ExtensionModel model(problem, solver.problem());
  std::vector<RankDecision> decisions;
  try {
    model.analyze(point, solver.options.model, decisions);
  } catch (const Failure& failure) {
    throw Failure(failure.status(),
                  std::string("the minimal extension, which is what can be exported, fails here: ") + failure.what());
  }
  ExtensionSystem& system = *model.system();
  const CharacteristicValues &values = solver.system()->analysis().values, &of_structure = system.analysis().values;
  if (of_structure.d != values.d)
    throw Failure(SFDAE_RANK_UNCLEAR, "structure gives (" + describe(of_structure) + "), the analysis (" +
                                          describe(values) + "): what would be exported is not that system.");
  const ExportedSystem exported =
      exported_system(system.extension(), system.linearization().choice(), system.accepted_jet());
  return source_of(exported, {language, name, values, solver.problem().equation_names()});
}

}  // namespace sfdae::core
