// Equations that were replaced, in checkpoints: points at random have found them once, and the same are to be taken
// again.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "linalg/archive.h"
#include "structure/structure.h"

namespace sfdae::core {

void archive_structure(const Structure& structure, Archive& archive);

// recorded: of the equations as they are. Throws DamagedArchive.
std::shared_ptr<const Structure> archived_structure(const Structure& recorded, Archive& archive);

}  // namespace sfdae::core
