// The minimal extension as a system F(t, z, z') = 0 of formulas, for use without the library:
//
//     f_i^(k) = 0,  k = 0, ..., c_i,   in the unknowns z = (x_j^(l), l = 0, ..., d_j, but x_j' of the states),
//
// x_j' of a state j is the derivative of its entry of z; derivatives that are entries of z themselves are algebraic
// unknowns, the dummy derivatives of [MS93]. There are as many equations as unknowns, and the system is
// strangeness-free (mu = 0) as long as the states determine the other unknowns. Derivatives are plain ones, without
// factorials.
//
// [MS93] S. E. Mattsson, G. Soederlind: Index Reduction in Differential-Algebraic Equations Using Dummy Derivatives.
//        SIAM J. Sci. Comput. 14 (1993), 677-692.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "expression/record.h"
#include "extension/minimal_extension.h"
#include "extension/state_matrix.h"
#include "system/jet.h"

namespace sfdae::core {

struct ExportedSystem {
  struct Unknown {
    int unknown, order;  // x_unknown^(order)
    bool is_state;       // its derivative is in the equations
  };
  struct Equation {
    int equation, order;  // f_equation, differentiated that often
  };
  struct Partial {
    int row, column;
    bool derivative;  // by z' instead of z
  };
  int size() const { return static_cast<int>(unknowns.size()); }
  int num_states() const;

  std::vector<Unknown> unknowns;
  std::vector<Equation> equations;
  std::vector<Partial> partials;  // those that are not zero, by rows
  // Equations: F first, then the partials.
  std::shared_ptr<const Record> formulas;
  double t = 0.0;
  std::vector<double> z, zdot;  // at t; F does not contain derivatives of entries that are not states
};

// jet: consistent, where the states were chosen. Throws Failure, SFDAE_ILLEGAL_ARGUMENT, if equations call functions
// that are not formulas.
ExportedSystem exported_system(const MinimalExtension& extension, const StateChoice& choice, const Jet& jet);

}  // namespace sfdae::core
