// Discrete equations and reactions, evaluated at events.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulation/tape.h"

namespace sfdae::cli {

class Discrete {
 public:
  explicit Discrete(const System& system);

  // Assigns all discrete variables; returns whether one changed. Throws Failure if interdependent ones do not settle.
  bool update(Values& values);

  // Sets the values of pre() from initial equations; returns whether one changed.
  bool set_initial(Values& values);

  // Returns whether a discrete variable differs from its previous value.
  bool differs_from_previous(const Values& values) const;
  // Sets pre() of all variables, including continuous ones, to their present values.
  void set_previous(Values& values) const { values.previous = values.variable; }

  void evaluate_reactions(Values& values) { reactions_.run(values); }
  bool is_active(int reaction) const { return reactions_[2 * reaction] > 0.0; }
  // Throws Failure if it is undefined whether a when clause acts. Evaluate the reactions first.
  void check_conditions(double t) const;
  double value(int reaction) const { return reactions_[2 * reaction + 1]; }

  // Computes all eliminated variables.
  void complete(Values& values) { others_.run(values); }

 private:
  const System& system_;
  Tape assignments_, initial_, reactions_, others_;
  std::vector<double> before_;
};

}  // namespace sfdae::cli
