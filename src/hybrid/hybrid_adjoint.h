// Visits of modes with stored steps: the adjoint of a hybrid system goes back through them.
//
// S at the end of a visit is basis z + offset (TangentSpace). The transition and the start of the next mode map S
// linearly. This map is differentiated forward along the columns of the offset, one for each parameter, and of the
// basis; the adjoint of the next visit has both as parameters. Its gradient with respect to the basis columns are
// weights of z = coordinates S, and so of S at the end of the visit before.
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
  // Owned if it is a switch's solver, which may be replaced meanwhile; others belong to the user.
  std::shared_ptr<Solver> solver;
  double start, end;
  // State when the steps were made; the solver may change it later.
  std::shared_ptr<const DaeSystem> system;
  bool follows_structure;
  std::vector<double> parameters;
  std::unique_ptr<Integration> integration;
  bool is_whole;       // S at its end is z
  Matrix coordinates;  // otherwise z = coordinates S
};

struct KeptVisits {
  std::vector<KeptVisit> visits;
  TangentSpace ending;  // of the visit that is ending
};

// Columns that span S before a transition: first those of the parameters; rows: the unknowns of the mode, including the
// part of the mode above. at_once: the transition is at the start of the mode; then the columns are those of the start.
// Throws Failure.
std::vector<double> find_columns(HybridSystem& hybrid, bool at_once);
// Afterwards stores the integration of the mode that ends. A mode that is left at once does not affect gradients.
void keep_visit(HybridSystem& hybrid, bool at_once);

}  // namespace sfdae::core
