// Ctrl-C: the first one requests a clean end, the second ends the program at once.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace sfdae::cli {

// Installs handlers that record SIGINT and SIGTERM.
void note_interruptions();

bool was_interrupted();

}  // namespace sfdae::cli
