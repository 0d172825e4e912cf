// Formatting of messages.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/format.h"

#include <cstdarg>
#include <cstdio>

namespace sfdae::core {

std::string format(const char* pattern, ...) {
  char buffer[1024];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(buffer, sizeof buffer, pattern, arguments);
  va_end(arguments);
  return buffer;
}

}  // namespace sfdae::core
