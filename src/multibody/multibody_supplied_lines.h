// Derivatives that callbacks of a mechanical system supply, compared with their functions from one side.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "multibody/multibody_callbacks.h"

namespace sfdae::core {

// Point and limits of the check.
struct MultibodyCheckPoint {
  double t, toward;
  const double *q, *v;
  double least_gap;  // relative difference that counts
};

// Throws SFDAE_WRONG_DERIVATIVES if a derivative contradicts the function beyond doubt.
void demand_derivatives(CallbackMultibody& problem, const MultibodyCheckPoint& point);

}  // namespace sfdae::core
