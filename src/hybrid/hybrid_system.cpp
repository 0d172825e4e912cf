// SPDX-License-Identifier: BSD-3-Clause
#include "hybrid/hybrid_system.h"

#include <algorithm>
#include <utility>

#include "hybrid/switches.h"
#include "linalg/index.h"

namespace sfdae::core {

SolverInCall::SolverInCall(HybridSystem& hybrid, Solver& solver, int mode)
    : running_(hybrid.running), solver_(solver), limit_(solver.problem(), solver.options.max_seconds) {
  if (solver.busy.exchange(true))
    throw Failure(SFDAE_BUSY, hybrid.name_of(mode) + ": its solver is in another call.");
  running_.store(&solver);
}

SolverInCall::~SolverInCall() {
  running_.store(nullptr);
  solver_.busy.store(false);
}

HybridSystem::~HybridSystem() {
  for (HybridMode& mode : modes) {
    if (mode.solver->sensitivities) mode.solver->ask_for_sensitivities(std::nullopt);
    mode.solver->set_events(nullptr);
  }
}

std::string HybridSystem::name_of(int mode) const {
  const std::string& name = modes[index(mode)].name;
  return name.empty() ? format("mode %d", mode) : format("mode %d (%.80s)", mode, name.c_str());
}

bool HybridSystem::is_running() const {
  return run.mode >= 0 && run.visit.integration != nullptr &&
         mode().solver->integration.get() == run.visit.integration &&
         !(mode().surface != nullptr && is_outdated(*this, *mode().surface));
}

VisitCounts HybridSystem::counts_of(int mode) const {
  VisitCounts counts = modes[index(mode)].left;
  if (mode != run.mode) return counts;
  if (const Integration* integration = modes[index(mode)].solver->integration.get())
    counts.add(integration->counts());
  counts.duration += run.t - run.visit.entered;
  return counts;
}

int HybridSystem::add_mode(Solver& solver, const std::string& name) {
  modes.push_back({&solver, name, &transitions});
  run.mode = -1;
  return static_cast<int>(modes.size()) - 1;
}

int HybridSystem::add_transition(const sfdae_transition& transition) {
  transitions.push_back({transition, {}, 0.0, nullptr});
  events_are_set = false;
  run.mode = -1;
  return static_cast<int>(transitions.size()) - 1;
}

// If it fails, nothing has changed.
int HybridSystem::add_switch(int below, int above, std::shared_ptr<const Record> surface, const std::string& name) {
  const int sliding = static_cast<int>(modes.size());
  auto added = std::make_unique<Switch>(Switch::Modes{below, above, sliding}, *modes[index(below)].solver,
                                        *modes[index(above)].solver, std::move(surface));
  const std::size_t count = transitions.size();
  switches.reserve(switches.size() + 1);
  modes.push_back({added->solver(), name, &transitions, added.get()});
  try {
    const int from[] = {below, above, sliding, sliding}, to[] = {above, below, below, above};
    for (int k = 0; k < 4; ++k) {
      sfdae_transition transition{};
      transition.size = sizeof transition;
      transition.from = from[k];
      transition.to = to[k];
      transition.kind = SFDAE_TRANSITION_CONDITION;
      transition.function = Switch::condition(k);
      transition.user = added.get();
      transitions.push_back({transition, {}, 0.0, added.get()});
    }
  } catch (...) {
    while (transitions.size() > count) transitions.pop_back();
    modes.pop_back();
    throw;
  }
  // Nothing fails after this point.
  switches.push_back(std::move(added));
  events_are_set = false;
  run.mode = -1;
  return sliding;
}

void HybridSystem::set_sensitivities(std::optional<HybridSensitivities> wanted) {
  sensitivities = std::move(wanted);
  kept = {};
  run.mode = -1;
}

void HybridSystem::record(std::weak_ptr<SolutionPieces> pieces) {
  call(std::max(run.mode, 0), [&pieces](Solver& solver) { solver.record(pieces); });
  solution = std::move(pieces);
}

// Without the part of the mode above, the last unknown along surfaces.
void HybridSystem::evaluate_sensitivities(double t, double* S, double* Sdot) {
  const std::size_t given = index(n()), rows = index(mode().solver->model.n()), count = sensitivities->names.size();
  std::vector<double> values(rows * count), slopes(Sdot != nullptr ? rows * count : 0);
  call(run.mode, [&](Solver& solver) {
    return solver.integration->evaluate_sensitivities(t, values.data(), Sdot != nullptr ? slopes.data() : nullptr);
  });
  for (std::size_t j = 0; j < count; ++j) {
    std::copy_n(values.data() + j * rows, given, S + j * given);
    if (Sdot != nullptr) std::copy_n(slopes.data() + j * rows, given, Sdot + j * given);
  }
}

void HybridSystem::request_stop() {
  stop_is_requested.store(true);
  if (Solver* solver = running.load()) solver->problem().request_stop();
}

CallResult HybridSystem::said_by(int mode, CallResult result) const {
  if (result.status < 0 || result.status == SFDAE_STOPPED) throw Failure(result.status, std::move(result.message));
  if (!result.message.empty()) result.message = name_of(mode) + ": " + result.message;
  return result;
}

void HybridSystem::fail(Solver& solver, int mode, const Failure& failure) {
  const int status = failure.status();
  if (status == SFDAE_STOPPED) {
    solver.problem().take_stop_request();
    stop_is_requested.store(false);
  }
  const std::string said = failure.what();
  throw Failure(status, said.empty() ? said : name_of(mode) + ": " + said + solver.hint(status));
}

CallResult HybridSystem::call_with_analysis(int number, const double* x,
                                            const std::function<CallResult(Solver&)>& body) {
  HybridMode& mode = modes[index(number)];
  const bool had_analysis = mode.solver->system() != nullptr;
  const auto count_analysis = [&mode, had_analysis] {
    if (!had_analysis && mode.solver->system() != nullptr) ++mode.num_analyses;
  };
  try {
    CallResult result = call(number, body);
    count_analysis();
    return result;
  } catch (const Failure& failure) {
    count_analysis();
    if (!had_analysis || failure.status() != SFDAE_CHARACTERISTICS_CHANGED) throw;
  }
  ++mode.num_analyses;
  call(number, [this, x](Solver& solver) { return solver.analyze({run.t, run.toward_from(), x}); });
  return call(number, body);
}

}  // namespace sfdae::core
