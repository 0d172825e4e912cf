// The exact strangeness index of equations that their minimal extension solves: one solve a level.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "extension/extension_linearization.h"
#include "extension/minimal_extension.h"

namespace sfdae::core {

// The largest k so that the recorded equations differentiated k times have a say in x, the states given: changes of
// these equations move some x_j then. linearization: usable, and made of the derivatives that the extension has now;
// these are no longer its own afterwards.
// tau: a unit of time that fits the equations: with theirs in it, effects do not depend on the user's.
int strangeness_index(MinimalExtension& extension, ExtensionLinearization& linearization, double tau);

}  // namespace sfdae::core
