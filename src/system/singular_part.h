// Part of a strangeness-free system that loses rank at a singular point.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace sfdae::core {

// constraints: A2; differential: E T2. unknown: not examined, or not determined numerically. Archived as numbers.
enum class SingularPart { unknown, constraints, differential, both };

}  // namespace sfdae::core
