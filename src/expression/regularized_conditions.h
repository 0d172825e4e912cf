// Equations that are continuous where a condition passes zero.
//
// The solution moves along a surface g = 0 if both branches of a condition g > 0 lead back to it [Fil88]. Equations
// become continuous there [ST96]: with u = 1/2 + g / (2 width) they are those of one branch for u <= 0, those of the
// other for u >= 1, and (1 - u) times the former and u times the latter in between. The solution stays within the width
// of the surface, and for smaller widths it tends to the motion along the surface. With several surfaces at once
// equations are linear in each u.
//
// [Fil88] A. F. Filippov: Differential Equations with Discontinuous Righthand Sides. Kluwer, 1988.
// [ST96]  J. Sotomayor, M. A. Teixeira: Regularization of discontinuous vector fields. Int. Conf. on Differential
//         Equations, Lisboa 1995. World Scientific, 1998, 207-223.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "expression/record.h"

namespace sfdae::core {

struct RegularizedCondition {
  std::size_t condition;  // number in the record
  double width;           // positive, in the unit of g
  // Conditions of one surface make one choice between its sides, by the g and the width of their leader, which is one
  // of them. is_opposite: g of this one has the other sign.
  std::size_t leader;
  bool is_opposite;
  bool operator==(const RegularizedCondition&) const = default;
};

// Largest number of surfaces; equations are recorded for all combinations of their sides. (Chosen.)
constexpr std::size_t most_surfaces = 8;

// Returns the equations in which choices by these conditions are continuous, with conditions that can be held. which:
// at most most_surfaces surfaces. The user's parameters keep their numbers.
std::shared_ptr<const Record> with_regularized(const Record& record, const std::vector<RegularizedCondition>& which);

}  // namespace sfdae::core
