// Checkpoints of hybrid systems: the state of the run, followed by that of the solver of its mode.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "hybrid/hybrid_sensitivities.h"
#include "hybrid/hybrid_system.h"
#include "hybrid/switches.h"
#include "integrate/checkpoint_identity.h"
#include "linalg/archive.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

constexpr double mark = 5.0e7 + 1238.0;  // improbable as the first number of anything else

// State without that of the solvers.
struct HybridState {
  HybridRun run;
  std::vector<VisitCounts> left;
  std::vector<std::vector<double>> passages;  // of each transition
  std::vector<double> margins;
  std::size_t num_sensitivities = 0;
};

HybridState state_of(const HybridSystem& hybrid) {
  HybridState state{hybrid.run, {}, {}, {}, 0};
  if (hybrid.sensitivities) state.num_sensitivities = hybrid.sensitivities->names.size();
  for (const HybridMode& mode : hybrid.modes) state.left.push_back(mode.left);
  for (const HybridTransition& transition : hybrid.transitions) {
    state.passages.push_back(transition.passages);
    state.margins.push_back(transition.margin);
  }
  return state;
}

void archive_count(Archive& archive, long& count) {
  double value = static_cast<double>(count);
  archive.real(value);
  if (archive.is_reading() && !(value >= 0.0 && value <= 1e15 && value == std::floor(value))) throw DamagedArchive();
  count = static_cast<long>(value);
}

// Archives a number that must equal the one here.
void archive_size(Archive& archive, std::size_t size) {
  double value = static_cast<double>(size);
  archive.real(value);
  if (archive.is_reading() && value != static_cast<double>(size)) throw DamagedArchive();
}

void archive_state(Archive& archive, HybridState& state, std::size_t n) {
  HybridRun& run = state.run;
  archive_size(archive, static_cast<std::size_t>(mark));
  archive_size(archive, n);
  archive_size(archive, state.left.size());
  archive_size(archive, state.passages.size());
  // -1 without sensitivities, the value for entries that are not written.
  const int wanted = state.num_sensitivities > 0 ? 0 : -1;
  int has_sensitivities = wanted;
  archive.small(run.mode, run.visit.is_fresh, has_sensitivities);
  if (has_sensitivities != wanted)
    refuse_argument(
        wanted == 0
            ? "the checkpoint has no sensitivities: call sfdae_set_hybrid_sensitivities with count = 0 first."
            : "the checkpoint has sensitivities: call sfdae_set_hybrid_sensitivities with their parameters first.");
  if (wanted == 0) {
    archive_size(archive, state.num_sensitivities);
    archive.reals(run.moving.shifts, state.num_sensitivities);
  }
  for (double* value :
       {&run.start, &run.toward, &run.visit.entered, &run.t, &run.short_visits.first, &run.visit.short_time})
    archive.real(*value);
  archive.reals(run.x, n);
  archive.reals(run.xdot, n);
  run.passages = {run.passages.count(), {}};
  archive_count(archive, run.passages.forgotten);
  archive_count(archive, run.short_visits.count);
  archive.reals(state.margins, state.margins.size());
  for (VisitCounts& counts : state.left) {
    for (long* count : {&counts.visits, &counts.steps, &counts.error_failures, &counts.other_failures,
                        &counts.reductions, &counts.factorizations})
      archive_count(archive, *count);
    for (double* value : {&counts.duration, &counts.smallest_kept, &counts.consistency, &counts.rounding})
      archive.real(*value);
  }
  for (std::vector<double>& times : state.passages) {
    long count = static_cast<long>(times.size());
    archive_count(archive, count);
    if (count > 64) throw DamagedArchive();
    archive.reals(times, static_cast<std::size_t>(count));
  }
}

double hash_of_transitions(const HybridSystem& hybrid) {
  WordHash hash;
  for (const HybridTransition& transition : hybrid.transitions) {
    const sfdae_transition& given = transition.given;
    const int numbers[] = {given.from,
                           given.to,
                           given.kind,
                           given.direction,
                           given.guard != nullptr ? 1 : 0,
                           given.jump != nullptr ? 1 : 0};
    hash.add_all(numbers);
    hash.add(&given.time, 1);
  }
  return hash.value_as_real();
}

// Visits the equations and options of all modes except sliding modes, which follow from others, and the running mode:
// the checkpoint of its solver contains them, with the method with which the mode was entered.
template <class Use>
void for_each_identity(const HybridSystem& hybrid, int running, Use use) {
  for (int k = 0; k < static_cast<int>(hybrid.modes.size()); ++k) {
    const HybridMode& mode = hybrid.modes[index(k)];
    if (k == running || mode.surface != nullptr) continue;
    const SolverOptions& options = mode.solver->options;
    use(k, identity_of(mode.solver->model, options.model, options.integration.method));
  }
}

