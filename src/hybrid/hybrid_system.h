// Hybrid system: modes with their solvers, transitions and switches between them, and a run across them.
//
// Folder hybrid: modes and transitions, motion along surfaces, sensitivities and checkpoints of such runs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "hybrid/hybrid_adjoint.h"
#include "hybrid/hybrid_run.h"
#include "hybrid/sliding.h"
#include "integrate/solution_pieces.h"
#include "problem/problem.h"
#include "sfdae/hybrid.h"
#include "solver/solver.h"

namespace sfdae::core {

struct HybridSystem;

struct HybridTransition {
  sfdae_transition given;
  std::vector<double> passages;  // the last times, at most `remembered`
  // Change of the function if x moves by its tolerances: a condition holds only above it.
  double margin = 0.0;
  Switch* surface = nullptr;  // switch to which it belongs
};

struct HybridMode {
  Solver* solver;
  std::string name;
  const std::deque<HybridTransition>* transitions;
  Switch* surface = nullptr;  // along which this mode slides, with one more unknown; it owns the solver
  // Set before a start. Transitions out of the mode, or out of the modes between which it slides, in order:
  std::vector<int> watched = {};  // events of the solver
  std::vector<int> timed = {};
  bool needs_slopes = false;  // for guards, or the rates of surfaces
  VisitCounts left = {};      // sum over ended visits
  int num_analyses = 0;
};

// Sensitivities requested from a system.
struct HybridSensitivities {
  std::vector<std::string> names;  // of parameters; empty: start values only
  std::vector<double> directions;  // n x count, at the start
  SensitivityOptions options;
  bool by_adjoint = false;  // stores at most max_kept_steps steps of a visit, 0: all
  long max_kept_steps = 0;
};

// Scope of a solver call that the hybrid system can stop. Throws Failure if the solver is already in a call.
class SolverInCall {
 public:
  SolverInCall(HybridSystem& hybrid, Solver& solver, int mode);
  SolverInCall(const SolverInCall&) = delete;
  SolverInCall& operator=(const SolverInCall&) = delete;
  ~SolverInCall();

 private:
  std::atomic<Solver*>& running_;
  Solver& solver_;
  TimeLimit limit_;
};

// Functions throw Failure, unless they return the result of a call; arguments have been checked.
struct HybridSystem {
  HybridSystem() = default;
  HybridSystem(const HybridSystem&) = delete;
  HybridSystem& operator=(const HybridSystem&) = delete;
  ~HybridSystem();

  int n() const { return modes.empty() ? 0 : modes.front().solver->model.n(); }
  // Length of x in the run.
  int width() const { return n() + (switches.empty() ? 0 : 1); }
  // "mode 1 (open)"
  std::string name_of(int mode) const;
  bool is_running() const;
  const HybridMode& mode() const { return modes[static_cast<std::size_t>(run.mode)]; }
  // Counts of a mode, including the present visit.
  VisitCounts counts_of(int mode) const;

  // These return the index of the new item. The solver must outlive the system.
  int add_mode(Solver& solver, const std::string& name);
  int add_transition(const sfdae_transition& transition);
  // The mode of the motion along surface = 0, between a mode below and one above it.
  int add_switch(int below, int above, std::shared_ptr<const Record> surface, const std::string& name);
  // Effective from the next start; empty: none.
  void set_sensitivities(std::optional<HybridSensitivities> wanted);
  // An expired pointer ends the recording.
  void record(std::weak_ptr<SolutionPieces> pieces);

  // The run has the point reached, whatever the status.
  CallResult start(int mode, const PointOfInterest& point);
  CallResult advance(double tout, bool stops_at_transition, bool wants_slopes);
  // May be called from any thread.
  void request_stop();
  // n x count, within the last step. Sdot may be null.
  void evaluate_sensitivities(double t, double* S, double* Sdot);
  // Adjoint functionals: n x num_times x count weights.
  struct Functionals {
    int num_times;
    const double* t;
    int count;
    const double* weights;
  };
  void gradient(const Functionals& functionals, double* gradient);

  std::size_t checkpoint_length();
  void save_checkpoint(double* to, std::size_t length);
  void restore_checkpoint(const SavedCheckpoint& saved);

  // Calls a solver, which stops when this system stops. Prefixes its messages with the name of the mode.
  template <class Body>
  CallResult call(Solver& solver, int mode, const Body& body) {
    const SolverInCall in_call(*this, solver, mode);
    try {
      if constexpr (std::is_void_v<std::invoke_result_t<const Body&, Solver&>>) body(solver);
      else return said_by(mode, body(solver));
    } catch (const Failure& failure) {
      fail(solver, mode, failure);
    }
    return {};
  }
  template <class Body>
  CallResult call(int mode, const Body& body) {
    return call(*modes[static_cast<std::size_t>(mode)].solver, mode, body);
  }
  // Repeats the call after a new analysis if the solver's previous one does not hold at (run.t, x).
  CallResult call_with_analysis(int mode, const double* x, const std::function<CallResult(Solver&)>& body);

  std::deque<HybridMode> modes;  // deques: events point into them
  std::deque<HybridTransition> transitions;
  std::vector<std::unique_ptr<Switch>> switches;
  std::optional<HybridSensitivities> sensitivities;
  KeptVisits kept;  // visits of the run, for the adjoint
  bool events_are_set = false;
  std::weak_ptr<SolutionPieces> solution;
  HybridRun run;
  std::atomic<bool> stop_is_requested{false};
  std::atomic<Solver*> running{nullptr};

 private:
  // Throws Failure if the result ends the call.
  CallResult said_by(int mode, CallResult result) const;
  [[noreturn]] void fail(Solver& solver, int mode, const Failure& failure);
};

// Sets events of all solvers after transitions were added; sets those of one solver.
void set_transition_events(HybridSystem& hybrid);
void set_events_of(HybridSystem& hybrid, int mode);

}  // namespace sfdae::core
