// The diagnostics report as text; names of statuses; version.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <string>

#include "c_api/codes.h"
#include "c_api/hybrid_report.h"
#include "c_api/solver.h"
#include "c_api/structs.h"
#include "c_api/structure_report.h"

namespace sfdae::core {

namespace {

const char* name_of(Verdict verdict) {
  constexpr const char* names[] = {"clear", "confirmed", "UNCLEAR", "rank_tol"};
  return names[code_of(verdict)];
}

std::string matrix_name(const RankDecision& decision) {
  switch (decision.subject) {
    case Subject::stage: return format("y_%d", decision.stage);
    case Subject::constraints: return "A2";
    case Subject::differential: return "E T2";
    case Subject::block: return format("J_%d", decision.stage);
    default: return "M";
  }
}

// Large systems have thousands of blocks: then those nearest to singular ones are shown.
std::string decision_table(std::vector<RankDecision> decisions) {
  constexpr std::size_t most = 60, shown = 20;
  const std::size_t count = decisions.size();
  std::string text = "  t             level  matrix  size       rank  smallest kept  largest dropped  decision\n";
  if (count > most) {
    std::stable_sort(decisions.begin(), decisions.end(),
                     [](const RankDecision& a, const RankDecision& b) { return a.gap < b.gap; });
    decisions.resize(shown);
  }
  for (const RankDecision& decision : decisions)
    text += format("  %-12.6g  %-5d  %-6s  %-9s  %-4d  %-13.1e  %-15.1e  %s\n", decision.t, decision.level,
                   matrix_name(decision).c_str(), format("%dx%d", decision.rows, decision.cols).c_str(),
                   decision.rank, decision.kept, decision.dropped, name_of(decision.verdict));
  if (count > most) text += format("  ... (the %zu of %zu with the smallest gaps)\n", shown, count);
  return text;
}

std::string analysis_report(const sfdae_solver& solver) {
  const IndexAnalysis& analysis = solver.system()->analysis();
  const CharacteristicValues& values = analysis.values;
  std::string text = format("strangeness index %d", values.mu);
  if (values.u == 0 && values.v == 0) text += format(" (differentiation index %d)", values.a > 0 ? values.mu + 1 : 0);
  text += format(": d = %d, a = %d, u = %d, v = %d\n", values.d, values.a, values.u, values.v);
  const double gap = smallest_gap(solver.decisions.different());
  Verdict worst = Verdict::clear;
  for (const RankDecision& decision : solver.decisions.different()) worst = std::max(worst, decision.verdict);
  const char* summary = worst == Verdict::clear       ? "every decision is safe"
                        : worst == Verdict::confirmed ? "doubtful decisions were confirmed by a second computation"
                        : worst == Verdict::user      ? "ranks were decided by rank_tol"
                                                      : "not every decision is safe";
  if (!solver.decisions.empty())
    text += summary + (gap < 1e300 ? format(": smallest gap %.0e\n", gap) : std::string("\n"));
  constexpr const char* leading[] = {"", "W = E^+ E", "W = E", "W = I"};
  text += format("time scale %.3g, leading term %s\n", analysis.time_scale,
                 leading[code_of(solver.system()->leading_term())]);
  if (analysis.distance > 0.0)
    text += format("the smallest relative change of the data that gives another answer is about %.0e\n",
                   analysis.distance);
  return text;
}

std::string initial_report(const sfdae_initial_report& report) {
  std::string text = format("Initial values at t = %.10g: constraint residual was %.1e, now %.1e; ", report.t,
                            report.residual_before, report.residual_after);
  text += report.component < 0 ? std::string("nothing changed")
                               : format("largest change %.4g in x[%d]", report.largest_change, report.component);
  return text + (report.derivative_exact != 0 ? "\n" : "; algebraic part of x' by differences\n");
}

std::string constraints_report(const sfdae_solver& solver) {
  const ConstraintsReport report = solver.kind.multibody->constraints();
  std::string text =
      format("Multibody system: %d holonomic and %d nonholonomic constraints", report.holonomic, report.nonholonomic);
  if (report.redundant > 0) text += format(", %d of them redundant", report.redundant);
  text += format("; %d degrees of freedom, %d independent positions\n", report.degrees_of_freedom,
                 report.position_freedom);
  text += format("  at t = %.10g: ", report.t);
  text += report.partitions > 0
              ? format("partition number %ld, of condition %.2g", report.partitions, report.condition)
              : format("sparse matrices; constraints of condition %.2g", report.condition);
  text +=
      format("; residuals %.1e (positions), %.1e (velocities)\n", report.position_residual, report.velocity_residual);
  return text;
}

// The stages of a Radau step of odd order 2s - 1.
std::string method_name(const sfdae_solver& solver, int order) {
  const bool automatic = solver.options.integration.method == Method::automatic;
  std::string name = "BDF";
  if (solver.integration->method() == Method::radau)
    name = order > 0 ? format("Radau IIA with %d stage%s", (order + 1) / 2, order > 1 ? "s" : "")
                     : std::string("Radau IIA");
  return automatic ? name + " (chosen automatically)" : name;
}

std::string integration_report(const sfdae_solver& solver) {
  const sfdae_statistics s = statistics_of(solver);
  std::string text =
      format("Integration to t = %.10g by %s: %ld steps, %ld error test failures, %ld other failures\n", s.t_internal,
             method_name(solver, s.last_order).c_str(), s.steps, s.error_failures, s.other_failures);
  text += format("  %ld reductions, %ld factorizations, ", s.reductions, s.factorizations);
  text += solver.kind.linear != nullptr && !solver.options.model.for_sensitivities
              ? format("%ld / %ld / %ld calls of E / A / f\n", s.evaluations_E, s.evaluations_A, s.evaluations_f)
          : solver.kind.multibody != nullptr
              ? format("%ld evaluations, %ld linearizations\n", s.evaluations_F, s.linearizations)
              : format("%ld evaluations of F along jets, %ld linearizations\n", s.evaluations_F, s.linearizations);
  text += format("  last step %.3g of order %d, next %.3g; smallest kept value %.1e\n", s.last_step, s.last_order,
                 s.next_step, s.smallest_kept);
  if (s.rounding > 1.0)
    text += format("  rounding errors of the equations exceed the tolerance of a component by a factor %.1e\n",
                   s.rounding);
  if (solver.system()->analysis().values.v > 0)
    text += format("  largest relative residual of redundant equations %.1e\n", s.consistency);
  return text;
}

std::string sensitivities_report(const sfdae_solver& solver) {
  sfdae_sensitivity_statistics s{};
  s.size = sizeof s;
  sfdae_get_sensitivity_statistics(&solver, &s);
  if (solver.integration->adjoint() == nullptr)
    return format(
        "  %d sensitivities: %ld linearizations, %ld factorizations, %ld error test failures, %ld outputs\n", s.count,
        s.linearizations, s.factorizations, s.error_test_failures, s.outputs);
  return report_of(s.count, solver.integration->adjoint()->work());
}

}  // namespace

std::string report_of(int count, const AdjointWork& work) {
  std::string text = format("  adjoint of %d parameters: %ld steps kept in %.2g MB", count, work.kept_steps,
                            static_cast<double>(work.bytes) / 1e6);
  if (work.checkpoints > 0)
    text += format(", with %ld checkpoints; %ld steps made again", work.checkpoints, work.repeated_steps);
  return text + "\n";
}

std::string report_of(const sfdae_solver& solver) {
  const int m = solver.model.m(), n = solver.model.n();
  const std::string about_modes = solver.hybrid != nullptr ? mode_report(solver) : std::string();
  if (solver.system() == nullptr && solver.decisions.empty())
    return format("no analysis yet (m = %d equations, n = %d unknowns)\n", m, n) + about_modes +
           breakpoints_report(solver);
  // A checkpoint has the analysis without its decisions.
  const double t = solver.decisions.empty() ? solver.system()->analysis().t : solver.decisions[0].t;
  std::string text = format("Index analysis at t = %.10g (m = %d equations, n = %d unknowns)\n", t, m, n);
  text += solver.decisions.empty() ? "  restored from a checkpoint, without its rank decisions\n"
                                   : decision_table(solver.decisions.all());
  text += solver.system() != nullptr ? analysis_report(solver) : "the analysis failed\n";
  if (solver.system() != nullptr && solver.kind.multibody != nullptr) text += constraints_report(solver);
  if (const auto extension = solver.model.extension())
    text += structure_report(*extension, solver.model.structure_evaluator()->record());
  if (solver.initial_report) text += initial_report(*solver.initial_report);
  if (solver.integration) text += integration_report(solver);
  if (solver.integration && solver.integration->has_companion()) text += sensitivities_report(solver);
  text += breakpoints_report(solver) + about_modes;
  if (solver.message[0] != '\0') text += std::string("Last message: ") + solver.message + "\n";
  return text;
}

}  // namespace sfdae::core

