// Diagnostics report as text.
// SPDX-License-Identifier: BSD-3-Clause
#include "solver/report.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "linalg/format.h"
#include "solver/structure_report.h"

namespace sfdae::core {

namespace {

constexpr std::size_t most_breakpoints = 5;

const char* name_of(Verdict verdict) {
  constexpr const char* names[] = {"clear", "confirmed", "UNCLEAR", "rank_tol"};
  return names[static_cast<int>(verdict)];
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

// Large systems have thousands of blocks: then only those nearest to singular ones are shown.
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

std::string analysis_report(const Solver& solver) {
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
                 leading[static_cast<int>(solver.system()->leading_term())]);
  if (analysis.distance > 0.0)
    text += format("the smallest relative change of the data that gives another answer is about %.0e\n",
                   analysis.distance);
  return text;
}

std::string initial_report(const InitialReport& report) {
  std::string text = format("Initial values at t = %.10g: constraint residual was %.1e, now %.1e; ", report.t,
                            report.residual_before, report.residual_after);
  text += report.component < 0 ? std::string("nothing changed")
                               : format("largest change %.4g in x[%d]", report.largest_change, report.component);
  return text + (report.is_derivative_exact ? "\n" : "; algebraic part of x' by differences\n");
}

std::string constraints_report(const Solver& solver) {
  const ConstraintsReport report = solver.model.constraints();
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

// Name of the method; a Radau step of odd order 2s - 1 has s stages.
std::string method_name(const Solver& solver, int order) {
  const bool automatic = solver.options.integration.method == Method::automatic;
  std::string name = "BDF";
  if (solver.integration->method() == Method::radau)
    name = order > 0 ? format("Radau IIA with %d stage%s", (order + 1) / 2, order > 1 ? "s" : "")
                     : std::string("Radau IIA");
  return automatic ? name + " (chosen automatically)" : name;
}

// Describes the equations that replaced the problem's own ones.
std::string regularization_report(const Solver& solver) {
  if (!solver.regularized) return "";
  std::string text;
  const std::vector<FlatEquation>& terms = solver.regularized->parts().terms;
  if (!terms.empty())
    text = format("  terms that make equations regular where they are flat: %zu, the first in equation %d by x[%d]\n",
                  terms.size(), terms[0].equation, terms[0].unknown);
  std::size_t surfaces = 0;
  std::string first;
  for (const auto& round : solver.regularized->parts().rounds)
    for (const RegularizedCondition& each : round) {
      if (first.empty()) first = solver.conditions->equation_with(each.condition);
      if (each.condition == each.leader) ++surfaces;
    }
  if (surfaces > 0)
    text += format("  conditions both branches of which lead back to their zeros: %zu, the first in %s\n", surfaces,
                   first.c_str());
  if (text.empty()) text = "  by first-order equations, since branches of conditions have to be held\n";
  return text;
}

std::string switches_report(const SwitchLog& switches, double span) {
  if (switches.all().empty()) return "";
  std::string text = format("  switches of conditions: %zu", switches.all().size());
  if (switches.jumps() > 0) text += format(", with jumps of x by impulses: %ld", switches.jumps());
  if (switches.time_along_surfaces() > 0.0 && span > 0.0)
    text += format(", motion along surfaces: %.3g of the time", switches.time_along_surfaces() / span);
  return text + "\n";
}

std::string integration_report(const Solver& solver) {
  const IntegrationCounts counts = solver.integration->counts();
  const EvaluationCounts calls = solver.model.evaluations();
  const StepState state = solver.integration->stepper().state();
  std::string text = format(
      "Integration to t = %.10g by %s: %ld steps, %ld error test failures, %ld other failures\n", state.t,
      method_name(solver, state.last.order).c_str(), counts.steps, counts.error_failures, counts.other_failures);
  text += format("  %ld reductions, %ld factorizations, ", counts.reductions, counts.factorizations);
  text += solver.model.linear() != nullptr && !solver.options.model.for_sensitivities
              ? format("%ld / %ld / %ld calls of E / A / f\n", calls.E, calls.A, calls.f)
          : solver.model.multibody() != nullptr
              ? format("%ld evaluations, %ld linearizations\n", calls.F, calls.linearizations)
              : format("%ld evaluations of F along jets, %ld linearizations\n", calls.F, calls.linearizations);
  text += format("  last step %.3g of order %d, next %.3g; smallest kept value %.1e\n", state.last.h,
                 state.last.order, state.next_step, counts.smallest_kept);
  text += switches_report(solver.integration->switches(), solver.integration->span());
  text += regularization_report(solver);
  if (counts.rounding > 1.0)
    text += format("  rounding errors of the equations exceed the tolerance of a component by a factor %.1e\n",
                   counts.rounding);
  if (solver.system()->analysis().values.v > 0)
    text += format("  largest relative residual of redundant equations %.1e\n", counts.inconsistency);
  return text;
}

std::string sensitivities_report(const Solver& solver) {
  if (const DiscreteAdjoint* adjoint = solver.integration->adjoint())
    return report_of(adjoint->count() - solver.sensitivities->num_of_values, adjoint->work());
  const Sensitivities& sensitivities = *solver.integration->sensitivities();
  const SensitivityWork work = sensitivities.work();
  return format("  %d sensitivities: %ld linearizations, %ld factorizations, %ld error test failures, %ld outputs\n",
                sensitivities.count(), work.linearizations, work.factorizations, work.error_failures, work.outputs);
}

struct Upcoming {
  double t;
  const char* kind;
};

// At most one more than is shown. Breakpoints are copied because a search changes them.
std::vector<Upcoming> upcoming(TimeBreakpoints breakpoints, double t, double toward) {
  const double direction = toward < t ? -1.0 : 1.0;
  std::vector<Upcoming> list;
  if (const auto gap = breakpoints.gap_at(t)) t = gap->far_end(direction);
  while (list.size() <= most_breakpoints) {
    const auto next = breakpoints.next(t, toward);
    if (!next || next->t == t) break;
    const auto gap = breakpoints.gap_at(next->t);
    if (gap) list.push_back({0.5 * (gap->start + gap->end), gap->is_jump ? "jump" : "kink"});
    else list.push_back({next->t, "smooth"});
    t = gap ? gap->far_end(direction) : next->t;
  }
  return list;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::fabs(a[i] - b[i]));
  return largest;
}

}  // namespace

std::string report_of(int count, const AdjointWork& work) {
  std::string text = format("  adjoint of %d parameters: %ld steps kept in %.2g MB", count, work.kept_steps,
                            static_cast<double>(work.bytes) / 1e6);
  if (work.checkpoints > 0)
    text += format(", with %ld checkpoints; %ld steps made again", work.checkpoints, work.repeated_steps);
  return text + "\n";
}

std::string breakpoints_report(const Solver& solver) {
  const std::size_t set = solver.breakpoints->num_times();
  if (!solver.integration) return set > 0 ? format("Breakpoints: %zu are set\n", set) : "";
  const double t = solver.integration->stepper().state().t;
  constexpr double spans = 100.0;  // intervals of interest
  const double toward = t + spans * solver.integration->direction() * solver.integration->span();
  const std::vector<Upcoming> next = upcoming(*solver.breakpoints, t, toward);
  std::string text;
  for (std::size_t k = 0; k < std::min(next.size(), most_breakpoints); ++k)
    text += format("%s t = %.10g (%s)", k == 0 ? "Breakpoints: next" : ",", next[k].t, next[k].kind);
  if (next.size() > most_breakpoints) text += ", ...";
  if (next.empty() && set > 0) text = format("Breakpoints: none after t = %.10g", t);
  if (!text.empty()) text += '\n';
  if (const auto& last = solver.jumps.last())
    text += format("  the last jump was at t = %.10g: largest change %.3g\n", last->t,
                   largest_difference(last->before, last->after));
  return text;
}

std::string report_of(const Solver& solver, const std::string& about_modes) {
  const int m = solver.model.m(), n = solver.model.n();
  if (solver.system() == nullptr && solver.decisions.empty())
    return format("no analysis yet (m = %d equations, n = %d unknowns)\n", m, n) + about_modes +
           breakpoints_report(solver);
  // A checkpoint has the analysis without its decisions.
  const double t = solver.decisions.empty() ? solver.system()->analysis().t : solver.decisions[0].t;
  std::string text = format("Index analysis at t = %.10g (m = %d equations, n = %d unknowns)\n", t, m, n);
  text += solver.decisions.empty() ? "  restored from a checkpoint, without its rank decisions\n"
                                   : decision_table(solver.decisions.all());
  text += solver.system() != nullptr ? analysis_report(solver) : "the analysis failed\n";
  if (solver.system() != nullptr && solver.model.multibody() != nullptr) text += constraints_report(solver);
  if (const auto extension = solver.model.extension())
    text += structure_report(*extension, solver.model.structure_evaluator()->record());
  if (solver.initial_report) text += initial_report(*solver.initial_report);
  if (solver.integration) text += integration_report(solver);
  if (solver.integration && solver.integration->has_companion()) text += sensitivities_report(solver);
  return text + breakpoints_report(solver) + about_modes;
}

}  // namespace sfdae::core
