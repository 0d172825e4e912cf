// Replaced equations in checkpoints: they were found with random points, so the same ones must be restored.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "linalg/archive.h"
#include "structure/structure.h"

namespace sfdae::core {

void archive_structure(const Structure& structure, Archive& archive);

// recorded: the structure of the original equations. Throws DamagedArchive.
std::shared_ptr<const Structure> archived_structure(const Structure& recorded, Archive& archive);

}  // namespace sfdae::core
