// printf into a string, for messages.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace sfdae::core {

#if defined(__GNUC__)
__attribute__((format(printf, 1, 2)))
#endif
std::string
format(const char* pattern, ...);

}  // namespace sfdae::core