void write_identity(const HybridSystem& hybrid, Archive& archive) {
  double transitions = hash_of_transitions(hybrid);
  archive.real(transitions);
  for (const auto& each : hybrid.switches) {
    double surface = each->hash_of_surface();
    archive.real(surface);
  }
  for_each_identity(hybrid, hybrid.run.mode,
                    [&](int, const CheckpointIdentity& identity) { identity.write(archive); });
}

// Throws Failure if modes or transitions differ. running: the mode of the checkpoint.
void demand_same(const HybridSystem& hybrid, int running, Archive& archive) {
  double transitions = 0.0;
  archive.real(transitions);
  if (transitions != hash_of_transitions(hybrid))
    refuse_argument(
        "the checkpoint was made with other transitions: add those that it was made with, in their order.");
  for (const auto& each : hybrid.switches) {
    double surface = 0.0;
    archive.real(surface);
    if (surface != each->hash_of_surface())
      refuse_argument("the checkpoint was made with another surface of " + hybrid.name_of(each->modes().sliding) +
                      ", or other values of its parameters: add the switch that it was made with.");
  }
  for_each_identity(hybrid, running, [&](int mode, const CheckpointIdentity& identity) {
    try {
      identity.demand_same(archive);
    } catch (const Failure& failure) {
      throw Failure(failure.status(), hybrid.name_of(mode) + ": " + failure.what());
    }
  });
}

std::size_t own_size(const HybridSystem& hybrid) {
  HybridState state = state_of(hybrid);
  Archive counter = Archive::counter();
  archive_state(counter, state, index(hybrid.width()));
  write_identity(hybrid, counter);
  return counter.size();
}

// Reads the state of the run; own: the position where the checkpoint of the solver begins.
HybridState read_state(const HybridSystem& hybrid, const double* checkpoint, std::size_t length, std::size_t& own) {
  HybridState state = state_of(hybrid);
  state.run = {};
  Archive archive = Archive::reader(checkpoint, length);
  archive_state(archive, state, index(hybrid.width()));
  if (state.run.mode < 0 || state.run.mode >= static_cast<int>(hybrid.modes.size())) throw DamagedArchive();
  demand_same(hybrid, state.run.mode, archive);
  own = archive.size();
  return state;
}

void restore(HybridSystem& hybrid, const SavedCheckpoint& saved) {
  std::size_t own = 0;
  HybridState state = read_state(hybrid, saved.values, saved.length, own);
  const int mode = state.run.mode;
  update_switches(hybrid);
  ask_for_sensitivities(hybrid);
  take_options_of_modes(hybrid, mode);
  set_transition_events(hybrid);
  hybrid.call(mode, [&saved, own](Solver& solver) {
    solver.restore_checkpoint({saved.values + own, saved.length - own});
  });
  // Nothing fails after this point.
  state.run.visit.integration = hybrid.modes[index(mode)].solver->integration.get();
  hybrid.run = std::move(state.run);
  for (std::size_t k = 0; k < hybrid.modes.size(); ++k) hybrid.modes[k].left = state.left[k];
  for (std::size_t k = 0; k < hybrid.transitions.size(); ++k) {
    hybrid.transitions[k].passages.swap(state.passages[k]);
    hybrid.transitions[k].margin = state.margins[k];
  }
}

}  // namespace

std::size_t HybridSystem::checkpoint_length() {
  std::size_t of_solver = 0;
  call(run.mode, [&of_solver](Solver& solver) { of_solver = solver.checkpoint_length(); });
  return own_size(*this) + of_solver;
}

void HybridSystem::save_checkpoint(double* to, std::size_t length) {
  const std::size_t own = own_size(*this);
  if (length <= own)
    refuse_argument(format("length = %zu, but the checkpoint has more than %zu doubles.", length, own));
  call(run.mode, [=](Solver& solver) { solver.save_checkpoint(to + own, length - own); });
  HybridState state = state_of(*this);
  Archive archive = Archive::writer(to, own);
  archive_state(archive, state, index(width()));
  write_identity(*this, archive);
}

void HybridSystem::restore_checkpoint(const SavedCheckpoint& saved) {
  if (sensitivities && sensitivities->by_adjoint)
    refuse_argument("checkpoints cannot hold the steps that are kept for the adjoint.");
  try {
    restore(*this, saved);
  } catch (const DamagedArchive&) {
    refuse_argument("the checkpoint is damaged, or one of another hybrid system.");
  }
}

}  // namespace sfdae::core
