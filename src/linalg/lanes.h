// Eight numbers side by side, one of each of eight points, for the same operation on all of them.
//
// Sums and products of lanes equal those of single numbers to the last bit: sources that use them are compiled without
// contraction to fused operations, and for every instruction set in the same way. Unused lanes repeat a point that is
// present, so that nothing happens in them that does not happen elsewhere.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "linalg/instruction_set.h"

namespace sfdae::core {

inline constexpr int lane_count = 8;

struct alignas(64) LaneBlock {
  double lane[lane_count] = {};
};
using LaneArray = std::vector<LaneBlock>;

// Vector type of GCC and Clang that lanes are computed with, independent of the registers.
typedef double Lanes __attribute__((vector_size(64), may_alias));
typedef std::int64_t LaneMask __attribute__((vector_size(64), may_alias));

inline Lanes& lanes(LaneBlock& block) { return reinterpret_cast<Lanes&>(block); }
inline const Lanes& lanes(const LaneBlock& block) { return reinterpret_cast<const Lanes&>(block); }
inline Lanes* to_lanes(LaneBlock* blocks) { return reinterpret_cast<Lanes*>(blocks); }
inline const Lanes* to_lanes(const LaneBlock* blocks) { return reinterpret_cast<const Lanes*>(blocks); }
inline LaneBlock* to_blocks(Lanes* values) { return reinterpret_cast<LaneBlock*>(values); }
inline Lanes* to_lanes(LaneArray& blocks) { return to_lanes(blocks.data()); }
inline const Lanes* to_lanes(const LaneArray& blocks) { return to_lanes(blocks.data()); }

inline void clear(Lanes* values, int count) {
  for (int k = 0; k < count; ++k) values[k] = Lanes{};
}

inline bool any(const LaneMask& mask) {
  std::int64_t found = 0;
  for (int l = 0; l < lane_count; ++l) found |= mask[l];
  return found != 0;
}
inline bool all(const LaneMask& mask) {
  std::int64_t found = -1;
  for (int l = 0; l < lane_count; ++l) found &= mask[l];
  return found != 0;
}
inline double smallest(const Lanes& values) {
  double least = values[0];
  for (int l = 1; l < lane_count; ++l) least = values[l] < least ? values[l] : least;
  return least;
}

// Bits of exponents that are all set belong to NaN and infinite numbers: no comparison that could be an exception.
inline void note_not_finite(const Lanes& values, LaneMask& found) {
  constexpr std::int64_t exponent = 0x7ff0000000000000;
  const LaneMask bits = reinterpret_cast<const LaneMask&>(values) & exponent;
  found |= bits == exponent;
}

// The columns of a matrix become lanes: block k has entry k of each, the last column in the lanes beyond.
inline void columns_to_lanes(const double* columns, int rows, int count, LaneBlock* blocks) {
  for (int l = 0; l < lane_count; ++l) {
    const double* column = columns + static_cast<std::ptrdiff_t>(l < count ? l : count - 1) * rows;
    for (int k = 0; k < rows; ++k) blocks[k].lane[l] = column[k];
  }
}
inline void lanes_to_columns(const LaneBlock* blocks, int rows, int count, double* columns) {
  for (int l = 0; l < count; ++l)
    for (int k = 0; k < rows; ++k) columns[static_cast<std::ptrdiff_t>(l) * rows + k] = blocks[k].lane[l];
}

// Instruction set for lanes: AVX-512 if best_instruction_set() returns it, else the compiler's target, except in loops
// written for AVX2. A test may choose otherwise.
InstructionSet instruction_set_of_lanes();
void use_for_lanes(InstructionSet set);

// SFDAE_LANE_KERNEL(name, Work) defines run_name(Work&), which calls name(Work&), with everything it calls, compiled
// for the instruction set in use.
#if defined(__x86_64__) && defined(__GNUC__)
#define SFDAE_LANE_KERNEL(name, Work)                                                                        \
  __attribute__((target("avx512f,avx512dq"), flatten)) static void name##_avx512(Work& work) { name(work); } \
  __attribute__((flatten)) static void name##_portable(Work& work) { name(work); }                           \
  static void run_##name(Work& work) {                                                                       \
    if (instruction_set_of_lanes() == InstructionSet::avx512) return name##_avx512(work);                    \
    name##_portable(work);                                                                                   \
  }
#else
#define SFDAE_LANE_KERNEL(name, Work) \
  static void run_##name(Work& work) { name(work); }
#endif

}  // namespace sfdae::core
