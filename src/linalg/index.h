// Conversion of subscripts: sizes are int, as in BLAS; the standard library counts with std::size_t.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace sfdae::core {

constexpr std::size_t index(int i) { return static_cast<std::size_t>(i); }

}  // namespace sfdae::core
