// Accuracy of located points at which something vanishes: changes between steps, and singular points.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace sfdae::core {

// Values up to this multiple of the smallest one kept at the located point count as zero there, as the point is not hit
// exactly. Ranks by a tolerance above a tenth would mean nothing.
inline constexpr double vanishing_factor = 30.0;
inline constexpr double largest_rank_tolerance = 0.1;

// Points are told apart down to this part of the interval searched, or to eight roundings of t.
inline constexpr double location_resolution = 1e-9;
inline constexpr double location_roundings = 8.0;

}  // namespace sfdae::core
