// Location of changes of the characteristic values of a linear problem between two points, and the new values.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "linear/linear_system.h"
#include "system/change_watch.h"

namespace sfdae::core {

// Between left, where the values known hold, and right, where others do. The points of the system stay.
std::optional<LocatedChange> locate_change(LinearSystem& system, double left, double right);

// A point in between, although the values known hold at both ends; left: the point accepted last.
StepSearch locate_isolated_change(LinearSystem& system, double left, double right);

}  // namespace sfdae::core
