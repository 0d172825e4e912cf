// What stands behind the handle sfdae_hybrid: modes with their solvers, transitions, and a run across them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "c_api/hybrid_adjoint.h"
#include "c_api/sliding.h"
#include "c_api/solver.h"
#include "integrate/solution_pieces.h"
#include "sfdae/hybrid.h"

namespace sfdae::core {

// Counts that add up over the visits of a mode.
struct VisitCounts {
  double duration = 0.0;
  long visits = 0, steps = 0, error_failures = 0, other_failures = 0, reductions = 0, factorizations = 0;
  double smallest_kept = 0.0, consistency = 0.0, rounding = 0.0;
  void add(const sfdae_statistics& s);
};

struct HybridTransition {
  sfdae_transition given;
  std::vector<double> passages;  // the times of the last ones, at most `remembered`
  // What the function changes by if x moves by its tolerances: no condition counts below that.
  double margin = 0.0;
  Switch* surface = nullptr;  // of whose four transitions it is one
};

struct HybridMode {
  sfdae_solver* solver;
  std::string name;
  // Set before a start. Transitions out of the mode, or of one between which it slides, in their order:
  std::vector<int> watched;  // events of the solver
  std::vector<int> timed;
  bool needs_slopes = false;  // for guards, or the rates of surfaces
  const std::deque<HybridTransition>* transitions;
  VisitCounts left;  // of all visits that have ended
  int num_analyses = 0;
  Switch* surface = nullptr;  // along which this mode slides, with one more unknown; the solver is the switch's
};

// Sensitivities that a system was asked for.
struct HybridSensitivities {
  std::vector<std::string> names;  // of parameters; empty: of start values alone
  std::vector<double> directions;  // n x count, at the start
  SensitivityOptions options;
  bool by_adjoint = false;  // with so many steps kept of a visit, 0: all
  long max_kept_steps = 0;
};

// A run across modes. t, x, xdot: the point reached, with the part of the mode above in the end where there are
// switches.
struct HybridRun {
  int mode = -1;
  double start = 0.0, toward = 0.0, entered = 0.0;
  double t = 0.0;
  std::vector<double> x, xdot;
  bool is_fresh = false;  // conditions of the mode have not been looked at since it was entered
  const Integration* integration = nullptr;
  long short_visits = 0;  // the last ones, in which x has moved by a few tolerances only
  double first_short = 0.0, short_time = 0.0;
  long forgotten = 0;  // passages before a checkpoint
  std::vector<sfdae_passage> passages;
  std::vector<double> before, after, impulse;  // of the last one
  std::optional<double> accumulation;
  // With sensitivities: dt/dp of the last transition, 0 at the start, and the derivatives of the values there with
  // these, width() of them for each parameter. With the adjoint by all columns that S is a combination of.
  std::vector<double> shifts, moved;
  double time_before = 0.0;  // in which x is known to change little, before that
  CallResult warning;        // the first one of the call
  double direction() const { return toward < start ? -1.0 : 1.0; }
};

}  // namespace sfdae::core

struct sfdae_hybrid {
  ~sfdae_hybrid();
  int n() const { return modes.empty() ? 0 : modes.front().solver->model.n(); }
  // Of x in the run.
  int width() const { return n() + (switches.empty() ? 0 : 1); }
  // "mode 1 (open)"
  std::string name_of(int mode) const;
  bool is_running() const;
  const sfdae::core::HybridMode& mode() const { return modes[static_cast<std::size_t>(run.mode)]; }

  std::deque<sfdae::core::HybridMode> modes;  // deques: events point into them
  std::deque<sfdae::core::HybridTransition> transitions;
  std::vector<std::unique_ptr<sfdae::core::Switch>> switches;
  std::optional<sfdae::core::HybridSensitivities> sensitivities;
  sfdae::core::KeptVisits kept;  // of the run, with the adjoint
  bool events_are_set = false;
  std::weak_ptr<sfdae::core::SolutionPieces> solution;
  sfdae::core::HybridRun run;
  std::atomic<bool> busy{false}, stop_is_requested{false};
  std::atomic<sfdae_solver*> running{nullptr};
  mutable char message[sizeof(sfdae_solver::message) + 128] = "";
};

