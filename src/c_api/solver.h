// What stands behind the handle sfdae_solver.
//
// Folder c_api: the functions of the public headers: argument checks, exceptions to status, conversion of structs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <vector>

#include "c_api/checks.h"
#include "c_api/problems.h"
#include "c_api/sensitivities.h"
#include "expression/steep_arguments.h"
#include "expression/time_breakpoints.h"
#include "expression/time_inputs.h"
#include "integrate/checkpoint.h"
#include "integrate/checkpoint_identity.h"
#include "integrate/jump_rule.h"
#include "linalg/kept_decisions.h"
#include "problem/failure.h"
#include "sfdae/sfdae.h"
#include "watch/events.h"

struct sfdae_hybrid;

namespace sfdae::core {

// The user's options in the form that the core wants.
struct SolverOptions {
  SolverOptions(const sfdae_options& options, int n);
  ModelOptions model;
  IntegrationOptions integration;
  bool xdot_is_guess;
  bool checks_derivatives;
};

// The jumps of data at breakpoints: by impulses of the equations.
class JumpsOfModel final : public JumpRule {
 public:
  explicit JumpsOfModel(sfdae_solver& solver) : solver_(solver) {}
  ConsistentPoint values_after(const PointOfInterest& before) override;
  void forget() { last_.reset(); }

  struct Crossed {
    double t;
    std::vector<double> before, after, impulse;
  };
  const std::optional<Crossed>& last() const { return last_; }

 private:
  sfdae_solver& solver_;
  std::optional<Crossed> last_;
};

// What carries a solution across a singular point: the consistent values nearest to its smooth continuation.
class ContinuationOfModel final : public ContinuationRule {
 public:
  explicit ContinuationOfModel(sfdae_solver& solver) : solver_(solver) {}
  ConsistentPoint look_at(const PointOfInterest& point) override;
  ConsistentPoint move_to(const PointOfInterest& point) override;

 private:
  ModelOptions options() const;

  sfdae_solver& solver_;
};

}  // namespace sfdae::core

struct sfdae_solver {
  sfdae_solver(sfdae::core::AnyModel its_kind, const sfdae_options& user_options)
      : sfdae_solver(std::move(its_kind), sfdae::core::SolverOptions(user_options, its_kind.model->n())) {}

  sfdae_solver(sfdae::core::AnyModel&& its_kind, sfdae::core::SolverOptions its_options)
      : kind(std::move(its_kind)), model(*kind.model), options(std::move(its_options)) {
    using Evaluators = std::vector<const sfdae::core::TaylorEvaluator*>;
    const Evaluators evaluators = model.evaluator() != nullptr ? model.evaluators_of_inputs() : Evaluators();
    breakpoints.emplace(evaluators);
    inputs.emplace(evaluators);
    steep_arguments.emplace(kind.nonlinear != nullptr ? evaluators : Evaluators());
    use_breakpoints(options.integration);
  }

  // Those of tables and those that are set, if there can be any.
  void use_breakpoints(sfdae::core::IntegrationOptions& integration_options) {
    const bool has_any = model.evaluator() != nullptr || breakpoints->has_times();
    integration_options.breakpoints = has_any ? &*breakpoints : nullptr;
    integration_options.inputs = inputs->count() > 0 ? &*inputs : nullptr;
    integration_options.steep_arguments = steep_arguments->empty() ? nullptr : &*steep_arguments;
    integration_options.jumps = breakpoints->has_times() ? &jumps : nullptr;
  }

  // Singular points are passed only if that was asked for.
  void use_continuation(sfdae::core::IntegrationOptions& integration_options) {
    integration_options.continuation = max_passed > 0 ? &continuation : nullptr;
    integration_options.max_passed = max_passed;
  }

  sfdae::core::Problem& problem() { return model.problem(); }
  // Null before an analysis.
  const sfdae::core::DaeSystem* system() const { return model.system(); }
  // Rows of the derivative array that structure does not ask for are left out.
  bool follows_structure() const {
    using sfdae::core::SystemForm;
    return (system() != nullptr && system()->form() == SystemForm::extension) ||
           (kind.nonlinear != nullptr && kind.nonlinear->follows_structure());
  }
  // Before the first step.
  void note_differentiations() { breakpoints->set_differentiations(system()->analysis().values.mu); }
  void forget_analysis() {
    integration.reset();
    model.forget_system();
    initial_report.reset();
  }

