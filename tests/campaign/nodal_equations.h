// Modified nodal analysis of a circuit. Unknowns: potentials e of the nodes, currents i_L of inductors, currents i_V
// of voltage sources.
//
//   A_C C A_C^T e' = -A_R G A_R^T e - A_L i_L - A_V i_V - A_I i_I(t)
//           L i_L' =  A_L^T e
//                0 =  A_V^T e - v(t)
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "circuit.h"
#include "linear_problem.h"

namespace campaign {

struct NodalEquations {
  DenseMatrix E, A;
  // f has the terms amplitude * sin(omega t + phase).
  struct Source {
    int row;
    double amplitude, phase;
  };
  std::vector<Source> sources;
};

// Entries are added up branch by branch, as circuit simulators do, with their rounding errors.
NodalEquations nodal_equations(const Circuit& circuit);

LinearProblem nodal_problem(const Circuit& circuit, const CharacteristicValues& values);

}  // namespace campaign
