// Discrete equations and reactions, evaluated at events.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulation/tape.h"

namespace sfdae::cli {

class Discrete {
 public:
  explicit Discrete(const System& system);

  // Assigns all discrete variables; returns whether one changed. Throws Failure where they depend on each other and do
  // not settle.
  bool update(Values& values);

  // Values of pre() that initial equations give; returns whether one changed.
  bool set_initial(Values& values);

  // Whether a discrete variable differs from its value before.
  bool differs_from_previous(const Values& values) const;
  // All pre() become what variables are now; those of continuous ones, too.
  void set_previous(Values& values) const { values.previous = values.variable; }

  void evaluate_reactions(Values& values) { reactions_.run(values); }
  bool is_active(int reaction) const { return reactions_[2 * reaction] > 0.0; }
  // Reactions have been evaluated. Throws Failure if it is undefined whether a when clause acts.
  void check_conditions(double t) const;
  double value(int reaction) const { return reactions_[2 * reaction + 1]; }

  // Fills in all variables that were eliminated.
  void complete(Values& values) { others_.run(values); }

 private:
  const System& system_;
  Tape assignments_, initial_, reactions_, others_;
  std::vector<double> before_;
};

}  // namespace sfdae::cli
