// Reason for the early end of a simulation, except errors of the model (ModelError).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

#include "simulation/simulation.h"

namespace sfdae::cli {

class Failure : public std::runtime_error {
 public:
  Failure(Outcome outcome, int status, const std::string& message)
      : std::runtime_error(message), outcome_(outcome), status_(status) {}
  Outcome outcome() const { return outcome_; }
  int status() const { return status_; }

 private:
  Outcome outcome_;
  int status_;
};

}  // namespace sfdae::cli
