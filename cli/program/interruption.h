// Ctrl-C: the first one asks for a clean end, the second ends the program at once.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace sfdae::cli {

// From now on SIGINT and SIGTERM are noted.
void note_interruptions();

bool was_interrupted();

}  // namespace sfdae::cli
