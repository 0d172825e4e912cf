// Inspection of a hybrid system's past integration: the C API.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "c_api/hybrid.h"
#include "c_api/structs.h"
#include "hybrid/hybrid_report.h"
#include "linalg/index.h"

namespace sfdae::core {

std::string modes_report(const sfdae_solver& solver) {
  if (solver.hybrid == nullptr) return "";
  const std::deque<HybridMode>& modes = solver.hybrid->modes;
  const auto is_its = [&solver](const HybridMode& mode) { return mode.solver == &solver; };
  const auto mode = std::find_if(modes.begin(), modes.end(), is_its) - modes.begin();
  return mode_report(*solver.hybrid, static_cast<int>(mode));
}

}  // namespace sfdae::core

using namespace sfdae::core;

namespace {

// Functions that only read, also from within callbacks.
template <class Body>
int query(const sfdae_hybrid* hybrid, Body body) noexcept {
  if (hybrid == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  return status_of(body, [hybrid](int status, const char* text) {
    if (status < 0) std::snprintf(hybrid->message, sizeof hybrid->message, "%s", text);
    return status;
  });
}

template <class Struct>
void fill(Struct* result, const Struct& source) {
  if (!fill_struct(result, source)) refuse_argument("result is NULL or its size is not set.");
}

sfdae_mode summary_of(const sfdae_hybrid& hybrid, int k) {
  const HybridMode& mode = hybrid.modes[index(k)];
  const VisitCounts counts = hybrid.counts_of(k);
  sfdae_mode summary{sizeof(sfdae_mode), counts.visits, counts.duration, counts.steps, mode.num_analyses, -1, -1, -1};
  if (mode.solver->system() == nullptr) return summary;
  const CharacteristicValues& values = mode.solver->system()->analysis().values;
  summary.strangeness_index = values.mu;
  summary.differential = values.d;
  summary.algebraic = values.a;
  return summary;
}

sfdae_statistics statistics_of_all(const sfdae_hybrid& hybrid) {
  sfdae_statistics sum{};
  if (hybrid.run.mode >= 0) sum = statistics_of(*hybrid.mode().solver);
  sum.size = sizeof sum;
  sum.steps = sum.error_failures = sum.other_failures = sum.reductions = sum.factorizations = 0;
  sum.evaluations_E = sum.evaluations_A = sum.evaluations_f = sum.evaluations_F = 0;
  sum.linearizations = sum.check_calls = 0;
  for (int k = 0; k < static_cast<int>(hybrid.modes.size()); ++k) {
    const VisitCounts counts = hybrid.counts_of(k);
    const sfdae_statistics calls = statistics_of(*hybrid.modes[index(k)].solver);
    sum.steps += counts.steps;
    sum.error_failures += counts.error_failures;
    sum.other_failures += counts.other_failures;
    sum.reductions += counts.reductions;
    sum.factorizations += counts.factorizations;
    sum.evaluations_E += calls.evaluations_E;
    sum.evaluations_A += calls.evaluations_A;
    sum.evaluations_f += calls.evaluations_f;
    sum.evaluations_F += calls.evaluations_F;
    sum.linearizations += calls.linearizations;
    sum.check_calls += calls.check_calls;
    if (counts.smallest_kept > 0.0)
      sum.smallest_kept =
          sum.smallest_kept > 0.0 ? std::min(sum.smallest_kept, counts.smallest_kept) : counts.smallest_kept;
    sum.consistency = std::max(sum.consistency, counts.consistency);
    sum.rounding = std::max(sum.rounding, counts.rounding);
  }
  return sum;
}

}  // namespace

extern "C" {

int sfdae_mode_init(sfdae_mode* mode, size_t size) { return initialize(mode, size, sfdae_mode{}); }
int sfdae_passage_init(sfdae_passage* passage, size_t size) { return initialize(passage, size, sfdae_passage{}); }

int sfdae_get_current_mode(const sfdae_hybrid* hybrid, int* mode) {
  return query(hybrid, [&] {
    if (mode == nullptr) refuse_argument("mode is NULL.");
    if (hybrid->run.mode < 0) refuse_without_run();
    *mode = hybrid->run.mode;
  });
}

int sfdae_get_mode(const sfdae_hybrid* hybrid, int mode, sfdae_mode* result) {
  return query(hybrid, [&] {
    if (mode < 0 || mode >= static_cast<int>(hybrid->modes.size()))
      refuse_argument(format("mode = %d; there are %zu modes.", mode, hybrid->modes.size()));
    return fill(result, summary_of(*hybrid, mode));
  });
}

int sfdae_get_num_passages(const sfdae_hybrid* hybrid, long* count) {
  return query(hybrid, [&] {
    if (count == nullptr) refuse_argument("count is NULL.");
    *count = hybrid->run.passages.count();
  });
}

int sfdae_get_passage(const sfdae_hybrid* hybrid, long number, sfdae_passage* result) {
  return query(hybrid, [&] {
    const PassageList& passages = hybrid->run.passages;
    const long first = passages.forgotten, count = passages.count();
    if (number < first || number >= count)
      refuse_argument(format("index = %ld; transitions from %ld on, below %ld, are known.", number, first, count));
    return fill(result, passages.known[static_cast<std::size_t>(number - first)]);
  });
}

int sfdae_get_passage_values(const sfdae_hybrid* hybrid, double* before, double* after, double* impulse) {
  return query(hybrid, [&] {
    const HybridRun& run = hybrid->run;
    if (run.passages.known.empty()) throw Failure(SFDAE_NOT_STARTED, "there was no transition since the start.");
    if (before != nullptr) std::copy_n(run.last.before.begin(), hybrid->n(), before);
    if (after != nullptr) std::copy_n(run.last.after.begin(), hybrid->n(), after);
    if (impulse != nullptr) std::copy_n(run.last.impulse.begin(), hybrid->n(), impulse);
  });
}

int sfdae_get_accumulation(const sfdae_hybrid* hybrid, double* t) {
  return query(hybrid, [&] {
    if (t == nullptr) refuse_argument("t is NULL.");
    if (!hybrid->run.accumulation) throw Failure(SFDAE_NOT_STARTED, "transitions have not accumulated.");
    *t = *hybrid->run.accumulation;
  });
}

int sfdae_get_hybrid_statistics(const sfdae_hybrid* hybrid, sfdae_statistics* result) {
  return query(hybrid, [&] { return fill(result, statistics_of_all(*hybrid)); });
}

int sfdae_report_hybrid(const sfdae_hybrid* hybrid, char* text, size_t length, size_t* needed) {
  return query(hybrid, [&] {
    if (text == nullptr && length > 0) refuse_argument("text is NULL.");
    const std::string report = report_of(*hybrid);
    if (length > 0) std::snprintf(text, length, "%s", report.c_str());
    if (needed != nullptr) *needed = report.size() + 1;
  });
}

}  // extern "C"
