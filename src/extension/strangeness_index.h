// The exact strangeness index of equations that their minimal extension solves: one solution for each level.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "extension/extension_linearization.h"
#include "extension/minimal_extension.h"

namespace sfdae::core {

// The largest k for which the recorded equations differentiated k times affect x, the states given: changes of these
// equations move some x_j. linearization: usable, and made from the current derivatives of the extension, which are
// changed afterwards.
// tau: a unit of time that fits the equations: effects then do not depend on the user's.
int strangeness_index(MinimalExtension& extension, ExtensionLinearization& linearization, double tau);

}  // namespace sfdae::core
