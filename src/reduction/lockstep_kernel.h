// The loops of an elimination in lockstep: eight rows at a time.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "reduction/lockstep_elimination.h"

namespace sfdae::core {

struct LockstepWork {
  LaneBlock* values = nullptr;  // layout as in LockstepMatrix
  int rows = 0, cols = 0, width = 0;
  int groups = 0;  // of eight rows
  double tolerance = 0.0;
  ZeroScale scale = ZeroScale::whole_rows;
  bool in_halves = false;  // with AVX2

  // Sums of sizes of terms in each entry; one block for each group of each column.
  std::vector<LaneBlock> sums;
  // q of the entries that may be pivots, in the columns to be eliminated; 0 in rows that have one.
  std::vector<LaneBlock> significances;
  // Multipliers of the pivot row of each step, as long as a column; and the groups of rows with nonzero ones.
  std::vector<LaneBlock> factors;
  std::vector<char> is_active;
  std::vector<int> exchanged;           // the row that was exchanged with row `rank`
  std::vector<char> used;               // columns with a pivot
  std::vector<LaneBlock> largest_sums;  // of rows; one block for each group

  int rank = 0;
  Significance significance;
};

void eliminate_in_lockstep(LockstepWork& work);

}  // namespace sfdae::core
