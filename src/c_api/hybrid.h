// The object of the handle sfdae_hybrid.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdio>
#include <vector>

#include "c_api/solver.h"
#include "hybrid/hybrid_system.h"
#include "sfdae/hybrid.h"

struct sfdae_hybrid : sfdae::core::HybridSystem {
  ~sfdae_hybrid();

  std::vector<sfdae_solver*> solvers;  // of the modes that the user has added
  std::atomic<bool> busy{false};
  mutable char message[sizeof(sfdae_solver::message) + 128] = "";
};

namespace sfdae::core {

// Runs the body of an API call: one at a time, exceptions to status and message.
template <class Body>
int guarded(sfdae_hybrid* hybrid, Body body) noexcept {
  if (hybrid == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  if (hybrid->busy.exchange(true)) return SFDAE_BUSY;
  const int returned = status_of(body, [hybrid](int status, const char* text) {
    std::snprintf(hybrid->message, sizeof hybrid->message, "%s", text);
    return status;
  });
  hybrid->busy.store(false);
  return returned;
}

[[noreturn]] inline void refuse_without_run() { throw Failure(SFDAE_NOT_STARTED, "call sfdae_start_hybrid first."); }

// Report on the system that it is a mode of; empty if there is none.
std::string modes_report(const sfdae_solver& solver);

}  // namespace sfdae::core