extern "C" {

const char* sfdae_status_name(int status) {
#define SFDAE_NAME(name) \
  case name: return #name;
  switch (status) {
    SFDAE_NAME(SFDAE_OK)
    SFDAE_NAME(SFDAE_STEP_TAKEN)
    SFDAE_NAME(SFDAE_STOPPED)
    SFDAE_NAME(SFDAE_NOT_UNIQUE)
    SFDAE_NAME(SFDAE_INCONSISTENCY_IGNORED)
    SFDAE_NAME(SFDAE_EVENT)
    SFDAE_NAME(SFDAE_VALUES_CHANGED)
    SFDAE_NAME(SFDAE_INSTANCES_FAILED)
    SFDAE_NAME(SFDAE_ILLEGAL_ARGUMENT)
    SFDAE_NAME(SFDAE_OUT_OF_MEMORY)
    SFDAE_NAME(SFDAE_BUSY)
    SFDAE_NAME(SFDAE_EMPTY_PROBLEM)
    SFDAE_NAME(SFDAE_NOT_STARTED)
    SFDAE_NAME(SFDAE_CALLBACK_STOPPED)
    SFDAE_NAME(SFDAE_CALLBACK_FAILED)
    SFDAE_NAME(SFDAE_NOT_FINITE)
    SFDAE_NAME(SFDAE_ORDER_MISSING)
    SFDAE_NAME(SFDAE_WRONG_DERIVATIVES)
    SFDAE_NAME(SFDAE_WRONG_PATTERN)
    SFDAE_NAME(SFDAE_INDEX_TOO_HIGH)
    SFDAE_NAME(SFDAE_RANK_UNCLEAR)
    SFDAE_NAME(SFDAE_CHARACTERISTICS_CHANGED)
    SFDAE_NAME(SFDAE_PRESCRIPTION_SINGULAR)
    SFDAE_NAME(SFDAE_INCONSISTENT_VALUES)
    SFDAE_NAME(SFDAE_INCONSISTENT_EQUATIONS)
    SFDAE_NAME(SFDAE_FIXED_VALUES)
    SFDAE_NAME(SFDAE_NO_CONSISTENT_VALUES)
    SFDAE_NAME(SFDAE_MAX_STEPS)
    SFDAE_NAME(SFDAE_STEP_TOO_SMALL)
    SFDAE_NAME(SFDAE_SINGULAR)
    SFDAE_NAME(SFDAE_TOLERANCE_TOO_SMALL)
    SFDAE_NAME(SFDAE_ZENO)
    SFDAE_NAME(SFDAE_INTERNAL)
    default: return "unknown status";
  }
#undef SFDAE_NAME
}

const char* sfdae_version(void) {
#define SFDAE_TEXT(x) #x
#define SFDAE_JOIN(a, b, c) SFDAE_TEXT(a) "." SFDAE_TEXT(b) "." SFDAE_TEXT(c)
  return SFDAE_JOIN(SFDAE_VERSION_MAJOR, SFDAE_VERSION_MINOR, SFDAE_VERSION_PATCH);
#undef SFDAE_JOIN
#undef SFDAE_TEXT
}

}  // extern "C"
