// SPDX-License-Identifier: BSD-3-Clause
#include "hybrid/hybrid_report.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "linalg/index.h"
#include "solver/report.h"

namespace sfdae::core {

namespace {

constexpr std::size_t most_timed = 5, most_passages = 20;

// Timed transitions out of the present mode that lie ahead, the next ones first.
std::string timed_transitions(const HybridSystem& hybrid) {
  const HybridRun& run = hybrid.run;
  std::vector<std::pair<double, int>> ahead;
  for (const int k : hybrid.mode().timed) {
    const double away = (hybrid.transitions[index(k)].given.time - run.t) * run.direction();
    if (away > 0.0) ahead.emplace_back(away, k);
  }
  std::sort(ahead.begin(), ahead.end());
  std::string text;
  for (std::size_t k = 0; k < std::min(ahead.size(), most_timed); ++k) {
    const sfdae_transition& given = hybrid.transitions[index(ahead[k].second)].given;
    text += format("  next transition by time: t = %.10g to %s\n", given.time, hybrid.name_of(given.to).c_str());
  }
  return text;
}

// Report on the stored steps of the present and of ended visits.
std::string adjoint_report(const HybridSystem& hybrid) {
  if (!hybrid.sensitivities || !hybrid.sensitivities->by_adjoint) return "";
  AdjointWork all;
  const auto add = [&all](const Integration* integration) {
    if (integration == nullptr || integration->adjoint() == nullptr) return;
    const AdjointWork work = integration->adjoint()->work();
    all.kept_steps += work.kept_steps;
    all.checkpoints += work.checkpoints;
    all.repeated_steps += work.repeated_steps;
    all.bytes += work.bytes;
  };
  for (const KeptVisit& visit : hybrid.kept.visits) add(visit.integration.get());
  add(hybrid.mode().solver->integration.get());
  return report_of(static_cast<int>(hybrid.sensitivities->names.size()), all);
}

std::string passages_report(const HybridSystem& hybrid) {
  const HybridRun& run = hybrid.run;
  const std::size_t count = run.passages.known.size();
  const long all = run.passages.count();
  if (all == 0) return "";
  std::string text = format("%ld transitions", all);
  text += count == 0 ? ", all before a checkpoint\n" : count > most_passages ? ", the last ones:\n" : ":\n";
  for (std::size_t k = count > most_passages ? count - most_passages : 0; k < count; ++k) {
    const sfdae_passage& passage = run.passages.known[k];
    text += format("  t = %-16.10g %s -> %s, largest change %.3g, impulse %.3g\n", passage.t,
                   hybrid.name_of(passage.from).c_str(), hybrid.name_of(passage.to).c_str(), passage.largest_change,
                   passage.largest_impulse);
  }
  return text;
}

}  // namespace

std::string report_of(const HybridSystem& hybrid) {
  const HybridRun& run = hybrid.run;
  std::string text =
      format("Hybrid system of %zu modes and %zu transitions\n", hybrid.modes.size(), hybrid.transitions.size());
  text += "  mode                          index     d     a     u     v  visits  analyses     steps          time\n";
  for (int k = 0; k < static_cast<int>(hybrid.modes.size()); ++k) {
    const HybridMode& mode = hybrid.modes[index(k)];
    const VisitCounts counts = hybrid.counts_of(k);
    std::string values = "    -     -     -     -     -";
    if (const DaeSystem* system = mode.solver->system()) {
      const CharacteristicValues& c = system->analysis().values;
      values = format("%5d %5d %5d %5d %5d", c.mu, c.d, c.a, c.u, c.v);
    }
    text += format("%c %-30.30s", k == run.mode ? '>' : ' ', hybrid.name_of(k).c_str()) + values +
            format("  %6ld  %8d  %8ld  %12.6g\n", counts.visits, mode.num_analyses, counts.steps, counts.duration);
  }
  if (run.mode >= 0) {
    text +=
        format("At t = %.10g in %s since t = %.10g\n", run.t, hybrid.name_of(run.mode).c_str(), run.visit.entered);
    text += timed_transitions(hybrid) + breakpoints_report(*hybrid.mode().solver);
    text += adjoint_report(hybrid);
    if (hybrid.sensitivities && !hybrid.sensitivities->by_adjoint)
      text += format("  %zu sensitivities are carried over transitions\n", hybrid.sensitivities->names.size());
  }
  text += passages_report(hybrid);
  if (run.accumulation) text += format("transitions accumulate at t = %.10g\n", *run.accumulation);
  return text;
}

std::string mode_report(const HybridSystem& hybrid, int number) {
  const HybridRun& run = hybrid.run;
  std::string text = format("This is %s of a hybrid system of %zu modes and %zu transitions, ",
                            hybrid.name_of(number).c_str(), hybrid.modes.size(), hybrid.transitions.size());
  if (run.mode == number) text += format("which is in it since t = %.10g", run.visit.entered);
  else if (run.mode >= 0)
    text += "which is in " + hybrid.name_of(run.mode) + format(" since t = %.10g", run.visit.entered);
  else text += "which has not been started";
  text += format("; %ld visits, %ld transitions\n", hybrid.counts_of(number).visits, run.passages.count());
  if (run.mode == number) text += timed_transitions(hybrid);
  return text;
}

}  // namespace sfdae::core
