// Recording of the formulas of a mechanical system.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "multibody/multibody_recorded.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

// Calls the user's function once. `problem` has been checked. Throws Failure, with a public status, for mistakes in
// recording.
std::unique_ptr<RecordedMultibody> record_multibody(const sfdae_multibody_problem& problem);

}  // namespace sfdae::core
