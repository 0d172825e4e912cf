// Automatic choice of the method from recent failures and outputs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "integrate/integration_options.h"
#include "linalg/archive.h"

namespace sfdae::core {

struct MethodChoice {
  void note_attempt(bool is_accepted) { failure_rate += forgetting * ((is_accepted ? 0.0 : 1.0) - failure_rate); }
  void note_step() {
    output_rate += forgetting * (outputs - output_rate);
    outputs = 0;
  }
  void note_output() { outputs = std::min(outputs + 1, most_outputs); }

  // True if half of the attempts of Radau fail, or there are more outputs than stages: measured, BDF then needs fewer
  // reductions.
  bool prefers_bdf() const {
    return chosen == Method::automatic && (failure_rate > many_failures || output_rate > many_outputs);
  }
  void archive_rates(Archive& archive) {
    if (chosen != Method::automatic) return;
    archive.real(failure_rate);
    archive.real(output_rate);
  }

  // Weight of a new value in the running means: they cover about the last six values.
  static constexpr double forgetting = 0.15;
  static constexpr double many_failures = 0.5, many_outputs = 5.0;
  // Upper limit of the count: a checkpoint stores small integers, and this is two hundred times many_outputs.
  static constexpr int most_outputs = 1000;

  Method chosen = Method::bdf;                   // by the user, at the start
  double failure_rate = 0.0, output_rate = 0.0;  // running means: failures per attempt, outputs per step
  int outputs = 0;                               // since the last step
};

}  // namespace sfdae::core
