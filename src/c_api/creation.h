// Functions that create the object of a handle: exceptions to status, and the message of this thread's last failure.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>

#include "c_api/solver.h"

namespace sfdae::core {

// The text that sfdae_message(NULL) returns to this thread.
using CreationMessage = char[sizeof(sfdae_solver::message)];
CreationMessage& creation_message();

// Runs the body of such a function.
template <class Body>
int creating(Body body) noexcept {
  return status_of(body, [](int status, const char* text) {
    std::snprintf(creation_message(), sizeof(CreationMessage), "%s", text);
    return status;
  });
}

}  // namespace sfdae::core
