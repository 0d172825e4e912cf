// SPDX-License-Identifier: BSD-3-Clause
#include "program/interruption.h"

#include <csignal>

#include <atomic>

namespace sfdae::cli {

namespace {

std::atomic<bool> interruption{false};
static_assert(std::atomic<bool>::is_always_lock_free);

// Restores the default action for the next signal.
extern "C" void note_interruption(int signal) {
  interruption.store(true);
  std::signal(signal, SIG_DFL);
}

}  // namespace

void note_interruptions() {
  std::signal(SIGINT, note_interruption);
  std::signal(SIGTERM, note_interruption);
}

bool was_interrupted() { return interruption.load(); }

}  // namespace sfdae::cli
