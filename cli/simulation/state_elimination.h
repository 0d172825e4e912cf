// States that other states give explicitly: positions of bodies by angles of joints, relative angles by absolute ones.
// Where constraints give x = f(states, t), f replaces x and its derivative by the chain rule x', which may give
// velocities explicitly in turn. The index of what remains is lower, and far fewer unknowns are left: a tree of
// bodies becomes an ordinary differential equation in the coordinates of its joints.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulation/aliases.h"
#include "simulation/system.h"

namespace sfdae::cli {

// variable = value, of remaining states and time; derivative: that of value.
struct ExplicitState {
  int variable = -1;
  Formula value = -1, derivative = -1;
};

// What the elimination works on; residuals are rewritten, those that are used up are marked, system.is_state follows.
struct Reducible {
  System& system;
  std::vector<Residual>& residuals;  // of roots of aliases
  std::vector<char>& used;
  const Aliases& aliases;
  const std::vector<int>& ranks;              // of variables; lower ones are eliminated first
  const std::vector<char>& is_state_outside;  // of variables: their derivatives occur in other formulas
};

std::vector<ExplicitState> eliminate_states(const Reducible& reducible);

}  // namespace sfdae::cli
