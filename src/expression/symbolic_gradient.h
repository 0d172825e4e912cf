// Derivatives of a recorded expression, recorded themselves: for equations that contain them.
//
// [GW08] A. Griewank, A. Walther: Evaluating Derivatives, 2nd ed. SIAM, 2008. Chapter 3: the reverse mode.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "expression/recorder.h"

namespace sfdae::core {

// Nodes of the derivatives of `node` by the first `count` unknowns; at kinks, those of the active branch.
std::vector<int> symbolic_gradient(Recorder& recorder, int node, int count);
// Derivatives by nodes of leaves.
std::vector<int> symbolic_gradient(Recorder& recorder, int node, const std::vector<int>& leaves);

// Nodes of the partial derivatives of a node by its operands, -1 if there is none. For any operation except leaves,
// calls of functions and `choose`, whose operands count on their branch only.
std::array<int, 3> symbolic_partials(Recorder& recorder, int node);

// The total derivative by time, in terms of x'; none if that needs x'', as the node depends on x'.
std::optional<int> symbolic_time_derivative(Recorder& recorder, int node);

}  // namespace sfdae::core
