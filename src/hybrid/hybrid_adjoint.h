// Visits of modes whose steps are kept: gradients of hybrid systems go back through them.
//
// S at the end of a visit is basis z + offset (TangentSpace). What the transition and the start of the next mode make
// of S, a linear map, is differentiated forward for the columns of the offset, one for each parameter, and those of
// the basis; the adjoint of the next visit has both as parameters. Its gradient by the columns of the basis are
// weights of z = coordinates S, and so of S where the visit before ends.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "integrate/integration.h"
#include "linalg/matrix.h"
#include "system/adjoint_system.h"

namespace sfdae::core {

struct HybridSystem;
struct Solver;

struct KeptVisit {
  int mode;
  // That of a switch lives on while the visit is kept, whatever becomes of the sliding mode; others are the user's.
  std::shared_ptr<Solver> solver;
  double start, end;
  // As they are while steps are made; the solver may have others later.
  std::shared_ptr<const DaeSystem> system;
  bool follows_structure;
  std::vector<double> parameters;
  std::unique_ptr<Integration> integration;
  bool is_whole;       // S at its end is z
  Matrix coordinates;  // else z = coordinates S
};

struct KeptVisits {
  std::vector<KeptVisit> visits;
  TangentSpace ending;  // of the visit that is about to end
};

// S before a transition, as columns that it is a combination of: first those of the parameters; with the unknowns of
// the mode, the part of the mode above included. at_once: where the mode begins; then those that it has begun with.
// Throws Failure.
std::vector<double> find_columns(HybridSystem& hybrid, bool at_once);
// After that: the integration of the present mode, which is left. One that is left at once has no part in gradients.
void keep_visit(HybridSystem& hybrid, bool at_once);

}  // namespace sfdae::core
