// A multibody system as the API sees it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "multibody/multibody_system.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

sfdae_multibody_report report_of(const MultibodySystem& system);

}  // namespace sfdae::core
