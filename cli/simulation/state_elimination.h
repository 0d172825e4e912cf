// States that other states give explicitly: positions of bodies by angles of joints, relative angles by absolute ones.
// If a constraint gives x = f(states, t), f replaces x, and its derivative by the chain rule replaces x', which may
// give velocities explicitly in turn. The remaining system has a lower index and far fewer unknowns: a tree of bodies
// becomes an ordinary differential equation in its joint coordinates.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulation/aliases.h"
#include "simulation/system.h"

namespace sfdae::cli {

// variable = value, in remaining states and time; derivative: time derivative of value.
struct ExplicitState {
  int variable = -1;
  Formula value = -1, derivative = -1;
};

// Data of the elimination: it rewrites residuals, marks those that are used up and updates system.is_state.
struct Reducible {
  System& system;
  std::vector<Residual>& residuals;  // in roots of aliases
  std::vector<char>& used;
  const Aliases& aliases;
  const std::vector<int>& ranks;              // of variables; lower ones are eliminated first
  const std::vector<char>& is_state_outside;  // by variable: its derivative occurs in other formulas
};

std::vector<ExplicitState> eliminate_states(const Reducible& reducible);

}  // namespace sfdae::cli
