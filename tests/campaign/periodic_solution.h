// Periodic solutions of circuits whose sources are sines of one frequency.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "circuit.h"
#include "integration.h"

namespace campaign {

// x(t) = Im(X exp(i omega t)), (i omega E - A) X = F, the solution through its value at 0; sizes are |X_j|, at least
// a thousandth of the largest potential or current. Nothing if rounding errors of the data change it by more than
// 1e-9 of these.
std::optional<ExactSolution> periodic_solution(const Circuit& circuit, RandomNumbers& random);

}  // namespace campaign
