// Random RLC circuits with independent sources, and what topology says of their equations by modified nodal analysis.
//
// There is one solution if there is no loop of voltage sources alone and no cutset of current sources alone. Then
// u = v = 0; d is the number of capacitors in a normal tree (all V, then as many C as possible, then R, then L) and
// of inductors outside it (P. R. Bryant: The explicit form of Bashkow's A matrix. IRE Trans. CT-9, 1962). mu = 1 if
// there is a loop of capacitors and voltage sources with at least one source, or a cutset of inductors and current
// sources, else 0 (D. Estevez Schwarz, C. Tischendorf: Structural analysis of electric circuits and consequences for
// MNA. Int. J. Circ. Theor. Appl. 28, 2000; their tractability index is mu + 1, or 0 if a = 0).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "kronecker_form.h"

namespace campaign {

enum class BranchKind { resistor, capacitor, inductor, voltage_source, current_source };

// Nodes are numbered from 1, 0 is the ground. The current flows from `from` to `to` through the branch.
struct Branch {
  BranchKind kind;
  int from, to;
  double value;        // Ohm, F, H, amplitude in V or A
  double phase = 0.0;  // sources: value * sin(omega t + phase)
};

struct Circuit {
  int nodes = 0;
  double omega = 0.0;     // of all sources, 1/s
  double duration = 0.0;  // s
  std::vector<Branch> branches;
};

int unknowns(const Circuit& circuit);

// Nothing if the circuit has no solution or more than one.
std::optional<CharacteristicValues> values_by_topology(const Circuit& circuit);

// From ... to, in Ohm, F, H, s.
struct ComponentRanges {
  std::array<double, 2> resistance, capacitance, inductance, duration;
};
inline constexpr ComponentRanges unit_sizes{{0.3, 3.0}, {0.3, 3.0}, {0.3, 3.0}, {1.0, 1.0}};
inline constexpr ComponentRanges si_units{{1.0, 1e6}, {1e-12, 1e-6}, {1e-9, 1e-3}, {1e-9, 1e-3}};

// At most 7 nodes, n <= 20, one source or more, one solution.
Circuit random_circuit(const ComponentRanges& ranges, RandomNumbers& random);

// R1 - (C1 - C2 divider) - L - R2: a source with R1 at node 1, C1 from there to node 2, C2 from node 2 to the ground,
// L from node 1 or 2 to node 3, R2 from there to the ground. d = 3, mu = 0. If L is at node 1, the row of node 2 has
// capacitors only.
Circuit random_divider(RandomNumbers& random);

}  // namespace campaign