  sfdae::core::AnyModel kind;
  sfdae::core::Model& model;
  sfdae::core::SolverOptions options;
  sfdae::core::KeptDecisions decisions;  // of the last analysis, failed or not
  // After an analysis:
  double direction = 1.0;                       // of the nearby point of the analysis
  std::unique_ptr<sfdae::core::Events> events;  // options.integration points to them
  std::optional<sfdae::core::TimeBreakpoints> breakpoints;
  std::optional<sfdae::core::TimeInputs> inputs;
  std::optional<sfdae::core::SteepArguments> steep_arguments;
  sfdae::core::JumpsOfModel jumps{*this};
  sfdae::core::ContinuationOfModel continuation{*this};
  long max_passed = 0;                                  // singular points in an integration
  std::weak_ptr<sfdae::core::SolutionPieces> solution;  // where steps are recorded
  std::optional<sfdae::core::SensitivityRequest> sensitivities;
  // After a start:
  std::unique_ptr<sfdae::core::Integration> integration;
  std::optional<sfdae_initial_report> initial_report;

  std::atomic<bool> busy{false};
  const sfdae_hybrid* hybrid = nullptr;  // of which it is a mode, and which lives
  // Of the last call. Functions that only read leave it alone where it explains a failure.
  mutable char message[1536] = "";
  bool message_explains_failure = false;
};

namespace sfdae::core {

inline constexpr const char* out_of_memory = "out of memory.";
// Whose words stay: those of the call always; those that explain an earlier failure; or these unless the call has
// words to say with success, which are what was asked for.
enum class Text { of_call, of_failure, of_answer };

// What helps where a multibody system with callbacks fails: a look at its derivatives; where rows of the array are
// left out: the whole array.
inline const char* hint_of(const sfdae_solver& solver, int status) {
  if (status == SFDAE_CHARACTERISTICS_CHANGED && solver.follows_structure() && solver.kind.multibody != nullptr)
    return " With structure = SFDAE_STRUCTURE_OFF the constraint that depends on others may be named.";
  if (status == SFDAE_CHARACTERISTICS_CHANGED && solver.follows_structure())
    return solver.system() != nullptr && solver.system()->form() == SystemForm::extension
               ? " If structure alone misleads there, structure = SFDAE_STRUCTURE_OFF goes on beyond that point."
               : " Or set structure = SFDAE_STRUCTURE_OFF: rows of the derivative array were left out that may be "
                 "needed there.";
  const bool has_callbacks = solver.kind.multibody != nullptr && solver.kind.multibody->callbacks() != nullptr;
  switch (status) {
    case SFDAE_CHARACTERISTICS_CHANGED:
    case SFDAE_RANK_UNCLEAR:
    case SFDAE_NO_CONSISTENT_VALUES:
    case SFDAE_STEP_TOO_SMALL:
    case SFDAE_SINGULAR:
      return has_callbacks
                 ? " If that is a surprise: sfdae_check_multibody_derivatives compares the derivatives that "
                   "the callbacks supply with differences."
                 : "";
    default: return "";
  }
}

// What a body returns, or what an exception out of it means, goes to say(status, text), which returns the status.
template <class Body, class Say>
int status_of(Body body, Say say) noexcept {
  try {
    const CallResult result = body();
    return say(result.status, result.message.c_str());
  } catch (const Failure& failure) {
    return say(failure.status(), failure.what());
  } catch (const std::bad_alloc&) {
    return say(SFDAE_OUT_OF_MEMORY, out_of_memory);
  } catch (const std::exception& unexpected) {
    return say(SFDAE_INTERNAL, unexpected.what());
  } catch (...) {
    return say(SFDAE_INTERNAL, "an exception came out of a callback.");
  }
}

// Runs the body of an API call: one at a time, exceptions to status and message.
template <Text text_kept = Text::of_call, class Body>
int guarded(sfdae_solver* solver, Body body) noexcept {
  if (solver == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  if (solver->busy.exchange(true)) return SFDAE_BUSY;
  const auto say = [solver](int status, const char* text) {
    const bool is_answer = text_kept == Text::of_answer && status >= 0 && *text != '\0';
    if (text_kept == Text::of_call || is_answer) solver->message_explains_failure = status < 0;
    else if (solver->message_explains_failure) return status;
    if (*text == '\0') solver->message[0] = '\0';
    else std::snprintf(solver->message, sizeof solver->message, "%s%s", text, hint_of(*solver, status));
    return status;
  };
  const int status = status_of(body, say);
  if (status == SFDAE_STOPPED) solver->problem().take_stop_request();
  solver->busy.store(false);
  return status;
}

// The side of the start that nothing is evaluated on, and the end of the first piece.
void set_limits(sfdae_solver& solver, double t, double direction);
// The analysis and limits that consistent values at the point need; an integration ends.
void prepare_start(sfdae_solver& solver, const PointOfInterest& point);
// Index analysis; replaces system, forgets the integration.
void analyze(sfdae_solver& solver, PointOfInterest point);
sfdae_characteristics characteristics_of(const sfdae_solver& solver);
sfdae_statistics statistics_of(const sfdae_solver& solver);
sfdae_decision public_decision(const RankDecision& decision);
std::string report_of(const sfdae_solver& solver);

}  // namespace sfdae::core