namespace sfdae::core {

// Runs the body of an API call: one at a time, exceptions to status and message.
template <class Body>
int guarded(sfdae_hybrid* hybrid, Body body) noexcept {
  if (hybrid == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  if (hybrid->busy.exchange(true)) return SFDAE_BUSY;
  CallResult result{SFDAE_INTERNAL, ""};
  const char* text = "";
  try {
    result = body();
    text = result.message.c_str();
  } catch (const std::bad_alloc&) {
    result.status = SFDAE_OUT_OF_MEMORY;
    text = out_of_memory;
  } catch (...) {
    text = "an exception came out of a callback.";
  }
  std::snprintf(hybrid->message, sizeof hybrid->message, "%s", text);
  hybrid->busy.store(false);
  return result.status;
}

inline CallResult no_run() { return {SFDAE_NOT_STARTED, "call sfdae_start_hybrid first."}; }

CallResult check_mode(const sfdae_hybrid& hybrid, const char* name, int mode);
CallResult check_name(const sfdae_hybrid& hybrid, const char* name);
// Events of all solvers, where transitions have been added.
CallResult set_transition_events(sfdae_hybrid& hybrid);
CallResult set_events_of(sfdae_hybrid& hybrid, int mode);
CallResult start_run(sfdae_hybrid& hybrid, int mode, const PointOfInterest& point);
// Calls a solver, and once more after a new analysis if the one that it had does not hold at the point of the run.
CallResult with_analysis(sfdae_hybrid& hybrid, int to, const double* x,
                         const std::function<int(sfdae_solver*)>& call);
// Where a switch leads to: `to`, or along the surface if that mode leads back.
CallResult choose_mode(sfdae_hybrid& hybrid, const HybridTransition& transition, int& to);
// Before a sliding mode begins other than by its switch: the part of the mode above. Fails where the surface does not
// attract.
CallResult prepare_sliding(sfdae_hybrid& hybrid, int mode);
// The equations of its sliding mode are made of other values of parameters, or for derivatives by others, than they
// are now.
bool is_outdated(const sfdae_hybrid& hybrid, const Switch& surface);
// Surfaces and sliding modes for what they are now; their solvers are asked for sensitivities.
CallResult update_switches(sfdae_hybrid& hybrid);
// Before a mode is entered: if it slides, with the options of its modes.
void take_options_of_modes(sfdae_hybrid& hybrid, int mode);
// Those of the start, width() x count.
std::vector<double> directions_at_start(const sfdae_hybrid& hybrid);
// Asks the solvers of all modes for what the system was asked for, or for none.
CallResult ask_for_sensitivities(sfdae_hybrid& hybrid);
// How the time of a transition moves with the parameters, and x there. at_once: with the transition before.
CallResult find_shifts(sfdae_hybrid& hybrid, const HybridTransition& transition, bool at_once);
// Then, with the values after it: how these move.
CallResult carry_over(sfdae_hybrid& hybrid, const sfdae_transition& given);
// Before a mode is entered, and after that: a start that is none of the system's begins with nothing of it.
void begin_sensitivities(sfdae_hybrid& hybrid, int mode);
void end_sensitivities(sfdae_hybrid& hybrid, int mode);
CallResult advance_run(sfdae_hybrid& hybrid, double tout, bool stops_at_transition, bool wants_slopes);
// The failure that a function of the user's returned.
CallResult of_callback(const char* what, const HybridRun& run, int returned);
// What the solver of a mode says, with its mode.
CallResult of_mode(const sfdae_hybrid& hybrid, int mode, int status);
// As messages call it.
const char* name_of_function(const sfdae_transition& given);
// Toward the end of the run, or beside t once that is passed.
double toward_from(const HybridRun& run);
// How much the function of a transition changes when x moves by its tolerances, or t by some roundings.
CallResult find_margin(const sfdae_hybrid& hybrid, const sfdae_transition& given, double& margin);
// The time in which x moves by a few tolerances. Visits that end before are counted.
double time_of_short_visit(const HybridRun& run, const Tolerances& tolerances);
void count_short_visit(HybridRun& run);
void note_passage(HybridTransition& transition, double t);
// SFDAE_ZENO after a transition that is one of too many.
CallResult check_accumulation(sfdae_hybrid& hybrid, const HybridTransition& last);
// Counts of a mode, the present visit included.
VisitCounts counts_of(const sfdae_hybrid& hybrid, int mode);

}  // namespace sfdae::core
