// The object of the handle sfdae_solver.
//
// Folder c_api: the functions of the public headers: argument checks, exceptions to status, conversion of structs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>

#include "c_api/checks.h"
#include "problem/problem.h"
#include "sfdae/sfdae.h"
#include "solver/solver.h"
#include "solver/status_of.h"

struct sfdae_hybrid;

struct sfdae_solver : sfdae::core::Solver {
  using Solver::Solver;

  const sfdae_hybrid* hybrid = nullptr;  // of which it is a mode, and which lives
  // Message of the last call. Functions that only read do not change it if it explains a failure.
  mutable char message[1536] = "";
  bool message_explains_failure = false;
};

namespace sfdae::core {

// Message to keep: always that of the call; one that explains an earlier failure; or that one unless the call succeeds
// with a message, which is then its answer.
enum class Text { of_call, of_failure, of_answer };

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
    else std::snprintf(solver->message, sizeof solver->message, "%s%s", text, solver->hint(status));
    return status;
  };
  const auto call = [&] {
    const TimeLimit limit(solver->problem(), solver->options.max_seconds);
    return status_of(body, say);
  };
  const int status = call();
  if (status == SFDAE_STOPPED) solver->problem().take_stop_request();
  solver->busy.store(false);
  return status;
}

sfdae_characteristics characteristics_of(const Solver& solver);
sfdae_statistics statistics_of(const Solver& solver);

}  // namespace sfdae::core
